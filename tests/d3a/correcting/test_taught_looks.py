"""A thing shown by a box: found by its colours, told as a look-alike, and taken back whole."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from d3a import images, teaching
from d3a.answer import is_by_look
from d3a.constraints import HISTORY, SAID, Correction
from d3a.correcting.corrections import UnknownThing
from d3a.correcting.forgetting import forget, plan_forgetting
from d3a.correcting.forgotten import Selection
from d3a.correcting.look_search import Look, search
from d3a.correcting.taught_looks import search_later, teach_look
from d3a.ingest import ingest
from d3a.ingesting.live import Live
from d3a.model import BadInput, Box, Frame, Json
from d3a.parameters import PROFILES
from d3a.readers.base import RecordingFacts
from d3a.store.base import (
    Batch,
    Keyframe,
    ObjectRecord,
    Sighting,
    StayRecord,
    Store,
    TaughtName,
)
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, rounds

WIDTH, HEIGHT = 240, 160
SIZE = 40
GADGET = ((220, 40, 180), (30, 220, 210))
"""Two colours that the rooms do not have: a thing half and half."""
TABLE: Box = (10.0, 100.0, 90.0, 150.0)
PLACES = {"p0": (60, 50), "p1": (150, 90), "p2": None, "p3": (20, 20), "p4": None, "p5": None}


def room(seed: int, at: tuple[int, int] | None, *, colours: tuple[tuple[int, ...], ...]) -> bytes:
    """Return a picture of grainy browns and greys, with the thing where it is."""
    rng = np.random.default_rng(seed)
    pixels = np.full((HEIGHT, WIDTH, 3), (150, 130, 110), dtype=np.float64)
    pixels[: HEIGHT // 3] = (190, 190, 200)
    for _ in range(12):  # furniture
        x, y = rng.integers(0, WIDTH - 30), rng.integers(0, HEIGHT - 20)
        pixels[y : y + 20, x : x + 30] = rng.integers(60, 200) * np.array([1.0, 0.9, 0.8])
    if at is not None:
        left, top = at
        pixels[top : top + SIZE // 2, left : left + SIZE] = colours[0]
        pixels[top + SIZE // 2 : top + SIZE, left : left + SIZE] = colours[1]
    noisy = np.clip(pixels + rng.normal(0, 4, pixels.shape), 0, 255).astype(np.uint8)
    return images.encode(noisy, max(WIDTH, HEIGHT), 90)


def fill(store: Store, *, colours: tuple[tuple[int, ...], ...] = GADGET, scale: int = 1) -> Store:
    """A table seen in each picture, a minute apart; boxes are of frames `scale` times larger."""
    box: Box = tuple(scale * v for v in TABLE)  # type: ignore[assignment]  # four of them
    start, end = 0, 60_000 * (len(PLACES) - 1)
    keyframes, sightings = [], []
    for n, (key, at) in enumerate(PLACES.items()):
        jpeg = room(n, at, colours=colours)
        keyframes.append(Keyframe(key, jpeg, WIDTH * scale, HEIGHT * scale, 60_000 * n))
        sightings.append(
            Sighting("t", 0, 60_000 * n, 60_000 * n, f"f{n}", 0.9, box, key, category="table")
        )
    store.apply(
        Batch(
            objects=[ObjectRecord("t", "table", 6.0, start, end)],
            stays=[StayRecord("t", 0, (1.0, 2.0, 0.7), start, end, 6.0, seen=6)],
            sightings=sightings,
            keyframes=keyframes,
        )
    )
    return store


def box_at(place: tuple[int, int], scale: int = 1) -> Box:
    x, y = place
    return (x * scale, y * scale, (x + SIZE) * scale, (y + SIZE) * scale)


def content(store: Store) -> list[Json]:
    return [r for r in store.dump() if r.get("key") not in (HISTORY, SAID)]


def overlap(a: Box, b: Box) -> float:
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return width * height / max((a[2] - a[0]) * (a[3] - a[1]), (b[2] - b[0]) * (b[3] - b[1]))


@pytest.mark.parametrize("scale", [1, 4])
def test_it_is_found_where_it_is_and_nowhere_else(scale: int) -> None:
    """The store may hold a smaller picture than the frame that boxes are told in."""
    finds = search(fill(OracleStore(), scale=scale), "p0", box_at((60, 50), scale))[1]
    assert [find.image for find in finds[:1]] == ["p0"]
    assert sorted(find.image for find in finds[1:]) == ["p1", "p3"]
    for find in finds[1:]:
        place = PLACES[find.image]
        assert place is not None
        assert overlap(find.box, box_at(place, scale)) > 0.6


def test_it_is_a_thing_of_the_store_on_every_store(make_store: Callable[[], Store]) -> None:
    store = fill(make_store())
    before = content(store)
    done = teach_look(store, "p0", box_at((60, 50)), "Gadget", "me", at_ms=5)
    assert done.arguments["found"] == 3
    [thing] = store.objects(names=["gadget"])
    assert is_by_look(thing.object_id)
    assert not is_by_look("t")
    assert thing.names == (TaughtName("gadget", "me"),)
    [stay] = store.stays(object_ids=[thing.object_id])
    assert stay.position == (1.0, 2.0, 0.7)  # that of the table, the nearest thing
    assert stay.covariance is not None
    assert not stay.tentative  # the person showed one there
    seen = store.sightings(object_ids=[thing.object_id])
    assert [(s.image, s.start_ms, s.frame) for s in seen] == [
        ("p0", 0, "f0"), ("p1", 60_000, "f1"), ("p3", 180_000, "f3"),
    ]  # fmt: skip
    assert seen[0].probability == 1.0
    assert all(0.0 < s.probability <= 1.0 for s in seen)
    assert store.check() == []
    assert "shown by a box" in teaching.undo(store).said
    assert content(store) == before
    store.close()


def test_the_colours_of_the_room_are_no_look() -> None:
    store = fill(OracleStore())
    with pytest.raises(BadInput, match="colours of what is around it"):
        search(store, "p2", (100, 100, 140, 140))


def test_a_look_that_is_everywhere_finds_no_more_than_chance() -> None:
    """Two things of the same colours in each picture: neither is told from the other."""
    store = fill(OracleStore())
    doubled = []
    for n, key in enumerate(PLACES):
        pixels = images.decode(room(n, (30, 30), colours=GADGET)).copy()
        pixels[90:130, 150:190] = pixels[30:70, 30:70]
        jpeg = images.encode(pixels, WIDTH, 90)
        doubled.append(Keyframe(key, jpeg, WIDTH, HEIGHT, 60_000 * n))
    store.apply(Batch(keyframes=doubled))
    assert len(search(store, "p0", box_at((30, 30)))[1]) <= 2


@pytest.mark.parametrize(
    ("box", "words"),
    [
        ((10, 10, 12, 12), "too small"),
        ((10, 10, 10, 20), "must lie in the picture"),
        ((-1, 0, 20, 20), "must lie in the picture"),
        ((0, 0, WIDTH + 1, 20), "must lie in the picture"),
        ((0, 0, float("nan"), 20), "must lie in the picture"),
    ],
)
def test_a_box_that_cannot_be_meant_is_refused(box: Box, words: str) -> None:
    store = fill(OracleStore())
    before = content(store)
    with pytest.raises(BadInput, match=words):
        teach_look(store, "p0", box, "gadget")
    assert content(store) == before


def test_a_picture_that_is_not_there_is_unknown_and_a_name_is_needed() -> None:
    store = fill(OracleStore())
    with pytest.raises(UnknownThing, match="no picture"):
        teach_look(store, "p9", box_at((60, 50)), "gadget")
    with pytest.raises(BadInput, match="name"):
        teach_look(store, "p0", box_at((60, 50)), "  ")


def test_damaged_pictures_are_left_out() -> None:
    store = fill(OracleStore())
    whole = store.keyframe("p1")
    assert whole is not None
    store.apply(Batch(keyframes=[Keyframe("p1", whole.jpeg[:200], WIDTH, HEIGHT, 60_000)]))
    assert [f.image for f in search(store, "p0", box_at((60, 50)))[1]] == ["p0", "p3"]
    with pytest.raises(BadInput, match="damaged"):
        search(store, "p1", box_at((150, 90)))


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_a_later_recording_keeps_it(profile: str) -> None:
    """The thing stays what it was named, and nothing that is detected since becomes part of it."""
    things = [Thing("cup", circle(1.5, 8)[0], 0, since=0, until=10**9)]
    frames = rounds(things, 80, 3, noise_m=0.05, missed=0.1)
    store = OracleStore()
    ingest(ListReader(frames[:40]), store, PROFILES[profile])
    jpeg = room(0, (60, 50), colours=GADGET)
    store.apply(Batch(keyframes=[Keyframe("p0", jpeg, WIDTH, HEIGHT, frames[39].time_ms)]))
    done = teach_look(store, "p0", box_at((60, 50)), "gadget", "me")
    before = [r for r in store.dump() if r.get("object_id") == done.arguments["new"]]
    second = RecordingFacts("second", zone="UTC")
    ingest(ListReader(frames[40:], second), store, PROFILES[profile])
    after = [r for r in store.dump() if r.get("object_id") == done.arguments["new"]]
    assert len(before) == 3  # object, stay, sighting
    assert after == before
    assert store.check() == []
    teaching.undo(store)
    assert not [r for r in store.dump() if r.get("object_id") == done.arguments["new"]]
    assert store.check() == []


SHOWN = {13: (150, 90), 16: (20, 20), 19: (100, 60)}
"""Where the thing is in frames of the second recording."""
FLEETING = PROFILES["default"].with_changes(interval_gap_s=0.1, checkpoint_frames=3)
"""Each frame is an interval of its own, so that each picture is kept."""


def recorded() -> list[Frame]:
    """Return 24 frames with pictures: the thing is in the first, and in those of SHOWN."""
    frames = rounds([Thing("cup", circle(1.5, 8)[0], 0, since=0, until=10**9)], 24, 3, missed=0)
    places = {0: (60, 50)} | SHOWN
    return [
        replace(frame, image=room(n, places.get(n), colours=GADGET))
        for n, frame in enumerate(frames)
    ]


def taught(store: Store) -> tuple[list[Frame], Correction]:
    """Fill a store with the first half, and teach the thing in its first picture."""
    frames = recorded()
    ingest(ListReader(frames[:12]), store, FLEETING)
    key = f"{store.recordings()[0].name}/{frames[0].name}"
    return frames, teach_look(store, key, box_at((60, 50)), "gadget", "me")


SECOND = RecordingFacts("second", zone="UTC")


def seen(store: Store, done: Correction) -> list[str | None]:
    return [s.image for s in store.sightings(object_ids=[done.arguments["new"]])]


def test_pictures_that_come_later_are_searched_too(make_store: Callable[[], Store]) -> None:
    with closing(make_store()) as store:
        frames, done = taught(store)
        assert len(seen(store, done)) == 1
        ingest(ListReader(frames[12:], SECOND), store, FLEETING)
        assert seen(store, done)[1:] == [f"second/{frames[n].name}" for n in SHOWN]
        for sighting, at in zip(
            store.sightings(object_ids=[done.arguments["new"]])[1:], SHOWN.values(), strict=True
        ):
            assert sighting.box == pytest.approx(box_at(at), abs=12)
        (thing,) = store.objects(ids=[done.arguments["new"]])
        assert thing.last_ms == frames[max(SHOWN)].time_ms
        assert {s.tentative for s in store.stays(object_ids=[thing.object_id])} == {False}
        assert store.check() == []
        content = [r for r in store.dump() if r.get("key") != HISTORY]
        assert ingest(ListReader(frames[12:], SECOND), store, FLEETING).already
        assert [r for r in store.dump() if r.get("key") != HISTORY] == content, "searched once"
        teaching.undo(store)
        assert not [r for r in store.dump() if str(r.get("key")).startswith("look:")]
        assert seen(store, done) == []
        assert store.check() == []


def test_an_ingest_in_parts_finds_what_a_whole_one_does() -> None:
    stores = []
    for cuts in ([None], [5, None], [1, 1, 4, None]):
        store = OracleStore()
        frames, _ = taught(store)
        for cut in cuts:
            ingest(ListReader(frames[12:], SECOND), store, FLEETING, max_frames=cut)
        stores.append(list(store.dump()))
    assert stores[0] == stores[1] == stores[2]


def test_a_watch_searches_as_it_goes_a_few_pictures_at_a_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole, store = OracleStore(), OracleStore()
    frames, done = taught(whole)
    ingest(ListReader(frames[12:], SECOND), whole, FLEETING)
    taught(store)
    searched: list[int] = []

    def noting(*args: Any) -> int:
        found: int = search_later(*args)
        searched.append(len(seen(store, done)))
        return found

    monkeypatch.setattr("d3a.ingest.search_later", noting)
    monkeypatch.setattr("d3a.ingest.PICTURES_A_CHECKPOINT", 2)
    ingest(ListReader(frames[12:], SECOND), store, FLEETING, live=Live(0.0))
    assert len(searched) > 5
    assert {1, 2, 3, 4} <= set(searched), "found as it went"
    assert seen(store, done) == seen(whole, done)


def test_a_look_is_not_searched_for_once_it_is_forgotten_or_undone() -> None:
    store = OracleStore()
    frames, done = taught(store)
    forget(store, plan_forgetting(store, Selection(object_ids=frozenset({done.arguments["new"]}))))
    assert "look:" not in "".join(str(r.get("key")) for r in store.dump())
    ingest(ListReader(frames[12:], SECOND), store, FLEETING)
    assert seen(store, done) == []
    assert store.check() == []


def test_a_look_read_back_is_the_very_same() -> None:
    look, _ = search(fill(OracleStore()), "p0", box_at((60, 50)))
    again = Look.of_json(json.loads(json.dumps(look.to_json())))
    for name in ("shares", "colours", "worth", "wanted"):
        assert np.array_equal(getattr(look, name), getattr(again, name))
    assert (look.size, look.step, look.level) == (again.size, again.step, again.level)
