"""Default profile: what else may have moved, and where else, of all moves of a category together.

A thing that left went to one place at most, and what turned up came from one at most: of all ways
to pair them the likely ones count. Each pair's chance follows from messages between both ends, as
in belief propagation: a thing claims a new place the less, the better it is found elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


ROUNDS = 12
"""Of messages: each brings them half way to where they stay."""


@dataclass(frozen=True, slots=True)
class Rivals:
    """Moves that exclude each other: what turned up (n) from where things were last (m).

    odds: (n, m), of each move against none, 0 where it cannot be. claims: the same, by how likely
    the thing that left is at no other new place; offers: by how likely what turned up is no other
    of those that left.
    """

    odds: Floats
    claims: Floats
    offers: Floats

    @classmethod
    def of(cls, odds: Floats) -> Rivals:
        """Weigh the odds of all moves of a category, (n, m)."""
        claims, offers = odds, odds
        for _ in range(ROUNDS):  # by geometric means, as twins would make them swing
            claims = np.sqrt(claims * (odds / (1.0 + _others(offers, 0))))
            offers = np.sqrt(offers * (odds / (1.0 + _others(claims, 1))))
        return cls(odds, claims, offers)

    def chance(self, row: int, k: int, counts: Floats) -> float:
        """Return how likely what turned up is the k-th thing.

        counts: (m,), how much more each thing counts as what came than its odds say.
        """
        others = _without(self.claims[row] * counts, k)
        elsewhere = _without(self.offers[:, k], row)
        own = float(self.odds[row, k])
        return own / (own + (1.0 + others) * (1.0 + elsewhere))


def _without(values: Floats, k: int) -> float:
    return float(values[:k].sum() + values[k + 1 :].sum())


def _others(values: Floats, axis: int) -> Floats:
    """Return for each value the sum of all others along an axis."""
    ordered = np.moveaxis(values, axis, 0)
    above, below = np.zeros_like(ordered), np.zeros_like(ordered)
    np.cumsum(ordered[:-1], axis=0, out=above[1:])  # no difference of sums: odds may be huge
    np.cumsum(ordered[:0:-1], axis=0, out=below[-2::-1])
    return np.moveaxis(above + below, 0, axis)
