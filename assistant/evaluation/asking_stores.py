"""Put a question to a filled store as each method's authors would: the paper's way, or ours.

Both ways go through the grammar and the planner; the paper's differs in what Q2 returns and in
the order of keyframes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime
from time import perf_counter

from assistant.asking import store_parameters, store_words
from assistant.evaluation.methods import Filled
from assistant.evaluation.questions import Level
from assistant.lexicon import VocabularyLexicon
from d3a.answer import Answer, RankedKeyframe
from d3a.execute import execute
from d3a.metrics import CUT
from d3a.plan import (
    FindObjects,
    FindSightings,
    FindStays,
    JudgeAttributes,
    Plan,
    Precision,
    Rank,
    Relate,
    plan,
)
from grammar import FormalQuery, QuestionError, parse_report

FORCED: dict[Level, Precision] = {
    "perfect": "perfect",
    "category": "category",
    "attribute": "attribute",
    "any": "any",
}
EVERYTHING = 1_000_000
"""Keyframes asked for where the method arranges them itself, as the paper's do: all."""
RETRIEVING = (FindObjects, JudgeAttributes, FindSightings, FindStays, Relate, Rank)
"""The steps of retrieval and ranking; the rest tells a person more about what was found."""


class Asker:
    """Asks one store. now: aware, in the home's zone."""

    def __init__(self, run: Filled, now: datetime) -> None:
        self._run, self._now = run, now
        self._words = store_words(run.store)
        self._parameters = store_parameters(run.store)
        self._lexicon = VocabularyLexicon()

    def ask(self, text: str, level: Level, *, whole: bool = False) -> tuple[Answer, float]:
        """Return the arranged answer and the milliseconds that parsing took.

        whole: with all keyframes, for whoever puts them into another order, and not only as many
        as a person is shown.

        At Perfect, a name that could not be taught, as no ObjectID holds the object, is a word
        that the grammar does not know: an empty answer, and so a miss. Raises QuestionError at
        any other level, StoreError where the store fails.
        """
        before = perf_counter()
        try:
            parsed = parse_report(text, now=self._now, words=self._words)
        except QuestionError:
            if level != "perfect":
                raise
            return Answer(text=text, status="unknown_object"), _ms_since(before)
        parse_ms = _ms_since(before)
        if level == "perfect" and parsed.corrections:  # read as the name of another object
            return Answer(text=text, status="unknown_object"), parse_ms
        query = parsed.query
        if self._run.method.is_papers:
            return self._the_papers_way(query, level), parse_ms
        if self._run.method.kind == "tiers" and not whole:
            return self._execute(query, level, CUT * max(1, len(query.objects))), parse_ms
        return self._run.method.arrange(self._execute(query, level)), parse_ms

    def _execute(self, query: FormalQuery, level: Level, limit: int = EVERYTHING) -> Answer:
        steps = plan(query, parameters=self._parameters, precision=FORCED[level])
        kept = tuple(step for step in steps.steps if isinstance(step, RETRIEVING))
        return execute(
            Plan(steps.query, kept),
            self._run.store,
            self._lexicon,
            now=self._now,
            limit=limit,
            parameters=self._parameters,
        )

    def _the_papers_way(self, query: FormalQuery, level: Level) -> Answer:
        """Return the union of what is found for each object, by the keyframes' probability.

        The paper's Any rows return as much for Q2 as for Q1: its “together” is a union.
        """
        if query.relation is None:
            return by_probability([self._execute(query, level)])
        alone = [
            replace(query, form="Q1", objects=(term,), relation=None) for term in query.objects
        ]
        return by_probability([self._execute(one, level) for one in alone])


def by_probability(answers: Iterable[Answer]) -> Answer:
    """Return the answers as one, each keyframe once, ordered by its detection's probability.

    Paper: "returned frames ordered by their probability of correctness", the keyframe being "the
    frame with the highest detection probability". A colour that was asked for weighs in, as the
    paper leaves open how. Ties go by time, then by id.
    """
    once: dict[tuple[str, str, datetime], RankedKeyframe] = {}
    first: Answer | None = None
    for answer in answers:
        first = first or answer
        for keyframe in answer.keyframes:
            once.setdefault((keyframe.object_id, keyframe.frame, keyframe.start), keyframe)
    ordered = sorted(once.values(), key=lambda k: (-_worth(k), k.start, k.object_id))
    keyframes = tuple(replace(k, rank=n, group=None) for n, k in enumerate(ordered, 1))
    return replace(first or Answer(), keyframes=keyframes)


def _worth(keyframe: RankedKeyframe) -> float:
    colours: dict[str, float] = keyframe.why.get("attributes", {})
    return keyframe.probability * math.prod(colours.values())


def _ms_since(started: float) -> float:
    return (perf_counter() - started) * 1000
