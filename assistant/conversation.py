"""A conversation with one store: each question is understood after the one before it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from time import perf_counter

from assistant.asking import ask, ask_query, explain, failure, refusal, store_words
from assistant.dialogue import follow
from d3a.answer import Answer
from d3a.store.base import Store, StoreError
from grammar.errors import QuestionError
from grammar.forms import FormalQuery
from grammar.notation import looks_formal, write


class Conversation:
    """Asks a store, and keeps the last query that it understood for "and yesterday?".

    now: the moment to ask at, in the home's zone. One thread at a time.
    """

    def __init__(self, store: Store, now: Callable[[], datetime]) -> None:
        self._store = store
        self._now = now
        self._last: FormalQuery | None = None
        self._seen_at: datetime | None = None

    def ask(self, text: str) -> Answer:
        """Answer a question or a follow-up. What cannot be answered is an answer with its status.

        A question that was not understood, or is about a thing that nobody knows, leaves the one
        before it in force.
        """
        answer = self._answer(text)
        if answer.query is not None and answer.status in ("found", "not_found"):
            self._last = answer.query
            best = answer.keyframes[0] if answer.keyframes else answer.otherwise
            self._seen_at = best.end if best else None
        return answer

    def _answer(self, text: str) -> Answer:
        started, now = perf_counter(), self._now()
        if looks_formal(text):
            return ask(self._store, text, now=now)
        try:
            words = store_words(self._store)
            query = follow(text, now=now, words=words, last=self._last, seen_at=self._seen_at)
        except QuestionError as error:
            return refusal(error)
        except StoreError as error:
            return failure(text, error)
        parse_ms = (perf_counter() - started) * 1000
        answer = ask_query(self._store, query, now=now)
        elapsed = {"parse": parse_ms} | answer.elapsed_ms
        return replace(answer, elapsed_ms=elapsed | {"total": (perf_counter() - started) * 1000})

    def alone(self, text: str) -> Answer:
        """Answer a question by itself: neither after nor before another."""
        return ask(self._store, text, now=self._now())

    def explain(self, text: str) -> str:
        """Return the query, plan and native queries of what was asked last, else of `text`.

        Raises QuestionError and StoreError.
        """
        if self._last is not None and self._last.text == text:
            text = write(self._last)
        return explain(self._store, text, now=self._now()).to_text()
