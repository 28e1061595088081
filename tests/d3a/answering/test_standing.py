"""What stood at its places at one time, though nothing shows it so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering import standing
from d3a.answering.joined import between_moments
from d3a.answering.joins import Asked
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.answering.standing import stood_together, within_reach
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from d3a.store.base import ObjectRecord, Sighting, StayRecord
from grammar.forms import FormalQuery, ObjectTerm, Relation, RelationKind, TimeSlice
from tests.worlds.made import NOW, Home, Words, at
from tests.worlds.oracle import OracleStore

BOX = (0.0, 0.0, 1.0, 1.0)
Seen = Sequence[tuple[int, int]]


def found(name: str, seen: Seen, *, far: float = 0.0) -> Found:
    """A thing seen at places, each `far` further along x, for a moment each: (place, time)."""
    table = Found({name: Candidate(ObjectRecord(name, name, 1.0, 0, 999), 1.0)})
    for place, time in seen:
        table.sightings.append(Sighting(name, place, time, time, f"f{time}", 0.9, BOX))
    for place in {place for place, _ in seen}:
        times = [time for where, time in seen if where == place]
        position = (float(place), far, 0.0)
        stay = StayRecord(name, place, position, min(times), max(times), 1.0)
        table.stays[stay.key] = stay
    return table


def test_things_seen_by_turns_stood_together_and_are_told_as_seen_last() -> None:
    couch, tv = found("couch", [(0, 10), (0, 30)]), found("tv", [(0, 20), (0, 40)])
    (link,) = stood_together(couch, tv, 1.0)
    assert (link.figure, link.ground, link.standing) == (("couch", 0), ("tv", 0), (20, 30))
    assert (link.start_ms, link.end_ms) == (30, 30)
    assert [s.start_ms for s in link.seen()] == [30, 20]
    assert not stood_together(couch, found("tv", [(0, 20), (0, 40)], far=1.5), 1.0)
    assert not stood_together(couch, couch, 1.0)  # nothing stands beside itself


def test_the_other_s_sighting_tells_where_the_figure_was_seen_only_before_and_after() -> None:
    (link,) = stood_together(found("a", [(0, 10), (0, 50)]), found("b", [(0, 30)]), 1.0)
    assert (link.start_ms, [s.start_ms for s in link.seen()]) == (30, [10, 30])


def test_what_was_elsewhere_in_between_did_not_stand_there() -> None:
    tv = found("tv", [(0, 25)])
    assert stood_together(found("cup", [(0, 10), (0, 30)]), tv, 0.5)
    assert not stood_together(found("cup", [(0, 10), (1, 20), (1, 28), (0, 30)]), tv, 0.5)


def test_what_was_seen_but_once_stands_nowhere() -> None:
    tv, once = found("tv", [(0, 10), (0, 30)]), found("cup", [(0, 20)])
    assert stood_together(once, tv, 1.0)
    once.candidates["cup"] = Candidate(ObjectRecord("cup", "cup", 1.0, 0, 9, tentative=True), 1.0)
    assert not stood_together(once, tv, 1.0)


def test_of_what_is_much_the_newest_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    moving = found("cup", [(k, k) for k in range(8)])
    shelf = found("shelf", [(0, 0), (0, 99)])
    monkeypatch.setattr(standing, "MOST_RUNS", 5)
    assert [k.figure[1] for k in stood_together(moving, shelf, 9.0)] == [3, 4, 5, 6, 7]
    monkeypatch.setattr(standing, "MOST_STOOD", 2)
    assert [k.figure[1] for k in stood_together(moving, shelf, 9.0)] == [6, 7]


places = st.lists(st.tuples(*[st.integers(0, 6)] * 3), max_size=9)


@given(here=places, there=places, reach=st.integers(0, 4))
def test_within_reach_is_what_a_loop_over_all_finds(
    here: list[tuple[int, int, int]], there: list[tuple[int, int, int]], reach: int
) -> None:
    one, other = (np.array(each, dtype=float).reshape(-1, 3) for each in (here, there))
    rows, columns = within_reach(one, other, float(reach))
    near = [
        (i, j)
        for i, a in enumerate(one)
        for j, b in enumerate(other)
        if np.linalg.norm(a - b) <= reach
    ]
    assert sorted(zip(rows.tolist(), columns.tolist(), strict=True)) == near


def by_turns() -> Home:
    home = Home()
    for name, category, x, first in (
        ("l", "lamp", 0.0, 0),
        ("c", "cup", 1.0, 5),
        ("b", "book", 2.0, 10),
    ):
        home.thing(name, category)
        home.seen(name, first, at=(x, 0, 0))
        home.seen(name, first + 60, at=(x, 0, 0))
    return home


def asked(kind: RelationKind, *words: str, negated: bool = False) -> FormalQuery:
    terms = tuple(ObjectTerm(word, word) for word in words)
    return FormalQuery(
        "?", "Q2", "whether", terms, Relation(kind, negated), None, None, "all", False
    )


@pytest.mark.parametrize(
    ("query", "told"),
    [
        (asked("between", "cup", "lamp", "book"), ["c", "l", "b"] * 2),
        (asked("between", "lamp", "cup", "book"), []),
        (asked("near", "cup", "lamp"), ["c", "l"] * 2),
        (asked("near", "book", "lamp"), []),
        (asked("near", "cup", "lamp", negated=True), ["c"]),  # when the lamp was seen no more
        (asked("near", "book", "lamp", negated=True), ["b", "b"]),
    ],
)
def test_what_no_frame_shows_is_judged_by_where_things_stood(
    query: FormalQuery, told: list[str]
) -> None:
    store = by_turns().into(OracleStore())
    answer = execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)
    assert [k.object_id for k in answer.keyframes] == told


def test_what_stands_between_is_told_by_what_was_seen_of_any_while_all_stood() -> None:
    cup = found("cup", [(1, 5), (1, 65)])
    lamp, book = found("lamp", [(0, 0), (0, 60)]), found("book", [(2, 10), (2, 70)])
    related = [Asked("between", cup, each, DEFAULT) for each in (lamp, book)]
    met = [each.judged(each.links(())) for each in related]
    moments = between_moments(cup, [lamp, book], met, ())
    assert [(moment.start_ms, moment.end_ms) for moment in moments] == [(10, 10), (60, 60)]
    told = [[entry.sighting.start_ms for entry in moment.entries] for moment in moments]
    assert told == [[5, 0, 10], [65, 60, 70]]


@pytest.mark.parametrize(
    ("ground", "told"),
    [
        ("couch", ["c-0-5", "c-0-30", "c-0-65"]),  # never carried, it stood there all the time
        ("lamp", ["c-0-5", "c-0-65"]),  # half an hour from either time that it was seen there
    ],
)
def test_what_may_be_carried_stood_beside_what_one_round_showed(
    ground: str, told: list[str]
) -> None:
    home = Home()
    home.thing("l", ground, extent_m=(1.5, 0.8) if ground == "couch" else None)
    home.thing("c", "cup")
    for name, x, times in (("l", 0.0, (0, 60)), ("c", 1.0, (5, 30, 65))):
        for time in times:
            home.seen(name, time, at=(x, 0, 0))
    store = home.into(OracleStore())
    query = asked("near", "cup", ground)
    whole = execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)
    shown = {k.frame for k in whole.keyframes if k.object_id == "c"}
    assert shown == {*told}
    within = replace(query, time=TimeSlice(at(25), at(35)))  # the ground was seen before and after
    answer = execute(plan(within), store, Words(), now=NOW, limit=50, parameters=DEFAULT)
    within_it = ["c-0-30", "l-0-0"] if "c-0-30" in told else []
    assert [k.frame for k in answer.keyframes] == within_it


def test_a_thing_that_moved_is_not_where_it_was_until_it_was_seen_elsewhere() -> None:
    home = Home()
    home.thing("bear", "teddy bear", extent_m=(0.3, 0.4))
    home.thing("l", "couch", extent_m=(1.9, 0.8))
    for time, place in ((0, 0), (280, 1), (600, 0)):
        home.seen("bear", time, at=(0.5 + 4.0 * place, 0, 0), place=place)
    for time in (0, 275, 600):
        home.seen("l", time, at=(0, 0, 0))
    store = home.into(OracleStore())
    query = asked("near", "teddy bear", "couch")
    whole = execute(plan(query), store, Words(), now=at(600), limit=50, parameters=DEFAULT)
    assert {k.frame for k in whole.keyframes} == {"bear-0-0", "l-0-0", "bear-0-600", "l-0-600"}
    afternoon = replace(query, time=TimeSlice(at(240), at(480)))
    answer = execute(plan(afternoon), store, Words(), now=at(600), limit=50, parameters=DEFAULT)
    assert (answer.status, answer.reason) == ("not_found", "not_there")


@pytest.mark.parametrize("kind", ["near", "on", "above", "left_of"])
def test_a_wall_parts_what_no_frame_shows_together(kind: RelationKind) -> None:
    viewer = (0.0, -3.0, 1.2, -0.5, 0.5, -0.5, 0.5)
    home = Home()
    home.thing("l", "couch", extent_m=(1.9, 0.8))
    home.thing("c", "cup", extent_m=(0.1, 0.1))
    wall = 0.0 if kind == "left_of" else 0.5
    beside = wall - 0.2 if kind == "left_of" else wall + 0.1
    for time in (0, 60):
        home.seen("l", time, time + 5, at=(0.4, 0, 0.4), viewer=viewer)
        home.seen("c", time, time + 5, at=(beside, 0, 0.86), viewer=viewer)

    def status() -> str:
        store, query = home.into(OracleStore()), asked(kind, "cup", "couch")
        return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT).status

    assert status() == "found"
    home.room("kitchen", -1.0, -1.0, wall, 1.0)
    assert status() == "found"  # the other is in no room that is known
    home.room("hall", wall, -1.0, 3.0, 1.0)
    assert status() == "not_found"
    shown = ((40, 10, 60, 30), (50, 30, 120, 80))
    home.met("c", "l", 0, boxes=shown, viewer=viewer)
    assert status() == "found"
