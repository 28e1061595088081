"""The store on a MongoDB server: collections `oic` and `stc` as in the paper, asked by pymongo.

A batch is atomic for recovery, by the journal, and not for a reader that asks while it is being
applied: it may see the objects of a batch before its sightings, never a sighting without its stay.
Sorting is done here: the order must not depend on how a server compares strings.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

import numpy as np
from bson import json_util
from numpy.typing import NDArray
from pymongo import MongoClient
from pymongo.database import Database

from d3a.model import Json
from d3a.store import mongo_check, mongo_read, mongo_repair
from d3a.store import mongo_documents as documents
from d3a.store.base import (
    Area,
    Batch,
    Encounter,
    Keyframe,
    NativeQuery,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayRecord,
    StoreError,
    TaughtName,
    View,
)
from d3a.store.expected import check_expected
from d3a.store.lease import Lease
from d3a.store.limits import check_batch
from d3a.store.mongo_apply import Applier
from d3a.store.mongo_documents import Document
from d3a.store.mongo_journal import join_parts
from d3a.store.mongo_read import Find
from d3a.store.mongo_turn import LEASE, lease_of, server_ms
from d3a.store.mongo_write import embedding_kind, in_parts
from d3a.store.newest import ByReading
from d3a.store.records import Picture, Record, dump_records

Translate = Callable[[str], AbstractContextManager[None]]
_RETRIES = 3


class MongoStore(ByReading):
    """`Store` on a server; threads may share it. Opened by `mongo_server.open_mongo`.

    uri: the masked address. translated: turns errors of pymongo into StoreError.
    """

    def __init__(
        self,
        uri: str,
        client: MongoClient[Document],
        database: Database[Document],
        translated: Translate,
        *,
        read_only: bool = False,
    ) -> None:
        self.uri = uri
        self._read_only = read_only
        self._client = client
        self._db = database
        self._translated = translated
        self._applier = Applier(database)
        self._lock = threading.RLock()
        self._observer: Callable[[NativeQuery], None] | None = None

    def close(self) -> None:
        """Release the connections."""
        self._client.close()

    # writing
    @contextmanager
    def turn(self) -> Iterator[None]:
        """Be the one writer; see `Applier.turn`."""
        if self._read_only:
            raise StoreError(f"{self.uri}: it was opened for reading only")
        with self._lock, self._translated(self.uri), self._applier.turn():
            yield

    def apply(self, batch: Batch) -> None:
        """Apply a batch; returns when a majority of the servers has it in their journals."""
        check_batch(batch)
        with self.turn():
            check_expected(self, batch)
            self._applier.apply(batch)

    def recover(self) -> None:
        """Apply again what a writer has written down and not finished."""
        with self.turn():
            self._applier.finish()

    def lease(self) -> Lease | None:
        """Return who ingests or did last."""
        with self._translated(self.uri):
            return lease_of(self._db, LEASE)

    def put_lease(self, lease: Lease) -> None:
        """Keep another lease."""
        with self.turn():
            self._applier.keep()
            self._db["meta"].replace_one({"_id": LEASE}, lease.to_json(), upsert=True)

    def clock_ms(self) -> int:
        """Return the server's time."""
        with self._translated(self.uri):
            return server_ms(self._db)

    def collect_keyframes(self, keep: Sequence[str] = ()) -> int:
        """Remove pictures that nothing refers to, but for `keep`; count them."""
        with self.turn():
            unused = set(self.keyframe_keys()) - mongo_check.images(self._db) - set(keep)
            removed = 0
            for part in in_parts(sorted(unused)):
                self._applier.keep()
                removed += self._db["keyframes"].delete_many({"_id": {"$in": part}}).deleted_count
            return removed

    def scrub(self) -> bool:
        """Return False: a server frees the space of removed documents at its own pace."""
        return False

    # reading
    def moment(self) -> AbstractContextManager[object]:
        """Keep other writers away; who only reads cannot, and sees what they write meanwhile."""
        return nullcontext() if self._read_only else self.turn()

    def _find(self, name: str, find: Find) -> list[Document]:
        """Run one find; the observer is told of it, with the index of the winning plan."""
        with self._translated(self.uri):
            begun = time.perf_counter()
            found = list(self._db[name].find(find.filter, find.projection))
            elapsed_ms = (time.perf_counter() - begun) * 1000
            observer = self._observer
            if observer is not None:
                said = [json_util.dumps(find.filter), json_util.dumps(find.projection or {})]
                text = f"db.{name}.find({', '.join(said)})"
                observer(NativeQuery(text, self._index(name, find), len(found), elapsed_ms))
        return found

    def _index(self, name: str, find: Find) -> str | None:
        command = {"find": name, "filter": find.filter}
        plan = self._db.command("explain", command, verbosity="queryPlanner")
        return mongo_read.index_of(plan["queryPlanner"]["winningPlan"])

    def _all(self, name: str, finds: Iterable[Find]) -> list[Document]:
        """Run finds that differ in their part of the ids; a document counts once."""
        found = {document["_id"]: document for f in finds for document in self._find(name, f)}
        return list(found.values())

    def objects(
        self,
        *,
        ids: Sequence[str] | None = None,
        categories: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        votes: bool = False,
        embeddings: bool = True,
    ) -> list[ObjectRecord]:
        """Return objects by id; see `Store.objects`."""
        finds = mongo_read.objects(ids, categories, names, votes=votes, embeddings=embeddings)
        found = self._all("oic", finds)
        return sorted(map(documents.object_record, found), key=lambda record: record.object_id)

    def categories(self) -> list[tuple[str, int]]:
        """Return (category, objects of it), by category."""
        with self._translated(self.uri):
            groups = [{"$group": {"_id": "$category", "count": {"$sum": 1}}}]
            return sorted((g["_id"], g["count"]) for g in self._db["oic"].aggregate(groups))

    def names(self) -> list[TaughtName]:
        """Return what people call the objects, by (word, owner or ""), none twice."""
        asked = Find({"names": {"$gte": ""}}, {"names": 1, "owners": 1})
        pairs = {
            (word, owner or "", owner is not None)
            for document in self._find("oic", asked)
            for word, owner in zip(document["names"], document["owners"], strict=True)
        }
        return [TaughtName(word, owner if known else None) for word, owner, known in sorted(pairs)]

    def embeddings(self, limit: int | None = None) -> tuple[list[str], NDArray[np.float32]]:
        """Return the ids, by id, of the objects with an embedding, and their matrix (n, d)."""
        asked = Find({"emb": {"$exists": True}}, {"emb": 1})
        found = sorted(self._find("oic", asked), key=lambda document: str(document["_id"]))[:limit]
        with self._translated(self.uri):
            kind = embedding_kind(self._db)
        matrix = np.zeros((len(found), kind.length if kind else 0), dtype=np.float32)
        for row, document in zip(matrix, found, strict=True):
            row[:] = documents.embedding(document["emb"])
        return [document["_id"] for document in found], matrix

    def stays(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[StayRecord]:
        """Return stays by (object_id, place) whose [first, last] touches [start, end]."""
        found = self._all("stc", mongo_read.stays(object_ids, area, start_ms, end_ms))
        return sorted(map(documents.stay_record, found), key=lambda record: record.key)

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> list[Sighting]:
        """Return sightings by (start, object_id, place) that touch the closed [start, end]."""
        found = self._all("stc", mongo_read.sightings(object_ids, area, start_ms, end_ms))
        records = [record for document in found for record in documents.sightings(document)]
        return sorted(records, key=lambda r: (r.start_ms, r.object_id, r.place))[:limit]

    def edges(
        self,
        object_ids: Sequence[str],
        which: str,
        *,
        before_ms: int | None = None,
        after_ms: int | None = None,
    ) -> list[Sighting]:
        """Return each object's "first" or "last" sighting, by object_id.

        The spans of all documents are read first, then, round by round, each object's most
        promising document, until no other one can hold a better sighting.
        """
        spans = self._all("stc", mongo_read.spans(object_ids, after_ms, before_ms))
        search = mongo_read.EdgeSearch(spans, last=which == "last")
        while wanted := search.wanted():
            for part in in_parts(wanted):
                asked = mongo_read.intervals({"_id": {"$in": part}}, after_ms, before_ms)
                for document in self._find("stc", asked):
                    search.seen(documents.sightings(document))
        return search.found()

    def encounters(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        with_ids: Sequence[str] | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Encounter]:
        """Return encounters by (start, a, b, places) between the two lists of objects."""
        found = self._all(
            "encounters", mongo_read.encounters(object_ids, with_ids, start_ms, end_ms)
        )
        mine = None if object_ids is None else set(object_ids)
        others = None if with_ids is None else set(with_ids)
        kept = [
            record
            for record in map(documents.encounter_record, found)
            if record.is_between(mine, others)
        ]
        return sorted(
            kept, key=lambda r: (r.start_ms, r.object_a, r.object_b, r.place_a, r.place_b)
        )

    def keyframe(self, key: str) -> Keyframe | None:
        """Return a stored picture."""
        found = self._find("keyframes", Find({"_id": {"$in": [key]}}, None))
        return documents.keyframe_record(found[0]) if found else None

    def keyframe_keys(self) -> list[str]:
        """Return the keys of all stored pictures, sorted."""
        return sorted(document["_id"] for document in self._find("keyframes", Find({}, {"_id": 1})))

    def views(self, *, start_ms: int | None = None, end_ms: int | None = None) -> list[View]:
        """Return views by (start, end) that touch the closed [start, end]."""
        found = self._find("views", Find(mongo_read.touching(start_ms, end_ms), None))
        records = map(documents.view_record, found)
        return sorted(records, key=lambda r: (r.start_ms, r.end_ms, r.site, r.recording))

    def last_view_ms(self) -> int | None:
        """Return the time of the newest frame: of the views and of the recordings."""
        with self._translated(self.uri):
            newest = self._db["views"].find({}, {"end": 1}).sort("end", -1).limit(1)
            ends = [int(document["end"]) for document in newest]
        ends += [r.last_ms for r in self.recordings() if r.last_ms is not None]
        return max(ends, default=None)

    def regions(self) -> list[Region]:
        """Return named rooms, by name."""
        found = self._find("regions", Find({}, None))
        return sorted(map(documents.region_record, found), key=lambda record: record.name)

    def recordings(self) -> list[RecordingRecord]:
        """Return recordings, by key."""
        found = self._find("recordings", Find({}, None))
        return sorted(map(documents.recording_record, found), key=lambda record: record.key)

    def meta(self, key: str) -> Any | None:
        """Return a JSON value, None where it is not set."""
        found = self._find("meta", Find({"_id": f"meta:{key}"}, None))
        return json.loads(found[0]["value"]) if found else None

    def state(self) -> bytes | None:
        """Return the associator's checkpoint; asks again where a writer has just replaced it."""
        for _ in range(_RETRIES):
            pointer = self._find("meta", Find({"_id": "d3a:state"}, None))
            if not pointer:
                return None
            parts = self._find("state", Find({"digest": pointer[0]["digest"]}, None))
            payload = join_parts(parts)
            if payload is not None:
                return payload
        raise StoreError(f"{self.uri}: parts of the checkpoint are missing")

    def revision(self) -> tuple[int, int] | None:
        """Return None: a server does not count the writes of all its clients."""
        return None

    def counts(self) -> Json:
        """Return how many records of each kind there are, and their size in bytes."""
        with self._translated(self.uri):
            return mongo_check.counts(self._db)

    def check(self) -> list[str]:
        """Return what is damaged or dangling, a sentence each; [] for a sound store."""
        with self._translated(self.uri):
            return mongo_check.check(self._db)

    def repair(self) -> list[str]:
        """Mend what `check` finds, where it can be; a sentence for each change."""
        with self.turn():
            return mongo_repair.repair(self._db)

    def tracing(self, observer: Callable[[NativeQuery], None] | None) -> None:
        """Call `observer` after every find, with its plan; None stops it."""
        self._observer = observer

    def dump(self) -> Iterator[Json]:
        """Yield every record in a fixed order; a kind is read at one moment, not all of them."""
        return dump_records(self)

    # what `dump_records` reads
    def meta_entries(self) -> list[tuple[str, Any]]:
        """Return (key, value) by key."""
        found = self._find("meta", Find({"_id": {"$gte": "meta:", "$lt": "meta;"}}, None))
        entries = {d["_id"].removeprefix("meta:"): json.loads(d["value"]) for d in found}
        return sorted(entries.items())

    def records(self, kind: str) -> Sequence[Record]:
        """Return all records of a kind."""
        every: Mapping[str, Callable[[], Sequence[Record]]] = {
            "recording": self.recordings,
            "region": self.regions,
            "object": self.objects,
            "stay": self.stays,
            "sighting": self.sightings,
            "encounter": self.encounters,
            "view": self.views,
        }
        return every[kind]()

    def pictures(self) -> list[Picture]:
        """Return the stored pictures by key, without their bytes."""
        shown = {"width": 1, "height": 1, "time": 1, "size": 1}
        found = self._find("keyframes", Find({}, shown))
        pictures = (
            Picture(d["_id"], d["width"], d["height"], int(d["time"]), d["size"]) for d in found
        )
        return sorted(pictures, key=lambda shown: shown.key)
