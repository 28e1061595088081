"""Which looks a thing was seen in, of those by which it is told how often it was so."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.often import looks_at


@st.composite
def looks(draw: st.DrawFn) -> list[tuple[int, int]]:
    """Draw up to eight looks by time, none touching another; some of one frame."""
    steps = draw(st.lists(st.tuples(st.integers(1, 9), st.integers(0, 9)), min_size=1, max_size=8))
    edges = [*accumulate(step for pair in steps for step in pair)]
    return [*zip(edges[::2], edges[1::2], strict=True)]


@given(looks=looks(), start=st.integers(-5, 90), lasting=st.integers(0, 30))
def test_a_span_is_of_the_looks_that_are_nearest_of_all(
    looks: Sequence[tuple[int, int]], start: int, lasting: int
) -> None:
    end = start + lasting
    apart = [max(begun - end, start - ended, 0) for begun, ended in looks]
    nearest = [number for number, away in enumerate(apart) if away == min(apart)]
    assert [*looks_at(looks, start, end)] == nearest
