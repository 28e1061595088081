"""A batch that survives a kill without transactions: it is written down first, then applied.

Every write of a batch is an absolute put or a removal, so applying it twice is applying it once.
A batch is one journal document, or several where it is large; it counts when all parts are there.
What is written down but not marked done is applied again when the store is opened for writing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bson.binary import Binary
from pymongo.database import Database

from d3a.store.base import Batch
from d3a.store.mongo_documents import Document
from d3a.store.records import batch_from_json, batch_to_json

PART_BYTES = 12_000_000
"""A document of MongoDB ends at 16 MB."""


@dataclass(frozen=True, slots=True)
class StatePointer:
    """Where the checkpoint is: its parts in `state` carry the digest."""

    digest: str
    parts: int


@dataclass(frozen=True, slots=True)
class Entry:
    """What the journal holds: a batch without pictures, which are stored before it."""

    batch: Batch
    state: StatePointer | None


def split(payload: bytes) -> list[bytes]:
    """Return the payload in parts that fit into a document, one at least."""
    return [payload[at : at + PART_BYTES] for at in range(0, max(1, len(payload)), PART_BYTES)]


def write_parts(collection: Any, payload: bytes) -> StatePointer:
    """Store a payload as documents named by its digest and their number; again is the same."""
    digest = hashlib.sha256(payload).hexdigest()
    parts = split(payload)
    for number, part in enumerate(parts):
        document = {
            "_id": f"{digest}:{number}",
            "digest": digest,
            "part": number,
            "parts": len(parts),
            "bytes": Binary(part),
        }
        collection.replace_one({"_id": document["_id"]}, document, upsert=True)
    return StatePointer(digest, len(parts))


def join_parts(documents: Sequence[Document]) -> bytes | None:
    """Return the payload of the documents of `write_parts`, None where parts are missing."""
    ordered = sorted(documents, key=lambda document: document["part"])
    if not ordered or len(ordered) != ordered[0]["parts"]:
        return None
    payload = b"".join(document["bytes"] for document in ordered)
    whole = hashlib.sha256(payload).hexdigest() == ordered[0]["digest"]
    return payload if whole else None


class Journal:
    """The collection `journal`: empty, or the one batch that is under way."""

    def __init__(self, database: Database[Document]) -> None:
        self._journal = database["journal"]

    def write(self, entry: Entry) -> None:
        """Write an entry down; from here on it will be applied, come what may."""
        pointer = None if entry.state is None else [entry.state.digest, entry.state.parts]
        value = {**batch_to_json(entry.batch), "state": pointer}
        write_parts(self._journal, json.dumps(value, ensure_ascii=False).encode("utf-8"))

    def pending(self) -> Entry | None:
        """Return the entry that was not finished; None, too, for one that was cut in writing."""
        payload = join_parts(list(self._journal.find({})))
        if payload is None:
            return None
        value = json.loads(payload)
        state = None if value["state"] is None else StatePointer(*value["state"])
        return Entry(batch_from_json(value), state)

    def done(self) -> None:
        """Mark the entry done: nothing of it is left."""
        self._journal.delete_many({})
