"""The associator's state as bytes: JSON and plain arrays, a version, and no pickle."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.model import Detection, Json
from d3a.sightings import FrameRef
from d3a.store.base import StoreError

VERSION = 1
_MAGIC = b"D3A-STATE\n"
Arrays = dict[str, NDArray[Any]]


def pack(record: Json, arrays: Arrays) -> bytes:
    """Return the state as bytes; equal states give equal bytes."""
    text = json.dumps(record, ensure_ascii=False, sort_keys=True, allow_nan=False).encode()
    out = io.BytesIO()
    out.write(_MAGIC + f"{VERSION} {len(text)} {len(arrays)}\n".encode() + text)
    for name in sorted(arrays):
        out.write(name.encode() + b"\n")
        np.lib.format.write_array(out, np.ascontiguousarray(arrays[name]), allow_pickle=False)
    return out.getvalue()


def unpack(state: bytes) -> tuple[Json, Arrays]:
    """Return what `pack` was given. Raises StoreError for bytes of another program or version."""
    source = io.BytesIO(state)
    if source.readline() != _MAGIC:
        raise StoreError("the store's checkpoint is not one of this program")
    version, size, count = (int(part) for part in source.readline().split())
    if version != VERSION:
        raise StoreError(
            f"the store's checkpoint has version {version}, this program reads {VERSION}: finish "
            "the ingest with the program that began it, or use another store"
        )
    record = json.loads(source.read(size))
    arrays = {}
    for _ in range(count):
        name = source.readline().decode().strip()
        arrays[name] = np.lib.format.read_array(source, allow_pickle=False)
    return record, arrays


def stacked(rows: Sequence[NDArray[np.float32] | None]) -> NDArray[np.float32]:
    """Return embeddings as a matrix (n, d); what has none is a row of zeros, d = 0 if all are."""
    length = next((len(row) for row in rows if row is not None), 0)
    none = np.zeros(length, dtype=np.float32)
    matrix = [none if row is None else row for row in rows]
    return np.array(matrix, dtype=np.float32).reshape(len(rows), length)


def ref_json(ref: FrameRef) -> Json:
    """Return a frame's reference as JSON."""
    return asdict(ref)


def ref_of(record: Json) -> FrameRef:
    """Return what `ref_json` wrote."""
    viewer = record["viewer"]
    return FrameRef(**(record | {"viewer": None if viewer is None else tuple(viewer)}))


_TUPLES = ("box", "position", "covariance", "extent_m")


def detection_json(detection: Detection) -> Json:
    """Return a detection as JSON, without its embedding."""
    names = ("category", "probability", "row", *_TUPLES)
    return {name: getattr(detection, name) for name in names}


def detection_of(record: Json, embedding: NDArray[np.float32] | None) -> Detection:
    """Return what `detection_json` wrote, with its embedding."""
    tuples = {n: None if record[n] is None else tuple(record[n]) for n in _TUPLES}
    return Detection(**(record | tuples), embedding=embedding)
