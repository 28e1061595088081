"""Ask a store the questions of its world and judge what comes back against the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from time import perf_counter
from typing import Literal
from zoneinfo import ZoneInfo

import numpy as np

from assistant.evaluation.asking_stores import Asker
from assistant.evaluation.methods import Filled
from assistant.evaluation.questions import FORMS, LEVELS, Form, Level, Question
from d3a.answer import Answer, RankedKeyframe
from d3a.baselines import Moment, moments_of
from d3a.metrics import CUT, Rows, Score, ceiling, first_right
from d3a.truth import Truth
from grammar import QuestionError

Reading = Literal["strict", "frame"]
"""What counts as found. strict: the keyframe's own box is the asked object (Q2: both asked objects
were detected in its frame). frame: the asked object was detected anywhere in the frame, which is
what the paper's figures need to be matched."""
READINGS: tuple[Reading, ...] = ("strict", "frame")


@dataclass(frozen=True, slots=True)
class Judged:
    """One query at one level, answered and judged.

    scores: by reading. inside: the first right keyframe (strict) lies in the asked slice; of Q3
    alone. ceiling: best MRR to be had without knowing which look-alike was meant. empty: nothing
    was returned. retrieval_ms: plan, store and ranking; evaluation_ms: matching against the truth.
    """

    form: Form
    level: Level
    scores: dict[Reading, Score]
    ceiling: float
    negative: bool
    empty: bool
    inside: bool | None
    parse_ms: float
    retrieval_ms: float
    evaluation_ms: float
    refused: str | None = None


@dataclass(frozen=True, slots=True)
class Cell:
    """A row of the Exp 2 table: one form at one level, over the positive queries of a world."""

    form: Form
    level: Level
    queries: int
    miss: dict[Reading, float]
    mrr: dict[Reading, float]
    frames: float
    ids: float
    ceiling: float
    miss_inside: float | None
    retrieval_ms: float
    retrieval_p95_ms: float
    evaluation_ms: float


class Judge:
    """Asks one filled store; `truth` is of the recording that filled it."""

    def __init__(self, run: Filled, truth: Truth, zone: ZoneInfo) -> None:
        self._truth = truth
        self._rows = Rows(truth)
        self._asker = Asker(run, datetime.fromtimestamp(truth.span_ms[1] / 1000, zone))

    def ask_all(self, questions: Sequence[Question]) -> list[Judged]:
        """Ask every question at every level it has words for; one that is refused is a miss."""
        return [
            self._ask_or_miss(question, level)
            for question in questions
            for level in LEVELS
            if level in question.texts
        ]

    def _ask_or_miss(self, question: Question, level: Level) -> Judged:
        before = perf_counter()
        try:
            return self.ask(question, level)
        except QuestionError as error:
            parse_ms = (perf_counter() - before) * 1000
            missed = self._judged(question, level, Answer(text=error.text), parse_ms, 0.0)
            return replace(missed, refused=f"“{error.text}”: {error.reason}")

    def ask(self, question: Question, level: Level) -> Judged:
        """Ask one question at one level, in words, and judge the answer.

        Raises QuestionError for one that the grammar refuses, StoreError where the store fails.
        """
        before = perf_counter()
        answer, parse_ms = self._asker.ask(question.texts[level], level)
        retrieval_ms = (perf_counter() - before) * 1000 - parse_ms
        return self._judged(question, level, answer, parse_ms, retrieval_ms)

    def _judged(
        self, question: Question, level: Level, answer: Answer, parse_ms: float, retrieval_ms: float
    ) -> Judged:
        before = perf_counter()
        moments = moments_of(answer)
        ids = len({keyframe.object_id for keyframe in answer.keyframes})
        right = [self._is_right(moment, question) for moment in moments]
        scores: dict[Reading, Score] = {"strict": Score(first_right(right), len(moments), ids)}
        evaluation_ms = (perf_counter() - before) * 1000
        shown = [[self._shows(moment, question)] for moment in moments]
        scores["frame"] = Score(first_right(shown), len(moments), ids)
        return Judged(
            form=question.form,
            level=level,
            scores=scores,
            ceiling=ceiling(question.alternatives.get(level, 0)),
            negative=question.negative,
            empty=not moments,
            inside=self._is_inside(moments, right, question),
            parse_ms=parse_ms,
            retrieval_ms=retrieval_ms,
            evaluation_ms=evaluation_ms,
        )

    def _is_right(self, moment: Moment, question: Question) -> list[bool]:
        if question.form == "Q2":
            return [self._shows(moment, question)]
        owners = [self._rows.owner(keyframe.frame, keyframe.box) for keyframe in moment]
        return [owner in question.targets for owner in owners]

    def _shows(self, moment: Moment, question: Question) -> bool:
        if not question.targets:
            return False
        return any(
            self._rows.shown(keyframe.frame).issuperset(question.targets) for keyframe in moment
        )

    def _is_inside(
        self, moments: Sequence[Moment], right: Sequence[Sequence[bool]], question: Question
    ) -> bool | None:
        """Whether a right keyframe of the first 50 was itself taken in the asked slice."""
        if question.slice_ms is None or question.negative:
            return None
        start, end = question.slice_ms
        return any(
            any(ok) and start <= self._taken_ms(moment[0]) < end
            for moment, ok in zip(moments[:CUT], right[:CUT], strict=True)
        )

    def _taken_ms(self, keyframe: RankedKeyframe) -> int:
        row = self._rows.row(keyframe.frame, keyframe.box)
        if row is None:
            return round(keyframe.start.timestamp() * 1000)
        return int(self._truth.time_ms[row])


def cells(judged: Sequence[Judged]) -> list[Cell]:
    """Return a cell per form and level that was asked, over positive queries."""
    out = []
    for form in FORMS:
        for level in LEVELS:
            asked = [
                one
                for one in judged
                if one.form == form and one.level == level and not one.negative
            ]
            if asked:
                out.append(_cell(form, level, asked))
    return out


def _cell(form: Form, level: Level, asked: Sequence[Judged]) -> Cell:
    inside = [one.inside for one in asked if one.inside is not None]
    times = [one.retrieval_ms for one in asked]
    scores = {reading: [one.scores[reading] for one in asked] for reading in READINGS}

    def mean(values: Sequence[float]) -> float:
        return float(np.mean(values))

    return Cell(
        form=form,
        level=level,
        queries=len(asked),
        miss={r: mean([float(s.missed()) for s in scores[r]]) for r in READINGS},
        mrr={r: mean([s.reciprocal() for s in scores[r]]) for r in READINGS},
        frames=mean([s.frames for s in scores["strict"]]),
        ids=mean([s.ids for s in scores["strict"]]),
        ceiling=mean([one.ceiling for one in asked]),
        miss_inside=1.0 - mean([float(ok) for ok in inside]) if inside else None,
        retrieval_ms=mean(times),
        retrieval_p95_ms=float(np.percentile(times, 95)),
        evaluation_ms=mean([one.evaluation_ms for one in asked]),
    )


def false_answers(judged: Sequence[Judged], level: Level = "attribute") -> float | None:
    """Return the share of negative queries that got any keyframe; None where none was asked."""
    asked = [one for one in judged if one.negative and one.level == level]
    return float(np.mean([not one.empty for one in asked])) if asked else None
