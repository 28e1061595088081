"""A portion of the store: all records of some objects, changed as a whole by a person's word.

Pure functions: a correction takes the portion that it concerns to another one, and the difference
of the two is one batch. So it can be checked, undone, and done again on newer records.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from d3a.ledger import EncounterKey, SightingKey, encounter_key
from d3a.model import Json
from d3a.parameters import Parameters
from d3a.sightings import Interval, joined
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayKey, StayRecord, Store
from d3a.store.records import from_json, to_json

KINDS = ("objects", "stays", "sightings", "encounters")


@dataclass(frozen=True, slots=True)
class Portion:
    """All records of some objects, each kind by its key; encounters with whatever they met."""

    objects: Mapping[str, ObjectRecord]
    stays: Mapping[StayKey, StayRecord]
    sightings: Mapping[SightingKey, Sighting]
    encounters: Mapping[EncounterKey, Encounter]

    @classmethod
    def of(
        cls,
        objects: Iterable[ObjectRecord],
        stays: Iterable[StayRecord],
        sightings: Iterable[Sighting],
        encounters: Iterable[Encounter],
    ) -> Portion:
        """Return the portion of these records; of two with one key the later counts."""
        return cls(
            {r.object_id: r for r in objects},
            {r.key: r for r in stays},
            {(*r.stay, r.start_ms): r for r in sightings},
            {encounter_key(r): r for r in encounters},
        )

    @classmethod
    def read(cls, store: Store, ids: Iterable[str]) -> Portion:
        """Return what the store holds of some objects; ids that it does not know are left out."""
        asked = sorted(set(ids))
        return cls.of(
            store.objects(ids=asked),
            store.stays(object_ids=asked),
            store.sightings(object_ids=asked),
            store.encounters(object_ids=asked),
        )

    def ids(self) -> set[str]:
        """Return the ids of its objects."""
        return set(self.objects)

    def of_object(self, object_id: str) -> list[StayRecord]:
        """Return the stays of an object, by place."""
        return [self.stays[key] for key in sorted(self.stays) if key[0] == object_id]

    def at(self, stay: StayKey) -> list[Sighting]:
        """Return the sightings of a stay, by time."""
        return [self.sightings[key] for key in sorted(self.sightings) if key[:2] == stay]

    def images(self) -> set[str]:
        """Return the pictures that its records refer to."""
        seen = {each.image for each in self.sightings.values()}
        met = {each.image for each in self.encounters.values()}
        return {image for image in seen | met if image is not None}

    def with_images(self, stored: set[str]) -> Portion:
        """Return the same without references to pictures that are no longer stored."""
        lost = self.images() - stored
        if not lost:
            return self
        return replace(
            self,
            sightings={k: _seen_without(r, lost) for k, r in self.sightings.items()},
            encounters={k: _seen_without(r, lost) for k, r in self.encounters.items()},
        )

    def without(self, ids: set[str]) -> Portion:
        """Return the rest when some objects are taken out, with all that touches them."""
        return Portion(
            {k: r for k, r in self.objects.items() if k not in ids},
            {k: r for k, r in self.stays.items() if k[0] not in ids},
            {k: r for k, r in self.sightings.items() if k[0] not in ids},
            {k: r for k, r in self.encounters.items() if not ids & {k[0], k[1]}},
        )

    def only(self, ids: set[str]) -> Portion:
        """Return the part about some objects, with all that touches them."""
        return Portion(
            {k: r for k, r in self.objects.items() if k in ids},
            {k: r for k, r in self.stays.items() if k[0] in ids},
            {k: r for k, r in self.sightings.items() if k[0] in ids},
            {k: r for k, r in self.encounters.items() if ids & {k[0], k[1]}},
        )

    def plus(self, other: Portion) -> Portion:
        """Return both; where a key is in both, the other's record."""
        return Portion(
            {**self.objects, **other.objects},
            {**self.stays, **other.stays},
            {**self.sightings, **other.sightings},
            {**self.encounters, **other.encounters},
        )

    def to_json(self) -> list[Json]:
        """Return its records as JSON, in a fixed order."""
        return [
            to_json(getattr(self, kind)[key])
            for kind in KINDS
            for key in sorted(getattr(self, kind))
        ]

    @classmethod
    def from_json(cls, records: Sequence[Json]) -> Portion:
        """Return what `to_json` wrote."""
        found: dict[type, list[Any]] = {}
        for each in records:
            record = from_json(each)
            found.setdefault(type(record), []).append(record)
        kinds = (ObjectRecord, StayRecord, Sighting, Encounter)
        return cls.of(*(found.get(kind, []) for kind in kinds))

    def same_as(self, other: Portion) -> bool:
        """Say whether both hold equal records, looks included."""
        return self.to_json() == other.to_json()


def _seen_without(record: Any, lost: set[str]) -> Any:
    return replace(record, image=None) if record.image in lost else record


def difference(before: Portion, after: Portion) -> dict[str, Any]:
    """Return the fields of the batch that makes `after` of `before`: what is equal is left."""
    kept_objects = before.objects.keys() & after.objects.keys()
    gone_stays = [k for k in before.stays.keys() - after.stays.keys() if k[0] in kept_objects]
    kept_stays = before.stays.keys() & after.stays.keys()
    gone_sightings = [
        k for k in before.sightings.keys() - after.sightings.keys() if k[:2] in kept_stays
    ]
    result: dict[str, Any] = {
        kind: [
            record
            for key, record in sorted(getattr(after, kind).items())
            if not _equal(getattr(before, kind).get(key), record)
        ]
        for kind in KINDS
    }
    return result | {
        "removed_objects": sorted(before.objects.keys() - after.objects.keys()),
        "removed_stays": sorted(gone_stays),
        "removed_sightings": sorted(gone_sightings),
        "removed_encounters": sorted(before.encounters.keys() - after.encounters.keys()),
    }


def _equal(one: Any, other: Any) -> bool:
    return one is not None and to_json(one) == to_json(other)


def relabelled(sighting: Sighting, stay: StayKey) -> Sighting:
    """Return the sighting as one of another stay."""
    return replace(sighting, object_id=stay[0], place=stay[1])


def rename_encounters(
    encounters: Iterable[Encounter], becomes: Mapping[StayKey, StayKey]
) -> dict[EncounterKey, Encounter]:
    """Return encounters by key with their stays renamed; two that fall together are one."""
    result: dict[EncounterKey, Encounter] = {}
    for each in encounters:
        other = each.renamed(becomes)
        if other is None:
            continue
        key = encounter_key(other)
        result[key] = _united(result[key], other) if key in result else other
    return result


def _united(one: Encounter, other: Encounter) -> Encounter:
    best = max(one, other, key=lambda e: (e.probability, e.frame))
    return replace(best, end_ms=max(one.end_ms, other.end_ms), seen=one.seen + other.seen)


def joined_sightings(
    sightings: Iterable[Sighting], stay: StayKey, parameters: Parameters
) -> list[Sighting]:
    """Return the sightings as those of one stay: what overlaps or follows on is one interval."""
    intervals = joined((Interval.from_sighting(each) for each in sightings), parameters)
    return [interval.sighting(stay) for interval in intervals]
