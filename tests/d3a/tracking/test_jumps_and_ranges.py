"""A localisation that jumps, and ranges that are not those of the thing in the box."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a.images import unit
from d3a.ingest import ingest
from d3a.model import Detection, Frame, Pose
from d3a.parameters import DEFAULT
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, FORWARD, START_MS, ListReader, Thing, colour

Place = tuple[float, float, float]
DESK = [
    Thing("cup", (2.0, -0.5, 0.0), 1),
    Thing("book", (2.2, 0.3, 0.0), 2),
    Thing("lamp", (2.5, 0.8, 0.0), 3),
]
SIZE_M = 0.2
EYE = (0.0, 0.0, 0.0)


def like(number: int, other: int) -> NDArray[np.float32]:
    """The look of a thing in a light that makes it a little like another."""
    return unit(colour(number) + np.float32(1.0) * colour(other))


def view(
    thing: Thing,
    eye: Place,
    *,
    nearer: float = 1.0,
    off: Place = (0.0, 0.0, 0.0),
    size_m: float = SIZE_M,
) -> Detection:
    """A thing at its size, measured at so much of its range by a robot that is off by so much."""
    away = np.array(thing.position) - eye
    x, y, z = np.array(eye) + away * nearer + off
    side = CAMERA.fx * size_m / away[0]
    left = 20.0 + 10 * (thing.number % 3)
    return Detection(
        thing.category, 0.9, (left, 10.0, left + side, 10.0 + side),
        position=(float(x), float(y), float(z)), embedding=colour(thing.number),
    )  # fmt: skip


def frame(
    number: int,
    things: Sequence[Thing],
    eye: Place = EYE,
    *,
    nearer: float = 1.0,
    off: Place = (0.0, 0.0, 0.0),
) -> Frame:
    seen = tuple(view(thing, eye, nearer=nearer, off=off) for thing in things)
    x, y, z = np.array(eye) + off
    pose = Pose((float(x), float(y), float(z)), FORWARD)
    return Frame(f"f{number}", START_MS + number * 5000, pose, CAMERA, None, None, seen)


def side_by_side(shown: Frame) -> Frame:
    """The frame with boxes that are apart: one box is one thing, whatever it is called."""
    boxes = [(9.0 * k, 10.0, 9.0 * k + 5.0, 15.0) for k in range(len(shown.detections or ()))]
    both = zip(shown.detections or (), boxes, strict=True)
    return replace(shown, detections=tuple(replace(each, box=box) for each, box in both))


def filled(frames: Sequence[Frame]) -> OracleStore:
    store = OracleStore()
    ingest(ListReader(frames), store, DEFAULT)
    return store


@pytest.mark.parametrize("off", [(1.5, 0.9, 0.0), (-0.3, 1.6, 0.0)])
def test_a_localisation_that_jumps_makes_no_second_things(off: Place) -> None:
    steady = [frame(n, DESK) for n in range(8)]
    lost = [frame(n, DESK, off=off) for n in range(8, 16)]
    found_again = [frame(n, DESK) for n in range(16, 24)]
    store = filled([*steady, *lost, *found_again])
    assert sorted(record.category for record in store.objects()) == ["book", "cup", "lamp"]
    assert [stay.seen for stay in store.stays()] == [24, 24, 24]


def test_one_thing_elsewhere_is_no_jump_of_the_robot() -> None:
    """The cup was carried off, and everything else is where it was."""
    before = [frame(n, DESK) for n in range(8)]
    carried = [Thing("cup", (3.5, 1.9, 0.0), 1), *DESK[1:]]
    after = [frame(n, carried) for n in range(8, 16)]
    store = filled([*before, *after])
    places = [s.position for s in store.stays() if s.seen == 16 and s.position is not None]
    assert len(places) == 2, "book and lamp stayed where they were"
    for thing in DESK[1:]:
        assert min(math.dist(place, thing.position) for place in places) < 0.1


def test_twins_in_a_room_that_is_new_are_no_jump_of_the_robot() -> None:
    """Two of seven things lie there as two like them lie on the desk."""
    names = ("pan", "vase", "clock", "radio", "kettle")
    rest = [Thing(name, (2.0, 2.0 + 0.3 * k, 0.5), 4 + k) for k, name in enumerate(names)]
    twins = [
        replace(each, position=(each.position[0], each.position[1] + 1.5, 0.0)) for each in DESK[:2]
    ]
    before = [frame(n, DESK) for n in range(8)]
    after = [side_by_side(frame(n, [*twins, *rest], (0.0, 1.5, 0.0))) for n in range(8, 16)]
    stays = filled([*before, *after]).stays()
    assert [stay.seen for stay in stays] == [8] * 10
    for thing in (*DESK, *twins, *rest):
        assert min(math.dist(s.position, thing.position) for s in stays if s.position) < 0.1


def blind(shown: Frame) -> Frame:
    """The frame with detections that have no look."""
    seen = [replace(each, embedding=None) for each in shown.detections or ()]
    return replace(shown, detections=tuple(seen))


def test_namesakes_without_a_look_are_no_jump_of_the_robot() -> None:
    """Things that lie as two of their rare names do elsewhere are other ones."""
    frames = []
    for n in range(24):  # three other kinds wherever it comes by
        y = -5.0 * (n // 2)
        along = [Thing(f"kind {n // 2} {k}", (2.0, y - 0.5 + 0.5 * k, 0.5), k) for k in range(3)]
        frames.append(frame(n, along, (0.0, y, 0.0)))
    twins = [
        replace(each, position=(each.position[0], each.position[1] + 6.5, 0.0)) for each in DESK
    ]
    desk = [replace(each, position=(each.position[0], each.position[1] + 5, 0.0)) for each in DESK]
    frames += [frame(n, desk, (0.0, 5.0, 0.0)) for n in range(24, 27)]
    frames += [frame(n, twins[:2], (0.0, 6.5, 0.0)) for n in range(27, 29)]
    frames += [frame(n, desk, (0.0, 5.0, 0.0)) for n in range(29, 32)]
    stays = filled([blind(each) for each in frames]).stays()
    assert sorted(stay.seen for stay in stays) == [2] * 38 + [6] * 3
    for thing in (*desk, *twins[:2]):
        assert min(math.dist(s.position, thing.position) for s in stays if s.position) < 0.1


@pytest.mark.parametrize("nearer", [0.4, 2.0])
def test_a_thing_measured_at_a_wrong_range_is_the_thing_and_stays_where_it_is(
    nearer: float,
) -> None:
    frames = [frame(n, DESK) for n in range(6)]
    for n in range(6, 10):
        amiss = view(DESK[0], EYE, nearer=nearer)
        right = frame(n, DESK[1:])
        frames.append(replace(right, detections=(amiss, *(right.detections or ()))))
    stays = filled(frames).stays()
    assert [stay.seen for stay in stays] == [10, 10, 10]
    (at,) = [stay.position for stay in stays if stay.position is not None and stay.position[1] < 0]
    assert at == pytest.approx(DESK[0].position, abs=0.05)


def test_a_thing_that_was_first_measured_at_a_wrong_range_goes_where_it_is() -> None:
    cup = DESK[0]
    wrong = [frame(n, [cup], nearer=0.5) for n in range(2)]
    right = [frame(n, [cup], (0.0, -2.5, 0.0)) for n in range(2, 8)]
    (stay,) = filled([*wrong, *right]).stays()
    assert stay.seen == 8
    assert stay.position == pytest.approx(cup.position, abs=0.15)


@pytest.mark.parametrize(("size", "things"), [(0.4, 3), (1.0, 4)])
def test_the_size_tells_a_thing_at_a_wrong_range_from_another_before_it(
    size: float, things: int
) -> None:
    """At two fifths of the range its box is that of a smaller thing; a like one is as large."""
    frames = [frame(n, DESK) for n in range(6)]
    before = replace(DESK[0], position=(0.8, -0.2, 0.0))
    seen = replace(view(before, EYE, size_m=SIZE_M * size), embedding=like(1, 2))
    for n in range(6, 9):
        others = frame(n, DESK[1:])
        frames.append(replace(others, detections=(seen, *(others.detections or ()))))
    assert len({stay.object_id for stay in filled(frames).stays()}) == things
