"""The one screen of the chat: it shows what it is given, and passes on what the person does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container, Horizontal, Vertical, VerticalScroll
from textual.events import Key
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Static

from assistant.english import ago
from assistant.pointing import shown
from assistant.protocols import Kind
from assistant.session import Session
from assistant.terminal import clean, width_of
from assistant.ui.footer import KeyLine
from assistant.ui.keys import SCREEN_KEYS
from assistant.ui.lists import KeyframeList, QuestionList
from assistant.ui.panels import FloorView, Timeline, asked, exchange
from assistant.ui.picture import PictureView, Shot, caption
from assistant.ui.prompt import Prompt
from assistant.ui.sheets import Sheet
from assistant.ui.world import World
from assistant.wording import from_ms, short_time
from d3a.answer import Answer, RankedKeyframe

EXCHANGES_KEPT = 50
TYPE_A_QUESTION = "type a question, then Enter"
PARTS = (
    "#header, #exchange-pane, #exchange, #keyframes, #questions, #earlier, #earlier-text, "
    "#picture-caption, #picture, #floor, #timeline, #prompt"
)
"""What messages that come late would be shown by."""
GO_ON = "go on: and yesterday?   not this one   when was that?"


def welcome(world: World, *, brief: bool = False) -> Text:
    """Return the first words: what may be asked, or why nothing can be.

    brief: where each row is needed for the questions below.
    """
    if world.problem is not None:
        problem = clean(world.problem)
        return Text(f"I cannot reach my memory.\n{problem}\nAsk again in a moment.")
    if world.newest_ms is None:
        return Text("I have seen nothing yet.\nFill this memory: d3a ingest SOURCE --store ...")
    known = ", ".join(clean(word) for word in world.words[:12])
    more = " and more" if len(world.words) > 12 else ""
    if brief:
        return Text("Ask me where things were. Down and Enter, or type:", style="bold")
    words = Text("Ask me where things were.\n", style="bold")
    words.append(f"I know {known}{more}.", style="not bold")
    if world.questions:
        words.append("\n\nFor example (Down and Enter, or type your own):", style="not bold dim")
    return words


def header(
    title: str, now: datetime, newest_ms: int | None, answer: Answer | None, width: int
) -> str:
    """Return the line on top: whose memory, how fresh, in which zone times are said.

    What does not fit in `width` cells goes whole, from the right.
    """
    parts = [f"d3a  {clean(title)}"]
    if newest_ms is not None:
        newest = from_ms(newest_ms, now)
        moment = short_time(newest, now).removesuffix(" today")
        parts.append(f"memory up to {moment} ({ago(newest, now)})")
    parts.append(f"times: {now.tzinfo}")
    if answer is not None and answer.keyframes:
        spent = answer.elapsed_ms.get("total")
        parts.append(f"{len(answer.keyframes)} found")
        if spent is not None:
            parts[-1] += f" in {spent:.0f} ms"
    while len(parts) > 1 and width_of("  ".join(parts)) > width:
        parts.pop()
    return "  ".join(parts)


class ChatScreen(Screen[None]):
    """Question line, answer, ranked keyframes, picture, map; `chat.tcss` arranges them."""

    HORIZONTAL_BREAKPOINTS = [  # noqa: RUF012  as textual's base declares it
        (0, "-tiny"),
        (40, "-small"),
        (60, "-narrow"),
        (110, "-wide"),
    ]
    VERTICAL_BREAKPOINTS = [  # noqa: RUF012
        (0, "-cut"),
        (10, "-flat"),
        (16, "-low"),
        (22, "-mid"),
        (30, "-high"),
    ]
    BINDINGS: ClassVar[list[BindingType]] = SCREEN_KEYS

    @dataclass
    class Ready(Message):
        """The screen stands there: the store may be looked at."""

    def __init__(self, session: Session, pictures: Kind) -> None:
        super().__init__()
        self._session = session
        self._pictures: Kind = pictures
        self._shown: Answer | None = None
        self._asked_at: datetime | None = None
        self._world = World()
        self._earlier: list[Text] = []
        self.typed = ""
        """What the person typed before the screen stood there."""

    @property
    def shot(self) -> Shot | None:
        """The picture shown, with its keyframe."""
        return self.query_one("#picture", PictureView).shot

    @property
    def keyframes(self) -> tuple[RankedKeyframe, ...]:
        """The keyframes listed: the answer's, else the nearest true one that it offers."""
        return shown(self._shown)

    @property
    def earlier(self) -> str:
        """What was said before the answer shown, newest first."""
        return "\n\n".join(text.plain for text in self._earlier)

    @property
    def now(self) -> datetime:
        """The moment of the answer shown, by which its times are said."""
        return self._asked_at or self._session.now()

    @property
    def _is_left(self) -> bool:
        """Whether the person is leaving: messages still come, for parts that are gone.

        They go one by one, in no order that is promised.
        """
        return len(self.query(PARTS)) < PARTS.count("#")

    def compose(self) -> ComposeResult:
        """Lay out the one tree that the style sheet arranges for every size of window."""
        yield Static(id="header", markup=False)
        with Container(id="body"):
            with Container(id="talk"):
                with VerticalScroll(id="exchange-pane", can_focus=False):
                    yield Static(id="exchange", markup=False)
                yield KeyframeList(id="keyframes")
                yield QuestionList(id="questions")
                with VerticalScroll(id="earlier", can_focus=False):
                    yield Static(id="earlier-text", markup=False)
            with Container(id="sight"):
                with Vertical(id="left"):
                    yield Static(id="picture-caption", classes="caption", markup=False)
                    yield PictureView(kind=self._pictures, id="picture")
                with Container(id="right"):
                    with Vertical(id="crop-pane"):
                        yield Static("Around the box", classes="caption", markup=False)
                        yield PictureView(kind=self._pictures, id="crop")
                    with Vertical(id="floor-pane"):
                        yield Static("Map", classes="caption", markup=False)
                        yield FloorView(id="floor")
                yield Timeline(id="timeline")
        yield Static("Please make the window larger.", id="too-small", markup=False)
        with Horizontal(id="ask"):
            yield Static("Ask:", id="ask-word", markup=False)
            yield Prompt(placeholder=TYPE_A_QUESTION, id="prompt")
        yield KeyLine()

    def on_mount(self) -> None:
        """Start on an empty conversation."""
        self.add_class("-idle")
        self.focus_prompt()
        self.query_one(Prompt).insert_text_at_cursor(self.typed)
        self._show_header()
        self.post_message(self.Ready())

    def on_resize(self) -> None:
        """Show the whole picture beside the crop where there is room for both."""
        self.call_after_refresh(self._choose_view)

    def _choose_view(self) -> None:
        if self._is_left:
            return
        self.query_one("#picture", PictureView).whole = self.has_class("-wide")
        self._show_caption()
        self._show_header()
        if self.query_one(QuestionList).option_count and self.has_class("-idle"):
            self._greet()
        if self.focused is None:  # a window too small hides the question line, and its focus
            self.focus_prompt()

    def _show_header(self) -> None:
        width = self.size.width - 2
        newest_ms = self._world.newest_ms
        line = header(self._session.title, self.now, newest_ms, self._shown, width)
        self.query_one("#header", Static).update(line)

    def _say(self, words: Text) -> None:
        self.query_one("#exchange", Static).update(words)
        self.query_one("#exchange-pane").scroll_home(animate=False)

    def show_welcome(self) -> None:
        """Greet, with questions to start from: nothing was asked yet."""
        if self._is_left:
            return
        self._greet()
        self.query_one(QuestionList).show_questions(self._world.questions)

    def _greet(self) -> None:
        is_small = any(map(self.has_class, ("-small", "-flat")))
        self._say(welcome(self._world, brief=is_small and bool(self._world.questions)))

    def show_world(self, world: World) -> None:
        """Take in what the store holds."""
        if self._is_left:
            return
        self._world = world
        self._show_header()
        self.query_one(Prompt).known.words = world.words
        self.query_one(FloorView).floor = world.floor

    def show_earlier(self, questions: Sequence[str]) -> None:
        """Let the question line offer these, the newest first."""
        if self._is_left:
            return
        prompt = self.query_one(Prompt)
        prompt.known.earlier = questions
        prompt.forget_place()

    def focus_prompt(self) -> None:
        """Let the person type."""
        self.query_one(Prompt).focus()

    def show_looking(self, text: str) -> None:
        """Say that an answer takes a while."""
        if self._is_left:
            return
        self._say(asked(text).append("Looking ... (Esc stops)", style="not dim"))

    def show_remark(self, typed: str, words: str) -> None:
        """Say something of what was typed that is no answer; what is listed stays."""
        self._say(asked(typed).append(clean(words), style="not dim"))

    def show_stopped(self) -> None:
        """Say that nothing is waited for any more."""
        self._say(Text("Stopped. Ask again, or something else."))

    def show_answer(
        self, answer: Answer, world: World, pointed: RankedKeyframe | None = None
    ) -> None:
        """Show an answer: its sentence, its keyframes, its places; the mark on the one pointed at.

        A picture that stays the same stays as it is.
        """
        if self._is_left:
            return
        if self._shown is not None:
            self._remember(self._shown)
        self._shown = answer
        self._asked_at = now = self._session.now()
        rows = shown(answer)
        self.remove_class("-idle").add_class("-answered")
        self.set_class(bool(answer.suggestions) and not rows, "-suggesting")
        self.set_class(not rows, "-nothing")
        self.query_one(Prompt).placeholder = GO_ON if rows else TYPE_A_QUESTION
        self._say(exchange(answer))
        at = next((i for i, each in enumerate(rows) if each == pointed), 0)
        self.query_one(KeyframeList).show_keyframes(rows, now, at)
        self.query_one(QuestionList).show_questions(answer.suggestions)
        self.query_one(FloorView).keyframes = rows
        timeline = self.query_one(Timeline)
        timeline.now, timeline.keyframes = now, rows
        self.show_world(world)
        if not rows:
            self.show_shot(None)

    def show_late(self, answer: Answer, world: World) -> None:
        """Keep an answer that came after something newer was said."""
        if not self._is_left:
            self._remember(answer)
            self.show_world(world)

    def _remember(self, answer: Answer) -> None:
        self._earlier = [exchange(answer), *self._earlier][:EXCHANGES_KEPT]
        said = Text("\n\n").join([Text("Earlier in this chat", style="dim"), *self._earlier])
        self.query_one("#earlier-text", Static).update(said)

    def show_shot(self, shot: Shot | None) -> None:
        """Show the picture of a keyframe, None for none."""
        if self._is_left:
            return
        for view in self.query(PictureView):
            view.shot = shot
        self._show_caption()

    def _show_caption(self) -> None:
        view = self.query_one("#picture", PictureView)
        count, width = len(self.keyframes), view.size.width - 1
        words = caption(view.shot, count, self.now, whole=view.whole, width=width)
        self.query_one("#picture-caption", Static).update(words)

    def step(self, step: int) -> None:
        """Move the mark in the list."""
        if self._is_left:
            return
        rows = self.query_one(KeyframeList)
        if rows.highlighted is not None:
            rows.highlighted = min(max(rows.highlighted + step, 0), rows.option_count - 1)

    def on_prompt_left_below(self) -> None:
        """Go from the question line to the rows."""
        for rows in (self.query_one(KeyframeList), self.query_one(QuestionList)):
            if rows.display and rows.option_count:
                rows.focus()
                return

    def on_key(self, event: Key) -> None:
        """Let typing anywhere in the chat go on in the question line."""
        if event.is_printable and not self.query_one(Prompt).has_focus:
            self.type_on(event.character or "")
            event.stop()

    def type_on(self, text: str) -> None:
        """Go on in the question line with what was typed elsewhere."""
        prompt = self.query_one(Prompt)
        prompt.focus()
        prompt.insert_pasted(text)

    def action_earlier(self, pages: int) -> None:
        """Scroll in the conversation; where it has no pane it comes as a sheet."""
        pane = self.query_one("#earlier")
        if self.has_class("-wide"):
            pane.scroll_relative(y=pages * max(pane.size.height - 1, 1), animate=False)
        elif pages < 0:
            text = self.earlier or "Nothing was said before this."
            self.app.push_screen(Sheet("Earlier in this chat", text))
