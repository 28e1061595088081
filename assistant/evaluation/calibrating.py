"""Judge every answer that is told, not only the first right one: how often is a score right.

An answer of one thing is right where its box shows a thing of the asked category (and colour, at
the Attribute level); of two things where both boxes are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from zoneinfo import ZoneInfo

from assistant.evaluation.asking_stores import Asker
from assistant.evaluation.methods import Filled
from assistant.evaluation.questions import Level, Question
from d3a.answer import RankedKeyframe
from d3a.answering.calibration import Kind, kind_of
from d3a.baselines import Moment, moments_of
from d3a.metrics import CUT, Rows
from d3a.truth import Truth

LEVELS: tuple[Level, ...] = ("category", "attribute")
"""At the others nearly everything is right: a taught name, any thing at all."""


@dataclass(frozen=True, slots=True)
class Told:
    """One answer of a list: its kind, the product of its parts, its score, and whether right."""

    kind: Kind
    product: float
    score: float
    right: bool


class Teller:
    """Asks one filled store; `truth` is of the recording that filled it."""

    def __init__(self, run: Filled, truth: Truth, zone: ZoneInfo) -> None:
        self._truth, self._rows = truth, Rows(truth)
        self._asker = Asker(run, datetime.fromtimestamp(truth.span_ms[1] / 1000, zone))

    def tell_all(self, questions: Sequence[Question]) -> Iterator[Told]:
        """Yield the first 50 answers of each question at each level, judged."""
        for question in questions:
            for level in LEVELS:
                if level in question.texts:
                    answer, _ = self._asker.ask(question.texts[level], level)
                    for moment in moments_of(answer)[:CUT]:
                        yield self._told(moment, question, level)

    def _told(self, moment: Moment, question: Question, level: Level) -> Told:
        first = moment[0]
        factor = first.why.get("calibration", 1.0) * first.why.get("repeat", 1.0)
        wanted = [self._words(term, level) for term in question.terms]
        return Told(
            kind=kind_of(len(moment), by_looks=level == "attribute"),
            product=min(1.0, first.score / factor) if factor > 0 else 0.0,
            score=first.score,
            right=[self._shown(keyframe, level) for keyframe in moment] == wanted,
        )

    def _words(self, asked: tuple[str, str], level: Level) -> tuple[str, ...]:
        return asked if level == "attribute" else asked[1:]

    def _shown(self, keyframe: RankedKeyframe, level: Level) -> tuple[str, ...] | None:
        owner = self._rows.owner(keyframe.frame, keyframe.box)
        if owner < 0:
            return None
        one = self._truth.objects[owner]
        return self._words((one.colour, one.category), level)
