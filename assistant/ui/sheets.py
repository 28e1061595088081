"""Screens over the chat: help, why this answer, the whole picture, the map, the large view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.events import Key, MouseDown, MouseMove, MouseUp, Paste
from textual.message import Message
from textual.screen import ModalScreen
from textual.widgets import Static

from assistant.keymap import ACTIONS
from assistant.protocols import Kind
from assistant.terminal import clean, clean_lines
from assistant.ui.boxing import first_box, grown, moved, spanned
from assistant.ui.floor import marks_of
from assistant.ui.footer import SheetFoot
from assistant.ui.keys import closing
from assistant.ui.panels import FloorView, asked
from assistant.ui.picture import PictureView, Shot, caption
from assistant.wording import place_words, short_time

if TYPE_CHECKING:
    from datetime import datetime

    from textual.app import ComposeResult

    from assistant.ui.floor import Floor
    from d3a.answer import Answer, RankedKeyframe
    from d3a.model import Box

LOOKING = "Esc: back   arrows: others   b: draw a box   c: crop   mouse: draw a box too"
BOXING = "Enter: take it   Esc: leave it   arrows: move   shift+arrows or wasd: size"
HELP = """Type a question in plain English, and Enter.

  Where are my keys?
  Where was the cup this morning?
  When were the cup and the bowl together?
  What is on the table?
  Did you ever see a red mug?
  How many chairs are in the kitchen?

Enter      ask; on a row of the list: the whole picture, and back
Up, Down   earlier questions; Down at the newest: the list
Right      take the grey suggestion
Tab        the next pane
1 to 9     with the list in focus: that keyframe
PgUp       what was said earlier in this chat
Esc        stop the running question, or back to the question line

F1 help      F2 picture   F3 map       F4 speak     F5 large
F6 save      F7 why       F8 copy      Ctrl+P all commands   Ctrl+Q quit

Go on from an answer: and the bowl?   what about yesterday?   not this one
the second one   when was that?   where was it before that?

Teach me, of the chosen row:  these are my keys     call this place the desk
that is the same cup as number 2     that is not the same     undo
What I do not know: draw a box (F2, then b or the mouse) and say what it is.

Each key has a word too: /help /picture /map /speak /large /save /why /copy
/undo /taught /forget (the questions of earlier chats) /quit

Letters too small? Make them larger in your terminal, mostly by Ctrl and +."""


class Overlay(ModalScreen[None]):
    """What is laid over the chat, until its own key, Enter, q or Esc takes it away."""

    def on_mount(self) -> None:
        """Take away notices that would hide what is laid there."""
        self.app.clear_notifications()

    def action_dismiss_sheet(self) -> None:
        """Go back to the chat."""
        self.leave()

    def leave(self) -> None:
        """Go back to the chat, once: keys that come in a burst may say it several times."""
        if self.is_active:
            self.dismiss()


class Page(Overlay):
    """What is laid over the chat and has no use for letters: a question goes on in the chat."""

    @dataclass
    class TypedOn(Message):
        """Somebody types or pastes: it is meant for the question line."""

        text: str

    _typed = ""

    def on_key(self, event: Key) -> None:
        """Leave for the question line with the first letter."""
        letter = event.character if event.is_printable else None
        begins = letter and not letter.isspace() and event.key not in self.active_bindings
        goes_on = self._typed or not self.is_active  # a burst that came before this was left
        if letter and (begins or goes_on):
            event.stop()
            self._go_on(letter)

    def on_paste(self, event: Paste) -> None:
        """Leave for the question line with what was pasted."""
        event.stop()
        self._go_on(event.text)

    def _go_on(self, text: str) -> None:
        if not self._typed:
            self.call_later(self._leave)
        self._typed += text

    def _leave(self) -> None:
        text, self._typed = self._typed, ""
        self.app.post_message(self.TypedOn(text))
        self.leave()


class Sheet(Page):
    """A page of text over the chat; Esc, Enter, q or its own key closes it."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter,q", "dismiss_sheet", "Back"),
        *closing("help", "why"),
    ]

    def __init__(self, title: str, text: str = "") -> None:
        super().__init__()
        self._title = title
        self._text = text

    def compose(self) -> ComposeResult:
        """Lay out a title, the text, and how to leave."""
        yield Static(self._title, id="sheet-title", markup=False)
        with VerticalScroll(id="sheet-scroll"):
            yield Static(clean_lines(self._text), id="sheet-text", markup=False)
        yield SheetFoot("Esc: back   arrows, PgUp, PgDn: scroll")

    def on_mount(self) -> None:
        """Let the arrows scroll."""
        self.query_one("#sheet-scroll").focus()

    def set_text(self, text: str) -> None:
        """Replace the text, when a worker has it."""
        self._text = text
        if self.is_mounted:
            self.query_one("#sheet-text", Static).update(clean_lines(text))


class PictureSheet(Overlay):
    """The whole picture of a keyframe; the arrows go through the list."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,q", "dismiss_sheet", "Back"),
        *closing("picture"),
        Binding("enter", "accept", "Back, or take the box"),
        Binding("n", "step(1)", "Next"),
        Binding("p", "step(-1)", "Previous"),
        Binding("down", "arrow(0, 1)", "Next"),
        Binding("up", "arrow(0, -1)", "Previous"),
        Binding("right", "arrow(1, 0)", "Next"),
        Binding("left", "arrow(-1, 0)", "Previous"),
        Binding("shift+down,s", "grow(0, 1)", "Higher"),
        Binding("shift+up,w", "grow(0, -1)", "Lower"),
        Binding("shift+right,d", "grow(1, 0)", "Wider"),
        Binding("shift+left,a", "grow(-1, 0)", "Narrower"),
        Binding("b", "box", "Draw a box"),
        Binding("c", "crop", "Crop or whole"),
    ]

    @dataclass
    class Stepped(Message):
        """Another keyframe of the answer is wanted."""

        sheet: PictureSheet
        step: int

    @dataclass
    class Boxed(Message):
        """A box was drawn on the picture: in pixels of the frame."""

        box: Box

    def __init__(self, shot: Shot, count: int, now: datetime, kind: Kind) -> None:
        super().__init__()
        self._shot, self._count, self._now, self._kind = shot, count, now, kind
        self._box: Box | None = None  # the one being drawn
        self._corner: tuple[float, float] | None = None  # where the mouse went down

    def compose(self) -> ComposeResult:
        """Lay out a caption, the picture, and how to leave."""
        yield Static(id="sheet-title", markup=False)
        yield PictureView(kind=self._kind, whole=True, id="whole")
        yield SheetFoot(LOOKING)

    def on_mount(self) -> None:
        """Show the picture that was asked for."""
        self.show_shot(self._shot)

    def show_shot(self, shot: Shot) -> None:
        """Show another keyframe."""
        self._shot, self._box = shot, None
        self.query_one(PictureView).shot = shot
        self._say()

    def _draw(self, box: Box | None) -> None:
        """Show the box that is being drawn, None for the keyframe's own."""
        self._box = box
        view, shot = self.query_one(PictureView), self._shot
        view.whole = view.whole or box is not None
        if box is None:
            view.shot = shot
        else:
            view.shot = replace(shot, keyframe=replace(shot.keyframe, box=box, category="new"))
        self._say()

    @property
    def _frame_size(self) -> tuple[int, int] | None:
        picture = self._shot.picture
        return (picture.width, picture.height) if picture else None

    def _say(self) -> None:
        whole = self.query_one(PictureView).whole
        width = self.size.width - 2
        words = caption(self._shot, self._count, self._now, whole=whole, width=width)
        self.query_one("#sheet-title", Static).update(words)
        self.query_one(SheetFoot).say(LOOKING if self._box is None else BOXING)

    def action_box(self) -> None:
        """Draw a box around a thing, to say what it is."""
        if self._frame_size is not None:
            self._draw(first_box(self._frame_size, self._shot.keyframe.box))

    def action_arrow(self, across: int, down: int) -> None:
        """Move the box that is being drawn, else go through the list."""
        if self._box is not None and self._frame_size is not None:
            self._draw(moved(self._box, across, down, self._frame_size))
        else:
            self.action_step(across + down)

    def action_grow(self, across: int, down: int) -> None:
        """Move the right or the lower edge of the box that is being drawn."""
        if self._box is not None and self._frame_size is not None:
            self._draw(grown(self._box, across, down, self._frame_size))

    def action_accept(self) -> None:
        """Take the box that was drawn; without one go back to the chat."""
        if self._box is not None:
            self.post_message(self.Boxed(self._box))
        self.leave()

    def action_dismiss_sheet(self) -> None:
        """Leave the box, if one is being drawn, else the sheet."""
        if self._box is not None:
            self._draw(None)
        else:
            self.leave()

    def on_mouse_down(self, event: MouseDown) -> None:
        """Begin a box where the mouse goes down."""
        self._corner = self._point(event)

    def on_mouse_move(self, event: MouseMove) -> None:
        """Draw the box from there to here."""
        here = self._point(event)
        if self._corner is not None and here is not None and self._frame_size is not None:
            self._draw(spanned(self._corner, here, self._frame_size))

    def on_mouse_up(self, event: MouseUp) -> None:
        """Leave the box as it is."""
        self._corner = None

    def _point(self, event: MouseDown | MouseMove) -> tuple[float, float] | None:
        view = self.query_one(PictureView)
        at = event.screen_offset - view.region.offset
        return view.frame_point(at.x, at.y)

    def action_step(self, step: int) -> None:
        """Ask for the keyframe before or after."""
        self.post_message(self.Stepped(self, step))

    def action_crop(self) -> None:
        """Show the part around the box, or the whole again."""
        view = self.query_one(PictureView)
        view.whole = not view.whole
        self._say()


class FloorSheet(Page):
    """The map over the whole screen."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter,q", "dismiss_sheet", "Back"),
        *closing("map"),
    ]

    def __init__(self, floor: Floor, keyframes: Sequence[RankedKeyframe], now: datetime) -> None:
        super().__init__()
        self._floor, self._keyframes, self._now = floor, tuple(keyframes), now

    def compose(self) -> ComposeResult:
        """Lay out the map, what its numbers are, and how to leave."""
        yield Static("Map", id="sheet-title", markup=False)
        yield FloorView(id="floor-large")
        marked = {mark.label for mark in marks_of(self._keyframes)}
        lines = [
            f"{k.rank}  {clean(place_words(k))}, {short_time(k.last, self._now)}"
            for k in self._keyframes
            if str(k.rank) in marked
        ]
        with VerticalScroll(id="floor-places"):
            yield Static("\n".join(lines), id="floor-words", markup=False)
        yield SheetFoot("Esc: back   arrows: scroll the places")

    def on_mount(self) -> None:
        """Draw the map."""
        view = self.query_one(FloorView)
        view.floor, view.keyframes = self._floor, self._keyframes


class LargeSheet(Page):
    """One answer in few, spaced lines, one picture, three keys: for tired eyes."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter,q", "dismiss_sheet", "Back"),
        *closing("large"),
        Binding(ACTIONS["speak"], "app.speak", "Speak", id="speak"),
        Binding(ACTIONS["copy"], "app.copy_answer", "Copy", id="copy"),
        Binding(ACTIONS["save"], "app.save", "Save", id="save"),
    ]

    def __init__(self, answer: Answer, shot: Shot | None, kind: Kind) -> None:
        super().__init__()
        self._answer, self._shot, self._kind = answer, shot, kind

    def compose(self) -> ComposeResult:
        """Lay out the sentences with air between them, the picture, three keys."""
        yield Static(large_text(self._answer), id="large-text", markup=False)
        yield PictureView(kind=self._kind, id="large-picture")
        yield SheetFoot("Esc: back   F4: speak   F6: save")

    def on_mount(self) -> None:
        """Show the best picture."""
        self.query_one(PictureView).shot = self._shot


def large_text(answer: Answer) -> Text:
    """Return the question, and the answer a sentence a line, an empty line between."""
    words = clean(answer.answer or answer.message or "Ask a question first.")
    sentences = [
        part.strip() for part in words.replace("? ", "?\n").replace(". ", ".\n").split("\n")
    ]
    said = "\n\n".join(part for part in sentences if part)
    return asked(answer.text).append(f"\n{said}", style="not dim bold")
