"""The robot's rounds: when it looks, from where, at what."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np

from assistant.home.life import when
from assistant.home.meshes import Floats
from d3a.geometry import quaternion
from d3a.model import Camera, Pose

CAMERA = Camera(width=480, height=360, fx=400.0, fy=400.0, cx=240.0, cy=180.0)
EYE_HEIGHT_M = 1.2
FRAME_GAP_S = 4.0
ROOM_GAP_S = 22.0
POSITION_NOISE_M = 0.015
ANGLE_NOISE_DEG = 0.4

ROUNDS = tuple(
    when(text)
    for text in (
        *("1 08:31", "1 13:04", "1 19:41"),
        *("2 08:24", "2 12:52", "2 19:36"),
        *("3 08:37", "3 13:10", "3 19:48"),
    )
)

View = tuple[float, float, float, float, float]
"""Eye x, y; then the point looked at, x, y, z; metres."""

STOPS: tuple[tuple[View, ...], ...] = (
    (  # hall: from the dock, the shelf, the bench
        (0.75, 3.1, 2.6, 1.5, 0.7),
        (2.05, 2.5, 2.2, 1.22, 0.86),
        (2.4, 2.45, 2.2, 1.22, 0.86),
        (2.2, 2.2, 2.95, 3.8, 0.55),
        (2.55, 2.1, 2.95, 3.8, 0.55),
    ),
    (  # bedroom: from the door, the desk, the nightstand, the bed
        (4.75, 2.75, 8.0, 1.2, 0.65),
        (6.2, 1.75, 5.0, 0.87, 0.72),
        (6.28, 1.58, 5.0, 0.87, 0.72),
        (6.75, 1.65, 6.95, 0.25, 0.62),
        (6.5, 1.6, 7.05, 0.25, 0.62),
        (6.6, 2.75, 8.2, 0.95, 0.5),
    ),
    (  # kitchen: from the door, the table, along the counter, the fridge and the clock
        (1.2, 4.3, 2.42, 6.7, 0.8),
        (2.0, 4.32, 2.2, 5.6, 0.74),
        (2.45, 4.35, 2.2, 5.6, 0.74),
        (0.75, 6.45, 0.7, 7.6, 0.95),
        (1.2, 6.5, 1.15, 7.6, 0.95),
        (1.55, 6.5, 1.65, 7.6, 0.95),
        (1.75, 6.55, 2.2, 7.6, 0.95),
        (2.95, 4.7, 3.8, 7.4, 1.15),
    ),
    (  # living room: from the door, the coffee table, the couch, tv, bookcase, plant
        (4.85, 4.9, 7.9, 6.7, 0.6),
        (7.25, 4.95, 7.4, 6.2, 0.42),
        (7.6, 4.95, 7.4, 6.2, 0.42),
        (7.3, 5.3, 7.4, 7.5, 0.55),
        (8.6, 5.9, 7.6, 3.9, 0.7),
        (6.4, 6.0, 4.9, 6.8, 0.8),
        (7.2, 5.4, 9.4, 4.3, 0.7),
    ),
)


@dataclass(frozen=True, slots=True)
class Glance:
    """One frame to be taken: its name, time, where the camera truly is and what it looks at."""

    name: str
    time: datetime
    eye: tuple[float, float, float]
    target: tuple[float, float, float]

    @property
    def axes(self) -> Floats:
        """The camera's axes in the map frame, as the columns right, down, forward of a (3, 3)."""
        forward = np.subtract(self.target, self.eye)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(forward, right), forward], axis=-1)


def glances(rng: np.random.Generator) -> list[tuple[Glance, ...]]:
    """Return the frames of each round in order of time; no stop is taken up twice quite alike."""
    rounds = []
    number = 0
    for moment in ROUNDS:
        taken = []
        for stop in STOPS:
            for x, y, *target in stop:
                shift = rng.normal(scale=0.035, size=5)
                eye = (x + float(shift[0]), y + float(shift[1]), EYE_HEIGHT_M)
                at = tuple(float(t + s) for t, s in zip(target, shift[2:], strict=True))
                taken.append(Glance(f"{number:06d}", moment, eye, (at[0], at[1], at[2])))
                number += 1
                moment += timedelta(milliseconds=int(1000 * (FRAME_GAP_S + rng.uniform(-0.8, 0.8))))
            moment += timedelta(milliseconds=int(1000 * (ROOM_GAP_S + rng.uniform(-5, 5))))
        rounds.append(tuple(taken))
    return rounds


@dataclass(frozen=True, slots=True)
class Belief:
    """Where the robot believes its camera to be: the truth, off by localisation's noise."""

    eye: Floats
    axes: Floats

    def to_map(self, points: Floats) -> Floats:
        """Return points (..., 3) of the optical frame in the map frame, as the robot believes."""
        return np.asarray(points @ self.axes.T + self.eye)

    def pose(self) -> Pose:
        """Return the pose with its covariance."""
        spread = [POSITION_NOISE_M**2] * 2 + [1e-6] * 3 + [float(np.radians(ANGLE_NOISE_DEG)) ** 2]
        x, y, z = (float(value) for value in self.eye)
        covariance = tuple(float(value) for value in np.diag(spread).ravel())
        return Pose((x, y, z), quaternion(self.axes), covariance)


def believed(glance: Glance, rng: np.random.Generator) -> Belief:
    """Return the belief, off by POSITION_NOISE_M in x and y and ANGLE_NOISE_DEG in heading."""
    dx, dy = rng.normal(scale=POSITION_NOISE_M, size=2)
    turn = np.radians(rng.normal(scale=ANGLE_NOISE_DEG))
    cosine, sine = np.cos(turn), np.sin(turn)
    heading = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    return Belief(np.add(glance.eye, (dx, dy, 0.0)), heading @ glance.axes)
