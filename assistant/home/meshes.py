"""Solids as triangle meshes: boxes, solids of revolution, tubes and rounded bodies.

Lengths are metres, z points up, angles are degrees. Every solid is centred on x = y = 0 and, unless
its docstring says otherwise, stands on z = 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: `vertices` (n, 3) in metres, `faces` (m, 3) their rows, counter-clockwise.

    Vertices that share a row are shaded as one smooth surface; an edge is sharp where they do not.
    """

    vertices: Floats
    faces: NDArray[np.int64]

    def normals(self) -> Floats:
        """Return the unit normal of each vertex, (n, 3): its faces' normals weighted by area."""
        corners = self.vertices[self.faces]
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        total = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(total, self.faces[:, corner], face)
        length = np.linalg.norm(total, axis=1, keepdims=True)
        return np.asarray(total / np.where(length > 0, length, 1.0))

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """Return the mesh shifted by x, y, z metres."""
        return Mesh(self.vertices + np.array([x, y, z]), self.faces)

    def turned(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Mesh:
        """Return the mesh turned about the x, then the y, then the z axis."""
        return Mesh(self.vertices @ rotation(x, y, z).T, self.faces)

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> Mesh:
        """Return the mesh scaled along each axis, or evenly where only one factor is given."""
        factors = np.array([x, x if y is None else y, x if z is None else z])
        return Mesh(self.vertices * factors, self.faces)


def rotation(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Floats:
    """Return the (3, 3) matrix that turns a column about x, then y, then z, by degrees."""
    turned = np.eye(3)
    for axis, angle in enumerate((x, y, z)):
        cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        one = np.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        one[[first, first, second, second], [first, second, first, second]] = [
            *(cosine, -sine),
            *(sine, cosine),
        ]
        turned = one @ turned
    return turned


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """Return one mesh with the triangles of all; no vertex becomes shared."""
    vertices: list[Floats] = []
    faces: list[NDArray[np.int64]] = []
    count = 0
    for mesh in meshes:
        vertices.append(mesh.vertices)
        faces.append(mesh.faces + count)
        count += len(mesh.vertices)
    return Mesh(np.concatenate(vertices), np.concatenate(faces))


def _grid(points: Floats, *, wrap_rows: bool, wrap_columns: bool) -> Mesh:
    """Stretch quads, as pairs of triangles, over a (rows, columns, 3) grid of points."""
    rows, columns = points.shape[:2]
    row, column = np.meshgrid(
        np.arange(rows if wrap_rows else rows - 1),
        np.arange(columns if wrap_columns else columns - 1),
        indexing="ij",
    )
    below, right = (row + 1) % rows, (column + 1) % columns
    a, b = row * columns + column, row * columns + right
    c, d = below * columns + right, below * columns + column
    faces = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    return Mesh(points.reshape(-1, 3), faces.astype(np.int64))


def box(width: float, depth: float, height: float) -> Mesh:
    """Return a box: `width` along x, `depth` along y, `height` along z, with sharp edges."""
    sides = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            corners = np.empty((2, 2, 3))
            first, second = (axis + 1) % 3, (axis + 2) % 3
            corners[..., axis] = sign
            corners[..., first] = np.array([[-1.0], [1.0]])
            corners[..., second] = np.array([[-1.0, 1.0]])
            quad = corners if sign < 0 else corners[::-1]
            sides.append(_grid(quad, wrap_rows=False, wrap_columns=False))
    solid = joined(sides)
    return solid.scaled(width / 2, depth / 2, height / 2).moved(z=height / 2)


def lathe(
    profile: Sequence[tuple[float, float]], *, segments: int = 36, crease: float = 35
) -> Mesh:
    """Return the solid swept by a profile of (radius, z), listed from its lower end up the outside.

    The profile turns about the z axis; a bend of more than `crease` degrees makes a sharp edge.
    """
    points = np.asarray(profile, dtype=np.float64)
    steps = np.diff(points, axis=0)
    angles = np.degrees(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    bends = np.flatnonzero(np.abs(np.diff(angles)) > crease) + 1
    around = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    bands = []
    for start, end in zip([0, *bends], [*bends, len(points) - 1], strict=True):
        radius, z = points[start : end + 1, 0, None], points[start : end + 1, 1, None]
        ring = np.stack(
            [
                radius * np.cos(around),
                radius * np.sin(around),
                np.broadcast_to(z, (len(z), segments)),
            ],
            axis=-1,
        )
        bands.append(_grid(ring, wrap_rows=False, wrap_columns=True))
    return joined(bands)


def cylinder(radius: float, height: float, *, top: float | None = None) -> Mesh:
    """Return a closed cylinder, or a cone frustum where `top` gives the upper radius."""
    upper = radius if top is None else top
    return lathe([(0.0, 0.0), (radius, 0.0), (upper, height), (0.0, height)])


def tube(
    path: ArrayLike, radius: float | Sequence[float], *, closed: bool = False, sides: int = 10
) -> Mesh:
    """Return a round bar along `path` (n, 3), where that lies; `radius` may vary by point."""
    points = np.asarray(path, dtype=np.float64)
    ahead = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    if not closed:
        ahead[0], ahead[-1] = points[1] - points[0], points[-1] - points[-2]
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    # The axis that the path turns least towards keeps the rings from twisting on the way.
    steady = np.eye(3)[np.abs(ahead).max(axis=0).argmin()]
    across = np.cross(ahead, steady)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    upward = np.cross(across, ahead)
    around = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    radii = np.broadcast_to(np.asarray(radius, dtype=np.float64), (len(points),))[:, None, None]
    rings = points[:, None] + radii * (
        upward[:, None] * np.cos(around)[:, None] + across[:, None] * np.sin(around)[:, None]
    )
    if not closed:  # the ends are closed by rings of no width
        rings = np.concatenate(
            [
                np.broadcast_to(points[0], (1, sides, 3)),
                rings,
                np.broadcast_to(points[-1], (1, sides, 3)),
            ]
        )
    return _grid(rings, wrap_rows=closed, wrap_columns=True)


def arc(radius: float, start: float, end: float, *, steps: int = 16) -> Floats:
    """Return points (steps, 3) of an arc in the x, y plane, from `start` to `end` degrees."""
    angles = np.radians(np.linspace(start, end, steps))
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), np.zeros(steps)], axis=-1)


def ring(radius: float, thickness: float, *, steps: int = 28) -> Mesh:
    """Return a torus that lies on z = 0: `radius` to the middle of a bar of radius `thickness`."""
    circle = arc(radius, 0, 360, steps=steps + 1)[:-1]
    return tube(circle, thickness, closed=True).moved(z=thickness)


def _angles(start: float, octants: int, roundness: float) -> Floats:
    """Return 4 steps an octant from `start` degrees, in radians, closer at the corners.

    The corners are the odd multiples of 45 degrees; the rounder the body, the more even the steps.
    """
    rise = np.linspace(0, 1, 5)[1:] ** (1 + 2 * (1 - roundness))
    to_corner = 1 - np.append(rise[-2::-1], 0.0)
    steps = [to_corner if octant % 2 == 0 else rise for octant in range(octants)]
    degrees = np.concatenate([octant + step for octant, step in enumerate(steps)]) * 45 + start
    return np.asarray(np.radians(np.append(float(start), degrees)))


def body(width: float, depth: float, height: float, *, roundness: float = 1.0) -> Mesh:
    """Return a superellipsoid: an ellipsoid at roundness 1, a box with soft edges near 0."""
    up = _angles(-90, 4, roundness)[:, None]
    around = _angles(0, 8, roundness)[None, :-1]

    def reach(angle: Floats) -> Floats:
        # Even angles: the usual powers of sine and cosine crowd the points at small roundness
        # into slivers, whose normals a renderer cannot tell.
        power = 2.0 / roundness
        return np.asarray(
            (abs(np.cos(angle)) ** power + abs(np.sin(angle)) ** power) ** (-1 / power)
        )

    level, turn = reach(up), reach(around)
    points = np.stack(
        [
            level * np.cos(up) * turn * np.cos(around) * width / 2,
            level * np.cos(up) * turn * np.sin(around) * depth / 2,
            np.broadcast_to(level * np.sin(up), (17, 32)) * height / 2 + height / 2,
        ],
        axis=-1,
    )
    return _grid(points, wrap_rows=False, wrap_columns=True)
