"""Numbers over sightings as columns, against the same told one by one."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering import columns
from d3a.answering.distinct import ROUND_GAP_MS, least_number, rounds
from d3a.answering.moments import joined, total_ms
from d3a.store.base import Sighting, Spans

IDS = ("a", "b", "c", "d")


@st.composite
def sightings(draw: st.DrawFn) -> list[Sighting]:
    """Draw sightings that touch, overlap, follow at once and after the gap of a round."""
    times = st.integers(0, 12).map(lambda n: n * (ROUND_GAP_MS // 3))
    drawn = draw(
        st.lists(
            st.tuples(st.sampled_from(IDS), st.integers(0, 2), times, st.sampled_from((0, 1, 2))),
            unique_by=lambda row: row[:3],
            max_size=14,
        )
    )
    lengths = (0, ROUND_GAP_MS // 3 - 1, ROUND_GAP_MS // 2)
    return [
        Sighting(name, place, start, start + lengths[n], "f", 0.5, (0, 0, 1, 1))
        for name, place, start, n in drawn
    ]


@given(sightings())
def test_a_stay_has_one_number_and_its_newest_sighting_one_row(seen: list[Sighting]) -> None:
    spans = Spans.of_sightings(IDS, seen)
    stay = columns.stay_of(spans)
    assert len({*zip(spans.stays(), stay.tolist(), strict=True)}) == len({*spans.stays()})
    newest = columns.lasts(stay, [spans.start_ms])
    expected = {s: max(x.start_ms for x in seen if x.stay == s) for s in {x.stay for x in seen}}
    assert {key[:2]: key[2] for key in spans.chosen(newest).which()} == expected


@given(sightings())
def test_lengths_are_those_of_the_union(seen: list[Sighting]) -> None:
    spans = Spans.of_sightings(IDS, seen)
    lengths = columns.covered_ms(spans.of, spans.start_ms, spans.end_ms, len(IDS)).tolist()
    for name, length in zip(IDS, lengths, strict=True):
        assert length == total_ms((s.start_ms, s.end_ms) for s in seen if s.object_id == name)


@given(sightings())
def test_rounds_and_their_fullest(seen: list[Sighting]) -> None:
    spans = Spans.of_sightings(IDS, seen)
    numbers = columns.rounds_of(spans.start_ms, spans.end_ms)
    told = dict(zip(spans.which(), numbers.tolist(), strict=True))
    expected = [{(*s.stay, s.start_ms) for s in one} for one in rounds(seen)]
    assert [{k for k, n in told.items() if n == number} for number in range(len(expected))] == (
        expected
    )
    assert columns.least_number(spans.of, spans.start_ms, spans.end_ms) == least_number(seen)


@given(sightings())
def test_split_sightings_are_one_occasion(seen: list[Sighting]) -> None:
    spans = Spans.of_sightings(IDS, seen)
    start, end = columns.occasions(spans)
    whole = joined(seen)
    told = sorted(zip(start.tolist(), end.tolist(), strict=True))
    assert told == sorted((s.start_ms, s.end_ms) for s in whole)
    for row, key in enumerate(spans.which()):
        parts = spans.chosen(columns.whole(spans, np.array([row])))
        assert key in parts.which()
        assert len(joined(s for s in seen if (*s.stay, s.start_ms) in parts.which())) == 1


@given(sightings())
def test_two_met_where_one_round_of_theirs_has_both(seen: list[Sighting]) -> None:
    spans = Spans.of_sightings(IDS, seen)
    both = columns.met(spans.of, spans.start_ms, spans.end_ms, len(IDS))
    for i, one in enumerate(IDS):
        for j, other in enumerate(IDS):
            theirs = [s for s in seen if s.object_id in (one, other)]
            shown = any({s.object_id for s in each} == {one, other} for each in rounds(theirs))
            assert both[i, j] == (shown or i == j)


def test_nothing_seen_is_no_round_and_no_length() -> None:
    none = np.zeros(0, dtype=np.int64)
    assert columns.least_number(none, none, none) == 0
    assert columns.covered_ms(none, none, none, 2).tolist() == [0, 0]
    assert not columns.met(none, none, none, 2)[0, 1]
