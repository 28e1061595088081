"""What will do as well, what is left out, several places, and what is to the contrary."""

from __future__ import annotations

from dataclasses import replace

import pytest

from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import LeaveOut, TakeIn, plan
from grammar.forms import FormalQuery, FormError, ObjectTerm, Relation
from tests.worlds.made import NOW, Home, Words
from tests.worlds.oracle import OracleStore

THING = ObjectTerm("object", "thing")


def whether(term: ObjectTerm, **more: object) -> FormalQuery:
    return FormalQuery("?", "Q1", "whether", (term,), **more)  # type: ignore[arg-type]


def run(home: Home, query: FormalQuery) -> Answer:
    store = home.into(OracleStore())
    return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def found(home: Home, query: FormalQuery) -> set[str]:
    return {keyframe.object_id for keyframe in run(home, query).keyframes}


@pytest.fixture
def home() -> Home:
    home = Home()
    for colour, x in (("red", 1.0), ("blue", 1.5), ("green", 6.0)):
        home.thing(f"cup-{colour}", "cup", paint=colour)
        home.seen(f"cup-{colour}", 0, 10, at=(x, 1, 1))
    home.thing("bowl-red", "bowl", paint="red")
    home.seen("bowl-red", 5, 30, at=(11, 1, 1))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("office", 4, -1, 9, 3)
    return home


def test_either_look_or_either_kind_will_do(home: Home) -> None:
    red, blue = ObjectTerm("cup", attributes=("red",)), ObjectTerm("cup", attributes=("blue",))
    assert found(home, whether(replace(red, or_else=(blue,)))) == {"cup-red", "cup-blue"}
    bowl = replace(ObjectTerm("bowl"), or_else=(blue,))
    assert found(home, whether(bowl)) == {"bowl-red", "cup-blue"}


@pytest.mark.parametrize("asked", [("red", "purple"), ("purple", "red")])
def test_what_may_be_one_of_two_is_no_answer_by_itself(home: Home, asked: tuple[str, str]) -> None:
    home.thing("rusty", "vase", paint=(152.0, 80.0, 45.0))
    home.seen("rusty", 0, 10, at=(2, 1, 1))
    first, second = (ObjectTerm("vase", attributes=(colour,)) for colour in asked)
    answer = run(home, whether(replace(first, or_else=(second,))))
    assert (answer.status, answer.keyframes) == ("not_found", ())
    (maybe,) = answer.perhaps
    assert maybe.object_id == "rusty"
    assert maybe.why["refused"] == ["red"]
    home.thing("red", "vase", paint="red")
    home.seen("red", 0, 10, at=(2, 2, 1))
    both = run(home, whether(replace(first, or_else=(second,))))
    assert both.keyframes[0].object_id == "red"
    assert both.count == 1


def test_what_is_seen_of_neither_is_a_no_and_an_unknown_word_is_only_one_of_two(home: Home) -> None:
    unicorn = ObjectTerm("unicorn")
    assert run(home, whether(replace(unicorn, or_else=(ObjectTerm("griffin"),)))).reason == "never"
    assert found(home, whether(replace(unicorn, or_else=(ObjectTerm("bowl"),)))) == {"bowl-red"}


def test_a_kind_that_is_left_out_is_not_told(home: Home) -> None:
    red = replace(THING, attributes=("red",))
    assert found(home, whether(red)) == {"cup-red", "bowl-red"}
    no_cup = run(home, whether(replace(red, other_than=(ObjectTerm("cup"),))))
    assert [k.object_id for k in no_cup.keyframes] == ["bowl-red"]
    assert no_cup.keyframes[0].why["attributes"]["not cup"] == 1.0
    but_the_red_cup = replace(THING, other_than=(ObjectTerm("cup", attributes=("red",)),))
    assert found(home, whether(but_the_red_cup)) == {"cup-blue", "cup-green", "bowl-red"}


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (ObjectTerm("unicorn"), "not unicorn"),
        (ObjectTerm("cup", attributes=("plastic",)), "not plastic cup"),
        (ObjectTerm("cup", owner="anna"), "not anna's cup"),
    ],
)
def test_what_cannot_be_told_is_not_left_out_and_said(
    home: Home, other: ObjectTerm, said: str
) -> None:
    answer = run(home, whether(replace(THING, other_than=(other,))))
    assert answer.count == 4
    assert said in answer.unjudged


def test_of_several_places_any_will_do_and_outside_is_in_none(home: Home) -> None:
    cup = whether(ObjectTerm("cup"), place="kitchen", or_places=("office",))
    assert found(home, cup) == {"cup-red", "cup-blue", "cup-green"}
    assert found(home, replace(cup, objects=(THING,), outside=True)) == {"bowl-red"}
    assert found(home, replace(cup, or_places=())) == {"cup-red", "cup-blue"}


def test_a_place_that_nobody_defined_may_be_where_it_is(home: Home) -> None:
    asked = whether(THING, place="kitchen", or_places=("attic",))
    answer = run(home, asked)
    assert answer.count == 4
    assert answer.unjudged == ("in the kitchen", "in the attic")
    outside = run(home, replace(asked, outside=True))
    assert {k.object_id for k in outside.keyframes} == {"cup-green", "bowl-red"}
    assert outside.unjudged == ("in the attic",)


def test_the_contrary_is_a_sighting_of_which_it_does_not_hold(home: Home) -> None:
    home.seen("cup-red", 100, 110, at=(6, 1, 1), place=1)
    denied = whether(ObjectTerm("cup", attributes=("red",)), place="kitchen", negated=True)
    assert [k.place for k in run(home, denied).keyframes] == ["kitchen"]
    assert [k.place for k in run(home, replace(denied, contrary=True)).keyframes] == ["office"]
    when = replace(denied, ask="when")
    contrary = run(home, replace(denied, contrary=True)).keyframes
    assert [k.start for k in run(home, when).keyframes] == [k.start for k in contrary]


def test_on_neither_is_where_no_ground_of_two_is(home: Home) -> None:
    home.thing("desk", "desk")
    home.seen("desk", 0, 30, at=(6.2, 1, 0.7))
    grounds = replace(ObjectTerm("desk"), or_else=(ObjectTerm("bowl"),))
    near = FormalQuery("?", "Q2", "what", (THING, grounds), Relation("near", negated=True))
    told = found(home, near)
    assert {"cup-red", "cup-blue"} <= told
    assert "cup-green" not in told


def test_the_plan_reads_like_the_question() -> None:
    cup = replace(ObjectTerm("cup"), or_else=(ObjectTerm("bowl"),), other_than=(ObjectTerm("mug"),))
    steps = plan(whether(cup)).steps
    assert TakeIn("x", ("x/1",)) in steps
    assert LeaveOut("x", ("x-1",)) in steps


@pytest.mark.parametrize(
    "wrong",
    [
        {"or_places": ("hall",)},
        {"negated": True, "contrary": True},
        {"place": "hall", "contrary": True},
    ],
)
def test_records_that_say_nothing_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(FormError):
        whether(THING, **wrong)


def test_an_alternative_is_no_more_than_a_noun_its_looks_and_its_owner() -> None:
    with pytest.raises(FormError):
        ObjectTerm("cup", or_else=(ObjectTerm("bowl", quantity=2),))
    with pytest.raises(FormError):
        ObjectTerm("cup", other_than=(ObjectTerm("bowl", or_else=(THING,)),))
