"""Which sightings count where there are too many to tell: the newest of each stay."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from d3a.store.base import (
    Area,
    Positions,
    Sighting,
    SightingKey,
    Spans,
    StayKey,
    StayRecord,
)


class _Reader(Protocol):
    """The two questions of a store that the others can be answered by."""

    def stays(self, *, object_ids: Sequence[str] | None = None) -> list[StayRecord]: ...

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Sighting]: ...


class ByReading:
    """What a store answers by reading all of some objects: right, and not quick."""

    def stays_at(self: _Reader, keys: Sequence[StayKey]) -> list[StayRecord]:
        """Return these stays of those that there are, by (object_id, place)."""
        wanted = set(keys)
        return [s for s in self.stays(object_ids=sorted({k for k, _ in keys})) if s.key in wanted]

    def sightings_at(self: _Reader, keys: Sequence[SightingKey]) -> list[Sighting]:
        """Return these sightings of those that there are, by (start, object_id, place)."""
        wanted = set(keys)
        found = self.sightings(object_ids=sorted({name for name, *_ in keys}))
        return [s for s in found if (*s.stay, s.start_ms) in wanted]

    def spans(
        self: _Reader,
        object_ids: Sequence[str],
        *,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> Spans:
        """Return when objects were seen, see `Store.spans`."""
        found = self.sightings(object_ids=object_ids, area=area, start_ms=start_ms, end_ms=end_ms)
        every = Spans.of_sightings(object_ids, found)
        return every if limit is None else every.chosen(np.arange(min(limit, len(every))))

    def positions(self: _Reader, object_ids: Sequence[str]) -> Positions:
        """Return where the stays of objects are, see `Store.positions`."""
        return Positions.of_stays(object_ids, self.stays(object_ids=object_ids))

    def newest(
        self: _Reader,
        object_ids: Sequence[str],
        limit: int,
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
        oldest: bool = False,
    ) -> list[Sighting]:
        """Return at most `limit` sightings, the newest of each stay first; see `Store.newest`."""
        found = self.sightings(object_ids=object_ids, start_ms=start_ms, end_ms=end_ms)
        return newest_of(found, limit, oldest=oldest)

    def reach(
        self: _Reader, object_ids: Sequence[str], count: int, *, oldest: bool = False
    ) -> int | None:
        """Return the start of the count-th newest (or oldest) sighting of any of the objects."""
        found = self.sightings(object_ids=object_ids)
        return found[count - 1 if oldest else -count].start_ms if len(found) >= count else None

    def count_seen(
        self: _Reader,
        object_ids: Sequence[str],
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> int:
        """Count the objects with a sighting that touches the closed [start, end]."""
        found = self.sightings(object_ids=object_ids, start_ms=start_ms, end_ms=end_ms)
        return len({sighting.object_id for sighting in found})


def newest_of(sightings: Sequence[Sighting], limit: int, *, oldest: bool = False) -> list[Sighting]:
    """Return at most `limit` of the sightings, as `Store.newest` says; both in its order."""
    if len(sightings) <= limit:
        return list(sightings)
    each = max(1, limit // len({sighting.stay for sighting in sightings}))
    taken: Counter[StayKey] = Counter()
    found: list[Sighting] = []
    for sighting in sightings if oldest else reversed(sightings):
        if taken[sighting.stay] < each:
            taken[sighting.stay] += 1
            found.append(sighting)
            if len(found) == limit:
                break
    return found if oldest else found[::-1]


def is_whole(found: Sequence[Sighting], limit: int) -> bool:
    """Whether what `Store.newest` chose for a limit is surely all that there is.

    Of more than the limit each stay gives the same share: none of them is cut that gave less.
    """
    if len(found) >= limit:
        return False
    given = Counter(sighting.stay for sighting in found)
    return max(1, limit // max(len(given), 1)) not in given.values()
