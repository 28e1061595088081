"""How a batch becomes documents: each step may be repeated, and ends in the same documents."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from pymongo import DeleteMany, DeleteOne, ReplaceOne, UpdateOne
from pymongo.database import Database

from d3a.store import mongo_documents as documents
from d3a.store.base import Batch, Sighting, StayKey, StayRecord, StoreError
from d3a.store.limits import EmbeddingKind, check_referred, referred
from d3a.store.limits import embedding_kind as kind_with
from d3a.store.mongo_documents import MAX_INTERVALS, Document
from d3a.store.mongo_journal import Entry, StatePointer, write_parts
from d3a.store.records import meta_json

SENT_AT_ONCE = 500
_ANOTHER = "does another process write to this store?"
Operation = Any  # one of pymongo's bulk operations


@dataclass(slots=True)
class Part:
    """A document of a stay as it is stored: its number and the starts in its array."""

    seq: int
    starts: set[int]


@dataclass(slots=True)
class Addition:
    """New intervals of one document; before: how many it holds, which guards the push."""

    before: int
    records: list[Sighting] = field(default_factory=list)

    def push(self, key: str) -> Operation:
        """Return the push; it finds no document where another process was quicker."""
        change = {
            "$push": {"intervals": {"$each": [documents.interval(r) for r in self.records]}},
            "$set": {"n": self.before + len(self.records)},
            "$min": {"first": documents.date(min(r.start_ms for r in self.records))},
            "$max": {"last": documents.date(max(r.end_ms for r in self.records))},
        }
        return UpdateOne({"_id": key, "n": self.before}, change)


def in_parts(values: Iterable[Any]) -> Iterator[list[Any]]:
    """Yield the values, so many in one command as a server takes gladly."""
    every = list(values)
    for at in range(0, len(every), SENT_AT_ONCE):
        yield every[at : at + SENT_AT_ONCE]


def embedding_kind(database: Database[Document]) -> EmbeddingKind | None:
    """Return what fills the embeddings of a store."""
    found = database["meta"].find_one({"_id": "d3a:embedding"})
    return EmbeddingKind(found["model"], found["length"]) if found else None


class Writer:
    """Writes batches into a database; the caller keeps the journal.

    keep: called before each command that writes; it raises where this client may write no more.
    """

    def __init__(self, database: Database[Document], keep: Callable[[], None]) -> None:
        self._db = database
        self._keep = keep

    def check(self, batch: Batch) -> None:
        """Raise StoreRefused for records that refer to what is not stored."""
        objects, stays = referred(batch)
        found = [
            document["_id"]
            for part in in_parts(sorted(objects))
            for document in self._db["oic"].find({"_id": {"$in": part}}, {"_id": 1})
        ]
        firsts = {documents.stay_id(stay, 0): stay for stay in stays}
        known = [
            firsts[document["_id"]]
            for part in in_parts(sorted(firsts))
            for document in self._db["stc"].find({"_id": {"$in": part}}, {"_id": 1})
        ]
        check_referred(batch, found, known)
        kind_with(batch, embedding_kind(self._db))

    def put_bytes(self, batch: Batch) -> StatePointer | None:
        """Store pictures and checkpoint ahead of the batch that refers to them."""
        for keyframe in batch.keyframes:  # one by one: each may be megabytes
            document = documents.keyframe_document(keyframe)
            self._keep()
            self._db["keyframes"].replace_one({"_id": keyframe.key}, document, upsert=True)
        return None if batch.state is None else write_parts(self._db["state"], batch.state)

    def write(self, entry: Entry) -> None:
        """Apply an entry of the journal: removals, then puts, what is referred to first."""
        batch = entry.batch
        self._remove(batch)
        kind = kind_with(batch, None)
        if kind is not None:
            about = {"_id": "d3a:embedding", "model": kind.model, "length": kind.length}
            self._put("meta", [about])
        self._put("oic", map(documents.object_document, batch.objects))
        self._put_stays(batch.stays)
        self._put_sightings(batch.sightings)
        self._put("encounters", map(documents.encounter_document, batch.encounters))
        self._put("views", map(documents.view_document, batch.views))
        self._put("regions", map(documents.region_document, batch.regions))
        self._put("recordings", map(documents.recording_document, batch.recordings))
        self._put_meta(batch)
        if entry.state is not None:
            self._turn_to_state(entry.state)

    def _put_meta(self, batch: Batch) -> None:
        kept = [(key, value) for key, value in batch.meta.items() if value is not None]
        self._put("meta", [{"_id": f"meta:{k}", "value": meta_json(v)} for k, v in kept])
        gone = [f"meta:{key}" for key, value in batch.meta.items() if value is None]
        if gone:
            self._bulk("meta", [DeleteMany({"_id": {"$in": gone}})])

    def _turn_to_state(self, state: StatePointer) -> None:
        self._put("meta", [{"_id": "d3a:state", "digest": state.digest, "parts": state.parts}])
        self._bulk("state", [DeleteMany({"digest": {"$ne": state.digest}})])

    def _bulk(self, name: str, operations: Iterable[Operation]) -> int:
        """Send the operations in order and return how many found their document."""
        matched = 0
        for part in in_parts(operations):
            self._keep()
            matched += self._db[name].bulk_write(part, ordered=True).matched_count
        return matched

    def _put(self, name: str, puts: Iterable[Document]) -> None:
        last = {put["_id"]: put for put in puts}  # of two puts of one key the later one counts
        self._bulk(name, [ReplaceOne({"_id": key}, put, upsert=True) for key, put in last.items()])

    # removals
    def _remove(self, batch: Batch) -> None:
        objects = list(batch.removed_objects)
        stays = [(object_id, int(place)) for object_id, place in batch.removed_stays]
        encounters: list[Operation] = []
        for end in ("a", "b"):
            encounters += [DeleteMany({end: object_id}) for object_id in objects]
            encounters += [DeleteMany({end: stay[0], f"place_{end}": stay[1]}) for stay in stays]
        encounters += [
            DeleteOne({"_id": documents.encounter_id(*key)}) for key in batch.removed_encounters
        ]
        self._bulk("encounters", encounters)
        self._bulk(
            "stc",
            [DeleteMany({"object_id": object_id}) for object_id in objects]
            + [DeleteMany({"object_id": stay[0], "place": stay[1]}) for stay in stays],
        )
        self._bulk("oic", [DeleteOne({"_id": object_id}) for object_id in objects])
        self._remove_sightings(batch.removed_sightings)
        self._bulk("regions", [DeleteOne({"_id": name}) for name in batch.removed_regions])
        views = [DeleteOne({"_id": documents.view_key(*key)}) for key in batch.removed_views]
        self._bulk("views", views)
        self._bulk("keyframes", [DeleteOne({"_id": key}) for key in batch.removed_keyframes])

    def _remove_sightings(self, keys: Sequence[tuple[str, int, int]]) -> None:
        layout = self._layout({(object_id, int(place)) for object_id, place, _ in keys})
        gone: dict[StayKey, set[int]] = {}
        for object_id, place, start_ms in keys:
            gone.setdefault((object_id, int(place)), set()).add(int(start_ms))
        operations = []
        for stay, starts in gone.items():
            for part in layout.get(stay, []):
                pulled = [documents.date(start_ms) for start_ms in starts & part.starts]
                change = {
                    "$pull": {"intervals": {"start": {"$in": pulled}}},
                    "$set": {"n": len(part.starts - starts)},
                }
                if pulled:
                    key = {"_id": documents.stay_id(stay, part.seq)}
                    operations.append(UpdateOne(key, change))
        self._bulk("stc", operations)

    # puts into stc
    def _layout(self, stays: set[StayKey]) -> dict[StayKey, list[Part]]:
        """Return the documents of each stay, by number, with the starts that each holds."""
        found: dict[StayKey, list[Part]] = {}
        shown = {"object_id": 1, "place": 1, "seq": 1, "intervals.start": 1}
        for part in in_parts(sorted(stays)):
            asked = {
                "object_id": {"$in": sorted({object_id for object_id, _ in part})},
                "place": {"$in": sorted({place for _, place in part})},
            }
            for document in self._db["stc"].find(asked, shown):
                key = (document["object_id"], document["place"])
                starts = {int(interval["start"]) for interval in document["intervals"]}
                if key in stays and all(p.seq != document["seq"] for p in found.get(key, [])):
                    found.setdefault(key, []).append(Part(document["seq"], starts))
        return {key: sorted(parts, key=lambda p: p.seq) for key, parts in found.items()}

    def _put_stays(self, records: Sequence[StayRecord]) -> None:
        last = {record.key: record for record in records}
        operations: list[Operation] = []
        for key, record in last.items():
            whole = documents.stay_part(record)
            moved = _moved(record, whole)
            first: Document = {
                **moved,
                "$set": {**moved["$set"], "stay": whole["stay"]},
                "$min": {"first": whole["stay"]["first"]},
                "$max": {"last": whole["stay"]["last"]},
                "$setOnInsert": _new_part(key, 0),
            }
            operations.append(UpdateOne({"_id": documents.stay_id(key, 0)}, first, upsert=True))
        for part in in_parts(last):
            ids = {"object_id": {"$in": sorted({object_id for object_id, _ in part})}}
            shown = {"object_id": 1, "place": 1}
            for other in self._db["stc"].find({**ids, "seq": {"$gt": 0}}, shown):
                key = (other["object_id"], other["place"])
                if key in last:
                    moved = _moved(last[key], documents.stay_part(last[key]))
                    operations.append(UpdateOne({"_id": other["_id"]}, moved))
        self._bulk("stc", operations)

    def _put_sightings(self, records: Sequence[Sighting]) -> None:
        """Replace the intervals that are there, push the others into each stay's newest part."""
        last: dict[tuple[str, int, int], Sighting] = {}  # of two puts of one key the later counts
        for record in records:
            last[record.object_id, int(record.place), int(record.start_ms)] = record
        layout = self._layout({record.stay for record in last.values()})
        replaced: list[Operation] = []
        added: dict[str, Addition] = {}
        for record in last.values():
            if record.stay not in layout:
                raise StoreError(f"the stay {record.stay} has gone: {_ANOTHER}")
            parts = layout[record.stay]
            holder = next((part for part in parts if int(record.start_ms) in part.starts), None)
            if holder is not None:
                replaced.append(_replacement(record, holder.seq))
                continue
            if len(parts[-1].starts) >= MAX_INTERVALS:
                parts.append(Part(parts[-1].seq + 1, set()))
                self._start_part(record.stay, parts[-1].seq)
            key = documents.stay_id(record.stay, parts[-1].seq)
            added.setdefault(key, Addition(len(parts[-1].starts))).records.append(record)
            parts[-1].starts.add(int(record.start_ms))
        pushed = [addition.push(key) for key, addition in added.items()]
        if self._bulk("stc", replaced + pushed) != len(replaced) + len(pushed):
            raise StoreError(f"documents of stays changed meanwhile: {_ANOTHER}")

    def _start_part(self, stay: StayKey, seq: int) -> None:
        """Make the next document of a stay, empty, with the place of the first."""
        first = self._db["stc"].find_one({"_id": documents.stay_id(stay, 0)}, {"intervals": 0})
        if first is None:
            raise StoreError(f"the stay {stay} has gone: {_ANOTHER}")
        shared: Document = {name: first[name] for name in ("site", "z", "loc") if name in first}
        document: Document = {**_new_part(stay, seq), **shared}
        key = {"_id": documents.stay_id(stay, seq)}
        self._bulk("stc", [UpdateOne(key, {"$setOnInsert": document}, upsert=True)])


def _new_part(stay: StayKey, seq: int) -> Document:
    return {"object_id": stay[0], "place": int(stay[1]), "seq": seq, "n": 0, "intervals": []}


def _moved(record: StayRecord, whole: Document) -> Document:
    """Return the update that every document of a stay takes."""
    loc = documents.location(record)
    moved: Document = {"$set": {"site": whole["site"], "z": whole["z"]}}
    if loc is None:
        moved["$unset"] = {"loc": ""}
    else:
        moved["$set"]["loc"] = loc
    return moved


def _replacement(record: Sighting, seq: int) -> Operation:
    start = documents.date(record.start_ms)
    change = {
        "$set": {"intervals.$": documents.interval(record)},
        "$max": {"last": documents.date(record.end_ms)},
    }
    key = documents.stay_id(record.stay, seq)
    return UpdateOne({"_id": key, "intervals.start": start}, change)
