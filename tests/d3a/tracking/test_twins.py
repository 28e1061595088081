"""Which of several has come: its twin may have left too, and what stands there may be it."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.parameters import DEFAULT
from d3a.tracking.absence import Absence
from d3a.tracking.alike import BINS
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.moves import Link, Moves
from d3a.tracking.positions import Row

HOUR_MS = 3_600_000
GONE_MS, CAME_MS = 5 * HOUR_MS, 6 * HOUR_MS
"""When all were last seen where they were, and when one turned up elsewhere."""


def drill(memory: Memory, number: int, look: list[float], place: Place) -> Known:
    thing = Known(number, {"drill": 1.0}, place.first_ms, place.last_ms, seen=9)
    thing.places.append(place)
    memory.add(thing)
    memory.looks.put(thing, np.array(look, dtype=np.float32), 9.0)
    return thing


def found(twin_last_ms: int, missed: float, twin_look: list[float] | None = None) -> list[Link]:
    """Return the links where one of two was missed, and the other last seen at some time."""
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    moves = Moves(memory, LookSpace(DEFAULT), LookModel(DEFAULT), absence, DEFAULT)
    moves.others = {"drill": [20.0] * 12 + [0.0] * (BINS - 12)}
    alike = [1.0, 0.0, 0.0]
    left = Place(0, 0, GONE_MS, seen=9, hits=9, chances=9.0, misses=4, evidence=missed)
    drill(memory, 0, alike, left)
    drill(memory, 1, twin_look or alike, Place(0, 0, twin_last_ms, seen=9, hits=9, chances=9.0))
    drill(memory, 2, alike, Place(0, CAME_MS, CAME_MS + HOUR_MS, seen=9, hits=9, chances=9.0))
    return moves.find({0, 1, 2}, CAME_MS + HOUR_MS)


@pytest.mark.parametrize("missed", [5.0, 30.0])
def test_while_nobody_has_looked_for_its_twin_neither_is_linked(missed: float) -> None:
    """However often the one was missed: the other one may be gone as well."""
    assert found(GONE_MS, missed) == []


def test_once_the_twin_is_found_at_its_place_the_other_one_came() -> None:
    (link,) = found(CAME_MS + HOUR_MS, 5.0)
    assert (link.old.number, link.new.number) == (0, 2)
    assert link.score >= DEFAULT.move_probability


def test_what_does_not_look_alike_need_not_be_looked_for() -> None:
    (link,) = found(GONE_MS, 5.0, [0.0, 1.0, 0.0])
    assert (link.old.number, link.new.number) == (0, 2)


def standing(memory: Memory, number: int, category: str, place: Place, x: float) -> Known:
    thing = Known(number, {category: 1.0}, place.first_ms, place.last_ms, seen=place.seen)
    thing.places.append(place)
    memory.add(thing)
    memory.looks.put(thing, np.array([1.0, 0.0, 0.0], dtype=np.float32), 9.0)
    at, error = (x, 0.0, 0.0), (0.01, 0.0, 0.0, 0.01, 0.0, 0.01)
    memory.positions.add([(thing, place, Row.of(at, at, error, (0.0, 0.0), DEFAULT))])
    return thing


@pytest.mark.parametrize(
    ("last_ms", "away_m", "met", "is_linked"),
    [
        (CAME_MS + HOUR_MS, 0.1, False, False),
        (CAME_MS + HOUR_MS, 0.1, True, True),  # one frame shows both
        (CAME_MS + HOUR_MS, 1.5, False, True),  # it stands elsewhere
        (GONE_MS, 0.1, False, True),  # nobody has seen it since: it may have left
    ],
)
def test_what_turns_up_where_a_known_thing_stands_is_that_thing(
    last_ms: int, away_m: float, met: bool, is_linked: bool
) -> None:
    """A lamp that is taken for a plant now and then, and the plant that was carried away."""
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    moves = Moves(memory, LookSpace(DEFAULT), LookModel(DEFAULT), absence, DEFAULT)
    moves.others = {"plant": [20.0] * 12 + [0.0] * (BINS - 12)}
    left = Place(0, 0, GONE_MS, seen=9, hits=9, chances=9.0, misses=4, evidence=5.0)
    standing(memory, 0, "plant", left, 5.0)
    lamp = standing(memory, 1, "lamp", Place(0, 0, last_ms, seen=40), away_m)
    came = Place(0, CAME_MS, CAME_MS + HOUR_MS, seen=3, hits=3, chances=3.0)
    plant = standing(memory, 2, "plant", came, 0.0)
    if met:
        plant.met.add(lamp.number)
        lamp.met.add(plant.number)
    links = moves.find({0, 1, 2}, CAME_MS + HOUR_MS)
    assert [(link.old.number, link.new.number) for link in links] == [(0, 2)] * is_linked
