"""How many things there must be: an id is no proof, a moved thing often gets a new one.

Two objects of one category may be one thing that was carried, unless one round showed both. So
the ids are the most that there may be, and the fullest round tells the least.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterable, Sequence
from operator import attrgetter

from d3a.model import Position
from d3a.store.base import ObjectRecord, Sighting

ROUND_GAP_MS = 600_000
"""Sightings further apart than this are of two rounds: between them a thing may be carried."""


_BY_TIME = attrgetter("start_ms", "end_ms", "object_id", "place")


def rounds(sightings: Iterable[Sighting]) -> list[list[Sighting]]:
    """Return the sightings in groups that no gap divides, by time."""
    out: list[list[Sighting]] = []
    end_ms = 0
    for sighting in sorted(sightings, key=_BY_TIME):
        if out and sighting.start_ms - end_ms <= ROUND_GAP_MS:
            out[-1].append(sighting)
            end_ms = max(end_ms, sighting.end_ms)
        else:
            out.append([sighting])
            end_ms = sighting.end_ms
    return out


def rounds_of(sightings: Iterable[Sighting]) -> dict[str, set[int]]:
    """Return the rounds that showed each object, by number."""
    shown: dict[str, set[int]] = {}
    for number, one in enumerate(rounds(sightings)):
        for sighting in one:
            shown.setdefault(sighting.object_id, set()).add(number)
    return shown


def least_number(sightings: Sequence[Sighting]) -> int:
    """Return how many things of one category there must be: the most objects of one round."""
    return max((len({s.object_id for s in one}) for one in rounds(sightings)), default=0)


def may_be_one(sightings: Sequence[Sighting]) -> bool:
    """Whether the objects of these sightings, of one category, may be fewer than their ids."""
    return least_number(sightings) < len({s.object_id for s in sightings})


def things_of(records: Iterable[ObjectRecord]) -> dict[str, int]:
    """Return a number for each object by its id, the same for those that may be one thing.

    They are of one category and site, and each was seen for the last time before the next was seen
    at all. Each goes to the first group, in the order given, that it may belong to; as a thing is
    in one place at a time, it must fit all of the group.
    """
    numbers: dict[str, int] = {}
    kinds: dict[tuple[str, str], _Kind] = {}
    for record in records:
        if record.object_id not in numbers:
            kind = kinds.setdefault((record.site, record.category), _Kind())
            span = (record.first_ms, record.last_ms)
            numbers[record.object_id] = kind.add(span, len(numbers))
    return numbers


class _Kind:
    """The things of one category and site: the spans over which each was seen, in order."""

    def __init__(self) -> None:
        self._things: list[tuple[int, list[tuple[int, int]]]] = []
        self._first_end, self._last_start = math.inf, -math.inf

    def add(self, span: tuple[int, int], number: int) -> int:
        """Return the number of the first thing that was out of sight then, else make a new one."""
        found = None
        # Most things are seen all the time: what overlaps every span needs no further look.
        if self._first_end < span[0] or span[1] < self._last_start:
            found = next((each for each in self._things if _fits(span, each[1])), None)
        if found is None:
            self._things.append((number, [span]))
        else:
            number = found[0]
            found[1].insert(bisect(found[1], span), span)
        self._first_end = min(self._first_end, span[1])
        self._last_start = max(self._last_start, span[0])
        return number


def _fits(span: tuple[int, int], spans: Sequence[tuple[int, int]]) -> bool:
    """Whether a span overlaps none of those, which are in order and apart from each other."""
    place = bisect(spans, span)
    is_after = place == 0 or spans[place - 1][1] < span[0]
    return is_after and (place == len(spans) or span[1] < spans[place][0])


class Apart:
    """Places none of which is within `reach_m` of another, found by the cells of a grid."""

    def __init__(self, reach_m: float) -> None:
        self._reach_m = reach_m
        self._size_m = 2 * reach_m or 1.0
        self._cells: dict[tuple[float, float], list[Position]] = {}

    def add(self, at: Position) -> bool:
        """Take a place in that is away from all the others; say whether it is."""
        reach, size = self._reach_m, self._size_m
        low, high = (at[0] - reach) // size, (at[0] + reach) // size
        near, far = (at[1] - reach) // size, (at[1] + reach) // size
        for column in (low,) if low == high else (low, high):
            for row in (near,) if near == far else (near, far):
                for other in self._cells.get((column, row), ()):
                    if math.dist(at, other) < reach:
                        return False
        self._cells.setdefault((at[0] // size, at[1] // size), []).append(at)
        return True
