"""Records as plain JSON: what `dump` yields, what a copy reads and what Mongo's journal holds."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from numbers import Integral, Real
from typing import Any, Protocol

import numpy as np

from d3a.model import Json
from d3a.store.base import (
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayRecord,
    TaughtName,
    View,
)

Record = ObjectRecord | StayRecord | Sighting | Encounter | View | Region | RecordingRecord
RECORD_KINDS: dict[str, type[Record]] = {
    "recording": RecordingRecord,
    "region": Region,
    "object": ObjectRecord,
    "stay": StayRecord,
    "sighting": Sighting,
    "encounter": Encounter,
    "view": View,
}
BATCH_FIELDS: dict[str, str] = {
    "recording": "recordings",
    "region": "regions",
    "object": "objects",
    "stay": "stays",
    "sighting": "sightings",
    "encounter": "encounters",
    "view": "views",
}
"""Kind of record -> the field of `Batch` that puts it, in the order of `dump`."""
_KIND_OF = {record_type: kind for kind, record_type in RECORD_KINDS.items()}
_FIELDS = {record_type: tuple(f.name for f in fields(record_type)) for record_type in _KIND_OF}


def meta_json(value: Any) -> str:
    """Return the one text of a JSON value: sorted keys, so that equal values are equal texts."""
    return json.dumps(value, ensure_ascii=False, sort_keys=True, allow_nan=False)


def to_json(record: Record) -> Json:
    """Return the record as JSON with its `kind`; an embedding is base64 of its float32 bytes."""
    record_type = type(record)
    values = {name: _plain(getattr(record, name)) for name in _FIELDS[record_type]}
    return {"kind": _KIND_OF[record_type], **values}


def from_json(value: Json) -> Record:
    """Return the record that `to_json` wrote."""
    record_type = RECORD_KINDS[value["kind"]]
    given = {name: _frozen(value[name]) for name in _FIELDS[record_type]}
    if record_type is ObjectRecord:
        given["names"] = tuple(TaughtName(*name) for name in given["names"])
        if given["embedding"] is not None:
            given["embedding"] = embedding_from_bytes(base64.b64decode(given["embedding"]))
    return record_type(**given)


_REMOVALS = (
    "removed_objects",
    "removed_stays",
    "removed_sightings",
    "removed_encounters",
    "removed_regions",
    "removed_views",
    "removed_keyframes",
)


def batch_to_json(batch: Batch) -> Json:
    """Return a batch as JSON, without its pictures and its checkpoint."""
    put = [to_json(r) for name in BATCH_FIELDS.values() for r in getattr(batch, name)]
    removed = {name: _plain(getattr(batch, name)) for name in _REMOVALS}
    return {"put": put, **removed, "meta": dict(batch.meta)}


def batch_from_json(value: Json) -> Batch:
    """Return the batch that `batch_to_json` wrote."""
    put: dict[str, Any] = {name: [] for name in BATCH_FIELDS.values()}
    for record in value["put"]:
        put[BATCH_FIELDS[record["kind"]]].append(from_json(record))
    removed: dict[str, Any] = {name: _frozen(value.get(name, ())) for name in _REMOVALS}
    return Batch(**put, **removed, meta=value["meta"])


def embedding_bytes(embedding: np.ndarray[Any, np.dtype[np.float32]]) -> bytes:
    """Return little-endian float32 bytes of a (d,) embedding."""
    return np.ascontiguousarray(embedding, dtype="<f4").tobytes()


def embedding_from_bytes(blob: bytes) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Return the (d,) embedding of `embedding_bytes`; it cannot be written to."""
    return np.frombuffer(blob, dtype="<f4")


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value) + 0.0  # no negative zero: it is equal, but prints otherwise
    if isinstance(value, np.ndarray):
        return base64.b64encode(embedding_bytes(value)).decode("ascii")
    if isinstance(value, TaughtName):
        return [value.word, value.owner]
    return [_plain(part) for part in value]


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


@dataclass(frozen=True, slots=True)
class Picture:
    """A stored picture without its bytes."""

    key: str
    width: int
    height: int
    time_ms: int
    size: int


class Snapshot(Protocol):
    """What `dump_records` reads; each part comes in the order that `Store` states."""

    def meta_entries(self) -> Iterable[tuple[str, Any]]:
        """Yield (key, value) by key."""
        ...

    def records(self, kind: str) -> Iterable[Record]:
        """Yield all records of a kind of `RECORD_KINDS`."""
        ...

    def pictures(self) -> Iterable[Picture]:
        """Yield the stored pictures by key."""
        ...

    def state(self) -> bytes | None:
        """Return the checkpoint."""
        ...


def dump_records(snapshot: Snapshot) -> Iterator[Json]:
    """Yield everything in a fixed order: meta, records, pictures by size, state by its hash."""
    for key, value in snapshot.meta_entries():
        yield {"kind": "meta", "key": key, "value": value}
    for kind in RECORD_KINDS:
        for record in snapshot.records(kind):
            yield to_json(record)
    for picture in snapshot.pictures():
        yield {"kind": "keyframe", **{name: getattr(picture, name) for name in _PICTURE}}
    state = snapshot.state()
    if state is not None:
        import hashlib  # loads a library of ciphers, which a question does without

        digest = hashlib.sha256(state).hexdigest()
        yield {"kind": "state", "size": len(state), "sha256": digest}


_PICTURE = tuple(f.name for f in fields(Picture))


def picture(keyframe: Keyframe) -> Picture:
    """Return what a dump says of a keyframe."""
    return Picture(
        keyframe.key, keyframe.width, keyframe.height, keyframe.time_ms, len(keyframe.jpeg)
    )
