"""A batch of writes, and what must hold still for it. Import them from `d3a.store.base`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from d3a.store.documents import (
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayKey,
    StayRecord,
    View,
)


@dataclass(frozen=True, slots=True)
class Expected:
    """What must hold still, None: whatever it is.

    meta: values by key, None for none. recordings: all of them. fence: of the store's lease.
    """

    meta: Mapping[str, Any] = field(default_factory=dict)
    recordings: tuple[RecordingRecord, ...] | None = None
    fence: int | None = None


@dataclass(frozen=True, slots=True)
class Batch:
    """Writes that become visible together: `Store.apply` returns after the commit.

    Removing an object removes its stays, sightings and encounters; removing a stay its sightings
    and encounters. Removals happen before puts. meta: JSON values; None removes a key.
    state: the associator's checkpoint, opaque bytes, None leaves it as it is.
    expects: what must hold still, else the whole batch is a StoreConflict and nothing is written.
    A stay needs its object, a sighting its stay, an encounter both stays: in the store or in the
    batch, else the whole batch is refused. Of two puts of one key the later one counts.
    """

    objects: Sequence[ObjectRecord] = ()
    stays: Sequence[StayRecord] = ()
    sightings: Sequence[Sighting] = ()
    encounters: Sequence[Encounter] = ()
    views: Sequence[View] = ()
    keyframes: Sequence[Keyframe] = ()
    regions: Sequence[Region] = ()
    recordings: Sequence[RecordingRecord] = ()
    removed_objects: Sequence[str] = ()
    removed_stays: Sequence[StayKey] = ()
    removed_sightings: Sequence[tuple[str, int, int]] = ()  # object_id, place, start_ms
    removed_encounters: Sequence[tuple[str, str, int, int, int]] = ()  # a, b, places, start_ms
    removed_regions: Sequence[str] = ()
    removed_views: Sequence[tuple[str, str, int]] = ()  # site, recording, start_ms
    removed_keyframes: Sequence[str] = ()  # by key; none that the batch puts
    meta: Mapping[str, Any] = field(default_factory=dict)
    state: bytes | None = None
    expects: Expected | None = None
