"""A green plant that was called a vase twice is no green vase, unless something says it is one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from d3a.store.base import TaughtName
from grammar.forms import FormalQuery, ObjectTerm
from tests.worlds.made import NOW, Home, Rgb, Words
from tests.worlds.oracle import OracleStore

CORNER, SHELF = (1.0, 1.0, 0.5), (8.0, 8.0, 1.0)
Spot = tuple[float, float, float]


def home(*, plant: str | Rgb = "green", at: Spot = CORNER, plant_views: float = 40.0) -> Home:
    """Return a home with a plant, and a green thing that was called a vase twice."""
    made = Home()
    made.thing("plant", "potted plant", paint=plant)
    made.thing("vase", "vase", paint="green")
    made.objects["plant"] = replace(made.objects["plant"], weight=plant_views)
    made.objects["vase"] = replace(made.objects["vase"], weight=1.8)
    made.seen("plant", 0, 50, at=CORNER, times=40)
    made.seen("vase", 60, 61, at=at, times=2)
    for number, paint in enumerate(("red", "blue", "white", "brown", "orange")):
        made.thing(paint, "bowl", paint=paint)
        made.seen(paint, 5 * number, at=(number, 5, 1))
    return made


def asked(made: Home, word: str = "vase", *attributes: str) -> Answer:
    query = FormalQuery("?", "Q1", "whether", (ObjectTerm(word, word, attributes=attributes),))
    store = made.into(OracleStore())
    return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def test_what_looks_like_its_better_known_neighbour_is_miscalled() -> None:
    answer = asked(home(), "vase", "green")
    assert (answer.status, answer.reason) == ("not_found", "never")
    assert answer.keyframes == ()


@pytest.mark.parametrize(
    "made",
    [
        home(plant="brown"),  # it looks otherwise
        home(at=SHELF),  # it lies elsewhere
        home(plant_views=3.0),  # the plant is hardly better known
    ],
    ids=["looks", "place", "views"],
)
def test_what_differs_from_its_neighbour_is_what_it_is_called(made: Home) -> None:
    assert [k.object_id for k in asked(made, "vase", "green").keyframes] == ["vase"]


def test_one_picture_of_both_shows_that_there_are_two() -> None:
    both = home()
    both.met("plant", "vase", 60)
    assert asked(both, "vase", "green").status == "found"


def test_a_thing_that_a_person_named_is_what_it_was_called() -> None:
    named = home()
    names = (TaughtName("excalibur"),)
    named.objects["vase"] = replace(named.objects["vase"], names=names)
    assert asked(named, "excalibur", "green").status == "found"
    assert asked(named, "vase", "green").status == "not_found"


def test_a_yes_that_rests_on_more_is_not_looked_at_again() -> None:
    more = home()
    more.thing("other", "vase", paint="green")
    more.objects["other"] = replace(more.objects["other"], weight=20.0)
    more.seen("other", 70, 75, at=SHELF, times=20)
    ids = [k.object_id for k in asked(more, "vase", "green").keyframes]
    assert ids == ["other", "vase"]


def test_without_looks_nothing_is_miscalled() -> None:
    assert asked(home(), "vase").status == "found"
