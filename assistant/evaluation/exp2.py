"""Exp 2: retrieval for three kinds of queries at four precisions, and the summary of a system.

Paper: Tables 3 and 4. Every method is asked the same questions of the same world.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from assistant.evaluation.judging import Cell, Judge, Judged, Reading, cells, false_answers
from assistant.evaluation.methods import METHODS, Filled, Method, filled, teach
from assistant.evaluation.questions import NEGATIVES, POSITIVES, draw
from assistant.evaluation.worlds import Recorded, Steps, World, recorded
from d3a import metrics
from d3a.simulate import NOMINAL
from d3a.store_size import Against, against_naive
from d3a.truth import Truth

PAPERS_LEVELS = ("perfect", "category", "any")


@dataclass(frozen=True, slots=True)
class Identity:
    """How well a store's ids are the world's things; see `d3a.metrics`."""

    precision: float
    recall: float
    f: float
    dropped: float
    duplicates: metrics.Duplicates
    links: metrics.Rate
    absent: metrics.Rate


@dataclass(frozen=True, slots=True)
class Size:
    """What a store holds. confirmed: not tentative. truly: places detected at least twice.

    entries: keyframes that it refers to; pictures: distinct frames among them; file_bytes: the
    store's file without pictures, as a simulated world has none. smaller: how many times smaller
    than Naive's, by entries with a picture each and by the crops of their boxes.
    """

    ids: int
    confirmed_ids: int
    stays: int
    confirmed_stays: int
    truly: int
    entries: int
    pictures: int
    file_bytes: int
    smaller: Against


@dataclass(frozen=True, slots=True)
class Outcome:
    """One method on one world. refused: questions that count as misses unread, each with why."""

    method: Method
    world: World
    cells: tuple[Cell, ...]
    false_answers: float | None
    identity: Identity
    size: Size
    detections: int
    seconds: float
    associate_s: float
    refused: tuple[str, ...] = ()

    def accuracy(
        self, reading: Reading = "strict", *, perfect: float | None = None, six: bool = False
    ) -> float:
        """Return the accuracy over the paper's nine cells, or the six without Perfect.

        perfect: what Perfect cells count as; 0 is the paper's, None as measured (acc9h).
        """
        misses: dict[tuple[str, str], float] = {
            (cell.form, cell.level): cell.miss[reading]
            for cell in self.cells
            if cell.level in PAPERS_LEVELS and not (six and cell.level == "perfect")
        }
        return metrics.accuracy(misses, perfect=perfect)

    def mrr(self, level: str, reading: Reading = "strict") -> float:
        """Return the MRR@50 at a level, the mean of Q1 to Q3."""
        return float(np.mean([cell.mrr[reading] for cell in self.cells if cell.level == level]))

    def ceiling(self, level: str) -> float:
        """Return the best MRR of the world at a level without knowing which look-alike is meant.

        The mean of Q1 to Q3; an order that knows more than the words (how often a thing was
        seen) may come out above it.
        """
        return float(np.mean([cell.ceiling for cell in self.cells if cell.level == level]))

    def response_ms(self) -> float:
        """Return the mean retrieval time over the paper's nine cells."""
        shown = [cell.retrieval_ms for cell in self.cells if cell.level in PAPERS_LEVELS]
        return float(np.mean(shown))


def run(
    worlds: Sequence[World],
    work: Path,
    steps: Steps,
    *,
    methods: Sequence[Method] = METHODS,
    condition: str = NOMINAL.name,
    reading: Reading = "strict",
    count: int = POSITIVES,
) -> list[Outcome]:
    """Ask every method the questions of every world; methods whose sensor it lacks are left out.

    reading "frame" asks for well-seen objects (10 detections) alone, as the paper's figures
    suggest its authors did; "strict" asks for every object that was seen.
    """
    outcomes = []
    for world in worlds:
        for method in methods:
            wanted = method.condition or condition
            steps.begin(f"{world.title}: {method.title}")
            if world.has(wanted):
                source = recorded(world, wanted, work)
                outcomes.append(_outcome(method, world, source, work, reading, count))
    return outcomes


def _outcome(
    method: Method, world: World, source: Recorded, work: Path, reading: Reading, count: int
) -> Outcome:
    rng = np.random.default_rng([world.seed, 2])
    least = 10 if reading == "frame" else 1
    questions = draw(source.truth, source.zone, rng, count=count, negatives=NEGATIVES, least=least)
    with filled(method, source, work / "stores") as store:
        identity, size = judge_identity(store, source.truth), size_of(store, source.truth)
        teach(store.store, source.truth, store.assignments)
        judged: list[Judged] = Judge(store, source.truth, source.zone).ask_all(questions)
        return Outcome(
            method=method,
            world=world,
            cells=tuple(cells(judged)),
            false_answers=false_answers(judged),
            identity=identity,
            size=size,
            detections=store.detections,
            seconds=store.seconds,
            associate_s=store.associate_s,
            refused=tuple(dict.fromkeys(one.refused for one in judged if one.refused is not None)),
        )


def judge_identity(run: Filled, truth: Truth) -> Identity:
    """Judge the ids, links and absences of a filled store."""
    b_cubed = metrics.b_cubed(truth.owner.tolist(), run.assignments)
    confirmed = [one.object_id for one in run.store.objects() if not one.tentative]
    stays = [stay for stay in run.store.stays() if not stay.tentative]
    left = sum(stay is None for stay in run.assignments)
    return Identity(
        precision=b_cubed.precision,
        recall=b_cubed.recall,
        f=b_cubed.f,
        dropped=left / max(1, len(run.assignments)),
        duplicates=metrics.duplicates(truth, run.assignments, confirmed),
        links=metrics.move_links(truth, run.assignments, stays),
        absent=metrics.last_absent(truth, run.assignments, stays),
    )


def size_of(run: Filled, truth: Truth) -> Size:
    """Count what a filled store holds."""
    objects, stays = run.store.objects(), run.store.stays()
    sightings = run.store.sightings()
    entries = {(s.frame, s.box) for s in sightings}
    return Size(
        ids=len(objects),
        confirmed_ids=sum(not one.tentative for one in objects),
        stays=len(stays),
        confirmed_stays=sum(not stay.tentative for stay in stays),
        truly=metrics.true_stays(truth),
        entries=len(entries),
        pictures=len({frame for frame, _ in entries}),
        file_bytes=int(run.store.counts()["bytes"]),
        smaller=against_naive(sightings, truth.box),
    )
