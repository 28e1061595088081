"""Where the person types: one line, earlier questions on Up and Down, a grey suggestion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.events import Paste
from textual.message import Message
from textual.suggester import Suggester
from textual.widgets import Input

from assistant.suggesting import completion
from assistant.terminal import clean


class KnownQuestions(Suggester):
    """Completes what is typed from earlier questions and the words of the store."""

    def __init__(self) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self.earlier: Sequence[str] = ()
        self.words: Sequence[str] = ()

    async def get_suggestion(self, value: str) -> str | None:
        """Return the completed value."""
        return completion(value, self.earlier, self.words)


class Prompt(Input):
    """The question line. Posts `Input.Submitted`; `LeftBelow` when Down has nothing newer."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "earlier", "Earlier question", show=False),
        Binding("down", "later", "Later question", show=False),
        # Enter, where it was typed before the chat stood there and the terminal was a shell's
        Binding("ctrl+j", "submit", "Ask", show=False),
    ]

    @dataclass
    class LeftBelow(Message):
        """Down was pressed at the newest line: the person wants the list."""

    def __init__(self, *, placeholder: str, id: str | None = None) -> None:  # noqa: A002  textual's word
        self.known = KnownQuestions()
        super().__init__(
            placeholder=placeholder,
            suggester=self.known,
            select_on_focus=False,
            compact=True,
            id=id,
        )
        self.cursor_blink = False  # blinking sends 2 KB/s down the line for nothing
        self._back = 0  # how many questions back the shown one lies; 0: what is being typed
        self._typed = ""

    def action_earlier(self) -> None:
        """Show the question before."""
        earlier = self.known.earlier
        if self._back < len(earlier):
            if self._back == 0:
                self._typed = self.value
            self._back += 1
            self._recall(earlier[-self._back])

    def action_later(self) -> None:
        """Show the question after, or what was typed; below that lies the list."""
        if self._back == 0:
            self.post_message(self.LeftBelow())
            return
        self._back -= 1
        self._recall(self.known.earlier[-self._back] if self._back else self._typed)

    def forget_place(self) -> None:
        """Start again from the newest question: one was asked."""
        self._back, self._typed = 0, ""

    def _recall(self, text: str) -> None:
        self.value = text
        self.cursor_position = len(text)

    def _on_paste(self, event: Paste) -> None:
        """Take all of what is pasted or dictated."""
        event.prevent_default()
        event.stop()
        self.insert_pasted(event.text)

    def insert_pasted(self, text: str) -> None:
        """Insert what came at once: its lines become one."""
        self.insert_text_at_cursor(" ".join(clean(text).split()) or clean(text))
