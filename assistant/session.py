"""What a conversation needs, with or without a full screen: a store, and a way to ask it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from typing import TYPE_CHECKING

from assistant.taught import is_lesson
from d3a.answer import Answer, RankedKeyframe
from d3a.store.base import StoreError
from grammar.errors import QuestionError

if TYPE_CHECKING:
    from d3a.model import Box
    from d3a.store.base import Store

Ask = Callable[[str], Answer]


@dataclass(slots=True)
class Pointer:
    """What the person points at: the row under the mark, which the screen and the talk share.

    box: drawn on its picture by the person, in pixels of the original frame; None for none.
    """

    row: RankedKeyframe | None = None
    box: Box | None = None

    def to(self, row: RankedKeyframe | None) -> None:
        """Point at a row; a box that was drawn on another picture is no longer meant."""
        if row is None or self.row is None or row.image != self.row.image:
            self.box = None
        self.row = row


@dataclass(frozen=True, slots=True)
class Session:
    """A store and the functions that answer from it, bound to it.

    ask: a question's answer, after what was said before. alone: the same by itself, None where
    that is all one. explain: formal query, plan and native queries of an answer, as text.
    now: the moment to ask at, in the home's zone: a function, as a chat lasts. title: of the home.
    teaches: whether a saying is to be done even where nobody waits for its answer. pointer: what
    "these" means, when something is taught.
    """

    store: Store = field(repr=False)
    ask: Ask
    explain: Callable[[str], str]
    now: Callable[[], datetime]
    title: str = "home"
    suggestions: tuple[str, ...] = ()
    alone: Ask | None = None
    teaches: Callable[[str], bool] = is_lesson
    pointer: Pointer = field(default_factory=Pointer)

    def safely(self, text: str, *, alone: bool = False) -> Answer:
        """Ask, and let whatever fails be an answer that names it: a chat goes on after it.

        alone: neither after what was said before, nor to be followed up.
        """
        try:
            return self.alone(text) if alone and self.alone else self.ask(text)
        except StoreError as error:
            words = "I cannot reach my memory just now. Ask again in a moment."
            return Answer(
                text=text, status="error", answer=words, message=str(error), suggestions=(text,)
            )
        except Exception as error:  # a chat outlives a defect, and shows it
            words = "Something in me is broken; this question did not work."
            name = type(error).__name__
            return Answer(text=text, status="error", answer=words, message=f"{name}: {error}")

    def explained(self, text: str) -> str:
        """Return why a question has its answer, or why that cannot be told."""
        try:
            return self.explain(text)
        except (QuestionError, StoreError) as error:
            return str(error)
        except Exception as error:  # as above
            return f"{type(error).__name__}: {error}"


def known_words(store: Store) -> tuple[str, ...]:
    """Return what the store can be asked about, commonest first: categories, names, places."""
    categories = sorted(store.categories(), key=lambda pair: (-pair[1], pair[0]))
    named = {name.word for name in store.names()}
    return (
        *(category for category, _ in categories),
        *sorted(named),
        *(region.name for region in store.regions()),
    )
