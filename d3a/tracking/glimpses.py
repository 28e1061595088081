"""Default profile: which of the known places the frames of looks had in view, and what hid them.

Frames without depth are judged together, those of several looks as one table of frames and places:
a look is a handful of frames from nearly one viewpoint, and each table costs as much as a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from itertools import islice

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
    """What a look, or several, showed of k places, by thing and place.

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

    @classmethod
    def joined(cls, parts: Sequence[Shown]) -> Shown:
        """Return what some showed, one after the other."""
        return cls(
            np.concatenate([each.keys for each in parts]),
            np.concatenate([each.counts for each in parts], axis=1),
            np.concatenate([each.last for each in parts], axis=1),
        )

    def some(self, wanted: NDArray[np.bool_]) -> Shown:
        """Return what it showed of some places."""
        return Shown(self.keys[wanted], self.counts[:, wanted], self.last[:, wanted])


NO_PLACES = np.empty(0, dtype=np.int64)
NO_ROWS = np.empty(0, dtype=np.intp)


class Glimpses:
    """Collects what the frames of the latest looks show of the known places.

    The last look goes on; the others have ended, and wait to be taken.
    """

    def __init__(self, positions: Positions, parameters: Parameters) -> None:
        self._positions = positions
        self._parameters = parameters
        self._waiting: list[list[_View]] = [[]]
        """Of each look the frames that are not judged yet, and how many these are together."""
        self._count = 0
        self._shown: list[Shown | None] = [None]
        """Of each look what those showed that are judged."""
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
        if scene.depth is not None or self._count == WAITING_MOST:
            self._judge()
        self._waiting[-1].append((*eye, error_m2, *into_camera(eye, turn)))
        self._count += 1
        if scene.depth is not None:
            self._judge(scene.depth)

    def end_look(self) -> None:
        """Let the next frame begin a look."""
        self._waiting.append([])
        self._shown.append(None)

    def take(self) -> tuple[Rows, Rows, Shown]:
        """Return what the looks that ended showed of the places that are known still.

        By look, thing and place: the look, counted from the first, and the row of each place.
        """
        waiting, self._waiting = self._waiting[:-1], self._waiting[-1:]
        judged, self._shown = self._shown[:-1], self._shown[-1:]
        self._count = len(self._waiting[0])
        of, rows, shown = self._in_view(waiting)
        if not any(judged):
            return of, rows, shown
        parts = [
            shown.some(of == k) if each is None else each.then(shown.some(of == k))
            for k, each in enumerate(judged)
        ]
        of = np.repeat(np.arange(len(parts)), [len(part.keys) for part in parts])
        shown = Shown.joined(parts)
        rows = self._positions.rows_of(shown.keys)
        known = rows >= 0
        return of[known], rows[known], shown.some(known)

    def forget(self, number: int) -> None:
        """Forget what the looks showed of a thing, by its number."""
        self._shown = [
            each and each.some(each.keys // MOST_PLACES != number) for each in self._shown
        ]

    def _judge(self, depth: Metres | None = None) -> None:
        """Judge the frames that wait; depth: of the only one."""
        if not self._count:
            return
        of, _, shown = self._in_view(self._waiting, depth)
        self._waiting, self._count = [[] for _ in self._waiting], 0
        for k in np.unique(of).tolist():
            part, before = shown.some(of == k), self._shown[k]
            self._shown[k] = part if before is None else before.then(part)

    def _in_view(
        self, waiting: list[list[_View]], depth: Metres | None = None
    ) -> tuple[Rows, Rows, Shown]:
        """Return what the frames of looks show; see `take`."""
        positions, frames = self._positions, [view for look in waiting for view in look]
        if not frames or not positions.owners:
            return NO_ROWS, NO_ROWS, Shown.nothing(NO_PLACES)
        views = np.array(frames)  # (frames, 20)
        into, limits = views[:, 4:].reshape(-1, 4, 4), 3 * SURE_M**2 - views[:, 3:4]
        inside = (self._view() @ into).reshape(-1, 4) @ positions.spots
        inside = inside.reshape(len(views), 6, -1)
        seen = np.logical_and.reduce(inside >= 0.0, axis=1)  # (frames, places), as what follows
        seen &= positions.spread_m2 <= limits
        rows = positions.in_order(np.logical_or.reduce(seen, axis=0))
        of, columns, latest, times = _by_look(seen[:, rows], [len(look) for look in waiting])
        rows = rows[columns]
        counts, last = np.zeros((3, len(rows))), np.empty((4, len(rows)))
        counts[0] = times
        last[:3] = views[latest, :3].T
        last[3] = inside[latest, 4, rows] + NEAREST_M
        if depth is not None and len(rows):
            spots, sigma_m2 = into[0] @ positions.spots[:, rows], positions.spread_m2[rows] / 3
            hidden, through = self._depths(depth, spots[1:], np.sqrt(sigma_m2 + views[0, 3] / 3))
            counts[1], counts[2] = hidden, through
            last[:, hidden] = np.nan
        return of, rows, Shown(positions.keys(rows), counts, last)

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
        shown = [each or Shown.nothing(NO_PLACES) for each in self._shown]
        whole = Shown.joined(shown)
        frames = [view for look in self._waiting for view in look]
        return camera, {
            "waiting": np.array(frames).reshape(-1, 20),
            "waiting_counts": np.array([len(look) for look in self._waiting]),
            "shown_keys": whole.keys,
            "shown": np.concatenate([whole.counts, whole.last]),
            "shown_counts": np.array([len(each.keys) for each in shown]),
        }

    def restore(self, camera: list[float], arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        if camera:
            width, height, *lens = camera
            self._camera, self._frustum = Camera(int(width), int(height), *lens), None
        frames, keys, shown = arrays["waiting"], arrays["shown_keys"], arrays["shown"]
        # older checkpoints hold no look but the one that goes on
        waiting = arrays.get("waiting_counts", np.array([len(frames)]))
        counts = arrays.get("shown_counts", np.array([len(keys)]))
        self._count = len(frames)
        views = iter([tuple(view) for view in frames.tolist()])
        self._waiting = [list(islice(views, count)) for count in waiting.tolist()]
        self._shown, first = [], 0
        for count in counts.tolist():
            part = slice(first, first := first + count)
            each = Shown(keys[part], shown[:3, part], shown[3:, part])
            self._shown.append(each if count else None)


def _by_look(
    seen: NDArray[np.bool_], frames: Sequence[int]
) -> tuple[Rows, Rows, Rows, NDArray[np.intp] | float]:
    """Return which looks had which places in view, the last frame that did, and how many did.

    seen: (n, k), of each frame, look by look; frames: how many each look has.
    """
    looks = np.array([k for k, count in enumerate(frames) if count])
    if len(looks) == len(seen):  # the usual case: each frame is one
        at, columns = seen.nonzero()
        return looks[at], columns, at, 1.0
    starts = np.cumsum([0, *(count for count in frames if count)])[:-1]
    number = np.arange(1, len(seen) + 1)[:, None]
    latest = np.maximum.reduceat(seen * number, starts, axis=0)
    at, columns = latest.nonzero()
    times = np.add.reduceat(seen, starts, axis=0, dtype=np.intp)
    return looks[at], columns, latest[at, columns] - 1, times[at, columns]
