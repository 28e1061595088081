"""Default profile: how far off a frame's localisation is, common to all that it shows."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from d3a.geometry import pose_covariance
from d3a.model import Json, Pose
from d3a.parameters import Parameters
from d3a.symmetric import (
    Matrix,
    Six,
    Triple,
    Vector,
    added,
    flat,
    inverse,
    minus,
    of_rows,
    plus,
    squared,
    times,
)

NOTHING, EXACT = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
JUMP_M = 0.7
"""How far off, along each axis of the plane, a robot is that lost its way: twice the usual."""
LEAST_M2 = 1e-6
"""A millimetre: what is exact is known as well as that."""


@dataclass(slots=True)
class FrameOffset:
    """How far the frame's localisation is off the map of things: a slow Kalman state.

    It decays to zero over `pose_tau_s`, as a localisation that lost its way finds it again.
    covariance: xx xy xz yy yz zz.
    """

    parameters: Parameters
    mean: Triple
    covariance: Matrix
    time_ms: int | None = None

    @classmethod
    def unknown(cls, parameters: Parameters) -> FrameOffset:
        """Return the state before any frame."""
        return cls(parameters, NOTHING, EXACT)

    def copy(self) -> FrameOffset:
        """Return the same state, to be changed by itself."""
        return FrameOffset(self.parameters, self.mean, self.covariance, self.time_ms)

    def predict(self, time_ms: int, pose: Pose | None) -> None:
        """Go to the time of a frame whose pose claims this error."""
        if pose is None:  # a position then is the recording's own, and errs by its covariance
            self.mean, self.covariance, self.time_ms = NOTHING, EXACT, None
            return
        keep = 0.0
        if self.time_ms is not None:
            passed_s = abs(time_ms - self.time_ms) / 1000
            keep = math.exp(-passed_s / self.parameters.pose_tau_s)
        old, new = keep**2, 1.0 - keep**2
        (x, y, z), (a, b, c, d, e, f) = self.mean, self.covariance
        xx, xy, xz, yy, yz, zz = pose_covariance(pose, self.parameters)
        self.mean = x * keep, y * keep, z * keep
        self.covariance = (
            a * old + xx * new, b * old + xy * new, c * old + xz * new,
            d * old + yy * new, e * old + yz * new, f * old + zz * new,
        )  # fmt: skip
        self.time_ms = time_ms

    def lost(self, pose: Pose) -> FrameOffset:
        """Return the state of a robot that may be somewhere else in the plane than it thinks."""
        xx, xy, xz, yy, yz, zz = pose_covariance(pose, self.parameters)
        wide = xx + JUMP_M**2, xy, xz, yy + JUMP_M**2, yz, zz
        return FrameOffset(self.parameters, NOTHING, wide, self.time_ms)

    def likely(self, before: FrameOffset) -> float:
        """Return how likely the state was, of one that was known so before a frame, in the plane.

        Natural logarithm, with the share of what was possible that is left: what explains a frame
        only by being anywhere is worth less.
        """
        x, y, _ = minus(self.mean, before.mean)
        (_, _, _, left), (xx, xy, yy, of) = _in_plane(self.covariance), _in_plane(before.covariance)
        squared_off = (yy * x * x - 2 * xy * x * y + xx * y * y) / of
        return (math.log(left / of) - squared_off) / 2

    def correct(self, known: Iterable[tuple[Vector, Six]]) -> None:
        """Take in how far known things were off: residuals with their covariances.

        Each weighs the less the farther it is off what was expected, as it may be mistaken.
        """
        dof = self.parameters.outlier_dof
        mx, my, mz = self.mean
        total = inverse(self.covariance)
        weighed = times(total, self.mean)
        for residual, noise in known:
            x, y, z = residual
            off = squared(inverse(added(noise, self.covariance)), (x - mx, y - my, z - mz))
            w = min(1.0, (dof + 3) / (dof + off))
            xx, xy, xz, yy, yz, zz = noise
            precision = inverse((xx / w, xy / w, xz / w, yy / w, yz / w, zz / w))
            weighed = plus(weighed, times(precision, residual))
            total = added(total, precision)
        self.covariance = inverse(total)
        self.mean = times(self.covariance, weighed)

    def to_state(self) -> Json:
        """Return the state as JSON."""
        covariance = list(flat(self.covariance))
        return {"mean": list(self.mean), "covariance": covariance, "time_ms": self.time_ms}

    def restore(self, record: Json) -> None:
        """Go on where `to_state` was called."""
        x, y, z = record["mean"]
        self.mean, self.covariance = (x, y, z), of_rows(record["covariance"])
        self.time_ms = record["time_ms"]


def _in_plane(covariance: Matrix) -> tuple[float, float, float, float]:
    """Return xx, xy and yy, no axis exact, and their determinant."""
    xx, yy, xy = covariance[0] + LEAST_M2, covariance[3] + LEAST_M2, covariance[1]
    return xx, xy, yy, xx * yy - xy * xy
