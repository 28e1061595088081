"""Looks are judged a handful at a time, and each says what it would have said by itself."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.model import Camera, Pose
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef, Scene
from d3a.tracking.absence import TOGETHER_MOST, TOGETHER_MS, Absence
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.positions import Row

ORIGIN = (0.0, 0.0, 0.0)
CAMERA = Camera(width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0)
OFFSET = FrameOffset.unknown(DEFAULT)
MINUTE_MS = 60_000
Seen = list[tuple[Known, Place]]


def scene(time_ms: int, x: float = 0.0) -> Scene:
    """A frame whose camera looks along z."""
    pose = Pose((x, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    return Scene(FrameRef(f"f{time_ms}", time_ms), (), pose, CAMERA)


def thing_at(memory: Memory, number: int, x: float, first_ms: int = 0) -> tuple[Known, Place]:
    """A thing two metres away, that was seen from the origin and from beside it."""
    place = Place(0, first_ms, first_ms, seen=9, hits=9, chances=9.0)
    place.seen_from = [ORIGIN, (0.6, 0.0, 0.0)]
    thing = Known(number, {"cup": 1.0}, first_ms, first_ms, seen=9)
    memory.add(thing)
    thing.places.append(place)
    row = Row.of((x, 0.0, 2.0), (x, 0.0, 2.0), (1e-4, 0, 0, 1e-4, 0, 1e-4), (0, 0), DEFAULT)
    memory.positions.add([(thing, place, row)])
    return thing, place


def look(absence: Absence, time_ms: int, seen: Seen, x: float = 0.0) -> None:
    absence.watch(scene(time_ms, x), seen, OFFSET)
    absence.end_look()


def told(place: Place) -> tuple[float, ...]:
    return (place.evidence, place.there, place.hits, place.chances, place.misses, place.looked)


@pytest.mark.parametrize("is_stopped", [False, True])
def test_looks_tell_together_what_each_tells_by_itself(is_stopped: bool) -> None:
    """Also where a checkpoint was between them."""
    by_way: list[list[tuple[float, ...]]] = []
    by_missed: list[list[int]] = []
    for is_together in (False, True):
        memory = Memory()
        absence, things = Absence(memory, DEFAULT), [thing_at(memory, n, 0.2 * n) for n in range(3)]
        missed: list[list[int]] = []
        for n, seen in enumerate(([0], [1, 2], [0, 1], [], [1])):
            look(absence, (n + 1) * 10 * MINUTE_MS, [things[k] for k in seen], 0.6 * (n % 2))
            if not is_together:
                missed += [[thing.number for thing in each.missed] for each in absence.judge()]
        if is_together:
            if is_stopped:
                state, absence = absence.to_state(), Absence(memory, DEFAULT)
                absence.restore(*state)
            judged = absence.judge()
            assert [[thing.number for thing in each.found] for each in judged][1] == [1, 2]
            assert [[thing.number for thing in each.missed] for each in judged] == by_missed
        by_missed = missed or by_missed
        by_way.append([told(place) for _, place in things])
        rows = np.array([place.row for _, place in things])
        looks = memory.positions.looks(rows)
        assert looks[:, 3].astype(bool).sum(axis=1).tolist() == [p.looked for _, p in things]
    apart, together = by_way
    # only what looks from one side found is asked once for all of them
    assert [each[2:] for each in together] == [each[2:] for each in apart]
    assert [each[0] for each in together] == pytest.approx([each[0] for each in apart], rel=0.5)


def test_what_turns_up_is_not_missed_by_the_looks_before() -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    look(absence, MINUTE_MS, [])
    new = thing_at(memory, 1, 0.0, first_ms=2 * MINUTE_MS)
    look(absence, 2 * MINUTE_MS, [new])
    look(absence, 12 * MINUTE_MS, [])
    assert [[thing.number for thing in each.missed] for each in absence.judge()] == [[], [], [1]]
    assert new[1].misses == 1


def test_looks_wait_for_others_but_not_for_long() -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    assert not absence.is_due(10**9)  # none has ended
    look(absence, 1000, [])
    assert not absence.is_due(1000 + TOGETHER_MS)
    assert absence.is_due(1001 + TOGETHER_MS)
    for n in range(1, TOGETHER_MOST):
        assert not absence.is_due(1000 + n)
        look(absence, 1000 + n, [])
    assert absence.is_due(1000 + TOGETHER_MOST)
    assert len(absence.judge()) == TOGETHER_MOST
    assert not absence.is_due(10**9)


def test_what_the_look_that_goes_on_has_found_follows_what_it_is_made_part_of() -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    (kept, place), (gone, lost) = (thing_at(memory, n, 0.0) for n in (1, 2))
    look(absence, 1000, [(kept, place)])
    absence.watch(scene(2000), [(gone, lost)], OFFSET)
    (first,) = absence.judge()
    assert [thing.number for thing in first.missed] == [2]
    absence.became(lost, place, kept)
    memory.remove(gone)
    absence.end_look()
    (second,) = absence.judge()
    assert ([thing.number for thing in second.found], second.missed) == ([1], [])


def test_what_left_the_memory_is_forgotten_in_all_looks() -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    one, other = thing_at(memory, 1, 0.0), thing_at(memory, 2, 0.2)
    look(absence, 1000, [one, other])
    absence.watch(scene(2000), [one], OFFSET)
    absence.forget([one[0]])
    absence.end_look()
    assert [[thing.number for thing in each.found] for each in absence.judge()] == [[2], []]
