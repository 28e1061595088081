"""The default profile's memory as JSON and arrays, and back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields

import numpy as np

from d3a.checkpoint import Arrays, stacked
from d3a.model import Json
from d3a.parameters import Parameters
from d3a.sightings import Interval
from d3a.store.base import TaughtName
from d3a.symmetric import flat
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory, Whole
from d3a.tracking.positions import Row

_PLACE = tuple(f.name for f in fields(Place) if f.name not in ("open", "row"))
_OWN = ("names", "places", "row", "votes", "met")
_KNOWN = tuple(f.name for f in fields(Known) if f.init and f.name not in _OWN)


def memory_state(wholes: Iterable[Whole]) -> tuple[Json, Arrays]:
    """Return things as JSON, and their arrays in the same order."""
    known = list(wholes)
    rows = [row for each in known for _, row in each.rows]
    arrays: Arrays = {
        "looks": stacked([each.look for each in known]),
        "means": np.array([(row.mean, row.raw) for row in rows]).reshape(-1, 2, 3),
        "errors": np.array([flat(row.error) for row in rows]).reshape(-1, 3, 3),
        "scales": np.array([row.scale for row in rows]).reshape(-1, 2),
    }
    return {"things": [_thing_json(each) for each in known]}, arrays


def _thing_json(whole: Whole) -> Json:
    thing = whole.thing
    record: Json = {name: getattr(thing, name) for name in _KNOWN}
    record["votes"] = list(thing.votes.items())  # their order is that of summation
    record["met"] = sorted(thing.met)
    record["names"] = [[name.word, name.owner] for name in thing.names]
    placed = {place.number for place, _ in whole.rows}
    record["places"] = [_place_json(place, place.number in placed) for place in thing.places]
    return record


def _place_json(place: Place, is_placed: bool) -> Json:
    record: Json = {name: getattr(place, name) for name in _PLACE}
    record["open"] = None if place.open is None else place.open.to_json()
    record["placed"] = is_placed
    return record


def memory_of_state(memory: Memory, record: Json, arrays: Arrays, parameters: Parameters) -> None:
    """Fill an empty memory with what `memory_state` gave."""
    means, errors, scales = (arrays[name].tolist() for name in ("means", "errors", "scales"))
    rows = zip(means, errors, scales, strict=True)
    for i, each in enumerate(record["things"]):
        thing = _thing(each)
        weight = thing.look_weight
        memory.add(thing)
        if weight > 0:
            memory.looks.put(thing, arrays["looks"][i], weight)
        for place_record in each["places"]:
            place = _place(place_record)
            thing.places.append(place)
            if place_record["placed"]:
                row = _place_row(*next(rows), parameters)
                memory.positions.add([(thing, place, row)])


def _place_row(
    means: list[list[float]], error: list[list[float]], scale: list[float], parameters: Parameters
) -> Row:
    (x, y, z), (raw_x, raw_y, raw_z) = means
    (xx, xy, xz), (_, yy, yz), (*_, zz) = error
    six, (off, seen) = (xx, xy, xz, yy, yz, zz), scale
    return Row.of((x, y, z), (raw_x, raw_y, raw_z), six, (off, seen), parameters)


def _thing(record: Json) -> Known:
    plain = {name: record[name] for name in _KNOWN if name in record}  # older ones have fewer
    extent = plain["extent_m"]
    plain["extent_m"] = None if extent is None else tuple(extent)
    names = tuple(TaughtName(word, owner) for word, owner in record["names"])
    return Known(**plain, votes=dict(record["votes"]), names=names, met=set(record["met"]))


def _place(record: Json) -> Place:
    plain = {name: record[name] for name in _PLACE if name in record}
    moved = plain["moved_from"]
    plain["moved_from"] = None if moved is None else tuple(moved)
    plain["seen_from"] = [(x, y, z) for x, y, z in record["seen_from"]]
    plain["missed_from"] = [((x, y, z), time_ms) for (x, y, z), time_ms in record["missed_from"]]
    looks = record.get("looks", [])  # older checkpoints have none
    plain["looks"] = [((x, y, z), share, found) for (x, y, z), share, found in looks]
    plain.setdefault("looked", len(looks))
    opened = record["open"]
    return Place(**plain, open=None if opened is None else Interval.from_json(opened))
