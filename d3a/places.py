"""Named rooms, landmarks and coverage: where a sighting is, said as people say it.

Rooms are polygons in the ground plane (x, y); a position's own uncertainty decides how likely it
lies inside. Landmarks are large things that stay: "next to the microwave".
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a.match import Lexicon
from d3a.model import Position
from d3a.pairs import DEFAULT_SIGMA_M, normal_cdf
from d3a.store.base import ObjectRecord, Region, StayRecord, View

LANDMARK_WORDS = frozenset(
    {"furniture", "shelf", "screen", "counter", "sink", "toilet", "bathtub", "shower"}
    | {"door", "window", "fireplace", "radiator", "stairs", "fixture", "rack", "piano"}
    | {"refrigerator", "freezer", "oven", "stove", "microwave", "dishwasher"}
    | {"washing machine", "dryer"}
)
"""What is large and stays where it is, by name or by a wider word."""
HOLLOW_WORDS = frozenset(
    {"container", "shelf", "cabinet", "drawer", "rack", "bag", "luggage", "drinkware", "dish"}
    | {"sink", "bathtub", "wardrobe", "closet", "crib", "vehicle"}
    | {"refrigerator", "freezer", "oven", "microwave", "dishwasher", "washing machine", "dryer"}
)
"""What other things are put into, by name or by a wider word."""
MOVABLE_WORDS = frozenset(
    {"chair", "stool", "ottoman", "pouf", "bean bag", "crib", "person", "animal", "vehicle"}
)
"""What does not stay, however large: it is never a landmark."""
LARGE_M = 1.0
"""A thing that is at least this wide or tall and stays is a landmark whatever it is called."""
SMALL_M = 0.35
"""A thing that is measured smaller is no landmark: its name is a mistake of the detector."""
LEAST_VIEWS = 4
LEAST_SHARE = 0.75
"""A landmark was seen so often, so much of it at one place and under one name."""
FAR_M = 6.0
"""Where nothing near has a name, a landmark within this distance tells the place, with metres."""
ROUNDING_M = 1e-6
"""More than what arrays may round a distance by."""


_Bounds = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Landmarks:
    """Large static things: ids, categories as people say them, positions in metres, by id."""

    ids: tuple[str, ...]
    categories: tuple[str, ...]
    places: tuple[Position, ...]
    _array: NDArray[np.float64] = field(init=False, repr=False, compare=False)
    _rows: dict[str, int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Keep the positions as an array (3, n) too, and which id is where."""
        places = np.array(self.places, dtype=np.float64).reshape(-1, 3).T
        object.__setattr__(self, "_array", places)
        object.__setattr__(self, "_rows", {name: row for row, name in enumerate(self.ids)})

    def nearest(
        self,
        stays: Sequence[StayRecord],
        limit_m: float,
        *,
        not_ids: Collection[str] = (),
        not_categories: Collection[str] = (),
    ) -> list[tuple[str, float] | None]:
        """Return category and distance of the nearest to each stay within the limit.

        The first by id of those as near; never the thing itself, nor what is ruled out.
        """
        found: list[tuple[str, float] | None] = [None] * len(stays)
        placed = [k for k, stay in enumerate(stays) if stay.position is not None]
        if not placed or not self.ids:
            return found
        positions = np.array([stays[k].position for k in placed]).T  # (3, p)
        x, y, z = positions[:, :, None] - self._array[:, None]  # (p, n) each
        apart = np.sqrt(x * x + y * y + z * z)
        named = zip(self.ids, self.categories, strict=True)
        apart[:, [i in not_ids or kind in not_categories for i, kind in named]] = np.inf
        for row, k in enumerate(placed):
            own = self._rows.get(stays[k].object_id)
            if own is not None:
                apart[row, own] = np.inf
        # arrays may round otherwise than one distance alone: the exact one decides among the near
        close = apart <= np.minimum(apart.min(axis=1), limit_m)[:, None] + ROUNDING_M
        for row, i in zip(*map(np.ndarray.tolist, np.nonzero(close)), strict=True):
            k, best = placed[row], found[placed[row]]
            exact = math.dist(stays[k].position or (), self.places[i])
            if exact <= limit_m and (best is None or exact < best[1]):
                found[k] = self.categories[i], exact
        return found


def is_landmark_word(category: str, lexicon: Lexicon, *, or_large: bool = False) -> bool:
    """Return whether things of a category are large and stay, by its name.

    or_large: also categories that do not say so, whose things may be large all the same.
    """
    name = lexicon.canonical(category)
    kinds = {name, *lexicon.broader(name)}
    return not kinds & MOVABLE_WORDS and (or_large or bool(kinds & LANDMARK_WORDS))


def is_hollow_word(category: str, lexicon: Lexicon) -> bool:
    """Return whether things of a category have room inside, by its name."""
    name = lexicon.canonical(category)
    return bool({name, *lexicon.broader(name)} & HOLLOW_WORDS)


def landmarks(
    records: Sequence[ObjectRecord], stays: Sequence[StayRecord], lexicon: Lexicon
) -> Landmarks:
    """Return the landmarks among objects: confirmed, large, and seen at one place alone.

    What is called furniture is large where nothing measured it. An object that has most of its
    views elsewhere, that is gone, or that was seldom seen so called, is none.
    """
    of: dict[str, list[StayRecord]] = {}
    for stay in stays:
        of.setdefault(stay.object_id, []).append(stay)
    chosen: list[tuple[str, str, Position]] = []
    for record in sorted(records, key=lambda r: r.object_id):
        main = max(of.get(record.object_id, []), key=lambda s: (s.seen, s.last_ms), default=None)
        if main is None or main.position is None or record.tentative or main.tentative:
            continue
        if _is_static(main, of[record.object_id]) and _is_large(record, lexicon):
            name = lexicon.canonical(record.category)
            chosen.append((record.object_id, name, main.position))
    return Landmarks(
        tuple(name for name, _, _ in chosen),
        tuple(category for _, category, _ in chosen),
        tuple(place for _, _, place in chosen),
    )


def _is_static(main: StayRecord, stays: Sequence[StayRecord]) -> bool:
    gone = main.last_absent_ms is not None and main.last_absent_ms > main.last_ms
    views = sum(stay.seen for stay in stays)
    return not gone and main.seen >= LEAST_VIEWS and main.seen >= LEAST_SHARE * views


def _is_large(record: ObjectRecord, lexicon: Lexicon) -> bool:
    votes = dict(record.categories)
    total = sum(votes.values())
    if total > 0 and votes.get(record.category, 0.0) < LEAST_SHARE * total:
        return False
    size = max(record.extent_m) if record.extent_m is not None else None
    if is_landmark_word(record.category, lexicon):
        return size is None or size >= SMALL_M
    return size is not None and size >= LARGE_M


def probability_inside(region: Region, stays: Sequence[StayRecord]) -> NDArray[np.float64]:
    """Return how likely each stay lies inside of the room (n,), NaN without a position.

    The distance to the nearest wall against the position's deviation: on the wall it is 0.5. In a
    room of another site, which has a map of its own, is nothing: 0.
    """
    result = np.full(len(stays), np.nan)
    for i, stay in enumerate(stays):
        if not is_of(region, stay.site):
            result[i] = -np.inf
        elif stay.position is not None:
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
    bounded = [(region, _bounds(region.polygon)) for region in regions]
    return [_room(bounded, *place) for place in places]


def _room(
    bounded: Sequence[tuple[Region, _Bounds]], position: Position | None, site: str
) -> str | None:
    if position is None:
        return None
    x, y = position[0], position[1]
    holding = [
        region
        for region, (x_min, x_max, y_min, y_max) in bounded
        if x_min <= x <= x_max
        and y_min <= y <= y_max
        and is_of(region, site)
        and _holds(region.polygon, x, y)
    ]
    if len(holding) < 2:
        return holding[0].name if holding else None
    return min(holding, key=lambda r: (area_m2(r.polygon), r.name)).name


def last_look(views: Sequence[View], region: Region) -> int | None:
    """Return when the robot last stood in a room or looked at its middle; None for never."""
    xs, ys = zip(*region.polygon, strict=True)
    middle = (sum(xs) / len(xs), sum(ys) / len(ys))
    seen = [view.end_ms for view in views if _looks_into(view, region, middle)]
    return max(seen, default=None)


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
    for (x1, y1), (x2, y2) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
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
