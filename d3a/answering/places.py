"""Named rooms and coverage: where a sighting is, said as people say it.

Rooms are polygons in the ground plane (x, y); a position's own uncertainty decides how likely it
lies inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.answering.pairs import DEFAULT_SIGMA_M, normal_cdf
from d3a.model import Position
from d3a.store.base import Area, Positions, Region, StayRecord, Store, View

DAY_MS = 86_400_000
SUREST_M = 0.02
"""No position is known better."""
Floats = NDArray[np.float64]
_Bounds = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Rooms:
    """The rooms that are asked for: inside of any of them, or outside of all of them."""

    regions: tuple[Region, ...]
    outside: bool = False

    @property
    def one(self) -> Region | None:
        """Return the one room inside of which is asked for, None of others."""
        return None if self.outside or len(self.regions) > 1 else self.regions[0]

    def probability(self, positions: Positions) -> Floats:
        """Return how likely each stay is where it is asked for (n,), NaN without a position."""
        every = np.stack([_chance_inside(region, positions) for region in self.regions])
        inside = np.minimum(1.0, every.sum(axis=0))
        return np.asarray(1.0 - inside if self.outside else inside)

    def holding(self, stays: Sequence[StayRecord]) -> Floats:
        """Return the same of stays that were read."""
        return self.probability(Positions.of_stays([s.object_id for s in stays], stays))


def probability_inside(region: Region, stays: Sequence[StayRecord]) -> Floats:
    """Return how likely each stay lies inside of the room (n,), NaN without a position."""
    return Rooms((region,)).holding(stays)


def _chance_inside(region: Region, positions: Positions) -> Floats:
    """Return how likely each stay lies inside of the room (n,), NaN without a position.

    The distance to the nearest wall against the position's deviation: on the wall it is 0.5. In a
    room of another site, which has a map of its own, is nothing: 0.
    """
    depth = _depths_inside(region.polygon, positions.x, positions.y)
    deviation = np.maximum(np.sqrt(np.maximum(positions.variance, 0.0)), SUREST_M)
    away = depth / np.where(np.isnan(deviation), DEFAULT_SIGMA_M, deviation)
    there = np.array([is_of(region, site) for site in positions.sites], dtype=np.bool_)
    away[~there[positions.site]] = -np.inf
    known = ~np.isnan(away)
    away[known] = normal_cdf(away[known])
    return away


def sigma_of(stay: StayRecord | None) -> float:
    """Return the deviation of a stay's position, metres: the mean over the axes."""
    if stay is None or stay.covariance is None:
        return DEFAULT_SIGMA_M
    variance = (stay.covariance[0] + stay.covariance[4] + stay.covariance[8]) / 3
    return max(math.sqrt(max(variance, 0.0)), SUREST_M)


def up_of(stay: StayRecord | None) -> float:
    """Return the deviation of a stay's height, metres; up is z, as floors are in the x-y plane."""
    if stay is None or stay.covariance is None:
        return DEFAULT_SIGMA_M
    return max(math.sqrt(max(stay.covariance[8], 0.0)), SUREST_M)


def is_of(region: Region, site: str) -> bool:
    """Say whether a room is on the map of a site; one without a site is on every map."""
    return region.site in ("", site)


def room_of(regions: Sequence[Region], position: Position | None, site: str) -> str | None:
    """Return the name of the site's room that holds a position, the smallest of several."""
    return rooms_of(regions, [(position, site)])[0]


def rooms_of(
    regions: Sequence[Region], places: Iterable[tuple[Position | None, str]]
) -> list[str | None]:
    """Return the name of the room that holds each place, see `room_of`. places: with their site."""
    return [smallest(holding) for holding in holders_of(regions, places)]


def holders_of(
    regions: Sequence[Region], places: Iterable[tuple[Position | None, str]]
) -> list[list[Region]]:
    """Return all rooms that hold each place, with their walls. places: with their site."""
    bounded = [(region, _bounds(region.polygon)) for region in regions]
    return [_holders(bounded, *place) for place in places]


def smallest(holding: Sequence[Region]) -> str | None:
    """Return the name of the smallest of some rooms, None of none."""
    if len(holding) < 2:
        return holding[0].name if holding else None
    return min(holding, key=lambda r: (area_m2(r.polygon), r.name)).name


def box_of(region: Region) -> Area:
    """Return the box around a room."""
    x_min, x_max, y_min, y_max = _bounds(region.polygon)
    return Area(x_min, y_min, x_max, y_max)


def is_box(region: Region) -> bool:
    """Whether a room is the box around it, on every map."""
    x_min, x_max, y_min, y_max = _bounds(region.polygon)
    corners = {(x, y) for x in (x_min, x_max) for y in (y_min, y_max)}
    crossing = area_m2(region.polygon) == 0  # the corners in another order
    return (
        {*region.polygon} == corners and len(region.polygon) == 4 and not (crossing or region.site)
    )


def _holders(
    bounded: Sequence[tuple[Region, _Bounds]], position: Position | None, site: str
) -> list[Region]:
    if position is None:
        return []
    x, y = position[0], position[1]
    return [
        region
        for region, (x_min, x_max, y_min, y_max) in bounded
        if x_min <= x <= x_max
        and y_min <= y <= y_max
        and is_of(region, site)
        and _holds(region.polygon, x, y)
    ]


def last_look(views: Sequence[View], region: Region) -> int | None:
    """Return when the robot last stood in a room or looked at its middle; None for never."""
    placed = [view for view in views if view.x is not None and is_of(region, view.site)]
    seen = [(v.x, v.y, v.yaw, v.half_angle, v.range_m) for v in placed]
    x, y, yaw, half_angle, range_m = np.array(seen, dtype=np.float64).reshape(-1, 5).T
    xs, ys = zip(*region.polygon, strict=True)
    dx, dy = sum(xs) / len(xs) - x, sum(ys) / len(ys) - y
    turn = (np.arctan2(dy, dx) - yaw + math.pi) % (2 * math.pi) - math.pi
    looked = (np.hypot(dx, dy) <= range_m) & (np.abs(turn) <= half_angle)  # no yaw: False
    rows = np.flatnonzero(looked | (_depths_inside(region.polygon, x, y) >= 0))
    return max((placed[row].end_ms for row in rows.tolist()), default=None)


def newest_look(store: Store, region: Region, newest_ms: int | None) -> int | None:
    """Return `last_look` of all views; the newest are read first, and mostly tell.

    newest_ms: of the newest frame. Raises StoreError.
    """
    width = DAY_MS
    while newest_ms is not None and width < newest_ms:
        found = last_look(store.views(start_ms=newest_ms - width), region)
        if found is not None:
            return found
        width *= 8
    return last_look(store.views(), region)


def _holds(polygon: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    """Return whether one place is inside or on a wall; how far the walls are is not needed."""
    return _is_inside(polygon, x, y) or any(
        (x2 - x1) * (y - y1) == (y2 - y1) * (x - x1)
        and min(x1, x2) <= x <= max(x1, x2)
        and min(y1, y2) <= y <= max(y1, y2)
        for (x1, y1), (x2, y2) in _walls(polygon)
    )


def _is_inside(polygon: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    inside = False
    for (x1, y1), (x2, y2) in _walls(polygon):
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
    return inside


def _depths_inside(polygon: Sequence[tuple[float, float]], x: Floats, y: Floats) -> Floats:
    """Return the distance of each place to the nearest wall (n,), negative outside."""
    nearest, inside = np.full(len(x), math.inf), np.zeros(len(x), dtype=np.bool_)
    for (x1, y1), (x2, y2) in _walls(polygon):
        wide, high, right, up = x2 - x1, y2 - y1, x - x1, y - y1
        length2 = wide**2 + high**2
        along = (right * wide + up * high) / (length2 or 1.0)
        along = np.minimum(1.0, np.maximum(0.0, along))
        nearest = np.minimum(nearest, np.hypot(right - along * wide, up - along * high))
        if high:
            inside ^= ((y1 > y) != (y2 > y)) & (x < wide * up / high + x1)
    return np.where(inside, nearest, -nearest)


def _walls(
    polygon: Sequence[tuple[float, float]],
) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the ends of each wall."""
    return zip(polygon, (*polygon[1:], polygon[0]), strict=True)


def _bounds(polygon: Sequence[tuple[float, float]]) -> _Bounds:
    xs, ys = zip(*polygon, strict=True)
    return min(xs), max(xs), min(ys), max(ys)


def area_m2(polygon: Sequence[tuple[float, float]]) -> float:
    """Return the area of a room."""
    return abs(sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in _walls(polygon))) / 2
