"""The chance of a move among all moves of a category together."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a.tracking.rivals import Rivals

Floats = NDArray[np.float64]


def _chance(odds: Floats, row: int, k: int) -> float:
    return Rivals.of(odds).chance(row, k, np.ones(odds.shape[1]))


def _counted(odds: Floats, row: int, k: int) -> float:
    """Return the same by all ways in which each thing goes to one place, from one, at most."""
    n, m = odds.shape
    own = every = 0.0
    for ways in product([-1, *range(m)], repeat=n):
        taken = [each for each in ways if each >= 0]
        if len(taken) == len(set(taken)):
            weight = float(np.prod([odds[i, j] for i, j in enumerate(ways) if j >= 0]))
            every += weight
            own += weight if ways[row] == k else 0.0
    return own / every


@pytest.mark.parametrize("seed", range(5))
def test_of_moves_in_a_row_the_chances_are_those_of_all_ways_counted(seed: int) -> None:
    """Each end has two moves at most, and no circle is closed: a, then b from a, then c."""
    first, skipped, second = np.random.default_rng(seed).uniform(0.1, 50.0, 3)
    odds = np.array([[first, 0.0], [skipped, second]])
    for row, k in ((0, 0), (1, 1), (1, 0)):
        assert _chance(odds, row, k) == pytest.approx(_counted(odds, row, k), abs=0.01)


def test_one_that_surely_went_elsewhere_is_no_rival() -> None:
    odds = np.array([[1e9, 0.0], [100.0, 100.0]])
    assert _chance(odds, 1, 1) == pytest.approx(100 / 101, abs=0.01)
    assert _chance(odds[1:], 0, 1) == pytest.approx(100 / 201)


def test_of_two_alike_neither_is_the_one() -> None:
    assert _chance(np.full((2, 2), 1e6), 0, 0) == pytest.approx(0.5, abs=0.01)


def test_a_rival_counts_by_how_likely_it_left() -> None:
    rivals = Rivals.of(np.array([[9.0, 9.0]]))
    alone, even = (rivals.chance(0, 0, np.array([1.0, count])) for count in (0.0, 1.0))
    assert (alone, even) == pytest.approx((9 / 10, 9 / 19))


def test_huge_odds_leave_small_ones_as_they_are() -> None:
    odds = np.array([[np.exp(50.0), 0.0], [0.0, 3.0]])
    assert _chance(odds, 1, 1) == pytest.approx(3 / 4)
