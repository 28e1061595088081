"""Default profile: evidence that a thing came to its place ("I looked there before: nothing").

The counterpart of `absence`: a side that shows a thing now, and showed nothing of it in looks
before it was first seen, says that it was not there then, so that it was brought. How much each
look says follows from how often such things are found at all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.model import Position
from d3a.parameters import Parameters
from d3a.sightings import Scene
from d3a.tracking.known import Place
from d3a.tracking.sides import LOOK_RANGE_M, Look, chance, is_familiar, share_of_look

Floats = NDArray[np.float64]
KEPT = 1024
"""Looks that are remembered at least, the latest; twice as many at most."""
CAME_MOST = 6.0
"""Log-odds that looks before a thing was seen count for at most."""
Spot = tuple[int, list[float]]
"""How often a place was seen, and where it is."""
_TIME, _EYE, _TURN, _EDGES = 0, slice(1, 4), slice(4, 13), slice(13, 17)
"""Of a row: when, where the camera was, its axes in the map, and left, right, top and bottom of
its picture, each at a metre's distance."""


class Looked:
    """What the latest looks had in view: of each its first frame."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._rows = np.empty((2 * KEPT, 17))
        self._count = 0
        self.is_open = False
        """Whether a look is going on whose first frame is known."""
        self._told: dict[Place, tuple[Spot, list[Look]]] = {}
        """What `_before` told of places, for as long as no look is forgotten: the same few are
        asked of after each look, and mostly not seen in between."""

    def watch(self, scene: Scene, eye: Position, turn: Sequence[float]) -> None:
        """Take in a frame of a known camera.

        eye: where it was taken from, in the map of things; turn: see `geometry.axes`.
        """
        camera = scene.camera
        if self.is_open or camera is None:
            return
        self.is_open = True
        edge_u, edge_v = (n * self._parameters.view_margin for n in (camera.width, camera.height))
        left, right = ((u - camera.cx) / camera.fx for u in (edge_u, camera.width - edge_u))
        top, bottom = ((v - camera.cy) / camera.fy for v in (edge_v, camera.height - edge_v))
        if self._count == len(self._rows):
            self._rows[:KEPT] = self._rows[KEPT:]
            self._told.clear()
            self._count = KEPT
        self._rows[self._count] = (scene.ref.time_ms, *eye, *turn, left, right, top, bottom)
        self._count += 1

    def end_look(self) -> None:
        """Let the next frame begin a look."""
        self.is_open = False

    def came(self, place: Place, where: Floats, usual: float) -> float:
        """Return the log-odds that what is at a place was not there before it was first seen.

        where: (3,), the place's position. usual: how likely a look finds what is there.
        """
        said = vain = 0.0
        latest: list[Look] = []
        for eye, time_ms in self._looks_before(place, where):
            share, latest = share_of_look(latest, eye, time_ms)
            said -= share * math.log(1 - chance(place, usual, vain))
            vain += share
            if said >= CAME_MOST:
                return CAME_MOST
        return said

    def _looks_before(self, place: Place, where: Floats) -> list[Look]:
        """Return what `_before` does, which changes only with a view of the place."""
        spot = place.seen, where.tolist()
        known = self._told.get(place)
        if known is None or known[0] != spot:
            known = self._told[place] = spot, self._before(place, where)
        return known[1]

    def _before(self, place: Place, where: Floats) -> list[Look]:
        """Return the looks that had a place in view from a side that has shown it since."""
        rows = self.rows
        near = rows[:, _TIME] < place.first_ms
        for eyes, at in zip(rows[:, _EYE].T, where.tolist(), strict=True):
            near &= np.abs(eyes - at) <= 2 * LOOK_RANGE_M  # no picture is so wide
        rows = rows[near]  # few of them: only these are gone through as a whole
        away = where - rows[:, _EYE]
        x, y, z = np.einsum("ni,nij->jn", away, rows[:, _TURN].reshape(-1, 3, 3))
        left, right, top, bottom = rows[:, _EDGES].T
        seen = (z > 0) & (z <= LOOK_RANGE_M)
        seen &= (x >= left * z) & (x <= right * z) & (y >= top * z) & (y <= bottom * z)
        return [
            ((eye_x, eye_y, eye_z), int(time_ms))
            for (time_ms, eye_x, eye_y, eye_z), depth_m in zip(
                rows[seen, :4].tolist(), z[seen].tolist(), strict=True
            )
            if is_familiar(place, (eye_x, eye_y, eye_z), depth_m)
        ]

    @property
    def rows(self) -> Floats:
        """(n, 17): the looks, in the order in which they were taken."""
        return self._rows[: self._count]

    def restore(self, rows: Floats, is_open: bool) -> None:
        """Go on with looks that `rows` gave; is_open: whether the last of them goes on."""
        self._count, self.is_open = len(rows), is_open
        self._rows[: len(rows)] = rows
        self._told.clear()

    def clear(self) -> None:
        """Forget all looks."""
        self._count, self.is_open = 0, False
        self._told.clear()
