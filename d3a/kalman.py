"""Default profile: how one view moves what is known of a place: Kalman's update, robust."""

from __future__ import annotations

from dataclasses import dataclass

from d3a.parameters import Parameters
from d3a.symmetric import Six, Triple, Vector, inverse, product, squared, times


@dataclass(frozen=True, slots=True)
class Pulled:
    """A place after a view: its means, the covariance of both, and how far off the view was.

    error: xx xy xz yy yz zz. squared: in sigmas.
    """

    mean: list[float]
    raw: list[float]
    error: Six
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
    mean, raw, error, spread = known
    away = [w - o - m for w, o, m in zip(where, offset, mean, strict=True)]
    off = squared(inverse([n + s for n, s in zip(noise, spread, strict=True)]), away)
    dof = parameters.outlier_dof
    weight = min(1.0, (dof + 3) / (dof + off))
    surface = parameters.object_spread_m**2
    xx, xy, xz, yy, yz, zz = noise
    views = [(n + s) / weight for n, s in ((xx, surface), (xy, 0.0), (xz, 0.0))]
    views += [(n + s) / weight for n, s in ((yy, surface), (yz, 0.0), (zz, surface))]
    gain = product(error, inverse([e + v for e, v in zip(error, views, strict=True)]))
    rest = [w - r for w, r in zip(where, raw, strict=True)]
    (lxx, lxy, lxz), (_, lyy, lyz), (_, _, lzz) = (times(error, row) for row in gain)
    less = (lxx, lxy, lxz, lyy, lyz, lzz)
    return Pulled(
        _moved(mean, gain, away),
        _moved(raw, gain, rest),
        [old - by for old, by in zip(error, less, strict=True)],
        off,
    )


def _moved(mean: Vector, gain: tuple[Triple, Triple, Triple], away: Vector) -> list[float]:
    x, y, z = away
    return [m + a * x + b * y + c * z for m, (a, b, c) in zip(mean, gain, strict=True)]
