"""Invariants of an ingest: what interrupts it, and how often it checkpoints, changes nothing."""

from __future__ import annotations

import random
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from d3a.checkpoint import pack, unpack
from d3a.ingest import ingest
from d3a.model import BadInput, Frame, Json
from d3a.parameters import PROFILES, Parameters
from d3a.readers.base import RecordingFacts
from d3a.store.base import Batch, Store, StoreError, StoreRefused
from d3a.store.opening import open_store
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, jpeg, rounds

KILLS = 12
"""How often the suite kills an ingest; tests/bench/bench_real.py does it 50 times."""

drawn_things = st.lists(
    st.tuples(
        st.sampled_from(["cup", "bowl", "book"]),
        st.integers(0, 7),
        st.integers(0, 3),
        st.integers(0, 30),
    ),
    min_size=1,
    max_size=6,
)


def world(drawn: Sequence[tuple[str, int, int, int]], seed: int, frames: int = 45) -> list[Frame]:
    places = circle(1.5, 8)
    things = [Thing(c, places[at], look, since) for c, at, look, since in drawn]
    return rounds(things, frames, seed, noise_m=0.1, missed=0.4)


def with_pictures(frames: list[Frame]) -> list[Frame]:
    return [replace(frame, image=jpeg(n % 150)) for n, frame in enumerate(frames)]


def dump_of(frames: Sequence[Frame], parameters: Parameters) -> list[Json]:
    store = OracleStore()
    ingest(ListReader(frames), store, parameters)
    return list(store.dump())


def small(profile: str, checkpoint_frames: int = 10) -> Parameters:
    """A memory so small that things are evicted and fetched back."""
    return PROFILES[profile].with_changes(
        stm_capacity=3, checkpoint_frames=checkpoint_frames, interval_gap_s=30.0
    )


@pytest.mark.parametrize("profile", ["default", "paper"])
@settings(deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow])
@given(drawn=drawn_things, seed=st.integers(0, 99), cut=st.integers(1, 44))
def test_a_prefix_and_the_rest_are_the_whole(
    profile: str, drawn: list[tuple[str, int, int, int]], seed: int, cut: int
) -> None:
    frames, parameters = world(drawn, seed), small(profile)
    store = OracleStore()
    ingest(ListReader(frames), store, parameters, max_frames=cut)
    ingest(ListReader(frames), store, parameters)
    assert list(store.dump()) == dump_of(frames, parameters)


@pytest.mark.parametrize("profile", ["default", "paper"])
@settings(deadline=None, max_examples=10, suppress_health_check=[HealthCheck.too_slow])
@given(drawn=drawn_things, seed=st.integers(0, 99), every=st.integers(1, 50))
def test_checkpoints_and_the_order_in_a_frame_do_not_matter(
    profile: str, drawn: list[tuple[str, int, int, int]], seed: int, every: int
) -> None:
    frames = world(drawn, seed)
    shuffled = []
    for number, frame in enumerate(frames):
        detections = list(frame.detections or ())
        random.Random(number).shuffle(detections)
        shuffled.append(replace(frame, detections=tuple(detections)))
    wanted = [r for r in dump_of(frames, small(profile)) if r["kind"] != "meta"]
    found = [r for r in dump_of(shuffled, small(profile, every)) if r["kind"] != "meta"]
    assert found == wanted


@pytest.mark.parametrize("profile", ["default", "paper"])
@settings(deadline=None, max_examples=10, suppress_health_check=[HealthCheck.too_slow])
@given(drawn=drawn_things, seed=st.integers(0, 99))
def test_no_detection_is_counted_twice(
    profile: str, drawn: list[tuple[str, int, int, int]], seed: int
) -> None:
    frames = world(drawn, seed)
    store = OracleStore()
    summary = ingest(ListReader(frames), store, small(profile))
    counted = sum(stay.seen for stay in store.stays())
    assert counted == sum(sighting.seen for sighting in store.sightings())
    assert counted <= summary.detections
    total = sum(d.probability for f in frames for d in f.detections or ())
    assert sum(record.weight for record in store.objects()) <= total + 1e-6
    assert store.check() == []


class Killed(Exception):  # noqa: N818
    """Stands for SIGKILL: nothing after it happens."""


class DyingStore:
    """A store whose process dies at some batch, before or after it was committed."""

    def __init__(self, store: Store, after: int, committed: bool) -> None:
        self._store, self._left, self._committed = store, after, committed

    def apply(self, batch: Batch) -> None:
        self._left -= 1
        if self._left < 0:
            if self._committed:
                self._store.apply(batch)
            raise Killed
        self._store.apply(batch)

    def __getattr__(self, name: str) -> object:
        return getattr(self._store, name)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_a_killed_ingest_that_is_run_again_ends_in_the_same_store(
    profile: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn = [("cup", n, n % 3, 4 * n) for n in range(6)]
    frames, parameters = with_pictures(world(drawn, 5, 60)), small(profile, 7)
    wanted = dump_of(frames, parameters)
    rng = random.Random(8)
    for kill in range(KILLS):
        store = open_store(f"sqlite:///{tmp_path / f'{profile}{kill}.db'}")
        for _ in range(rng.randrange(1, 4)):
            dying = DyingStore(store, rng.randrange(0, 6), rng.random() < 0.5)
            try:
                ingest(ListReader(frames), dying, parameters)  # type: ignore[arg-type]
            except Killed:
                continue
        ingest(ListReader(frames), store, parameters)
        assert list(store.dump()) == wanted
        assert store.check() == []
        store.close()
    with capsys.disabled():
        sys.stdout.write(f" {KILLS} kills ")


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_the_same_recording_twice_changes_nothing(profile: str) -> None:
    frames = with_pictures(world([("cup", 1, 1, 0), ("bowl", 3, 2, 0)], 3))
    store = OracleStore()
    first = ingest(ListReader(frames), store, small(profile))
    before = list(store.dump())
    again = ingest(ListReader(frames), store, small(profile))
    assert list(store.dump()) == before
    assert not first.already
    assert again.already
    assert again.frames == 0
    assert again.already_frames == len(frames)


def test_a_recording_that_grew_is_continued() -> None:
    frames = world([("cup", 1, 1, 0)], 3)
    store = OracleStore()
    ingest(ListReader(frames[:30]), store, small("default"))
    summary = ingest(ListReader(frames), store, small("default"))
    assert summary.frames == 15
    (record,) = store.recordings()
    assert (record.frames, record.done) == (45, True)


def test_a_second_recording_goes_on_with_the_things_of_the_first() -> None:
    drawn = [("cup", 0, 1, 0), ("bowl", 3, 2, 0)]
    first = world(drawn, 3)
    later = [
        replace(frame, name=f"g{n}", time_ms=frame.time_ms + 86_400_000)
        for n, frame in enumerate(world(drawn, 4))
    ]
    store = OracleStore()
    ingest(ListReader(first), store, PROFILES["default"])
    ids = [record.object_id for record in store.objects()]
    ingest(ListReader(later, RecordingFacts("later", zone="UTC")), store, PROFILES["default"])
    assert [record.object_id for record in store.objects()] == ids
    assert len(store.recordings()) == 2


@pytest.mark.parametrize("profile", ["default", "paper"])
@pytest.mark.parametrize("cut", [5, 20, 44])
def test_a_second_recording_that_was_interrupted_is_the_whole(profile: str, cut: int) -> None:
    drawn = [("cup", 0, 1, 0), ("bowl", 3, 2, 0), ("book", 5, 0, 0)]
    later = [replace(f, time_ms=f.time_ms + 86_400_000) for f in world(drawn, 4)]
    first = ListReader(world(drawn, 3))
    second = ListReader(later, RecordingFacts("later", zone="UTC"))
    whole, parts = OracleStore(), OracleStore()
    for store in (whole, parts):
        ingest(first, store, small(profile))
    known = {record.object_id for record in whole.objects()}
    ingest(second, whole, small(profile))
    ingest(second, parts, small(profile), max_frames=cut)
    ingest(second, parts, small(profile))
    assert list(parts.dump()) == list(whole.dump())
    assert known <= {record.object_id for record in whole.objects()}


def test_an_open_recording_is_ended_before_another_begins() -> None:
    drawn = [("cup", 0, 1, 0), ("bowl", 3, 2, 0)]
    store = OracleStore()
    ingest(ListReader(world(drawn, 3)), store, PROFILES["paper"], max_frames=20)
    assert any(record.volatile for record in store.objects())
    later = [replace(f, time_ms=f.time_ms + 86_400_000) for f in world(drawn, 4)]
    ingest(ListReader(later, RecordingFacts("later")), store, PROFILES["paper"])
    assert not any(record.volatile for record in store.objects())
    assert store.check() == []


def test_a_store_filled_otherwise_is_refused_before_anything_is_written() -> None:
    frames = world([("cup", 1, 1, 0)], 3)
    store = OracleStore()
    ingest(ListReader(frames), store, PROFILES["default"])
    before = list(store.dump())
    other = RecordingFacts("other", embedding_model="clip")
    for reader, parameters, said in (
        (ListReader(frames), PROFILES["paper"], "profile 'default', not 'paper'"),
        (
            ListReader(frames),
            PROFILES["default"].with_changes(stm_capacity=9),
            "stm_capacity = 400",
        ),
        (ListReader(frames, other), PROFILES["default"], "embeddings of 'rgb-8x8x8'"),
    ):
        with pytest.raises(StoreRefused, match=said):
            ingest(reader, store, parameters)
    assert list(store.dump()) == before
    ingest(ListReader(frames), store, PROFILES["default"].with_changes(near_m=9.0))


def test_pictures_are_there_for_every_record_at_every_checkpoint() -> None:
    frames = with_pictures(world([("cup", 1, 1, 0), ("bowl", 5, 2, 0)], 3))
    for profile in ("default", "paper"):
        store = OracleStore()
        for cut in (7, 13, 20):
            ingest(ListReader(frames), store, small(profile), max_frames=cut)
            assert store.check() == []
        ingest(ListReader(frames), store, small(profile))
        assert store.check() == []
        used = {s.image for s in store.sightings()} | {e.image for e in store.encounters()}
        assert set(store.keyframe_keys()) == used - {None}
        keyframe = store.keyframe(store.keyframe_keys()[0])
        assert keyframe is not None
        assert (keyframe.width, keyframe.height) == (64, 48)


def test_a_state_comes_back_and_a_strange_one_is_refused() -> None:
    arrays = {"b": np.arange(6.0).reshape(2, 3), "a": np.zeros((0, 4), np.float32)}
    packed = pack({"x": [1, "ü"]}, arrays)
    record, again = unpack(packed)
    assert record == {"x": [1, "ü"]}
    assert all(np.array_equal(arrays[name], again[name]) for name in arrays)
    assert pack(record, again) == packed
    with pytest.raises(StoreError, match="not one of this program"):
        unpack(b"something else")
    with pytest.raises(StoreError, match="version 9"):
        unpack(packed.replace(b"\n1 ", b"\n9 ", 1))


def test_a_recording_without_frames_or_detections_is_bad_input() -> None:
    with pytest.raises(BadInput, match="no frame"):
        ingest(ListReader([]), OracleStore(), PROFILES["default"])
    blind = [Frame("a", 1, image=jpeg(1))]
    with pytest.raises(BadInput, match="needs a detector"):
        ingest(ListReader(blind), OracleStore(), PROFILES["default"])
