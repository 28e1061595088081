"""How many things there must be, and which ids may be one thing."""

from __future__ import annotations

import math
from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.distinct import Apart, things_of
from d3a.store.base import ObjectRecord

Span = tuple[int, int]


def seen(name: str, span: Span, category: str = "cup", site: str = "home") -> ObjectRecord:
    return ObjectRecord(name, category, 1.0, *span, site=site)


@pytest.mark.parametrize(
    ("later", "is_one"),
    [((60, 90), True), ((50, 90), False), ((0, 90), False), ((10, 20), False)],
    ids=["after", "in the same frame", "all along", "within"],
)
def test_ids_never_seen_over_one_span_may_be_one_thing(later: Span, is_one: bool) -> None:
    things = things_of([seen("a", (0, 50)), seen("b", later)])
    assert (things["a"] == things["b"]) is is_one


def test_other_kinds_and_other_homes_are_other_things() -> None:
    records = [seen("a", (0, 5)), seen("b", (9, 9), "bowl"), seen("c", (9, 9), site="office")]
    assert len(set(things_of(records).values())) == 3


def test_a_thing_is_in_one_place_at_a_time() -> None:
    """Either of two later ones may be the first, but not both of them."""
    things = things_of([seen("a", (0, 5)), seen("b", (10, 20)), seen("c", (15, 25))])
    assert things["b"] == things["a"] != things["c"]


SPANS = st.tuples(st.integers(0, 30), st.integers(0, 12)).map(lambda s: (s[0], s[0] + s[1]))


@given(st.lists(SPANS, max_size=25))
def test_each_goes_to_the_first_thing_that_it_may_be(spans: list[Span]) -> None:
    records = [seen(f"o{k}", span) for k, span in enumerate(spans)]
    expected: list[list[Span]] = []
    numbers = []
    for span in spans:
        apart = [all(end < span[0] or span[1] < start for start, end in one) for one in expected]
        if not any(apart):
            expected.append([])
            apart.append(True)
        expected[apart.index(True)].append(span)
        numbers.append(apart.index(True))
    things = list(things_of([*records, *records]).values())
    assert [sorted(things).index(n) for n in things] == [sorted(numbers).index(n) for n in numbers]
    assert len(list(groupby(sorted(things)))) == len(expected)


@given(
    st.lists(st.tuples(*[st.floats(-3, 3)] * 3), max_size=30),
    st.sampled_from([0.0, 0.3, 1.0, 2.5]),
)
def test_a_place_is_apart_where_none_that_was_taken_in_is_near(
    places: list[tuple[float, float, float]], reach_m: float
) -> None:
    apart, kept = Apart(reach_m), list[tuple[float, float, float]]()
    for place in places:
        away = all(math.dist(place, other) >= reach_m for other in kept)
        assert apart.add(place) == away
        if away:
            kept.append(place)
