"""What a store takes: records outside of these limits are refused before anything is written.

The numbers were measured on both backends: an interval longer than an hour makes every time
filter wider, an R*Tree and a 2d index need bounds, a document of MongoDB ends at 16 MB.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

import numpy as np

from d3a.store.base import (
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayKey,
    StayRecord,
    StoreRefused,
    View,
)
from d3a.store.records import meta_json

MAX_INTERVAL_MS = 3_600_000
MAX_TIME_MS = 7_258_118_400_000  # 2200-01-01
MAX_XY_M = 10_000.0
MAX_Z_M = 1_000.0
MIN_EMBEDDING, MAX_EMBEDDING = 64, 4096
MAX_TEXT = 1_024  # characters of a name, an id or a frame
MAX_PARTS = 4_096  # entries of a tuple inside a record: names, corners, reasons
MAX_PICTURE_BYTES = 12_000_000
MAX_META_BYTES = 1_000_000
MAX_STATE_BYTES = 900_000_000
_MAX_WHOLE = 2**63 - 1
_PLAIN = frozenset({float, int})


@dataclass(frozen=True, slots=True)
class EmbeddingKind:
    """What fills the embeddings of a store: one model, one length, or they cannot be compared."""

    model: str
    length: int


def check_batch(batch: Batch) -> None:
    """Raise StoreRefused for the first record outside of the limits; the message names it."""
    _each("object", batch.objects, _object)
    _each("stay", batch.stays, _stay)
    _each("sighting", batch.sightings, _sighting)
    _each("encounter", batch.encounters, _encounter)
    _each("view", batch.views, _view)
    _each("keyframe", batch.keyframes, _keyframe)
    _each("region", batch.regions, _region)
    _each("recording", batch.recordings, _recording)
    _each("removal", [(key,) for key in (*batch.removed_objects, *batch.removed_regions)], _key)
    _each("removal", batch.removed_stays, _key)
    _each("removal", batch.removed_sightings, _key)
    _each("removal", batch.removed_encounters, _key)
    _each("removal", batch.removed_views, _view_key)
    _each("removal", [(key,) for key in batch.removed_keyframes], _key)
    both = {picture.key for picture in batch.keyframes}.intersection(batch.removed_keyframes)
    if both:
        raise StoreRefused(f"picture {min(both)!r} is both put and removed in one batch")
    _each("meta", batch.meta.items(), _meta)
    if batch.state is not None and len(batch.state) > MAX_STATE_BYTES:
        raise StoreRefused(f"a checkpoint of {len(batch.state)} bytes is over {MAX_STATE_BYTES}")


def embedding_kind(batch: Batch, stored: EmbeddingKind | None) -> EmbeddingKind | None:
    """Return the kind of the store's embeddings after the batch.

    Raises StoreRefused where the batch brings another model or length than the store holds.
    """
    kind = stored
    for record in batch.objects:
        if record.embedding is None:
            continue
        brought = EmbeddingKind(record.embedding_model or "", len(record.embedding))
        if kind is not None and kind != brought:
            raise StoreRefused(
                f"object {record.object_id!r} has an embedding of {brought.length} numbers by "
                f"{brought.model or 'an unnamed model'!r}; this store holds {kind.length} by "
                f"{kind.model or 'an unnamed model'!r}: use another store for it"
            )
        kind = brought
    return kind


def referred(batch: Batch) -> tuple[set[str], set[StayKey]]:
    """Return the objects and stays that the batch refers to and does not put itself.

    A stay needs its object, a sighting its stay, an encounter both stays.
    """
    put_objects = {record.object_id for record in batch.objects}
    objects = {record.object_id for record in batch.stays} - put_objects
    put_stays = {record.key for record in batch.stays}
    stays = {record.stay for record in batch.sightings}
    stays |= {(record.object_a, record.place_a) for record in batch.encounters}
    stays |= {(record.object_b, record.place_b) for record in batch.encounters}
    return objects, stays - put_stays


def check_referred(
    batch: Batch, known_objects: Iterable[str], known_stays: Iterable[StayKey]
) -> None:
    """Raise StoreRefused where the batch refers to what is not stored, or what it removes.

    known_objects, known_stays: those of `referred` that the store holds.
    """
    objects, stays = referred(batch)
    gone = set(batch.removed_objects)
    objects -= set(known_objects) - gone
    stays -= {stay for stay in known_stays if stay[0] not in gone} - set(batch.removed_stays)
    if objects:
        raise StoreRefused(f"a stay of object {min(objects)!r}, which is not stored")
    if stays:
        object_id, place = min(stays)
        raise StoreRefused(
            f"a sighting or encounter of object {object_id!r} at place {place}, a stay that is "
            "not stored"
        )


def _each(kind: str, records: Iterable[Any], check: Callable[[Any], None]) -> None:
    for record in records:
        try:
            check(record)
        except _Outside as outside:
            raise StoreRefused(f"{kind} {_short(record)}: {outside}") from None


class _Outside(Exception):  # noqa: N818  never leaves this module
    """What is wrong with a value; `_each` says which record holds it."""


def _short(record: Any) -> str:
    text = repr(record)
    return text if len(text) <= 200 else text[:197] + "..."


def _text(name: str, value: object, *, empty: bool = True) -> None:
    if not isinstance(value, str):
        raise _Outside(f"{name} must be text")
    if len(value) > MAX_TEXT:
        raise _Outside(f"{name} has {len(value)} characters, at most {MAX_TEXT} are kept")
    if not value and not empty:
        raise _Outside(f"{name} is empty")
    if "\0" in value:
        raise _Outside(f"{name} holds a NUL character")
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        raise _Outside(f"{name} is not valid Unicode (a lone surrogate)") from None


def _whole(name: str, value: object, low: int = 0, high: int = _MAX_WHOLE) -> None:
    if not isinstance(value, (int, Integral)):  # the abstract one alone is asked slowly
        raise _Outside(f"{name} must be a whole number, not {value!r}")
    if not low <= int(value) <= high:
        raise _Outside(f"{name} {value} is outside of {low}..{high}")


def _number(name: str, value: object, low: float = -math.inf, high: float = math.inf) -> None:
    if not isinstance(value, (float, int, Real)) or not math.isfinite(value):
        raise _Outside(f"{name} must be a finite number, not {value!r}")
    if not low <= float(value) <= high:
        raise _Outside(f"{name} {value} is outside of {low:g}..{high:g}")


def _numbers(name: str, values: Sequence[Any] | None, count: int) -> None:
    if values is None:
        return
    if len(values) != count:
        raise _Outside(f"{name} needs {count} numbers, not {len(values)}")
    if _PLAIN.issuperset(map(type, values)) and all(map(math.isfinite, values)):
        return  # so nearly all are, and one by one they take five times as long
    for value in values:
        _number(name, value)


def _parts(name: str, values: Sequence[object]) -> None:
    if len(values) > MAX_PARTS:
        raise _Outside(f"{name} has {len(values)} entries, at most {MAX_PARTS} are kept")


def _ground(name: str, value: object) -> None:
    """Check x or y: below 10 km, the bound of MongoDB's 2d index."""
    _number(name, value)
    if not -MAX_XY_M < value < MAX_XY_M:  # type: ignore[operator]  # a Real by the line above
        raise _Outside(f"{name} {value} m is not within {MAX_XY_M:g} m of the map's origin")


def _span(start_ms: object, end_ms: object, longest_ms: int | None = None) -> None:
    _whole("start", start_ms, 0, MAX_TIME_MS)
    _whole("end", end_ms, 0, MAX_TIME_MS)
    length = int(end_ms) - int(start_ms)  # type: ignore[call-overload]  # whole by the lines above
    if length < 0:
        raise _Outside(f"it ends {-length} ms before it starts")
    if longest_ms is not None and length > longest_ms:
        raise _Outside(f"{length} ms is longer than {longest_ms} ms: split it into parts")


def _object(record: ObjectRecord) -> None:
    _text("object_id", record.object_id, empty=False)
    _text("category", record.category, empty=False)
    _text("site", record.site)
    _number("weight", record.weight, 0)
    _span(record.first_ms, record.last_ms)
    _parts("categories", record.categories)
    for category, weight in record.categories:
        _text("a category", category, empty=False)
        _number("a category's weight", weight, 0)
    _parts("names", record.names)
    for name in record.names:
        _text("a taught name", name.word, empty=False)
        _text("an owner", name.owner or "")
    _text("embedding_model", record.embedding_model or "")
    _numbers("extent", record.extent_m, 2)
    if record.embedding is not None:
        _embedding(record.embedding)


def _embedding(embedding: object) -> None:
    if not isinstance(embedding, np.ndarray) or embedding.dtype != np.float32:
        raise _Outside("an embedding must be a float32 array")
    if embedding.ndim != 1 or not MIN_EMBEDDING <= len(embedding) <= MAX_EMBEDDING:
        raise _Outside(
            f"an embedding of shape {embedding.shape} is not one row of "
            f"{MIN_EMBEDDING} to {MAX_EMBEDDING} numbers"
        )
    if not np.isfinite(embedding).all():
        raise _Outside("an embedding holds NaN or infinity")


def _stay(record: StayRecord) -> None:
    _text("object_id", record.object_id, empty=False)
    _text("site", record.site)
    _whole("place", record.place)
    _span(record.first_ms, record.last_ms)
    _number("weight", record.weight, 0)
    _whole("seen", record.seen)
    _numbers("position", record.position, 3)
    if record.position is not None:
        _ground("x", record.position[0])
        _ground("y", record.position[1])
        _number("z", record.position[2], -MAX_Z_M, MAX_Z_M)
    _numbers("covariance", record.covariance, 9)
    if record.moved_from is not None:
        _whole("moved_from", record.moved_from[0])
        _number("the score of moved_from", record.moved_from[1])
    if record.last_absent_ms is not None:
        _whole("last_absent", record.last_absent_ms, 0, MAX_TIME_MS)


def _sighting(record: Sighting) -> None:
    _text("object_id", record.object_id, empty=False)
    _whole("place", record.place)
    _span(record.start_ms, record.end_ms, MAX_INTERVAL_MS)
    _text("frame", record.frame)
    _number("probability", record.probability, 0, 1)
    _numbers("box", record.box, 4)
    _text("image", record.image or "")
    _whole("seen", record.seen)
    _text("category", record.category)
    _text("recording", record.recording)
    if record.keyframe_ms is not None:
        _whole("keyframe time", record.keyframe_ms, 0, MAX_TIME_MS)
    _numbers("viewer", record.viewer, 7)


def _encounter(record: Encounter) -> None:
    _text("object_a", record.object_a, empty=False)
    _text("object_b", record.object_b, empty=False)
    if record.object_a >= record.object_b:
        raise _Outside("object_a must come before object_b")
    _whole("place_a", record.place_a)
    _whole("place_b", record.place_b)
    _span(record.start_ms, record.end_ms, MAX_INTERVAL_MS)
    _text("frame", record.frame)
    _numbers("box_a", record.box_a, 4)
    _numbers("box_b", record.box_b, 4)
    _number("probability", record.probability, 0, 1)
    _text("image", record.image or "")
    _whole("seen", record.seen)
    _text("recording", record.recording)
    _numbers("viewer", record.viewer, 7)
    _numbers("apart", record.apart, 4)


def _view(record: View) -> None:
    _span(record.start_ms, record.end_ms)
    _whole("frames", record.frames)
    _text("site", record.site)
    _text("recording", record.recording)
    for name, value in (("x", record.x), ("y", record.y)):
        if value is not None:
            _ground(name, value)
    for name in ("yaw", "half_angle", "range_m"):
        if getattr(record, name) is not None:
            _number(name, getattr(record, name))


def _keyframe(record: Keyframe) -> None:
    _text("key", record.key, empty=False)
    if not 0 < len(record.jpeg) <= MAX_PICTURE_BYTES:
        raise _Outside(f"{len(record.jpeg)} bytes are not within 1..{MAX_PICTURE_BYTES}")
    _whole("width", record.width, 1)
    _whole("height", record.height, 1)
    _whole("time", record.time_ms, 0, MAX_TIME_MS)


def _region(record: Region) -> None:
    _text("name", record.name, empty=False)
    _text("site", record.site)
    if len(record.polygon) < 3:
        raise _Outside("a room needs three corners or more")
    _parts("polygon", record.polygon)
    for corner in record.polygon:
        _numbers("a corner", corner, 2)
        _ground("x", corner[0])
        _ground("y", corner[1])


def _recording(record: RecordingRecord) -> None:
    for name in ("key", "name", "site"):
        _text(name, getattr(record, name), empty=name != "key")
    for name in ("zone", "last_frame"):
        _text(name, getattr(record, name) or "")
    _whole("frames", record.frames)
    _whole("detections", record.detections)
    for name in ("first_ms", "last_ms"):
        if getattr(record, name) is not None:
            _whole(name, getattr(record, name), 0, MAX_TIME_MS)
    _parts("skipped", record.skipped)
    for reason, count in record.skipped:
        _text("a reason", reason)
        _whole("a count", count)


def _key(parts: Sequence[object]) -> None:
    for part in parts:
        if isinstance(part, str):
            _text("a key", part, empty=False)
        else:
            _whole("a key's number", part)


def _view_key(parts: tuple[str, str, int]) -> None:
    site, recording, start_ms = parts
    _text("site", site)
    _text("recording", recording)
    _whole("start", start_ms)


def _meta(entry: tuple[str, Any]) -> None:
    key, value = entry
    _text("key", key, empty=False)
    try:
        size = len(meta_json(value).encode("utf-8"))
    except (TypeError, ValueError) as error:  # UnicodeEncodeError is a ValueError
        raise _Outside(f"the value is not JSON ({error})") from None
    if size > MAX_META_BYTES:
        raise _Outside(f"the value takes {size} bytes, at most {MAX_META_BYTES} are kept")
