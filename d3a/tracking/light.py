"""Default profile: whether the light is another one than that in which things were known.

A view long after those that are known of a thing, and unlike them, may be of another thing at its
place; where most such views of late are, it is the light.
"""

from __future__ import annotations

import numpy as np

from d3a.parameters import Parameters
from d3a.tracking.known import Known
from d3a.tracking.likelihood import LATER, OTHER, LookModel

SURE, MOST = 2.0, 3.0
"""By how many more of the latest views looks object than agree where the light is another one; and
what is counted of that at most, either way."""


class Light:
    """Counts looks that object to what place and category say, long after a thing was known."""

    def __init__(self, looks: LookModel, parameters: Parameters) -> None:
        self._looks = looks
        self._parameters = parameters
        self.objections = 0.0
        """By how many more of the latest such views looks object than agree."""

    def is_later(self, thing: Known, now_ms: int) -> bool:
        """Say whether what is known of a thing's look is of long ago, and of another light."""
        return self.objections >= SURE and self.is_long_after(thing, now_ms)

    def is_long_after(self, thing: Known, now_ms: int) -> bool:
        """Say whether a thing's look is of another visit, on average; one seen once has none."""
        parameters = self._parameters
        is_confirmed = thing.seen >= parameters.confirm_sightings
        return is_confirmed and now_ms - thing.look_ms > parameters.interval_gap_s * 1000

    def learn(self, pairs: list[tuple[float, float]]) -> None:
        """Learn from surely known things, seen long after: how alike, and to looks of what weight.

        How unlike they are is learned where most object: else it may be another thing's look.
        """
        if not pairs:
            return
        likeness, views = np.array(pairs).T
        told = self._looks.against(likeness[None], views, [False] * len(pairs), (OTHER,))[0, 0]
        for (alike, weight), odds in zip(pairs, told.tolist(), strict=True):
            objections = self.objections + (1.0 if odds < 0 else -1.0)
            self.objections = min(max(objections, -MOST), MOST)
            if self.objections > 0:
                self._looks.add(LATER, alike, weight)
