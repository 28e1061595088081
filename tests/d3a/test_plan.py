"""The plan of each form, as data."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import timedelta

import pytest

from d3a.parameters import PAPER
from d3a.plan import (
    Cover,
    ExplainEmpty,
    FilterPlace,
    FindEdge,
    FindLandmarks,
    FindObjects,
    FindSightings,
    FindStays,
    JudgeAttributes,
    KeepInRoom,
    KeepMissing,
    KeepMoved,
    KeepPresent,
    KeepUsual,
    Measure,
    Precision,
    Rank,
    Relate,
    Unite,
    numbers_unjudged,
    plan,
)
from grammar.forms import Ask, FormalQuery, ObjectTerm, Relation, TimeSlice, Where
from tests.worlds.made import NOON

CUP = ObjectTerm("cup", "mug", attributes=("pink",), owner="anna")
BOWL = ObjectTerm("bowl")
SLICE = TimeSlice(NOON, NOON + timedelta(hours=1))
END = (FindLandmarks("x"), Cover(None), ExplainEmpty(("x",)))


def test_q1_finds_judges_and_ranks() -> None:
    query = FormalQuery("", "Q1", "whether", (CUP,))
    assert plan(query).steps == (
        FindObjects("x", "cup", "mug", "anna", votes=True),
        JudgeAttributes("x", ("pink",), doubts=True),
        FindSightings("x", select="all"),
        FindStays("x"),
        Measure("whether", "x"),
        Rank(("x",), "all", spread=True),
        *END,
    )


@pytest.mark.parametrize(
    "query",
    [
        FormalQuery("", "Q1", "count", (BOWL,)),
        FormalQuery("", "Q1", "how_often", (BOWL,)),
        FormalQuery("", "Q1", "where", (BOWL,), place="kitchen"),
        FormalQuery("", "Q1", "where", (BOWL,), select="usual"),
        FormalQuery("", "Q1", "whether", (replace(BOWL, quantity=2),)),
        FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("on")),
    ],
)
def test_what_is_counted_or_sifted_is_read_as_a_whole(query: FormalQuery) -> None:
    finds = [step for step in plan(query).steps if isinstance(step, FindSightings)]
    assert [find.select for find in finds] == [None] * len(query.objects)


def test_q3_asks_for_the_slice_and_the_place() -> None:
    query = FormalQuery("", "Q3", "where", (BOWL,), place="kitchen", time=SLICE, select="last")
    assert plan(query).steps == (
        FindObjects("x", "bowl", "bowl", votes=True),
        FindSightings("x", SLICE.start, SLICE.end),
        FindStays("x"),
        FilterPlace("x", "kitchen"),
        Measure("where", "x"),
        Rank(("x",), "last", spread=False),
        FindLandmarks("x"),
        Cover("kitchen"),
        ExplainEmpty(("x",), SLICE, "kitchen"),
    )


def test_q2_joins_both_objects_in_the_slice() -> None:
    query = FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("together"), time=SLICE)
    steps = plan(query).steps
    assert steps.index(FindObjects("y", "bowl", "bowl")) == 2  # before any sighting is read
    assert Relate("together", ("x", "y"), start=SLICE.start, end=SLICE.end) in steps


def test_point_in_time_asks_for_the_sightings_before_and_after() -> None:
    query = FormalQuery("", "Q3", "where", (BOWL,), time=TimeSlice(NOON, NOON))
    steps = plan(query).steps
    assert steps[1:3] == (FindEdge("x", "last", NOON), FindEdge("x", "first", NOON))
    assert not any(isinstance(step, FindSightings) for step in steps)


def test_description_narrows_the_object_before_it_is_related() -> None:
    table = ObjectTerm("table", where=Where("near", ObjectTerm("door")))
    query = FormalQuery("", "Q2", "where", (CUP, table), Relation("on"))
    steps = list(plan(query).steps)
    described = steps.index(Relate("near", ("y", "y.1"), keep="figure"))
    assert FindObjects("y.1", "door", "door") in steps[:described]
    assert described < steps.index(Relate("on", ("x", "y")))


@pytest.mark.parametrize(
    ("ask", "negated", "expected"), [("when", True, True), ("whether", True, False)]
)
def test_negation_seeks_absence_unless_the_answer_is_yes_or_no(
    ask: str, negated: bool, expected: bool
) -> None:
    query = FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("on"), negated=negated)
    query = replace(query, ask=ask)  # type: ignore[arg-type]
    relate = next(step for step in plan(query).steps if isinstance(step, Relate))
    assert relate.negated is expected


@pytest.mark.parametrize(
    ("ask", "select", "step"),
    [
        ("moved", "all", KeepMoved("x", SLICE.start, SLICE.end)),
        ("missing", "all", KeepMissing("x", SLICE.start, SLICE.end)),
        ("where", "usual", KeepUsual("x", SLICE.start, SLICE.end)),
    ],
)
def test_questions_over_the_memory_look_at_all_of_it(ask: str, select: str, step: object) -> None:
    query = FormalQuery("", "Q3", "where", (BOWL,), time=SLICE)
    steps = plan(replace(query, ask=ask, select=select)).steps  # type: ignore[arg-type]
    assert step in steps
    assert FindSightings("x") in steps


@pytest.mark.parametrize(
    ("ask", "select", "kind"),
    [("moved", "all", KeepMoved), ("missing", "all", KeepMissing), ("where", "usual", KeepUsual)],
)
def test_each_of_several_things_is_looked_at_or_the_figure_of_a_relation(
    ask: str, select: str, kind: type[KeepMoved | KeepMissing | KeepUsual]
) -> None:
    query = FormalQuery("", "Q3", "where", (CUP, BOWL))
    asked = replace(query, ask=ask, select=select)  # type: ignore[arg-type]
    assert [s.var for s in plan(asked).steps if isinstance(s, kind)] == ["x", "y"]
    related = replace(asked, relation=Relation("on"))
    assert [s.var for s in plan(related).steps if isinstance(s, kind)] == ["x"]
    assert Relate("on", ("x", "y"), keep="figure") in plan(related).steps


def test_when_it_usually_is_so_asks_for_all_times() -> None:
    query = FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("on"), select="usual")
    found = plan(query)
    assert found.query == query
    assert found.steps == plan(replace(query, select="all")).steps


def test_what_moved_needs_no_object() -> None:
    assert plan(FormalQuery("", "Q1", "moved")).steps[0] == FindObjects("x", "object", "object")


def test_precision_is_forced_on_every_object() -> None:
    query = FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("together"))
    finds = [s for s in plan(query, precision="any").steps if isinstance(s, FindObjects)]
    assert [find.precision for find in finds] == ["any", "any"]


@pytest.mark.parametrize(
    ("precision", "judges"),
    [("perfect", True), ("category", False), ("attribute", True), ("any", False)],
)
def test_attributes_are_judged_where_the_precision_says_so(
    precision: Precision, judges: bool
) -> None:
    steps = plan(FormalQuery("", "Q1", "whether", (CUP,)), precision=precision).steps
    assert any(isinstance(step, JudgeAttributes) for step in steps) is judges
    assert not any(isinstance(step, FindObjects) and step.votes for step in steps)


def test_the_paper_answers_together_by_the_union() -> None:
    query = FormalQuery("", "Q2", "when", (CUP, BOWL), Relation("together"), time=SLICE)
    steps = plan(query, parameters=PAPER).steps
    assert Unite("together", ("x", "y")) in steps
    assert not any(isinstance(step, Relate) for step in steps)
    assert Rank(("x", "y"), "all", spread=True) in steps
    beside = replace(query, relation=Relation("near"))
    assert plan(beside, parameters=PAPER) == plan(beside)
    apart = replace(query, negated=True)  # a union has no opposite
    assert plan(apart, parameters=PAPER) == plan(apart)


def test_the_present_keeps_what_is_so_still() -> None:
    query = FormalQuery("", "Q2", "what", (ObjectTerm("object"), BOWL), Relation("on"))
    assert KeepPresent("x") not in plan(query).steps
    steps = plan(replace(query, select="last")).steps
    assert steps.index(KeepPresent("x")) > steps.index(Relate("on", ("x", "y")))
    assert Rank(("x",), "all", spread=True) in steps


def test_only_a_noun_of_several_words_may_name_a_room() -> None:
    table = ObjectTerm("dining table", "kitchen table")
    query = FormalQuery("", "Q2", "where", (CUP, table), Relation("on"))
    rooms = [step for step in plan(query).steps if isinstance(step, KeepInRoom)]
    assert rooms == [KeepInRoom("y")]


def test_plan_is_printable_as_data_and_as_lines() -> None:
    query = FormalQuery("", "Q3", "where", (CUP,), time=SLICE)
    steps = plan(query)
    assert json.loads(json.dumps(steps.to_json()))[0] == {
        "step": "FindObjects",
        "var": "x",
        "category": "cup",
        "word": "mug",
        "owner": "anna",
        "votes": True,
    }
    assert steps.lines()[1] == "judge attributes x, attributes pink, doubts"
    assert len(steps.lines()) == len(steps.steps)


@pytest.mark.parametrize(
    ("ask", "negated", "outside", "kept_outside"),
    [
        ("whether", False, True, True),
        ("whether", True, True, True),
        ("whether", True, False, False),
        ("what", True, False, True),
        ("what", True, True, False),
    ],
)
def test_a_place_where_it_must_not_be(
    ask: Ask, negated: bool, outside: bool, kept_outside: bool
) -> None:
    query = FormalQuery("", "Q3", ask, (BOWL,), place="hall", negated=negated, outside=outside)
    steps = plan(query).steps
    assert FilterPlace("x", "hall", kept_outside) in steps
    assert Cover(None if outside else "hall") in steps


def test_whose_it_must_not_be_is_said_to_the_store() -> None:
    step = plan(FormalQuery("", "Q1", "whether", (replace(BOWL, not_owner="anna"),))).steps[0]
    assert isinstance(step, FindObjects)
    assert step.not_owner == "anna"


@pytest.mark.parametrize(
    ("ask", "relation", "unjudged"),
    [
        ("whether", None, 0),
        ("whether", Relation("on"), 1),
        ("whether", Relation("together"), 2),
        ("when", None, 1),
        ("where", Relation("near"), 2),
    ],
)
def test_bounded_numbers_are_judged_of_what_was_seen_alone(
    ask: Ask, relation: Relation | None, unjudged: int
) -> None:
    term = replace(BOWL, quantity=2, bound="most")
    objects = (term,) if relation is None else (term, replace(CUP, quantity=3, bound="exactly"))
    assert len(numbers_unjudged(FormalQuery("", "Q1", ask, objects, relation))) == unjudged


def test_what_was_last_seen_somewhere_need_not_be_there_now() -> None:
    query = FormalQuery("", "Q3", "what", (BOWL,), place="hall", select="last")
    kept, chosen = plan(query).steps, plan(query, sighting=True).steps
    assert KeepPresent("x") in kept
    assert Rank(("x",), "all", spread=True) in kept
    assert KeepPresent("x") not in chosen
    assert Rank(("x",), "last", spread=False) in chosen
