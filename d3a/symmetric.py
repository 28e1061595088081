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
FULL = [0, 1, 2, 1, 3, 4, 2, 4, 5]
"""Of the six numbers, those of the matrix row by row."""
LEAST_M2, FLAT = 1e-9, 1e-6
"""What is added along each axis of a matrix that has no inverse, and the share of its largest
number, if that is more: a robot on wheels says that its height is exact."""


def of_rows(flat: Vector) -> Matrix:
    """Return the six numbers of nine, row by row."""
    return flat[0], flat[1], flat[2], flat[4], flat[5], flat[8]


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
