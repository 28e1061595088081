"""Records as rows of SQLite and back. Tuples of numbers are packed doubles, exact both ways."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from d3a.frozen import maker
from d3a.store.base import (
    Encounter,
    ObjectRecord,
    Positions,
    RecordingRecord,
    Region,
    Sighting,
    StayRecord,
    TaughtName,
    View,
)
from d3a.store.records import Record, embedding_bytes, embedding_from_bytes
from d3a.store.spans import UNKNOWN

Row = tuple[Any, ...]
_BOX = struct.Struct("<4d")
_POSE = struct.Struct("<7d")
_EXTENT = struct.Struct("<2d")
_COVARIANCE = struct.Struct("<9d")
_decoded = json.JSONDecoder().raw_decode
"""A quarter of what `json.loads` takes: it does not look for blanks, of which none were written."""
_object, _stay = maker(ObjectRecord), maker(StayRecord)
_sighting, _encounter = maker(Sighting), maker(Encounter)

OBJECT_COLUMNS = (
    "object_id, category, weight, first_ms, last_ms, site, categories, names, embedding, "
    "embedding_model, extent, tentative, volatile"
)
LIGHT_OBJECT_COLUMNS = OBJECT_COLUMNS.replace(" embedding,", " NULL AS embedding,")
STAY_COLUMNS = (
    "object_id, place, x, y, z, first_ms, last_ms, weight, site, covariance, seen, moved_place, "
    "moved_score, last_absent_ms, tentative, volatile"
)
SIGHTING_COLUMNS = (
    "object_id, place, start_ms, end_ms, frame, probability, box, image, seen, category, "
    "recording, keyframe_ms, viewer"
)
ENCOUNTER_COLUMNS = (
    "object_a, object_b, place_a, place_b, start_ms, end_ms, frame, box_a, box_b, probability, "
    "image, seen, recording, viewer, apart"
)
VIEW_COLUMNS = "start_ms, end_ms, frames, site, recording, x, y, yaw, half_angle, range_m"
REGION_COLUMNS = "name, polygon, site"
RECORDING_COLUMNS = (
    "key, name, site, zone, frames, detections, first_ms, last_ms, last_frame, done, skipped"
)


def _json(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _doubles(values: Sequence[float] | None) -> bytes | None:
    return None if values is None else struct.pack(f"<{len(values)}d", *values)


def _real(value: float | None) -> float | None:
    return None if value is None else float(value)


def _whole(value: int | None) -> int | None:
    return None if value is None else int(value)


def object_row(record: ObjectRecord) -> Row:
    """Return the values of OBJECT_COLUMNS."""
    votes = [(category, float(weight)) for category, weight in record.categories]
    embedding = record.embedding
    return (
        record.object_id,
        record.category,
        float(record.weight),
        int(record.first_ms),
        int(record.last_ms),
        record.site,
        _json(votes),
        _json([(name.word, name.owner) for name in record.names]),
        None if embedding is None else embedding_bytes(embedding),
        record.embedding_model,
        _doubles(record.extent_m),
        bool(record.tentative),
        bool(record.volatile),
    )


def object_record(row: Row) -> ObjectRecord:
    """Return the record of a row of OBJECT_COLUMNS; positional: lists of thousands are read."""
    return _object(
        row[0],
        row[1],
        row[2],
        row[3],
        row[4],
        row[5],
        () if row[6] == "[]" else tuple(map(tuple, _decoded(row[6])[0])),
        () if row[7] == "[]" else tuple(TaughtName(*n) for n in _decoded(row[7])[0]),
        None if row[8] is None else embedding_from_bytes(row[8]),
        row[9],
        None if row[10] is None else _EXTENT.unpack(row[10]),
        row[11] == 1,
        row[12] == 1,
    )


def stay_row(record: StayRecord) -> Row:
    """Return the values of STAY_COLUMNS."""
    x, y, z = record.position or (None, None, None)
    place, score = record.moved_from or (None, None)
    return (
        record.object_id,
        int(record.place),
        _real(x),
        _real(y),
        _real(z),
        int(record.first_ms),
        int(record.last_ms),
        float(record.weight),
        record.site,
        _doubles(record.covariance),
        int(record.seen),
        _whole(place),
        _real(score),
        _whole(record.last_absent_ms),
        bool(record.tentative),
        bool(record.volatile),
    )


def stay_record(row: Row) -> StayRecord:
    """Return the record of a row of STAY_COLUMNS; positional: lists of thousands are read."""
    return _stay(
        row[0],
        row[1],
        None if row[2] is None else (row[2], row[3], row[4]),
        row[5],
        row[6],
        row[7],
        row[8],
        None if row[9] is None else _COVARIANCE.unpack(row[9]),
        row[10],
        None if row[11] is None else (row[11], row[12]),
        row[13],
        row[14] == 1,
        row[15] == 1,
    )


def positions(object_ids: Sequence[str], rows: Sequence[Row]) -> Positions:
    """Return rows of (object_id, place, x, y, z, site, covariance) as columns."""
    *columns, packed = zip(*rows, strict=True) if rows else ((),) * 7
    unknown = _COVARIANCE.pack(*UNKNOWN)
    covariance = np.frombuffer(b"".join([each or unknown for each in packed]), dtype="<f8")
    return Positions.of_columns(object_ids, columns, covariance.reshape(-1, 9))


def sighting_row(record: Sighting) -> Row:
    """Return the values of SIGHTING_COLUMNS."""
    return (
        record.object_id,
        int(record.place),
        int(record.start_ms),
        int(record.end_ms),
        record.frame,
        float(record.probability),
        _BOX.pack(*record.box),
        record.image,
        int(record.seen),
        record.category,
        record.recording,
        _whole(record.keyframe_ms),
        _doubles(record.viewer),
    )


def sighting_record(row: Row) -> Sighting:
    """Return the record of a row of SIGHTING_COLUMNS; positional: lists of thousands are read."""
    return _sighting(
        row[0],
        row[1],
        row[2],
        row[3],
        row[4],
        row[5],
        _BOX.unpack(row[6]),
        row[7],
        row[8],
        row[9],
        row[10],
        row[11],
        None if row[12] is None else _POSE.unpack(row[12]),
    )


def encounter_row(record: Encounter) -> Row:
    """Return the values of ENCOUNTER_COLUMNS."""
    return (
        record.object_a,
        record.object_b,
        int(record.place_a),
        int(record.place_b),
        int(record.start_ms),
        int(record.end_ms),
        record.frame,
        _BOX.pack(*record.box_a),
        _BOX.pack(*record.box_b),
        float(record.probability),
        record.image,
        int(record.seen),
        record.recording,
        _doubles(record.viewer),
        None if record.apart is None else _BOX.pack(*record.apart),
    )


def encounter_record(row: Row) -> Encounter:
    """Return the record of a row of ENCOUNTER_COLUMNS."""
    return _encounter(
        row[0],
        row[1],
        row[2],
        row[3],
        row[4],
        row[5],
        row[6],
        _BOX.unpack(row[7]),
        _BOX.unpack(row[8]),
        row[9],
        row[10],
        row[11],
        row[12],
        None if row[13] is None else _POSE.unpack(row[13]),
        None if row[14] is None else _BOX.unpack(row[14]),
    )


def view_row(record: View) -> Row:
    """Return the values of VIEW_COLUMNS."""
    numbers = (record.x, record.y, record.yaw, record.half_angle, record.range_m)
    span = (int(record.start_ms), int(record.end_ms), int(record.frames))
    return (*span, record.site, record.recording, *map(_real, numbers))


def view_record(row: Row) -> View:
    """Return the record of a row of VIEW_COLUMNS."""
    return View(*row)


def region_row(record: Region) -> Row:
    """Return the values of REGION_COLUMNS."""
    corners = [(float(x), float(y)) for x, y in record.polygon]
    return (record.name, _json(corners), record.site)


def region_record(row: Row) -> Region:
    """Return the record of a row of REGION_COLUMNS."""
    return Region(row[0], tuple((x, y) for x, y in json.loads(row[1])), row[2])


def recording_row(record: RecordingRecord) -> Row:
    """Return the values of RECORDING_COLUMNS."""
    return (
        record.key,
        record.name,
        record.site,
        record.zone,
        int(record.frames),
        int(record.detections),
        _whole(record.first_ms),
        _whole(record.last_ms),
        record.last_frame,
        bool(record.done),
        _json([(reason, int(count)) for reason, count in record.skipped]),
    )


def recording_record(row: Row) -> RecordingRecord:
    """Return the record of a row of RECORDING_COLUMNS."""
    skipped = tuple((reason, count) for reason, count in json.loads(row[10]))
    return RecordingRecord(
        key=row[0],
        name=row[1],
        site=row[2],
        zone=row[3],
        frames=row[4],
        detections=row[5],
        first_ms=row[6],
        last_ms=row[7],
        last_frame=row[8],
        done=bool(row[9]),
        skipped=skipped,
    )


READERS: dict[str, tuple[str, Callable[[Row], Record]]] = {
    "recording": (
        f"SELECT {RECORDING_COLUMNS} FROM recording ORDER BY key",
        recording_record,
    ),
    "region": (f"SELECT {REGION_COLUMNS} FROM region ORDER BY name", region_record),
    "object": (f"SELECT {OBJECT_COLUMNS} FROM oic ORDER BY object_id", object_record),
    "stay": (f"SELECT {STAY_COLUMNS} FROM stc ORDER BY object_id, place", stay_record),
    "sighting": (
        f"SELECT {SIGHTING_COLUMNS} FROM sighting ORDER BY start_ms, object_id, place",
        sighting_record,
    ),
    "encounter": (
        f"SELECT {ENCOUNTER_COLUMNS} FROM encounter "
        "ORDER BY start_ms, object_a, object_b, place_a, place_b",
        encounter_record,
    ),
    "view": (
        f"SELECT {VIEW_COLUMNS} FROM seen_area ORDER BY start_ms, end_ms, site, recording",
        view_record,
    ),
}
"""Kind of record -> how all of them are read, in the order that `Store` states."""
