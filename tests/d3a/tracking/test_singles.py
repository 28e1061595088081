"""What was seen once, long ago, is most likely a mistake where most such things were."""

from __future__ import annotations

import math

import pytest

from d3a.ledger import Ledger
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef
from d3a.tier3 import Stored
from d3a.tracking.singles import LONG_MS, PRIOR, REMEMBERED, Singles
from d3a.tracking.tracker import TrackerPipeline
from tests.worlds.oracle import OracleStore


def test_nothing_is_said_before_anything_is_known_or_of_what_is_new() -> None:
    singles = Singles()
    assert singles.odds(10 * LONG_MS) == 0.0
    for _ in range(1000):
        singles.born()
    assert singles.odds(LONG_MS) == 0.0
    assert singles.odds(LONG_MS + 1) > 1.0


def test_what_is_seen_again_soon_or_late_speaks_for_the_others() -> None:
    mistakes, soon, late = Singles(), Singles(), Singles()
    for singles, after_ms in ((mistakes, None), (soon, 1000), (late, 2 * LONG_MS)):
        for _ in range(100):
            singles.born()
            if after_ms is not None:
                singles.seen_again(after_ms)
    assert soon.odds(2 * LONG_MS) == late.odds(2 * LONG_MS) == 0.0
    assert mistakes.odds(2 * LONG_MS) > 2.0


def test_the_share_that_comes_back_is_told_and_fades() -> None:
    singles = Singles()
    for k in range(2000):
        singles.born()
        if k < 1000 or k % 10 == 0:
            singles.seen_again(2 * LONG_MS)
    usual = REMEMBERED / 10  # nine in ten of the latest never came back
    assert singles.again == pytest.approx(usual, rel=0.15)
    expected = (REMEMBERED - usual + PRIOR) / (usual + PRIOR)
    assert math.exp(singles.odds(2 * LONG_MS)) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(("since_ms", "is_over"), [(LONG_MS, False), (LONG_MS + 1, True)])
def test_a_few_looks_in_vain_tell_where_most_singles_were_mistakes(
    since_ms: int, is_over: bool
) -> None:
    tracker = TrackerPipeline(Ledger(OracleStore()), Stored("", "none"), DEFAULT, 0)
    thing, place = tracker._born(FrameRef("f", 0))
    thing.seen, place.evidence = 1, DEFAULT.expire_odds / 2
    tracker._now_ms = since_ms
    assert not tracker._is_over(thing)
    for _ in range(100):
        tracker._singles.born()
    assert tracker._is_over(thing) is is_over
    record, arrays = tracker.to_state()
    resumed = TrackerPipeline(Ledger(OracleStore()), Stored("", "none"), DEFAULT, 0)
    resumed.restore(record, arrays)
    assert resumed._is_over(thing) is is_over
