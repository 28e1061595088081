from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.model import Detection, Frame, Pose
from d3a.parameters import DEFAULT, Parameters
from d3a.tracking.moves import Link, Moves
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


def filled(frames: Sequence[Frame], parameters: Parameters = DEFAULT) -> OracleStore:
    store = OracleStore()
    ingest(ListReader(frames), store, parameters)
    return store


def single(
    number: int, *detections: Detection, step_s: float = 60.0, pose: Pose | None = None
) -> Frame:
    time_ms = START_MS + round(number * step_s * 1000)
    return Frame(f"f{number}", time_ms, pose, CAMERA, None, None, detections)


def cup(
    x: float | None = None, look: int | None = 1, category: str = "cup", left: float = 0.0
) -> Detection:
    position = None if x is None else (x, 0.0, 0.0)
    embedding = None if look is None else colour(look)
    box = (left, 0.0, left + 5, 5.0)
    return Detection(category, 0.8, box, position=position, embedding=embedding)


def test_things_apart_are_told_apart_and_found_again() -> None:
    things = [
        Thing("cup", (0, 0, 0), 1),
        Thing("cup", (0, 2.5, 0), 2),
        Thing("bowl", (0, 0.7, 0), 3),
    ]
    store = filled(rounds(things, 60))
    assert not any(record.tentative for record in store.objects())
    assert Counter(r.category for r in store.objects()) == {"cup": 2, "bowl": 1}
    for thing in things:
        near = [np.linalg.norm(np.array(stay.position) - thing.position) for stay in store.stays()]
        assert min(near) < 0.1


def test_one_sighting_is_tentative_and_the_second_ever_confirms() -> None:
    first = single(0, cup(1.0))
    (record,) = filled([first]).objects()
    assert record.tentative
    (record,) = filled([first, single(60 * 24, cup(1.0))]).objects()
    assert not record.tentative


def test_two_look_alikes_in_one_frame_are_two() -> None:
    frames = [single(n, cup(1.0), cup(1.3, left=20)) for n in range(6)]
    assert len(filled(frames).objects()) == 2


def test_where_positions_are_useless_look_and_category_decide() -> None:
    """One position for all, metres off: the gate follows the covariance."""
    wide = tuple((np.eye(3) * 4.0).ravel().tolist())

    def vague(x: float, look: int, left: float) -> Detection:
        return Detection(
            "cup", 0.9, (left, 0, left + 5, 5), (x, 0.0, 0.0), wide, embedding=colour(look)
        )

    offsets = [0.0, 1.5, -1.0, 3.0, 0.5, -2.0]
    frames = [single(n, vague(x, 1, 0), vague(x, 2, 20)) for n, x in enumerate(offsets)]
    store = filled(frames)
    assert len(store.objects()) == 2
    assert sorted(stay.seen for stay in store.stays()) == [6, 6]


def test_without_any_position_look_and_category_decide() -> None:
    frames = [single(n, cup(look=1), cup(look=2, left=20)) for n in range(5)]
    store = filled(frames)
    assert len(store.objects()) == 2
    assert all(stay.position is None for stay in store.stays())


def test_a_thing_without_a_picture_is_matched_by_place_and_category() -> None:
    frames = [single(n, cup(1.0, None), cup(4.0, None, left=20)) for n in range(5)]
    assert sorted(stay.seen for stay in filled(frames).stays()) == [5, 5]


def test_a_wrong_category_now_and_then_is_outvoted() -> None:
    names = ["cup", "cup", "bowl", "cup", "cup"]
    frames = [single(n, cup(1.0, category=name)) for n, name in enumerate(names)]
    (record,) = filled(frames).objects()
    assert record.category == "cup"
    assert dict(record.categories) == pytest.approx({"cup": 3.2, "bowl": 0.8})


SIDE_BY_SIDE = {"key": (0.0, 0.0, 0.0), "cup": (0.25, 0.0, 0.0)}
"""Small things on one table: their boxes are mostly table, so they look much alike."""


def on_table(n: int, *names: str, sure: float = 0.9) -> Frame:
    """A frame with some of the things; each is measured with an error of its own."""
    found = []
    for name in names:
        wobble = np.random.default_rng([n, len(name)]).normal(0, 0.08, 3)
        x, y, z = np.array(SIDE_BY_SIDE[name]) + wobble
        look = colour(7) + 0.3 * colour(1 if name == "cup" else 2)
        left = 10.0 if name == "key" else 30.0
        found.append(
            Detection(
                name, sure, (left, 10, left + 8, 18), (x, y, z),
                embedding=(look / np.linalg.norm(look)).astype(np.float32),
            )
        )  # fmt: skip
    return single(n, *found, pose=Pose((-2.0, 0.0, 0.0), FORWARD))


SEEN_IN_TURN = [("cup",), ("key",)] * 6
SEEN_TOGETHER = [("cup", "key")] * 6


@pytest.mark.parametrize(
    "shown",
    [
        SEEN_IN_TURN,
        SEEN_TOGETHER,
        SEEN_IN_TURN + SEEN_TOGETHER,
        SEEN_TOGETHER + SEEN_IN_TURN,
        [("cup",)] * 12 + [("key",)] * 12,
    ],
    ids=["in turn", "together", "in turn, then together", "together, then in turn", "one by one"],
)
@pytest.mark.parametrize("sure", [0.7, 0.99])
def test_things_side_by_side_keep_their_own_names(
    shown: list[tuple[str, ...]], sure: float
) -> None:
    store = filled([on_table(n, *names, sure=sure) for n, names in enumerate(shown)])
    for record in store.objects():
        assert [name for name, _ in record.categories] == [record.category]
    assert Counter(r.category for r in store.objects()) == {"cup": 1, "key": 1}


def test_a_doubtful_name_at_the_very_place_is_a_wrong_name() -> None:
    frames = [on_table(n, "cup") for n in range(12)]
    (cup_again,) = on_table(12, "cup").detections or ()
    doubtful = replace(cup_again, category="vase", probability=0.5)
    (record,) = filled([*frames, single(12, doubtful, pose=frames[0].pose)]).objects()
    assert dict(record.categories)["vase"] == 0.5


def test_another_thing_of_the_kind_on_the_same_spot_is_known_by_its_look() -> None:
    """A pink cup stands where a blue one stood: place and name agree, and are outvoted."""
    frames = [
        single(n, cup(1.0, 1), cup(2.0, 2, left=20), cup(4.0, 3, left=40)) for n in range(120)
    ]
    frames += [single(n, cup(1.0, 4), cup(2.0, 2, left=20)) for n in range(120, 126)]
    assert sorted(stay.seen for stay in filled(frames).stays()) == [6, 120, 120, 126]


def test_a_common_drift_is_taken_out() -> None:
    """All things of a frame are off by the same 0.35 m: they are recognised together."""
    rng = np.random.default_rng(1)
    places = [0.0, 1.1, 2.6, 4.3]
    frames = []
    for n in range(40):
        off = 0.35 * np.sign(np.sin(n)) * np.array([1.0, 0, 0])
        pose = Pose((-2.0 + off[0], 0, 0), FORWARD)
        found = [cup(x + off[0] + rng.normal(0, 0.03), None, left=5 * x) for x in places]
        frames.append(single(n, *found, pose=pose))
    store = filled(frames)
    assert sorted(stay.seen for stay in store.stays()) == [40] * 4


def test_shared_frames_become_encounters() -> None:
    frames = [single(n, cup(1.0), cup(1.3, 2, "bowl", left=20), step_s=5) for n in range(6)]
    (encounter,) = filled(frames).encounters()
    assert (encounter.object_a, encounter.object_b) == ("o1", "o2")
    assert encounter.seen == 6
    assert encounter.box_a != encounter.box_b
    assert encounter.apart is not None
    assert encounter.apart[:3] == pytest.approx((-0.3, 0.0, 0.0))  # from the bowl to the cup


def test_an_interval_keeps_its_best_frame_and_closes_after_a_pause() -> None:
    frames = [single(n, cup(1.0), step_s=60) for n in (0, 1, 2, 60, 61)]
    first, second = filled(frames).sightings()
    assert (first.seen, second.seen) == (3, 2)
    assert first.end_ms - first.start_ms == 120_000


def test_a_longer_pause_closes_an_interval_only_where_a_look_saw_it_gone() -> None:
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    before = [looking(n, there, away_m=2.0) for n in range(12)]
    away = [looking(n, away_m=4.0) for n in range(12, 30)]
    again = [looking(n, there, away_m=2.0) for n in range(30, 36)]
    (whole,) = filled([*before, *again]).sightings()
    assert whole.seen == 9
    first, second = filled([*before, *away, *again]).sightings()
    assert (first.seen, second.seen) == (6, 3)


def test_what_depth_contradicts_is_dropped_unless_it_is_seen_again() -> None:
    """A detector's mistake in mid-air; what is flat is contradicted too, but it is there again."""
    ghost = Detection("cup", 0.9, (28, 20, 36, 28), position=(2.0, 0.0, 0.0), embedding=colour(1))
    elsewhere = replace(looking(2, away_m=4.0), pose=Pose((0.0, 40.0, 0.0), FORWARD))
    later = [replace(elsewhere, name=f"e{n}", time_ms=START_MS + n * 60_000) for n in range(2, 20)]
    once = [looking(0, ghost, away_m=4.0), *later]
    assert filled(once).objects() == []
    (kept,) = filled([looking(0, ghost, away_m=2.0), *later]).objects()
    assert kept.tentative
    second = replace(looking(0, ghost, away_m=4.0), name="again", time_ms=START_MS + 1000)
    (kept,) = filled([once[0], second, *later]).objects()
    assert not kept.tentative


def test_an_interval_is_split_and_can_be_joined_again() -> None:
    store = filled([single(n, cup(1.0), step_s=300) for n in range(30)])
    sightings = store.sightings()
    assert len(sightings) == 3
    for one, next_one in pairwise(sightings):
        assert next_one.start_ms - one.end_ms == 1
    assert sum(sighting.seen for sighting in sightings) == 30


def test_after_a_bridged_pause_what_is_too_long_begins_at_its_own_first_view() -> None:
    frames = [single(n, cup(1.0), step_s=60) for n in (0, 1, 41, 81, 82, 100)]
    first, second = filled(frames).sightings()
    assert (first.seen, second.seen) == (3, 3)
    assert first.end_ms - START_MS == 41 * 60_000
    assert second.start_ms - START_MS == 81 * 60_000


# Negative evidence and moves: a thing in front of a wall, then the wall alone


def looking(n: int, *detections: Detection, away_m: float) -> Frame:
    """A look from the same place with a turn away in between, so that each frame is a look."""
    corner = 0.0 if n % 2 == 0 else 9.0
    pose = Pose((0.0, corner, 0.0), FORWARD, tuple((np.eye(6) * 1e-4).ravel().tolist()))
    time_ms = START_MS + n * 60_000
    return Frame(
        f"f{n}", time_ms, pose, CAMERA, None, depth_png(away_m), detections if n % 2 == 0 else ()
    )


def test_a_place_that_is_seen_through_was_left() -> None:
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    frames += [looking(n, away_m=4.0) for n in range(12, 24)]
    (stay,) = filled(frames).stays()
    assert stay.last_absent_ms is not None
    assert stay.last_absent_ms > stay.last_ms
    assert stay.last_absent_ms >= START_MS + 14 * 60_000


def test_a_place_that_was_seen_through_though_it_was_there_proves_little() -> None:
    """Something thin or flat: depth never shows it, and it is found now and then."""
    thin = Detection("cup", 0.9, (28, 20, 36, 28), position=(2.0, 0.0, 0.0), embedding=colour(1))
    shown = [n < 6 or n % 8 == 0 for n in range(80)] + [False] * 12
    frames = [looking(n, *([thin] if is_shown else []), away_m=4.0) for n, is_shown in
              enumerate(shown)]  # fmt: skip
    (stay,) = filled(frames).stays()
    assert stay.seen == 12
    assert stay.last_absent_ms is None


@pytest.mark.parametrize(("apart_ms", "is_gone"), [(600_000, True), (500, False)])
def test_looks_from_one_side_in_a_short_time_are_hardly_more_than_one(
    apart_ms: int, is_gone: bool
) -> None:
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    empty = [looking(n, away_m=4.0) for n in range(12, 20)]
    frames += [replace(f, time_ms=empty[0].time_ms + n * apart_ms) for n, f in enumerate(empty)]
    (stay,) = filled(frames).stays()
    assert (stay.last_absent_ms is not None) == is_gone


def test_a_place_that_is_hidden_proves_nothing() -> None:
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    frames += [looking(n, away_m=0.8) for n in range(12, 60)]
    (stay,) = filled(frames).stays()
    assert stay.last_absent_ms is None


def test_a_thing_that_is_seen_again_is_not_absent() -> None:
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    frames += [looking(n, away_m=4.0) for n in range(12, 24)]
    frames += [looking(n, there, away_m=2.0) for n in range(24, 30)]
    (stay,) = filled(frames).stays()
    assert stay.last_absent_ms is None


@pytest.mark.parametrize(
    "stray",
    [
        Detection("cup", 0.9, (34, 20, 42, 28), embedding=colour(2)),
        Detection("bowl", 0.9, (28, 20, 36, 28)),
    ],
)
def test_what_was_missed_for_long_is_least_likely_what_turns_up_there(stray: Detection) -> None:
    """A doubtful view is of a thing that was just there, and of another one where it has left."""
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    gone = [looking(n, away_m=4.0) for n in range(12, 24)]
    (stay,) = filled([*frames, looking(24, stray, away_m=2.0)]).stays()
    assert stay.seen == 7
    left, other = filled([*frames, *gone, looking(24, stray, away_m=2.0)]).stays()
    assert (left.seen, other.seen) == (6, 1)
    assert left.last_absent_ms is not None
    (back,) = filled([*frames, *gone, looking(24, there, away_m=2.0)]).stays()
    assert back.seen == 7
    assert back.last_absent_ms is None


def test_a_thing_that_the_look_which_missed_it_finds_after_all_is_not_absent() -> None:
    """Taken for another one at first, as it was missed for long, and made one with it then."""
    there = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(1))
    unlike = Detection("cup", 0.9, (28, 20, 36, 28), embedding=colour(2))
    frames = [looking(n, there, away_m=2.0) for n in range(12)]
    frames += [looking(n, away_m=4.0) for n in range(12, 24)]
    (stay,) = filled([*frames, looking(24, unlike, away_m=2.0)]).stays()
    assert stay.seen == 7
    assert stay.last_absent_ms is None


def test_a_thing_seen_once_expires_when_looks_do_not_find_it() -> None:
    ghost = Detection("cup", 0.4, (28, 20, 36, 28), embedding=colour(1))
    frames = [looking(0, ghost, away_m=2.0)]
    frames += [looking(n, away_m=4.0) for n in range(1, 24)]
    assert filled(frames).objects() == []


@pytest.mark.parametrize("absent_odds", [DEFAULT.absent_odds, 1e9])
def test_a_move_is_linked_when_the_old_place_was_seen_empty(absent_odds: float) -> None:
    """The place is known to be left then, though the looks alone may not be enough to say so."""
    here = Detection("cup", 0.9, (14, 20, 22, 28), embedding=colour(1))
    moved = Detection("cup", 0.9, (44, 20, 52, 28), embedding=colour(1))
    frames = [looking(n, here, away_m=3.0) for n in range(12)]
    frames += [looking(n, away_m=4.5) for n in range(12, 24)]
    frames += [looking(n, moved, away_m=3.0) for n in range(24, 36)]
    store = filled(frames, DEFAULT.with_changes(absent_odds=absent_odds))
    (record,) = store.objects()
    first, second = store.stays()
    assert second.moved_from is not None
    assert second.moved_from[0] == first.place
    assert first.last_absent_ms == frames[34].time_ms  # the last look that way
    assert {sighting.place for sighting in store.sightings()} == {0, 1}
    assert record.weight == pytest.approx(12 * 0.9)


def test_a_chain_of_moves_found_at_once_is_linked_one_by_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a to b and b to c, the second link's old thing is gone once the first is made."""
    frames = [single(n, cup(5.0 * (n // 2), look=1 + n // 2)) for n in range(6)]
    frames += [single(6 + n, pose=Pose((0.0, 50.0 * n, 0.0), FORWARD)) for n in range(2)]

    def chained(moves: Moves, changed: set[int], now_ms: int) -> list[Link]:
        known = [moves._memory.things[number] for number in sorted(moves._memory.things)]
        if len(known) < 3:
            return []
        return [Link(known[0], known[1], 0.95), Link(known[1], known[2], 0.95)]

    monkeypatch.setattr(Moves, "find", chained)
    store = filled(frames)
    assert len(store.objects()) == 2
    assert sorted(stay.place for stay in store.stays()) == [0, 0, 1]


def test_what_was_moved_several_times_is_linked_to_what_it_was_before_all_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From b to c is found first, and later on from a to b."""
    frames = [single(n, cup(5.0 * (n // 2), look=1 + n // 2)) for n in range(6)]
    frames += [single(6 + n, pose=Pose((0.0, 50.0 * n, 0.0), FORWARD)) for n in range(3)]

    def backwards(moves: Moves, changed: set[int], now_ms: int) -> list[Link]:
        known = [moves._memory.things[number] for number in sorted(moves._memory.things)]
        if len(known) == 3:
            return [Link(known[1], known[2], 0.96)]
        return [Link(known[0], known[1], 0.97)] if len(known[-1].places) == 2 else []

    monkeypatch.setattr(Moves, "find", backwards)
    store = filled(frames)
    (record,) = store.objects()
    assert record.object_id == "o1"
    assert [(stay.place, stay.moved_from) for stay in store.stays()] == [
        (0, None), (1, (0, 0.97)), (2, (1, 0.96)),
    ]  # fmt: skip
    assert sorted(sighting.place for sighting in store.sightings()) == [0, 1, 2]
    assert store.check() == []


def test_no_move_is_linked_while_the_old_place_is_taken() -> None:
    here = Detection("cup", 0.9, (14, 20, 22, 28), embedding=colour(1))
    other = Detection("cup", 0.9, (44, 20, 52, 28), embedding=colour(1))
    frames = [looking(n, here, away_m=3.0) for n in range(12)]
    frames += [looking(n, here, other, away_m=3.0) for n in range(12, 24)]
    assert len(filled(frames).objects()) == 2


def test_another_look_at_a_new_place_is_no_move() -> None:
    here = Detection("cup", 0.9, (14, 20, 22, 28), embedding=colour(1))
    other = Detection("cup", 0.9, (44, 20, 52, 28), embedding=colour(2))
    frames = [looking(n, here, away_m=3.0) for n in range(12)]
    frames += [looking(n, away_m=4.5) for n in range(12, 24)]
    frames += [looking(n, other, away_m=3.0) for n in range(24, 36)]
    assert len(filled(frames).objects()) == 2


def test_of_two_alike_that_left_neither_is_the_one_that_turned_up() -> None:
    one = Detection("cup", 0.9, (4, 20, 12, 28), embedding=colour(1))
    two = Detection("cup", 0.9, (26, 20, 34, 28), embedding=colour(1))
    moved = Detection("cup", 0.9, (50, 20, 58, 28), embedding=colour(1))
    frames = [looking(n, one, two, away_m=3.0) for n in range(12)]
    frames += [looking(n, away_m=4.5) for n in range(12, 24)]
    frames += [looking(n, moved, away_m=3.0) for n in range(24, 36)]
    assert len(filled(frames).objects()) == 3


def cup_at(y: float, look: int | None = 1) -> Detection:
    return Detection(
        "cup", 0.9, (28, 20, 36, 28), (2.0, y, 0.0), (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01),
        embedding=None if look is None else colour(look),
    )  # fmt: skip


def test_two_things_that_turn_out_to_be_one_are_made_one() -> None:
    """A first bad position founds a second cup; the looks that find one and miss it join them."""
    at = cup_at
    frames = [looking(0, at(0.5), away_m=2.0), looking(2, at(0.5), away_m=2.0)]
    frames += [looking(n, at(-0.2), away_m=2.0) for n in range(4, 12)]
    narrow = DEFAULT.with_changes(space_m3=0.01, move_probability=1.0)
    apart = filled(frames, narrow.with_changes(merge_odds=99.0))
    joined = filled(frames, narrow.with_changes(merge_odds=-9.0))
    assert len(apart.objects()) == 2
    (record,) = joined.objects()
    (stay,) = joined.stays()
    assert record.object_id == "o1"
    assert stay.seen == sum(sighting.seen for sighting in joined.sightings()) == 6
    assert joined.check() == []


@pytest.mark.parametrize(("look", "things"), [(1, 1), (None, 2)])
def test_what_is_one_thing_from_either_side_is_made_one_by_its_look(
    look: int | None, things: int
) -> None:
    """Seen from the other side alone, it is not missed there; without a look it may be another."""
    narrow = DEFAULT.with_changes(space_m3=0.01, merge_odds=-9.0, move_probability=1.0)
    frames = [looking(n, cup_at(0.5, look), away_m=2.0) for n in (0, 2)]
    backward = (0.0, -FORWARD[1], 0.0, FORWARD[3])
    for n in (4, 6):
        frame = looking(n, cup_at(-0.2, look), away_m=2.0)
        assert frame.pose is not None
        pose = replace(frame.pose, position=(4.0, 0.0, 0.0), quaternion=backward)
        frames.append(replace(frame, pose=pose))
        frames.append(looking(n + 1, away_m=2.0))
    assert len(filled(frames, narrow).objects()) == things


def far_off(n: int, sides: Sequence[tuple[float, float]]) -> Frame:
    """A vase 6 m ahead of where the camera was at first; neither depth nor position is known."""
    x, right = sides[n % len(sides)]
    pose = Pose((x, 0.0, right), FORWARD, tuple((np.eye(6) * 1e-4).ravel().tolist()))
    u = CAMERA.cx + CAMERA.fx * right / (6.0 - x)  # the picture's right is the map's -z
    seen = Detection("vase", 0.9, (u - 2, 22, u + 2, 26), embedding=colour(1))
    return Frame(f"f{n}", START_MS + n * 5000, pose, CAMERA, None, None, (seen,))


def test_a_range_that_was_assumed_gets_no_surer_by_being_assumed_again() -> None:
    """From one side it stays unknown, so that it may be what is seen elsewhere from near by."""
    once, often = (filled([far_off(n, [(0.0, 0.0)]) for n in range(k)]).stays() for k in (1, 30))
    spread = [stay.covariance[0] for (stay,) in (once, often) if stay.covariance is not None]
    assert spread[1] == pytest.approx(spread[0], rel=0.6)
    assert spread[1] > 0.5


def test_directions_from_two_sides_tell_where_a_thing_is() -> None:
    (stay,) = filled([far_off(n, [(0.0, 0.0), (3.0, 1.0)]) for n in range(20)]).stays()
    assert stay.position == pytest.approx((6.0, 0.0, 0.0), abs=0.4)
