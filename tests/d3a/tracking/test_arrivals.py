"""What looks before a thing was first seen say of whether it was brought."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from d3a.geometry import axes
from d3a.model import Camera, Pose
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef, Scene
from d3a.tracking.absence import SURE_SEEN, Absence
from d3a.tracking.alike import BINS
from d3a.tracking.arrivals import CAME_MOST, KEPT, Looked
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.moves import Moves
from d3a.tracking.positions import Row

Turn = tuple[float, float, float, float]
AHEAD: Turn = (0.0, 0.7071067811865476, 0.0, 0.7071067811865476)
"""The camera looks along x."""
BACK: Turn = (0.0, -0.7071067811865476, 0.0, 0.7071067811865476)
CAMERA = Camera(width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0)
WHERE = np.array([2.0, 0.0, 0.0])
HOUR_MS = 3_600_000
ORIGIN = (0.0, 0.0, 0.0)
AXES = axes(Pose(ORIGIN, AHEAD))


def scene(time_ms: int, eye: tuple[float, float, float] = ORIGIN, turn: Turn = AHEAD) -> Scene:
    pose = Pose(eye, turn)
    return Scene(FrameRef(f"f{time_ms}", time_ms), (), pose, CAMERA)


def look(looked: Looked, one: Scene) -> None:
    assert one.pose is not None
    looked.watch(one, one.pose.position, axes(one.pose))
    looked.end_look()


def brought(first_ms: int = 9 * HOUR_MS) -> Place:
    """A place that every look from the origin has shown since."""
    return Place(0, first_ms, first_ms, seen=3, hits=3, chances=3.0, seen_from=[ORIGIN])


def test_each_look_that_showed_nothing_there_says_that_it_was_brought() -> None:
    looked, said = Looked(DEFAULT), []
    for hour in range(4):
        said.append(looked.came(brought(), WHERE, 0.6))
        look(looked, scene(hour * HOUR_MS))
    assert said[0] == 0.0
    assert said[1] > 1.0
    assert said == sorted(said)
    assert said[2] - said[1] < said[1]  # nor is a thing always found that is there


def test_what_is_hard_to_see_was_there_perhaps() -> None:
    looked = Looked(DEFAULT)
    look(looked, scene(0))
    seldom = replace(brought(), chances=12.0)
    assert looked.came(seldom, WHERE, 0.6) < looked.came(brought(), WHERE, 0.6) / 2


@pytest.mark.parametrize(
    "other",
    [
        scene(10 * HOUR_MS),  # it was there by then
        scene(0, turn=BACK),  # the picture is of what is behind
        scene(0, (0.0, 0.5, 3.0)),  # above it: out of the picture
        scene(0, (-3.0, 0.0, 0.0)),  # a side that never showed it
        scene(0, (-9.0, 0.0, 0.0)),  # far away
    ],
)
def test_looks_that_could_not_have_shown_it_say_nothing(other: Scene) -> None:
    looked = Looked(DEFAULT)
    look(looked, other)
    assert looked.came(brought(), WHERE, 0.6) == 0.0


def test_what_looks_said_is_asked_anew_once_the_place_was_seen_again() -> None:
    looked, place = Looked(DEFAULT), brought()
    look(looked, scene(0))
    look(looked, scene(HOUR_MS, (-0.9, 0.0, 0.0)))
    once = looked.came(place, WHERE, 0.6)
    assert looked.came(place, WHERE, 0.6) == once
    place.seen_from.append((-0.9, 0.0, 0.0))
    place.seen += 1
    assert looked.came(place, WHERE, 0.6) > once
    assert looked.came(place, WHERE + 9.0, 0.6) == 0.0


def test_looks_from_one_side_at_one_time_are_hardly_more_than_one() -> None:
    close, apart = Looked(DEFAULT), Looked(DEFAULT)
    for n in range(3):
        look(close, scene(n * 1000))
        look(apart, scene(n * HOUR_MS))
    assert close.came(brought(), WHERE, 0.6) < 0.75 * apart.came(brought(), WHERE, 0.6)


def test_only_so_many_looks_are_kept_and_count_for_so_much() -> None:
    looked = Looked(DEFAULT)
    for n in range(2 * KEPT + 5):
        look(looked, scene(n * HOUR_MS))
    assert len(looked.rows) == KEPT + 5
    assert looked.rows[-1, 0] == (2 * KEPT + 4) * HOUR_MS
    assert looked.came(brought(9999 * HOUR_MS), WHERE, 0.6) == CAME_MOST


def test_a_look_that_goes_on_is_one_after_a_restart_too() -> None:
    whole, before, after = Looked(DEFAULT), Looked(DEFAULT), Looked(DEFAULT)
    for looked in (whole, before):
        look(looked, scene(0))
        looked.watch(scene(HOUR_MS), ORIGIN, AXES)
    after.restore(before.rows.copy(), before.is_open)
    for looked in (whole, after):
        looked.watch(scene(HOUR_MS + 1000), ORIGIN, AXES)
        looked.end_look()
        looked.watch(scene(2 * HOUR_MS), ORIGIN, AXES)
    assert len(whole.rows) == 3
    assert np.array_equal(whole.rows, after.rows)


def placed(
    memory: Memory, number: int, look: list[float], place: Place, away_m: float = 2.0
) -> Known:
    thing = Known(number, {"bag": 1.0}, place.first_ms, place.last_ms, seen=9)
    thing.places.append(place)
    memory.add(thing)
    memory.looks.put(thing, np.array(look, dtype=np.float32), 9.0)
    error = (0.01, 0.0, 0.0, 0.01, 0.0, 0.01)
    at = away_m, 0.0, 0.0
    row = Row.of(at, at, error, (0.0, 0.0), DEFAULT)
    memory.positions.add([(thing, place, row)])
    return thing


@pytest.mark.parametrize(("looks_before", "is_linked"), [(0, False), (4, True)])
def test_in_another_light_it_is_the_same_where_nothing_was_before(
    looks_before: int, is_linked: bool
) -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    moves = Moves(memory, LookSpace(DEFAULT), LookModel(DEFAULT), absence, DEFAULT)
    moves.others = {"bag": [1.0] * BINS}
    left = Place(0, 0, 1000, seen=9, hits=9, chances=12.0, misses=3, evidence=4.0)
    placed(memory, 0, [1.0, 0.0, 0.0], left)
    placed(memory, 1, [0.7, 0.714, 0.0], brought())
    for hour in range(looks_before):
        look(absence.looked, scene(hour * HOUR_MS))
    links = moves.find({0, 1}, 10 * HOUR_MS)
    assert [(link.old.number, link.new.number) for link in links] == [(0, 1)] * is_linked


@pytest.mark.parametrize(("views", "is_told"), [(SURE_SEEN - 1, False), (SURE_SEEN, True)])
def test_that_a_stray_is_not_seen_again_says_nothing(views: int, is_told: bool) -> None:
    """Two or three views of one bad moment found a thing that never was."""
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    place = Place(0, 0, 0, seen=views, hits=views, chances=float(views), seen_from=[ORIGIN])
    thing = placed(memory, 0, [1.0, 0.0, 0.0], place)
    thing.seen = views
    offset = FrameOffset.unknown(DEFAULT)
    for hour in range(1, 40):
        absence.watch(scene(hour * HOUR_MS), [], offset)
        absence.end_look()
        absence.judge()
    assert place.evidence > DEFAULT.absent_odds
    assert (place.last_absent_ms is not None) == is_told


@pytest.mark.parametrize(("away_m", "is_told"), [(3.0, True), (8.0, True), (12.0, False)])
def test_what_is_seen_across_a_hall_is_missed_across_it(away_m: float, is_told: bool) -> None:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    place = Place(0, 0, 0, seen=9, hits=9, chances=9.0, seen_from=[ORIGIN])
    placed(memory, 0, [1.0, 0.0, 0.0], place, away_m)
    offset = FrameOffset.unknown(DEFAULT)
    for hour in range(1, 12):
        absence.watch(scene(hour * HOUR_MS), [], offset)
        absence.end_look()
        absence.judge()
    assert (place.last_absent_ms is not None) == is_told
