"""A store with the writes on top that are not in it yet.

The tiers read through the ledger, so that what they see does not depend on when the last
checkpoint was: an ingest that was interrupted, or asked for progress more often, fills the store
just as another does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Set
from typing import Any

from d3a.store.base import (
    Area,
    Encounter,
    ObjectRecord,
    Sighting,
    StayKey,
    StayRecord,
    Store,
    TaughtName,
    View,
)

EncounterKey = tuple[str, str, int, int, int]
SightingKey = tuple[str, int, int]


def encounter_key(encounter: Encounter) -> EncounterKey:
    """Return the key under which a store holds the encounter."""
    e = encounter
    return e.object_a, e.object_b, e.place_a, e.place_b, e.start_ms


class Ledger:
    """Reads like the store will after the next batch; gives that batch's records."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self.clear()

    def clear(self) -> None:
        """Forget the writes: they were applied."""
        self._objects: dict[str, ObjectRecord] = {}
        self._stays: dict[StayKey, StayRecord] = {}
        self._sightings: dict[SightingKey, Sighting] = {}
        self._encounters: dict[EncounterKey, Encounter] = {}
        self._views: list[View] = []
        self._gone_objects: set[str] = set()
        self._gone_stays: set[StayKey] = set()
        self._gone_sightings: set[SightingKey] = set()

    def batch_fields(self) -> dict[str, Any]:
        """Return the writes by the names of `Batch`, each kind in the order of its keys."""
        return {
            "objects": [self._objects[k] for k in sorted(self._objects)],
            "stays": [self._stays[k] for k in sorted(self._stays)],
            "sightings": [self._sightings[k] for k in sorted(self._sightings)],
            "encounters": [self._encounters[k] for k in sorted(self._encounters)],
            "views": list(self._views),
            "removed_objects": sorted(self._gone_objects),
            "removed_stays": sorted(self._gone_stays),
            "removed_sightings": sorted(self._gone_sightings),
        }

    def taught(self) -> dict[str, tuple[TaughtName, ...]]:
        """Return the names that people gave, by object: the store's own word on them.

        They may be taught while an ingest runs, by another process: what the tiers hold is older.
        """
        words = sorted({name.word for name in self._store.names()})
        if not words:
            return {}
        return {record.object_id: record.names for record in self._store.objects(names=words)}

    def named(self, object_ids: Sequence[str]) -> set[str]:
        """Return which of some objects have a name that people gave, by now."""
        return {record.object_id for record in self._store.objects(ids=object_ids) if record.names}

    # writes
    def put_object(self, record: ObjectRecord) -> None:
        """Put an object, whatever was there."""
        self._objects[record.object_id] = record

    def put_stay(self, record: StayRecord) -> None:
        """Put a stay, whatever was there."""
        self._stays[record.key] = record

    def put_sighting(self, record: Sighting) -> None:
        """Put a sighting, whatever was there."""
        self._sightings[(*record.stay, record.start_ms)] = record

    def put_encounter(self, record: Encounter) -> None:
        """Put an encounter, whatever was there."""
        self._encounters[encounter_key(record)] = record

    def put_view(self, record: View) -> None:
        """Put a view, whatever was there."""
        self._views.append(record)

    def remove_objects(self, object_ids: Set[str]) -> None:
        """Remove objects with their stays, sightings and encounters."""
        self._gone_objects.update(object_ids)
        for object_id in object_ids:
            self._objects.pop(object_id, None)
        self._forget(lambda stay: stay[0] in object_ids)

    def remove_stay(self, stay: StayKey) -> None:
        """Remove a stay with its sightings and encounters."""
        self._gone_stays.add(stay)
        self._forget(lambda each: each == stay)

    def remove_sighting(self, record: Sighting) -> None:
        """Remove a sighting."""
        key = (*record.stay, record.start_ms)
        self._gone_sightings.add(key)
        self._sightings.pop(key, None)

    def _forget(self, matches: Callable[[StayKey], bool]) -> None:
        self._stays = {k: r for k, r in self._stays.items() if not matches(k)}
        self._sightings = {k: r for k, r in self._sightings.items() if not matches(r.stay)}
        self._encounters = {
            k: r
            for k, r in self._encounters.items()
            if not matches((r.object_a, r.place_a)) and not matches((r.object_b, r.place_b))
        }

    # reads
    def objects(
        self, *, ids: Sequence[str] | None = None, categories: Sequence[str] | None = None
    ) -> list[ObjectRecord]:
        """Return objects by id, as `Store.objects`."""
        stored = self._store.objects(ids=ids, categories=categories)
        kept = {r.object_id: r for r in stored if r.object_id not in self._gone_objects}
        for object_id in kept.keys() & self._objects.keys():
            del kept[object_id]  # its category may have changed: judge the newer record
        kept |= {
            object_id: record
            for object_id, record in self._objects.items()
            if (ids is None or object_id in ids)
            and (categories is None or record.category in categories)
        }
        return [kept[object_id] for object_id in sorted(kept)]

    def stays(
        self, *, object_ids: Sequence[str] | None = None, area: Area | None = None
    ) -> list[StayRecord]:
        """Return stays by (object_id, place), as `Store.stays`."""
        stored = self._store.stays(object_ids=object_ids, area=area)
        kept = {r.key: r for r in stored if not self._is_gone(r.key) and r.key not in self._stays}
        for key, record in self._stays.items():
            if (object_ids is None or key[0] in object_ids) and _within(record, area):
                kept[key] = record
        return [kept[key] for key in sorted(kept)]

    def sightings(
        self,
        object_ids: Sequence[str] | None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Sighting]:
        """Return sightings by (start, object_id, place) that touch [start, end]; None: all."""
        stored = self._store.sightings(object_ids=object_ids, start_ms=start_ms, end_ms=end_ms)
        kept: dict[SightingKey, Sighting] = {}
        for record in stored:
            key = (*record.stay, record.start_ms)
            if not self._is_gone(record.stay) and key not in self._gone_sightings:
                kept[key] = record
        for key, record in self._sightings.items():
            kept.pop(key, None)
            late = start_ms is not None and record.end_ms < start_ms
            early = end_ms is not None and record.start_ms > end_ms
            asked = object_ids is None or record.object_id in object_ids
            if asked and not late and not early:
                kept[key] = record
        return sorted(kept.values(), key=lambda r: (r.start_ms, *r.stay))

    def encounters(
        self,
        object_id: str | None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        *,
        with_ids: Sequence[str] | None = None,
    ) -> list[Encounter]:
        """Return the encounters of an object, None for all, that touch [start, end], by key.

        with_ids: those with one of these objects; None for any.
        """
        kept: dict[EncounterKey, Encounter] = {}
        ids = None if object_id is None else [object_id]
        for record in self._store.encounters(
            object_ids=ids, with_ids=with_ids, start_ms=start_ms, end_ms=end_ms
        ):
            a, b = (record.object_a, record.place_a), (record.object_b, record.place_b)
            key = encounter_key(record)
            if not (self._is_gone(a) or self._is_gone(b)):
                kept[key] = record
        for key, record in self._encounters.items():
            kept.pop(key, None)
            late = start_ms is not None and record.end_ms < start_ms
            early = end_ms is not None and record.start_ms > end_ms
            if not late and not early and record.is_between(ids, with_ids):
                kept[key] = record
        return [kept[key] for key in sorted(kept)]

    def span(self) -> tuple[int, int]:
        """Return the start of the first sighting and the newest frame's time; 0, 0 for none."""
        first = self._store.sightings(limit=1)
        starts = [record.start_ms for record in (*first, *self._sightings.values())]
        return min(starts, default=0), self._store.last_view_ms() or 0

    def _is_gone(self, stay: StayKey) -> bool:
        return stay in self._gone_stays or stay[0] in self._gone_objects


def _within(record: StayRecord, area: Area | None) -> bool:
    if area is None:
        return True
    if record.position is None:
        return False
    x, y, _ = record.position
    return area.x_min <= x <= area.x_max and area.y_min <= y <= area.y_max


def grouped(sightings: Iterable[Sighting]) -> dict[StayKey, list[Sighting]]:
    """Return sightings by their stay."""
    by_stay: dict[StayKey, list[Sighting]] = {}
    for record in sightings:
        by_stay.setdefault(record.stay, []).append(record)
    return by_stay
