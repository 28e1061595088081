"""The Python API: `d3a.open(store)` gives a memory to ask, in words or by formal queries.

    >>> import d3a
    >>> with d3a.open(home) as memory:
    ...     answer = memory.ask("Where is the red cup?", now="2026-05-14T20:30+01:00")
    >>> answer.status
    'found'

It is here and not in the package `d3a`, because questions in words need the grammar; `d3a.open`
loads it when it is first used.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Literal

from assistant import asking
from assistant.tense import as_of_now
from d3a.answer import Answer
from d3a.facts import Facts
from d3a.plan import Plan, plan
from d3a.store import open_store
from d3a.store.base import Keyframe, ObjectRecord, Store
from grammar.forms import FormalQuery

Now = datetime | str | None
"""A time, an ISO text, "last" for the newest frame's; None: the store's own, else the clock."""


def open(store: str | Path, *, create: bool = False) -> Memory:  # noqa: A001  d3a.open is its name
    """Open a store to ask it: a file, `sqlite:///...` or `mongodb://...`.

    create: make it where there is none. Raises d3a.StoreError (StoreUnreachable where it cannot be
    opened); passwords in the address are never shown.
    """
    return Memory(open_store(str(store), create=create))


class Memory:
    """A robot's memory: objects, and answers with the keyframes that prove them.

    Use it as a context manager, or `close` it. Threads may share it. `store` is the store itself.
    """

    def __init__(self, store: Store) -> None:
        self.store = store

    def __enter__(self) -> Memory:
        """Return the memory."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the store."""
        self.close()

    def __repr__(self) -> str:
        """Return the address, passwords masked."""
        return f"<d3a.Memory of {self.store.uri}>"

    def close(self) -> None:
        """Release the store."""
        self.store.close()

    def ask(
        self,
        question: str | FormalQuery,
        *,
        now: Now = None,
        limit: int = 50,
        precision: str | None = None,
    ) -> Answer:
        """Answer a question: words, the formal notation, or a FormalQuery.

        precision: "perfect", "category", "attribute" or "any" forces a rung of the ladder on which
        words are matched. A question that cannot be understood and a store that fails are answers
        with their `status`; ValueError for an unknown precision or a `now` that is no time.
        """
        moment = self.now(now)
        if isinstance(question, str):
            return asking.ask(self.store, question, now=moment, limit=limit, precision=precision)
        return asking.ask_query(self.store, question, now=moment, limit=limit, precision=precision)

    def query(self, question: str, *, now: Now = None) -> FormalQuery:
        """Return the formal query of a question. Raises grammar.QuestionError where it has none."""
        return asking.read_question(self.store, question, now=self.now(now))

    def plan(self, question: str | FormalQuery, *, now: Now = None) -> Plan:
        """Return the steps by which a question is answered; nothing is asked of OIc and STc."""
        query = self.query(question, now=now) if isinstance(question, str) else question
        return plan(as_of_now(query), parameters=Facts(self.store).parameters())

    def explain(self, question: str | FormalQuery, *, now: Now = None) -> asking.Explanation:
        """Answer a question and tell how: plan, native queries with index and rows, times."""
        return asking.explain(self.store, question, now=self.now(now))

    def objects(
        self, *, categories: Sequence[str] | None = None, names: Sequence[str] | None = None
    ) -> list[ObjectRecord]:
        """Return the objects of OIc by id; categories, names: exactly, and-ed."""
        return self.store.objects(categories=categories, names=names)

    def keyframe(self, image: str) -> Keyframe | None:
        """Return the stored picture behind a keyframe's `image`, None where there is none."""
        return self.store.keyframe(image)

    def now(self, given: Now = None) -> datetime:
        """Return the moment that a question is asked at, in the home's zone."""
        last: Literal["last"] | datetime | None
        if given == "last":
            last = "last"
        else:
            last = datetime.fromisoformat(given) if isinstance(given, str) else given
        return asking.store_now(self.store, last, _clock)


def _clock() -> datetime:
    return datetime.now(UTC)
