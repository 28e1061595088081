"""The default profile's memory as JSON and arrays, and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields
from itertools import islice, repeat

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

_LISTS = ("looks", "seen_from", "missed_from")
"""What is long of a place: an array each, of all places, as JSON would take most of the time."""
_PLACE = tuple(f.name for f in fields(Place) if f.name not in ("open", "row"))
_SHORT = tuple(name for name in _PLACE if name not in _LISTS)
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
    arrays |= _long([each.thing for each in known])
    return {"things": [_thing_json(each) for each in known]}, arrays


def _long(things: list[Known]) -> Arrays:
    """Return what is long of things and their places, one array of all of them each."""
    places = [place for thing in things for place in thing.places]
    missed_from = [(*eye, time_ms) for each in places for eye, time_ms in each.missed_from]
    counts = [[len(getattr(each, name)) for name in _LISTS] for each in places]
    return {
        "place_looks": np.array([look for each in places for look in each.looks]).reshape(-1, 5),
        "place_seen_from": np.array([e for p in places for e in p.seen_from]).reshape(-1, 3),
        "place_missed_from": np.array(missed_from).reshape(-1, 4),
        "place_counts": np.array(counts, dtype=np.int64).reshape(-1, len(_LISTS)),
        "met": np.array([n for thing in things for n in sorted(thing.met)], dtype=np.int64),
        "met_counts": np.array([len(thing.met) for thing in things], dtype=np.int64),
    }


def _places_of(arrays: Arrays) -> Iterator[Json]:
    """Return of each place what `_long` took, as it was JSON in older checkpoints."""
    looks, sides, missed = (iter(arrays[f"place_{name}"].tolist()) for name in _LISTS)
    for looked, seen, misses in arrays["place_counts"].tolist():
        yield {
            "looks": [(eye, share, found) for *eye, share, found in islice(looks, looked)],
            "seen_from": list(islice(sides, seen)),
            "missed_from": [(eye, int(time_ms)) for *eye, time_ms in islice(missed, misses)],
        }


def _met_of(arrays: Arrays) -> Iterator[Json]:
    """Return the same of each thing."""
    met = iter(arrays["met"].tolist())
    for count in arrays["met_counts"].tolist():
        yield {"met": list(islice(met, count))}


def _thing_json(whole: Whole) -> Json:
    thing = whole.thing
    record: Json = {name: getattr(thing, name) for name in _KNOWN}
    record["votes"] = list(thing.votes.items())  # their order is that of summation
    record["names"] = [[name.word, name.owner] for name in thing.names]
    placed = {place.number for place, _ in whole.rows}
    record["places"] = [_place_json(place, place.number in placed) for place in thing.places]
    return record


def _place_json(place: Place, is_placed: bool) -> Json:
    record: Json = {name: getattr(place, name) for name in _SHORT}
    record["open"] = None if place.open is None else place.open.to_json()
    record["placed"] = is_placed
    return record


def memory_of_state(memory: Memory, record: Json, arrays: Arrays, parameters: Parameters) -> None:
    """Fill an empty memory with what `memory_state` gave."""
    means, errors, scales = (arrays[name].tolist() for name in ("means", "errors", "scales"))
    rows = zip(means, errors, scales, strict=True)
    in_json: Json = {}  # older checkpoints hold all there
    met = _met_of(arrays) if "met" in arrays else repeat(in_json)
    long = _places_of(arrays) if "place_counts" in arrays else repeat(in_json)
    for i, each in enumerate(record["things"]):
        thing = _thing(each | next(met))
        weight = thing.look_weight
        memory.add(thing)
        if weight > 0:
            memory.looks.put(thing, arrays["looks"][i], weight)
        for place_record in each["places"]:
            place = _place(place_record | next(long))
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
    looks = record.get("looks", [])  # the oldest checkpoints have none
    plain["looks"] = [(x, y, z, share, bool(found)) for (x, y, z), share, found in looks]
    plain.setdefault("looked", len(looks))
    opened = record["open"]
    return Place(**plain, open=None if opened is None else Interval.from_json(opened))
