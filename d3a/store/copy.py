"""Copying a store into another, of either kind, and proving that the copy is equal."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from itertools import zip_longest
from typing import Any

from d3a.model import Json
from d3a.store.base import Batch, Store, StoreError, StoreRefused
from d3a.store.records import BATCH_FIELDS, from_json

RECORDS_AT_ONCE = 500
BYTES_AT_ONCE = 8_000_000

Progress = Callable[[int], None]


def copy_store(source: Store, target: Store, *, progress: Progress | None = None) -> Json:
    """Copy everything, pictures and checkpoint included, and return the target's counts.

    progress: called with the number of records copied so far. Of a file one moment is copied,
    whatever is written to it meanwhile; to a server nobody may write. Raises StoreRefused where
    the target is not empty, StoreError where the copy is not equal to what the source holds. A
    target that was cut short is best deleted.
    """
    if next(iter(target.dump()), None) is not None:
        raise StoreRefused(f"{target.uri} is not empty; copy into a new store")
    copied = 0
    with source.moment():
        for count, batch in _batches(source):
            target.apply(batch)
            copied += count
            if progress is not None:
                progress(copied)
        _verify(source, target)
    return target.counts()


def _batches(source: Store) -> Iterator[tuple[int, Batch]]:
    """Yield (records, batch) in the order of the dump: what is referred to comes first."""
    kind, gathered, size = "", list[Any](), 0
    for record in source.dump():
        full = len(gathered) >= RECORDS_AT_ONCE or size >= BYTES_AT_ONCE
        if gathered and (full or record["kind"] != kind):
            yield len(gathered), _batch(kind, gathered)
            gathered, size = [], 0
        kind = record["kind"]
        if kind == "keyframe":
            picture = source.keyframe(record["key"])
            if picture is None:
                raise StoreError(
                    f"{source.uri}: picture {record['key']!r} went while it was copied"
                )
            gathered.append(picture)
            size += len(picture.jpeg)
        elif kind == "state":
            yield 1, Batch(state=source.state())
        else:
            gathered.append(record if kind == "meta" else from_json(record))
    if gathered:
        yield len(gathered), _batch(kind, gathered)


def _batch(kind: str, gathered: list[Any]) -> Batch:
    if kind == "meta":
        return Batch(meta={record["key"]: record["value"] for record in gathered})
    if kind == "keyframe":
        return Batch(keyframes=gathered)
    fields: dict[str, Any] = {BATCH_FIELDS[kind]: gathered}
    return Batch(**fields)


def _verify(source: Store, target: Store) -> None:
    for wanted, found in zip_longest(source.dump(), target.dump()):
        if wanted != found:
            said = json.dumps({"source": wanted, "copy": found}, ensure_ascii=False)
            told = f"{target.uri} is not equal to {source.uri}"
            raise StoreError(f"{told}; was that written to meanwhile? {said[:200]}")
    for key in source.keyframe_keys():
        if source.keyframe(key) != target.keyframe(key):
            raise StoreError(f"{target.uri}: picture {key!r} differs from that of {source.uri}")
