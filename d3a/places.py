"""Named rooms, landmarks and coverage: where a sighting is, said as people say it.

Rooms are polygons in the ground plane (x, y); a position's own uncertainty decides how likely it
lies inside. Landmarks are large things that stay: "next to the microwave".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.match import Lexicon
from d3a.model import Position
from d3a.relations import DEFAULT_SIGMA_M, normal_cdf
from d3a.store.base import ObjectRecord, Region, StayRecord, View

LANDMARK_KINDS = frozenset({"furniture", "appliance", "screen", "fixture"})
"""Broader words of what is large and stays where it is."""
LANDMARK_M = 0.8
"""A thing at least this wide or tall is a landmark whatever it is called."""


@dataclass(frozen=True, slots=True)
class Landmarks:
    """Large static things: object ids, categories and positions (n, 3), by id and place."""

    ids: tuple[str, ...]
    categories: tuple[str, ...]
    position: NDArray[np.float64]

    def nearest(self, position: Position | None, own: str, limit_m: float) -> str | None:
        """Return the category of the nearest one within the limit that is not the thing itself."""
        if position is None or not self.ids:
            return None
        distance = np.linalg.norm(self.position - np.array(position), axis=1)
        distance[[i for i, name in enumerate(self.ids) if name == own]] = np.inf
        best = int(np.argmin(distance))
        return self.categories[best] if distance[best] <= limit_m else None


def landmark_categories(categories: Sequence[str], lexicon: Lexicon) -> list[str]:
    """Return the categories, as the store spells them, whose things are large and stay."""
    return [
        category
        for category in categories
        if LANDMARK_KINDS & set(lexicon.broader(lexicon.canonical(category)))
    ]


def landmarks(records: Sequence[ObjectRecord], stays: Sequence[StayRecord]) -> Landmarks:
    """Return the landmarks among objects at their stays; what has no position is none.

    A thing that a person moved is where it was seen last.
    """
    category = {record.object_id: record.category for record in records}
    newest: dict[str, StayRecord] = {}
    for stay in stays:
        known = newest.get(stay.object_id)
        if (
            stay.position is not None
            and stay.object_id in category
            and (known is None or stay.last_ms > known.last_ms)
        ):
            newest[stay.object_id] = stay
    ids = tuple(sorted(newest))
    position = [newest[name].position for name in ids]
    return Landmarks(
        ids,
        tuple(category[name] for name in ids),
        np.array(position, dtype=np.float64).reshape(-1, 3),
    )


def probability_inside(region: Region, stays: Sequence[StayRecord]) -> NDArray[np.float64]:
    """Return how likely each stay lies inside of the room (n,), NaN without a position.

    The distance to the nearest wall against the position's deviation: on the wall it is 0.5.
    """
    result = np.full(len(stays), np.nan)
    for i, stay in enumerate(stays):
        if stay.position is not None:
            depth = _depth_inside(region.polygon, stay.position[0], stay.position[1])
            result[i] = depth / sigma_of(stay)
    known = ~np.isnan(result)
    result[known] = normal_cdf(result[known])
    return result


def sigma_of(stay: StayRecord | None) -> float:
    """Return the deviation of a stay's position, metres: the mean over the axes."""
    if stay is None or stay.covariance is None:
        return DEFAULT_SIGMA_M
    variance = (stay.covariance[0] + stay.covariance[4] + stay.covariance[8]) / 3
    return max(math.sqrt(max(variance, 0.0)), 0.02)


def room_of(regions: Sequence[Region], position: Position | None) -> str | None:
    """Return the name of the room that holds a position, the smallest where rooms overlap."""
    if position is None:
        return None
    holding = [r for r in regions if _depth_inside(r.polygon, position[0], position[1]) >= 0]
    return min(holding, key=lambda r: (_size(r.polygon), r.name)).name if holding else None


def last_look(views: Sequence[View], region: Region) -> int | None:
    """Return when the robot last stood in a room or looked at its middle; None for never."""
    xs, ys = zip(*region.polygon, strict=True)
    middle = (sum(xs) / len(xs), sum(ys) / len(ys))
    seen = [view.end_ms for view in views if _looks_into(view, region, middle)]
    return max(seen, default=None)


def _looks_into(view: View, region: Region, middle: tuple[float, float]) -> bool:
    if view.x is None or view.y is None:
        return False
    if _depth_inside(region.polygon, view.x, view.y) >= 0:
        return True
    if view.yaw is None or view.half_angle is None or view.range_m is None:
        return False
    dx, dy = middle[0] - view.x, middle[1] - view.y
    turn = (math.atan2(dy, dx) - view.yaw + math.pi) % (2 * math.pi) - math.pi
    return math.hypot(dx, dy) <= view.range_m and abs(turn) <= view.half_angle


def _depth_inside(polygon: Sequence[tuple[float, float]], x: float, y: float) -> float:
    """Return the distance to the nearest wall, negative outside."""
    inside, nearest = False, math.inf
    for (x1, y1), (x2, y2) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
        length2 = (x2 - x1) ** 2 + (y2 - y1) ** 2
        along = 0.0 if length2 == 0 else ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / length2
        along = min(1.0, max(0.0, along))
        nearest = min(nearest, math.hypot(x - x1 - along * (x2 - x1), y - y1 - along * (y2 - y1)))
    return nearest if inside else -nearest


def _size(polygon: Sequence[tuple[float, float]]) -> float:
    corners = zip(polygon, (*polygon[1:], polygon[0]), strict=True)
    return abs(sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in corners)) / 2
