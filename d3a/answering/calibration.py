"""From the product of a score's parts to the probability that it is right.

The parts of a score (`d3a.rank`) are not independent, so their product orders answers well and is
no probability. A monotone map per kind of question mends that: order is kept, only what cannot be
told apart becomes alike. The maps were fitted on development worlds of the simulator by
`python -m tests.bench.bench_calibration --refit`, which also prints how reliable they are on
others; `calibration.json` holds them.
"""

from __future__ import annotations

import json
from bisect import bisect_left
from collections.abc import Sequence
from functools import lru_cache
from importlib.resources import files
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Kind = Literal["thing", "looks", "pair", "pair looks"]
"""What was asked: one thing or several in a relation, by its looks too or not."""
KINDS: tuple[Kind, ...] = ("thing", "looks", "pair", "pair looks")
Knots = tuple[tuple[float, ...], tuple[float, ...]]
"""Products, rising from 0 to 1, and the probability of each, never falling."""
LEAST_IN_STEP = 200
"""Answers of which a step of the map tells the share of right ones, at least."""
_PRIOR = 2.0
"""Answers that a step is thought to have seen beyond its own, one right and one wrong."""


def kind_of(entries: int, *, by_looks: bool) -> Kind:
    """Return the kind of an answer that shows so many things."""
    if entries > 1:
        return "pair looks" if by_looks else "pair"
    return "looks" if by_looks else "thing"


def calibrated(product: float, kind: Kind) -> float:
    """Return the probability 0..1 that an answer is right whose parts have this product."""
    products, probabilities = maps()[kind]
    if product <= 0.0:
        return 0.0
    at = bisect_left(products, product)  # six times as quick as numpy's for one number
    if at >= len(products):
        return probabilities[-1]
    low, high = products[at - 1], products[at]
    share = (product - low) / (high - low)
    return probabilities[at - 1] + share * (probabilities[at] - probabilities[at - 1])


@lru_cache(maxsize=1)
def maps() -> dict[str, Knots]:
    """Return the fitted map of each kind."""
    text = files("d3a.answering").joinpath("calibration.json").read_text(encoding="utf-8")
    return {
        kind: (tuple(knots["product"]), tuple(knots["probability"]))
        for kind, knots in json.loads(text).items()
    }


def fitted(products: Sequence[float], right: Sequence[bool], least: int = LEAST_IN_STEP) -> Knots:
    """Return the map from products to shares of right answers, by isotonic regression.

    Answers by product in steps of `least`, neighbours pooled where a likelier step was right
    less often; between the steps' means the map is linear, and (0, 0) and (1, last) end it.
    """
    order = np.argsort(products, kind="stable")
    x = np.asarray(products, dtype=np.float64)[order]
    y = np.asarray(right, dtype=np.float64)[order]
    blocks = [_block(x[at : at + least], y[at : at + least]) for at in range(0, len(x), least)]
    pooled: list[tuple[float, float, float]] = []  # sum of products, of right ones, how many
    for block in blocks:
        pooled.append(block)
        while len(pooled) > 1 and _share(pooled[-2]) >= _share(pooled[-1]):
            last = pooled.pop()
            before = pooled.pop()
            pooled.append((before[0] + last[0], before[1] + last[1], before[2] + last[2]))
    knots = [(total / count, _share((total, good, count))) for total, good, count in pooled]
    last_share = knots[-1][1] if knots else 1.0
    ends = [(0.0, 0.0), *knots, (1.0, last_share)]
    rising = [knot for at, knot in enumerate(ends) if at == 0 or knot[0] > ends[at - 1][0]]
    return tuple(round(a, 4) for a, _ in rising), tuple(round(b, 4) for _, b in rising)


def _block(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float, float]:
    return float(x.sum()), float(y.sum()), float(len(x))


def _share(block: tuple[float, float, float]) -> float:
    return (block[1] + _PRIOR / 2) / (block[2] + _PRIOR)


def expected_error(
    probabilities: Sequence[float], right: Sequence[bool], bins: int = 10
) -> tuple[float, list[tuple[int, float, float]]]:
    """Return the expected calibration error, and (count, mean probability, share right) a bin.

    Bins of equal width; the error is the mean distance of both, by the bins' counts.
    """
    p = np.asarray(probabilities, dtype=np.float64)
    y = np.asarray(right, dtype=np.float64)
    of = np.minimum((p * bins).astype(np.intp), bins - 1)
    rows: list[tuple[int, float, float]] = []
    for number in range(bins):
        inside = of == number
        count = int(inside.sum())
        rows.append(
            (count, float(p[inside].mean()), float(y[inside].mean())) if count else (0, 0.0, 0.0)
        )
    error = sum(count * abs(told - was) for count, told, was in rows) / max(len(p), 1)
    return error, rows
