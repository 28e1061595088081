"""What went missing in a slice: gone since it began, not merely gone in it too."""

from __future__ import annotations

import pytest

from d3a.answer import Answer
from d3a.answering.departures import Left, Looks, share_left
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from d3a.store.base import View
from grammar.forms import FormalQuery, TimeSlice
from tests.worlds.made import Home, Words, at
from tests.worlds.oracle import OracleStore

HOUR = 60.0
NOW = at(24 * HOUR)
"""After all looks: an answer goes by what was seen until then."""
SPOT = (2.0, 0.0, 0.5)


def missing(home: Home, start: float | None = None, end: float | None = None) -> Answer:
    bounded = start is not None or end is not None
    time = TimeSlice(None if start is None else at(start), None if end is None else at(end))
    asked = FormalQuery("?", "Q3", "missing", (), None, None, time if bounded else None)
    store = home.into(OracleStore())
    return execute(plan(asked), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def names(answer: Answer) -> list[str]:
    return [keyframe.object_id for keyframe in answer.keyframes]


def looked_at(absent: float, *looks: float) -> Home:
    """Return a home whose apple three looks found; `looks` are those after it was seen last."""
    home = Home()
    home.thing("apple", "apple")
    for minute in (0, HOUR, 2 * HOUR):
        home.seen("apple", minute, minute + 1, at=SPOT, absent=absent)
    home.views.clear()
    for minute in (0, HOUR, 2 * HOUR, *looks):
        home.look(minute, 0.0, 0.0)
    return home


def test_what_a_look_before_the_slice_was_in_vain_for_went_before_it() -> None:
    home = looked_at(20 * HOUR, 6 * HOUR, 16 * HOUR, 20 * HOUR)
    assert names(missing(home)) == ["apple"]
    assert missing(home, 10 * HOUR).status == "not_found"
    before = missing(home, 0, 10 * HOUR)  # it was last seen gone after that
    assert names(before) == ["apple"]
    assert 0.5 < before.keyframes[0].why["relation"] < 1.0
    assert names(missing(home, 0)) == ["apple"]


def test_without_a_look_between_it_is_missing_from_when_it_could_be_noticed() -> None:
    home = looked_at(20 * HOUR, 20 * HOUR)
    assert names(missing(home, 19 * HOUR)) == ["apple"]
    assert names(missing(home, 3 * HOUR, 19 * HOUR)) == ["apple"]  # most of the pause
    assert missing(home, 2 * HOUR, 4 * HOUR).status == "not_found"
    assert missing(home, 21 * HOUR).status == "not_found"


def test_looks_that_find_it_seldom_tell_little() -> None:
    """What nine of ten looks miss may well have been there in one more."""

    def share(*found: float) -> float:
        home = Home()
        home.thing("apple", "apple")
        for hour in (0.0, *found, 29.0):
            home.seen("apple", hour * HOUR, at=SPOT, absent=50 * HOUR)
        home.views.clear()
        for hour in (*range(30), 46):
            home.look(hour * HOUR, 0.0, 0.0)
        stay = home.stays["apple", 0]
        left = Left(home.sightings, stay, Home.minute(50 * HOUR))
        end = left.absent_ms + 1
        return share_left(left, Looks(home.views), 0.6, Home.minute(47 * HOUR), end)

    assert share(10, 20) > 4 * share(*range(1, 29))


@pytest.mark.parametrize("x", [5.0, -5.0])
def test_a_look_elsewhere_says_nothing(x: float) -> None:
    """Views look along x for 3 m: what is behind them or too far off is not in them."""
    home = looked_at(20 * HOUR)
    home.look(6 * HOUR, x, 0.0)
    assert names(missing(home, 10 * HOUR)) == ["apple"]


def test_without_poses_the_last_look_decides() -> None:
    home = looked_at(20 * HOUR)
    home.views = [View(Home.minute(0), Home.minute(20 * HOUR), 9)]
    assert names(missing(home, 19 * HOUR)) == ["apple"]
    assert missing(home, None, HOUR).status == "not_found"
