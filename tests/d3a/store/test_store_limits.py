"""What a store refuses, and that it says which record and why."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.store.base import (
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayRecord,
    StoreRefused,
    TaughtName,
    View,
)
from d3a.store.limits import MAX_INTERVAL_MS, MAX_TIME_MS, check_batch
from tests.worlds.oracle import OracleStore

BOX = (0.0, 0.0, 1.0, 1.0)
NAN = float("nan")


def an_object(**changes: object) -> ObjectRecord:
    fields: dict[str, object] = {
        "object_id": "a", "category": "cup", "weight": 1.0, "first_ms": 0, "last_ms": 1,
    }  # fmt: skip
    return ObjectRecord(**{**fields, **changes})  # type: ignore[arg-type]


def a_stay(**changes: object) -> StayRecord:
    fields: dict[str, object] = {
        "object_id": "a", "place": 0, "position": (0.0, 0.0, 0.0), "first_ms": 0, "last_ms": 1,
        "weight": 1.0,
    }  # fmt: skip
    return StayRecord(**{**fields, **changes})  # type: ignore[arg-type]


def a_sighting(**changes: object) -> Sighting:
    fields: dict[str, object] = {
        "object_id": "a", "place": 0, "start_ms": 0, "end_ms": 1, "frame": "f",
        "probability": 0.5, "box": BOX,
    }  # fmt: skip
    return Sighting(**{**fields, **changes})  # type: ignore[arg-type]


def an_encounter(**changes: object) -> Encounter:
    fields: dict[str, object] = {
        "object_a": "a", "object_b": "b", "place_a": 0, "place_b": 0, "start_ms": 0, "end_ms": 1,
        "frame": "f", "box_a": BOX, "box_b": BOX, "probability": 0.5,
    }  # fmt: skip
    return Encounter(**{**fields, **changes})  # type: ignore[arg-type]


def embedding(length: int = 64, fill: float = 0.1) -> np.ndarray:
    return np.full(length, fill, dtype=np.float32)


REFUSED = [
    (Batch(objects=[an_object(object_id="")]), "object_id is empty"),
    (Batch(objects=[an_object(object_id="a\0b")]), "NUL"),
    (Batch(objects=[an_object(category="cup\ud800")]), "surrogate"),
    (Batch(objects=[an_object(category="c" * 1025)]), "1025 characters"),
    (Batch(objects=[an_object(weight=NAN)]), "weight must be a finite number"),
    (Batch(objects=[an_object(weight=-1.0)]), "weight -1.0 is outside"),
    (Batch(objects=[an_object(first_ms=5, last_ms=4)]), "ends 1 ms before"),
    (Batch(objects=[an_object(last_ms=MAX_TIME_MS + 1)]), "end 7258118400001 is outside"),
    (Batch(objects=[an_object(last_ms=1.5)]), "end must be a whole number"),
    (Batch(objects=[an_object(names=[TaughtName("")])]), "taught name is empty"),
    (Batch(objects=[an_object(categories=[("cup", NAN)])]), "category's weight"),
    (Batch(objects=[an_object(extent_m=(1.0,))]), "extent needs 2 numbers"),
    (Batch(objects=[an_object(embedding=embedding(63))]), "64 to 4096"),
    (Batch(objects=[an_object(embedding=embedding(4097))]), "64 to 4096"),
    (Batch(objects=[an_object(embedding=embedding(fill=NAN))]), "NaN or infinity"),
    (Batch(objects=[an_object(embedding=np.ones(64))]), "float32"),
    (Batch(stays=[a_stay(place=-1)]), "place -1 is outside"),
    (Batch(stays=[a_stay(position=(1e4, 0.0, 0.0))]), "x 10000.0 m is not within"),
    (Batch(stays=[a_stay(position=(0.0, -1e4, 0.0))]), "y -10000.0 m is not within"),
    (Batch(stays=[a_stay(position=(0.0, 0.0, 1001.0))]), "z 1001.0 is outside"),
    (Batch(stays=[a_stay(position=(0.0, NAN, 0.0))]), "finite"),
    (Batch(stays=[a_stay(covariance=(1.0,) * 8)]), "covariance needs 9"),
    (Batch(stays=[a_stay(moved_from=(0, NAN))]), "score of moved_from"),
    (Batch(sightings=[a_sighting(end_ms=MAX_INTERVAL_MS + 1)]), "split it"),
    (Batch(sightings=[a_sighting(probability=1.1)]), "probability 1.1 is outside"),
    (Batch(sightings=[a_sighting(box=(0.0, 0.0, 1.0))]), "box needs 4"),
    (Batch(sightings=[a_sighting(box=(0.0, 0.0, "1", 1.0))]), "finite number, not '1'"),
    (Batch(sightings=[a_sighting(viewer=(0.0,) * 6 + (float("inf"),))]), "number, not inf"),
    (Batch(sightings=[a_sighting(viewer=(0.0,) * 6)]), "viewer needs 7"),
    (Batch(sightings=[a_sighting(start_ms=-1)]), "start -1 is outside"),
    (Batch(encounters=[an_encounter(object_a="c")]), "object_a must come before"),
    (Batch(encounters=[an_encounter(box_b=(NAN, 0.0, 1.0, 1.0))]), "box_b must be a finite"),
    (Batch(encounters=[an_encounter(apart=(0.0, 0.0, 1.0))]), "apart needs 4 numbers, not 3"),
    (Batch(views=[View(0, 1, 1, x=NAN)]), "x must be a finite"),
    (Batch(keyframes=[Keyframe("k", b"", 1, 1, 0)]), "0 bytes"),
    (Batch(keyframes=[Keyframe("k", b"x", 0, 1, 0)]), "width 0 is outside"),
    (Batch(regions=[Region("hall", ((0.0, 0.0), (1.0, 0.0)))]), "three corners"),
    (Batch(recordings=[RecordingRecord("", "r", "", None, 0, 0, None, None, None, False)]), "key"),
    (Batch(removed_objects=["a\0"]), "NUL"),
    (Batch(meta={"zone": NAN}), "not JSON"),
    (Batch(meta={"zone": {1, 2}}), "not JSON"),
    (Batch(meta={"": 1}), "key is empty"),
]


@pytest.mark.parametrize(("batch", "said"), REFUSED, ids=[said for _, said in REFUSED])
def test_what_is_outside_of_the_limits_is_refused(batch: Batch, said: str) -> None:
    with pytest.raises(StoreRefused) as refused:
        check_batch(batch)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    "batch",
    [
        Batch(sightings=[a_sighting(end_ms=MAX_INTERVAL_MS)]),
        Batch(sightings=[a_sighting(box=(np.float32(0.5), 0, 1.0, np.int64(1)))]),
        Batch(stays=[a_stay(position=(9999.999, -9999.999, -1000.0))]),
        Batch(objects=[an_object(object_id="clé ☕ 钥匙", last_ms=MAX_TIME_MS)]),
        Batch(objects=[an_object(embedding=embedding(4096))]),
        Batch(meta={"$where": "1", "a.b": {"$gt": ""}}),
    ],
    ids=[
        "an hour",
        "numbers of any kind",
        "the map's corner",
        "any script",
        "a long embedding",
        "operators as text",
    ],
)
def test_what_is_at_the_limits_is_taken(batch: Batch) -> None:
    check_batch(batch)


@given(st.floats(allow_nan=True, allow_infinity=True), st.floats(), st.floats())
def test_no_position_passes_that_an_index_would_refuse(x: float, y: float, z: float) -> None:
    inside = abs(x) < 10_000 and abs(y) < 10_000 and abs(z) <= 1_000
    batch = Batch(stays=[a_stay(position=(x, y, z))])
    if inside:
        check_batch(batch)
    else:
        with pytest.raises(StoreRefused):
            check_batch(batch)


def test_nothing_of_a_refused_batch_is_written(oracle_store: OracleStore) -> None:
    with pytest.raises(StoreRefused):
        oracle_store.apply(Batch(objects=[an_object()], stays=[a_stay(place=-1)]))
    assert list(oracle_store.dump()) == []
