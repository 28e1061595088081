from __future__ import annotations

import math

import pytest

from d3a.ingesting.coverage import Coverage, angle_between
from d3a.model import Pose
from d3a.parameters import DEFAULT
from tests.worlds.rounds import CAMERA, FORWARD


def pose(x: float, yaw: float = 0.0) -> Pose:
    half = yaw / 2
    # Turned about the map's z after FORWARD: quaternion product (0, 0, sin, cos) * FORWARD.
    _, y, _, w = FORWARD
    sine, cosine = math.sin(half), math.cos(half)
    return Pose((x, 0.0, 0.0), (-sine * y, cosine * y, sine * w, cosine * w))


def test_standing_still_is_one_view() -> None:
    coverage = Coverage(DEFAULT, "lab", "r")
    for second in range(50):
        assert coverage.add(second * 1000, pose(0.004 * second), CAMERA) is None
    assert coverage.open is not None
    assert (coverage.open.frames, coverage.open.end_ms) == (50, 49_000)
    assert coverage.open.half_angle == pytest.approx(math.atan(32 / 50))
    assert coverage.open.range_m == DEFAULT.view_range_m


@pytest.mark.parametrize(
    ("later", "second"),
    [(pose(0.6), 1), (pose(0.0, 0.4), 1), (pose(0.0), 700), (None, 1)],
    ids=["moved", "turned", "paused", "lost"],
)
def test_another_viewpoint_is_another_view(later: Pose | None, second: int) -> None:
    coverage = Coverage(DEFAULT, "lab", "r")
    coverage.add(0, pose(0.0), CAMERA)
    ended = coverage.add(second * 1000, later, CAMERA)
    assert ended is not None
    assert (ended.start_ms, ended.end_ms, ended.x, ended.site) == (0, 0, 0.0, "lab")


def test_a_slow_drift_ends_a_view_too() -> None:
    coverage = Coverage(DEFAULT, "lab", "r")
    ended = [coverage.add(n * 1000, pose(0.1 * n), CAMERA) for n in range(13)]
    assert sum(view is not None for view in ended) == 2


def test_the_open_view_survives_a_restart() -> None:
    coverage = Coverage(DEFAULT, "lab", "r")
    coverage.add(0, pose(1.0), CAMERA)
    again = Coverage(DEFAULT, "lab", "r")
    again.restore(coverage.to_state())
    assert again.open == coverage.open
    again.restore(None)
    assert again.open is None


def test_angles_go_round() -> None:
    assert angle_between(math.pi - 0.1, -math.pi + 0.1) == pytest.approx(0.2)
    assert angle_between(0.0, 3 * math.pi) == pytest.approx(math.pi)
