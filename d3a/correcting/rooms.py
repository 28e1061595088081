"""Rooms as people give them: corners, a circle around a point, where the robot stands."""

from __future__ import annotations

import math
from collections.abc import Sequence

from d3a.model import BadInput, Json
from d3a.store.base import Region, Store

ROUND_CORNERS = 16
"""Corners of a room that is given as a circle."""
Corner = tuple[float, float]


def circle(middle: Corner, radius_m: float) -> tuple[Corner, ...]:
    """Return the corners of a round place, metres; raises BadInput for no radius."""
    if not math.isfinite(radius_m) or radius_m <= 0:
        raise BadInput(f"a radius of {radius_m} m is not above 0")
    turns = (2 * math.pi * k / ROUND_CORNERS for k in range(ROUND_CORNERS))
    x, y = middle
    return tuple((x + radius_m * math.cos(t), y + radius_m * math.sin(t)) for t in turns)


def robot_position(store: Store) -> Corner:
    """Return where the robot stood when it looked last."""
    newest = store.last_view_ms()
    views = store.views(start_ms=newest) if newest is not None else []
    for view in reversed(views):
        if view.x is not None and view.y is not None:
            return view.x, view.y
    raise BadInput("where the robot stands is not known: say the place's corners or a point")


def checked_polygon(corners: Sequence[Corner]) -> tuple[Corner, ...]:
    """Return the corners of a room; raises BadInput for what encloses nothing or crosses itself."""
    points = [(float(x), float(y)) for x, y in corners]
    if not all(math.isfinite(v) for point in points for v in point):
        raise BadInput("a corner is not finite")
    if len(points) > 1 and points[0] == points[-1]:
        points.pop()
    if len(points) < 3:
        raise BadInput("a place needs three corners or more")
    sides = list(zip(points, [*points[1:], points[0]], strict=True))
    if abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in sides)) < 1e-6:
        raise BadInput("the corners lie on one line: they enclose nothing")
    count = len(sides)
    for i in range(count):
        for j in range(i + 2, count - (i == 0)):
            if _cross(*sides[i], *sides[j]):
                raise BadInput("the polygon crosses itself: give its corners in order")
    return tuple(points)


def _cross(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    def side(p: Corner, q: Corner, r: Corner) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def region_json(region: Region) -> Json:
    """Return a region as JSON."""
    return {
        "name": region.name,
        "polygon": [list(corner) for corner in region.polygon],
        "site": region.site,
    }


def region_of(record: Json) -> Region:
    """Return what `region_json` wrote."""
    corners = tuple((float(x), float(y)) for x, y in record["polygon"])
    return Region(record["name"], corners, record["site"])
