"""Questions without a formal query, and what the person may say instead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from grammar.forms import FormalQuery, Json


@dataclass(eq=False)
class QuestionError(Exception):
    """A question without a formal query; OutOfScope, NotUnderstood and Ambiguous derive from it.

    text: the question. position: offset in `text` of the first character that was not read.
    reason: one plain sentence. suggestions: up to three questions that do parse.
    """

    kind: ClassVar[str] = "not_understood"
    text: str
    position: int
    reason: str
    suggestions: tuple[str, ...] = ()

    def __str__(self) -> str:
        hint = f" Did you mean: {self.suggestions[0]}" if self.suggestions else ""
        return f"{self.reason}{hint}"

    def to_json(self) -> Json:
        """Return the error object of formal-query."""
        return {
            "text": self.text,
            "error": self.kind,
            "message": str(self),
            "position": self.position,
            "suggestions": list(self.suggestions),
        }


@dataclass(eq=False)
class NotUnderstood(QuestionError):
    """No rule reads the question; `position` is where reading stopped."""

    kind: ClassVar[str] = "not_understood"


@dataclass(eq=False)
class OutOfScope(QuestionError):
    """The question is clear, but a memory of sightings cannot answer it."""

    kind: ClassVar[str] = "out_of_scope"


@dataclass(eq=False)
class Ambiguous(QuestionError):
    """Two fair readings change the answer; `readings` holds both, `suggestions` spells them out."""

    kind: ClassVar[str] = "ambiguous"
    readings: tuple[FormalQuery, ...] = ()
