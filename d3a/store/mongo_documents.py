"""Records as documents of MongoDB and back.

A stay is one document, `object_id:place:0`, with the intervals of its sightings in an array; when
512 are in it the next ones go to `object_id:place:1` and so on. What is said of the stay as a
whole is in `stay` of the first document alone; `first` and `last` of every document cover all
that is in it and are there to narrow a search. Names are values, never keys or operators.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from bson.binary import VECTOR_SUBTYPE, Binary, BinaryVectorDtype
from bson.datetime_ms import DatetimeMS

from d3a.store.base import (
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayKey,
    StayRecord,
    TaughtName,
    View,
)
from d3a.store.records import embedding_bytes, embedding_from_bytes

Document = dict[str, Any]
MAX_INTERVALS = 512
_VECTOR_HEADER = bytes([BinaryVectorDtype.FLOAT32.value[0], 0])  # element type, padding


def date(time_ms: int | None) -> DatetimeMS | None:
    """Return UTC milliseconds as a BSON date, exactly."""
    return None if time_ms is None else DatetimeMS(int(time_ms))


def _ms(value: DatetimeMS | None) -> int | None:
    return None if value is None else int(value)


def _floats(values: Sequence[float] | None) -> list[float] | None:
    return None if values is None else [float(value) for value in values]


def _tuple(values: list[float] | None) -> tuple[Any, ...] | None:
    return None if values is None else tuple(values)


def stay_id(stay: StayKey, seq: int) -> str:
    """Return `_id` of a stay's document; it is read from the right, ids may hold colons."""
    return f"{stay[0]}:{stay[1]}:{seq}"


def encounter_id(a: str, b: str, place_a: int, place_b: int, start_ms: int) -> str:
    """Return `_id` of an encounter: its key as JSON, so that no two keys are one text."""
    return json.dumps([a, b, int(place_a), int(place_b), int(start_ms)], ensure_ascii=False)


def view_key(site: str, recording: str, start_ms: int) -> str:
    """Return `_id` of a view: its key as JSON."""
    return json.dumps([site, recording, int(start_ms)], ensure_ascii=False)


def object_document(record: ObjectRecord) -> Document:
    """Return a document of `oic`; without an embedding there is no `emb`.

    votes: the categories that only some of the detections had, to be found by.
    """
    document = {
        "_id": record.object_id,
        "site": record.site,
        "category": record.category,
        "categories": [[category, float(weight)] for category, weight in record.categories],
        "votes": [category for category, _ in record.categories if category != record.category],
        "names": [name.word for name in record.names],
        "owners": [name.owner for name in record.names],
        "weight": float(record.weight),
        "first": date(record.first_ms),
        "last": date(record.last_ms),
        "emb_model": record.embedding_model,
        "extent": _floats(record.extent_m),
        "tentative": bool(record.tentative),
        "volatile": bool(record.volatile),
    }
    if record.embedding is not None:
        blob = _VECTOR_HEADER + embedding_bytes(record.embedding)
        document["emb"] = Binary(blob, VECTOR_SUBTYPE)
    return document


def object_record(document: Document) -> ObjectRecord:
    """Return the record of a document of `oic`."""
    words = zip(document["names"], document["owners"], strict=True)
    return ObjectRecord(
        object_id=document["_id"],
        category=document["category"],
        weight=document["weight"],
        first_ms=int(document["first"]),
        last_ms=int(document["last"]),
        site=document["site"],
        categories=tuple((category, weight) for category, weight in document["categories"]),
        names=tuple(TaughtName(word, owner) for word, owner in words),
        embedding=embedding(document["emb"]) if "emb" in document else None,
        embedding_model=document["emb_model"],
        extent_m=_tuple(document["extent"]),
        tentative=document["tentative"],
        volatile=document["volatile"],
    )


def embedding(vector: Binary) -> Any:
    """Return the (d,) float32 array of a BSON vector."""
    return embedding_from_bytes(bytes(vector)[len(_VECTOR_HEADER) :])


def stay_part(record: StayRecord) -> Document:
    """Return `stay`, `site` and `z` of a stay's first document."""
    return {
        "site": record.site,
        "z": None if record.position is None else float(record.position[2]),
        "stay": {
            "first": date(record.first_ms),
            "last": date(record.last_ms),
            "weight": float(record.weight),
            "covariance": _floats(record.covariance),
            "seen": int(record.seen),
            "moved_from": None
            if record.moved_from is None
            else [int(record.moved_from[0]), float(record.moved_from[1])],
            "last_absent": date(record.last_absent_ms),
            "tentative": bool(record.tentative),
            "volatile": bool(record.volatile),
        },
    }


def location(record: StayRecord) -> list[float] | None:
    """Return [x, y] in metres for the 2d index, None without a position."""
    return None if record.position is None else _floats(record.position[:2])


def stay_record(document: Document) -> StayRecord:
    """Return the record of a stay's first document."""
    part, loc = document["stay"], document.get("loc")
    return StayRecord(
        object_id=document["object_id"],
        place=document["place"],
        position=None if loc is None else (loc[0], loc[1], document["z"]),
        first_ms=int(part["first"]),
        last_ms=int(part["last"]),
        weight=part["weight"],
        site=document["site"],
        covariance=_tuple(part["covariance"]),
        seen=part["seen"],
        moved_from=_tuple(part["moved_from"]),
        last_absent_ms=_ms(part["last_absent"]),
        tentative=part["tentative"],
        volatile=part["volatile"],
    )


def interval(record: Sighting) -> Document:
    """Return a sighting as an element of `intervals`."""
    return {
        "start": date(record.start_ms),
        "end": date(record.end_ms),
        "frame": record.frame,
        "prob": float(record.probability),
        "bbox": _floats(record.box),
        "image": record.image,
        "seen": int(record.seen),
        "category": record.category,
        "recording": record.recording,
        "keyframe": date(record.keyframe_ms),
        "viewer": _floats(record.viewer),
    }


def sightings(document: Document) -> list[Sighting]:
    """Return the records of the intervals in a document of `stc`."""
    object_id, place = document["object_id"], document["place"]
    return [
        Sighting(
            object_id=object_id,
            place=place,
            start_ms=int(part["start"]),
            end_ms=int(part["end"]),
            frame=part["frame"],
            probability=part["prob"],
            box=(part["bbox"][0], part["bbox"][1], part["bbox"][2], part["bbox"][3]),
            image=part["image"],
            seen=part["seen"],
            category=part["category"],
            recording=part["recording"],
            keyframe_ms=_ms(part["keyframe"]),
            viewer=_tuple(part["viewer"]),
        )
        for part in document["intervals"]
    ]


def encounter_document(record: Encounter) -> Document:
    """Return a document of `encounters`."""
    key = (record.object_a, record.object_b, record.place_a, record.place_b, record.start_ms)
    return {
        "_id": encounter_id(*key),
        "a": record.object_a,
        "b": record.object_b,
        "place_a": int(record.place_a),
        "place_b": int(record.place_b),
        "start": date(record.start_ms),
        "end": date(record.end_ms),
        "frame": record.frame,
        "bbox_a": _floats(record.box_a),
        "bbox_b": _floats(record.box_b),
        "prob": float(record.probability),
        "image": record.image,
        "seen": int(record.seen),
        "recording": record.recording,
        "viewer": _floats(record.viewer),
        "apart": _floats(record.apart),
    }


def encounter_record(document: Document) -> Encounter:
    """Return the record of a document of `encounters`."""
    box_a, box_b = document["bbox_a"], document["bbox_b"]
    return Encounter(
        object_a=document["a"],
        object_b=document["b"],
        place_a=document["place_a"],
        place_b=document["place_b"],
        start_ms=int(document["start"]),
        end_ms=int(document["end"]),
        frame=document["frame"],
        box_a=(box_a[0], box_a[1], box_a[2], box_a[3]),
        box_b=(box_b[0], box_b[1], box_b[2], box_b[3]),
        probability=document["prob"],
        image=document["image"],
        seen=document["seen"],
        recording=document["recording"],
        viewer=_tuple(document["viewer"]),
        apart=_tuple(document.get("apart")),  # stores of the first versions have none
    )


_VIEW_NUMBERS = ("x", "y", "yaw", "half_angle", "range_m")


def view_document(record: View) -> Document:
    """Return a document of `views`."""
    numbers = {name: getattr(record, name) for name in _VIEW_NUMBERS}
    return {
        "_id": view_key(record.site, record.recording, record.start_ms),
        "start": date(record.start_ms),
        "end": date(record.end_ms),
        "frames": int(record.frames),
        "site": record.site,
        "recording": record.recording,
        **{name: None if n is None else float(n) for name, n in numbers.items()},
    }


def view_record(document: Document) -> View:
    """Return the record of a document of `views`."""
    return View(
        int(document["start"]),
        int(document["end"]),
        document["frames"],
        document["site"],
        document["recording"],
        *(document[name] for name in _VIEW_NUMBERS),
    )


def region_document(record: Region) -> Document:
    """Return a document of `regions`."""
    corners = [_floats(corner) for corner in record.polygon]
    return {"_id": record.name, "polygon": corners, "site": record.site}


def region_record(document: Document) -> Region:
    """Return the record of a document of `regions`."""
    corners = tuple((x, y) for x, y in document["polygon"])
    return Region(document["_id"], corners, document["site"])


def recording_document(record: RecordingRecord) -> Document:
    """Return a document of `recordings`."""
    return {
        "_id": record.key,
        "name": record.name,
        "site": record.site,
        "zone": record.zone,
        "frames": int(record.frames),
        "detections": int(record.detections),
        "first": date(record.first_ms),
        "last": date(record.last_ms),
        "last_frame": record.last_frame,
        "done": bool(record.done),
        "skipped": [[reason, int(count)] for reason, count in record.skipped],
    }


def recording_record(document: Document) -> RecordingRecord:
    """Return the record of a document of `recordings`."""
    return RecordingRecord(
        key=document["_id"],
        name=document["name"],
        site=document["site"],
        zone=document["zone"],
        frames=document["frames"],
        detections=document["detections"],
        first_ms=_ms(document["first"]),
        last_ms=_ms(document["last"]),
        last_frame=document["last_frame"],
        done=document["done"],
        skipped=tuple((reason, count) for reason, count in document["skipped"]),
    )


def keyframe_document(record: Keyframe) -> Document:
    """Return a document of `keyframes`."""
    return {
        "_id": record.key,
        "jpeg": Binary(record.jpeg),
        "size": len(record.jpeg),
        "width": int(record.width),
        "height": int(record.height),
        "time": date(record.time_ms),
    }


def keyframe_record(document: Document) -> Keyframe:
    """Return the record of a document of `keyframes`."""
    return Keyframe(
        document["_id"],
        bytes(document["jpeg"]),
        document["width"],
        document["height"],
        int(document["time"]),
    )
