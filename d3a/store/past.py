"""A store as it was known at some time: nothing that was seen later is in it.

A question that is asked as of an earlier `now` goes by this view, so that all its steps, whatever
they read, look back from there. What tells things apart and what they are called (votes, weight,
looks, taught names, places of stays) is what is known of them today: what a thing is, is no event.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.store.base import (
    Area,
    Encounter,
    ObjectRecord,
    Positions,
    Sighting,
    SightingKey,
    Spans,
    StayKey,
    StayRecord,
    Store,
    TaughtName,
    View,
)

DAY_MS = 86_400_000


class PastStore:
    """What a store held of `until_ms` and before; to read alone. Methods: see `Store`.

    An interval that goes on after `until_ms` ends there; a picture that was taken later is left
    out. That a place was seen without a thing is known where the newest such look is not later.
    What has no time (rooms, names, pictures by key, meta) is the store's own.
    """

    def __init__(self, store: Store, until_ms: int) -> None:
        self._store, self._until_ms = store, until_ms

    def __getattr__(self, name: str) -> Any:
        """Return what of the store no time cuts."""
        return getattr(self._store, name)

    def _end(self, end_ms: int | None) -> int:
        return self._until_ms if end_ms is None else min(end_ms, self._until_ms)

    def _is_later(self, time_ms: int | None) -> bool:
        return time_ms is not None and time_ms > self._until_ms

    # OIc
    def objects(
        self,
        *,
        ids: Sequence[str] | None = None,
        categories: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        votes: bool = False,
        embeddings: bool = True,
    ) -> list[ObjectRecord]:
        """Return the objects that were seen by then."""
        found = self._store.objects(
            ids=ids, categories=categories, names=names, votes=votes, embeddings=embeddings
        )
        return [
            r if r.last_ms <= self._until_ms else replace(r, last_ms=self._until_ms)
            for r in found
            if not self._is_later(r.first_ms)
        ]

    def categories(self) -> list[tuple[str, int]]:
        """Return (category, objects of it that were seen by then), by category."""
        return sorted(Counter(r.category for r in self.objects(embeddings=False)).items())

    def names(self) -> list[TaughtName]:
        """Return what people call the objects that were seen by then, by (word, owner or "")."""
        called = self.objects(names=[n.word for n in self._store.names()], embeddings=False)
        names = {name for record in called for name in record.names}
        return [name for name in self._store.names() if name in names]

    def embeddings(self, limit: int | None = None) -> tuple[list[str], NDArray[np.float32]]:
        """Return the ids and looks of what was seen by then, of the first `limit` of the store."""
        ids, matrix = self._store.embeddings(limit)
        seen = {record.object_id for record in self.objects(ids=ids, embeddings=False)}
        rows = [row for row, name in enumerate(ids) if name in seen]
        return [ids[row] for row in rows], matrix[rows]

    # STc
    def stays(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[StayRecord]:
        """Return the stays that had begun."""
        found = self._store.stays(
            object_ids=object_ids, area=area, start_ms=start_ms, end_ms=self._end(end_ms)
        )
        cut = self._cut_stays(found)
        return cut if start_ms is None else [stay for stay in cut if stay.last_ms >= start_ms]

    def stays_at(self, keys: Sequence[StayKey]) -> list[StayRecord]:
        """Return those of these stays that had begun."""
        return self._cut_stays(self._store.stays_at(keys))

    def _cut_stays(self, stays: Sequence[StayRecord]) -> list[StayRecord]:
        """Return the stays as they were known: until when seen, and since when seen without."""
        until = self._until_ms
        begun = [stay for stay in stays if stay.first_ms <= until]
        on = sorted({stay.object_id for stay in begun if stay.last_ms > until})
        last: dict[StayKey, int] = {}
        spans = self.spans(on) if on else None
        for stay, end in zip(spans.stays(), spans.end_ms.tolist(), strict=True) if spans else ():
            last[stay] = max(end, last.get(stay, end))
        return [
            replace(
                stay,
                last_ms=last.get(stay.key, until) if stay.last_ms > until else stay.last_ms,
                last_absent_ms=None if self._is_later(stay.last_absent_ms) else stay.last_absent_ms,
            )
            for stay in begun
        ]

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> list[Sighting]:
        """Return the sightings that had begun."""
        end = self._end(end_ms)
        if self._is_later(start_ms):
            return []
        found = self._store.sightings(
            object_ids=object_ids, area=area, start_ms=start_ms, end_ms=end, limit=limit
        )
        return [self._cut(sighting) for sighting in found]

    def sightings_at(self, keys: Sequence[SightingKey]) -> list[Sighting]:
        """Return those of these sightings that had begun."""
        begun = [key for key in keys if key[2] <= self._until_ms]
        return [self._cut(sighting) for sighting in self._store.sightings_at(begun)]

    def _cut(self, sighting: Sighting) -> Sighting:
        if sighting.end_ms <= self._until_ms:
            return sighting
        cut = replace(sighting, end_ms=self._until_ms)
        taken_ms = sighting.keyframe_ms
        late = taken_ms is not None and taken_ms > self._until_ms
        return replace(cut, image=None, keyframe_ms=None) if late else cut

    def spans(
        self,
        object_ids: Sequence[str],
        *,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> Spans:
        """Return when objects had been seen."""
        end = self._end(end_ms)
        if self._is_later(start_ms):
            return Spans.of_rows(object_ids, [])
        found = self._store.spans(object_ids, area=area, start_ms=start_ms, end_ms=end, limit=limit)
        if not (found.end_ms > self._until_ms).any():
            return found
        cut = replace(found, end_ms=np.minimum(found.end_ms, self._until_ms))
        return cut.chosen(np.lexsort((cut.place, cut.end_ms, cut.start_ms, cut.of)))

    def positions(self, object_ids: Sequence[str]) -> Positions:
        """Return where the stays are that had begun."""
        begun = self._store.stays(object_ids=object_ids, end_ms=self._until_ms)
        return Positions.of_stays(object_ids, begun)

    def newest(
        self,
        object_ids: Sequence[str],
        limit: int,
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
        oldest: bool = False,
    ) -> list[Sighting]:
        """Return the newest (or oldest) of the sightings that had begun."""
        end = self._end(end_ms)
        if self._is_later(start_ms):
            return []
        found = self._store.newest(object_ids, limit, start_ms=start_ms, end_ms=end, oldest=oldest)
        return [self._cut(sighting) for sighting in found]

    def reach(self, object_ids: Sequence[str], count: int, *, oldest: bool = False) -> int | None:
        """Return the start of the count-th newest (or oldest) sighting that had begun."""
        if self._store.reach(object_ids, count, oldest=oldest) is None:
            return None
        starts = np.sort(self.spans(object_ids).start_ms)
        if len(starts) < count:
            return None
        return int(starts[count - 1 if oldest else -count])

    def count_seen(
        self,
        object_ids: Sequence[str],
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> int:
        """Count the objects that had been seen."""
        end = self._end(end_ms)
        if self._is_later(start_ms):
            return 0
        return self._store.count_seen(object_ids, start_ms=start_ms, end_ms=end)

    def edges(
        self,
        object_ids: Sequence[str],
        which: str,
        *,
        before_ms: int | None = None,
        after_ms: int | None = None,
    ) -> list[Sighting]:
        """Return each object's first or last sighting that had begun.

        What was in view just then has one end, wherever it was: its start and place decide.
        """
        before, until = self._end(before_ms), self._until_ms
        if self._is_later(after_ms):
            return []
        found = self._store.edges(object_ids, which, before_ms=before, after_ms=after_ms)
        on = [s.object_id for s in found if s.end_ms > until]
        in_view = self._store.sightings(object_ids=on, start_ms=until, end_ms=until) if on else []
        edge = {s.object_id: s for s in found}
        sign = 1 if which == "first" else -1
        for sighting in sorted(in_view, key=lambda s: (-sign * s.start_ms, -sign * s.place)):
            if sighting.start_ms <= before:
                edge[sighting.object_id] = sighting
        return [self._cut(edge[s.object_id]) for s in found]

    def encounters(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        with_ids: Sequence[str] | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Encounter]:
        """Return the encounters that had begun; none is shown by a picture of unknown time."""
        end = self._end(end_ms)
        if self._is_later(start_ms):
            return []
        found = self._store.encounters(
            object_ids=object_ids, with_ids=with_ids, start_ms=start_ms, end_ms=end
        )
        until = self._until_ms
        return [m if m.end_ms <= until else replace(m, end_ms=until, image=None) for m in found]

    # coverage
    def views(self, *, start_ms: int | None = None, end_ms: int | None = None) -> list[View]:
        """Return the views that had begun."""
        end, until = self._end(end_ms), self._until_ms
        if self._is_later(start_ms):
            return []
        found = self._store.views(start_ms=start_ms, end_ms=end)
        cut = [v if v.end_ms <= until else replace(v, end_ms=until) for v in found]
        return sorted(cut, key=lambda v: (v.start_ms, v.end_ms, v.site, v.recording))

    def last_view_ms(self) -> int | None:
        """Return the time of the newest frame by then: the newest views are read first."""
        width = DAY_MS
        ends: list[int] = []
        while not ends and width < self._until_ms:
            ends = [view.end_ms for view in self.views(start_ms=self._until_ms - width)]
            width *= 8
        ends = ends or [view.end_ms for view in self.views()]
        known = (recording.last_ms for recording in self._store.recordings())
        ends += [ms for ms in known if ms is not None and ms <= self._until_ms]
        return max(ends, default=None)
