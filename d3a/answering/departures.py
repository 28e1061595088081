"""When a thing left its place, as far as later looks there tell.

The store keeps when a place was last seen without its thing. In which of the looks before that it
was gone already, they tell as evidence: each would have shown it, had it still been there, as
often as the looks did while it was there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.answering.distinct import ROUND_GAP_MS
from d3a.store.base import Sighting, StayRecord, View

PRIOR_LOOKS = 2
"""How often a look shows what is there is taken from so many looks before any was counted."""
MOST_SHOWN = 0.99
"""No number of looks that all showed it makes it certain that the next one does."""
Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Left:
    """A thing that left its place: all its sightings there, and when it was last seen gone."""

    sightings: Sequence[Sighting]
    stay: StayRecord
    absent_ms: int

    @property
    def last_ms(self) -> int:
        """Return when it was last seen there."""
        return max(s.end_ms for s in self.sightings)


def share_left(left: Left, looks: Looks, detect_chance: float, start_ms: int, end_ms: int) -> float:
    """Return how likely a thing left within [start, end), or that it had was first to be seen then.

    Until it was seen gone it may have left in any pause between two looks: as likely as the pause
    is long, and as the looks that followed it would all have overlooked the thing. The likelier of
    the two, 0..1: who looks first in the morning asks then what is gone.
    detect_chance: how often a look shows what is there, before any was counted.
    """
    last_ms = left.last_ms
    seen = looks.at(left.stay, left.absent_ms)
    overlooked = 1.0 - _shown([look for look in seen if look[0] <= last_ms], left, detect_chance)
    after = [look for look in seen if look[0] > last_ms and look[1] < left.absent_ms]
    total = went = noticed = 0.0
    since_ms, likely = last_ms, 1.0
    for first_ms, until_ms in (*after, (left.absent_ms, left.absent_ms)):
        total += likely * (first_ms - since_ms)
        went += likely * max(0, min(first_ms, end_ms) - max(since_ms, start_ms))
        noticed += likely * (first_ms - since_ms) * (start_ms <= until_ms < end_ms)
        since_ms, likely = until_ms, likely * overlooked
    return max(went, noticed) / total


def _shown(looks: Sequence[Span], left: Left, detect_chance: float) -> float:
    """Return how likely a look shows the thing while it is there."""
    spans = [(s.start_ms, s.end_ms) for s in left.sightings]
    shown = sum(any(a <= end and b >= start for a, b in spans) for start, end in looks)
    return min(MOST_SHOWN, (shown + PRIOR_LOOKS * detect_chance) / (len(looks) + PRIOR_LOOKS))


class Looks:
    """Where the robot looked and when, as arrays; views without a pose are left out."""

    def __init__(self, views: Sequence[View]) -> None:
        posed = [view for view in views if view.x is not None and view.half_angle is not None]
        self._sites = np.array([view.site for view in posed], dtype=np.str_)
        self._spans = np.array([(v.start_ms, v.end_ms) for v in posed], dtype=np.int64)
        rows = [(v.x, v.y, v.yaw, v.half_angle, v.range_m) for v in posed]
        self._poses = np.array(rows, dtype=np.float64).reshape(-1, 5).T

    def at(self, stay: StayRecord, until_ms: int) -> list[Span]:
        """Return the looks at a place from when its thing came, by time; one round is one look.

        The floor plan tells, not what may hide the place: so of what is there some looks show it.
        """
        if stay.position is None or self._poses.size == 0:
            return []
        x, y, yaw, half_angle, range_m = self._poses
        dx, dy = stay.position[0] - x, stay.position[1] - y
        turn = np.abs((np.arctan2(dy, dx) - yaw + math.pi) % (2 * math.pi) - math.pi)
        shows = (np.hypot(dx, dy) <= range_m) & (turn <= half_angle) & (self._sites == stay.site)
        start, end = self._spans.T
        return _rounds(self._spans[shows & (end >= stay.first_ms) & (start <= until_ms)])


def _rounds(spans: NDArray[np.int64]) -> list[Span]:
    """Return spans (n, 2), by start, with those of one round made one."""
    out: list[Span] = []
    for start_ms, end_ms in spans.tolist():
        if out and start_ms - out[-1][1] <= ROUND_GAP_MS:
            out[-1] = (out[-1][0], max(out[-1][1], end_ms))
        else:
            out.append((start_ms, end_ms))
    return out
