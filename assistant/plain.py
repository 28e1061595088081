"""The chat a line at a time: for screen readers, pipes, TERM=dumb and bad links.

No borders, no colours, no glyphs that a screen reader would spell; the cursor stays where the
person types. The same session answers as in the full-screen chat.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TextIO

from assistant.session import Session
from assistant.slashes import BOX_USAGE, COMMANDS, bare, slashed, unknown
from assistant.starters import starters
from assistant.terminal import clean, clean_lines
from assistant.wording import keyframe_row, more_words, told
from d3a.answer import Answer

HELP = """Type a question, and Enter. Also:
  1, 2, 3 ...   more of that answer's keyframe, or the one of several readings
  more          the rest of the list
  why           why this answer
  undo          take back what was taught last
  help          these lines
  quit          leave; so does the end of the input"""
SHOWN = 3
_WORDS = ("more", "undo")
"""Commands that need no slash here, beside those that need none anywhere."""
_SAYINGS = tuple(name for name, command in COMMANDS.items() if command.says)
_HERE = ("help", "more", "why", "box", *_SAYINGS, "quit")


class PlainChat:
    """A conversation over two text streams; holds the last answer, for `more`, `why` and 1 to 9."""

    def __init__(self, session: Session, say: Callable[[str], None]) -> None:
        self._session = session
        self._say = say
        self._answer: Answer | None = None

    def welcome(self) -> None:
        """Say whose memory this is and what may be asked."""
        self._say(f"The memory of {clean(self._session.title)}. Type a question, help or quit.")
        for question in starters(self._session):
            if question is not None:
                self._say(f"For example: {clean(question)}")

    def hear(self, line: str) -> bool:
        """Answer one line; False when the person is done."""
        text = clean(line).strip()
        word = bare(text) or (text.lower() if text.lower() in _WORDS else text[1:].lower())
        if bare(text) or text.lower() in _WORDS or text.startswith("/"):
            return self._do(word, text)
        if text.isascii() and text.isdigit() and not self._offers():
            self._details(int(text))
        elif text:
            self._reply(text)
        return True

    def _do(self, word: str, typed: str) -> bool:
        """Do what a command names; False when the person is done."""
        command = COMMANDS.get(word)
        if word in ("quit", "exit"):
            return False
        if word == "help":
            self._say(HELP)
        elif word == "more":
            self._list(SHOWN)
        elif word == "why":
            self._why()
        elif word.startswith("box "):
            self._reply(word, typed)
        elif word == "box":
            self._say(f"Answer: {BOX_USAGE}")
        elif command is not None and command.says:
            self._reply(command.says)
        elif command is not None:
            self._say(f"Answer: /{word} needs the full screen. Here: {slashed(_HERE)}")
        else:
            self._say(f"Answer: {unknown(word, _HERE)}")
        return True

    def _offers(self) -> bool:
        """Whether the answer before offers readings to choose from by their numbers."""
        answer = self._answer
        if answer is None or (answer.keyframes and answer.query is not None):
            return False
        return bool(answer.suggestions)

    def _reply(self, text: str, typed: str = "") -> None:
        answer = self._session.safely(text)
        self._answer = answer
        self._say(f"You: {answer.text if text.isdigit() else typed or text}")
        sentence, reason = told(answer)
        self._say(f"Answer: {clean(sentence)}")
        if reason:
            self._say(f"Reason: {clean(reason)}")
        if answer.query is not None:  # what was taught leaves the list as it was heard
            self._list(0, SHOWN)
        for keyframe in () if answer.keyframes else answer.instead[:SHOWN]:
            row = ", ".join(keyframe_row(keyframe, self._session.now()))
            self._say(f"{'Maybe' if answer.perhaps else 'Instead'}: {row}")
        if answer.status == "error":
            self._say("Type again to ask it again.")
            return
        for number, suggestion in enumerate(answer.suggestions, 1):
            self._say(f"Did you mean, {number}: {clean(suggestion)}")

    def _list(self, first: int, last: int | None = None) -> None:
        keyframes = self._answer.keyframes if self._answer else ()
        now = self._session.now()
        for keyframe in keyframes[first:last]:
            row = ", ".join(keyframe_row(keyframe, now))
            self._say(f"{keyframe.rank} of {len(keyframes)}: {row}")
        if last is not None and len(keyframes) > last:
            self._say(f"{len(keyframes) - last} more: type more")
        if first and len(keyframes) <= first:
            self._say("Answer: There is no more.")
        elif last is None and self._answer is not None and self._answer.truncated:
            self._say(more_words(self._answer))

    def _details(self, rank: int) -> None:
        keyframes = self._answer.keyframes if self._answer else ()
        if not 1 <= rank <= len(keyframes):
            has = f"the list has {len(keyframes)}" if keyframes else "nothing is listed yet"
            self._say(f"Answer: There is no {rank}; {has}.")
            return
        keyframe = keyframes[rank - 1]
        self._session.pointer.to(keyframe)
        self._say(
            f"{rank} of {len(keyframes)}: {', '.join(keyframe_row(keyframe, self._session.now()))}"
        )
        self._say(f"Frame {clean(keyframe.frame)}, object {clean(keyframe.object_id)}.")

    def _why(self) -> None:
        if self._answer is None:
            self._say("Answer: Ask a question first.")
            return
        self._say(clean_lines(self._session.explained(self._answer.text)))


def lines_of(stream: TextIO, prompt: Callable[[], None]) -> Iterator[str]:
    """Yield the lines of `stream`, after `prompt` was called for each."""
    while True:
        prompt()
        line = stream.readline()
        if not line:
            return
        yield line


def talk(session: Session, stdin: TextIO, stdout: TextIO, *, ask_for_lines: bool) -> None:
    """Hold a conversation until `quit` or the end of the input.

    ask_for_lines: print a prompt, where a person types.
    """

    def say(line: str) -> None:
        stdout.write(line + "\n")
        stdout.flush()

    def prompt() -> None:
        if ask_for_lines:
            stdout.write("Ask: ")
            stdout.flush()

    chat = PlainChat(session, say)
    if ask_for_lines:
        chat.welcome()
    for line in lines_of(stdin, prompt):
        if not chat.hear(line):
            return
