"""Plans walked over homes built by hand: what is found, in which order, and why."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answer import Answer
from d3a.answering.attributes import (
    LEAST_DOUBTFUL,
    LEAST_ONCE,
    Judged,
    Looks,
    judged,
    medians_of_others,
)
from d3a.answering.conclude import within
from d3a.answering.match import Candidate
from d3a.colours import LEAST_ODDS, Palette
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import JudgeAttributes, Precision, plan
from d3a.store.base import ObjectRecord
from grammar.forms import (
    Ask,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
    Where,
)
from tests.worlds.made import NOW, PAINTS, ZONE, Home, Words, at, painted
from tests.worlds.oracle import OracleStore

ON_TABLE, TABLE = (180.0, 170.0, 220.0, 230.0), (100.0, 200.0, 300.0, 400.0)
FLOOR = (180.0, 380.0, 220.0, 430.0)


def term(category: str, *attributes: str, word: str = "", **more: object) -> ObjectTerm:
    return ObjectTerm(category, word or category, attributes=attributes, **more)  # type: ignore[arg-type]


def query(
    *objects: ObjectTerm,
    ask: Ask = "whether",
    kind: RelationKind | None = None,
    place: str | None = None,
    time: TimeSlice | None = None,
    select: Select = "all",
    negated: bool = False,
) -> FormalQuery:
    relation = Relation(kind) if kind else None
    form = "Q2" if relation else ("Q3" if place or time or ask in ("where", "when") else "Q1")
    return FormalQuery("?", form, ask, objects, relation, place, time, select, negated)  # type: ignore[arg-type]


def run(
    home: Home, asked: FormalQuery, limit: int = 50, precision: Precision | None = None
) -> Answer:
    store = home.into(OracleStore())
    steps = plan(asked, precision=precision)
    return execute(steps, store, Words(), now=NOW, limit=limit, parameters=DEFAULT)


def ids(answer: Answer) -> list[str]:
    return [keyframe.object_id for keyframe in answer.keyframes]


@pytest.fixture
def kitchen() -> Home:
    home = Home()
    home.thing("cup-red", "cup", paint="red")
    home.thing("cup-blue", "cup", paint="blue")
    home.thing("bowl", "bowl", paint="orange")
    home.thing("fridge", "refrigerator", paint="white")
    home.thing("couch", "couch", paint="green")
    home.seen("cup-red", 0, 10, at=(1, 1, 1))
    home.seen("cup-blue", 20, 30, at=(1.5, 1, 1))
    home.seen("cup-blue", 200, 210, at=(6, 1, 1), place=1)
    home.seen("bowl", 5, 30, at=(1.2, 1, 1))
    home.seen("fridge", 0, 300, at=(0, 0, 1))
    home.seen("couch", 200, 220, at=(7, 1, 1))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    return home


def test_category_finds_each_object_at_each_place(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup")))
    assert answer.status == "found"
    assert answer.count == 2
    assert sorted(ids(answer)) == ["cup-blue", "cup-blue", "cup-red"]
    assert [k.rank for k in answer.keyframes] == [1, 2, 3]
    scores = [k.score for k in answer.keyframes]
    assert scores == sorted(scores, reverse=True)


def test_colour_keeps_what_has_it(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup", "red")))
    assert ids(answer) == ["cup-red"]
    assert answer.keyframes[0].why["attributes"]["red"] > 0.8


def test_without_is_the_complement_of_with(kitchen: Home) -> None:
    red = run(kitchen, query(term("cup", "red")))
    not_red = run(kitchen, query(replace(term("cup"), without=("red",))))
    assert not set(ids(red)) & set(ids(not_red))
    assert set(ids(not_red)) == {"cup-blue"}
    assert not_red.keyframes[0].why["attributes"]["not red"] > 0.9


def test_object_is_anything(kitchen: Home) -> None:
    assert run(kitchen, query(term("object"))).count == 5


def test_synonym_is_found_and_ranks_a_little_lower(kitchen: Home) -> None:
    cup = run(kitchen, query(term("cup"))).keyframes[0]
    mug = run(kitchen, query(term("cup", word="mug"))).keyframes[0]
    assert mug.object_id == cup.object_id
    assert mug.score < cup.score


def test_keyframe_tells_room_landmark_and_times(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup", "blue"), ask="where", select="last"))
    best = answer.keyframes[0]
    assert (best.place, best.near) == ("living room", "couch")
    assert best.end == at(210)
    assert best.end.tzinfo is ZONE
    assert answer.keyframes[1].place == "kitchen"


@pytest.mark.parametrize(
    ("start", "end", "found"),
    [
        (at(0), at(15), ["cup-red"]),
        (at(10), at(15), ["cup-red"]),  # a closed interval still holds its last moment
        (at(11), at(20), []),  # a half-open slice no longer holds its end
        (at(11), at(21), ["cup-blue"]),
        (None, at(0), []),
        (at(211), None, []),
    ],
)
def test_half_open_slices_meet_closed_sightings(
    kitchen: Home, start: datetime | None, end: datetime | None, found: list[str]
) -> None:
    answer = run(kitchen, query(term("cup"), time=TimeSlice(start, end)))
    assert ids(answer) == found


def test_a_point_in_time_gives_what_was_true_then(kitchen: Home) -> None:
    asked = query(term("cup", "blue"), ask="where", time=TimeSlice(at(100), at(100)))
    answer = run(kitchen, asked)
    assert [(k.start, k.place) for k in answer.keyframes] == [
        (at(20), "kitchen"),
        (at(200), "living room"),
    ]


def test_place_keeps_what_lies_in_the_room(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup"), place="living room"))
    assert [(k.object_id, k.place) for k in answer.keyframes] == [("cup-blue", "living room")]


def test_a_place_that_nobody_defined_is_left_out(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup", "red"), place="garage"))
    assert answer.status == "found"
    assert answer.unjudged == ("in the garage",)
    plain = run(kitchen, query(term("cup", "red")))
    assert answer.keyframes[0].score < plain.keyframes[0].score


def test_what_was_not_in_the_room(kitchen: Home) -> None:
    asked = query(term("cup"), ask="what", place="living room", negated=True)
    assert {k.place for k in run(kitchen, asked).keyframes} == {"kitchen"}


def test_a_material_is_said_and_left_out(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup", "red", "plastic")))
    assert ids(answer) == ["cup-red"]
    assert answer.unjudged == ("plastic",)
    assert answer.keyframes[0].why["unjudged"] < 1


def test_first_and_last(kitchen: Home) -> None:
    last = run(kitchen, query(term("cup"), ask="where", select="last"))
    first = run(kitchen, query(term("cup"), ask="where", select="first"))
    assert (last.keyframes[0].start, first.keyframes[0].start) == (at(200), at(0))


@pytest.mark.parametrize(
    ("ask", "value"), [("count", 2.0), ("how_often", 3.0), ("how_long", 1800.0)]
)
def test_numbers(kitchen: Home, ask: Ask, value: float) -> None:
    assert run(kitchen, query(term("cup"), ask=ask)).value == value


def test_duration_is_that_inside_of_the_slice(kitchen: Home) -> None:
    asked = query(term("cup", "red"), ask="how_long", time=TimeSlice(at(6), at(60)))
    assert run(kitchen, asked).value == 240.0


def test_intervals_that_the_store_had_to_split_are_one() -> None:
    home = Home()
    home.thing("tv", "tv")
    home.seen("tv", 0, 60)
    home.seen("tv", 60 + 0.001 / 60, 100, probability=0.95)
    answer = run(home, query(term("tv"), ask="how_often"))
    assert answer.value == 1.0
    assert (answer.keyframes[0].start, answer.keyframes[0].end) == (at(0), at(100))
    assert answer.keyframes[0].probability == 0.95


def test_limit_cuts_and_says_so(kitchen: Home) -> None:
    answer = run(kitchen, query(term("object")), limit=2)
    assert len(answer.keyframes) == 2
    assert answer.truncated
    assert answer.count == 5


def test_together_by_a_shared_frame(kitchen: Home) -> None:
    kitchen.met("cup-red", "fridge", 2, 4)
    answer = run(kitchen, query(term("cup"), term("refrigerator"), ask="when", kind="together"))
    shared = [k for k in answer.keyframes if k.frame == "both-2"]
    assert [k.object_id for k in shared] == ["cup-red", "fridge"]
    assert {k.group for k in shared} == {shared[0].group}
    assert (shared[0].start, shared[0].end) == (at(2), at(4))


def test_together_within_a_metre_in_overlapping_intervals(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup"), term("bowl"), ask="when", kind="together"))
    found = {(k.object_id, k.start, k.end) for k in answer.keyframes if k.category == "cup"}
    assert {(name, start) for name, start, _ in found} == {
        ("cup-red", at(0)),
        ("cup-blue", at(20)),
    }


def test_when_the_cup_was_not_with_the_bowl(kitchen: Home) -> None:
    asked = query(term("cup"), term("bowl"), ask="when", kind="together", negated=True)
    answer = run(kitchen, asked)
    assert [(k.object_id, k.start) for k in answer.keyframes] == [("cup-blue", at(200))]


def test_three_things_together(kitchen: Home) -> None:
    kitchen.met("cup-red", "fridge", 6, 8)
    kitchen.met("cup-red", "bowl", 6, 8)
    answer = run(
        kitchen, query(term("cup"), term("bowl"), term("refrigerator"), ask="when", kind="together")
    )
    best = [k.object_id for k in answer.keyframes if k.group == 1]
    assert best == ["cup-red", "bowl", "fridge"]


def test_on_the_table_by_boxes() -> None:
    home = Home()
    home.thing("cup-a", "cup")
    home.thing("cup-b", "cup")
    home.thing("table", "table")
    home.seen("cup-a", 0, 5, at=None, box=ON_TABLE)
    home.seen("cup-b", 0, 5, at=None, box=FLOOR)
    home.seen("table", 0, 5, at=None, box=TABLE)
    home.met("cup-a", "table", 0, 5, boxes=(ON_TABLE, TABLE))
    home.met("cup-b", "table", 0, 5, boxes=(FLOOR, TABLE))
    answer = run(home, query(term("cup"), term("table"), kind="on"))
    assert ids(answer) == ["cup-a", "table"]
    under = run(home, query(term("cup"), term("table"), kind="under"))
    assert ids(under) == ["cup-b", "table"]
    what = run(home, query(term("object"), term("table"), ask="what", kind="on"))
    assert ids(what) == ["cup-a", "table"]


def test_a_ground_that_no_detector_knows_is_left_out(kitchen: Home) -> None:
    answer = run(kitchen, query(term("cup", "red"), term("desk"), kind="on"))
    assert ids(answer) == ["cup-red"]
    assert answer.unjudged == ("on the desk",)


def test_the_cup_next_to_the_couch(kitchen: Home) -> None:
    described = replace(term("cup"), where=Where("near", term("couch")))
    answer = run(kitchen, query(described, ask="where"))
    assert [(k.object_id, k.start) for k in answer.keyframes] == [("cup-blue", at(200))]
    others = replace(term("cup"), where=Where("near", term("couch"), negated=True))
    assert {k.start for k in run(kitchen, query(others)).keyframes} == {at(0), at(20)}


def test_between_two_things() -> None:
    home = Home()
    for name, category, x in (("l", "lamp", 0.0), ("c", "cup", 1.0), ("b", "book", 2.0)):
        home.thing(name, category)
        home.seen(name, 0, 5, at=(x, 0, 0))
    found = run(home, query(term("cup"), term("lamp"), term("book"), kind="between"))
    assert ids(found) == ["c", "l", "b"]
    outside = run(home, query(term("lamp"), term("cup"), term("book"), kind="between"))
    assert outside.status == "not_found"


def test_between_the_chairs_needs_two_of_them() -> None:
    home = Home()
    for name, category, x in (("l", "chair", 0.0), ("c", "cup", 1.0), ("r", "chair", 2.0)):
        home.thing(name, category)
        home.seen(name, 0, 5, at=(x, 0, 0))
    answer = run(home, query(term("cup"), term("chair"), kind="between"))
    assert ids(answer) == ["c", "l", "r"]


def test_same_place_at_another_time() -> None:
    home = Home()
    for name, start, x in (("cup", 0, 1.0), ("bowl", 100, 1.1), ("vase", 100, 3.0)):
        home.thing(name, name)
        home.seen(name, start, at=(x, 0, 0))
    assert run(home, query(term("cup"), term("bowl"), kind="same_place")).status == "found"
    assert run(home, query(term("cup"), term("vase"), kind="same_place")).status == "not_found"


def test_sizes_are_relative_to_the_category() -> None:
    home = Home()
    for name, size in (("s", 0.08), ("m", 0.12), ("l", 0.3)):
        home.thing(name, "bowl", extent_m=(size, size))
        home.seen(name, 0)
    assert ids(run(home, query(term("bowl", "big"))))[0] == "l"
    assert ids(run(home, query(term("bowl", "small"))))[0] == "s"
    assert "l" not in ids(run(home, query(term("bowl", "small"))))


def test_the_one_of_several_that_moved_is_told_with_where_it_was() -> None:
    home = Home()
    home.thing("bowl", "bowl")
    home.seen("bowl", 0)
    home.thing("cup", "cup")
    home.seen("cup", 0)
    home.seen("cup", 60, at=(3, 0, 1), place=1, moved_from=(0, 0.99))
    for terms in ((term("bowl"), term("cup")), (term("cup"), term("bowl"))):
        answer = run(home, replace(query(*terms), ask="moved"))
        assert ids(answer) == ["cup"]
        assert answer.otherwise is not None
        assert (answer.otherwise.object_id, answer.otherwise.end) == ("cup", at(0))


def test_of_several_big_ones_one_is_the_biggest() -> None:
    home = Home()
    for number, size in enumerate((0.2, 0.2, 0.2, 0.5, 1.0)):
        home.thing(f"c{number}", "chair", extent_m=(size, size))
        home.seen(f"c{number}", 0, 5, at=(number, 0, 1))
        home.seen(f"c{number}", 60, 60 + number, at=(number, 0, 1))
    for word, found in (("big", ["c3", "c4"]), ("biggest", ["c4"]), ("bigger", ["c4"])):
        answer = run(home, query(term("chair", word)))
        assert sorted({k.object_id for k in answer.keyframes if k.score > 0.25}) == found, word
    home.room("hall", -1, -1, 3.5, 3)
    listed = replace(query(term("chair", "biggest")), ask="what", place="hall")
    answer = run(home, listed)  # among those of the hall, which are not known when it is judged
    assert (answer.unjudged, answer.count) == (("biggest",), 4)


def test_what_is_as_large_as_the_others_is_neither_big_nor_small() -> None:
    home = Home()
    for number, size in enumerate((0.115, 0.12, 0.12, 0.13)):
        home.thing(f"b{number}", "bowl", extent_m=(size, size))
        home.seen(f"b{number}", 0)
    home.thing("unmeasured", "bowl")
    home.seen("unmeasured", 0)
    for word in ("big", "small", "tall"):
        answer = run(home, query(term("bowl", word)))
        assert (answer.count, answer.unjudged) == (5, (word,))
    home.thing("l", "bowl", extent_m=(0.3, 0.3))
    home.seen("l", 0)
    big, small = run(home, query(term("bowl", "big"))), run(home, query(term("bowl", "small")))
    assert (big.count, big.keyframes[0].object_id, big.unjudged) == (1, "l", ())
    assert (small.status, small.reason, small.unjudged) == ("not_found", "never", ())
    assert run(home, query(replace(term("bowl"), without=("big",)))).count == 5


def test_of_two_lamps_the_one_is_small_and_the_other_tall() -> None:
    home = Home()
    home.thing("floor", "lamp", extent_m=(0.42, 1.52))
    home.thing("bedside", "lamp", extent_m=(0.29, 0.44))
    home.thing("mistake", "lamp", extent_m=(0.2, 0.32), tentative=True)  # tells no usual size
    for number, name in enumerate(("floor", "bedside", "mistake")):
        home.seen(name, 0, at=(number, 0, 0))
    for word in ("big", "tall"):
        assert ids(run(home, query(term("lamp", word)))) == ["floor"]
    for word in ("small", "short"):
        told = ids(run(home, query(term("lamp", word))))
        assert "floor" not in told
        assert "bedside" in told


def test_of_two_mugs_one_is_small_beside_the_other() -> None:
    home = Home()
    home.thing("mug", "cup", extent_m=(0.12, 0.12))
    home.thing("espresso", "cup", extent_m=(0.09, 0.1))  # a quarter smaller; of the mean an eighth
    for number, name in enumerate(("mug", "espresso")):
        home.seen(name, 0, at=(number, 0, 0))
    assert ids(run(home, query(term("cup", "small")))) == ["espresso"]
    assert ids(run(home, query(term("cup", "big")))) == ["mug"]


@given(st.lists(st.integers(-5, 5), min_size=2, max_size=9))
def test_the_usual_of_a_thing_is_the_median_of_the_others(sizes: list[int]) -> None:
    values = np.array(sizes, dtype=np.float64)
    wanted = [np.median(np.delete(values, i)) for i in range(len(values))]
    assert medians_of_others(values).tolist() == wanted


def test_of_what_may_have_the_looks_the_likeliest_is_told() -> None:
    home = Home()
    for number, paint in enumerate(("green", "blue", "white", "brown", "orange")):
        home.thing(paint, "bowl", paint=paint)
        home.seen(paint, 0, at=(number, 5, 1))
    home.thing("likelier", "cup", paint=(152.0, 80.0, 45.0))
    home.thing("newer", "cup", paint=(140.0, 88.0, 50.0))
    home.thing("not", "cup", paint="green")
    home.seen("likelier", 10, at=(0, 0, 1))
    home.seen("newer", 20, at=(2, 0, 1))
    home.seen("not", 30, at=(4, 0, 1))
    for asked in (term("cup", "red"), replace(term("cup", "red"), quantity=1)):
        answer = run(home, query(asked))
        assert (answer.status, answer.reason, answer.keyframes) == ("not_found", "never", ())
        assert [k.object_id for k in answer.perhaps] == ["likelier", "newer"]
        assert answer.otherwise == answer.perhaps[0] == answer.instead[0]
        assert [k.rank for k in answer.perhaps] == [1, 2]
        first, second = (k.why["attributes"]["red"] for k in answer.perhaps)
        assert LEAST_ODDS / (1 + LEAST_ODDS) > first > second >= LEAST_DOUBTFUL
        assert all(k.score < 0.5 and k.why["refused"] == ["red"] for k in answer.perhaps)
        assert [k["object_id"] for k in answer.to_json()["perhaps"]] == ["likelier", "newer"]
        assert [k.object_id for k in within(answer, 1).perhaps] == ["likelier"]
    flat = run(home, query(term("cup", "purple")))
    assert (flat.status, flat.perhaps) == ("not_found", ())
    assert "perhaps" not in flat.to_json()
    assert flat.otherwise is not None
    assert flat.otherwise.object_id == "not"  # the newest


def test_sizes_of_too_few_things_are_not_judged() -> None:
    home = Home()
    home.thing("only", "bowl", extent_m=(0.1, 0.1))
    home.seen("only", 0)
    assert run(home, query(term("bowl", "big"))).unjudged == ("big",)


def test_taught_names_and_owners() -> None:
    home = Home()
    home.thing("k1", "key", names=(("key", "anna"),))
    home.thing("k2", "key")
    home.thing("cat", "toy", names=(("Pumpkin", None),))
    for name in ("k1", "k2", "cat"):
        home.seen(name, 0)
    assert ids(run(home, query(term("key", owner="anna")))) == ["k1"]
    assert sorted(ids(run(home, query(term("key"))))) == ["k1", "k2"]
    assert ids(run(home, query(term("pumpkin")))) == ["cat"]
    bens = run(home, query(term("key", owner="ben")))
    assert ids(bens) == ["k2"]
    assert bens.unjudged == ("ben's",)


def test_precision_forces_a_rung(kitchen: Home) -> None:
    kitchen.thing("mine", "cup", paint="pink", names=(("cup", None),))
    kitchen.seen("mine", 0)
    asked = query(term("cup"))
    assert ids(run(kitchen, asked, precision="perfect")) == ["mine"]
    assert run(kitchen, asked, precision="category").count == 3
    assert run(kitchen, asked, precision="any").count == 6


def test_what_moved_and_what_is_missing() -> None:
    home = Home()
    for name in ("cup", "bowl", "book"):
        home.thing(name, name)
    home.seen("cup", 0, at=(0, 0, 0))
    home.seen("cup", 60, at=(3, 0, 0), place=1, moved_from=(0, 0.9))
    home.seen("bowl", 0, absent=90)
    home.seen("book", 0)
    moved = run(home, query(ask="moved"))
    assert [(k.object_id, k.start) for k in moved.keyframes] == [("cup", at(60))]
    assert moved.keyframes[0].why["relation"] == 0.9
    missing = run(home, query(ask="missing"))
    assert [(k.object_id, k.last_absent) for k in missing.keyframes] == [("bowl", at(90))]
    early = run(home, query(ask="moved", time=TimeSlice(at(0), at(60))))
    assert early.status == "not_found"


def test_what_moved_in_a_room_came_left_or_changed_its_place_there() -> None:
    home = Home()
    home.room("kitchen", -1, -1, 3, 3)
    home.room("hall", 4, -1, 9, 3)
    for name, first, second in (("came", 6, 1), ("left", 1, 6), ("never", 6, 8), ("within", 0, 2)):
        home.thing(name, "cup")
        home.seen(name, 0, at=(first, 0, 0))
        home.seen(name, 60, at=(second, 0, 0), place=1, moved_from=(0, 0.9))
    answer = run(home, query(ask="moved", place="kitchen"))
    assert sorted(ids(answer)) == ["came", "left", "within"]
    assert min(k.score for k in answer.keyframes) > 0.5
    assert sorted(ids(run(home, query(ask="moved", place="hall")))) == ["came", "left", "never"]


def test_what_moved_on_the_table_or_is_missing_from_it_was_on_it() -> None:
    home = Home()
    home.thing("table", "table")
    home.seen("table", 0, 30, at=None, box=TABLE)
    for name, box in (("cup", ON_TABLE), ("bowl", FLOOR)):
        home.thing(name, name)
        home.seen(name, 0, 5, at=None, box=box)
        home.met(name, "table", 0, 5, boxes=(box, TABLE))
        home.seen(name, 60, at=None, place=1, moved_from=(0, 0.9))
    for name, box in (("vase", ON_TABLE), ("book", FLOOR)):
        home.thing(name, name)
        home.seen(name, 10, 15, at=None, box=box, absent=90)
        home.met(name, "table", 10, 15, boxes=(box, TABLE))
    late = TimeSlice(at(50), at(100))
    both = term("object"), term("table")
    moved = run(home, query(*both, ask="moved", kind="on", time=late))
    assert [(k.object_id, k.start) for k in moved.keyframes] == [("cup", at(60))]
    missing = run(home, query(*both, ask="missing", kind="on", time=late))
    assert ids(missing) == ["vase"]
    unknown = run(home, query(term("object"), term("desk"), ask="missing", kind="on"))
    assert (sorted(ids(unknown)), unknown.unjudged) == (["book", "vase"], ("on the desk",))


def test_what_was_last_seen_before_the_slice_may_have_moved_before_it() -> None:
    home = Home()
    home.thing("cup", "cup")
    home.seen("cup", 0, at=(0, 0, 0))
    home.seen("cup", 60, at=(3, 0, 0), place=1, moved_from=(0, 0.8))
    (whole,) = run(home, query(ask="moved", time=TimeSlice(at(0), at(90)))).keyframes
    assert whole.why["relation"] == pytest.approx(0.8)
    assert "share" not in whole.why
    for start, share in ((15, 0.75), (45, 0.25)):
        (moved,) = run(home, query(ask="moved", time=TimeSlice(at(start), at(90)))).keyframes
        assert moved.why["share"] == pytest.approx(share)
        assert moved.score == pytest.approx(whole.score * share)


def test_usual_place_by_share_of_time() -> None:
    home = Home()
    home.thing("keys", "key")
    home.seen("keys", 0, 30, at=(0, 0, 0))
    home.seen("keys", 60, 70, at=(3, 0, 0), place=1)
    answer = run(home, query(term("key"), ask="where", select="usual"))
    shares = [k.why["share"] for k in answer.keyframes]  # until 12:45 it was where it was before
    assert shares == [pytest.approx(45 / 70, abs=1e-4), pytest.approx(25 / 70, abs=1e-4)]


def test_of_many_that_may_be_one_those_seen_most_often_have_their_share() -> None:
    home = Home()
    for number, name in enumerate("abc"):
        home.thing(name, "key")
        for again in range(number + 1):
            home.seen(name, 100 * number + 20 * again, at=(3 * number, 0, 0), times=1)
    asked = query(term("key"), ask="where", select="usual")
    shares = {k.object_id: k.why["share"] for k in run(home, asked).keyframes}
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-3)
    (best,) = run(home, asked, limit=1).keyframes  # of two of the three the share is looked at
    assert (best.object_id, best.why["share"]) == ("b", shares["b"])


def test_votes_for_another_category_still_find_the_object() -> None:
    home = Home()
    home.thing("mug", "cup", votes=(("cup", 3.0), ("bowl", 1.0)))
    home.seen("mug", 0)
    assert run(home, query(term("cup"))).keyframes[0].why["match"] == 0.75


def test_last_follows_a_thing_that_was_called_otherwise() -> None:
    home = Home()
    home.thing("cup", "cup", paint="red")
    home.thing("bowl", "bowl", paint="red", tentative=True)
    home.thing("vase", "vase", paint="red", tentative=True)
    home.seen("cup", 0, 5, at=(1, 1, 1))
    home.seen("bowl", 6, at=(1.05, 1, 1), times=1)
    home.seen("vase", 7, at=(4, 1, 1), times=1)
    answer = run(home, query(term("cup"), ask="where", select="last"))
    assert ids(answer) == ["bowl", "cup"]
    assert 0.5 < answer.keyframes[0].why["same"] < 1
    beside = Home(
        objects=home.objects, stays=home.stays, sightings=home.sightings, views=home.views
    )
    beside.met("bowl", "cup", 6)
    assert ids(run(beside, query(term("cup"), ask="where", select="last"))) == ["cup"]


def test_times_of_the_steps_are_told(kitchen: Home) -> None:
    elapsed = run(kitchen, query(term("cup"))).elapsed_ms
    assert set(elapsed) == {"retrieve", "rank", "total"}
    assert elapsed["total"] >= elapsed["retrieve"] >= 0


def test_one_look_must_be_nearly_sure() -> None:
    rng = np.random.default_rng(0)
    between = painted((212.0, 66.0, 36.0), rng)  # as much a red as an orange
    clear = painted(PAINTS["orange"], rng)
    palette = Palette.of(np.stack([between, clear, painted(PAINTS["green"], rng)]))
    often = ObjectRecord("often", "cup", 1.0, 0, 0, embedding=between, embedding_model="rgb-8x8x8")
    once = replace(often, object_id="once", tentative=True)
    found = [Candidate(often, 1.0), Candidate(once, 1.0)]
    found.append(Candidate(replace(once, object_id="clear", embedding=clear), 1.0))

    def told(colour: str, *, doubts: bool = False) -> Judged:
        step = JudgeAttributes("x", (colour,), doubts=doubts)
        return judged(step, found, lambda asked: Looks.of(asked, lambda: palette), Words())

    assert set(told("red").kept) == {"often"}
    assert 1 / 3 <= told("red").kept["often"].attributes["red"] < 0.5
    assert set(told("orange").kept) == {"often", "clear"}
    doubted = told("orange", doubts=True)
    assert set(doubted.kept) == {"often", "clear", "once"}
    assert doubted.doubtful == {"once"}


def test_what_is_doubtful_is_listed_below_what_is_likely_and_never_alone() -> None:
    def cups(*paints: tuple[str, str | tuple[float, float, float]]) -> Home:
        home = Home()
        for number, (name, paint) in enumerate(paints):
            home.thing(name, "cup", paint=paint)
            home.seen(name, 10 * number, at=(number, 0, 1))
        for number, paint in enumerate(("green", "blue", "white", "brown", "orange")):
            home.thing(paint, "bowl", paint=paint)
            home.seen(paint, 5 * number, at=(number, 5, 1))
        return home

    rusty = ("rusty", (150.0, 80.0, 45.0))
    both = run(cups(("red", "red"), rusty), query(term("cup", "red")))
    assert ids(both) == ["red", "rusty"]
    assert both.keyframes[1].why["attributes"]["red"] < 1 / 3
    assert both.count == 1
    alone = run(cups(rusty), query(term("cup", "red")))
    assert (alone.status, alone.keyframes) == ("not_found", ())
    assert alone.otherwise is not None
    assert alone.otherwise.object_id == "rusty"
    counted = run(cups(("red", "red"), rusty), query(term("cup", "red"), ask="count"))
    assert ids(counted) == ["red"]


def test_a_relation_of_mere_doubts_is_a_no_about_what_is_likely() -> None:
    home = Home()
    home.thing("red", "cup", paint="red")
    home.seen("red", 0, 5, at=(0, 0, 1))
    home.thing("rusty", "cup", paint=(150.0, 80.0, 45.0))
    home.seen("rusty", 10, 15, at=(9, 0, 1))
    for number, paint in enumerate(("green", "blue", "white", "brown", "orange")):
        home.thing(paint, "bowl", paint=paint)
        home.seen(paint, 10, 15, at=(9.0 + number / 10, 0, 1))
    answer = run(home, query(term("cup", "red"), term("bowl"), ask="when", kind="together"))
    assert (answer.status, answer.reason) == ("not_found", "not_there")
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "red"


def test_a_pair_is_an_answer_where_one_of_two_looks_is_doubtful() -> None:
    def asked(rust: tuple[float, float, float]) -> Answer:
        home = Home()
        for number, paint in enumerate(("green", "blue", "white", "brown", "orange")):
            home.thing(paint, "bowl", paint=paint)
            home.seen(paint, 10, 15, at=(number / 10, 0, 1))
        home.thing("rusty", "cup", paint=rust, tentative=True)
        home.seen("rusty", 10, 15, at=(0, 0.2, 1))
        things = term("cup", "red"), term("bowl", "blue")
        return run(home, query(*things, ask="when", kind="together"))

    both = asked((178.0, 53.0, 38.0))
    assert ids(both) == ["rusty", "blue"]
    assert both.count == 1
    assert both.keyframes[0].why["attributes"]["red"] < LEAST_ONCE
    assert asked((152.0, 80.0, 45.0)).status == "not_found"
