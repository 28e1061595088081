"""The `paper` profile: D3A's three tiers to the letter.

Window, STM and store, with the readings of `tier1`, `tier2` and `tier3`. It keeps no record of
shared frames: the paper answers "together" by the union of both objects' keyframes. While an
entry is in the STM its records are volatile, so that a question sees them; tier 3 replaces them.
So the id that a thing has while a recording is taken in is its instance's: what tier 3 then finds
in the store takes the id that it has there, and its place a small number. Where an ingest was
interrupted changes neither: in the end both are as if it had not been.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.checkpoint import Arrays, detection_json, detection_of, ref_json, ref_of, stacked
from d3a.constraints import Constraints
from d3a.correcting.reconcile import Corrected
from d3a.images import unit
from d3a.ledger import Ledger
from d3a.model import Json
from d3a.parameters import Parameters
from d3a.sightings import Became, Event, Interval, Scene, Seen, entry_name
from d3a.stm import Entry, ShortTermMemory
from d3a.store.base import ObjectRecord, StayKey, StayRecord, TaughtName
from d3a.tier1 import Cluster, Member, SlidingWindow
from d3a.tier2 import Filter
from d3a.tier3 import DatabaseFilter, Stored, position_tuple

VOLATILE_PLACE = 1_000_000
"""Places from here on are entries of the STM (plus their serial); a settled one gets a small
number of its object when tier 3 stores it."""
NOISE = "seen in one frame of its window only"


class PaperPipeline:
    """Tier 1 to 3 of the paper over a ledger."""

    def __init__(self, ledger: Ledger, stored: Stored, parameters: Parameters) -> None:
        self._ledger = ledger
        self._stored = stored
        self._window = SlidingWindow(parameters)
        self._stm = ShortTermMemory(parameters.stm_capacity)
        self._filter = Filter(self._stm, parameters)
        self._database = DatabaseFilter(ledger, stored, parameters)
        self._object_of: dict[int, str] = {}  # instance -> object, once tier 3 has stored it
        self._stay_of: dict[int, StayKey] = {}  # serial of an evicted entry -> its stay
        self._dirty: set[int] = set()
        self._volatile: dict[int, str] = {}  # serial -> object id of its volatile records
        self._events: list[Event] = []

    def observe(self, scene: Scene) -> None:
        """Take a frame through the tiers."""
        clusters, noise = self._window.push(scene)
        self._say_noise(noise)
        for cluster in clusters:
            self._take(cluster)

    def _take(self, cluster: Cluster) -> None:
        entry, is_new = self._filter.place(cluster)
        if is_new:
            while len(self._stm) >= self._stm.capacity:
                self._evict(self._stm.least_recently_viewed())
            self._stm.add(entry, cluster.position, cluster.embedding)
            self._filter.instance_of[entry.serial] = entry.instance
        else:
            self._filter.aggregate(entry, cluster)
        for member in cluster.members:
            member.label = entry.serial
            self._events.append(_seen(member, f"e{entry.serial}"))
        self._dirty.add(entry.serial)

    def _evict(self, entry: Entry) -> None:
        position, look = self._stm.position(entry), self._stm.embedding(entry)
        known = self._object_of.get(entry.instance)
        self._withdraw(entry)
        came_from = None if entry.moved_from is None else self._stay_of.get(entry.moved_from[0])
        key = self._database.merge(entry, position, look, known, f"o{entry.instance}", came_from)
        self._object_of[entry.instance] = key[0]
        self._stay_of[entry.serial] = key
        self._stm.remove(entry)
        self._dirty.discard(entry.serial)
        self._events.append(Became(f"e{entry.serial}", entry_name(key)))
        if known is None:  # the others of this instance are shown under its new name
            self._dirty |= {e.serial for e in self._stm if e.instance == entry.instance}

    def end_look(self) -> None:
        """Do nothing: the paper draws no conclusion from what is not seen."""

    # what a question sees of the STM
    def _withdraw(self, entry: Entry) -> None:
        """Take an entry's volatile records back; an object goes with its last one."""
        shown = self._volatile.pop(entry.serial, None)
        if shown is None:
            return
        self._ledger.remove_stay((shown, VOLATILE_PLACE + entry.serial))
        if shown not in self._volatile.values():
            for record in self._ledger.objects(ids=[shown]):
                if record.volatile:
                    self._ledger.remove_objects({shown})

    def take_constraints(self, constraints: Constraints) -> None:
        """Keep what people said from here on: what they made one is a candidate at its places."""
        self._database.one = constraints.one

    def correct(self, changed: Corrected) -> None:
        """Take in what people changed in the store; it holds no volatile records of theirs."""
        for instance, object_id in list(self._object_of.items()):
            self._object_of[instance] = changed.objects.get(object_id, object_id)
        for serial, key in list(self._stay_of.items()):
            self._stay_of[serial] = changed.stays.get(key, key)
        touched = changed.before | changed.after
        for serial, shown in list(self._volatile.items()):
            if shown in touched:
                del self._volatile[serial]
                self._dirty.add(serial)

    def take_names(self, taught: Mapping[str, tuple[TaughtName, ...]]) -> None:
        """Names change nothing: the paper's records are aggregated by their ids alone."""

    def write(self) -> None:
        """Put what changed in the STM into the ledger, as volatile records."""
        changed = [entry for entry in self._stm if entry.serial in self._dirty]
        for entry in changed:
            object_id = self._object_of.get(entry.instance, f"o{entry.instance}")
            if self._volatile.get(entry.serial, object_id) != object_id:
                self._withdraw(entry)
            self._volatile[entry.serial] = object_id
            if entry.instance not in self._object_of:
                self._ledger.put_object(self._volatile_object(object_id, entry.instance))
            key = (object_id, VOLATILE_PLACE + entry.serial)
            self._ledger.put_stay(self._volatile_stay(key, entry))
            for old in self._ledger.sightings([object_id]):
                if old.stay == key:
                    self._ledger.remove_sighting(old)
            for interval in entry.intervals:
                self._ledger.put_sighting(interval.sighting(key))
        self._dirty.clear()

    def _volatile_object(self, object_id: str, instance: int) -> ObjectRecord:
        entries = [entry for entry in self._stm if entry.instance == instance]
        heaviest = max(entries, key=lambda entry: (entry.weight, -entry.serial))
        weight = sum(entry.weight for entry in entries)
        look = self._stm.embedding(heaviest)
        return ObjectRecord(
            object_id=object_id,
            category=heaviest.category,
            weight=weight,
            first_ms=min(entry.first_ms for entry in entries),
            last_ms=max(entry.last_ms for entry in entries),
            site=self._stored.site,
            categories=((heaviest.category, weight),),
            embedding=None if look is None else unit(look),
            embedding_model=None if look is None else self._stored.embedding_model,
            volatile=True,
        )

    def _volatile_stay(self, key: StayKey, entry: Entry) -> StayRecord:
        return StayRecord(
            object_id=key[0],
            place=key[1],
            position=position_tuple(self._stm.position(entry)),
            first_ms=entry.first_ms,
            last_ms=entry.last_ms,
            weight=entry.weight,
            site=self._stored.site,
            seen=entry.seen,
            volatile=True,
        )

    def flush(self) -> None:
        """End a recording: the window's rest is noise, the STM goes to the store, oldest first."""
        self._say_noise(self._window.drain())
        while len(self._stm):
            self._evict(self._stm.least_recently_viewed())
        self._object_of.clear()
        self._stay_of.clear()
        self._filter.instance_of.clear()

    def _say_noise(self, noise: list[Member]) -> None:
        for member in noise:
            name = f"noise {member.ref.name} {member.detection.box}"
            self._events += [_seen(member, name), Became(name, None, NOISE)]

    def take_events(self) -> list[Event]:
        """Return what became of detections and entries since the last call."""
        events, self._events = self._events, []
        return events

    def images(self) -> set[str]:
        """Return the pictures that the window and the STM refer to."""
        held = {i.image for entry in self._stm for i in entry.intervals if i.image}
        return self._window.images() | held

    # checkpoint
    def to_state(self) -> tuple[Json, Arrays]:
        """Return everything that `restore` needs."""
        entries = list(self._stm)
        window = self._window.to_state()
        record: Json = {
            "serial": self._filter.next_serial,
            "instance": self._filter.next_instance,
            "instance_of": list(self._filter.instance_of.items()),
            "object_of": list(self._object_of.items()),
            "stay_of": [[serial, *key] for serial, key in self._stay_of.items()],
            "volatile": list(self._volatile.items()),
            "entries": [_entry_json(entry) for entry in entries],
            "times": self._window.times(),
            "window": [
                [ref_json(ref), detection_json(detection), label]
                for ref, detection, label in window
            ],
        }
        positions = [self._stm.position(entry) for entry in entries]
        arrays: Arrays = {
            "positions": np.array(positions, dtype=np.float64).reshape(len(entries), 3),
            "looks": stacked([self._stm.embedding(entry) for entry in entries]),
            "window": stacked([detection.embedding for _, detection, _ in window]),
        }
        return record, arrays

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        self._filter.next_serial = record["serial"]
        self._filter.next_instance = record["instance"]
        self._filter.instance_of.update((serial, of) for serial, of in record["instance_of"])
        self._object_of.update((instance, of) for instance, of in record["object_of"])
        self._stay_of.update((s, (object_id, place)) for s, object_id, place in record["stay_of"])
        self._volatile.update((serial, of) for serial, of in record["volatile"])
        looks = arrays["looks"]
        for row, each in enumerate(record["entries"]):
            self._stm.add(_entry_of(each), arrays["positions"][row], _row(looks, row))
        members = [
            (ref_of(ref), detection_of(detection, _row(arrays["window"], i)), label)
            for i, (ref, detection, label) in enumerate(record["window"])
        ]
        self._window.restore(record["times"], members)


def _row(matrix: NDArray[Any], row: int) -> NDArray[Any] | None:
    return np.array(matrix[row]) if matrix.shape[1] and matrix[row].any() else None


def _seen(member: Member, entry: str) -> Seen:
    return Seen(member.detection.row, member.ref.name, member.detection.box, entry)


def _entry_json(entry: Entry) -> Json:
    names = ("serial", "instance", "category", "weight", "seen", "first_ms", "last_ms")
    record: Json = {name: getattr(entry, name) for name in names}
    record["moved_from"] = entry.moved_from
    record["intervals"] = [interval.to_json() for interval in entry.intervals]
    return record


def _entry_of(record: Json) -> Entry:
    moved = record.pop("moved_from")
    intervals = [Interval.from_json(each) for each in record.pop("intervals")]
    return Entry(
        **record, intervals=intervals, moved_from=None if moved is None else (moved[0], moved[1])
    )
