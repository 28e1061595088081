"""Exp 1: a synthetic embedding generator, one-hot instance codes with flipped bits.

Paper: "Retrieval Performance with a Synthetic Embedding Generator with Increasing Uncertainty".
Its figure has no numbers, so only shapes can be compared. Every object that was seen is asked for
(Q1); candidates are the ObjectIDs whose embedding has the object's bit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from operator import itemgetter
from pathlib import Path
from typing import Literal

import numpy as np

from assistant.evaluation.asking_stores import Asker
from assistant.evaluation.methods import D3A_D, NAIVE, OURS, Filled, Method, filled
from assistant.evaluation.questions import taught_name
from assistant.evaluation.worlds import Recorded, Steps, World, recorded
from d3a.answer import RankedKeyframe
from d3a.metrics import Rows, Score, first_right
from d3a.simulate import codes
from d3a.store.base import Batch, Store, TaughtName
from d3a.truth import Truth

RATES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
FNR = 0.05
METHODS = (NAIVE, D3A_D, OURS)
Order = Literal["probability", "cosine"]
ORDERS: tuple[Order, ...] = ("probability", "cosine")


@dataclass(frozen=True, slots=True)
class Point:
    """One method at one false positive rate in one world; miss and MRR@50 by order."""

    method: Method
    world: World
    fpr: float
    miss: dict[Order, float]
    mrr: dict[Order, float]


def run(
    worlds: Sequence[World],
    work: Path,
    steps: Steps,
    *,
    rates: Sequence[float] = RATES,
    methods: Sequence[Method] = METHODS,
) -> list[Point]:
    """Return a point per world, rate and method; a given recording has no codes: left out."""
    points = []
    for world in worlds:
        for fpr in rates:
            for method in methods:
                steps.begin(f"{world.title}: fpr {fpr:g}, {method.title}")
                if world.folder is None:
                    source = recorded(world, codes(fpr, FNR), work, depth=False)
                    points.append(_point(method, world, fpr, source, work))
    return points


def _point(method: Method, world: World, fpr: float, source: Recorded, work: Path) -> Point:
    with filled(method, source, work / "stores") as run:
        vectors = teach_bits(run.store, len(source.truth.objects))
        scores = _ask(run, source, vectors)
    return Point(
        method=method,
        world=world,
        fpr=fpr,
        miss={o: float(np.mean([s.missed() for s in scores[o]])) for o in ORDERS},
        mrr={o: float(np.mean([s.reciprocal() for s in scores[o]])) for o in ORDERS},
    )


def teach_bits(store: Store, things: int) -> dict[str, np.ndarray]:
    """Name every ObjectID by the bits that its embedding has; return the embeddings, unit length.

    A bit is there where it is at least half of the strongest: an aggregated embedding is a mean of
    flipped codes. Raises StoreError.
    """
    records, vectors = [], {}
    for record in store.objects():
        if record.embedding is None:
            continue
        vector = np.asarray(record.embedding, dtype=float)
        vectors[record.object_id] = vector / np.linalg.norm(vector)
        bits = np.flatnonzero(vector[:things] >= 0.5 * vector.max())
        records.append(replace(record, names=tuple(TaughtName(taught_name(int(b))) for b in bits)))
    store.apply(Batch(objects=records))
    return vectors


def _ask(run: Filled, source: Recorded, vectors: dict[str, np.ndarray]) -> dict[Order, list[Score]]:
    truth: Truth = source.truth
    rows = Rows(truth)
    asker = Asker(run, datetime.fromtimestamp(truth.span_ms[1] / 1000, source.zone))
    scores: dict[Order, list[Score]] = {order: [] for order in ORDERS}
    for k in truth.seen():
        text = f"Did you ever see {taught_name(k)}?"
        answer, _ = asker.ask(text, "perfect")
        likeness = {name: float(vector[k]) for name, vector in vectors.items()}
        if run.method.is_papers:
            alike = by_cosine(answer.keyframes, likeness)
        else:
            whole, _ = asker.ask(text, "perfect", whole=True)
            alike = once_each_first(by_cosine(whole.keyframes, likeness))
        for order, shown in zip(ORDERS, (answer.keyframes, alike), strict=True):
            right = first_right([rows.owner(one.frame, one.box) == k] for one in shown)
            ids = len({one.object_id for one in shown})
            scores[order].append(Score(right, len(shown), ids))
    return scores


def by_cosine(
    keyframes: Sequence[RankedKeyframe], likeness: Mapping[str, float]
) -> list[RankedKeyframe]:
    """Return keyframes by how alike their ObjectID is to what was asked for, else as they are."""
    return sorted(keyframes, key=lambda one: -likeness.get(one.object_id, 0.0))


def once_each_first(keyframes: Sequence[RankedKeyframe]) -> list[RankedKeyframe]:
    """Return keyframes with each ObjectID once before any twice: as the default profile ranks."""
    turns: Counter[str] = Counter()
    turn = []
    for one in keyframes:
        turn.append(turns[one.object_id])
        turns[one.object_id] += 1
    return [one for _, one in sorted(zip(turn, keyframes, strict=True), key=itemgetter(0))]
