"""Plain arithmetic on small symmetric matrices, against NumPy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from d3a import symmetric

NUMBER = st.floats(-3, 3).map(lambda x: round(x, 3))
UPPER = np.triu_indices(3)


def matrix(numbers: list[float]) -> NDArray[np.float64]:
    """Return a covariance (3, 3) from nine numbers."""
    root = np.array(numbers).reshape(3, 3)
    return np.asarray(root @ root.T + 0.01 * np.eye(3))


@given(
    st.lists(NUMBER, min_size=9, max_size=9),
    st.lists(NUMBER, min_size=9, max_size=9),
    st.lists(NUMBER, min_size=3, max_size=3),
)
def test_it_computes_what_numpy_does(
    one: list[float], other: list[float], vector: list[float]
) -> None:
    a, b = matrix(one), matrix(other)
    s, t = symmetric.of_rows(a.ravel().tolist()), symmetric.of_rows(b.ravel().tolist())
    v = np.array(vector)
    assert np.allclose(symmetric.inverse(s), np.linalg.inv(a)[UPPER], rtol=1e-6, atol=1e-8)
    assert np.allclose(symmetric.times(s, vector), a @ v)
    assert symmetric.squared(s, vector) == pytest.approx(float(v @ a @ v), abs=1e-9)
    assert np.allclose(symmetric.product(s, t), a @ b)
    assert np.allclose(symmetric.added(s, t), (a + b)[UPPER])
    assert np.allclose(symmetric.scaled(s, 3.0), (3.0 * a)[UPPER])
    assert np.allclose(symmetric.flat(s), a.ravel())
    assert symmetric.trace(s) == pytest.approx(float(np.trace(a)))


def test_a_matrix_that_is_exact_along_an_axis_has_an_inverse() -> None:
    """A robot on wheels says that its height is exact."""
    xx, xy, xz, yy, yz, zz = symmetric.inverse((0.04, 0.0, 0.0, 0.04, 0.0, 0.0))
    assert (xx, yy) == pytest.approx((25.0, 25.0), rel=1e-4)
    assert zz > 1e6
    assert (xy, xz, yz) == (0.0, 0.0, 0.0)


def test_a_matrix_of_zeros_has_an_inverse() -> None:
    assert symmetric.inverse((0.0,) * 6) == pytest.approx((1e9, 0.0, 0.0, 1e9, 0.0, 1e9))


def test_numbers_that_are_no_covariance_have_an_inverse() -> None:
    assert np.isfinite(symmetric.inverse((-4.0, 2.0, 9.0, -1.0, 0.0, 3.0))).all()
