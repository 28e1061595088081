"""Default profile: how far off a frame's localisation is, common to all that it shows."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.geometry import pose_covariance
from d3a.model import Json, Pose
from d3a.parameters import Parameters
from d3a.symmetric import Six, Vector, inverse, of_rows, squared, times

Floats = NDArray[np.float64]
JUMP_M = 0.7
"""How far off, along each axis of the plane, a robot is that lost its way: twice the usual."""
LEAST_M2 = 1e-6
"""A millimetre: what is exact is known as well as that."""


@dataclass(slots=True)
class FrameOffset:
    """How far the frame's localisation is off the map of things: a slow Kalman state.

    It decays to zero over `pose_tau_s`, as a localisation that lost its way finds it again.
    """

    parameters: Parameters
    mean: Floats
    covariance: Floats
    time_ms: int | None = None

    @classmethod
    def unknown(cls, parameters: Parameters) -> FrameOffset:
        """Return the state before any frame."""
        return cls(parameters, np.zeros(3), np.zeros((3, 3)))

    def predict(self, time_ms: int, pose: Pose | None) -> None:
        """Go to the time of a frame whose pose claims this error."""
        if pose is None:  # a position then is the recording's own, and errs by its covariance
            self.mean, self.covariance, self.time_ms = np.zeros(3), np.zeros((3, 3)), None
            return
        prior = pose_covariance(pose, self.parameters)
        keep = 0.0
        if self.time_ms is not None:
            passed_s = abs(time_ms - self.time_ms) / 1000
            keep = math.exp(-passed_s / self.parameters.pose_tau_s)
        self.mean = self.mean * keep
        self.covariance = self.covariance * keep**2 + prior * (1 - keep**2)
        self.time_ms = time_ms

    def lost(self, pose: Pose) -> FrameOffset:
        """Return the state of a robot that may be somewhere else in the plane than it thinks."""
        wide = pose_covariance(pose, self.parameters)
        wide[:2, :2] += np.eye(2) * JUMP_M**2
        return FrameOffset(self.parameters, np.zeros(3), wide, self.time_ms)

    def likely(self, before: FrameOffset) -> float:
        """Return how likely the state was, of one that was known so before a frame, in the plane.

        Natural logarithm, with the share of what was possible that is left: what explains a frame
        only by being anywhere is worth less.
        """
        away = (self.mean - before.mean)[:2]
        left, of = (each.covariance[:2, :2] + np.eye(2) * LEAST_M2 for each in (self, before))
        narrower = np.linalg.slogdet(left)[1] - np.linalg.slogdet(of)[1]
        return float(narrower - away @ np.linalg.solve(of, away)) / 2

    def correct(self, known: Iterable[tuple[Vector, Six]]) -> None:
        """Take in how far known things were off: residuals with their covariances.

        Each weighs the less the farther it is off what was expected, as it may be mistaken.
        """
        dof = self.parameters.outlier_dof
        mx, my, mz = mean = self.mean.tolist()
        oxx, oxy, oxz, oyy, oyz, ozz = own = of_rows(self.covariance.ravel().tolist())
        total = inverse(own)
        sx, sy, sz = times(total, mean)
        for residual, (xx, xy, xz, yy, yz, zz) in known:
            x, y, z = residual
            noise = xx + oxx, xy + oxy, xz + oxz, yy + oyy, yz + oyz, zz + ozz
            off = squared(inverse(noise), (x - mx, y - my, z - mz))
            w = min(1.0, (dof + 3) / (dof + off))
            precision = inverse((xx / w, xy / w, xz / w, yy / w, yz / w, zz / w))
            px, py, pz = times(precision, residual)
            sx, sy, sz = sx + px, sy + py, sz + pz
            (a, b, c, d, e, f), (g, h, i, j, k, m) = total, precision
            total = a + g, b + h, c + i, d + j, e + k, f + m
        xx, xy, xz, yy, yz, zz = inverse(total)
        self.covariance = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        self.mean = self.covariance @ (sx, sy, sz)

    def to_state(self) -> Json:
        """Return the state as JSON."""
        covariance = self.covariance.ravel().tolist()
        return {"mean": self.mean.tolist(), "covariance": covariance, "time_ms": self.time_ms}

    def restore(self, record: Json) -> None:
        """Go on where `to_state` was called."""
        self.mean = np.array(record["mean"])
        self.covariance = np.array(record["covariance"]).reshape(3, 3)
        self.time_ms = record["time_ms"]
