"""What frames show of known places: judged together or one by one it is the same."""

from __future__ import annotations

import math

import numpy as np
import pytest

from d3a.geometry import axes, rotation
from d3a.model import Camera, Pose
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef, Metres, Scene
from d3a.tracking.glimpses import SURE_M, WAITING_MOST, Glimpses, Shown
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.positions import Row
from d3a.tracking.sides import LOOK_RANGE_M, are_familiar, is_familiar

CAMERA = Camera(width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0)
WIDE = Camera(width=64, height=48, fx=30.0, fy=30.0, cx=32.0, cy=24.0)
MARGIN = DEFAULT.view_margin


def _memory(rng: np.random.Generator, count: int = 60) -> Memory:
    memory = Memory()
    for number in range(count):
        thing = Known(number, {"cup": 1.0}, 0, 0)
        memory.add(thing)
        place = Place(0, 0, 0)
        thing.places.append(place)
        x, y, z = rng.uniform((-12, -12, -1), (12, 12, 1)).tolist()
        variance = float(rng.choice([0.01, 4 * SURE_M**2]))
        error = (variance, 0.0, 0.0, variance, 0.0, variance)
        row = Row.of((x, y, z), (x, y, z), error, (0.0, 0.0), DEFAULT)
        memory.positions.add([(thing, place, row)])
    return memory


def _pose(rng: np.random.Generator) -> Pose:
    yaw = rng.uniform(0, 2 * math.pi)
    x, y = rng.uniform(-3, 3, 2).tolist()
    # the camera looks along the map's plane, its y axis down
    ahead = np.array([-0.5, 0.5, -0.5, 0.5])
    turn = np.array([0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)])
    return Pose((x, y, 0.0), _product(turn, ahead))


def _product(p: np.ndarray, q: np.ndarray) -> tuple[float, float, float, float]:
    (a, b, c, d), (e, f, g, h) = p.tolist(), q.tolist()
    return (
        d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h, d * h - a * e - b * f - c * g,
    )  # fmt: skip


def _scene(n: int, pose: Pose, camera: Camera = CAMERA, depth: Metres | None = None) -> Scene:
    return Scene(FrameRef(f"f{n}", n), (), pose, camera, depth)


def _add(glimpses: Glimpses, scene: Scene) -> None:
    assert scene.pose is not None
    glimpses.add(scene, scene.pose.position, axes(scene.pose), 0.3)


def _plainly(memory: Memory, scenes: list[Scene]) -> dict[int, tuple[int, tuple[float, ...]]]:
    """Return by number in how many frames a place is in view, and its last eye and range."""
    found: dict[int, tuple[int, tuple[float, ...]]] = {}
    for scene in scenes:
        assert scene.pose is not None
        assert scene.camera is not None
        camera = scene.camera
        for thing, place in memory.positions.owners:
            row = memory.positions.of(place)
            along = rotation(scene.pose).T @ (np.array(row.mean) - scene.pose.position)
            x, y, z = along.tolist()
            if not 0 < z <= LOOK_RANGE_M or row.spread[0] * 3 + 0.3 > 3 * SURE_M**2:
                continue
            u, v = camera.cx + camera.fx * x / z, camera.cy + camera.fy * y / z
            at = (u / camera.width, v / camera.height)
            if all(MARGIN <= share <= 1 - MARGIN for share in at):
                before = found.get(thing.number, (0, ()))[0]
                found[thing.number] = before + 1, (*scene.pose.position, z)
    return found


def _by_number(memory: Memory, glimpses: Glimpses) -> dict[int, tuple[int, tuple[float, ...]]]:
    glimpses.end_look()
    of, rows, shown = glimpses.take()
    assert not of.any()  # one look
    owners = [memory.positions.owners[row][0].number for row in rows.tolist()]
    assert owners == sorted(owners)
    assert memory.positions.rows_of(shown.keys).tolist() == rows.tolist()
    return {
        number: (int(frames), tuple(last))
        for number, frames, last in zip(owners, shown.counts[0], shown.last.T, strict=True)
    }


def _assert_same(
    one: dict[int, tuple[int, tuple[float, ...]]], other: dict[int, tuple[int, tuple[float, ...]]]
) -> None:
    assert one.keys() == other.keys()
    for number, (frames, last) in one.items():
        assert frames == other[number][0]
        assert last == pytest.approx(other[number][1])


@pytest.mark.parametrize("count", [1, 2, 5, WAITING_MOST + 3])
def test_the_frames_of_a_look_show_what_each_shows(count: int) -> None:
    rng = np.random.default_rng(count)
    memory = _memory(rng)
    scenes = [_scene(n, _pose(rng), WIDE if n % 7 == 3 else CAMERA) for n in range(count)]
    glimpses = Glimpses(memory.positions, DEFAULT)
    for scene in scenes:
        _add(glimpses, scene)
    told = _by_number(memory, glimpses)
    assert told
    _assert_same(told, _plainly(memory, scenes))
    assert _by_number(memory, glimpses) == {}  # the next look begins with nothing


@pytest.mark.parametrize("is_stopped", [False, True])
@pytest.mark.parametrize(
    "frames",
    [
        [1, 1, 1, 1],
        [2, 0, 1, 3],
        [WAITING_MOST - 1, 0, 3, 2],  # the first two are judged while the third goes on
    ],
)
def test_looks_that_are_taken_together_show_what_each_shows(
    frames: list[int], is_stopped: bool
) -> None:
    """The last goes on, and is taken with the next ones; also where a checkpoint was between."""
    rng = np.random.default_rng(sum(frames))
    memory = _memory(rng)
    looks = [[_scene(n, _pose(rng)) for n in range(count)] for count in frames]
    glimpses = Glimpses(memory.positions, DEFAULT)
    for look in looks[:-1]:
        for scene in look:
            _add(glimpses, scene)
        glimpses.end_look()
    *others, last = looks[-1]
    for scene in others:
        _add(glimpses, scene)
    if is_stopped:
        state, glimpses = glimpses.to_state(), Glimpses(memory.positions, DEFAULT)
        glimpses.restore(*state)
    of, rows, shown = glimpses.take()
    owners = [memory.positions.owners[row][0].number for row in rows.tolist()]
    assert memory.positions.rows_of(shown.keys).tolist() == rows.tolist()
    for k, look in enumerate(looks[:-1]):
        told = {
            number: (int(times), tuple(where))
            for at, number, times, where in zip(
                of.tolist(), owners, shown.counts[0], shown.last.T, strict=True
            )
            if at == k
        }
        _assert_same(told, _plainly(memory, look))
    _add(glimpses, last)
    _assert_same(_by_number(memory, glimpses), _plainly(memory, looks[-1]))


def test_a_checkpoint_in_the_middle_of_a_look_changes_nothing() -> None:
    rng = np.random.default_rng(5)
    memory = _memory(rng)
    scenes = [_scene(n, _pose(rng)) for n in range(WAITING_MOST + 9)]
    whole, before, after = (Glimpses(memory.positions, DEFAULT) for _ in range(3))
    for n, scene in enumerate(scenes):
        _add(whole, scene)
        if n == WAITING_MOST + 4:
            after.restore(*before.to_state())
        _add(before if n <= WAITING_MOST + 3 else after, scene)
    assert _by_number(memory, whole) == _by_number(memory, after)


def test_what_left_the_memory_is_not_told_of() -> None:
    rng = np.random.default_rng(2)
    memory = _memory(rng)
    glimpses = Glimpses(memory.positions, DEFAULT)
    scenes = [_scene(n, _pose(rng)) for n in range(WAITING_MOST + 1)]
    for scene in scenes:
        _add(glimpses, scene)
    seen = sorted(_plainly(memory, scenes))
    memory.remove(memory.things[seen[0]])  # the last row moves into its
    glimpses.forget(seen[1])
    assert set(_by_number(memory, glimpses)) <= set(seen[1:])


def test_frames_with_depth_say_what_hides_a_place() -> None:
    memory = _memory(np.random.default_rng(1), 0)
    thing, place = Known(1, {"cup": 1.0}, 0, 0), Place(0, 0, 0)
    memory.add(thing)
    thing.places.append(place)
    row = Row.of((0.0, 0.0, 2.0), (0.0, 0.0, 2.0), (1e-4, 0, 0, 1e-4, 0, 1e-4), (0, 0), DEFAULT)
    memory.positions.add([(thing, place, row)])
    pose = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    glimpses = Glimpses(memory.positions, DEFAULT)
    for n, metres in enumerate((1.0, 2.0, 4.0, 1.0)):
        depth = np.full((48, 64), metres, dtype=np.float32)
        glimpses.add(_scene(n, pose, depth=depth), (0.1 * n, 0.0, 0.0), axes(pose), 1e-4)
    glimpses.end_look()
    _, _, shown = glimpses.take()
    assert shown.counts[:, 0].tolist() == [4.0, 2.0, 1.0]
    assert shown.last[:, 0] == pytest.approx([0.2, 0.0, 0.0, 2.0])  # of the last in plain view


def test_sides_in_a_table_are_as_familiar_as_one_by_one() -> None:
    rng = np.random.default_rng(3)
    memory = _memory(rng, 30)
    places = [place for _, place in memory.positions.owners]
    for k, place in enumerate(places):
        place.seen_from = [tuple(side) for side in rng.uniform(-3, 3, (k % 12, 3)).tolist()]
        memory.positions.put_sides(place)
    last = np.concatenate([rng.uniform(-3, 3, (3, 30)), rng.uniform(0, 9, (1, 30))])
    last[:, 7] = np.nan
    rows = np.array([place.row for place in places])
    expected = [
        is_familiar(place, (x, y, z), away_m)
        for place, (x, y, z, away_m) in zip(places, last.T.tolist(), strict=True)
    ]
    assert are_familiar(memory.positions.sides(rows), last).tolist() == expected
    assert 0 < sum(expected) < 30


def test_parts_of_a_look_add_up() -> None:
    one = Shown(np.array([1, 4]), np.ones((3, 2)), np.array([[1.0, 2.0]] * 4))
    other = Shown(np.array([2, 4]), np.ones((3, 2)), np.array([[3.0, np.nan]] * 4))
    both = one.then(other)
    assert both.keys.tolist() == [1, 2, 4]
    assert both.counts.tolist() == [[1.0, 1.0, 2.0]] * 3
    assert both.last.tolist() == [[1.0, 3.0, 2.0]] * 4
