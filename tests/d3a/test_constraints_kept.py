"""Later ingests keep what people said, and undo knows whose the later views are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from d3a import teaching
from d3a.constraints import HISTORY, SAID, Constraints, History
from d3a.ingest import ingest
from d3a.model import BadInput, Detection, Frame, Json, Pose
from d3a.parameters import PROFILES, Parameters
from d3a.readers.base import RecordingFacts, Regions
from d3a.store.base import Store
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import (
    CAMERA,
    FORWARD,
    START_MS,
    ListReader,
    Thing,
    colour,
    depth_png,
    rounds,
)

LEFT, RIGHT, FAR = (0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (2.0, 4.0, 0.0)


def numbers(profile: str, **changes: object) -> Parameters:
    return PROFILES[profile].with_changes(checkpoint_frames=10, interval_gap_s=30.0, **changes)


def world(*things: Thing, frames: int = 90) -> list[Frame]:
    return rounds(things, frames, 1, noise_m=0.05, missed=0.1)


def utc(milliseconds: int) -> datetime:
    return datetime.fromtimestamp(milliseconds / 1000, UTC)


def put(store: Store, frames: Sequence[Frame], parameters: Parameters) -> None:
    ingest(ListReader(frames), store, parameters)


def seen_at(store: Store, x: float, y: float) -> list[tuple[str, int]]:
    """Whose stays are within half a metre of a point, and how much was seen of each."""
    return [
        (stay.object_id, stay.seen)
        for stay in store.stays()
        if stay.position is not None and abs(stay.position[0] - x) + abs(stay.position[1] - y) < 0.5
    ]


def in_turn() -> list[Frame]:
    """A cup at the left, then a bowl at the right, then each again: never both in a frame."""
    turns = [(0, 20), (20, 45), (45, 65), (65, 90)]
    things = [
        Thing(*(("bowl", RIGHT, 5) if n % 2 else ("cup", LEFT, 1)), since=since, until=until)
        for n, (since, until) in enumerate(turns)
    ]
    return world(*things)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_what_was_made_one_stays_one_however_it_looks(profile: str) -> None:
    # two looks and two names: the association would never take them for one thing
    frames = in_turn()
    store = OracleStore()
    put(store, frames[:45], numbers(profile))
    (a, before), (b, also) = seen_at(store, *LEFT[:2])[0], seen_at(store, *RIGHT[:2])[0]
    assert a != b
    teaching.merge(store, a, b)
    put(store, frames, numbers(profile))
    assert [r.object_id for r in store.objects()] == [a]
    assert len(store.stays(object_ids=[a])) == 2
    ((one, left),), ((other, right),) = seen_at(store, *LEFT[:2]), seen_at(store, *RIGHT[:2])
    assert one == other == a
    assert left > before
    assert right > also
    assert store.check() == []


def test_without_the_constraint_the_paper_takes_them_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(History, "constraints", lambda _: Constraints())
    frames = in_turn()
    store = OracleStore()
    put(store, frames[:45], numbers("paper"))
    (a, _), (b, _) = seen_at(store, *LEFT[:2])[0], seen_at(store, *RIGHT[:2])[0]
    teaching.merge(store, a, b)
    put(store, frames, numbers("paper"))
    assert len(store.objects()) == 2


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_undoing_it_after_more_was_seen_gives_each_its_own_views(profile: str) -> None:
    frames = in_turn()
    alone = OracleStore()
    put(alone, frames[:45], numbers(profile))
    put(alone, frames, numbers(profile))
    store = OracleStore()
    put(store, frames[:45], numbers(profile))
    (a, _), (b, _) = seen_at(store, *LEFT[:2])[0], seen_at(store, *RIGHT[:2])[0]
    teaching.merge(store, a, b)
    put(store, frames, numbers(profile))
    teaching.undo(store)
    assert store.check() == []
    assert [r.object_id for r in store.objects()] == [r.object_id for r in alone.objects()]
    for record in alone.objects():
        (mine,) = store.objects(ids=[record.object_id])
        assert mine.category == record.category
        assert mine.weight == pytest.approx(record.weight)
        (stay,) = store.stays(object_ids=[record.object_id])
        (wanted,) = alone.stays(object_ids=[record.object_id])
        assert (stay.seen, stay.first_ms, stay.last_ms) == (
            wanted.seen,
            wanted.first_ms,
            wanted.last_ms,
        )
    assert store.sightings() == alone.sightings()


def paper_split() -> tuple[OracleStore, str, str, list[Frame]]:
    """One cup at two places, by the paper; a person says that there are two."""
    frames = world(Thing("cup", LEFT, 1), Thing("cup", FAR, 1))
    store = OracleStore()
    put(store, frames[:45], numbers("paper"))
    (whole,) = store.objects()
    said = teaching.split(store, whole.object_id, store.stays()[1].place)
    return store, whole.object_id, said.arguments["new"], frames


def test_what_was_split_is_not_made_one_again_by_the_paper() -> None:
    store, whole, new, frames = paper_split()
    put(store, frames, numbers("paper"))
    assert {r.object_id for r in store.objects()} == {whole, new}
    at_far, at_left = seen_at(store, *FAR[:2]), seen_at(store, *LEFT[:2])
    assert {at_far[0][0], at_left[0][0]} == {whole, new}
    assert len(at_far) == len(at_left) == 1
    teaching.undo(store)
    assert [r.object_id for r in store.objects()] == [whole]
    assert sum(s.seen for s in store.stays()) == at_far[0][1] + at_left[0][1]
    assert store.check() == []


def swapped() -> tuple[OracleStore, Parameters, list[Frame], datetime]:
    """Two cups that change places in a pause; their looks say nothing to the association."""
    things = [
        Thing("cup", *each)
        for each in ((LEFT, 1, 0, 45), (RIGHT, 2, 0, 45), (RIGHT, 1, 45, 90), (LEFT, 2, 45, 90))
    ]
    blind = numbers("default", look_most=0.0, look_least=0.0, max_interval_s=300.0)
    frames = world(*things)
    store = OracleStore()
    put(store, frames[:70], blind)
    return store, blind, frames, datetime.fromtimestamp(frames[45].time_ms / 1000, UTC)


def test_a_person_tells_that_two_things_changed_places() -> None:
    """Each place is the other one's from then on; later views go to who is there by now."""
    store, blind, frames, since = swapped()
    (a, _), (b, _) = *seen_at(store, *LEFT[:2]), *seen_at(store, *RIGHT[:2])
    at_left = teaching.split(store, a, 0, since=since).arguments["new"]
    at_right = teaching.split(store, b, 0, since=since).arguments["new"]
    assert store.check() == []
    first, later = store.stays(object_ids=[a, at_left])
    assert first.last_ms < frames[45].time_ms <= later.first_ms == first.last_absent_ms
    assert first.position == later.position
    teaching.merge(store, a, at_right)
    teaching.merge(store, b, at_left)
    before = {stay.key: stay.seen for stay in store.stays()}
    put(store, frames, blind)
    assert store.check() == []
    assert {r.object_id for r in store.objects()} == {a, b}
    grown = {s.key for s in store.stays() if s.seen > before[s.key]}
    assert grown == {(a, 1), (b, 1)}
    (now_left,) = (s for s in store.stays() if s.key == (b, 1))
    assert now_left.position == pytest.approx(LEFT, abs=0.2)
    while teaching.history(store):
        teaching.undo(store)
        assert store.check() == []
    assert {r.object_id for r in store.objects()} == {a, b}
    assert {stay.key for stay in store.stays()} == {(a, 0), (b, 0)}


def test_a_time_that_parts_nothing_is_refused_and_the_times_told() -> None:
    store, _, frames, _ = swapped()
    (a, seen), *_ = seen_at(store, *LEFT[:2])
    (stay,) = store.stays(object_ids=[a])
    span = " to ".join(
        utc(ms).isoformat(timespec="seconds") for ms in (stay.first_ms, stay.last_ms)
    )
    for at, rest in (
        (frames[0].time_ms, "since .*: a later time would do"),
        (frames[-1].time_ms + 1, "before .*: an earlier time would do"),
    ):
        said = f"{a} was seen at place 0 from {re.escape(span)}, all of it {rest}"
        with pytest.raises(BadInput, match=said):
            teaching.split(store, a, 0, since=utc(at))
    assert seen_at(store, *LEFT[:2]) == [(a, seen)]
    once = OracleStore()
    put(once, world(Thing("cup", LEFT, 1), frames=1), numbers("default"))
    with pytest.raises(BadInput, match=r"o1 was seen at place 0 at .* alone: there is nothing"):
        teaching.split(once, "o1", 0, since=utc(frames[0].time_ms))


@pytest.mark.parametrize("at", [1, 30, 69])
def test_a_thing_is_another_from_a_moment_within_one_interval_on(at: int) -> None:
    """The picture stays with the part of its time; views to come give the other one its own."""
    frames = [
        replace(frame, image=np.full((48, 64, 3), 90, np.uint8))
        for frame in world(Thing("cup", LEFT, 1), frames=90)
    ]
    long = numbers("default", max_interval_s=3600.0).with_changes(interval_gap_s=600.0)
    store = OracleStore()
    put(store, frames[:70], long)
    ((a, count),) = seen_at(store, *LEFT[:2])
    (whole,) = store.sightings(object_ids=[a])
    before = [record for record in store.dump() if record.get("key") not in (HISTORY, SAID)]
    new = teaching.split(store, a, 0, since=utc(frames[at].time_ms)).arguments["new"]
    assert store.check() == []
    (first,), (then,) = (store.sightings(object_ids=[each]) for each in (a, new))
    assert (first.start_ms, first.end_ms) == (whole.start_ms, frames[at].time_ms - 1)
    assert (then.start_ms, then.end_ms) == (frames[at].time_ms, whole.end_ms)
    assert first.seen + then.seen == whole.seen == count
    pictured, other = (first, then) if first.image else (then, first)
    assert (pictured.image, pictured.frame, other.image) == (whole.image, whole.frame, None)
    assert other.frame != whole.frame, "no question takes the two for shown together"
    teaching.undo(store)
    assert [r for r in store.dump() if r.get("key") not in (HISTORY, SAID)] == before
    teaching.split(store, a, 0, since=utc(frames[at].time_ms))
    put(store, frames, long)
    assert store.check() == []
    newest = max(store.sightings(), key=lambda seen: seen.end_ms)
    assert newest.end_ms == frames[89].time_ms
    assert newest.image is not None


def moving() -> list[Frame]:
    """A cup that is moved: seen, then its place seen empty, then seen a little aside; twice."""
    here = Detection("cup", 0.9, (14, 20, 22, 28), embedding=colour(1))
    moved = Detection("cup", 0.9, (44, 20, 52, 28), embedding=colour(1))
    empty = [(None, 4.5)] * 12
    shown = [(here, 3.0)] * 12 + empty + [(moved, 3.0)] * 12 + empty + [(moved, 3.0)] * 24
    return [looking(n, each, away_m) for n, (each, away_m) in enumerate(shown)]


def looking(n: int, detection: Detection | None, away_m: float) -> Frame:
    """A look from the same place with a turn away in between, so that each frame is a look."""
    pose = Pose((0.0, 9.0 * (n % 2), 0.0), FORWARD, tuple((np.eye(6) * 1e-4).ravel().tolist()))
    seen = () if n % 2 or detection is None else (detection,)
    depth = depth_png(away_m)
    return Frame(f"f{n}", START_MS + n * 60_000, pose, CAMERA, None, depth, seen)


@pytest.mark.parametrize("kept", [True, False])
def test_what_was_split_is_not_linked_as_a_move_again(
    kept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not kept:  # what the association would do by itself
        monkeypatch.setattr(History, "constraints", lambda _: Constraints())
    frames = moving()
    credulous = PROFILES["default"].with_changes(plain_odds=-9.0, move_odds=9.0)
    store = OracleStore()
    ingest(ListReader(frames), store, credulous, max_frames=36)
    (linked,) = store.objects()
    assert len(store.stays()) == 2
    new = teaching.split(store, linked.object_id, 1).arguments["new"]
    put(store, frames, credulous)
    assert {r.object_id for r in store.objects()} == ({"o1", new} if kept else {"o1"})
    assert store.check() == []


def test_an_ingest_that_is_interrupted_after_a_correction_ends_the_same() -> None:
    frames = world(Thing("cup", LEFT, 1), Thing("cup", RIGHT, 1), Thing("bowl", FAR, 3))
    parameters = numbers("default", stm_capacity=2)

    def filled(stops: Sequence[int]) -> list[Json]:
        store = OracleStore()
        ingest(ListReader(frames), store, parameters, max_frames=30)
        cups = [r.object_id for r in store.objects(categories=["cup"])]
        teaching.merge(store, cups[0], cups[1], force=True)
        done = 30
        for stop in stops:
            ingest(ListReader(frames), store, parameters, max_frames=stop - done)
            done = stop
        put(store, frames, parameters)
        return list(store.dump())

    whole = filled([])
    for stops in ([31], [35, 36, 50], [89]):
        assert filled(stops) == whole


def test_a_room_that_was_taken_away_does_not_come_back_with_the_next_recording() -> None:
    frames = world(Thing("cup", LEFT, 1), frames=20)
    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    facts = RecordingFacts(
        "one", zone="UTC", regions=Regions((("Kitchen", square), ("hall", square)))
    )
    store = OracleStore()
    ingest(ListReader(frames, facts), store, numbers("default"))
    teaching.rename_place(store, "kitchen", "galley")
    teaching.remove_place(store, "hall")
    later = [replace(f, name=f"x{f.name}", time_ms=f.time_ms + 10**7) for f in frames]
    ingest(ListReader(later, replace(facts, name="two")), store, numbers("default"))
    assert [region.name for region in store.regions()] == ["galley"]
    teaching.undo(store)
    ingest(ListReader(later[:1], replace(facts, name="three")), store, numbers("default"))
    assert [region.name for region in store.regions()] == ["galley", "hall"]


def test_names_stay_with_what_they_were_given_to_through_later_ingests() -> None:
    frames = in_turn()
    store = OracleStore()
    put(store, frames[:45], numbers("default"))
    (left, _), (right, _) = seen_at(store, *LEFT[:2])[0], seen_at(store, *RIGHT[:2])[0]
    teaching.teach_name(store, left, "cup", "me")
    teaching.merge(store, right, left)
    put(store, frames, numbers("default"))
    (cup,) = store.objects()
    assert [(n.word, n.owner) for n in cup.names] == [("cup", "me")]
    teaching.undo(store)
    named = {r.object_id: r.names for r in store.objects()}
    assert [n.owner for n in named[left]] == ["me"]
    assert named[right] == ()
