from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a.ledger import Ledger
from d3a.model import Detection
from d3a.paper import PaperPipeline
from d3a.parameters import PAPER
from d3a.sightings import FrameRef, Scene
from d3a.stm import Entry, ShortTermMemory
from d3a.store.base import Batch
from d3a.tier3 import Stored
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import colour


def frame(
    number: int,
    x: float,
    look: int = 1,
    step_s: float = 1.0,
    category: str = "cup",
    probability: float = 0.8,
    embedding: NDArray[np.float32] | None = None,
    z: float = 0.0,
) -> Scene:
    seen = colour(look) if embedding is None else embedding
    detection = Detection(
        category, probability, (0, 0, 5, 5), position=(x, 0.0, z), embedding=seen, row=number
    )
    return Scene(FrameRef(f"f{number}", round(number * step_s * 1000)), (detection,))


class Line:
    """The paper's pipeline with a store behind it."""

    def __init__(self, **changes: object) -> None:
        self.store = OracleStore()
        self.ledger = Ledger(self.store)
        parameters = PAPER.with_changes(**changes)
        self.pipeline = PaperPipeline(self.ledger, Stored("lab", "rgb-8x8x8"), parameters)

    def see(self, *scenes: Scene) -> None:
        for each in scenes:
            self.pipeline.observe(each)

    def write(self, *, flush: bool = False) -> OracleStore:
        if flush:
            self.pipeline.flush()
        self.pipeline.write()
        self.store.apply(Batch(**self.ledger.batch_fields()))
        self.ledger.clear()
        return self.store


def test_case_1_near_in_look_and_space_is_the_same() -> None:
    line = Line()
    line.see(frame(0, 1.0), frame(1, 1.0), frame(100, 1.3), frame(101, 1.3))
    store = line.write(flush=True)
    (stay,) = store.stays()
    assert stay.seen == 4
    assert stay.position is not None
    assert stay.position[0] == pytest.approx(1.15)
    assert stay.weight == pytest.approx(3.2)


def test_case_2_alike_but_far_off_has_moved() -> None:
    line = Line()
    line.see(frame(0, 1.0), frame(1, 1.0), frame(100, 4.0), frame(101, 4.0))
    store = line.write(flush=True)
    (record,) = store.objects()
    assert [stay.place for stay in store.stays()] == [0, 1]
    moved = store.stays()[1].moved_from
    assert moved is not None
    assert moved[0] == 0
    assert moved[1] == pytest.approx(1.0, abs=1e-6)
    assert record.weight == pytest.approx(3.2)


def test_case_3_another_look_is_another_thing() -> None:
    line = Line()
    line.see(frame(0, 1.0), frame(1, 1.0), frame(100, 1.0, look=9), frame(101, 1.0, look=9))
    assert len(line.write(flush=True).objects()) == 2


@pytest.mark.parametrize("capacity", [400, 1], ids=["memory", "store"])
def test_a_moved_thing_may_be_read_as_another_one(capacity: int) -> None:
    scenes = [frame(0, 1.0), frame(1, 1.0), frame(100, 4.0), frame(101, 4.0)]
    line = Line(keep_moved_id=False, stm_capacity=capacity)
    line.see(*scenes)
    store = line.write(flush=True)
    assert len(store.objects()) == 2
    assert all(stay.moved_from is None for stay in store.stays())
    kept = Line(stm_capacity=capacity)
    kept.see(*scenes)
    assert len(kept.write(flush=True).objects()) == 1


@pytest.mark.parametrize("capacity", [400, 1], ids=["memory", "store"])
def test_without_the_gate_tiers_2_and_3_join_what_is_named_otherwise(capacity: int) -> None:
    scenes = [frame(n, 1.0, category="bowl" if n >= 100 else "cup") for n in (0, 1, 100, 101)]
    gated, open_ = Line(stm_capacity=capacity), Line(stm_capacity=capacity, gate_category=False)
    gated.see(*scenes)
    open_.see(*scenes)
    assert len(gated.write(flush=True).objects()) == 2
    (record,) = open_.write(flush=True).objects()
    assert record.weight == pytest.approx(3.2)


def test_closest_in_look_takes_the_most_alike_where_it_is() -> None:
    """A likeness of .7 stands near, the very look far off: by look it is the one that moved."""
    middle = (colour(1) + colour(9)) / np.float32(np.sqrt(2))
    scenes = [frame(0, 1.0), frame(1, 1.0)]
    scenes += [frame(n, 5.0, embedding=middle) for n in (100, 101)]
    scenes += [frame(n, 5.2) for n in (200, 201)]
    places = {}
    for nearest_by in ("space", "look"):
        line = Line(nearest_by=nearest_by)
        line.see(*scenes)
        line.write()
        places[nearest_by] = len(line.store.stays())
    assert places == {"space": 2, "look": 3}


def test_views_may_count_alike_whatever_their_probability() -> None:
    means = {}
    for weigh_by in ("probability", "count"):
        line = Line(weigh_by=weigh_by)
        line.see(frame(0, 1.0, probability=0.9), frame(1, 1.4, probability=0.3))
        (stay,) = line.write(flush=True).stays()
        assert stay.position is not None
        means[weigh_by] = (stay.position[0], stay.weight)
    assert means["probability"] == pytest.approx((1.1, 1.2))
    assert means["count"] == pytest.approx((1.2, 2.0))


def test_the_memory_is_seen_while_it_fills_and_replaced_when_it_is_evicted() -> None:
    line = Line()
    line.see(frame(0, 1.0), frame(1, 1.0))
    store = line.write()
    assert [record.volatile for record in store.objects()] == [True]
    assert [stay.volatile for stay in store.stays()] == [True]
    assert len(store.sightings()) == 1
    line.see(frame(2, 1.0))
    store = line.write(flush=True)
    assert [record.volatile for record in store.objects()] == [False]
    assert [(stay.place, stay.volatile, stay.seen) for stay in store.stays()] == [(0, False, 3)]
    assert [sighting.seen for sighting in store.sightings()] == [3]


def test_a_full_memory_evicts_the_least_recently_viewed_and_tier_3_merges_it_again() -> None:
    line = Line(stm_capacity=1)
    pairs = [(0, 1.0), (100, 4.0), (200, 1.1), (300, 4.1)]
    line.see(*(frame(n + k, x, look=1 if x < 2 else 9) for n, x in pairs for k in range(2)))
    store = line.write(flush=True)
    weights = {record.object_id: record.weight for record in store.objects()}
    assert weights == pytest.approx({"o1": 3.2, "o2": 3.2})
    assert [stay.seen for stay in store.stays()] == [4, 4]


@pytest.mark.parametrize("capacity", [400, 1], ids=["flushed", "evicted"])
@pytest.mark.parametrize(
    ("along_m", "up_m", "places"),
    [
        (0.6, 0.0, {"map": 1, "space": 1, "none": 2}),  # drift, that tier 2 made a place of
        (0.8, 0.0, {"map": 2, "space": 1, "none": 2}),
        (0.0, 0.6, {"map": 2, "space": 1, "none": 2}),  # the shelf above: no pose drifts there
    ],
)
def test_tier_3_normalises_by_the_axes(
    along_m: float, up_m: float, places: dict[str, int], capacity: int
) -> None:
    found = {}
    for by in places:
        line = Line(normalise_by=by, stm_capacity=capacity)
        line.see(frame(0, 1.0), frame(1, 1.0))
        line.see(*(frame(n, 1.0 + along_m, z=up_m) for n in (100, 101)))
        assert len(line.write().stays()) == 2
        store = line.write(flush=True)
        found[by] = len(store.stays())
        assert sum(stay.seen for stay in store.stays()) == 4
    assert found == places


def test_an_instance_keeps_its_object_whatever_is_more_alike_in_the_store() -> None:
    """Both places of one instance go to one object, though a look-alike was stored before."""
    line = Line(stm_capacity=3)
    line.see(frame(0, 1.0), frame(1, 1.0))
    line.write(flush=True)
    line.see(frame(200, 5.0), frame(201, 5.0), frame(300, 9.0), frame(301, 9.0))
    store = line.write(flush=True)
    assert {stay.object_id for stay in store.stays()} == {"o1"}
    assert [stay.place for stay in store.stays()] == [0, 1, 2]


def test_intervals_close_after_a_pause_and_keep_the_best_frame() -> None:
    line = Line()
    line.see(frame(0, 1.0), frame(1, 1.0), frame(2000, 1.0), frame(2001, 1.0))
    first, second = line.write(flush=True).sightings()
    assert (first.start_ms, first.end_ms, first.frame) == (0, 1000, "f0")
    assert (second.start_ms, second.end_ms) == (2_000_000, 2_001_000)


def test_rows_stay_dense_when_entries_leave() -> None:
    stm = ShortTermMemory(3)
    entries = [Entry(n, n, "cup", 1.0, 1, n, n) for n in range(3)]
    for n, entry in enumerate(entries):
        stm.add(entry, np.full(3, float(n)), colour(n))
    assert stm.least_recently_viewed() is entries[0]
    stm.remove(entries[0])
    assert [entry.serial for entry in stm] == [1, 2]
    assert stm.position(entries[2])[0] == 2.0
    assert [entry.serial for entry, _ in stm.near_in_look("cup", colour(2), 0.9)] == [2]
    assert stm.near_in_look("bowl", colour(2), 0.9) == []
    assert len(stm.near_in_look("cup", None, 0.9)) == 2
