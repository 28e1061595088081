"""Mending a store on a server: what dangles goes, documents are brought in step.

The counterpart of `mongo_check`; every step may be repeated.
"""

from __future__ import annotations

from typing import Any

from pymongo.database import Database

from d3a.store.mongo_documents import Document


def repair(database: Database[Document]) -> list[str]:
    """Mend the database; return a sentence for each change."""
    said = [
        _removed(database, "stc", _lone_stays(database), "documents of stays"),
        _in_step(database),
        _removed(database, "encounters", _lone_encounters(database), "encounters of stays"),
        _without_pictures(database),
    ]
    return [sentence for sentence in said if sentence]


def _removed(database: Database[Document], name: str, ids: list[Any], what: str) -> str:
    for key in ids:
        database[name].delete_one({"_id": key})
    return f"removed {len(ids)} {what} that are not stored" if ids else ""


def _firsts(database: Database[Document]) -> dict[tuple[str, int], Document]:
    shown = {"object_id": 1, "place": 1, "loc": 1, "z": 1}
    found = database["stc"].find({"seq": 0}, shown)
    return {(document["object_id"], document["place"]): document for document in found}


def _lone_stays(database: Database[Document]) -> list[Any]:
    objects = {document["_id"] for document in database["oic"].find({}, {"_id": 1})}
    firsts = {key for key in _firsts(database) if key[0] in objects}
    every = database["stc"].find({}, {"object_id": 1, "place": 1})
    return [d["_id"] for d in every if (d["object_id"], d["place"]) not in firsts]


def _lone_encounters(database: Database[Document]) -> list[Any]:
    firsts = _firsts(database)
    shown = {"a": 1, "b": 1, "place_a": 1, "place_b": 1}
    return [
        document["_id"]
        for document in database["encounters"].find({}, shown)
        if (document["a"], document["place_a"]) not in firsts
        or (document["b"], document["place_b"]) not in firsts
    ]


def _in_step(database: Database[Document]) -> str:
    """Make each document's count, span and location those of its intervals and its stay."""
    firsts, seen, mended = _firsts(database), set[tuple[str, int, int]](), 0
    for document in database["stc"].find({}).sort("_id", 1):
        key = (document["object_id"], document["place"])
        kept = []
        for part in document["intervals"]:
            if (*key, int(part["start"])) not in seen:
                seen.add((*key, int(part["start"])))
                kept.append(part)
        first = firsts.get(key, document)
        ends = [part["end"] for part in kept] + [document["last"]]
        wanted = {
            "intervals": kept,
            "n": len(kept),
            "first": min([part["start"] for part in kept] + [document["first"]]),
            "last": max(ends),
            "z": first["z"],
        }
        differs = any(document[name] != value for name, value in wanted.items())
        if differs or document.get("loc") != first.get("loc"):
            change: Document = {"$set": wanted}
            if first.get("loc") is None:
                change["$unset"] = {"loc": ""}
            else:
                wanted["loc"] = first["loc"]
            database["stc"].update_one({"_id": document["_id"]}, change)
            mended += 1
    return f"brought {mended} documents in step with their stay and intervals" if mended else ""


def _without_pictures(database: Database[Document]) -> str:
    """Let no record name a picture that is not stored."""
    pictures = {document["_id"] for document in database["keyframes"].find({}, {"_id": 1})}
    known, mended = pictures | {None}, 0
    for document in database["stc"].find({}, {"intervals": 1}):
        lost = [p for p in document["intervals"] if p["image"] not in known]
        for part in lost:
            part["image"] = None
        if lost:
            change = {"$set": {"intervals": document["intervals"]}}
            database["stc"].update_one({"_id": document["_id"]}, change)
            mended += len(lost)
    for document in database["encounters"].find({"image": {"$ne": None}}, {"image": 1}):
        if document["image"] not in pictures:
            database["encounters"].update_one({"_id": document["_id"]}, {"$set": {"image": None}})
            mended += 1
    return f"{mended} records no longer name a picture that is not stored" if mended else ""
