"""Default profile: how far off a frame's localisation is, common to all that it shows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.geometry import pose_covariance
from d3a.model import Json, Pose
from d3a.parameters import Parameters

Floats = NDArray[np.float64]


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

    def correct(self, residuals: Floats, noise: Floats) -> None:
        """Take in how far known things (n, 3) were off, with their covariances (n, 3, 3).

        Each weighs the less the farther it is off what was expected, as it may be mistaken.
        """
        if len(residuals) == 0 or not self.covariance.any():
            return
        dof = self.parameters.outlier_dof
        squared, _ = likelihood.mahalanobis(residuals - self.mean, noise + self.covariance)
        weight = np.minimum(1.0, (dof + 3) / (dof + squared))
        precision = np.linalg.inv(noise) * weight[:, None, None]
        prior = np.linalg.inv(self.covariance)
        self.covariance = np.linalg.inv(prior + precision.sum(axis=0))
        pull = prior @ self.mean + np.einsum("nij,nj->i", precision, residuals)
        self.mean = self.covariance @ pull

    def to_state(self) -> Json:
        """Return the state as JSON."""
        covariance = self.covariance.ravel().tolist()
        return {"mean": self.mean.tolist(), "covariance": covariance, "time_ms": self.time_ms}

    def restore(self, record: Json) -> None:
        """Go on where `to_state` was called."""
        self.mean = np.array(record["mean"])
        self.covariance = np.array(record["covariance"]).reshape(3, 3)
        self.time_ms = record["time_ms"]
