"""Boxes in space: what hides what, and how far the camera sees.

A solid is a row (x0, y0, z0, x1, y1, z1) in metres, axis-aligned, lower corner first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Ints = NDArray[np.intp]
LATERAL = (-0.7, 0.0, 0.7)
VERTICAL = (-0.75, -0.25, 0.25, 0.75)
SAMPLES = len(LATERAL) * len(VERTICAL)
_CHUNK = 4_000_000  # slab tests held in memory at a time


def centred(position: NDArray[np.floating], size: NDArray[np.floating]) -> Floats:
    """Return the solids of things at `position` (..., 3), their centres, of `size` (..., 3)."""
    half = np.asarray(size) / 2
    return np.concatenate([position - half, position + half], axis=-1).astype(np.float32)


def overlap(solid: NDArray[np.floating], others: NDArray[np.floating], margin: float) -> bool:
    """Whether a solid comes closer than `margin` to one of `others` (n, 6)."""
    if not len(others):
        return False
    apart = (solid[:3] - margin >= others[:, 3:]) | (solid[3:] + margin <= others[:, :3])
    return bool((~apart.any(axis=1)).any())


def sample_points(cameras: Floats, targets: Floats) -> Floats:
    """Return points over each target's silhouette: cameras (p, 3), targets (p, 6) -> (p, s, 3).

    A grid across the line of sight and up the box, rows from the floor up, left to right within.
    """
    centre, size = (targets[:, :3] + targets[:, 3:]) / 2, targets[:, 3:] - targets[:, :3]
    sight = centre[:, :2] - cameras[:, :2]
    sight /= np.maximum(np.linalg.norm(sight, axis=1, keepdims=True), 1e-6)
    side = np.stack([sight[:, 1], -sight[:, 0]], axis=1)  # to the viewer's right
    half = 0.5 * (np.abs(side) * size[:, :2]).sum(axis=1)
    v, u = np.meshgrid(VERTICAL, LATERAL, indexing="ij")
    across = side[:, None, :] * (half[:, None] * u.ravel()[None])[..., None]
    points = np.repeat(centre[:, None, :], SAMPLES, axis=1)
    points[..., :2] += across
    points[..., 2] += 0.5 * size[:, 2:3] * v.ravel()[None]
    return points.astype(np.float32)


def blocked(origins: Floats, points: Floats, solids: Floats) -> NDArray[np.bool_]:
    """Return which segments a solid crosses, (p, s, b).

    origins (p, 3), points (p, s, 3), solids (p or 1, b, 6). The last 2 % of a segment do not
    count: a thing touches what it stands on.
    """
    ray = points - origins[:, None, :]
    ray = np.where(np.abs(ray) < 1e-6, np.float32(1e-6), ray)
    low = np.full((*ray.shape[:2], solids.shape[1]), 0.01, dtype=np.float32)
    high = np.full_like(low, 0.98)
    for axis in range(3):
        start = origins[:, None, axis, None]
        a = (solids[:, None, :, axis] - start) / ray[..., axis, None]
        b = (solids[:, None, :, axis + 3] - start) / ray[..., axis, None]
        np.maximum(low, np.minimum(a, b), out=low)
        np.minimum(high, np.maximum(a, b), out=high)
    return np.asarray(low < high)


def visible(
    cameras: Floats,
    targets: Floats,
    own: Ints,
    fixed: Floats,
    fixed_owner: Ints,
    loose: Floats,
    moment: Ints,
) -> NDArray[np.bool_]:
    """Return which sample points of each target are in plain sight, (p, s).

    cameras (p, 3), targets (p, 6); own (p,): the thing the target is, -1 for none.
    fixed (b, 6) with the thing each is part of, fixed_owner (b,); loose (m, n, 6): thing i at
    moment j; moment (p,): the moment of each pair. Nothing hides itself.
    """
    out = np.empty((len(cameras), SAMPLES), dtype=bool)
    step = max(1, _CHUNK // (SAMPLES * (len(fixed) + loose.shape[1])))
    things = np.arange(loose.shape[1])
    for begin in range(0, len(cameras), step):
        part = slice(begin, begin + step)
        points = sample_points(cameras[part], targets[part])
        by_fixed = blocked(cameras[part], points, fixed[None])
        by_fixed &= (fixed_owner[None] != own[part, None])[:, None, :]
        by_loose = blocked(cameras[part], points, loose[moment[part]])
        by_loose &= (things[None] != own[part, None])[:, None, :]
        out[part] = ~(by_fixed.any(axis=2) | by_loose.any(axis=2))
    return out


def ranges(origin: Floats, rays: Floats, solids: Floats, limit: float) -> Floats:
    """Return how far each ray (r, 3) goes, in lengths of the ray, before it meets a solid (b, 6).

    `limit` where it meets none. With rays of unit depth this is the depth image.
    """
    near = _reachable(origin, rays, solids, limit)
    safe = np.where(np.abs(rays) < 1e-6, np.float32(1e-6), rays)
    low = np.full((len(rays), len(near)), 0.05, dtype=np.float32)
    high = np.full_like(low, limit)
    for axis in range(3):
        a = (near[:, axis] - origin[axis])[None] / safe[:, axis, None]
        b = (near[:, axis + 3] - origin[axis])[None] / safe[:, axis, None]
        np.maximum(low, np.minimum(a, b), out=low)
        np.minimum(high, np.maximum(a, b), out=high)
    low[low >= high] = limit
    return np.asarray(low.min(axis=1, initial=limit), dtype=np.float32)


def _reachable(origin: Floats, rays: Floats, solids: Floats, limit: float) -> Floats:
    """Keep the solids that a bundle of rays can meet: those in front and not past its edges."""
    axis = rays.mean(axis=0)
    axis /= np.linalg.norm(axis)
    unit = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    widest = float(np.arccos(np.clip(unit @ axis, -1, 1)).max())
    centre, size = (solids[:, :3] + solids[:, 3:]) / 2, solids[:, 3:] - solids[:, :3]
    radius = np.linalg.norm(size, axis=1) / 2
    away = centre - origin
    distance = np.maximum(np.linalg.norm(away, axis=1), 1e-6)
    angle = np.arccos(np.clip((away @ axis) / distance, -1, 1))
    reach = np.arcsin(np.clip(radius / distance, 0, 1))
    keep = (distance <= radius) | ((angle - reach < widest) & (distance - radius < 1.3 * limit))
    return np.asarray(solids[keep])
