"""Whether a thing stood so at a moment: what was seen nearest to it on either side tells."""

from __future__ import annotations

from datetime import timedelta

import pytest

from assistant.reply import sentence
from d3a.answer import Answer
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from grammar.forms import FormalQuery, ObjectTerm, Relation, TimeSlice
from tests.worlds.made import NOON, NOW, Home, Words
from tests.worlds.oracle import OracleStore

ON, UNDER = (180.0, 170.0, 220.0, 230.0), (100.0, 200.0, 300.0, 400.0)
LAPTOP, DESK = ObjectTerm("laptop"), ObjectTerm("desk")


@pytest.fixture
def home() -> Home:
    """A laptop on the desk of the study at 12:10 and at 15:20."""
    home = Home()
    home.room("study", -1, -1, 3, 3)
    home.room("kitchen", 5, -1, 9, 3)
    home.thing("desk", "desk")
    home.thing("laptop", "laptop")
    for minute in (10, 200):
        home.seen("desk", minute, minute + 5, at=(1, 1, 0.7), box=UNDER)
        home.seen("laptop", minute, minute + 5, at=(1, 1, 0.8), box=ON)
        home.met("laptop", "desk", minute, minute + 5, boxes=(ON, UNDER))
    return home


def asked(home: Home, minute: float, *, room: str | None = None) -> Answer:
    at = NOON + timedelta(minutes=minute)
    time = TimeSlice(at, at)
    text = "Was the laptop there then?"
    query = FormalQuery(text, "Q2", "whether", (LAPTOP, DESK), Relation("on"), time=time)
    if room is not None:
        query = FormalQuery(text, "Q3", "whether", (LAPTOP,), place=room, time=time)
    store = home.into(OracleStore())
    return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


@pytest.mark.parametrize("room", [None, "study"])
def test_what_was_so_on_either_side_is_told_of_both(home: Home, room: str | None) -> None:
    answer = asked(home, 100, room=room)
    assert {k.start for k in answer.keyframes if k.category == "laptop"} == {
        NOON + timedelta(minutes=minute) for minute in (10, 200)
    }
    assert answer.otherwise is None


@pytest.mark.parametrize("name", ["laptop", "another"])
@pytest.mark.parametrize("room", [None, "study"])
def test_what_was_seen_elsewhere_in_between_counts(home: Home, name: str, room: str | None) -> None:
    if name != "laptop":
        home.thing(name, "laptop")
    home.seen(name, 90, 95, at=(7, 1, 1), place=1)
    answer = asked(home, 100, room=room)
    assert {k.start for k in answer.keyframes if k.category == "laptop"} == {
        NOON + timedelta(minutes=200)
    }
    assert answer.otherwise is not None
    assert (answer.otherwise.object_id, answer.otherwise.place) == (name, "kitchen")
    said = sentence(answer, now=NOW)
    assert said.index("in the kitchen. I next saw it ") < said.index("today at 15:20")
    before = asked(home, 50, room=room)
    assert {k.start for k in before.keyframes if k.category == "laptop"} == {
        NOON + timedelta(minutes=10)
    }
    assert "I next saw" in sentence(before, now=NOW)


def test_what_was_seen_elsewhere_at_that_moment_is_a_no(home: Home) -> None:
    home.thing("another", "laptop")
    home.seen("another", 90, 95, at=(7, 1, 1))
    answer = asked(home, 92)
    assert (answer.status, answer.reason) == ("not_found", "not_there")
    assert sentence(answer, now=NOW).endswith("I was seeing it then, in the kitchen.")


def test_one_that_a_round_showed_beside_it_says_nothing_of_it(home: Home) -> None:
    home.thing("another", "laptop")
    for minute in (12, 90):
        home.seen("another", minute, minute + 3, at=(7, 1, 1))
    answer = asked(home, 100)
    assert len({k.start for k in answer.keyframes if k.category == "laptop"}) == 2
    assert answer.otherwise is None
