"""The chat as an application: it asks the store in threads, and does what keys and words name.

The store is asked by one thread at a time, and each question bears a number, so that a late
answer never replaces a newer one. `chat.ChatScreen` shows what comes of it.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import ClassVar

from textual import work
from textual.app import App, SystemCommand
from textual.binding import BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Input

from assistant.clipboard import copied
from assistant.history import History
from assistant.protocols import Kind
from assistant.reasons import why_text
from assistant.saving import answer_text, saved
from assistant.session import Session
from assistant.slashes import BOX_USAGE, COMMANDS, Command, bare, unknown
from assistant.speaking import Voice
from assistant.terminal import clean
from assistant.ui.chat import ChatScreen
from assistant.ui.commands import HIGH_CONTRAST
from assistant.ui.keys import APP_KEYS, keys_said
from assistant.ui.lists import KeyframeList, QuestionList
from assistant.ui.palette import Palette
from assistant.ui.picture import Shot
from assistant.ui.sheets import HELP, FloorSheet, LargeSheet, Page, PictureSheet, Sheet
from assistant.ui.waiting import Saying, WaitingLine
from assistant.ui.world import News, World, in_turn, read_news, survey
from assistant.wording import told
from d3a.answer import Answer, RankedKeyframe
from d3a.model import D3AError
from d3a.store.base import Keyframe

LOOKING_S = 0.3
"""An answer that takes longer than this says that it is being looked for."""
PICTURES_KEPT = 32


class ChatApp(App[None], inherit_bindings=False):
    """The chat over one session.

    history: earlier questions. saves: the folder F6 writes to. speak: the command of F4.
    keys: by action, those that the settings put in the place of the usual ones.
    """

    TITLE = "d3a"
    CSS_PATH = "chat.tcss"
    BINDINGS: ClassVar[list[BindingType]] = APP_KEYS

    @dataclass
    class Answered(Message):
        """A thread has an answer; `number` tells a late one from the newest."""

        number: int
        answer: Answer
        news: News
        pointed: RankedKeyframe | None

    @dataclass
    class Surveyed(Message):
        """A thread has looked at what the store holds; done: found what may be asked, too."""

        world: World
        is_done: bool

    @dataclass
    class Fetched(Message):
        """A thread has read the picture of a keyframe."""

        shot: Shot
        problem: str = ""

    @dataclass
    class Explained(Message):
        """A thread has the text of `why`."""

        sheet: Sheet
        text: str

    def __init__(
        self,
        session: Session,
        *,
        history: History | None = None,
        pictures: Kind = "cells",
        saves: Path | None = None,
        speak: str | None = None,
        keys: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__()
        self._session = session
        self._history = history or History()
        self._pictures: Kind = pictures
        self._saves = saves or Path("d3a-saved")
        self._voice = Voice(speak)
        self._keys = dict(keys or {})
        self._store_lane = threading.Lock()  # a store's connection serves one thread at a time
        self._asked = 0
        self._waiting = False
        self._line = WaitingLine(session.teaches)
        self._answer: Answer | None = None
        self._chosen: RankedKeyframe | None = None
        self._world = World()
        self._kept: dict[str, Keyframe] = {}
        self.chat = ChatScreen(session, pictures)
        self.register_theme(HIGH_CONTRAST)
        self.set_keymap(self._keys)

    def get_default_screen(self) -> Screen[None]:
        """Return the screen of the conversation."""
        return self.chat

    def on_chat_screen_ready(self) -> None:
        """Look at the store in a thread, while the first screen stands there already."""
        self.chat.show_earlier(self._history.questions)
        self._survey()

    # the store, in threads

    @work(thread=True, group="survey")
    def _survey(self) -> None:
        """Look at the store a step at a time: a question that comes meanwhile waits for one."""
        steps = in_turn(survey(self._session), self._store_lane)
        world = next(steps)
        self.post_message(self.Surveyed(world, is_done=False))
        while not self._asked:  # then nobody needs examples any more
            following = next(steps, None)
            if following is None:
                self.post_message(self.Surveyed(world, is_done=True))
                break
            world = following
        with self._store_lane:  # the first question builds the grammar: 0.1 s to wait for
            self._session.safely("where is it?", alone=True)

    def on_chat_app_surveyed(self, message: Surveyed) -> None:
        """Show whose memory this is, and when it is known, what it can answer."""
        if not message.is_done:
            self._world = message.world
            self.chat.show_world(self._world)
        elif not self._asked:
            self._world = message.world
            self.chat.show_world(self._world)
            self.chat.show_welcome()

    def ask(self, text: str) -> None:
        """Ask a question; its answer comes by itself, an older one no more."""
        self._asked += 1
        self._waiting = True
        number = self._asked
        if not text.isdigit() and not text.startswith("box "):  # a choice and a box are none
            self._history.add(text)
        self.chat.show_earlier(self._history.questions)
        self.set_timer(LOOKING_S, lambda: self._say_looking(number, text))
        self._line.add(Saying(number, text, self._chosen))
        self._answer_next()

    def _say_looking(self, number: int, text: str) -> None:
        if self._waiting and number == self._asked:
            self.chat.show_looking(text)

    @work(thread=True, group="ask")
    def _answer_next(self) -> None:
        """Answer what has waited longest: each saying starts one of these threads."""
        with self._store_lane:
            said = self._line.take(self._asked)
            if said is None:  # a newer question waits behind this one
                return
            pointer = self._session.pointer
            if said.chosen is not None:
                pointer.to(said.chosen)
            answer = self._session.safely(said.text)
            failed = answer.status == "error"
            news = News() if failed else read_news(self._session.store, self._world)
            self.post_message(self.Answered(said.number, answer, news, pointer.row))

    def on_chat_app_answered(self, message: Answered) -> None:
        """Show an answer; one that comes late goes to what was said earlier."""
        self._world = self._world.after(message.news)
        if message.number != self._asked:
            self.chat.show_late(message.answer, self._world)
            if message.answer.query is None:  # no question: something was done
                self.notify(clean(told(message.answer)[0]), markup=False)
            return
        self._waiting = False
        self._answer, self._chosen = message.answer, None
        self.chat.show_answer(message.answer, self._world, message.pointed)

    def on_keyframe_list_chosen(self, message: KeyframeList.Chosen) -> None:
        """Fetch the picture of the row under the mark."""
        keyframe = self._chosen = message.keyframe
        if keyframe.image is None or keyframe.image in self._kept:
            self._show_shot(Shot(keyframe, self._kept.get(keyframe.image or "")))
        else:
            self._fetch(keyframe, keyframe.image)

    @work(thread=True, group="fetch")
    def _fetch(self, keyframe: RankedKeyframe, key: str) -> None:
        picture, problem = None, ""
        with self._store_lane:
            if self._chosen != keyframe:  # the mark moved on while this one waited
                return
            try:
                picture = self._session.store.keyframe(key)
            except D3AError as error:
                problem = str(error)
        self.post_message(self.Fetched(Shot(keyframe, picture), problem))

    def on_chat_app_fetched(self, message: Fetched) -> None:
        """Show a picture, unless another row was chosen since."""
        shot = message.shot
        if message.problem:
            self.notify(clean(message.problem), severity="error", markup=False)
        if shot.keyframe.image is not None and shot.picture is not None:
            self._kept[shot.keyframe.image] = shot.picture
            while len(self._kept) > PICTURES_KEPT:
                del self._kept[next(iter(self._kept))]
        if self._chosen == shot.keyframe:
            self._show_shot(shot)

    def _show_shot(self, shot: Shot) -> None:
        self.chat.show_shot(shot)
        for sheet in self.screen_stack[-1:]:  # none any more while the chat is being left
            if isinstance(sheet, PictureSheet):
                sheet.show_shot(shot)

    # what the person does

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Ask what was typed, or do what a slash names."""
        text = " ".join(clean(event.value).split())
        event.input.clear()
        if text.lower().startswith("/box "):
            self.ask(text[1:])
        elif text.startswith("/") or bare(text):
            self._do(bare(text) or text[1:].lower())
        elif text:
            self.ask(self._example(text) or text)

    def _example(self, text: str) -> str | None:
        """Return the question of the first screen that a number names, before anything is asked."""
        if self._asked or not (text.isascii() and text.isdigit()):
            return None
        return dict(enumerate(self._world.questions, 1)).get(int(text))

    def _do(self, word: str) -> None:
        if word in COMMANDS:
            self._run(COMMANDS[word])
        else:
            words = BOX_USAGE if word == "box" else unknown(word, [*COMMANDS, "box"])
            self.chat.show_remark(f"/{word}", words)

    def on_question_list_taken(self, message: QuestionList.Taken) -> None:
        """Ask one of the questions offered."""
        self.chat.focus_prompt()
        self.ask(message.question)

    def on_keyframe_list_opened(self) -> None:
        """Show the whole picture."""
        self.action_picture()

    def on_picture_sheet_stepped(self, message: PictureSheet.Stepped) -> None:
        """Move the mark in the list; its picture follows into the sheet."""
        self.chat.step(message.step)

    def on_picture_sheet_boxed(self, message: PictureSheet.Boxed) -> None:
        """Say the box that was drawn; what is in it, the person says next."""
        self.ask("box " + " ".join(f"{edge:.0f}" for edge in message.box))

    def on_page_typed_on(self, message: Page.TypedOn) -> None:
        """Go on in the question line with what was typed over a sheet."""
        self.chat.type_on(message.text)

    def action_help(self) -> None:
        """Show keys and examples."""
        self.push_screen(Sheet("Help", HELP + keys_said(self._keys)))

    def action_picture(self) -> None:
        """Show the whole picture of the chosen keyframe."""
        shot = self.chat.shot
        if shot is None:
            self._nothing_yet("picture")
            return
        count = len(self.chat.keyframes)
        self.push_screen(PictureSheet(shot, count, self.chat.now, self._pictures))

    def action_map(self) -> None:
        """Show the map."""
        self.push_screen(FloorSheet(self._world.floor, self.chat.keyframes, self.chat.now))

    def action_large(self) -> None:
        """Show the answer large."""
        if self._answer is None:
            self._nothing_yet("answer")
            return
        self.push_screen(LargeSheet(self._answer, self.chat.shot, self._pictures))

    def action_why(self) -> None:
        """Show how the answer came about; the plan is fetched in a thread."""
        if self._answer is None:
            self._nothing_yet("answer")
            return
        sheet = Sheet("Why this answer", why_text(self._answer, self._chosen, ""))
        self.push_screen(sheet)
        self._explain(sheet, self._answer, self._chosen)

    @work(thread=True, group="explain")
    def _explain(self, sheet: Sheet, answer: Answer, chosen: RankedKeyframe | None) -> None:
        with self._store_lane:
            explanation = self._session.explained(answer.text)
        self.post_message(self.Explained(sheet, why_text(answer, chosen, explanation)))

    def on_chat_app_explained(self, message: Explained) -> None:
        """Put the plan into the sheet, if it is still there."""
        if message.sheet.is_attached:
            message.sheet.set_text(message.text)

    def action_save(self) -> None:
        """Write the answer as a card and as JSON, and its picture as PNG, the box drawn in."""
        if self._answer is None:
            self._nothing_yet("answer")
            return
        shot = self.chat.shot
        keyframe, picture = (shot.keyframe, shot.picture) if shot else (None, None)
        words, failed = saved(self._answer, keyframe, picture, self._saves, self.chat.now)
        self.notify(words, severity="error" if failed else "information", markup=False)

    def action_copy_answer(self) -> None:
        """Copy the answer and its rows: by the desktop, else by the terminal, else to a file."""
        if self._answer is None:
            self._nothing_yet("answer")
            return
        text = answer_text(self._answer, self.chat.now)
        self.copy_to_clipboard(text)  # textual keeps it too, for pasting in the chat
        self.notify(copied(text, self._saves, by_terminal=True), markup=False)

    def action_speak(self) -> None:
        """Speak the answer aloud; again: stop."""
        if self._answer is None:
            self._nothing_yet("answer")
            return
        text = self._answer.answer or self._answer.message or ""
        self.notify(self._voice.say(text), markup=False)

    def action_stop(self) -> None:
        """Stop waiting for the running question, else go back to the question line."""
        if self._waiting:
            self._asked += 1
            self._waiting = False
            self.chat.show_stopped()
        self.chat.focus_prompt()

    def action_forget(self) -> None:
        """Forget the questions of this and earlier chats, once it was said twice."""
        words = self._history.forget()
        self.chat.show_earlier(self._history.questions)
        self.notify(words, markup=False)

    def _nothing_yet(self, what: str) -> None:
        self.notify(f"There is no {what} yet: ask a question first.", markup=False)

    def action_command_palette(self) -> None:
        """Show every command by its name."""
        if not isinstance(self.screen, Palette):
            self.push_screen(Palette(id="--command-palette"))

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """List the commands of the palette, the same that a slash names."""
        for name, command in COMMANDS.items():
            yield SystemCommand(name.capitalize(), command.tells, partial(self._run, command))

    def _run(self, command: Command) -> None:
        """Do what a command names, or ask what it says as if it were typed."""
        if command.says:
            self.call_later(self.ask, command.says)
        else:
            self.call_later(self.run_action, command.action)
