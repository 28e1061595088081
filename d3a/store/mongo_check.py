"""What can be wrong with a store on a server: dangling records, documents out of step."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pymongo.database import Database

from d3a.model import Json
from d3a.store.mongo_documents import MAX_INTERVALS, Document

_SHOWN = 5
_COUNTED = {
    "objects": "oic",
    "encounters": "encounters",
    "views": "views",
    "keyframes": "keyframes",
    "regions": "regions",
    "recordings": "recordings",
}
_SIZED = ("oic", "stc", "encounters", "views", "regions", "recordings", "meta", "state")


def images(database: Database[Document]) -> set[str]:
    """Return the pictures that sightings and encounters refer to."""
    found = {
        part["image"]
        for document in database["stc"].find({}, {"intervals.image": 1})
        for part in document["intervals"]
    }
    found |= {document["image"] for document in database["encounters"].find({}, {"image": 1})}
    return {image for image in found if image is not None}


def counts(database: Database[Document]) -> Json:
    """Return how many records of each kind there are, and the bytes of all documents."""
    counted = {kind: database[name].count_documents({}) for kind, name in _COUNTED.items()}
    size = _sum(database, "keyframes", "$size")
    size += sum(_sum(database, name, {"$bsonSize": "$$ROOT"}) for name in _SIZED)
    return {
        **counted,
        "stays": database["stc"].count_documents({"seq": 0}),
        "sightings": _sum(database, "stc", "$n"),
        "bytes": size,
    }


def _sum(database: Database[Document], name: str, expression: Any) -> int:
    groups = database[name].aggregate([{"$group": {"_id": None, "sum": {"$sum": expression}}}])
    return sum(int(group["sum"]) for group in groups)


def check(database: Database[Document]) -> list[str]:
    """Return a sentence for each kind of damage, with the first few records that show it."""
    objects = {document["_id"] for document in database["oic"].find({}, {"_id": 1})}
    shown = {"intervals.frame": 0, "intervals.bbox": 0, "intervals.viewer": 0}
    layout = list(database["stc"].find({}, shown))
    firsts = {(d["object_id"], d["place"]): d for d in layout if d["seq"] == 0}
    pictures = {document["_id"] for document in database["keyframes"].find({}, {"_id": 1})}
    found = {
        "stay {} of an object that is not stored": (
            f"{object_id} at {place}" for object_id, place in firsts if object_id not in objects
        ),
        "document {} of a stay that is not stored": (
            d["_id"] for d in layout if (d["object_id"], d["place"]) not in firsts
        ),
        "document {} disagrees with its stay or its intervals": (
            d["_id"] for d in layout if _disagrees(d, firsts.get((d["object_id"], d["place"]), d))
        ),
        "sighting {} is stored twice": _twice(layout),
        "encounter {} of a stay that is not stored": (
            d["_id"]
            for d in database["encounters"].find({})
            if (d["a"], d["place_a"]) not in firsts or (d["b"], d["place_b"]) not in firsts
        ),
        "picture {} is referred to and not stored": sorted(images(database) - pictures),
        "batch {} was not finished; open the store for writing": (
            d["digest"] for d in database["journal"].find({"part": 0})
        ),
    }
    sentences = []
    for sentence, records in found.items():
        names = [str(name) for name in records]
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        if names:
            sentences.append(sentence.format(", ".join(names[:_SHOWN]) + more))
    return sentences


def _disagrees(document: Document, first: Document) -> bool:
    parts = document["intervals"]
    if document["n"] != len(parts) or len(parts) > MAX_INTERVALS:
        return True
    if document.get("loc") != first.get("loc") or document["z"] != first["z"]:
        return True
    return any(
        part["start"] < document["first"] or part["end"] > document["last"] for part in parts
    )


def _twice(layout: list[Document]) -> Iterator[str]:
    seen = set()
    for document in layout:
        for part in document["intervals"]:
            key = (document["object_id"], document["place"], int(part["start"]))
            if key in seen:
                yield f"{key[0]} at {key[1]} from {key[2]}"
            seen.add(key)
