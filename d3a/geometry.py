"""Where a detection is in the map, how sure that is, and what a camera could see.

Paper: Pre-processing, "estimated from the robot's pose and limited depth information". Camera
frames are optical (x right, y down, z forward); covariances are 3 x 3 in the map frame, m^2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from d3a.model import Box, Camera, Detection, Pose, Position
from d3a.parameters import Parameters
from d3a.symmetric import Matrix

Floats = NDArray[np.float64]
Metres = NDArray[np.float32]
CENTRE_SHARE = 0.5
"""Side of the box's middle whose depths are taken: the rim is mostly what is behind the thing."""
NEAREST_M = 1e-6
"""What is not so far before a camera is in no picture."""
MIN_DEPTHS = 5
"""Fewer measured pixels than this in the middle of a box are no measurement."""


def axes(pose: Pose) -> tuple[float, ...]:
    """Return the nine numbers, row by row, of the matrix that turns camera axes into map axes."""
    x, y, z, w = pose.quaternion
    return (
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y),
    )  # fmt: skip


def rotation(pose: Pose) -> Floats:
    """Return the (3, 3) matrix that turns camera axes into map axes."""
    return np.array(axes(pose)).reshape(3, 3)


def quaternion(matrix: Floats) -> tuple[float, float, float, float]:
    """Return x y z w of a (3, 3) rotation, w >= 0."""
    m = matrix
    candidates = np.array(
        [
            [
                1 + m[0, 0] - m[1, 1] - m[2, 2],
                m[0, 1] + m[1, 0],
                m[0, 2] + m[2, 0],
                m[2, 1] - m[1, 2],
            ],
            [
                m[0, 1] + m[1, 0],
                1 - m[0, 0] + m[1, 1] - m[2, 2],
                m[1, 2] + m[2, 1],
                m[0, 2] - m[2, 0],
            ],
            [
                m[0, 2] + m[2, 0],
                m[1, 2] + m[2, 1],
                1 - m[0, 0] - m[1, 1] + m[2, 2],
                m[1, 0] - m[0, 1],
            ],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + np.trace(m)],
        ]
    )
    # The row with the largest diagonal is the one that does not divide by nearly nothing.
    best = candidates[int(np.argmax(np.diag(candidates)))]
    best = best / np.linalg.norm(best) * (1 if best[3] >= 0 else -1)
    return float(best[0]), float(best[1]), float(best[2]), float(best[3])


def pose_covariance(pose: Pose, parameters: Parameters) -> Matrix:
    """Return the covariance of the camera's place, which all things in a frame share."""
    if pose.covariance is None:
        variance = parameters.pose_sigma_m**2
        return variance, 0.0, 0.0, variance, 0.0, variance
    c = pose.covariance  # (6, 6), row by row
    return c[0], c[1], c[2], c[7], c[8], c[14]


def heading_covariance(pose: Pose, position: Floats) -> Floats:
    """Return what the pose's turning error does to a place seen from it, (3, 3)."""
    if pose.covariance is None:
        return np.zeros((3, 3))
    x, y, z = position - np.array(pose.position)
    lever = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    turning = np.reshape(pose.covariance, (6, 6))[3:, 3:]
    return np.asarray(lever @ turning @ lever.T)


@dataclass(frozen=True, slots=True)
class Spot:
    """A point before the camera: range along its axis, and the one-sigma errors of both."""

    depth_m: float
    depth_sigma_m: float
    sideways_sigma_m: float


def measured(depth: Metres, box: Box, parameters: Parameters) -> Spot | None:
    """Return the median depth of the middle of the box; None where too little was measured.

    depth: metres (h, w), 0 for nothing. The spread of the depths there (median absolute
    deviation) is part of the error: a chair's slats show what is behind them.
    """
    x1, y1, x2, y2 = box
    half_w, half_h = (x2 - x1) * CENTRE_SHARE / 2, (y2 - y1) * CENTRE_SHARE / 2
    cx, cy = (x1 + x2) / 2, (y1 + y2) / 2
    rows = slice(max(0, int(cy - half_h)), max(0, math.ceil(cy + half_h)))
    columns = slice(max(0, int(cx - half_w)), max(0, math.ceil(cx + half_w)))
    values = depth[rows, columns]
    values = values[values > 0]
    if len(values) < MIN_DEPTHS:
        return None
    middle = float(np.median(values))
    scatter = 1.4826 * float(np.median(np.abs(values - middle)))
    sigma = math.hypot(parameters.depth_sigma_rel * middle, scatter)
    return Spot(middle, sigma, parameters.depth_sigma_rel * middle)


def _unmeasured(parameters: Parameters) -> Spot:
    far = parameters.no_depth_range_m
    return Spot(far, far / 2, parameters.depth_sigma_rel * far)


def locate(
    detection: Detection,
    pose: Pose | None,
    camera: Camera | None,
    depth: Metres | None,
    parameters: Parameters,
) -> Detection:
    """Return the detection with position, covariance and extent, as far as they can be told.

    A position that the recording gives is kept, and tells how far and so how large the thing is.
    Else depth, intrinsics and pose give it; without
    depth it is half way along the ray of the box's centre with an error as long, and without
    intrinsics it is the robot's own place with that error all around (DESIGN, decision 6).
    The covariance is the thing's own share: what all things in a frame have in common is in the
    pose's covariance, and the tiers add it.
    """
    if detection.position is not None:
        return _sized(_given(detection, pose, parameters), pose, camera)
    if pose is None:
        return detection
    spot = measured(depth, detection.box, parameters) if depth is not None else None
    if camera is None:
        far = parameters.no_depth_range_m
        return _placed(detection, np.array(pose.position), np.eye(3) * far**2)
    found = spot or _unmeasured(parameters)
    x1, y1, x2, y2 = detection.box
    ray = np.array(
        [((x1 + x2) / 2 - camera.cx) / camera.fx, ((y1 + y2) / 2 - camera.cy) / camera.fy, 1]
    )
    turn = rotation(pose)
    position = turn @ (ray * found.depth_m) + np.array(pose.position)
    across = np.eye(3) * found.sideways_sigma_m**2
    along = np.outer(ray, ray) * found.depth_sigma_m**2
    covariance = turn @ (across + along) @ turn.T + heading_covariance(pose, position)
    placed = _placed(detection, position, covariance)
    if spot is None:
        return replace(placed, ranged=False)
    return replace(placed, extent_m=_extent(detection.box, spot.depth_m, camera))


def _given(detection: Detection, pose: Pose | None, parameters: Parameters) -> Detection:
    if detection.covariance is not None:
        return detection
    position = np.array(detection.position)
    covariance = np.eye(3) * parameters.position_sigma_m**2
    if pose is not None:
        away = position - np.array(pose.position)
        covariance += np.outer(away, away) * parameters.depth_sigma_rel**2
        covariance += heading_covariance(pose, position)
    return _placed(detection, position, covariance)


def _sized(detection: Detection, pose: Pose | None, camera: Camera | None) -> Detection:
    """Return the detection with its extent, from its own position as seen by the camera."""
    if detection.extent_m is not None or pose is None or camera is None:
        return detection
    away = np.array(detection.position) - np.array(pose.position)
    ahead = float(away @ rotation(pose)[:, 2])
    if ahead <= 0:  # the position is another one than the picture's
        return detection
    return replace(detection, extent_m=_extent(detection.box, ahead, camera))


def _extent(box: Box, ahead_m: float, camera: Camera) -> tuple[float, float] | None:
    """Return width and height in metres, None for a box that the picture's edge cuts."""
    x1, y1, x2, y2 = box
    if min(x1, y1) < 1 or x2 > camera.width - 1 or y2 > camera.height - 1:
        return None
    return (x2 - x1) * ahead_m / camera.fx, (y2 - y1) * ahead_m / camera.fy


def _placed(detection: Detection, position: Floats, covariance: Floats) -> Detection:
    x, y, z = (float(v) for v in position)
    return replace(
        detection, position=(x, y, z), covariance=tuple(float(v) for v in covariance.ravel())
    )


@dataclass(frozen=True, slots=True)
class Projection:
    """Points of the map as a camera sees them: pixels (n,), (n,) and depth (n,), metres."""

    u: Floats
    v: Floats
    depth_m: Floats


def project(points: Floats, pose: Pose, camera: Camera) -> Projection:
    """Project map points (n, 3) into a picture; depth <= 0 is behind the camera."""
    local = (points - np.array(pose.position)) @ rotation(pose)
    z = local[:, 2]
    ahead = np.where(z > NEAREST_M, z, np.nan)
    u = camera.cx + camera.fx * local[:, 0] / ahead
    v = camera.cy + camera.fy * local[:, 1] / ahead
    return Projection(u, v, z)


def frustum(camera: Camera, range_m: float, margin: float) -> Floats:
    """Return what a camera has in view, (6, 4): half-spaces along its own axes.

    The picture without `margin` (share of its size) at each edge, to so far away: a point is in
    view where the products of all rows with 1, x, y and z are 0 or more. That of the fifth is how
    far ahead it is, less `NEAREST_M`.
    """
    edge_u, edge_v = camera.width * margin, camera.height * margin
    return np.array(
        [
            [0.0, camera.fx, 0.0, camera.cx - edge_u],
            [0.0, -camera.fx, 0.0, camera.width - edge_u - camera.cx],
            [0.0, 0.0, camera.fy, camera.cy - edge_v],
            [0.0, 0.0, -camera.fy, camera.height - edge_v - camera.cy],
            [-NEAREST_M, 0.0, 0.0, 1.0],
            [range_m, 0.0, 0.0, -1.0],
        ]
    )


def into_camera(eye: Position, turn: Sequence[float]) -> list[float]:
    """Return the (4, 4) matrix, row by row, from 1, x, y, z in the map to those along the axes.

    eye: where the camera is; turn: its axes, see `axes`.
    """
    (x, y, z), (a, b, c, d, e, f, g, h, i) = eye, turn
    return [
        1.0, 0.0, 0.0, 0.0,
        -(a * x + d * y + g * z), a, d, g,
        -(b * x + e * y + h * z), b, e, h,
        -(c * x + f * y + i * z), c, f, i,
    ]  # fmt: skip


def heading(pose: Pose) -> float:
    """Return the viewing direction in the map's x-y plane, radians; up is z (REP 103)."""
    x, y, z, w = pose.quaternion
    return math.atan2(2 * (y * z - x * w), 2 * (x * z + y * w))  # of the camera's z axis


def clip_box(box: Box, width: int, height: int) -> Box | None:
    """Return the part of the box inside the picture; None where less than a pixel is."""
    x1, y1 = max(0.0, box[0]), max(0.0, box[1])
    x2, y2 = min(float(width), box[2]), min(float(height), box[3])
    return (x1, y1, x2, y2) if x2 - x1 >= 1 and y2 - y1 >= 1 else None


def iou(one: Box, other: Box) -> float:
    """Return the intersection over union of two boxes."""
    ax1, ay1, ax2, ay2 = one
    bx1, by1, bx2, by2 = other
    width, height = min(ax2, bx2) - max(ax1, bx1), min(ay2, by2) - max(ay1, by1)
    if width <= 0 or height <= 0:
        return 0.0
    shared = width * height
    return shared / ((ax2 - ax1) * (ay2 - ay1) + (bx2 - bx1) * (by2 - by1) - shared)
