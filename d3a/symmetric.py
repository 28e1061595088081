"""Symmetric 3 x 3 matrices as six plain numbers: xx xy xz yy yz zz.

A frame shows two or three things, and a call of NumPy costs as much as twenty of these numbers:
for a handful of matrices plain arithmetic is five times as quick.
"""

from __future__ import annotations

from collections.abc import Sequence

Vector = Sequence[float]
Six = Sequence[float]
Triple = tuple[float, float, float]
Matrix = tuple[float, float, float, float, float, float]
LEAST_M2, FLAT = 1e-9, 1e-6
"""What is added along each axis of a matrix that has no inverse, and the share of its largest
number, if that is more: a robot on wheels says that its height is exact."""


def of_rows(flat: Vector) -> Matrix:
    """Return the six numbers of nine, row by row."""
    return flat[0], flat[1], flat[2], flat[4], flat[5], flat[8]


def flat(s: Six) -> tuple[float, ...]:
    """Return the nine numbers of the matrix, row by row."""
    xx, xy, xz, yy, yz, zz = s
    return xx, xy, xz, xy, yy, yz, xz, yz, zz


def added(s: Six, t: Six) -> Matrix:
    """Return the sum of two matrices."""
    (a, b, c, d, e, f), (g, h, i, j, k, m) = s, t
    return a + g, b + h, c + i, d + j, e + k, f + m


def scaled(s: Six, by: float) -> Matrix:
    """Return so many times a matrix."""
    return s[0] * by, s[1] * by, s[2] * by, s[3] * by, s[4] * by, s[5] * by


def plus(v: Vector, w: Vector) -> Triple:
    """Return the sum of two vectors."""
    return v[0] + w[0], v[1] + w[1], v[2] + w[2]


def minus(v: Vector, w: Vector) -> Triple:
    """Return the difference of two vectors."""
    return v[0] - w[0], v[1] - w[1], v[2] - w[2]


def trace(s: Six) -> float:
    """Return the sum along the diagonal."""
    return s[0] + s[3] + s[5]


def along(x: float, y: float, z: float) -> Matrix:
    """Return the matrix of an error of one sigma along a vector."""
    return x * x, x * y, x * z, y * y, y * z, z * z


def inverse(s: Six, thicker: float = FLAT) -> Matrix:
    """Return the inverse; of a flat matrix, which has none, that of one `thicker` by that share."""
    xx, xy, xz, yy, yz, zz = s
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    n = xx * a + xy * b + xz * c
    if n <= 0.0:
        by = max(LEAST_M2, thicker * max(map(abs, s)))
        return inverse((xx + by, xy, xz, yy + by, yz, zz + by), 10 * thicker)
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    return a / n, b / n, c / n, d / n, e / n, f / n


def times(s: Six, v: Vector) -> Triple:
    """Return the product with a vector."""
    xx, xy, xz, yy, yz, zz = s
    x, y, z = v
    return xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z


def squared(s: Six, v: Vector) -> float:
    """Return the square of a vector's length as the matrix measures it."""
    xx, xy, xz, yy, yz, zz = s
    x, y, z = v
    return xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)


def product(s: Six, t: Six) -> tuple[Triple, Triple, Triple]:
    """Return the rows of s @ t, which need not be symmetric."""
    columns = (t[0], t[1], t[2]), (t[1], t[3], t[4]), (t[2], t[4], t[5])
    a, b, c = (times(s, column) for column in columns)
    return (a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2])
