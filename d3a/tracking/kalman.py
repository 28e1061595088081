"""Default profile: how one view moves what is known of a place: Kalman's update, robust."""

from __future__ import annotations

from typing import NamedTuple

from d3a.parameters import Parameters
from d3a.symmetric import Matrix, Six, Triple, Vector, inverse, product, squared


class Pulled(NamedTuple):
    """A place after a view: its means, the covariance of both, and how far off the view was.

    error: xx xy xz yy yz zz. squared: in sigmas.
    """

    mean: Triple
    raw: Triple
    error: Matrix
    squared: float


def pulled(
    known: tuple[Vector, Vector, Six, Six],
    where: Vector,
    offset: Vector,
    noise: Six,
    parameters: Parameters,
) -> Pulled:
    """Return what becomes of a place that was seen, with Student's weight for outliers.

    known: its mean, raw mean, error, and the spread that its views are expected to have. where: in
    the frame; offset: how far the frame is off; noise: what a view errs by, without the surface.
    """
    (mx, my, mz), (rx, ry, rz), error, (sxx, sxy, sxz, syy, syz, szz) = known
    (wx, wy, wz), (ox, oy, oz), (xx, xy, xz, yy, yz, zz) = where, offset, noise
    away = wx - ox - mx, wy - oy - my, wz - oz - mz
    expected = xx + sxx, xy + sxy, xz + sxz, yy + syy, yz + syz, zz + szz
    off = squared(inverse(expected), away)
    dof = parameters.outlier_dof
    weight = min(1.0, (dof + 3) / (dof + off))
    surface = parameters.object_spread_m**2
    a, b, c, d, e, f = error
    views = (
        a + (xx + surface) / weight, b + xy / weight, c + xz / weight,
        d + (yy + surface) / weight, e + yz / weight, f + (zz + surface) / weight,
    )  # fmt: skip
    gain = product(error, inverse(views))
    (px, py, pz), (qx, qy, qz), (tx, ty, tz) = gain
    less = (
        a - (px * a + py * b + pz * c), b - (px * b + py * d + pz * e),
        c - (px * c + py * e + pz * f), d - (qx * b + qy * d + qz * e),
        e - (qx * c + qy * e + qz * f), f - (tx * c + ty * e + tz * f),
    )  # fmt: skip
    mean = _moved((mx, my, mz), gain, away)
    return Pulled(mean, _moved((rx, ry, rz), gain, (wx - rx, wy - ry, wz - rz)), less, off)


def _moved(mean: Triple, gain: tuple[Triple, Triple, Triple], away: Triple) -> Triple:
    (mx, my, mz), (x, y, z) = mean, away
    (a, b, c), (d, e, f), (g, h, i) = gain
    return mx + a * x + b * y + c * z, my + d * x + e * y + f * z, mz + g * x + h * y + i * z
