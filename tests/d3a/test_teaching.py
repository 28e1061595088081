"""The small API for what people say, on every kind of store."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a import teaching
from d3a.constraints import HISTORY, SAID, Correction, History, forgetting
from d3a.correcting.corrections import UnknownThing
from d3a.images import encode, histogram
from d3a.model import BadInput, Json
from d3a.store import open_store
from d3a.store.base import (
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    Sighting,
    StayRecord,
    Store,
    TaughtName,
    View,
)
from d3a.store.copy import copy_store
from tests.worlds.oracle import OracleStore

MINUTE = 60_000
START = 1_600_000_000_000
BOX = (10.0, 10.0, 50.0, 40.0)
RED, BLUE = (200, 30, 30), (30, 40, 200)


def at(minute: float) -> int:
    return START + round(minute * MINUTE)


def picture(key: str, rgb: tuple[int, int, int]) -> Keyframe:
    pixels = np.full((48, 64, 3), rgb, dtype=np.uint8)
    return Keyframe(key, encode(pixels, 64, 95), 64, 48, START)


def look(rgb: tuple[int, int, int]) -> NDArray[np.float32]:
    return histogram(np.full((4, 4, 3), rgb, dtype=np.uint8))


def home() -> OracleStore:
    """A cup seen at two places (o1), the same cup under another id at one of them (o2), a bowl."""
    store = OracleStore()

    def seen(name: str, place: int, start: float, end: float, count: int, image: str) -> Sighting:
        return Sighting(
            name, place, at(start), at(end), f"f{image}", 0.9, BOX, image, count, category="cup"
        )

    mixed = np.asarray((look(RED) + look(BLUE)) / np.sqrt(2), dtype=np.float32)
    store.apply(
        Batch(
            objects=[
                ObjectRecord(
                    "o1", "cup", 6.0, at(0), at(30), "lab", (("cup", 5.0), ("bowl", 1.0)),
                    embedding=mixed, embedding_model="rgb-8x8x8", extent_m=(0.1, 0.1),
                ),
                ObjectRecord(
                    "o2", "cup", 2.0, at(31), at(33), "lab", (("cup", 2.0),),
                    embedding=look(BLUE), embedding_model="rgb-8x8x8",
                ),
                ObjectRecord("o3", "bowl", 3.0, at(0), at(30), "lab", (("bowl", 3.0),)),
            ],
            stays=[
                StayRecord("o1", 0, (1.0, 1.0, 0.8), at(0), at(10), 4.0, "lab", seen=4),
                StayRecord("o1", 1, (4.0, 2.0, 0.8), at(20), at(30), 2.0, "lab", seen=2,
                           moved_from=(0, 0.9)),
                StayRecord("o2", 0, (4.2, 2.1, 0.8), at(31), at(33), 2.0, "lab", seen=2),
                StayRecord("o3", 0, (1.2, 1.0, 0.8), at(0), at(30), 3.0, "lab", seen=3),
            ],
            sightings=[
                seen("o1", 0, 0, 10, 4, "red"),
                seen("o1", 1, 20, 30, 2, "blue"),
                seen("o2", 0, 31, 33, 2, "blue2"),
                replace(seen("o3", 0, 0, 30, 3, "red"), category="bowl"),
            ],
            encounters=[
                Encounter("o1", "o3", 0, 0, at(0), at(10), "fred", BOX, BOX, 0.8, "red", 3),
                Encounter("o2", "o3", 0, 0, at(31), at(33), "fblue2", BOX, BOX, 0.8, "blue2", 1),
            ],
            keyframes=[picture("red", RED), picture("blue", BLUE), picture("blue2", BLUE)],
            views=[View(at(40), at(41), 2, "lab", x=4.0, y=2.0, yaw=0.0)],
        )
    )  # fmt: skip
    return store


@pytest.fixture
def store(make_store: Callable[[], Store]) -> Store:
    made = make_store()
    copy_store(home(), made)
    return made


def content(store: Store) -> list[Json]:
    return [r for r in store.dump() if r.get("key") not in (HISTORY, SAID)]


def test_every_store_says_the_same_after_every_correction(store: Store) -> None:
    oracle = home()
    words: list[Callable[[Store], object]] = [
        lambda s: teaching.teach_name(s, "o2", "cup", "Anna"),
        lambda s: teaching.merge(s, "o1", "o2"),
        lambda s: teaching.split(s, "o1", 0),
        lambda s: teaching.name_place(s, "Kitchen", around=(4.0, 2.0), radius_m=1.0),
        lambda s: teaching.rename_place(s, "kitchen", "Pantry"),
        lambda s: teaching.merge(s, "o3", "s3", force=True),
        lambda s: teaching.remove_place(s, "pantry"),
        teaching.undo,
        teaching.undo,
        lambda s: teaching.forget_name(s, "o1", "cup"),
    ]
    for say in words:
        say(oracle)
        say(store)
        assert content(store) == content(oracle)
        assert store.check() == []
        assert [c.header() for c in teaching.history(store)] == [
            c.header() for c in teaching.history(oracle)
        ]
    while teaching.history(store):
        teaching.undo(store)
    assert content(store) == content(home())
    store.close()


def test_the_same_cup_is_one_cup_at_its_places() -> None:
    store = home()
    said = teaching.merge(store, "o1", "o2", at_ms=at(50))
    assert (said.said, said.at_ms) == ("o2 is the same thing as o1", at(50))
    (cup,) = store.objects(ids=["o1", "o2"])
    assert (cup.weight, cup.categories) == (8.0, (("cup", 7.0), ("bowl", 1.0)))
    assert (cup.first_ms, cup.last_ms) == (at(0), at(33))
    first, second = store.stays(object_ids=["o1"])
    assert first == home().stays(object_ids=["o1"])[0]
    assert second.seen == 4
    assert second.position == pytest.approx((4.1, 2.05, 0.8))
    assert second.moved_from == (0, 0.9)
    # a minute between them is no pause: one interval, with the earlier of equal keyframes
    (last,) = (s for s in store.sightings(object_ids=["o1"]) if s.place == 1)
    assert (last.start_ms, last.end_ms, last.seen) == (at(20), at(33), 4)
    met = store.encounters(object_ids=["o1"])
    assert [(e.object_a, e.place_a, e.seen) for e in met] == [("o1", 0, 3), ("o1", 1, 1)]


def test_what_turned_up_after_the_other_was_seen_last_has_moved_there() -> None:
    store = home()
    teaching.merge(store, "o3", "o2", force=True)
    (_, later) = store.stays(object_ids=["o3"])
    assert (later.position, later.moved_from) == ((4.2, 2.1, 0.8), (0, 1.0))


def test_one_frame_that_shows_both_says_that_they_are_two() -> None:
    store = home()
    before = content(store)
    with pytest.raises(BadInput, match="frame fred shows both o1 and o3"):
        teaching.merge(store, "o1", "o3")
    assert content(store) == before
    teaching.merge(store, "o1", "o3", force=True)
    assert [r.object_id for r in store.objects()] == ["o1", "o2"]


def test_a_split_tells_the_looks_apart_by_the_pictures() -> None:
    store = home()
    said = teaching.split(store, "o1", 1)
    new = said.arguments["new"]
    assert new == "s1"
    one, two = store.objects(ids=["o1", new])
    assert one.embedding is not None
    assert two.embedding is not None
    assert float(one.embedding @ look(RED)) > 0.99
    assert float(two.embedding @ look(BLUE)) > 0.99
    assert (one.weight, two.weight) == (4.0, 2.0)
    assert two.categories == (("cup", 2.0),)
    assert [s.place for s in store.stays(object_ids=[new])] == [0]
    assert store.stays(object_ids=[new])[0].moved_from is None
    assert store.sightings(object_ids=[new])[0].image == "blue"


def test_what_does_not_exist_is_named_with_the_nearest() -> None:
    store = home()
    with pytest.raises(UnknownThing, match="There is no object 'o11'") as error:
        teaching.teach_name(store, "o11", "cup")
    assert error.value.suggestions[0] == "o1"
    with pytest.raises(UnknownThing) as error:
        teaching.merge(store, "o1", "Cup")  # a word: those that it may mean, the likeliest first
    assert error.value.suggestions == ("o1", "o2")
    with pytest.raises(UnknownThing, match="has no place 3; it has 0, 1"):
        teaching.split(store, "o1", 3)
    with pytest.raises(UnknownThing, match="There is no place 'kitchn'"):
        teaching.remove_place(store, "kitchn")
    with pytest.raises(UnknownThing, match="nothing to undo"):
        teaching.undo(store)
    with pytest.raises(UnknownThing, match="it has no name"):
        teaching.forget_name(store, "o1", "mug")
    refusals: list[Callable[[], object]] = [
        lambda: teaching.merge(store, "o1", "o1"),
        lambda: teaching.split(store, "o3", 0),
        lambda: teaching.teach_name(store, "o1", " !? "),
        lambda: teaching.name_place(store, "k", polygon=[(0, 0), (1, 0)]),
        lambda: teaching.name_place(store, "k", polygon=[(0, 0), (1, 1), (2, 2)]),
        lambda: teaching.name_place(store, "k", polygon=[(0, 0), (1, 1), (1, 0), (0, 1)]),
        lambda: teaching.name_place(store, "k", around=(0, 0), radius_m=0),
        lambda: teaching.name_place(store, "k", polygon=[(0, 0), (1, float("nan")), (1, 0)]),
    ]
    for refused in refusals:
        with pytest.raises(BadInput):
            refused()
    assert content(store) == content(home())


def test_a_place_may_be_named_where_the_robot_stands() -> None:
    store = home()
    teaching.name_place(store, "Kitchen")
    (kitchen,) = store.regions()
    assert kitchen.name == "kitchen"
    xs, ys = zip(*kitchen.polygon, strict=True)
    assert (max(xs) + min(xs)) / 2 == pytest.approx(4.0)
    assert max(ys) - min(ys) == pytest.approx(3.0)
    with pytest.raises(BadInput, match="already"):
        teaching.name_place(store, "KITCHEN")
    teaching.name_place(store, "kitchen", around=(1, 1), replace=True)
    assert max(store.regions()[0].polygon)[0] == pytest.approx(2.5)
    teaching.undo(store)
    assert store.regions() == [kitchen]


def test_a_name_said_twice_changes_nothing_the_second_time() -> None:
    store = home()
    teaching.teach_name(store, "o1", "Cup", "Anna")
    before = content(store)
    assert teaching.teach_name(store, "o1", "cup", "anna").number == 0
    assert content(store) == before
    assert store.objects(ids=["o1"])[0].names == (TaughtName("cup", "anna"),)
    assert len(teaching.history(store)) == 1


def test_a_denial_holds_until_it_is_undone_or_the_name_is_taught() -> None:
    store = home()
    before = content(store)
    done = teaching.deny_name(store, "o2", "Cup", "me", at_ms=START)
    assert (done.number, done.said) == (1, "o2 is not my cup")
    assert teaching.deny_name(store, "o2", "cup", "me").number == 0
    assert History.read(store).denials() == {("o2", "cup", "me")}
    teaching.merge(store, "o1", "o2")
    assert ("o1", "cup", "me") in History.read(store).denials()
    teaching.teach_name(store, "o1", "cup", "me")
    assert ("o1", "cup", "me") not in History.read(store).denials()
    teaching.forget_name(store, "o1", "cup", "me")
    assert ("o1", "cup", "me") in History.read(store).denials()
    for _ in range(4):
        teaching.undo(store)
    assert History.read(store).denials() == frozenset()
    assert content(store) == before
    with pytest.raises(UnknownThing, match="no object"):
        teaching.deny_name(store, "o9", "cup", "me")


def test_what_a_correction_replaced_is_forgotten_with_its_object() -> None:
    store = home()
    teaching.merge(store, "o1", "o2")
    teaching.teach_name(store, "o3", "bowl", "me")
    store.apply(Batch(removed_objects=["o1"], meta=forgetting(store, ["o1"])))
    assert not [r for r in store.dump() if "correction:" in str(r.get("key"))]
    assert teaching.undo(store).kind == "teach"
    with pytest.raises(UnknownThing, match="nothing to undo"):
        teaching.undo(store)
    assert [r.object_id for r in store.objects()] == ["o3"]


def test_who_else_writes_waits_until_a_correction_is_written(tmp_path: Path) -> None:
    """Nothing is overwritten: what another writes is read before, or comes after."""
    path = str(tmp_path / "home.db")
    order: list[str] = []
    with closing(open_store(path)) as mine, closing(open_store(path)) as theirs:
        copy_store(home(), mine)
        (cup,) = mine.objects(ids=["o1"])

        def write() -> None:
            theirs.apply(Batch(objects=[replace(cup, weight=100.0)]))
            order.append("another")

        other = threading.Thread(target=write)

        def make(number: int) -> tuple[Correction, dict[str, Any]]:
            other.start()
            other.join(0.2)
            (read,) = mine.objects(ids=["o1"])
            order.append("correction")
            correction = Correction(number, "teach", "o1 is it", None, {"ids": ["o1"]})
            return correction, {"objects": [replace(read, names=(TaughtName("it", None),))]}

        teaching.commit(mine, make)
        other.join()
        assert order == ["correction", "another"]
        teaching.teach_name(mine, "o1", "cup", "me")
        (cup,) = mine.objects(ids=["o1"])
    assert (cup.weight, cup.names) == (100.0, (TaughtName("cup", "me"),))


def test_pictures_that_only_an_undo_needs_are_kept_for_it() -> None:
    store = home()
    store.apply(Batch(removed_encounters=[("o2", "o3", 0, 0, at(31))]))
    before = content(store)
    teaching.merge(store, "o1", "o2")
    needed = History.read(store).pictures()
    assert needed == {"blue2"}
    assert store.collect_keyframes(sorted(needed)) == 0
    teaching.undo(store)
    assert content(store) == before
    teaching.merge(store, "o1", "o2")
    assert store.collect_keyframes() == 1  # by somebody who does not know that it is needed
    teaching.undo(store)
    assert store.check() == []
    assert store.sightings(object_ids=["o2"])[0].image is None
