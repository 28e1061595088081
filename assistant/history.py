"""The questions of earlier chats, in a file of their owner's alone."""

from __future__ import annotations

import json
from pathlib import Path

KEPT = 500


class History:
    """Questions, oldest first; kept in a file where one is given, else for this chat only.

    A file that cannot be read or written costs the history, never the chat: `problem` says why.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        self._questions: list[str] = []
        self._to_be_wiped = False
        self.problem: str | None = None
        if path is not None:
            self._load(path)

    @property
    def questions(self) -> tuple[str, ...]:
        """Every question once, oldest first, at the place of its latest asking."""
        return tuple(self._questions)

    def add(self, question: str) -> None:
        """Keep a question; one that was asked before moves to the end."""
        self._to_be_wiped = False
        if question in self._questions:
            self._questions.remove(question)
        self._questions.append(question)
        del self._questions[:-KEPT]
        if self._path is None:
            return
        try:
            self._path.touch(mode=0o600, exist_ok=True)
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(question) + "\n")
        except OSError as error:
            self.problem = f"questions are not kept: {error.strerror}"

    def forget(self) -> str:
        """Wipe the questions when this is said twice in a row; return what is to be told."""
        if self._questions and not self._to_be_wiped:
            self._to_be_wiped = True
            count = len(self._questions)
            what = "The one question" if count == 1 else f"All {count} questions"
            return f"{what} of this and earlier chats? Say /forget again to wipe them for good."
        self._to_be_wiped = False
        self.wipe()
        return self.problem or "The questions are forgotten."

    def wipe(self) -> None:
        """Forget every question, in the file too."""
        self._questions.clear()
        if self._path is not None:
            try:
                self._path.unlink(missing_ok=True)
            except OSError as error:
                self.problem = f"the history {self._path} cannot be removed: {error.strerror}"

    def _load(self, path: Path) -> None:
        try:
            lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
        except FileNotFoundError:
            return
        except OSError as error:
            self.problem = f"the history {path} cannot be read: {error.strerror}"
            return
        for line in lines[-4 * KEPT :]:
            try:
                question = json.loads(line)
            except ValueError:  # a line that a full disk cut short
                continue
            if isinstance(question, str):
                if question in self._questions:
                    self._questions.remove(question)
                self._questions.append(question)
        del self._questions[:-KEPT]
        if len(lines) > 2 * KEPT:
            self._rewrite(path)

    def _rewrite(self, path: Path) -> None:
        try:
            path.write_text("".join(json.dumps(q) + "\n" for q in self._questions), "utf-8")
        except OSError as error:
            self.problem = f"questions are not kept: {error.strerror}"
