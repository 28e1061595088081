"""Intervals made one, without a store."""

from dataclasses import replace

import pytest

from d3a.model import Detection
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef, Interval, joined

MINUTE_MS = 60_000


def at(minute: int) -> Interval:
    view = Interval.of(
        FrameRef(f"f{minute}", minute * MINUTE_MS), Detection("cup", 0.9, (0, 0, 5, 5))
    )
    return replace(view, probability=0.5 + minute / 1000)


def spans(minutes: list[int], bridged_s: float = 0.0) -> list[tuple[float, float, int]]:
    """Return start and end in minutes, and how many views, of what some views make together."""
    made = joined([at(minute) for minute in minutes], DEFAULT, bridged_s)
    return [(i.start_ms / MINUTE_MS, i.end_ms / MINUTE_MS, i.seen) for i in made]


def test_only_a_pause_that_is_not_bridged_parts_intervals() -> None:
    minutes = [0, 9, 30, 35]
    assert spans(minutes) == [(0, 9, 2), (30, 35, 2)]
    assert spans(minutes, bridged_s=30 * 60.0) == [(0, 35, 4)]


def test_what_gets_too_long_without_a_pause_is_split_to_be_joined_again() -> None:
    first, second = joined([at(minute) for minute in range(0, 90, 9)], DEFAULT)
    assert second.start_ms - first.end_ms == 1
    assert (first.seen, second.seen) == (7, 3)


def test_what_gets_too_long_over_a_bridged_pause_begins_at_its_own_first_view() -> None:
    assert spans([0, 25, 50, 75, 100, 125], bridged_s=30 * 60.0) == [
        (0, 50, 3),
        (75, 125, 3),
    ]


@pytest.mark.parametrize("probability", [0.1, 0.5, 0.9])
def test_an_interval_grows_by_a_view_as_by_the_view_s_own_interval(probability: float) -> None:
    box, other = (1.0, 2.0, 3.0, 4.0), (5.0, 6.0, 7.0, 8.0)
    first, second = FrameRef("f1", 1000, "p1"), FrameRef("f2", 2000, "p2", (0.0,) * 7, "r")
    old = Interval.of(first, Detection("cup", 0.5, box))
    view = Detection("mug", probability, other)
    assert old.grown(second, view) == old.union(Interval.of(second, view))
