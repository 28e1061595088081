"""Things that leave a full memory come back as they went."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.model import Detection, Frame, Pose
from d3a.parameters import DEFAULT
from d3a.tracking.kinds import Kinds
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory, Whole
from d3a.tracking.positions import Row
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, FORWARD, START_MS, ListReader, colour, depth_png

SURE = tuple((np.eye(6) * 1e-4).ravel().tolist())
FAR_M = 60.0


def look(n: int, *detections: Detection, x: float = 0.0, away_m: float = 4.0) -> Frame:
    """A look forward from one of two spots; every other frame is a turn away, and shows nothing."""
    pose = Pose((x, 0.0 if n % 2 == 0 else 9.0, 0.0), FORWARD, SURE)
    shown = detections if n % 2 == 0 else ()
    time_ms = START_MS + n * 200_000  # so far apart, each look counts in full
    return Frame(f"f{n}", time_ms, pose, CAMERA, None, depth_png(away_m), shown)


def seen(category: str, number: int, left: float, x: float) -> Detection:
    """A thing 2 m ahead; `left` of 28 is straight ahead, and the others stand beside."""
    box, z = (left, 20.0, left + 8, 28.0), (left - 28) / 25
    return Detection(category, 0.9, box, position=(x, 0.0, z), embedding=colour(number))


def rounds_of_two_rooms(looks_in_vain: int) -> list[Frame]:
    """A cup and a bowl; the cup is gone; things in the other room; the bowl alone once more."""
    cup, bowl = seen("cup", 1, 28, 2.0), seen("bowl", 2, 46, 2.0)
    frames = [look(n, cup, bowl, away_m=2.0) for n in range(12)]
    frames += [look(n, bowl) for n in range(12, 12 + 2 * looks_in_vain)]
    n = len(frames)
    others = [seen("book", 3 + k, 12.0 * k + 4, FAR_M + 2) for k in range(4)]
    frames += [look(n + k, *others, x=FAR_M) for k in range(8)]
    n = len(frames)
    return frames + [look(n + k, bowl) for k in range(4)]


def filled(frames: list[Frame], capacity: int) -> OracleStore:
    store = OracleStore()
    parameters = DEFAULT.with_changes(stm_capacity=capacity, checkpoint_frames=7)
    ingest(ListReader(frames), store, parameters)
    return store


@pytest.mark.parametrize("looks_in_vain", [0, 3, 6])
def test_a_small_memory_tells_of_a_place_what_a_large_one_does(looks_in_vain: int) -> None:
    frames = rounds_of_two_rooms(looks_in_vain)
    small, large = filled(frames, 2), filled(frames, 400)
    assert small.stays() == large.stays()
    assert small.sightings() == large.sightings()
    assert [o.object_id for o in small.objects()] == [o.object_id for o in large.objects()]


def test_looks_in_vain_add_up_over_a_sleep() -> None:
    """Else what is looked for now and then would never be seen to be gone."""
    absent = []
    for looks_in_vain in (3, 5):  # and two more after it
        store = filled(rounds_of_two_rooms(looks_in_vain), 2)
        (cup,) = store.objects(categories=["cup"])
        (stay,) = store.stays(object_ids=[cup.object_id])
        absent.append(stay.last_absent_ms is not None)
    assert absent == [False, True]


def test_things_that_sleep_keep_all_their_numbers() -> None:
    memory, rng = Memory(), np.random.default_rng(1)
    for number in range(80):  # more than fit at first
        thing = Known(number, {"cup": 1.0}, 0, 0)
        thing.places = [Place(k, 0, 0) for k in range(1 + number % 3)]
        memory.add(thing)
        memory.looks.put(thing, colour(number), 2.0)
        for place in thing.places:
            (x, y, z), (xx, yy, zz) = rng.normal(size=3), rng.uniform(0.1, 1, 3)
            error = (xx, 0.0, 0.0, yy, 0.0, zz)
            row = Row.of((x, y, z), (-x, y, z), error, (0.0, 0.0), DEFAULT)
            memory.positions.add([(thing, place, row)])
    before = {whole.thing.number: whole for whole in memory.wholes()}
    names = ("bowl", "cup", "mug")
    kinds = Kinds(memory, 1)
    for _ in range(20):  # they leave and come in any order
        laid = rng.permutation(80)[:30].tolist()
        memory.lay([memory.things[number] for number in laid])
        assert memory.positions.placed == len(memory.things) == 50
        assert all(place.row < 0 for n in laid for place in before[n].thing.places)
        where = {(t.number, p.number): p.row for t, p in memory.positions.owners}
        assert sorted(where.values()) == list(range(len(memory.positions.owners)))
        assert all(p.row == where[t.number, p.number] for t, p in memory.positions.owners)
        assert_same(before, memory)
        memory.wake(rng.permutation(laid).tolist())
        for number in rng.permutation(80)[:9].tolist():
            memory.things[number].vote(names[number % 3], 2.0)
            memory.touch(memory.things[number])
            memory.things[number].seen += 1
        for name in names:
            listed = [
                thing
                for _, thing in sorted(memory.things.items())
                if thing.category == name and thing.seen >= 1
            ]
            assert [thing for thing, _ in kinds.of(name).lasts] == listed
    memory.lay([memory.things[7], memory.things[41]])
    memory.forget_sleepers([41])
    assert len(memory.looks.owners) == 79
    assert [each.thing.number for each in memory.sleepers()] == [7]
    del before[41]
    assert_same(before, memory)


def assert_same(before: dict[int, Whole], memory: Memory) -> None:
    wholes = memory.wholes()
    assert {whole.thing.number for whole in wholes} == before.keys()
    for whole in wholes:
        old = before[whole.thing.number]
        assert whole.thing is old.thing
        assert whole.look is not None
        assert np.array_equal(whole.look, colour(whole.thing.number))
        assert whole.rows == old.rows
