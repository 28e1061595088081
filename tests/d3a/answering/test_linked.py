"""The geometry of links: what shared frames measured, and where the middles of things are."""

from __future__ import annotations

import math

import numpy as np
import pytest

from d3a.answering.joins import links
from d3a.answering.linked import agreed, numbered, pairs_of
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.answering.pairs import SURFACE_SHARE, VISIT_ERROR, distance_of
from d3a.model import Position
from d3a.store.base import Apart, Encounter, ObjectRecord, Sighting, StayRecord

BOX, OTHER_BOX = (0.0, 0.0, 10.0, 10.0), (20.0, 0.0, 30.0, 10.0)
FACING = (-0.5, 0.5, -0.5, 0.5)
"""A camera that looks along +x."""
BACK = (0.5, 0.5, -0.5, -0.5)
"""And one that looks along -x."""
Viewer = tuple[float, ...]


def found_of(name: str, position: Position, extent: tuple[float, float] | None) -> Found:
    stay = StayRecord(
        name, 0, position, 0, 99, 1.0, covariance=(0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)
    )
    record = ObjectRecord(name, "cup", 1.0, 0, 99, extent_m=extent)
    sighting = Sighting(name, 0, 0, 99, "f", 0.9, BOX)
    return Found({name: Candidate(record, 1.0)}, [sighting], {stay.key: stay})


def frame(at: int, apart: Apart | None, viewer: Viewer = (0.0, 0.0, 1.0, *FACING)) -> Encounter:
    return Encounter("a", "b", 0, 0, at, at, "f", BOX, OTHER_BOX, 0.9, viewer=viewer, apart=apart)


def test_what_frames_measured_counts_before_the_places_but_for_heights() -> None:
    one, other = found_of("a", (3.0, 0.0, 0.5), None), found_of("b", (3.0, 1.0, 0.6), None)
    shared = [frame(1, (0.0, 0.2, 0.3, 0.1)), frame(2, (0.0, 0.4, 0.3, 0.1)), frame(3, None)]
    for figure, ground, sign in ((one, other, 1.0), (other, one, -1.0)):
        pairs = pairs_of(links(figure, ground, shared), figure, ground)
        line = pairs.position_b - pairs.position_a
        places = 2 * 0.01 * VISIT_ERROR**2
        own = 0.1**2 / 2  # of two frames
        expected = (0.3 * places + 1.0 * own) / (places + own)
        assert line == pytest.approx(np.array([[0.0, sign * expected, sign * 0.1]] * 3))
        assert (pairs.position_a + pairs.position_b)[0] / 2 == pytest.approx((3.0, 0.5, 0.55))
        assert pairs.sigma == pytest.approx(math.sqrt(places * own / (places + own)))
    assert pairs.sigma[0] < pairs_of(links(one, other, [frame(1, None)]), one, other).sigma[0]


def test_without_a_measurement_places_stay_as_they_are() -> None:
    one, other = found_of("a", (3.0, 0.0, 0.5), None), found_of("b", (3.0, 1.0, 0.6), None)
    pairs = pairs_of(links(one, other, [frame(1, None)]), one, other)
    assert pairs.position_a.tolist() == [[3.0, 0.0, 0.5]]
    assert pairs.position_b.tolist() == [[3.0, 1.0, 0.6]]
    assert len(pairs_of([], one, other)) == 0


@pytest.mark.parametrize(
    ("viewers", "behind"),
    [
        ([(0.0, 1.0, 1.0, *FACING)], 1.0),
        ([(0.0, 1.0, 1.0, *FACING), (6.0, 1.0, 1.0, *BACK)], 0.0),  # from all around
        ([(math.nan,) * 7], 0.0),  # nobody knows from where
    ],
)
def test_the_middle_of_a_thing_is_behind_what_is_measured_of_it(
    viewers: list[Viewer], behind: float
) -> None:
    one, other = found_of("a", (3.0, -5.0, 0.5), None), found_of("b", (3.0, 1.0, 0.6), (0.6, 1.0))
    shared = [frame(n, None, viewer) for n, viewer in enumerate(viewers)]
    pairs = pairs_of(links(one, other, shared), one, other)
    expected = (3.0 + behind * SURFACE_SHARE * 0.6, 1.0, 0.6)
    assert pairs.position_b == pytest.approx(np.array([expected] * len(viewers)))


def test_one_place_for_all_that_a_frame_shows_still_tells_nothing() -> None:
    one, other = found_of("a", (3.0, 1.0, 0.6), None), found_of("b", (3.0, 1.0, 0.6), (0.6, 1.0))
    pairs = pairs_of(links(one, other, [frame(1, None)]), one, other)
    assert np.isnan(distance_of(pairs)).all()


def test_links_of_the_same_two_stays_agree_on_their_mean() -> None:
    one, other = found_of("a", (3.0, 0.0, 0.5), None), found_of("b", (3.0, 1.0, 0.6), None)
    found = links(one, other, [frame(n, None) for n in range(3)])
    held = agreed(found, np.array([0.2, math.nan, 0.6]))
    assert held == pytest.approx(np.array([0.4, math.nan, 0.4]), nan_ok=True)
    assert agreed([], np.zeros(0)).tolist() == []


def test_equal_keys_get_equal_numbers() -> None:
    assert numbered("abac").tolist() == [0, 1, 0, 2]
