"""Default profile: how near to each other different things stand, learned while the robot looks.

Things stand in groups: on a table the next one is a hand's breadth away, and the chance to find
another thing beside a known one has little to do with the size of the home. Two boxes of a frame
are two things, so every frame tells.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from d3a.model import Position
from d3a.parameters import Parameters

Floats = NDArray[np.float64]
SHELLS_M = (0.0, 0.15, 0.3, 0.5, 0.8, 1.2)
"""Bounds of the distances that are told apart; beyond, things stand as anywhere in the home."""
VOLUMES = [4 / 3 * math.pi * (far**3 - near**3) for near, far in pairwise(SHELLS_M)]
REACH_M = SHELLS_M[-1]
_ENDS_M = SHELLS_M[1:]
_ENDS_M2 = np.array(_ENDS_M) ** 2


class Neighbours:
    """Counts pairs of different categories in a frame by distance."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self.pairs = [parameters.beside_prior * v / parameters.beside_m3 for v in VOLUMES]
        """Neighbours seen in each shell."""
        self.seen = parameters.beside_prior
        """Things around which was looked."""

    def add(self, things: int, apart_m: Iterable[float]) -> None:
        """Learn from a frame of so many things: how far apart its pairs of two categories are."""
        self.seen += things
        for each in apart_m:
            if each < REACH_M:
                self.pairs[bisect(_ENDS_M, each)] += 2.0  # each is the other's neighbour

    def shells_m3(self) -> Floats:
        """Return the space (shells + 1,) in which one other thing is found, by how far off."""
        most = self._parameters.space_m3
        looked = zip(self.pairs, VOLUMES, strict=True)
        return np.array([*(min(v * self.seen / n, most) if n else most for n, v in looked), most])

    def space_m3(self, apart_m2: Floats, shells_m3: Floats | None = None) -> Floats:
        """Return the space in which one other thing is found at such distances, alike shaped.

        apart_m2: squared. shells_m3: what `shells_m3` returns, where it is known already.
        """
        shells = self.shells_m3() if shells_m3 is None else shells_m3
        return np.asarray(shells[_ENDS_M2.searchsorted(apart_m2, side="right")])


def beside(spots: list[Position | None], placed: list[bool]) -> dict[tuple[int, int], float]:
    """Return the pairs of a frame's things that stand side by side, and how far apart they are.

    placed: which are known well enough to tell.
    """
    found: dict[tuple[int, int], float] = {}
    known = [
        (i, s)
        for i, (s, is_placed) in enumerate(zip(spots, placed, strict=True))
        if is_placed and s
    ]
    for k, (i, (x, y, z)) in enumerate(known):
        for j, (at_x, at_y, at_z) in known[:k]:
            dx, dy, dz = x - at_x, y - at_y, z - at_z
            if -REACH_M <= dx <= REACH_M and -REACH_M <= dy <= REACH_M:
                apart_m = math.sqrt(dx * dx + dy * dy + dz * dz)
                if apart_m <= REACH_M:
                    found[j, i] = apart_m
    return found
