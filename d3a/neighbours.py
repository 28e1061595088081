"""Default profile: how near to each other different things stand, learned while the robot looks.

Things stand in groups: on a table the next one is a hand's breadth away, and the chance to find
another thing beside a known one has little to do with the size of the home. Two boxes of a frame
are two things, so every frame tells.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters

Floats = NDArray[np.float64]
SHELLS_M = (0.0, 0.15, 0.3, 0.5, 0.8, 1.2)
"""Bounds of the distances that are told apart; beyond, things stand as anywhere in the home."""
VOLUMES = np.diff(np.array(SHELLS_M) ** 3) * 4 / 3 * np.pi
REACH_M = SHELLS_M[-1]
_ENDS_M = SHELLS_M[1:]
_ENDS_M2 = np.array(_ENDS_M) ** 2


class Neighbours:
    """Counts pairs of different categories in a frame by distance."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        prior = parameters.beside_prior
        self.pairs: Floats = prior * VOLUMES / parameters.beside_m3
        """(shells,): neighbours seen in each shell."""
        self.seen: Floats = np.array([prior])
        """(1,): things around which was looked."""

    def add(self, things: int, apart_m: Iterable[float]) -> None:
        """Learn from a frame of so many things: how far apart its pairs of two categories are."""
        self.seen += things
        counts = [0] * len(VOLUMES)
        for each in apart_m:
            if each < REACH_M:
                counts[bisect(_ENDS_M, each)] += 2  # each is the other's neighbour
        if any(counts):
            self.pairs += counts

    def shells_m3(self) -> Floats:
        """Return the space (shells + 1,) in which one other thing is found, by how far off."""
        anywhere = 1.0 / self._parameters.space_m3
        by_shell = np.empty(len(VOLUMES) + 1)
        np.maximum(self.pairs / (VOLUMES * self.seen), anywhere, out=by_shell[:-1])
        by_shell[-1] = anywhere
        return np.asarray(1.0 / by_shell)

    def space_m3(self, apart_m2: Floats, shells_m3: Floats | None = None) -> Floats:
        """Return the space in which one other thing is found at such distances, alike shaped.

        apart_m2: squared. shells_m3: what `shells_m3` returns, where it is known already.
        """
        shells = self.shells_m3() if shells_m3 is None else shells_m3
        return np.asarray(shells[_ENDS_M2.searchsorted(apart_m2, side="right")])


def beside(places: Floats, placed: NDArray[np.bool_]) -> dict[tuple[int, int], float]:
    """Return the pairs of a frame's things that stand side by side, and how far apart they are.

    places: (n, 3); placed: (n,), those that are known well enough to tell.
    """
    found: dict[tuple[int, int], float] = {}
    rows = places.tolist()
    known = [i for i in np.flatnonzero(placed).tolist() if not math.isnan(rows[i][0])]
    for k, i in enumerate(known):
        x, y, z = rows[i]
        for j in known[:k]:
            dx, dy, dz = x - rows[j][0], y - rows[j][1], z - rows[j][2]
            if -REACH_M <= dx <= REACH_M and -REACH_M <= dy <= REACH_M:
                apart_m = math.sqrt(dx * dx + dy * dy + dz * dz)
                if apart_m <= REACH_M:
                    found[j, i] = apart_m
    return found
