"""The robot's camera: optical frames (x right, y down, z forward), projection, depth rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from d3a.model import Camera
from d3a.simulation.patrol import PITCH, Track
from d3a.simulation.solids import Floats, ranges

Floats64 = NDArray[np.float64]
CAMERA = Camera(width=320, height=240, fx=225.0, fy=225.0, cx=160.0, cy=120.0)
DEPTH_LIMIT_M = 6.0
DEPTH_STEP = 5  # depth is measured on a grid of 64 x 48 and repeated to the picture's size


def axes(yaw: Floats64) -> Floats64:
    """Return the rotation from optical frame to map, (m, 3, 3): columns right, down, forward."""
    c, s = np.cos(yaw), np.sin(yaw)
    cp, sp = np.cos(PITCH), np.sin(PITCH)
    forward = np.stack([c * cp, s * cp, np.full_like(c, -sp)], axis=1)
    right = np.stack([s, -c, np.zeros_like(c)], axis=1)
    return np.stack([right, np.cross(forward, right), forward], axis=2)


def quaternions(yaw: Floats64) -> Floats64:
    """Return the same rotation as unit quaternions x y z w, (m, 4)."""
    zero, half = np.zeros_like(yaw), yaw / 2
    about_up = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=1)
    about_left = np.array([[0.0, np.sin(PITCH / 2), 0.0, np.cos(PITCH / 2)]])
    optical = np.array([[-0.5, 0.5, -0.5, 0.5]])
    return _product(_product(about_up, about_left), optical)


def _product(a: Floats64, b: Floats64) -> Floats64:
    """Return the Hamilton product of quaternions x y z w, rows broadcast."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a.T, b.T
    return np.stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
        axis=-1,
    )


def seen_from(track: Track, frame: NDArray[np.intp], points: Floats64) -> Floats64:
    """Return points (p, ..., 3) of the map in the optical frame of each one's `frame` (p,)."""
    turned = axes(track.yaw)[frame]
    middle = (1,) * (points.ndim - 2)
    offset = points - track.places[frame].reshape(len(frame), *middle, 3)
    return np.asarray(np.einsum("p...i,pij->p...j", offset, turned))


def pixels(points: Floats64) -> Floats64:
    """Project points (..., 3) of the optical frame to u, v (..., 2), as if at least 5 cm away."""
    depth = np.maximum(points[..., 2], 0.05)
    return np.stack(
        [
            CAMERA.cx + CAMERA.fx * points[..., 0] / depth,
            CAMERA.cy + CAMERA.fy * points[..., 1] / depth,
        ],
        axis=-1,
    )


def corners(solids: NDArray[np.floating]) -> Floats64:
    """Return the eight corners of each solid, (p, 8, 3)."""
    pick = np.array([[x, y, z] for x in (0, 3) for y in (1, 4) for z in (2, 5)])
    return np.asarray(solids, dtype=float)[:, pick]


def rays() -> Floats:
    """Return the depth grid's rays in the optical frame, (3072, 3), rows first, unit depth."""
    u = (np.arange(CAMERA.width // DEPTH_STEP) + 0.5) * DEPTH_STEP
    v = (np.arange(CAMERA.height // DEPTH_STEP) + 0.5) * DEPTH_STEP
    grid_v, grid_u = np.meshgrid(v, u, indexing="ij")
    x, y = (grid_u - CAMERA.cx) / CAMERA.fx, (grid_v - CAMERA.cy) / CAMERA.fy
    return np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3).astype(np.float32)


def depth_image(
    place: Floats64, turned: Floats64, solids: Floats, noise: bool, rng: np.random.Generator
) -> NDArray[np.uint16]:
    """Return what a depth camera at `place` (3,) with axes `turned` (3, 3) measures, millimetres.

    Noise grows with the square of the depth, as a structured-light camera's; 0 beyond 6 m.
    """
    origin = place.astype(np.float32)
    bundle = rays() @ turned.T.astype(np.float32)
    depth = ranges(origin, bundle, solids, DEPTH_LIMIT_M).astype(float)
    depth[depth >= DEPTH_LIMIT_M] = 0.0
    if noise:
        depth += 0.0015 * depth**2 * rng.normal(size=len(depth))
    coarse = np.round(depth * 200.0).astype(np.uint16) * np.uint16(5)  # steps of 5 mm
    shape = (CAMERA.height // DEPTH_STEP, CAMERA.width // DEPTH_STEP)
    return np.kron(coarse.reshape(shape), np.ones((DEPTH_STEP, DEPTH_STEP), dtype=np.uint16))
