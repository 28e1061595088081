"""What looks from somewhere say of a place, and what is expected before any look."""

from __future__ import annotations

import math

import numpy as np
import pytest

from d3a.model import Position
from d3a.parameters import DEFAULT
from d3a.tracking.known import Known, Place
from d3a.tracking.positions import Positions, Row
from d3a.tracking.sides import (
    AGAIN_MS,
    AGAIN_SHARE,
    HOUR_MS,
    LOOKS_KEPT,
    VISIT_SHARE,
    chance,
    chance_from,
    left,
    looks_near,
    remember_look,
    share_of_look,
)

NORTH, SOUTH = (0.0, 3.0, 1.0), (0.0, -3.0, 1.0)
USUAL = 0.6


def looked_at(north: bool, south: bool, times: int = 6) -> Place:
    """A place that was looked at so often from both sides, and found from some of them."""
    place = Place(0, 0, 0, hits=times * (north + south), chances=2.0 * times)
    for _ in range(times):
        remember_look(place, NORTH, 1.0, found=north)
        remember_look(place, SOUTH, 1.0, found=south)
    return place


def _chance(place: Place, eye: Position) -> float:
    """Return the chance of a look from three metres, by the table of a memory with the place."""
    positions, thing = Positions(), Known(1, {"cup": 1.0}, 0, 0)
    error = (0.01, 0.0, 0.0, 0.01, 0.0, 0.01)
    at = 0.0, 0.0, 1.0
    positions.add([(thing, place, Row.of(at, at, error, (0.0, 0.0), DEFAULT))])
    looks = positions.looks(np.array([place.row]))
    ((near, found),) = looks_near(looks, np.array([[*eye, 3.0]]).T).T.tolist()
    return chance_from(place, near, found, USUAL)


def test_a_side_that_always_showed_a_thing_shows_it_more_surely_than_one_that_never_did() -> None:
    place = looked_at(north=True, south=False)
    from_north, from_south = (_chance(place, eye) for eye in (NORTH, SOUTH))
    assert from_south < chance(place, USUAL) < from_north


def test_a_side_of_which_nothing_is_known_is_like_the_others() -> None:
    place = looked_at(north=True, south=False)
    assert _chance(place, (3.0, 0.0, 1.0)) == chance(place, USUAL)


def test_what_was_long_ago_from_a_side_is_forgotten() -> None:
    place = looked_at(north=True, south=True, times=LOOKS_KEPT)
    for _ in range(LOOKS_KEPT):
        remember_look(place, NORTH, 1.0, found=False)
    assert len(place.looks) == LOOKS_KEPT
    assert _chance(place, NORTH) < 0.2


def test_looks_of_one_visit_tell_less_than_one_each() -> None:
    first, latest = share_of_look([], NORTH, 0)
    again, latest = share_of_look(latest, NORTH, 1000)
    elsewhere, latest = share_of_look(latest, SOUTH, 2000)
    later, _ = share_of_look(latest, NORTH, 2000 + AGAIN_MS)
    assert (first, again, elsewhere, later) == (1.0, AGAIN_SHARE, VISIT_SHARE, 1.0)


@pytest.mark.parametrize(
    ("likelier", "than"),
    [
        ((0, HOUR_MS, HOUR_MS), (0, HOUR_MS, HOUR_MS // 60)),  # it had an hour to leave
        ((0, HOUR_MS, HOUR_MS // 60), (0, 9 * HOUR_MS, HOUR_MS // 60)),  # the other never does
        ((3, 9 * HOUR_MS, HOUR_MS // 60), (0, 9 * HOUR_MS, HOUR_MS // 60)),  # it often does
    ],
)
def test_a_thing_has_left_the_likelier_the_longer_and_the_oftener_it_moves(
    likelier: tuple[int, int, int], than: tuple[int, int, int]
) -> None:
    assert left(*likelier) > left(*than)


def test_nothing_has_left_more_likely_than_not_without_a_look() -> None:
    assert left(5, HOUR_MS, 100 * HOUR_MS) == 0.0
    assert math.isfinite(left(0, 0, 0))


def test_the_table_of_a_memory_holds_the_latest_looks() -> None:
    positions, thing = Positions(), Known(1, {"cup": 1.0}, 0, 0)
    error = (0.01, 0.0, 0.0, 0.01, 0.0, 0.01)
    place, beside = Place(0, 0, 0), Place(1, 0, 0)
    row = Row.of((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), error, (0.0, 0.0), DEFAULT)
    positions.add([(thing, place, row), (thing, beside, row)])
    for first in range(0, LOOKS_KEPT + 5, 8):
        latest = []
        for n in range(first, min(first + 8, LOOKS_KEPT + 5)):
            eye = (float(n), 0.0, 1.0)
            latest.append((beside, remember_look(beside, eye, 1.0, found=n % 3 == 0)))
        positions.put_some_looks(latest)
    positions.remove([place])  # the other one moves into its row
    one_by_one = positions.looks(np.array([beside.row]))
    assert sorted(one_by_one[0, 0].tolist()) == [float(n) for n in range(5, LOOKS_KEPT + 5)]
    assert one_by_one[0, 4].sum() == sum(n % 3 == 0 for n in range(5, LOOKS_KEPT + 5))
    positions.put_looks(beside)  # as after a checkpoint
    assert np.array_equal(positions.looks(np.array([beside.row])), one_by_one)
