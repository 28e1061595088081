"""The honest no: each reason, what is told instead, and that a no is never invented."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from grammar.forms import (
    RELATION_KINDS,
    Ask,
    Bound,
    Form,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
)
from tests.worlds.made import NOW, PAINTS, Home, Words, at
from tests.worlds.oracle import OracleStore

CUP = ObjectTerm("cup")


def run(home: Home, query: FormalQuery) -> Answer:
    store = home.into(OracleStore())
    return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def whether(*objects: ObjectTerm, **more: object) -> FormalQuery:
    return FormalQuery("?", "Q1", "whether", objects, **more)  # type: ignore[arg-type]


@pytest.fixture
def home() -> Home:
    home = Home(classes=("cup", "bowl", "elephant", "sportsball"))
    home.thing("cup", "cup", paint="red")
    home.thing("bowl", "bowl", paint="white")
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.seen("cup", 100, 110, at=(6, 1, 1), place=1)
    home.seen("bowl", 200, 201, at=(1, 1, 1))
    home.room("kitchen", 0, 0, 3, 3)
    home.room("hall", 10, 10, 12, 12)
    return home


def test_empty_store() -> None:
    answer = run(Home(), whether(CUP))
    assert (answer.status, answer.reason) == ("not_found", "empty")


def test_known_to_the_detector_but_never_seen(home: Home) -> None:
    answer = run(home, whether(ObjectTerm("elephant")))
    assert (answer.status, answer.reason) == ("not_found", "never")
    assert answer.last_looked == at(201)
    assert answer.keyframes == ()


def test_not_recognisable_where_the_class_list_is_known(home: Home) -> None:
    answer = run(home, whether(ObjectTerm("bowling pin")))
    assert (answer.status, answer.reason) == ("unknown_object", "not_recognisable")
    assert answer.suggestions == ("bowl",)


def test_unknown_word_without_a_class_list(home: Home) -> None:
    home.classes = None
    answer = run(home, whether(ObjectTerm("cucumber")))
    assert (answer.status, answer.reason) == ("unknown_object", "never")
    assert answer.suggestions == ("cup",)


def test_never_in_that_colour(home: Home) -> None:
    answer = run(home, whether(replace(CUP, attributes=("purple",))))
    assert (answer.status, answer.reason) == ("not_found", "never")
    assert answer.keyframes == ()
    assert answer.otherwise is not None
    assert answer.otherwise.category == "cup"
    assert answer.otherwise.why["refused"] == ["purple"]


@pytest.mark.parametrize(
    ("start", "end", "nearest"),
    [(11, 20, 10), (90, 99, 110), (20, 95, 110), (20, 40, 10), (111, None, 110)],
)
def test_not_then_tells_the_nearest_time(
    home: Home, start: float, end: float | None, nearest: float
) -> None:
    time = TimeSlice(at(start), None if end is None else at(end))
    answer = run(home, whether(CUP, time=time))
    assert (answer.status, answer.reason) == ("not_found", "not_then")
    assert answer.otherwise is not None
    assert answer.otherwise.end == at(nearest)
    assert answer.keyframes == ()


def test_not_there_tells_where_else(home: Home) -> None:
    answer = run(home, whether(CUP, place="hall"))
    assert (answer.status, answer.reason) == ("not_found", "not_there")
    assert answer.otherwise is not None
    assert answer.otherwise.end == at(110)


def test_last_look_is_that_into_the_room(home: Home) -> None:
    home.look(50, 11.0, 11.0)
    home.look(60, 9.0, 11.0)  # looks along +x, into the hall
    home.look(70, 13.0, 11.0)  # looks away from it
    assert run(home, whether(CUP, place="hall")).last_looked == at(60)


def test_seen_but_not_in_the_relation(home: Home) -> None:
    relation = Relation("together")
    query = FormalQuery("?", "Q2", "whether", (CUP, ObjectTerm("bowl")), relation)
    answer = run(home, query)
    assert (answer.status, answer.reason) == ("not_found", "not_there")
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "cup"


def test_together_with_what_was_never_seen_is_a_no(home: Home) -> None:
    relation = Relation("together")
    query = FormalQuery("?", "Q2", "when", (CUP, ObjectTerm("piano")), relation)
    answer = run(home, query)
    assert answer.status == "unknown_object"
    assert answer.message == "The answer is about “piano”."


def test_gone_by_the_moment_asked_for() -> None:
    home = Home()
    home.thing("cup", "cup")
    home.seen("cup", 0, 10, absent=30)
    gone = run(home, whether(CUP, time=TimeSlice(at(60), at(60))))
    assert (gone.status, gone.reason) == ("not_found", "gone")
    assert gone.otherwise is not None
    assert gone.otherwise.last_absent == at(30)
    still = run(home, whether(CUP, time=TimeSlice(at(20), at(20))))
    assert still.status == "found"


def test_found_but_gone_since_is_told_by_the_keyframe() -> None:
    home = Home()
    home.thing("cup", "cup")
    home.seen("cup", 0, 10, absent=30)
    assert run(home, whether(CUP)).keyframes[0].last_absent == at(30)


def test_both_are_wanted(home: Home) -> None:
    elephant = ObjectTerm("elephant")
    answer = run(home, whether(CUP, elephant))
    assert (answer.status, answer.reason) == ("not_found", "never")
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "cup"
    both = run(home, whether(CUP, ObjectTerm("bowl")))
    assert {k.object_id for k in both.keyframes} == {"cup", "bowl"}


def test_fewer_than_asked_for_is_a_no_that_tells_how_many(home: Home) -> None:
    home.thing("mug", "cup", paint="blue")
    home.seen("mug", 50, at=(1, 1, 1))
    for number, status in ((1, "found"), (2, "found"), (3, "not_found")):
        answer = run(home, whether(replace(CUP, quantity=number)))
        assert (answer.status, answer.count) == (status, 2)
        assert bool(answer.keyframes) == (status == "found") == (answer.reason is None)
    assert (answer.reason, answer.least) == ("never", 1)
    assert answer.otherwise is not None
    assert answer.otherwise.end == at(110)
    assert run(home, whether(replace(CUP, quantity=3), negated=True)).status == "not_found"
    asked = replace(whether(replace(CUP, quantity=3)), ask="where")
    assert run(home, asked).status == "found"  # no yes or no is asked for


@pytest.mark.parametrize(
    ("bound", "number", "status", "least"),
    [
        ("most", 1, "not_found", 2),
        ("most", 2, "found", 2),
        ("exactly", 1, "not_found", 2),
        ("exactly", 2, "found", 2),
        ("exactly", 3, "not_found", 2),
    ],
)
def test_another_number_than_asked_for_is_a_no(
    home: Home, bound: Bound, number: int, status: str, least: int
) -> None:
    home.thing("mug", "cup", paint="blue")
    home.seen("mug", 0, at=(9, 1, 1))
    home.seen("cup", 0, at=(1, 1, 1))
    home.met("mug", "cup", 0, 1)
    answer = run(home, whether(replace(CUP, quantity=number, bound=bound)))
    assert (answer.status, answer.count, answer.least) == (status, 2, least)
    wooden = replace(CUP, quantity=number, bound=bound, attributes=("wooden",))
    unjudged = run(home, whether(wooden))  # of two cups one may be wooden
    assert unjudged.status == ("not_found" if number > 2 else "found")


def test_nothing_moved_is_no_sighting_at_another_time(home: Home) -> None:
    query = FormalQuery("?", "Q3", "moved", time=TimeSlice(at(300), None))
    answer = run(home, query)
    assert (answer.status, answer.reason, answer.otherwise) == ("not_found", "never", None)


terms = st.builds(
    ObjectTerm,
    st.sampled_from(["cup", "bowl", "elephant", "piano", "object"]),
    attributes=st.lists(st.sampled_from([*PAINTS, "wooden", "big"]), max_size=2).map(tuple),
    without=st.lists(st.sampled_from(["red", "round"]), max_size=1).map(tuple),
)
slices = st.none() | st.builds(
    lambda a, b: TimeSlice(at(min(a, b)), at(max(a, b))),
    st.integers(-10, 250),
    st.integers(-10, 250),
)


@settings(deadline=None)
@given(
    st.lists(terms, min_size=1, max_size=3),
    st.none() | st.sampled_from(RELATION_KINDS),
    slices,
    st.sampled_from([None, "kitchen", "attic"]),
    st.sampled_from(["whether", "where", "when", "what", "count", "how_long", "moved", "missing"]),
    st.sampled_from(["all", "last", "first", "usual"]),
    st.booleans(),
)
def test_every_query_has_an_answer_of_the_contract(
    objects: list[ObjectTerm],
    kind: RelationKind | None,
    time: TimeSlice | None,
    place: str | None,
    ask: Ask,
    select: Select,
    negated: bool,
) -> None:
    home = Home(classes=("cup", "bowl", "elephant"))
    home.thing("cup", "cup", paint="red")
    home.thing("bowl", "bowl", paint="white")
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.seen("cup", 100, 110, at=(6, 1, 1), place=1, absent=150)
    home.seen("bowl", 5, 6, at=(1.4, 1, 1))
    home.met("bowl", "cup", 5, 6)
    home.room("kitchen", 0, 0, 3, 3)
    relation = Relation(kind) if kind else None
    form: Form = "Q2" if relation else "Q3"
    query = FormalQuery(
        "?",
        form,
        ask,
        tuple(objects),
        relation,
        place,
        time,
        select,
        negated,
    )
    answer = run(home, query)
    assert answer.status in ("found", "not_found", "unknown_object")
    assert (answer.status == "found") == bool(answer.keyframes)
    assert (answer.status == "found") == (answer.reason is None)
    assert all(0 <= k.score <= 1 for k in answer.keyframes)
    assert [k.rank for k in answer.keyframes] == list(range(1, len(answer.keyframes) + 1))
    assert answer.count <= len(answer.keyframes)
    if place == "attic" and answer.status != "unknown_object" and ask != "missing":
        assert "in the attic" in answer.unjudged or not answer.keyframes
    assert run(home, query).keyframes == answer.keyframes
    json = answer.to_json()
    assert json["schema"] == 1
