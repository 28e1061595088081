"""A store that is lists and loops: slow, and plain enough to be believed. For tests alone."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.model import Json
from d3a.store.base import (
    Area,
    Batch,
    Encounter,
    Keyframe,
    NativeQuery,
    ObjectRecord,
    Positions,
    RecordingRecord,
    Region,
    Sighting,
    SightingKey,
    Spans,
    StayKey,
    StayRecord,
    TaughtName,
    View,
)
from d3a.store.expected import check_expected
from d3a.store.lease import Lease
from d3a.store.limits import EmbeddingKind, check_batch, check_referred, embedding_kind
from d3a.store.records import Picture, Record, dump_records, meta_json, picture


def touches(start: int, end: int, start_ms: int | None, end_ms: int | None) -> bool:
    """Whether two closed intervals share a millisecond; None is open."""
    return (start_ms is None or end >= start_ms) and (end_ms is None or start <= end_ms)


class OracleStore:
    """`Store` by brute force over dictionaries: what both backends are compared with."""

    uri = "oracle"

    def __init__(self) -> None:
        self._objects: dict[str, ObjectRecord] = {}
        self._stays: dict[StayKey, StayRecord] = {}
        self._sightings: dict[tuple[str, int, int], Sighting] = {}
        self._encounters: dict[tuple[str, str, int, int, int], Encounter] = {}
        self._views: dict[tuple[str, str, int], View] = {}
        self._regions: dict[str, Region] = {}
        self._recordings: dict[str, RecordingRecord] = {}
        self._keyframes: dict[str, Keyframe] = {}
        self._meta: dict[str, str] = {}
        self._state: bytes | None = None
        self._embedding_kind: EmbeddingKind | None = None
        self._written = 0
        self._lease: Lease | None = None
        self._turn = threading.RLock()

    def close(self) -> None:
        pass

    def turn(self) -> AbstractContextManager[object]:
        return self._turn

    def moment(self) -> AbstractContextManager[object]:
        return nullcontext()

    def lease(self) -> Lease | None:
        return self._lease

    def put_lease(self, lease: Lease) -> None:
        self._lease = lease

    def clock_ms(self) -> int:
        return round(time.time() * 1000)

    def apply(self, batch: Batch) -> None:
        check_batch(batch)
        check_expected(self, batch)
        check_referred(batch, self._objects, self._stays)
        self._embedding_kind = embedding_kind(batch, self._embedding_kind)
        self._written += 1
        self._remove(batch)
        self._objects.update((r.object_id, r) for r in batch.objects)
        self._stays.update((r.key, r) for r in batch.stays)
        self._sightings.update(((*r.stay, r.start_ms), r) for r in batch.sightings)
        self._encounters.update((encounter_key(r), r) for r in batch.encounters)
        self._views.update(((r.site, r.recording, r.start_ms), r) for r in batch.views)
        self._regions.update((r.name, r) for r in batch.regions)
        self._recordings.update((r.key, r) for r in batch.recordings)
        self._keyframes.update((r.key, r) for r in batch.keyframes)
        for key, value in batch.meta.items():
            self._meta[key] = meta_json(value)
            if value is None:
                del self._meta[key]
        if batch.state is not None:
            self._state = batch.state

    def _remove(self, batch: Batch) -> None:
        gone_objects, gone_stays = set(batch.removed_objects), set(batch.removed_stays)

        def gone(stay: StayKey) -> bool:
            return stay in gone_stays or stay[0] in gone_objects

        self._objects = {k: r for k, r in self._objects.items() if k not in gone_objects}
        self._stays = {k: r for k, r in self._stays.items() if not gone(k)}
        self._sightings = {
            k: r
            for k, r in self._sightings.items()
            if not gone(r.stay) and k not in set(batch.removed_sightings)
        }
        self._encounters = {
            k: r
            for k, r in self._encounters.items()
            if not gone((r.object_a, r.place_a))
            and not gone((r.object_b, r.place_b))
            and k not in set(batch.removed_encounters)
        }
        for name in batch.removed_regions:
            self._regions.pop(name, None)
        for view in batch.removed_views:
            self._views.pop(view, None)
        for key in batch.removed_keyframes:
            self._keyframes.pop(key, None)

    def collect_keyframes(self, keep: Sequence[str] = ()) -> int:
        used = {r.image for r in self._sightings.values()}
        used |= {r.image for r in self._encounters.values()} | set(keep)
        unused = set(self._keyframes) - used
        for key in unused:
            del self._keyframes[key]
        return len(unused)

    def scrub(self) -> bool:
        return True

    def repair(self) -> list[str]:
        return []

    def objects(
        self,
        *,
        ids: Sequence[str] | None = None,
        categories: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        votes: bool = False,
        embeddings: bool = True,
    ) -> list[ObjectRecord]:
        def called(record: ObjectRecord) -> set[str]:
            return {record.category, *(c for c, _ in record.categories if votes)}

        return [
            record if embeddings else replace(record, embedding=None)
            for _, record in sorted(self._objects.items())
            if (ids is None or record.object_id in ids)
            and (categories is None or called(record) & set(categories))
            and (names is None or any(name.word in names for name in record.names))
        ]

    def categories(self) -> list[tuple[str, int]]:
        return sorted(Counter(r.category for r in self._objects.values()).items())

    def names(self) -> list[TaughtName]:
        names = {name for record in self._objects.values() for name in record.names}
        return sorted(names, key=lambda name: (name.word, name.owner or "", name.owner is not None))

    def embeddings(self, limit: int | None = None) -> tuple[list[str], NDArray[np.float32]]:
        ids = [k for k, r in sorted(self._objects.items()) if r.embedding is not None][:limit]
        rows = [self._objects[k].embedding for k in ids]
        length = self._embedding_kind.length if self._embedding_kind else 0
        return ids, np.array(rows, dtype=np.float32).reshape(len(ids), length)

    def _in(self, area: Area | None, stay: StayKey) -> bool:
        position = self._stays[stay].position
        return area is None or (
            position is not None
            and area.x_min <= position[0] <= area.x_max
            and area.y_min <= position[1] <= area.y_max
        )

    def stays(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[StayRecord]:
        return [
            record
            for key, record in sorted(self._stays.items())
            if (object_ids is None or record.object_id in object_ids)
            and self._in(area, key)
            and touches(record.first_ms, record.last_ms, start_ms, end_ms)
        ]

    def stays_at(self, keys: Sequence[StayKey]) -> list[StayRecord]:
        return [record for key, record in sorted(self._stays.items()) if key in keys]

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> list[Sighting]:
        found = [
            record
            for record in self._sightings.values()
            if (object_ids is None or record.object_id in object_ids)
            and self._in(area, record.stay)
            and touches(record.start_ms, record.end_ms, start_ms, end_ms)
        ]
        return sorted(found, key=lambda r: (r.start_ms, *r.stay))[:limit]

    def sightings_at(self, keys: Sequence[SightingKey]) -> list[Sighting]:
        found = [self._sightings[key] for key in set(keys) if key in self._sightings]
        return sorted(found, key=lambda s: (s.start_ms, s.object_id, s.place))

    def spans(
        self,
        object_ids: Sequence[str],
        *,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> Spans:
        rows = sorted(
            (name, start, s.end_ms, place)
            for (name, place, start), s in self._sightings.items()
            if name in object_ids
            and self._in(area, s.stay)
            and touches(start, s.end_ms, start_ms, end_ms)
        )
        return Spans.of_rows(object_ids, rows[:limit])

    def positions(self, object_ids: Sequence[str]) -> Positions:
        return Positions.of_stays(object_ids, self.stays(object_ids=object_ids))

    def newest(
        self,
        object_ids: Sequence[str],
        limit: int,
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
        oldest: bool = False,
    ) -> list[Sighting]:
        left = self.sightings(object_ids=object_ids, start_ms=start_ms, end_ms=end_ms)
        places = {record.stay for record in left}
        each = len(left) if len(left) <= limit else max(1, limit // len(places))
        taken: Counter[StayKey] = Counter()
        found: list[Sighting] = []
        while left and len(found) < limit:
            record = left.pop(0 if oldest else -1)
            if taken[record.stay] < each:
                taken[record.stay] += 1
                found.append(record)
        return sorted(found, key=lambda r: (r.start_ms, *r.stay))

    def reach(self, object_ids: Sequence[str], count: int, *, oldest: bool = False) -> int | None:
        starts = [record.start_ms for record in self.sightings(object_ids=object_ids)]
        return sorted(starts, reverse=not oldest)[count - 1] if len(starts) >= count else None

    def count_seen(
        self,
        object_ids: Sequence[str],
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> int:
        found = self.sightings(object_ids=object_ids, start_ms=start_ms, end_ms=end_ms)
        return len({record.object_id for record in found})

    def edges(
        self,
        object_ids: Sequence[str],
        which: str,
        *,
        before_ms: int | None = None,
        after_ms: int | None = None,
    ) -> list[Sighting]:
        by_object: dict[str, list[Sighting]] = {}
        for record in self.sightings(object_ids=object_ids, start_ms=after_ms, end_ms=before_ms):
            by_object.setdefault(record.object_id, []).append(record)
        if which == "first":
            best = [
                min(found, key=lambda r: (r.start_ms, r.end_ms, r.place))
                for found in by_object.values()
            ]
        else:
            best = [
                max(found, key=lambda r: (r.end_ms, r.start_ms, r.place))
                for found in by_object.values()
            ]
        return sorted(best, key=lambda r: r.object_id)

    def encounters(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        with_ids: Sequence[str] | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Encounter]:
        def among(object_id: str, ids: Sequence[str] | None) -> bool:
            return ids is None or object_id in ids

        found = [
            record
            for record in self._encounters.values()
            if touches(record.start_ms, record.end_ms, start_ms, end_ms)
            and (
                (among(record.object_a, object_ids) and among(record.object_b, with_ids))
                or (among(record.object_b, object_ids) and among(record.object_a, with_ids))
            )
        ]
        return sorted(
            found, key=lambda r: (r.start_ms, r.object_a, r.object_b, r.place_a, r.place_b)
        )

    def keyframe(self, key: str) -> Keyframe | None:
        return self._keyframes.get(key)

    def keyframe_keys(self) -> list[str]:
        return sorted(self._keyframes)

    def views(self, *, start_ms: int | None = None, end_ms: int | None = None) -> list[View]:
        found = [
            record
            for record in self._views.values()
            if touches(record.start_ms, record.end_ms, start_ms, end_ms)
        ]
        return sorted(found, key=lambda r: (r.start_ms, r.end_ms, r.site, r.recording))

    def last_view_ms(self) -> int | None:
        ends = [r.end_ms for r in self._views.values()]
        ends += [r.last_ms for r in self._recordings.values() if r.last_ms is not None]
        return max(ends, default=None)

    def regions(self) -> list[Region]:
        return [record for _, record in sorted(self._regions.items())]

    def recordings(self) -> list[RecordingRecord]:
        return [record for _, record in sorted(self._recordings.items())]

    def meta(self, key: str) -> Any | None:
        return json.loads(self._meta[key]) if key in self._meta else None

    def state(self) -> bytes | None:
        return self._state

    def revision(self) -> tuple[int, int] | None:
        return 0, self._written

    def counts(self) -> Json:
        return {
            "objects": len(self._objects),
            "stays": len(self._stays),
            "sightings": len(self._sightings),
            "encounters": len(self._encounters),
            "views": len(self._views),
            "keyframes": len(self._keyframes),
            "regions": len(self._regions),
            "recordings": len(self._recordings),
            "bytes": 0,
        }

    def check(self) -> list[str]:
        images = {r.image for r in self._sightings.values()}
        images |= {r.image for r in self._encounters.values()}
        return [
            f"missing picture {key}" for key in sorted(filter(None, images - {*self._keyframes}))
        ]

    def tracing(self, observer: Callable[[NativeQuery], None] | None) -> None:
        """Accept an observer: there are no native queries to tell of."""

    def dump(self) -> Iterator[Json]:
        return dump_records(self)

    # what `dump_records` reads
    def meta_entries(self) -> Iterable[tuple[str, Any]]:
        return [(key, json.loads(text)) for key, text in sorted(self._meta.items())]

    def records(self, kind: str) -> Iterable[Record]:
        every: dict[str, Callable[[], Sequence[Record]]] = {
            "recording": self.recordings,
            "region": self.regions,
            "object": self.objects,
            "stay": self.stays,
            "sighting": self.sightings,
            "encounter": self.encounters,
            "view": self.views,
        }
        return every[kind]()

    def pictures(self) -> Iterable[Picture]:
        return [picture(record) for _, record in sorted(self._keyframes.items())]


def encounter_key(record: Encounter) -> tuple[str, str, int, int, int]:
    """The key of an encounter, as `Batch.removed_encounters` names it."""
    return record.object_a, record.object_b, record.place_a, record.place_b, record.start_ms
