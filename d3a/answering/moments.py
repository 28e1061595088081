"""What execution works on: found objects with their sightings, and the moments that answer.

A moment is what a question asks for: one sighting of one object, or several objects in a relation
over one interval.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from operator import attrgetter
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from d3a.answering.match import Candidate
from d3a.store.base import Sighting, StayKey, StayRecord

SPLIT_GAP_MS = 1
"""Intervals of one stay at most this far apart were split for the store's limit alone."""


class Stood(NamedTuple):
    """A thing at a place without being seen elsewhere, and what was seen of it then."""

    stay: StayKey
    start_ms: int
    end_ms: int
    seen: list[Sighting]


@dataclass(slots=True)
class Found:
    """What a variable of the query stands for so far; steps narrow it.

    candidates: by object id. place: how likely a sighting lies in the asked region.
    held: how likely the relation that describes the object ever held for a stay.
    refused: what the word means, but not the attributes; doubtful: candidates that hold them less
    likely than not, to be told only beside others. gone: sightings that no longer held at
    the moment asked for.
    known: whether a category, a taught name or a detector's class knows the word. unjudged: a
    condition of its own that was left out: of what is plastic nobody knows which cups are. stood:
    when its things stood where, if of all that was seen only what may be related was read.
    """

    candidates: dict[str, Candidate] = field(default_factory=dict)
    sightings: list[Sighting] = field(default_factory=list)
    stays: dict[StayKey, StayRecord] = field(default_factory=dict)
    place: dict[StayKey, float] = field(default_factory=dict)
    held: dict[StayKey, float] = field(default_factory=dict)
    known: bool = True
    unjudged: bool = False
    refused: list[Candidate] = field(default_factory=list)
    doubtful: frozenset[str] = frozenset()
    gone: list[Sighting] = field(default_factory=list)
    elsewhere: list[Sighting] = field(default_factory=list)
    stood: list[Stood] | None = None

    @property
    def ids(self) -> list[str]:
        """Return the ids of the candidates, sorted."""
        return sorted(self.candidates)

    def refuse_doubtful(self) -> None:
        """Count what is doubtful among what is refused."""
        self.refused += [c for name, c in self.candidates.items() if name in self.doubtful]
        self.candidates = {n: c for n, c in self.candidates.items() if n not in self.doubtful}
        self.sightings = [s for s in self.sightings if s.object_id not in self.doubtful]
        self.doubtful = frozenset()


class Entry(NamedTuple):
    """One object of a moment, with the picture that shows it. A tuple: there are hundreds.

    place, held: see `Found`; 1.0 where nothing was asked.
    """

    candidate: Candidate
    stay: StayRecord | None
    sighting: Sighting
    place: float = 1.0
    held: float = 1.0


class Moment(NamedTuple):
    """What was asked for, once: its entries (figure first), its closed interval.

    relation: how likely the asked relation held. share: of the object's time at this place,
    or of the time in which it moved that lies in the asked slice.
    absent_ms: when the place was seen without the object, for what is missing.
    """

    entries: tuple[Entry, ...]
    start_ms: int
    end_ms: int
    relation: float | None = None
    share: float | None = None

    @property
    def figure(self) -> Entry:
        """Return the entry of the query's first object."""
        return self.entries[0]

    @property
    def ids(self) -> tuple[str, ...]:
        """Return the ids of its objects, the figure's first."""
        return tuple([entry.sighting.object_id for entry in self.entries])  # quicker than lazily


class Stretch(NamedTuple):
    """A closed interval in which an object was so whenever it was seen.

    before: the last sighting of it, or of what may be it, that was not so, before the interval.
    """

    object_id: str
    start_ms: int
    end_ms: int
    before: Sighting | None = None


def joined(sightings: Iterable[Sighting]) -> list[Sighting]:
    """Join intervals that were split for the store's limit, by (start, object_id, place).

    The joined sighting has the keyframe of its most probable part; `seen` adds up.
    """
    out: list[Sighting] = []
    rows: dict[StayKey, int] = {}
    for sighting in sorted(sightings, key=_IN_ORDER):  # most come in it: that costs no more
        stay = (sighting.object_id, sighting.place)
        row = rows.get(stay)
        if row is None or sighting.start_ms - out[row].end_ms > SPLIT_GAP_MS:
            rows[stay] = len(out)
            out.append(sighting)
        else:  # it takes the place of its first part, whose start it has
            out[row] = _as_one(out[row], sighting)
    return out


_IN_ORDER = attrgetter("start_ms", "object_id", "place")


def _as_one(first: Sighting, second: Sighting) -> Sighting:
    best = first if first.probability >= second.probability else second
    return replace(
        best,
        start_ms=first.start_ms,
        end_ms=max(first.end_ms, second.end_ms),
        seen=first.seen + second.seen,
    )


def common_span(one: Sequence[Sighting], other: Sequence[Sighting]) -> tuple[int, int]:
    """Return the least start and the greatest end of what touches a sighting of either list."""
    first = max(min(s.start_ms for s in one), min(s.start_ms for s in other))
    last = min(max(s.end_ms for s in one), max(s.end_ms for s in other))
    return first, last


class Spanning(Protocol):
    """What has a closed interval of time: a sighting, a moment, a link of two things."""

    @property
    def start_ms(self) -> int:
        """Its start, UTC milliseconds."""

    @property
    def end_ms(self) -> int:
        """Its end, UTC milliseconds."""


def in_slice(told: Spanning, start_ms: int | None, end_ms: int | None) -> bool:
    """Whether a closed interval meets the half-open slice [start, end)."""
    return (end_ms is None or told.start_ms < end_ms) and (
        start_ms is None or told.end_ms >= start_ms
    )


def entry_of(found: Found, sighting: Sighting) -> Entry:
    """Return the entry of a sighting of one of the found objects."""
    stay = (sighting.object_id, sighting.place)
    return Entry(
        found.candidates[sighting.object_id],
        found.stays.get(stay),
        sighting,
        found.place.get(stay, 1.0) if found.place else 1.0,  # most are asked without
        found.held.get(stay, 1.0) if found.held else 1.0,
    )


def single(found: Found, sighting: Sighting) -> Moment:
    """Return the moment of one sighting."""
    return Moment((entry_of(found, sighting),), sighting.start_ms, sighting.end_ms)


def extents(found: Found, ids: Sequence[str]) -> NDArray[np.float64]:
    """Return how wide and high objects are (n, 2), metres, NaN where unknown.

    What nothing measured is as large as the others of its category usually are.
    """
    of = {name: found.candidates[name].record for name in dict.fromkeys(ids)}
    unknown = {record.category for record in of.values() if record.extent_m is None}
    alike: dict[str, list[tuple[float, float]]] = {category: [] for category in unknown}
    for record in (c.record for c in found.candidates.values()) if unknown else ():
        if record.extent_m is not None and record.category in unknown:
            alike[record.category].append(record.extent_m)
    usual = {kind: np.median(known, axis=0) for kind, known in alike.items() if known}
    nothing = np.full(2, np.nan)
    sizes = {
        name: usual.get(record.category, nothing) if record.extent_m is None else record.extent_m
        for name, record in of.items()
    }
    return np.array([sizes[name] for name in ids], dtype=np.float64).reshape(len(ids), 2)


def positions(stays: Sequence[StayRecord | None]) -> NDArray[np.float64]:
    """Return the positions of stays (n, 3) in metres, NaN where unknown."""
    unknown = (np.nan, np.nan, np.nan)
    rows = [stay.position if stay and stay.position else unknown for stay in stays]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def total_ms(intervals: Iterable[tuple[int, int]]) -> int:
    """Return the length of the union of closed intervals."""
    return sum(end - start for start, end in merged(intervals))


def merged(intervals: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the union of closed intervals as intervals apart from each other, by time."""
    out: list[tuple[int, int]] = []
    for start, end in sorted(intervals):
        if out and start <= out[-1][1]:
            out[-1] = (out[-1][0], max(out[-1][1], end))
        else:
            out.append((start, end))
    return out


def changes_of_place(sightings: Sequence[Sighting]) -> list[tuple[Sighting, Sighting]]:
    """Return (before, after) for each time one object was seen at another place than before.

    sightings: of one object, by start.
    """
    return [(a, b) for a, b in pairwise(sightings) if a.place != b.place]
