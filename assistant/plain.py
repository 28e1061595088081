"""The chat a line at a time: for screen readers, pipes, TERM=dumb and bad links.

No borders, no colours, no glyphs that a screen reader would spell; the cursor stays where the
person types. The same session answers as in the full-screen chat.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from assistant.clipboard import copied
from assistant.english import ago
from assistant.history import History
from assistant.reasons import why_text
from assistant.saving import answer_text, saved
from assistant.session import Session
from assistant.slashes import BOX_USAGE, COMMANDS, bare, slashed, unknown
from assistant.speaking import Voice
from assistant.starters import starters
from assistant.terminal import clean, clean_lines
from assistant.wording import from_ms, keyframe_row, short_time, told
from d3a.answer import Answer, RankedKeyframe
from d3a.model import D3AError

HELP = """Type a question, and Enter. Also:
  1, 2, 3 ...   more of that answer's keyframe, or the one of several readings
  more          the next ten of the list
  repeat        the answer once more
  why           why this answer
  speak         the answer aloud, by this machine; again: stop
  save          the answer as a card and as JSON, its picture as PNG
  copy          the answer, to the clipboard
  undo          take back what was taught last
  /forget       wipe the questions of this and earlier chats
  help          these lines
  quit          leave; so does the end of the input, or Ctrl+C twice"""
SHOWN = 3
PAGE = 10
STOPPED = "Answer: Stopped. Ask again, or something else."
_WORDS = ("more", "undo")
"""Commands that need no slash here, beside those that need none anywhere."""
_SAYINGS = tuple(name for name, command in COMMANDS.items() if command.says)
_HERE = ("help", "more", "why", "speak", "save", "copy", "box", *_SAYINGS, "forget", "quit")


@dataclass(slots=True)
class PlainChat:
    """A conversation over lines; holds the last answer, for `more`, `why`, `save` and 1 to 9.

    echoes: say what was asked, too, where it was not typed here. saves: the folder of `save`.
    """

    session: Session
    say: Callable[[str], None]
    echoes: bool = True
    history: History = field(default_factory=History)
    voice: Voice = field(default_factory=Voice)
    saves: Path = Path("d3a-saved")
    _answer: Answer | None = None
    _listed: int = 0

    def welcome(self) -> None:
        """Say whose memory this is, how fresh, and what may be asked."""
        self.say(f"The memory of {clean(self.session.title)}{self._freshness()}.")
        self.say("Type a question, help or quit.")
        for question in starters(self.session):
            if question is not None:
                self.say(f"For example: {clean(question)}")

    def _freshness(self) -> str:
        now = self.session.now()
        try:
            newest_ms = self.session.store.last_view_ms()
        except D3AError as error:
            return f", which I cannot reach: {clean(str(error))}"
        if newest_ms is None:
            return ", which has seen nothing yet"
        newest = from_ms(newest_ms, now)
        return f", up to {short_time(newest, now)}, {ago(newest, now)}. Times: {now.tzinfo}"

    def hear(self, line: str) -> bool:
        """Answer one line; False when the person is done."""
        text = " ".join(clean(line).split())
        word = bare(text) or (text.lower() if text.lower() in _WORDS else None)
        if word is not None or text.startswith("/"):
            return self._do(word or text[1:].lower(), text)
        if text.isascii() and text.isdigit() and not self._offers():
            self._details(int(text))
        elif text:
            if not text.isdigit():  # a choice is no question
                self.history.add(text)
            self._reply(text)
        return True

    def _do(self, word: str, typed: str) -> bool:
        """Do what a command names; False when the person is done."""
        command = COMMANDS.get(word)
        done: dict[str, Callable[[], None]] = {
            "help": lambda: self.say(HELP),
            "more": self._more,
            "why": self._why,
            "speak": self._speak,
            "save": self._save,
            "copy": self._copy,
            "forget": lambda: self.say(f"Answer: {self.history.forget()}"),
            "box": lambda: self.say(f"Answer: {BOX_USAGE}"),
        }
        if word in ("quit", "exit"):
            return False
        if word in done:
            done[word]()
        elif word.startswith("box "):
            self._reply(word, typed)
        elif command is not None and command.says:
            self._reply(command.says)
        elif command is not None:
            self.say(f"Answer: /{word} needs the full screen. Here: {slashed(_HERE)}")
        else:
            self.say(f"Answer: {unknown(word, _HERE)}")
        return True

    def _offers(self) -> bool:
        """Whether the answer before offers readings to choose from by their numbers."""
        answer = self._answer
        if answer is None or (answer.keyframes and answer.query is not None):
            return False
        return bool(answer.suggestions)

    def _reply(self, text: str, typed: str = "") -> None:
        answer = self.session.safely(text)
        self._answer, self._listed = answer, 0
        if self.echoes or text.isdigit():
            self.say(f"You: {answer.text if text.isdigit() else typed or text}")
        sentence, reason = told(answer)
        self.say(f"Answer: {clean(sentence)}")
        if reason:
            self.say(f"Reason: {clean(reason)}")
        if answer.query is not None:  # what was taught leaves the list as it was heard
            self._list(SHOWN)
        for keyframe in () if answer.keyframes else answer.instead[:SHOWN]:
            row = ", ".join(keyframe_row(keyframe, self.session.now()))
            self.say(f"{'Maybe' if answer.perhaps else 'Instead'}: {row}")
        if answer.status == "error":
            self.say("Type again to ask it again.")
            return
        for number, suggestion in enumerate(answer.suggestions, 1):
            self.say(f"Did you mean, {number}: {clean(suggestion)}")

    def _list(self, count: int) -> None:
        """Say so many rows more, and how many are left."""
        keyframes = self._answer.keyframes if self._answer else ()
        first, self._listed = self._listed, min(self._listed + count, len(keyframes))
        for keyframe in keyframes[first : self._listed]:
            self.say(self._row(keyframe))
        if self._listed < len(keyframes):
            self.say(f"{len(keyframes) - self._listed} more: type more")
        elif first and self._answer is not None and self._answer.truncated:
            self.say(f"The list stops at {len(keyframes)}; there are more.")

    def _row(self, keyframe: RankedKeyframe) -> str:
        count = len(self._answer.keyframes) if self._answer else 0
        row = ", ".join(keyframe_row(keyframe, self.session.now()))
        return f"{keyframe.rank} of {count}: {row}"

    def _more(self) -> None:
        keyframes = self._answer.keyframes if self._answer else ()
        if self._listed >= len(keyframes):
            self.say("Answer: There is no more.")
        else:
            self._list(PAGE)

    def _details(self, rank: int) -> None:
        keyframes = self._answer.keyframes if self._answer else ()
        if not 1 <= rank <= len(keyframes):
            has = f"the list has {len(keyframes)}" if keyframes else "nothing is listed yet"
            self.say(f"Answer: There is no {rank}; {has}.")
            return
        keyframe = keyframes[rank - 1]
        self.session.pointer.to(keyframe)
        self.say(self._row(keyframe))
        self.say(f"Frame {clean(keyframe.frame)}, object {clean(keyframe.object_id)}.")

    def _meant(self, answer: Answer) -> RankedKeyframe | None:
        """Return the row that is pointed at, else the best."""
        row = self.session.pointer.row
        return row if row in answer.keyframes else next(iter(answer.keyframes), None)

    def _asked(self) -> Answer | None:
        """Return the last answer; say so where there is none."""
        if self._answer is None:
            self.say("Answer: Ask a question first.")
        return self._answer

    def _why(self) -> None:
        if (answer := self._asked()) is not None:
            steps = self.session.explained(answer.text)
            self.say(clean_lines(why_text(answer, self._meant(answer), steps, aloud=True)))

    def _speak(self) -> None:
        if (answer := self._asked()) is not None:
            self.say(f"Answer: {self.voice.say(answer.answer or answer.message or '')}")

    def _save(self) -> None:
        if (answer := self._asked()) is None:
            return
        keyframe = self._meant(answer)
        try:
            key = keyframe.image if keyframe else None
            picture = self.session.store.keyframe(key) if key else None
        except D3AError as error:
            self.say(f"Answer: {clean(str(error))}")
            return
        words, _ = saved(answer, keyframe, picture, self.saves, self.session.now())
        self.say(f"Answer: {clean(words)}")

    def _copy(self) -> None:
        if (answer := self._asked()) is not None:
            text = answer_text(answer, self.session.now())
            self.say(f"Answer: {clean(copied(text, self.saves, by_terminal=False))}")


def talk(chat: PlainChat, lines: Iterable[str]) -> None:
    """Hold a conversation until `quit` or the end of the lines; Ctrl+C stops an answer alone."""
    for line in lines:
        try:
            if not chat.hear(line):
                return
        except KeyboardInterrupt:
            if chat.echoes:  # nobody sits there: it is the program that was meant
                raise
            chat.say(STOPPED)


def wrapped(text: str, width: int) -> str:
    """Return text broken between words, as terminals and screen readers do not."""
    return "\n".join(
        textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False)
        if len(line) > width
        else line
        for line in text.split("\n")
    )
