"""Default profile: the things of one frame as arrays, as tier 2 compares them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.checkpoint import stacked
from d3a.tier1 import Thing

Floats = NDArray[np.float64]
_UNKNOWN = (math.nan,) * 3
_EXACT = (0.0,) * 9


@dataclass(frozen=True, slots=True)
class Observed:
    """The things of a frame as arrays. Unknown positions are NaN, unknown looks zeros.

    places: (n, 3). noise: (n, 3, 3), each detection's own. looks: (n, d), d = 0 without pictures.
    nowhere: (n,), which have no position. pictured: (n,), which have a look.
    """

    things: tuple[Thing, ...]
    places: Floats
    noise: Floats
    looks: NDArray[np.float32]
    nowhere: NDArray[np.bool_]
    pictured: NDArray[np.bool_]

    @classmethod
    def of(cls, things: list[Thing], is_histogram: bool) -> Observed:
        """Return the arrays of a frame's things."""
        detections = [thing.detection for thing in things]
        places = np.array([d.position or _UNKNOWN for d in detections], dtype=np.float64)
        noise = np.array([d.covariance or _EXACT for d in detections], dtype=np.float64)
        looks = likelihood.feature(stacked([d.embedding for d in detections]), is_histogram)
        count = len(things)
        places = places.reshape(count, 3)
        return cls(
            tuple(things),
            places,
            noise.reshape(count, 3, 3),
            looks,
            np.isnan(places[:, 0]),
            np.asarray(looks.any(axis=1)),
        )

    def part(self, wanted: list[int]) -> Observed:
        """Return some of the things."""
        return Observed(
            tuple(self.things[i] for i in wanted),
            self.places[wanted],
            self.noise[wanted],
            self.looks[wanted],
            self.nowhere[wanted],
            self.pictured[wanted],
        )
