"""Landmarks: large things that stay, which tell where others are: "next to the microwave".

A landmark of another room is behind a wall, however near it is.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a.answering.match import Lexicon
from d3a.answering.places import holders_of
from d3a.model import Position
from d3a.store.base import ObjectRecord, Region, StayKey, StayRecord
from grammar.forms import RelationKind

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


@dataclass(frozen=True, slots=True)
class Landmarks:
    """Large static things: where each stays, categories as people say them, positions, by id.

    places: metres. sites: whose map each is on. rooms: the names of those that hold it; () where
    none does.
    """

    stays: tuple[StayKey, ...]
    categories: tuple[str, ...]
    places: tuple[Position, ...]
    sites: tuple[str, ...]
    rooms: tuple[tuple[str, ...], ...]
    _array: NDArray[np.float64] = field(init=False, repr=False, compare=False)
    _rows: dict[str, int] = field(init=False, repr=False, compare=False)
    _held: dict[str, NDArray[np.bool_]] = field(init=False, repr=False, compare=False)
    _mapped: dict[str, NDArray[np.bool_]] = field(init=False, repr=False, compare=False)
    _nameless: NDArray[np.bool_] = field(init=False, repr=False, compare=False)
    _open: dict[tuple[str, tuple[str, ...]], NDArray[np.bool_]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        """Keep the positions as an array (3, n) too, which id is where, and what each room has."""
        places = np.array(self.places, dtype=np.float64).reshape(-1, 3).T
        object.__setattr__(self, "_array", places)
        object.__setattr__(self, "_rows", {name: row for row, (name, _) in enumerate(self.stays)})
        names = {name for held in self.rooms for name in held}
        held = {name: np.array([name in each for each in self.rooms]) for name in names}
        object.__setattr__(self, "_held", held)
        nameless = np.array([not each for each in self.rooms], dtype=np.bool_)
        object.__setattr__(self, "_nameless", nameless)
        mapped = {site: np.array([site == each for each in self.sites]) for site in {*self.sites}}
        object.__setattr__(self, "_mapped", mapped)

    def __contains__(self, object_id: str) -> bool:
        """Say whether a thing is one of them."""
        return object_id in self._rows

    def nearest(
        self,
        stays: Sequence[StayRecord],
        limit_m: float,
        rooms: Sequence[tuple[str, ...]],
        *,
        without: Collection[int] = (),
    ) -> list[tuple[str, float] | None]:
        """Return category and distance of the nearest to each stay within the limit.

        rooms: the names of those that hold each stay. What is in other rooms alone is behind a
        wall, and on another site's map it is nowhere near. The first by id of those as near; never
        the thing itself, nor what is in the rows that are ruled out.
        """
        found: list[tuple[str, float] | None] = [None] * len(stays)
        placed = [k for k, stay in enumerate(stays) if stay.position is not None]
        if not placed or not self.stays:
            return found
        positions = np.array([stays[k].position for k in placed]).T  # (3, p)
        x, y, z = positions[:, :, None] - self._array[:, None]  # (p, n) each
        reachable = np.array([self._reachable(stays[k].site, rooms[k]) for k in placed])
        reachable[:, [*without]] = False
        apart = np.where(reachable, np.sqrt(x * x + y * y + z * z), np.inf)
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

    def _reachable(self, site: str, rooms: tuple[str, ...]) -> NDArray[np.bool_]:
        """Return which landmarks (n,) are on a site, and in one of the rooms or in none."""
        known = self._open.get((site, rooms))
        if known is None:
            known = self._open[site, rooms] = self._reached(site, rooms)
        return known

    def _reached(self, site: str, rooms: tuple[str, ...]) -> NDArray[np.bool_]:
        nothing = np.zeros(len(self.stays), dtype=np.bool_)
        mapped = self._mapped.get(site, nothing)
        if not rooms or not self._held:
            return mapped
        within = [self._held.get(name, nothing) for name in rooms]
        return np.asarray(mapped & (np.logical_or.reduce(within) | self._nameless))


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


def usual_grounds(
    kind: RelationKind, categories: Iterable[str], lexicon: Lexicon
) -> frozenset[str]:
    """Return the categories that things usually stand in the relation to, see `Facts`."""
    if kind == "under":
        return frozenset(
            category
            for category in categories
            if "furniture" in lexicon.broader(lexicon.canonical(category))
        )
    if kind == "in":
        return frozenset(c for c in categories if is_hollow_word(c, lexicon))
    if kind in ("on", "above"):
        return frozenset(
            category
            for category in categories
            if is_landmark_word(category, lexicon)
            and (kind != "above" or not is_hollow_word(category, lexicon))
        )
    return frozenset()


def landmarks(
    records: Sequence[ObjectRecord],
    stays: Sequence[StayRecord],
    regions: Sequence[Region],
    lexicon: Lexicon,
) -> Landmarks:
    """Return the landmarks among objects: confirmed, large, and seen at one place alone.

    What is called furniture is large where nothing measured it. An object that has most of its
    views elsewhere, that is gone, or that was seldom seen so called, is none.
    """
    of: dict[str, list[StayRecord]] = {}
    for stay in stays:
        of.setdefault(stay.object_id, []).append(stay)
    chosen: list[tuple[ObjectRecord, StayRecord, Position]] = []
    for record in sorted(records, key=lambda r: r.object_id):
        main = max(of.get(record.object_id, []), key=lambda s: (s.seen, s.last_ms), default=None)
        if main is None or main.position is None or record.tentative or main.tentative:
            continue
        if _is_static(main, of[record.object_id]) and _is_large(record, lexicon):
            chosen.append((record, main, main.position))
    holders = holders_of(regions, [(place, main.site) for _, main, place in chosen])
    return Landmarks(
        tuple(main.key for _, main, _ in chosen),
        tuple(lexicon.canonical(record.category) for record, _, _ in chosen),
        tuple(place for _, _, place in chosen),
        tuple(main.site for _, main, _ in chosen),
        tuple(tuple(region.name for region in holding) for holding in holders),
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
