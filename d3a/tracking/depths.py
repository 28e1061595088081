"""Default profile: what a depth image says of places, and of detections that it contradicts.

A detector's mistake is often no thing at all: depth at the very moment shows what is behind the
place where it should be, or something before it. Where positions come from depth they agree, and
nothing is doubted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.geometry import project
from d3a.model import Box
from d3a.parameters import Parameters
from d3a.sightings import Metres, Scene

Floats = NDArray[np.float64]
Counts = NDArray[np.intp]
SAMPLES = 9
"""Depths that are looked at along each side of a patch."""
NEAREST_SHARE = 0.1
"""Share of a patch's depths that may be as near as the thing's place without being it."""
BOX_SHARE, LEAST = 0.25, 3.0
"""Half the side of the patch that a detection is judged by, in its box's shorter sides; pixels."""
AGREES, BEHIND, BEFORE = 0, 1, 2
"""What depth says of a detection: nothing against it, only what is behind it is seen, or
something stands before it."""
FALSE_SHARE = 0.4
"""How often depth speaks so of what is no thing, and"""
TRUE_SHARE, TRUE_PRIOR = 0.1, 10.0
"""how often of things, before any were recognised; worth so many of them."""


def samples(depth: Metres, u: Floats, v: Floats, half: Floats, steps: int = SAMPLES) -> Metres:
    """Return depths (k, steps**2) of a grid in the squares of half a side `half` around pixels.

    u, v, half: (k,). What lies outside of the picture is 0, as what was not measured.
    """
    offset = half[:, None] * np.linspace(-1.0, 1.0, steps)
    row = np.rint(v[:, None] + offset).astype(np.intp)
    column = np.rint(u[:, None] + offset).astype(np.intp)
    height, width = depth.shape
    inside = ((row >= 0) & (row < height))[:, :, None] & ((column >= 0) & (column < width))[:, None]
    found = depth[row.clip(0, height - 1)[:, :, None], column.clip(0, width - 1)[:, None]]
    return np.asarray(np.where(inside, found, np.float32(0.0)).reshape(len(u), -1))


def nearer(depths: Metres, limit_m: Floats) -> tuple[Counts, Counts]:
    """Return how many measured depths of (k, n) are nearer than a limit (k,), and how many are."""
    measured = depths > 0
    return (measured & (depths < limit_m[:, None])).sum(axis=1), measured.sum(axis=1)


class Doubts:
    """How much depth contradicts a detection, learned from what it says of recognised things."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self.counts: Floats = np.array([TRUE_SHARE * TRUE_PRIOR] * 2 + [TRUE_PRIOR])
        """(3,): recognised things that depth spoke against, as BEHIND and BEFORE, and all."""

    def judge(self, scene: Scene, places: Floats, boxes: Sequence[Box]) -> list[int]:
        """Return AGREES, BEHIND or BEFORE for detections at places (k, 3), NaN where unknown."""
        none = [AGREES] * len(places)
        if scene.depth is None or scene.pose is None or scene.camera is None or not none:
            return none
        seen = project(places, scene.pose, scene.camera)
        sides = np.array([min(x2 - x1, y2 - y1) for x1, y1, x2, y2 in boxes])
        half = np.maximum(LEAST, BOX_SHARE * sides)
        known = ~np.isnan(seen.u)
        u, v = np.where(known, seen.u, -1e6), np.where(known, seen.v, -1e6)
        depths = samples(scene.depth, u, v, half)
        margin = self._parameters.seen_through_m
        as_near, measured = nearer(depths, seen.depth_m + margin)
        before, _ = nearer(depths, seen.depth_m - margin)
        said = np.where(2 * before > measured, BEFORE, AGREES)
        said = np.where(as_near < NEAREST_SHARE * measured, BEHIND, said)
        found: list[int] = np.where(measured > 0, said, AGREES).tolist()
        return found

    def learn(self, said: int) -> None:
        """Learn from what depth said of a thing that was recognised."""
        self.counts[2] += 1.0
        if said != AGREES:
            self.counts[said - 1] += 1.0

    def odds(self, said: int) -> float:
        """Return the log-odds that what depth speaks so of is no thing, 0 at least."""
        if said == AGREES:
            return 0.0
        share = float(self.counts[said - 1] / self.counts[2])
        return max(0.0, math.log(FALSE_SHARE / share))
