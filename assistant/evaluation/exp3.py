"""Exp 3: how a store grows over a long recording (paper, "Compactness Comparison").

The paper's figure of cumulative insertions per hour has no numbers; its shape alone is compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from assistant.evaluation.methods import D3A_D, NAIVE, OURS, Method, filled
from assistant.evaluation.worlds import Steps, World, recorded
from d3a.truth import Truth

METHODS = (NAIVE, D3A_D, OURS)
PAUSE_MS = 3_600_000


@dataclass(frozen=True, slots=True)
class Growth:
    """Stays (STc documents) and ids in the store by the robot's working hour, cumulative.

    hours: the end of each hour; stays, confirmed, ids: counts of what began before it.
    A stay that was tentative and expired is no longer in the store, and is not counted.
    """

    method: Method
    world: World
    hours: tuple[int, ...]
    stays: tuple[int, ...]
    confirmed: tuple[int, ...]
    ids: tuple[int, ...]
    seconds: float
    associate_s: float
    detections: int

    @property
    def per_hour(self) -> float:
        """Stays begun per hour."""
        return self.stays[-1] / max(1, len(self.hours))


def run(
    worlds: Sequence[World], work: Path, steps: Steps, *, methods: Sequence[Method] = METHODS
) -> list[Growth]:
    """Fill each method's store from each world and tell how it grew."""
    grown = []
    for world in worlds:
        for method in methods:
            steps.begin(f"{world.title}, {world.hours:g} h: {method.title}")
            source = recorded(world, "nominal", work)
            with filled(method, source, work / "stores") as filling:
                stays = filling.store.stays()
                clock = WorkingHours(source.truth)
                hours = tuple(range(1, clock.whole + 1))
                grown.append(
                    Growth(
                        method=method,
                        world=world,
                        hours=hours,
                        stays=clock.cumulative([s.first_ms for s in stays], hours),
                        confirmed=clock.cumulative(
                            [s.first_ms for s in stays if not s.tentative], hours
                        ),
                        ids=clock.cumulative([o.first_ms for o in filling.store.objects()], hours),
                        seconds=filling.seconds,
                        associate_s=filling.associate_s,
                        detections=filling.detections,
                    )
                )
    return grown


class WorkingHours:
    """The robot's own hours: pauses of an hour and more (nights) do not count."""

    def __init__(self, truth: Truth) -> None:
        times = np.unique(truth.time_ms)
        gaps = np.diff(times, prepend=times[:1])
        gaps[gaps >= PAUSE_MS] = 0
        self._times, self._worked = times, np.cumsum(gaps)

    @property
    def whole(self) -> int:
        """Working hours, begun ones too."""
        return int(np.ceil(max(self._worked[-1], 1) / 3_600_000)) if len(self._worked) else 0

    def cumulative(self, moments_ms: Sequence[int], hours: Sequence[int]) -> tuple[int, ...]:
        """Return how many of the moments lie before the end of each working hour."""
        worked = np.interp(moments_ms, self._times, self._worked)
        return tuple(int((worked <= hour * 3_600_000).sum()) for hour in hours)
