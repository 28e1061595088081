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

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Literal

from assistant import asking
from assistant.explanation import Explanation
from assistant.tense import planned
from d3a.answer import Answer
from d3a.answering.facts import Facts
from d3a.model import BadInput
from d3a.plan import Plan
from d3a.store import open_store
from d3a.store.base import Keyframe, ObjectRecord, Store
from grammar.errors import QuestionError
from grammar.forms import FormalQuery, FormError

_TIMES = 'a time, an ISO text such as 2026-05-14T20:30+01:00 or "last" would do'
Question = str | FormalQuery | Mapping[str, Any]
"""Words or the formal notation; a formal query, or the JSON record of one."""
Now = datetime | str | None
"""A time, an ISO text, "last" for the newest frame's; None: the store's own, else the clock."""


def open(store: str | Path, *, create: bool = False) -> Memory:  # noqa: A001  d3a.open is its name
    """Open a store to ask it: a file, `sqlite:///...` or `mongodb://...`.

    create: make it where there is none. Raises d3a.StoreError (StoreUnreachable where it cannot be
    opened); passwords in the address are never shown.
    """
    return Memory(open_store(str(store), create=create))


class BadQuestion(BadInput):
    """A question that has no formal query; `error` is the grammar's, with position and kind."""

    def __init__(self, error: QuestionError) -> None:
        super().__init__(str(error))
        self.error = error


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
        question: Question,
        *,
        now: Now = None,
        limit: int = 50,
        precision: str | None = None,
    ) -> Answer:
        """Answer a question: words, the formal notation, a FormalQuery, or its JSON record.

        limit: the most keyframes, from 1. precision: "perfect", "category", "attribute" or "any"
        forces a rung of the ladder on which words are matched. A question that cannot be understood
        and a store that fails are answers with their `status`; BadInput is raised for the rest:
        what is no question, no time, no precision, no limit.
        """
        if isinstance(limit, bool) or not isinstance(limit, int) or limit < 1:
            raise BadInput(f"limit is {limit!r}; it must be a whole number from 1")
        moment, asked = self.now(now), _asked(question)
        if isinstance(asked, str):
            return asking.ask(self.store, asked, now=moment, limit=limit, precision=precision)
        return asking.ask_query(self.store, asked, now=moment, limit=limit, precision=precision)

    def query(self, question: Question, *, now: Now = None) -> FormalQuery:
        """Return the formal query of a question. Raises BadQuestion where it has none."""
        asked, moment = _asked(question), self.now(now)
        if not isinstance(asked, str):
            return asked
        try:
            return asking.read_question(self.store, asked, now=moment)
        except QuestionError as error:
            raise BadQuestion(error) from error

    def plan(self, question: Question, *, now: Now = None) -> Plan:
        """Return the steps by which a question is answered; nothing is asked of OIc and STc.

        Raises BadQuestion.
        """
        query = self.query(question, now=now)
        return planned(query, Facts(self.store).parameters())

    def explain(
        self, question: Question, *, now: Now = None, precision: str | None = None
    ) -> Explanation:
        """Answer a question and tell how: plan, native queries with index and rows, times.

        Raises BadQuestion.
        """
        moment, asked = self.now(now), _asked(question)
        try:
            return asking.explain(self.store, asked, now=moment, precision=precision)
        except QuestionError as error:
            raise BadQuestion(error) from error

    def objects(
        self,
        *,
        categories: Sequence[str] | str | None = None,
        names: Sequence[str] | str | None = None,
    ) -> list[ObjectRecord]:
        """Return the objects of OIc by id; categories, names: exactly, one or several, and-ed."""
        return self.store.objects(
            categories=_words("categories", categories), names=_words("names", names)
        )

    def keyframe(self, image: str) -> Keyframe | None:
        """Return the stored picture behind a keyframe's `image`, None where there is none."""
        if not isinstance(image, str):
            raise BadInput(f"image is {image!r}; the `image` of a keyframe that has one would do")
        return self.store.keyframe(image)

    def now(self, given: Now = None) -> datetime:
        """Return the moment that a question is asked at, in the home's zone.

        Raises BadInput for what is no time.
        """
        moment = _moment(given)
        try:
            return asking.store_now(self.store, moment, _clock)
        except OverflowError as error:
            raise BadInput(f"now is {given!r}; {_TIMES}") from error


def _moment(given: object) -> datetime | Literal["last"] | None:
    """Return what `now` says; raise BadInput for what is no time."""
    if given is None or isinstance(given, datetime):
        return given
    if given == "last":
        return "last"
    try:
        return datetime.fromisoformat(str(given))
    except ValueError as error:
        raise BadInput(f"now is {given!r}; {_TIMES}") from error


def _asked(question: object) -> str | FormalQuery:
    """Return words and formal queries as they are, and the query of a record."""
    if isinstance(question, str | FormalQuery):
        return question
    if not isinstance(question, Mapping):
        raise BadInput(
            f"the question is {question!r}; words, a FormalQuery or its JSON record would do"
        )
    try:
        return FormalQuery.from_json(question)
    except FormError as error:
        raise BadInput(f"the question is a record that cannot be read: {error}") from error


def _words(field: str, given: object) -> list[str] | None:
    """Return the words of a filter; one word alone is a list of it."""
    if given is None:
        return None
    words = [given] if isinstance(given, str) else given
    if not isinstance(words, Sequence) or not all(isinstance(word, str) for word in words):
        raise BadInput(f"{field} is {given!r}; a word or a list of words would do")
    return list(words)


def _clock() -> datetime:
    return datetime.now(UTC)
