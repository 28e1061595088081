"""The memory as a checkpoint holds it."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from d3a.checkpoint import Arrays, pack, unpack
from d3a.model import Json
from d3a.parameters import DEFAULT
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.memory_state import memory_of_state, memory_state
from d3a.tracking.positions import Row
from d3a.tracking.sides import remember_look, remember_side
from tests.worlds.rounds import START_MS, colour

LONG = ("place_looks", "place_seen_from", "place_missed_from", "place_counts", "met", "met_counts")


def remembering() -> Memory:
    """Things that were looked at between never and more often than is remembered."""
    memory, rng = Memory(), np.random.default_rng(7)
    error = (0.01, 0.001, 0.0, 0.02, 0.0, 0.03)
    for number in range(6):
        thing = Known(number, {"cup": 1.0, "mug": 0.5}, START_MS, START_MS + number)
        thing.met = set(range(0, number, 2))
        memory.add(thing)
        memory.looks.put(thing, colour(number), 2.0)
        for k in range(number % 3):
            place = Place(k, START_MS, START_MS + 5, last_absent_ms=START_MS if k else None)
            thing.places.append(place)
            for n in range(9 * number):
                x, y, z = rng.uniform(-5.0, 5.0, 3).tolist()
                remember_look(place, (x, y, z), 0.3, found=n % 3 == 0)
                if n % 4 == 0:
                    remember_side(place, (y, x, z))
                if n % 9 == k:
                    place.missed_from.append(((z, x, y), START_MS + n))
            if k == 0:
                mean = (float(number), 1.0, 2.0)
                memory.positions.add(
                    [(thing, place, Row.of(mean, mean, error, (0.5, 2.0), DEFAULT))]
                )
    return memory


def in_json(record: Json, arrays: Arrays) -> tuple[Json, Arrays]:
    """The same as checkpoints held it before: all of a place is with it."""
    long = {name: iter(arrays[name].tolist()) for name in LONG}
    for thing in record["things"]:
        thing["met"] = [next(long["met"]) for _ in range(next(long["met_counts"]))]
        for place in thing["places"]:
            looks, sides, missed = next(long["place_counts"])
            rows = [next(long["place_looks"]) for _ in range(looks)]
            place["looks"] = [[[x, y, z], share, found > 0] for x, y, z, share, found in rows]
            place["seen_from"] = [next(long["place_seen_from"]) for _ in range(sides)]
            rows = [next(long["place_missed_from"]) for _ in range(missed)]
            place["missed_from"] = [[[x, y, z], round(time_ms)] for x, y, z, time_ms in rows]
    return record, {name: array for name, array in arrays.items() if name not in LONG}


@pytest.mark.parametrize("is_older", [False, True])
def test_a_memory_comes_back_from_a_checkpoint_as_it_was(is_older: bool) -> None:
    memory = remembering()
    state = pack(*memory_state(memory.wholes()))
    record, arrays = unpack(state)
    if is_older:
        record, arrays = in_json(record, arrays)
    again = Memory()
    memory_of_state(again, record, arrays, DEFAULT)
    for old, new in zip(memory.wholes(), again.wholes(), strict=True):
        assert new.thing.met == old.thing.met
        assert [row for _, row in new.rows] == [row for _, row in old.rows]
        for was, place in zip(old.thing.places, new.thing.places, strict=True):
            for each in fields(Place):
                assert getattr(place, each.name) == getattr(was, each.name)
            times = [time_ms for _, time_ms in place.missed_from]
            assert all(isinstance(time_ms, int) for time_ms in times)
            assert all(look[-1] in (True, False) for look in place.looks)
    assert pack(*memory_state(again.wholes())) == state


def test_an_empty_memory_is_kept_too() -> None:
    again = Memory()
    memory_of_state(again, *unpack(pack(*memory_state(Memory().wholes()))), DEFAULT)
    assert not again.things
