"""Of two things that look alike, which one has come: what was not looked for may have left too."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.parameters import DEFAULT
from d3a.tracking.absence import Absence
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.moves import BINS, Link, Moves

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
