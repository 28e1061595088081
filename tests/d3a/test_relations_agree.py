"""Relations of drawn homes: inverses agree, and a slice tells of the same facts as no slice."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from d3a.execute import execute
from d3a.parameters import DEFAULT
from d3a.plan import plan
from grammar.forms import (
    ANYTHING,
    RELATION_KINDS,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    TimeSlice,
)
from tests.worlds.made import NOW, Box, Home, Words, at
from tests.worlds.oracle import OracleStore

INVERSE: dict[RelationKind, RelationKind] = {
    "above": "under",
    "under": "above",
    "left_of": "right_of",
    "right_of": "left_of",
    "behind": "in_front_of",
    "in_front_of": "behind",
    "near": "near",
    "together": "together",
    "same_place": "same_place",
}
SIZES = {"cup": (0.1, 0.1), "tv": (1.0, 0.6), "table": (1.4, 0.7), "couch": (1.9, 0.8)}
VIEWERS = ((0.0, -3.0, 1.2, -0.5, 0.5, -0.5, 0.5), (-3.0, 0.0, 1.3, -0.707, 0.0, 0.0, 0.707))
Fact = frozenset[tuple[str, str]]
corner = st.sampled_from((0.0, 30.0, 60.0, 100.0))
box = st.tuples(corner, corner, st.sampled_from((30.0, 90.0))).map(
    lambda b: (b[0], b[1], b[0] + b[2], b[1] + b[2])
)
spot = st.tuples(
    st.sampled_from((0.0, 0.3, 0.8, 1.8)),
    st.sampled_from((0.0, 0.4)),
    st.sampled_from((0.05, 0.35, 0.75, 1.1)),
)


@st.composite
def homes(draw: st.DrawFn) -> Home:
    """Draw up to five things that are at one place at a time, and frames of what was seen so."""
    home = Home()
    seen: list[tuple[str, int, float, float]] = []
    for number in range(draw(st.integers(2, 5))):
        name, kind = f"o{number}", draw(st.sampled_from(sorted(SIZES)))
        size = SIZES[kind] if draw(st.integers(0, 5)) else None
        home.thing(name, kind, extent_m=size, tentative=draw(st.integers(0, 5)) == 0)
        spots, clock = (draw(spot), draw(spot)), 0.0
        for _ in range(draw(st.integers(1, 4))):
            place = draw(st.integers(0, 1))
            clock += draw(st.sampled_from((3.0, 10.0, 40.0)))
            until = clock + draw(st.sampled_from((0.0, 2.0, 15.0)))
            viewer = draw(st.none() | st.sampled_from(VIEWERS))
            home.seen(name, clock, until, at=spots[place], place=place, viewer=viewer, sigma=0.03)
            seen.append((name, place, clock, until))
            clock = until
    shown: dict[tuple[str, float], Box] = {}  # a thing has one box in a frame
    for one in seen:
        for other in seen:
            begin, end = max(one[2], other[2]), min(one[3], other[3])
            if one[0] < other[0] and begin <= end and draw(st.booleans()):
                names = (one[0], begin), (other[0], begin)
                boxes = tuple(shown.setdefault(name, draw(box)) for name in names)
                viewer = draw(st.sampled_from(VIEWERS))
                until = draw(st.sampled_from((begin, end)))
                places = one[1], other[1]
                home.met(
                    one[0],
                    other[0],
                    begin,
                    until,
                    boxes=(boxes[0], boxes[1]),
                    places=places,
                    viewer=viewer,
                )
    return home


def facts(
    home: Home,
    kind: RelationKind,
    numbers: Sequence[int],
    time: TimeSlice | None = None,
    by: str = "frame",
) -> set[Fact]:
    """Return what is told of a relation: the things of each moment and the frames that show them.

    by: frame, or position: of one place a picture will do as another. numbers: of the home's
    categories, or else anything.
    """
    known = [*dict.fromkeys(one.category for one in home.objects.values()), ANYTHING]
    words = [known[min(number, len(known) - 1)] for number in numbers]
    terms = tuple(ObjectTerm(word, word, var=var) for word, var in zip(words, "xyz", strict=False))
    relation = Relation(kind, negated=False)
    query = FormalQuery("?", "Q2", "when", terms, relation, None, time, "all", negated=False)
    store = home.into(OracleStore())
    answer = execute(plan(query), store, Words(), now=NOW, limit=10_000, parameters=DEFAULT)
    assert not answer.truncated
    if answer.unjudged:  # things are told without the relation
        return set()
    told: dict[int | None, set[tuple[str, str]]] = {}
    for keyframe in answer.keyframes:
        told.setdefault(keyframe.group, set()).add((keyframe.object_id, str(getattr(keyframe, by))))
    return {frozenset(each) for each in told.values()}


words = st.integers(0, 4)
times = st.tuples(st.integers(0, 16), st.integers(0, 16)).map(
    lambda ends: TimeSlice(at(10.0 * min(ends)), at(10.0 * max(ends)))
)


@pytest.mark.parametrize("kind", sorted(INVERSE))
@settings(deadline=None, max_examples=25)
@given(home=homes(), one=words, other=words, time=st.none() | times)
def test_a_relation_and_its_inverse_tell_the_same(
    kind: RelationKind, home: Home, one: int, other: int, time: TimeSlice | None
) -> None:
    told = facts(home, kind, (one, other), time)
    assert told == facts(home, INVERSE[kind], (other, one), time)


@settings(deadline=None, max_examples=50)
@given(home=homes(), one=words, other=words, time=st.none() | times)
def test_what_a_thing_is_on_is_under_it(
    home: Home, one: int, other: int, time: TimeSlice | None
) -> None:
    assert facts(home, "on", (one, other), time) <= facts(home, "under", (other, one), time)


@settings(deadline=None, max_examples=50)
@given(home=homes(), each=st.tuples(words, words, words), time=st.none() | times)
def test_between_two_is_between_the_same_two(
    home: Home, each: tuple[int, int, int], time: TimeSlice | None
) -> None:
    figure, one, other = each
    told = facts(home, "between", (figure, one, other), time)
    assert told == facts(home, "between", (figure, other, one), time)


@pytest.mark.parametrize("kind", RELATION_KINDS)
@settings(deadline=None, max_examples=25)
@given(home=homes(), each=st.tuples(words, words, words), time=times)
def test_a_slice_tells_facts_that_are_told_without_it(
    kind: RelationKind, home: Home, each: tuple[int, int, int], time: TimeSlice
) -> None:
    asked = each if kind == "between" else each[:2]
    ever = facts(home, kind, asked)
    within = facts(home, kind, asked, time, by="position")
    assert within <= facts(home, kind, asked, by="position")
    assert facts(home, kind, asked, TimeSlice(at(-60.0), at(600.0))) == ever
