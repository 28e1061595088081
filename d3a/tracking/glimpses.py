"""Default profile: which of the known places the frames of a look had in view, and what hid them.

Frames without depth are judged together when the look ends, as one table of frames and places: a
look is a handful of frames from nearly one viewpoint, and each table costs as much as a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.checkpoint import Arrays
from d3a.geometry import NEAREST_M, frustum, into_camera
from d3a.model import Camera, Position
from d3a.parameters import Parameters
from d3a.sightings import Metres, Scene
from d3a.tracking.depths import NEAREST_SHARE, nearer, samples
from d3a.tracking.positions import MOST_PLACES, Positions
from d3a.tracking.sides import LOOK_RANGE_M

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
_View = tuple[float, ...]
"""A frame that waits: x y z of its eye in the map, the variance of that along all three axes
together, and the matrix (4, 4) of `geometry.into_camera`."""
PATCH, PATCH_MOST = 3, 40
"""Half the side, in pixels, of the patch of depth that is looked at, at least and at most."""
SURE_M = 1.0
"""A place whose position may err by more than this (one sigma) cannot be looked at."""
WAITING_MOST = 32
"""So many frames are judged together at most: a robot may stand still for hours."""


@dataclass(frozen=True, slots=True)
class Shown:
    """What a look showed of k places, by thing and place.

    keys: (k,), see `Positions.keys`. counts: (3, k), frames that had it in view, those of them in
    which something hides it, and those that show only what is behind it. last: (4, k), x y z of
    where the camera was when it was last in plain view, and how far off the place; NaN: never.
    """

    keys: NDArray[np.int64]
    counts: Floats
    last: Floats

    @classmethod
    def nothing(cls, keys: NDArray[np.int64]) -> Shown:
        """Return places of which no frame showed anything."""
        return cls(keys, np.zeros((3, len(keys))), np.full((4, len(keys)), np.nan))

    def then(self, later: Shown) -> Shown:
        """Return what this and a later part of a look show together."""
        both = Shown.nothing(np.union1d(self.keys, later.keys))
        for part in (self, later):
            at = both.keys.searchsorted(part.keys)
            both.counts[:, at] += part.counts
            plain = ~np.isnan(part.last[3])
            both.last[:, at[plain]] = part.last[:, plain]
        return both

    def some(self, wanted: NDArray[np.bool_]) -> Shown:
        """Return what it showed of some places."""
        return Shown(self.keys[wanted], self.counts[:, wanted], self.last[:, wanted])


NO_PLACES = np.empty(0, dtype=np.int64)


class Glimpses:
    """Collects what the frames of the current look show of the known places."""

    def __init__(self, positions: Positions, parameters: Parameters) -> None:
        self._positions = positions
        self._parameters = parameters
        self._waiting: list[_View] = []
        """Frames that are not judged yet."""
        self._shown: Shown | None = None
        """What those showed that are judged."""
        self._camera: Camera | None = None
        """That of the frames that wait, which is mostly the next one's too."""
        self._frustum: Floats | None = None
        """What it has in view, (6, 4)."""

    def add(self, scene: Scene, eye: Position, turn: Sequence[float], error_m2: float) -> None:
        """Take in a frame of a known camera.

        eye: where it was in the map of things; turn: see `geometry.axes`; error_m2: variance of the
        eye along all three axes of the map together.
        """
        camera = scene.camera
        if camera is not self._camera and camera != self._camera:
            self._judge()
            self._camera, self._frustum = camera, None
        if scene.depth is not None or len(self._waiting) == WAITING_MOST:
            self._judge()
        self._waiting.append((*eye, error_m2, *into_camera(eye, turn)))
        if scene.depth is not None:
            self._judge(scene.depth)

    def take(self) -> tuple[Rows, Shown]:
        """Return what the look showed of the places that are known still, with their rows."""
        if self._shown is None:
            return self._in_view()
        self._judge()
        shown, self._shown = self._shown, None
        rows = self._positions.rows_of(shown.keys)
        known = rows >= 0
        return rows[known], shown.some(known)

    def forget(self, number: int) -> None:
        """Forget what the look showed of a thing, by its number."""
        if self._shown is not None:
            self._shown = self._shown.some(self._shown.keys // MOST_PLACES != number)

    def _judge(self, depth: Metres | None = None) -> None:
        """Judge the frames that wait; depth: of the only one."""
        if not self._waiting:
            return
        _, shown = self._in_view(depth)
        self._shown = shown if self._shown is None else self._shown.then(shown)

    def _in_view(self, depth: Metres | None = None) -> tuple[Rows, Shown]:
        """Return what the frames that wait show, with the rows of the places; none waits then."""
        waiting, self._waiting = self._waiting, []
        positions = self._positions
        if not waiting or not positions.owners:
            return np.empty(0, dtype=np.intp), Shown.nothing(NO_PLACES)
        views = np.array(waiting)  # (frames, 20)
        into, limits = views[:, 4:].reshape(-1, 4, 4), 3 * SURE_M**2 - views[:, 3:4]
        inside = (self._view() @ into).reshape(-1, 4) @ positions.spots
        inside = inside.reshape(len(views), 6, -1)
        seen = np.logical_and.reduce(inside >= 0.0, axis=1)  # (frames, places), as what follows
        seen &= positions.spread_m2 <= limits
        rows = positions.in_order(np.logical_or.reduce(seen, axis=0))
        counts, last = np.zeros((3, len(rows))), np.empty((4, len(rows)))
        if len(views) == 1:
            counts[0] = 1.0
            last[:3] = views[0, :3, None]
            last[3] = inside[0, 4, rows]
        else:
            latest = np.zeros(len(rows), dtype=np.intp)
            for k, shows in enumerate(seen[:, rows]):
                latest[shows] = k
                counts[0] += shows
            last[:3] = views[latest, :3].T
            last[3] = inside[latest, 4, rows]
        last[3] += NEAREST_M
        if depth is not None and len(rows):
            spots, sigma_m2 = into[0] @ positions.spots[:, rows], positions.spread_m2[rows] / 3
            hidden, through = self._depths(depth, spots[1:], np.sqrt(sigma_m2 + views[0, 3] / 3))
            counts[1], counts[2] = hidden, through
            last[:, hidden] = np.nan
        return rows, Shown(positions.keys(rows), counts, last)

    def _view(self) -> Floats:
        if self._frustum is None:
            assert self._camera is not None, "no frame waits without one"
            self._frustum = frustum(self._camera, LOOK_RANGE_M, self._parameters.view_margin)
        return self._frustum

    def _depths(
        self, depth: Metres, spots: Floats, sigma_m: Floats
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Say of places (3, k) whether something hides them, and whether only what is behind shows.

        A thing may be anywhere in its error around its place: nothing there may be as near as it.
        """
        camera = self._camera
        assert camera is not None, "no frame waits without one"
        x, y, away_m = spots
        u, v = camera.cx + camera.fx * x / away_m, camera.cy + camera.fy * y / away_m
        spot = np.full(len(sigma_m), float(PATCH))
        margin = self._parameters.seen_through_m + 2 * sigma_m
        before, measured = nearer(samples(depth, u, v, spot, 2 * PATCH + 1), away_m - margin)
        hidden = 2 * before > measured
        wide = PATCH + np.round(2 * sigma_m * camera.fx / away_m)
        around = samples(depth, u, v, np.minimum(wide, PATCH_MOST))
        near, of = nearer(around, away_m + self._parameters.seen_through_m)
        through = ~hidden & (measured > 0) & (near < NEAREST_SHARE * of) & (wide <= PATCH_MOST)
        return hidden, through

    def to_state(self) -> tuple[list[float], Arrays]:
        """Return the numbers of the camera, none before any, and the frames as arrays."""
        camera = [] if self._camera is None else list(astuple(self._camera))
        shown = self._shown or Shown.nothing(NO_PLACES)
        return camera, {
            "waiting": np.array(self._waiting).reshape(-1, 20),
            "shown_keys": shown.keys,
            "shown": np.concatenate([shown.counts, shown.last]),
        }

    def restore(self, camera: list[float], arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        if camera:
            width, height, *lens = camera
            self._camera, self._frustum = Camera(int(width), int(height), *lens), None
        self._waiting = [tuple(view) for view in arrays["waiting"].tolist()]
        shown = arrays["shown"]
        self._shown = Shown(arrays["shown_keys"], shown[:3], shown[3:]) if shown.size else None
