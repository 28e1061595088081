"""The map from products of parts to probabilities: how it is fitted, and the one that ships."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.calibration import KINDS, Kind, calibrated, expected_error, fitted, kind_of, maps


def test_the_kinds_are_by_things_and_looks() -> None:
    kinds = [kind_of(n, by_looks=looks) for n in (1, 2) for looks in (False, True)]
    assert kinds == list(KINDS)


def test_a_fit_mends_what_is_told_too_low_and_too_high() -> None:
    rng = np.random.default_rng(1)
    products = rng.uniform(0, 1, 8_000)
    right = rng.uniform(0, 1, 8_000) < products**3
    before, _ = expected_error(products.tolist(), right.tolist())
    knots = fitted(products.tolist(), right.tolist())
    mended = np.interp(products, *knots)
    after, rows = expected_error(mended.tolist(), right.tolist())
    assert before > 0.2
    assert after < 0.03
    assert sum(count for count, _, _ in rows) == 8_000


@given(st.lists(st.tuples(st.floats(0, 1), st.booleans()), max_size=60), st.integers(1, 20))
def test_a_fitted_map_rises_from_nothing_to_one(answers: list[tuple[float, bool]], n: int) -> None:
    products, probabilities = fitted([p for p, _ in answers], [r for _, r in answers], n)
    assert (products[0], probabilities[0]) == (0.0, 0.0)
    assert list(products) == sorted(products)
    assert list(probabilities) == sorted(probabilities)
    assert all(0 <= p <= 1 for p in (*products, *probabilities))


@pytest.mark.parametrize("kind", KINDS)
def test_what_ships_keeps_the_order_and_ends_above_a_half(kind: Kind) -> None:
    products, probabilities = maps()[kind]
    assert (products[0], products[-1]) == (0.0, 1.0)
    assert list(probabilities) == sorted(probabilities)
    told = [calibrated(p, kind) for p in np.linspace(0, 1, 101)]
    assert told == sorted(told)
    assert told[0] == 0.0
    assert 0.5 < told[-1] <= 1.0


def test_the_error_is_the_distance_of_what_is_told_and_what_is_right() -> None:
    error, rows = expected_error([0.95, 0.95, 0.15, 0.15], [True, False, False, False])
    assert error == pytest.approx((2 * 0.45 + 2 * 0.15) / 4)
    assert rows[9] == pytest.approx((2, 0.95, 0.5))
    assert rows[5] == pytest.approx((0, 0.0, 0.0))
