"""Named rooms and coverage: where a sighting is, said as people say it.

Rooms are polygons in the ground plane (x, y); a position's own uncertainty decides how likely it
lies inside.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.answering.pairs import DEFAULT_SIGMA_M, normal_cdf
from d3a.model import Position
from d3a.store.base import Area, Region, StayRecord, Store, View

DAY_MS = 86_400_000
FAR_SIGMAS = 9.0
"""What is further from a room is not in it: how likely it is all the same changes no sum."""
_Bounds = tuple[float, float, float, float]


def probability_inside(region: Region, stays: Sequence[StayRecord]) -> NDArray[np.float64]:
    """Return how likely each stay lies inside of the room (n,), NaN without a position.

    The distance to the nearest wall against the position's deviation: on the wall it is 0.5. In a
    room of another site, which has a map of its own, is nothing: 0.
    """
    result = np.full(len(stays), np.nan)
    x_min, x_max, y_min, y_max = _bounds(region.polygon)
    for i, stay in enumerate(stays):
        if not is_of(region, stay.site):
            result[i] = -np.inf
        elif stay.position is not None:
            x, y, sigma = stay.position[0], stay.position[1], sigma_of(stay)
            away = max(x_min - x, x - x_max, y_min - y, y - y_max)  # of the box around it
            is_far = away > FAR_SIGMAS * sigma
            result[i] = -np.inf if is_far else _depth_inside(region.polygon, x, y) / sigma
    known = ~np.isnan(result)
    result[known] = normal_cdf(result[known])
    return result


def sigma_of(stay: StayRecord | None) -> float:
    """Return the deviation of a stay's position, metres: the mean over the axes."""
    if stay is None or stay.covariance is None:
        return DEFAULT_SIGMA_M
    variance = (stay.covariance[0] + stay.covariance[4] + stay.covariance[8]) / 3
    return max(math.sqrt(max(variance, 0.0)), 0.02)


def up_of(stay: StayRecord | None) -> float:
    """Return the deviation of a stay's height, metres; up is z, as floors are in the x-y plane."""
    if stay is None or stay.covariance is None:
        return DEFAULT_SIGMA_M
    return max(math.sqrt(max(stay.covariance[8], 0.0)), 0.02)


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
    xs, ys = zip(*region.polygon, strict=True)
    middle = (sum(xs) / len(xs), sum(ys) / len(ys))
    seen = [view.end_ms for view in views if _looks_into(view, region, middle)]
    return max(seen, default=None)


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


def _looks_into(view: View, region: Region, middle: tuple[float, float]) -> bool:
    if view.x is None or view.y is None or not is_of(region, view.site):
        return False
    if _depth_inside(region.polygon, view.x, view.y) >= 0:
        return True
    if view.yaw is None or view.half_angle is None or view.range_m is None:
        return False
    dx, dy = middle[0] - view.x, middle[1] - view.y
    turn = (math.atan2(dy, dx) - view.yaw + math.pi) % (2 * math.pi) - math.pi
    return math.hypot(dx, dy) <= view.range_m and abs(turn) <= view.half_angle


def _holds(polygon: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    """Return whether a place is inside or on a wall; how far the walls are is seldom needed."""
    return _is_inside(polygon, x, y) or _depth_inside(polygon, x, y) >= 0


def _is_inside(polygon: Sequence[tuple[float, float]], x: float, y: float) -> bool:
    inside = False
    x1, y1 = polygon[-1]
    for x2, y2 in polygon:
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
        x1, y1 = x2, y2
    return inside


def _depth_inside(polygon: Sequence[tuple[float, float]], x: float, y: float) -> float:
    """Return the distance to the nearest wall, negative outside."""
    nearest = math.inf
    for (x1, y1), (x2, y2) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        length2 = (x2 - x1) ** 2 + (y2 - y1) ** 2
        along = 0.0 if length2 == 0 else ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / length2
        along = min(1.0, max(0.0, along))
        nearest = min(nearest, math.hypot(x - x1 - along * (x2 - x1), y - y1 - along * (y2 - y1)))
    return nearest if _is_inside(polygon, x, y) else -nearest


def _bounds(polygon: Sequence[tuple[float, float]]) -> _Bounds:
    xs, ys = zip(*polygon, strict=True)
    return min(xs), max(xs), min(ys), max(ys)


def area_m2(polygon: Sequence[tuple[float, float]]) -> float:
    """Return the area of a room."""
    corners = zip(polygon, (*polygon[1:], polygon[0]), strict=True)
    return abs(sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in corners)) / 2
