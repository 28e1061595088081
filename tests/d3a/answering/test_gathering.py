"""So many things together: against a loop over all choices of them, and walked as a plan."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answer import Answer
from d3a.answering.gathering import Ties, gathered, scattered
from d3a.answering.joins import Related
from d3a.answering.linked import Link
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import Gather, Unite, numbers_together, plan
from d3a.store.base import ObjectRecord, Sighting, Store
from grammar.forms import FormalQuery, ObjectTerm, Relation
from tests.worlds.made import NOW, Home, Words, at
from tests.worlds.oracle import OracleStore

BOX = (0.0, 0.0, 1.0, 1.0)
KINDS = {"a": 0, "b": 1}
Met = tuple[str, str, int, int, float]
names = st.sampled_from([f"{kind}{number}" for kind in KINDS for number in range(5)])
meetings = st.lists(
    st.tuples(names, names, st.integers(0, 6), st.integers(0, 3), st.floats(0, 1)),
    max_size=30,
    unique_by=lambda met: frozenset(met[:2]),  # two things meet once: a choice has one span
)


def tables_of() -> list[Found]:
    tables = [Found(), Found()]
    for kind, var in KINDS.items():
        for number in range(5):
            name = f"{kind}{number}"
            record = ObjectRecord(name, kind, 1.0, 0, 99)
            tables[var].candidates[name] = Candidate(record, 1.0)
            tables[var].sightings.append(Sighting(name, 0, 0, 9, "f", 0.9, BOX))
    return tables


def ties_of(tables: list[Found], met: list[Met]) -> Ties:
    """Return the ties of meetings as joins give them: by variables, the first name's first."""
    ties = Ties(tables)
    for vars_ in ((0, 0), (0, 1), (1, 1)):
        links, held = [], []
        for one, other, start, length, p in met:
            a, b = sorted((one, other))
            if a != b and (KINDS[a[0]], KINDS[b[0]]) == vars_:
                span = start, start + length
                seen = tuple(Sighting(name, 0, *span, "f", 0.9, BOX) for name in (a, b))
                links.append(Link((a, 0), (b, 0), *span, sightings=(seen[0], seen[1])))
                held.append(p)
        ties.add(*vars_, Related(links, np.array(held)))
    return ties


def groups_of(met: list[Met], numbers: tuple[int, int]) -> dict[frozenset[str], float]:
    """Return every choice of so many of each that all met at one time, and how likely."""
    ties = {frozenset(m[:2]): m for m in met if m[0] != m[1] and m[4] >= 0.5}
    found = {}
    for some in combinations([f"a{i}" for i in range(5)], numbers[0]):
        for more in combinations([f"b{i}" for i in range(5)], numbers[1]):
            pairs = [frozenset(pair) for pair in combinations((*some, *more), 2)]
            if not all(pair in ties for pair in pairs):
                continue
            start = max(ties[pair][2] for pair in pairs)
            if start <= min(ties[pair][2] + ties[pair][3] for pair in pairs):
                found[frozenset((*some, *more))] = min(ties[pair][4] for pair in pairs)
    return found


@pytest.mark.parametrize("numbers", [(2, 0), (3, 0), (4, 0), (2, 1), (1, 2), (3, 2)])
@given(met=meetings)
def test_groups_are_those_that_a_loop_over_all_choices_finds(
    numbers: tuple[int, int], met: list[Met]
) -> None:
    tables = tables_of()
    ties, every = ties_of(tables, met), groups_of(met, numbers)
    wanted = numbers if numbers[1] else numbers[:1]
    groups = list(ties.groups(wanted))
    told = {frozenset(m.stay[0] for m in group.members): group.probability for group in groups}
    assert told.items() <= every.items()
    first = "ab" if numbers[0] == 1 else "aa"
    begun = {
        pair
        for group in every
        for pair in map(frozenset, combinations(group, 2))
        if "".join(sorted(name[0] for name in pair)) == first
    }
    assert all(any(pair <= group for group in told) for pair in begun)
    moments = gathered(ties, wanted)
    assert bool(moments) == bool(every)
    spans: dict[str, list[tuple[int, int]]] = {}
    for moment in moments:
        assert [name[0] for name in moment.ids] == ["a"] * numbers[0] + ["b"] * numbers[1]
        for name in moment.ids:
            others = spans.setdefault(name, [])
            assert all(end < moment.start_ms or start > moment.end_ms for start, end in others)
            others.append((moment.start_ms, moment.end_ms))
    alone = {moment.figure.sighting.object_id for moment in scattered(ties, wanted, tables[0])}
    sure = {name for group, p in every.items() if p > 0.5 for name in group}
    assert alone.isdisjoint(sure)
    assert alone >= set(tables[0].candidates) - {name for group in every for name in group}


def together(*objects: ObjectTerm, **more: object) -> FormalQuery:
    relation = Relation("together")
    return FormalQuery("?", "Q2", "whether", objects, relation, **more)  # type: ignore[arg-type]


def ask(home: Home, query: FormalQuery, store: Store | None = None) -> Answer:
    store = home.into(OracleStore() if store is None else store)
    return execute(plan(query), store, Words(), now=NOW, limit=50, parameters=DEFAULT)


def moments_of(answer: Answer) -> list[set[str]]:
    groups: dict[int | None, set[str]] = {}
    for keyframe in answer.keyframes:
        groups.setdefault(keyframe.group, set()).add(keyframe.object_id)
    return list(groups.values())


@pytest.fixture
def table() -> Home:
    """Three cups and a bowl in a picture; the first two stay, the fourth is near them later."""
    home = Home()
    for name in ("c1", "c2", "c3", "c4"):
        home.thing(name, "cup")
    home.thing("bowl", "bowl")
    for name in ("c1", "c2", "c3", "bowl"):
        home.seen(name, 0, 5, at=None)
    for one, other in combinations(("c1", "c2", "c3", "bowl"), 2):
        home.met(one, other, 2, 3)
    for name, x in (("c1", 0.0), ("c2", 0.4), ("c4", 0.8), ("c3", 9.0)):
        home.seen(name, 100, 105, at=(x, 0, 0), place=1)
    return home


def test_two_and_three_of_a_kind(table: Home) -> None:
    cups = ObjectTerm("cup", quantity=2)
    two = ask(table, together(cups))
    assert {frozenset(group) for group in moments_of(two)} >= {frozenset(("c1", "c2"))}
    assert all(len(group) == 2 for group in moments_of(two))
    three = ask(table, together(replace(cups, quantity=3)))
    assert sorted(map(sorted, moments_of(three))) == [["c1", "c2", "c3"], ["c1", "c2", "c4"]]
    assert (three.count, three.least, three.unjudged) == (4, 3, ())
    four = ask(table, together(replace(cups, quantity=4)))
    assert (four.status, four.reason) == ("not_found", "not_there")
    assert four.otherwise is not None


def test_the_cups_are_two_at_least(table: Home) -> None:
    assert ask(table, together(ObjectTerm("cup"))).status == "found"
    assert ask(table, together(ObjectTerm("bowl"))).status == "not_found"


def test_how_many_were_together_is_the_most_at_once(table: Home) -> None:
    answer = ask(table, how_many())
    assert (answer.value, answer.status) == (3.0, "found")
    assert all(len(group) == 3 for group in moments_of(answer))


def how_many() -> FormalQuery:
    return replace(together(ObjectTerm("cup")), ask="count")


def test_the_times_of_two_are_those_of_both(table: Home) -> None:
    asked = FormalQuery("?", "Q3", "when", (ObjectTerm("cup", quantity=3),))
    assert len(moments_of(ask(table, asked))) == 2
    four = ask(table, replace(asked, objects=(ObjectTerm("cup", quantity=4),)))
    assert (four.status, four.reason) == ("not_found", "not_there")


def test_so_many_with_another_thing(table: Home) -> None:
    bowl, cups = ObjectTerm("bowl", var="y"), ObjectTerm("cup", quantity=3)
    answer = ask(table, together(cups, bowl))
    assert moments_of(answer) == [{"c1", "c2", "c3", "bowl"}]
    assert answer.count == 3
    the_other_way = ask(table, together(replace(bowl, var="x"), replace(cups, var="y")))
    assert (moments_of(the_other_way), the_other_way.count) == (moments_of(answer), 1)
    assert ask(table, together(replace(cups, quantity=4), bowl)).status == "not_found"


def test_when_they_were_not_together(table: Home) -> None:
    asked = replace(together(ObjectTerm("cup", quantity=2)), ask="when", negated=True)
    answer = ask(table, asked)
    assert [(k.object_id, k.start) for k in answer.keyframes] == [("c3", at(100))]


def test_two_ids_at_one_spot_that_no_frame_shows_at_once_are_no_two_things() -> None:
    asked = together(ObjectTerm("cup", quantity=2))
    for apart_m, sigma, found in ((0.1, 0.05, False), (0.5, 0.05, True), (0.5, 0.3, False)):
        home = Home()
        for name, x in (("c1", 0.0), ("c2", apart_m)):
            home.thing(name, "cup")
            home.seen(name, 0, 5, at=(x, 0, 0), sigma=sigma)
        answer = ask(home, asked)
        assert (answer.status == "found") is found
        home.met("c1", "c2", 2)
        assert ask(home, asked).status == "found"


def test_what_nothing_tells_is_left_out() -> None:
    home = Home()
    for name in ("c1", "c2"):
        home.thing(name, "cup")
        home.seen(name, 0, 5, at=None)
    home.thing("c3", "cup")
    home.seen("c3", 0, 5, at=(0, 0, 0))
    assert ask(home, together(ObjectTerm("cup", quantity=2))).status == "not_found"


def test_a_plan_gathers_where_numbers_are_asked_together() -> None:
    cup, bowl = ObjectTerm("cup"), ObjectTerm("bowl", var="y")
    assert numbers_together(together(cup)) == (2,)
    assert numbers_together(together(replace(cup, quantity=3))) == (3,)
    assert numbers_together(together(cup, replace(bowl, quantity=2))) == (1, 2)
    assert numbers_together(together(cup, bowl)) == ()
    assert numbers_together(replace(together(cup), relation=None)) == ()
    alone = FormalQuery("?", "Q3", "when", (replace(cup, quantity=3),))
    assert numbers_together(alone) == (3,)
    assert Gather(("x",), (3,)) in plan(alone).steps
    assert numbers_together(replace(alone, ask="where")) == ()  # they may be anywhere
    assert numbers_together(replace(alone, ask="whether")) == ()  # one after the other will do
    assert numbers_together(replace(alone, objects=(replace(cup, quantity=1),))) == ()
    steps = plan(together(replace(cup, quantity=3))).steps
    assert Gather(("x",), (3,)) in steps
    assert "gather x, numbers 3" in "\n".join(plan(together(replace(cup, quantity=3))).lines())
    moved = plan(replace(together(cup), ask="moved")).steps
    assert Unite("together", ("x",)) in moved


def test_every_store_gathers_alike(table: Home, make_store: Callable[[], Store]) -> None:
    for asked in (
        together(ObjectTerm("cup", quantity=3)),
        how_many(),
        together(ObjectTerm("cup", quantity=2), ObjectTerm("bowl", var="y")),
    ):
        with closing(make_store()) as store:
            told = ask(table, asked, store).to_json()
        oracle = ask(table, asked).to_json()
        del told["elapsed_ms"], oracle["elapsed_ms"]
        assert told == oracle
