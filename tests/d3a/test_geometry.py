from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a import geometry
from d3a.model import Camera, Detection, Pose
from d3a.parameters import DEFAULT
from tests.worlds.rounds import CAMERA, FORWARD

IDENTITY = (0.0, 0.0, 0.0, 1.0)
turns = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(v * v for v in q) > 0.01)
metres = st.floats(-20, 20)


def detection(box: tuple[float, float, float, float] = (22, 14, 42, 34)) -> Detection:
    return Detection("cup", 0.9, box)


@given(turns)
def test_a_rotation_is_orthogonal_and_comes_back(q: tuple[float, float, float, float]) -> None:
    matrix = geometry.rotation(Pose((0, 0, 0), q))
    assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(matrix) == pytest.approx(1.0)
    again = geometry.rotation(Pose((0, 0, 0), geometry.quaternion(matrix)))
    assert np.allclose(matrix, again, atol=1e-9)


@given(turns, metres, metres, metres, st.floats(0.3, 5.0))
def test_what_is_placed_projects_back_into_the_middle_of_its_box(
    q: tuple[float, float, float, float], x: float, y: float, z: float, away: float
) -> None:
    pose = Pose((x, y, z), q)
    depth = np.full((48, 64), away, np.float32)
    box = (40.0, 4.0, 60.0, 24.0)
    placed = geometry.locate(detection(box), pose, CAMERA, depth, DEFAULT)
    assert placed.position is not None
    seen = geometry.project(np.array([placed.position]), pose, CAMERA)
    assert (seen.u[0], seen.v[0]) == pytest.approx((50.0, 14.0), abs=1e-3)
    assert seen.depth_m[0] == pytest.approx(away, rel=1e-5)


def test_depth_places_a_thing_and_tells_its_size() -> None:
    depth = np.full((48, 64), 2.0, np.float32)
    placed = geometry.locate(detection(), Pose((1, 2, 3), IDENTITY), CAMERA, depth, DEFAULT)
    assert placed.position == pytest.approx((1.0, 2.0, 5.0))
    assert placed.extent_m == pytest.approx((0.8, 0.8))
    assert placed.covariance is not None
    sigma = np.sqrt(np.diag(np.reshape(placed.covariance, (3, 3))))
    assert (sigma < 0.1).all()


def test_the_median_is_not_moved_by_what_shows_through() -> None:
    depth = np.full((48, 64), 2.0, np.float32)
    depth[:, ::3] = 4.0
    depth[0:20] = 0.0
    found = geometry.measured(depth, (22, 14, 42, 34), DEFAULT)
    assert found is not None
    assert found.depth_m == pytest.approx(2.0)


def test_without_depth_the_covariance_says_so() -> None:
    pose = Pose((0, 0, 0), IDENTITY)
    holes = np.zeros((48, 64), np.float32)
    for depth in (None, holes):
        placed = geometry.locate(detection(), pose, CAMERA, depth, DEFAULT)
        assert placed.covariance is not None
        assert placed.extent_m is None
        along = math.sqrt(placed.covariance[8])
        across = math.sqrt(placed.covariance[0])
        assert along >= 1.0
        assert across < along / 5
    bare = geometry.locate(detection(), pose, None, None, DEFAULT)
    assert bare.position == (0.0, 0.0, 0.0)
    assert bare.covariance is not None
    assert math.sqrt(bare.covariance[0]) == pytest.approx(DEFAULT.no_depth_range_m)


def test_without_a_pose_there_is_no_position() -> None:
    assert geometry.locate(detection(), None, CAMERA, None, DEFAULT).position is None


def test_a_turning_error_grows_with_the_distance_and_is_sideways() -> None:
    covariance = np.zeros((6, 6))
    covariance[5, 5] = 0.01  # about z
    pose = Pose((0, 0, 0), FORWARD, tuple(covariance.ravel().tolist()))
    error = geometry.heading_covariance(pose, np.array([4.0, 0.0, 0.0]))
    assert error[1, 1] == pytest.approx(16 * 0.01)
    assert error[0, 0] == pytest.approx(0.0)


def test_a_given_position_is_kept_and_gets_a_covariance() -> None:
    given_one = Detection("cup", 0.9, (1, 1, 5, 5), position=(3.0, 0.0, 0.0))
    placed = geometry.locate(given_one, Pose((0, 0, 0), FORWARD), CAMERA, None, DEFAULT)
    assert placed.position == (3.0, 0.0, 0.0)
    assert placed.covariance is not None
    own = Detection("cup", 0.9, (1, 1, 5, 5), position=(3.0, 0.0, 0.0), covariance=(1.0,) * 9)
    assert geometry.locate(own, None, CAMERA, None, DEFAULT) is own


def test_a_given_position_tells_how_large_a_thing_is() -> None:
    whole = Detection("cup", 0.9, (10, 10, 30, 20), position=(2.0, 0.0, 0.0))
    placed = geometry.locate(whole, Pose((0, 0, 0), FORWARD), CAMERA, None, DEFAULT)
    assert placed.extent_m == pytest.approx((20 * 2.0 / CAMERA.fx, 10 * 2.0 / CAMERA.fy))
    for box, position in (((0, 10, 30, 20), (2.0, 0.0, 0.0)), ((10, 10, 30, 20), (-2.0, 0.0, 0.0))):
        cut = Detection("cup", 0.9, box, position=position)  # by the edge; behind the camera
        assert (
            geometry.locate(cut, Pose((0, 0, 0), FORWARD), CAMERA, None, DEFAULT).extent_m is None
        )


def _in_view(points: geometry.Floats, camera: Camera, reach_m: float, margin: float) -> list[int]:
    """Return which of points (n, 3) along the camera's axes are in view."""
    along = np.concatenate([np.ones((1, len(points))), points.T])
    told = geometry.frustum(camera, reach_m, margin) @ along
    return np.flatnonzero((told >= 0).all(axis=0)).tolist()


def test_in_view_knows_edges_range_and_behind() -> None:
    points = np.array([[0, 0, 2], [0, 0, -2], [0, 0, 9], [1.25, 0, 2], [5, 0, 2]], float)
    assert _in_view(points, CAMERA, 5.0, 0.0) == [0, 3]
    assert _in_view(points, CAMERA, 5.0, 0.1) == [0]


@given(turns, st.lists(st.tuples(metres, metres, metres), min_size=1, max_size=8))
def test_what_is_in_view_is_what_the_picture_shows(
    q: tuple[float, float, float, float], points: list[tuple[float, float, float]]
) -> None:
    pose, margin, reach = Pose((1.0, -2.0, 0.5), q), 0.1, 8.0
    seen = geometry.project(np.array(points), pose, CAMERA)
    into = np.reshape(geometry.into_camera(pose.position, geometry.axes(pose)), (4, 4))
    local = (into @ np.insert(np.array(points), 0, 1.0, axis=1).T)[1:].T
    assert np.allclose(local, (np.array(points) - pose.position) @ geometry.rotation(pose))
    sides = ((seen.u, CAMERA.width), (seen.v, CAMERA.height))
    inside = [np.minimum(at - size * margin, size * (1 - margin) - at) for at, size in sides]
    ahead = np.minimum(seen.depth_m - geometry.NEAREST_M, reach - seen.depth_m)
    least = np.fmin.reduce([*inside, ahead])
    kept = set(_in_view(local, CAMERA, reach, margin))
    for k, by in enumerate(least.tolist()):  # on the edge itself rounding decides
        assert abs(by) < 1e-6 or (k in kept) == (by > 0)


def test_heading_is_in_the_ground_plane() -> None:
    assert geometry.heading(Pose((0, 0, 0), FORWARD)) == pytest.approx(0.0)


def test_boxes_are_cut_to_the_picture() -> None:
    assert geometry.clip_box((-5, 2, 10, 99), 64, 48) == (0.0, 2, 10, 48.0)
    assert geometry.clip_box((70, 2, 80, 9), 64, 48) is None
    one = (0.0, 0.0, 2.0, 2.0)
    boxes = (one, (1.0, 0.0, 3.0, 2.0), (5.0, 5.0, 6.0, 6.0))
    assert [geometry.iou(one, box) for box in boxes] == pytest.approx([1.0, 1 / 3, 0.0])


def test_a_camera_of_another_size_is_its_own() -> None:
    wide = Camera(128, 48, 50, 50, 64, 24)
    assert _in_view(np.array([[2.4, 0.0, 2.0]]), wide, 5.0, 0.0) == [0]
