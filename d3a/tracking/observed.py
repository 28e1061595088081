"""Default profile: the things of one frame as arrays, as tier 2 compares them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.checkpoint import stacked
from d3a.model import Pose, Position
from d3a.symmetric import Matrix, added, along, of_rows, scaled
from d3a.tier1 import Thing
from d3a.tracking import likelihood

Floats = NDArray[np.float64]
ANYWHERE = 10.0
"""Sigma, by the range that was assumed, of a range that nothing tells."""
_UNKNOWN = (math.nan,) * 3
_EXACT = (0.0,) * 6


class Observed(NamedTuple):
    """The n things of a frame, of which there is one at least. Unknown looks are zeros.

    spots: their positions, None where unknown; places: the same (3, n), NaN where unknown. errors:
    each detection's own, xx xy xz yy yz zz; noise: the same (6, n). looks: (n, d), d = 0 without
    pictures; pictured: which have one.
    """

    things: tuple[Thing, ...]
    spots: list[Position | None]
    places: Floats
    errors: list[Matrix]
    noise: Floats
    looks: NDArray[np.float32]
    pictured: list[bool]

    @classmethod
    def of(cls, things: list[Thing], is_histogram: bool) -> Observed:
        """Return the arrays of a frame's things."""
        detections = [thing.detection for thing in things]
        spots = [d.position for d in detections]
        errors = [_EXACT if d.covariance is None else of_rows(d.covariance) for d in detections]
        looks = likelihood.feature(stacked([d.embedding for d in detections]), is_histogram)
        return cls(
            tuple(things),
            spots,
            np.array([_UNKNOWN if spot is None else spot for spot in spots]).T,
            errors,
            np.array(errors).T,
            looks,
            np.asarray(looks.any(axis=1)).tolist(),
        )

    def part(self, wanted: list[int]) -> Observed:
        """Return some of the things."""
        return Observed(
            tuple(self.things[i] for i in wanted),
            [self.spots[i] for i in wanted],
            self.places[:, wanted],
            [self.errors[i] for i in wanted],
            self.noise[:, wanted],
            self.looks[wanted],
            [self.pictured[i] for i in wanted],
        )

    def error_again(self, i: int, pose: Pose | None, scale: float) -> Matrix:
        """Return the error of a view of something that was seen before, its own share scaled.

        A range that was assumed was so before: it tells nothing anew, however often it is said.
        The direction does, and from two sides the directions alone tell where a thing is.
        """
        error, spot = scaled(self.errors[i], scale), self.spots[i]
        if pose is None or spot is None or self.things[i].detection.ranged:
            return error
        (x, y, z), (at_x, at_y, at_z) = spot, pose.position
        beam = ANYWHERE * (x - at_x), ANYWHERE * (y - at_y), ANYWHERE * (z - at_z)
        return added(error, along(*beam))

    @property
    def nowhere(self) -> list[int]:
        """Which have no position."""
        return [i for i, spot in enumerate(self.spots) if spot is None]
