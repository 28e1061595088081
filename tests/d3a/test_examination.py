"""Examining and mending a store as a whole, on every backend."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

import pytest

from d3a.correcting.forgotten import UNSCRUBBED
from d3a.examination import examine, facts_of, mend
from d3a.store.base import Batch, Keyframe, Store
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

MINUTE_MS = 60_000


def outgrown(store: Store) -> Batch:
    (sighting,) = store.sightings(object_ids=["cup-1"])
    return Batch(sightings=[replace(sighting, end_ms=sighting.end_ms + MINUTE_MS)])


def overlapping(store: Store) -> Batch:
    (s,) = store.sightings(object_ids=["cup-1"])
    (stay,) = store.stays(object_ids=["cup-1"])
    longer = replace(s, end_ms=s.end_ms + MINUTE_MS)
    within = replace(s, start_ms=s.start_ms + 5, end_ms=s.start_ms + 9)
    return Batch(stays=[replace(stay, last_ms=longer.end_ms)], sightings=[longer, within])


DAMAGE: dict[str, tuple[Callable[[Store], Batch], str, bool]] = {
    "outgrown": (outgrown, "stay cup-1 at 3 does not span its sightings", True),
    "overlapping": (overlapping, "begins before the one before it has ended", False),
    "cut picture": (
        lambda _: Batch(keyframes=[Keyframe("p1", b"\xff\xd8half", 8, 8, 1)]),
        "picture p1 is no whole JPEG",
        True,
    ),
    "checkpoint": (lambda _: Batch(state=b"\0"), "the checkpoint cannot be read", False),
    "zone": (lambda _: Batch(meta={"zone": "Mars/Base"}), "zone 'Mars/Base' is not known", False),
    "unscrubbed": (lambda _: Batch(meta={UNSCRUBBED: True}), "something was forgotten", True),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_named_and_what_can_be_mended_is(
    make_store: Callable[[], Store], kind: str
) -> None:
    damaged, said, mendable = DAMAGE[kind]
    with closing(make_store()) as store:
        small_home.fill(store)
        assert examine(store) == []
        assert mend(store) == []
        store.apply(damaged(store))
        found = examine(store)
        assert len(found) == 1
        assert said in found[0]
        if store.uri != "oracle":  # it knows no repair
            mended = mend(store)
            assert bool(mended) == mendable
            assert examine(store) == ([] if mendable else found)


def test_facts_tell_what_a_store_is(make_store: Callable[[], Store]) -> None:
    with closing(make_store()) as store:
        assert facts_of(store)["first_ms"] is None
        small_home.fill(store)
        store.apply(Batch(meta={"retention": {"seconds": 86_400}, "profile": "default"}))
        facts = facts_of(store)
        assert facts["categories"] == {"bowl": 1, "couch": 1, "cup": 1, "keys": 1}
        assert facts["holds"]["sightings"] == 6
        assert (facts["zone"], facts["retain_seconds"], facts["forgotten"]) == (
            small_home.ZONE.key,
            86_400,
            False,
        )
        assert facts["first_ms"] < facts["last_ms"]


def test_two_recordings_of_one_hour_may_show_one_thing() -> None:
    store = OracleStore()
    small_home.fill(store)
    store.apply(overlapping(store))
    (_, within) = store.sightings(object_ids=["cup-1"])
    assert len(examine(store)) == 1
    store.apply(Batch(sightings=[replace(within, recording="another camera")]))
    assert examine(store) == []
