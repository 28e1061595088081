"""What looks from somewhere say of a place, and what is expected before any look."""

from __future__ import annotations

import math

import pytest

from d3a.tracking.known import Place
from d3a.tracking.sides import (
    AGAIN_MS,
    AGAIN_SHARE,
    HOUR_MS,
    LOOKS_KEPT,
    VISIT_SHARE,
    chance,
    chance_from,
    left,
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


def test_a_side_that_always_showed_a_thing_shows_it_more_surely_than_one_that_never_did() -> None:
    place = looked_at(north=True, south=False)
    from_north, from_south = (chance_from(place, eye, 3.0, USUAL) for eye in (NORTH, SOUTH))
    assert from_south < chance(place, USUAL) < from_north


def test_a_side_of_which_nothing_is_known_is_like_the_others() -> None:
    place = looked_at(north=True, south=False)
    assert chance_from(place, (3.0, 0.0, 1.0), 3.0, USUAL) == chance(place, USUAL)


def test_what_was_long_ago_from_a_side_is_forgotten() -> None:
    place = looked_at(north=True, south=True, times=LOOKS_KEPT)
    for _ in range(LOOKS_KEPT):
        remember_look(place, NORTH, 1.0, found=False)
    assert len(place.looks) == LOOKS_KEPT
    assert chance_from(place, NORTH, 3.0, USUAL) < 0.2


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
