"""A relation that is asked of now: each of its things is judged, whichever is said first."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta

import pytest

from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from grammar.forms import FormalQuery, ObjectTerm, Relation, RelationKind
from tests.worlds.made import NOON, NOW, Home, Words
from tests.worlds.oracle import OracleStore

BAG, COUCH, KEY = ObjectTerm("handbag"), ObjectTerm("couch"), ObjectTerm("key")
THING = ObjectTerm("object")
ON, UNDER = (180.0, 170.0, 220.0, 230.0), (100.0, 200.0, 300.0, 400.0)


@pytest.fixture
def home() -> Home:
    """A bag on a couch, which is seen until later; then a bag in the hall, seen in no round."""
    home = Home()
    home.room("living room", -1, -1, 3, 3)
    home.room("hall", 5, -1, 9, 3)
    home.thing("couch", "couch")
    home.thing("bag", "handbag")
    for minute in (10, 100, 200):
        home.seen("couch", minute, minute + 5, at=(1, 1, 0.4), box=UNDER)
    home.seen("bag", 10, 15, at=(1, 1, 0.7), box=ON)
    home.met("bag", "couch", 10, 15, boxes=(ON, UNDER))
    return home


def run(home: Home, kind: RelationKind, *things: ObjectTerm, ask: str = "whether") -> Answer:
    asked = FormalQuery("?", "Q2", "whether", things, Relation(kind), select="last")
    asked = replace(asked, ask="what") if ask == "what" else asked
    store = home.into(OracleStore())
    return execute(plan(asked), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def seen_in_the_hall(home: Home) -> None:
    home.thing("bag-again", "handbag")
    home.seen("bag-again", 100, 105, at=(7, 1, 0.4))


@pytest.mark.parametrize(
    ("kind", "things"), [("on", (BAG, COUCH)), ("under", (COUCH, BAG)), ("near", (COUCH, BAG))]
)
def test_what_stands_beside_is_doubted_as_what_is_asked_for(
    home: Home, kind: RelationKind, things: tuple[ObjectTerm, ...]
) -> None:
    assert run(home, kind, *things).otherwise is None
    seen_in_the_hall(home)
    answer = run(home, kind, *things)
    assert answer.status == "found"
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "bag-again"


def test_what_stays_is_told_as_it_was_seen_with_what_is_carried(home: Home) -> None:
    told = run(home, "under", COUCH, BAG).keyframes
    assert {keyframe.end for keyframe in told} == {NOON + timedelta(minutes=15)}


def test_of_a_ground_that_left_it_is_told_where_it_is(home: Home) -> None:
    home.seen("bag", 100, 105, at=(7, 1, 0.4), place=1)
    answer = run(home, "under", COUCH, BAG)
    assert (answer.status, answer.reason) == ("not_found", "gone")
    assert answer.otherwise is not None
    assert (answer.otherwise.object_id, answer.otherwise.place) == ("bag", "hall")
    assert answer.message is not None
    assert "handbag" in answer.message


def test_a_list_leaves_out_what_stands_beside_what_may_be_elsewhere(home: Home) -> None:
    seen_in_the_hall(home)
    home.thing("bench", "bench")
    home.seen("bench", 100, 105, at=(7, 1.4, 0.4))
    beside = run(home, "near", THING, BAG, ask="what")
    assert {k.object_id for k in beside.keyframes} - {"bag-again"} == {"bench"}


def test_one_that_is_sure_is_enough(home: Home) -> None:
    """Of two bags on the couch one was not seen elsewhere by any other of its kind."""
    seen_in_the_hall(home)
    home.thing("pouch", "handbag")
    home.seen("pouch", 99, 106, at=(1.3, 1, 0.7), box=ON)
    home.met("pouch", "couch", 100, 105, boxes=(ON, UNDER))
    answer = run(home, "under", COUCH, BAG)
    assert answer.otherwise is None
    assert {k.object_id for k in answer.keyframes} == {"couch", "pouch"}
