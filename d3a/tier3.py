"""Tier 3, paper profile: filter what leaves the short-term memory across the store's entries.

Paper: "Tier 3 - Filtering across Database Entries": OIc and STc are looked up and updated. It
reads and writes through the ledger, ignores what is volatile (still in the STM), and counts a
known object always among the candidates: to match by look alone would split and mix ids.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from d3a.correcting.same_thing import ranked
from d3a.images import unit
from d3a.ledger import Ledger
from d3a.parameters import Normalising, Parameters
from d3a.sightings import Interval, joined
from d3a.stm import Entry
from d3a.store.base import ObjectRecord, StayKey, StayRecord
from d3a.tier2 import apart_m, weighted, weighted_look

Floats = NDArray[np.float64]
Embedding = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Stored:
    """What of the store does not come from the entry itself."""

    site: str
    embedding_model: str | None


def position_of(record: StayRecord) -> Floats:
    """Return a stay's position (3,), NaN where unknown."""
    return np.array(record.position or (np.nan,) * 3, dtype=np.float64)


def position_tuple(position: Floats) -> tuple[float, float, float] | None:
    """Return a position as a record keeps it."""
    if np.isnan(position).any():
        return None
    return float(position[0]), float(position[1]), float(position[2])


def cosine(a: Embedding | None, b: Embedding | None) -> float:
    """Return the cosine of two embeddings, 1 where one is unknown."""
    if a is None or b is None:
        return 1.0
    scale = float(np.linalg.norm(a)) * float(np.linalg.norm(b))
    return float(a @ b) / scale if scale > 0 else 1.0


def normalised_m(a: Floats, b: Floats, by: Normalising) -> float:
    """Return the "normalized Euclidean distance" of two places; 0 where one is unknown.

    Tiers 1 and 2 measure plain metres; the paper calls the distance normalised in tier 3 alone and
    does not say by what. By the number of axes is the one way that needs no number beside those
    that the paper gives: a root mean square. "map": over the map's two axes, along which the
    robot's pose errs, so that one visit's drift does not make a second place of a thing in the
    store; a height, in which no pose drifts, counts in full. "space": over all three axes. "none":
    plain metres again; then tier 3 joins hardly anything that tier 2 has kept apart.
    """
    if by == "none":
        return apart_m(a, b)
    if by == "space":
        return apart_m(a, b) / math.sqrt(len(a))
    in_map = apart_m(a[:2], b[:2]) / math.sqrt(2)
    return math.hypot(in_map, apart_m(a[2:], b[2:]))


class DatabaseFilter:
    """Merges evicted entries into OIc and STc."""

    def __init__(self, ledger: Ledger, stored: Stored, parameters: Parameters) -> None:
        self._ledger = ledger
        self._stored = stored
        self._parameters = parameters
        self.one: Mapping[str, frozenset[str]] = {}
        """What a person made one of several, with the categories that those had."""

    def merge(
        self,
        entry: Entry,
        position: Floats,
        look: Embedding | None,
        known_id: str | None,
        new_id: str,
        came_from: StayKey | None,
    ) -> StayKey:
        """Put an evicted entry into the store; return the stay that it is now part of.

        known_id: the object that its instance already is; new_id: for an object not seen before.
        came_from: the stay of the entry that it moved away from, where that is stored already.
        """
        records = self._records(entry, look, known_id)
        records = self._told(entry.category, position, records)
        stays = self._ledger.stays(object_ids=list(records)) if records else []
        settled = [stay for stay in stays if not stay.volatile]
        near = [(self._apart_m(stay, position), stay) for stay in settled]
        near.sort(key=lambda each: (each[0], each[1].object_id != known_id, each[1].key))
        if near and near[0][0] <= self._parameters.d_thresh_m:
            stay = near[0][1]
            self._update_stay(stay, entry, position)
            self._update_object(records[stay.object_id], entry, look)
            return stay.key
        record = self._most_alike(records, look, known_id)
        if record is None:
            self._insert_object(new_id, entry, look)
            key = (new_id, 0)
        else:
            self._update_object(record, entry, look)
            places = [stay.place for stay in settled if stay.object_id == record.object_id]
            key = (record.object_id, max(places, default=-1) + 1)
        self._insert_stay(key, entry, position, came_from)
        return key

    def _records(
        self, entry: Entry, look: Embedding | None, known_id: str | None
    ) -> dict[str, ObjectRecord]:
        categories = [entry.category] if self._parameters.gate_category else None
        found = {
            record.object_id: record
            for record in self._ledger.objects(categories=categories)
            if not record.volatile
            and record.site == self._stored.site
            and cosine(record.embedding, look) >= self._parameters.min_similarity
        }
        if known_id is not None:
            found |= {record.object_id: record for record in self._ledger.objects(ids=[known_id])}
        return dict(sorted(found.items()))

    def _told(
        self, category: str, position: Floats, records: dict[str, ObjectRecord]
    ) -> dict[str, ObjectRecord]:
        """Add what a person made one of several, at its places: it may look like any of them."""
        ids = sorted(i for i, names in self.one.items() if category in names and i not in records)
        if not ids:
            return records
        near = {
            stay.object_id
            for stay in self._ledger.stays(object_ids=ids)
            if stay.site == self._stored.site
            and self._apart_m(stay, position) <= self._parameters.d_thresh_m
        }
        told = {r.object_id: r for r in self._ledger.objects(ids=sorted(near)) if not r.volatile}
        return dict(sorted((records | told).items()))

    def _apart_m(self, stay: StayRecord, position: Floats) -> float:
        return normalised_m(position_of(stay), position, self._parameters.normalise_by)

    def _most_alike(
        self, records: dict[str, ObjectRecord], look: Embedding | None, known_id: str | None
    ) -> ObjectRecord | None:
        if known_id in records:
            return records[known_id]
        if not self._parameters.keep_moved_id:
            return None
        return max(records.values(), key=lambda r: cosine(r.embedding, look), default=None)

    def _insert_object(self, object_id: str, entry: Entry, look: Embedding | None) -> None:
        self._ledger.put_object(
            ObjectRecord(
                object_id=object_id,
                category=entry.category,
                weight=entry.weight,
                first_ms=entry.first_ms,
                last_ms=entry.last_ms,
                site=self._stored.site,
                categories=((entry.category, entry.weight),),
                embedding=None if look is None else unit(look),
                embedding_model=None if look is None else self._stored.embedding_model,
            )
        )

    def _update_object(self, record: ObjectRecord, entry: Entry, look: Embedding | None) -> None:
        """Merge by weighted average, the third aggregation; a weight is a sum (appendix)."""
        mean = weighted_look(record.embedding, record.weight, look, entry.weight)
        weight = record.weight + entry.weight
        votes = dict(record.categories)  # of one category, but for what a person made one
        votes[entry.category] = votes.get(entry.category, 0.0) + entry.weight
        self._ledger.put_object(
            replace(
                record,
                weight=weight,
                first_ms=min(record.first_ms, entry.first_ms),
                last_ms=max(record.last_ms, entry.last_ms),
                categories=ranked(votes),
                embedding=None if mean is None else unit(mean),
                embedding_model=None if mean is None else self._stored.embedding_model,
            )
        )

    def _insert_stay(
        self, key: StayKey, entry: Entry, position: Floats, came_from: StayKey | None
    ) -> None:
        moved_from = None
        if came_from is not None and entry.moved_from is not None and came_from[0] == key[0]:
            moved_from = (came_from[1], entry.moved_from[1])
        self._ledger.put_stay(
            StayRecord(
                object_id=key[0],
                place=key[1],
                position=position_tuple(position),
                first_ms=entry.first_ms,
                last_ms=entry.last_ms,
                weight=entry.weight,
                site=self._stored.site,
                seen=entry.seen,
                moved_from=moved_from,
            )
        )
        self._put_intervals(key, entry.intervals)

    def _update_stay(self, stay: StayRecord, entry: Entry, position: Floats) -> None:
        mean = weighted(position_of(stay), stay.weight, position, entry.weight)
        self._ledger.put_stay(
            replace(
                stay,
                position=position_tuple(mean),
                first_ms=min(stay.first_ms, entry.first_ms),
                last_ms=max(stay.last_ms, entry.last_ms),
                weight=stay.weight + entry.weight,
                seen=stay.seen + entry.seen,
            )
        )
        self._put_intervals(stay.key, entry.intervals)

    def _put_intervals(self, key: StayKey, intervals: list[Interval]) -> None:
        """Join the intervals with those of the stay that they touch or follow."""
        gap_ms = round(self._parameters.interval_gap_s * 1000)
        start = min(each.start_ms for each in intervals) - gap_ms
        end = max(each.end_ms for each in intervals) + gap_ms
        for old in self._ledger.sightings([key[0]], start, end):
            if old.stay == key:
                self._ledger.remove_sighting(old)
                intervals = [*intervals, Interval.from_sighting(old)]
        for interval in joined(intervals, self._parameters):
            self._ledger.put_sighting(interval.sighting(key))
