"""Sightings that meet in time and space, against a loop over all pairs."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering import joins
from d3a.answering.joins import links, meeting
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayKey, StayRecord

BOX = (0.0, 0.0, 1.0, 1.0)
Rows = list[tuple[int, int, int, float]]
rows = st.lists(
    st.tuples(st.integers(0, 2), st.integers(0, 30), st.integers(0, 9), st.floats(0, 3)),
    max_size=12,
)


def found_of(prefix: str, drawn: Rows) -> Found:
    """Objects with a stay a sighting: (object, start, length, x)."""
    table = Found()
    for place, (number, start, length, x) in enumerate(drawn):
        name = f"{prefix}{number}"
        table.candidates[name] = Candidate(ObjectRecord(name, prefix, 1.0, 0, 99), 1.0)
        stay = StayRecord(name, place, (x, 0.0, 0.0), start, start + length, 1.0)
        table.stays[stay.key] = stay
        table.sightings.append(Sighting(name, place, start, start + length, "f", 0.9, BOX))
    return table


def apart_m(a: Sighting, b: Sighting, one: Found, other: Found) -> float:
    here, there = one.stays[a.stay].position, other.stays[b.stay].position
    assert here is not None
    assert there is not None
    return math.dist(here, there)


@pytest.mark.parametrize("part", [1, 5, 4_000_000])
@given(figures=rows, grounds=rows)
def test_they_meet_as_a_loop_over_all_pairs_says(figures: Rows, grounds: Rows, part: int) -> None:
    one, other = found_of("a", figures), found_of("b", grounds)
    want = sorted(
        (max(a.start_ms, b.start_ms), a.stay, b.stay)
        for a in one.sightings
        for b in other.sightings
        if apart_m(a, b, one, other) <= 1.0 and a.start_ms <= b.end_ms and b.start_ms <= a.end_ms
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(joins, "_PART", part)
        met = links(one, other, (), reach_m=1.0)
    assert [key_of(link.start_ms, link.figure, link.ground) for link in met] == want


@given(figures=rows, grounds=rows, shared=st.lists(st.tuples(*[st.integers(0, 11)] * 3)))
def test_what_may_meet_holds_whatever_is_linked(
    figures: Rows, grounds: Rows, shared: list[tuple[int, int, int]]
) -> None:
    one, other = found_of("a", figures), found_of("b", grounds)
    frames = [
        Encounter(a.object_id, b.object_id, a.place, b.place, at, at + 9, "f", BOX, BOX, 0.9)
        for i, j, at in shared
        if i < len(one.sightings) and j < len(other.sightings)
        for a, b in [(one.sightings[i], other.sightings[j])]
    ]
    told = meeting(one.sightings, other.sightings, frames)
    linked = links(one, other, frames, reach_m=9.0)
    for table, some, side in ((one, told[0], 0), (other, told[1], 1)):
        stays = {link[side] for link in linked}
        assert stays <= {s.stay for s in some}
        assert [s for s in table.sightings if s in some] == some
    shown = {(e.object_a, e.place_a) for e in frames}
    for a in one.sightings:
        overlaps = any(a.start_ms <= b.end_ms and b.start_ms <= a.end_ms for b in other.sightings)
        assert (a in told[0]) == (overlaps or a.stay in shown)


def key_of(start_ms: int, figure: StayKey, ground: StayKey) -> tuple[int, StayKey, StayKey]:
    return start_ms, figure, ground
