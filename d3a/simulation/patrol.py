"""The robot's rounds: way points in free space, paths between them, frames on the way.

Poses are true ones; the reported pose is these plus the noise of `reported`.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.simulation.conditions import Condition
from d3a.simulation.room import LENGTH, WIDTH
from d3a.simulation.world import World

Floats64 = NDArray[np.float64]
CELL_M = 0.2
CAMERA_M = 1.05  # height of the camera
PITCH = np.deg2rad(9.0)  # it looks down a little
SPEED = 0.35
TURN = np.deg2rad(45.0)  # per second
WAY_POINTS = 14
HEADINGS = 16
BURST_FRAMES = 50
FRAME_GAP_S = 3.6
Cell = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Track:
    """The camera over time: seconds (m,), x, y, z in metres (m, 3) and heading in radians (m,)."""

    times: Floats64
    places: Floats64
    yaw: Floats64


def frames_in(hours: float) -> int:
    """Return how many frames the paper's robot takes: 991 in 3 h, 10,132 in 22 h."""
    per_hour = 991 / 3 + (10132 / 22 - 991 / 3) * min(1.0, max(0.0, hours - 3.0) / 19.0)
    return max(1, round(per_hour * hours))


def idle_share(hours: float) -> float:
    """Return the share of frames at the dock: long recordings have half the detections a frame."""
    return 0.48 * min(1.0, max(0.0, hours - 3.0) / 19.0)


def patrol(world: World, hours: float, even: bool, rng: np.random.Generator) -> Track:
    """Drive bursts of rounds through the sessions and return where each frame was taken."""
    grid = _free_cells(world)
    points = _way_points(grid, rng)
    sights = [_sights(world, *_metres(point)) for point in points]
    liked = np.ones(len(points)) if even else rng.lognormal(0.0, 1.8, size=len(points))
    frames = frames_in(hours)
    bursts = max(1, round(frames / BURST_FRAMES))
    sizes = np.diff(np.linspace(0, frames, bursts + 1).round().astype(int))
    starts = _starts(world.sessions, bursts, rng)
    tracks, at = [], 0
    for start, count in zip(starts, sizes, strict=True):
        gaps = FRAME_GAP_S * rng.lognormal(0.0, 0.2, size=int(count))
        times = start + np.cumsum(gaps)
        idle = round(idle_share(hours) * int(count))
        at, drive = _drive(grid, points, sights, liked, even, at, times[-1] - start, rng)
        x, y, yaw = (np.interp(times - start, drive[:, 0], drive[:, c]) for c in (1, 2, 3))
        if idle:  # the end of the burst is spent at the dock, nose to the wall
            x[-idle:], y[-idle:], yaw[-idle:] = WIDTH / 2, 0.12, -np.pi / 2
        tracks.append(np.stack([times, x, y, yaw], axis=1))
    rows = np.concatenate(tracks)
    places = np.column_stack([rows[:, 1:3], np.full(len(rows), CAMERA_M)])
    return Track(rows[:, 0], places, rows[:, 3])


def reported(track: Track, condition: Condition, rng: np.random.Generator) -> Track:
    """Return the track as the robot's localiser has it: drawn towards truth, never quite there."""
    xy = np.stack([_wander(track.times, condition.pose_shares, rng) for _ in range(2)], axis=1)
    turn = _wander(track.times, condition.pose_shares, rng) * np.deg2rad(condition.heading_deg)
    places = track.places.copy()
    places[:, :2] += condition.pose_m * xy
    return Track(track.times, places, track.yaw + turn)


def _wander(
    times: Floats64, shares: tuple[float, float, float], rng: np.random.Generator
) -> Floats64:
    """Return unit-variance noise (m,): an independent, a 90 s and a 1 h part."""
    gaps = np.diff(times, prepend=times[0] - 1e9)
    total = np.sqrt(shares[0]) * rng.normal(size=len(times))
    for share, tau in zip(shares[1:], (90.0, 3600.0), strict=True):
        kept = np.exp(-gaps / tau)
        fresh = rng.normal(size=len(times)) * np.sqrt(1 - kept**2)
        state, part = 0.0, np.empty(len(times))
        for i in range(len(times)):
            state = kept[i] * state + fresh[i]
            part[i] = state
        total = total + np.sqrt(share) * part
    return np.asarray(total)


def _starts(
    sessions: tuple[tuple[float, float], ...], bursts: int, rng: np.random.Generator
) -> Floats64:
    """Spread bursts over the sessions; each ends before the next begins."""
    lengths = np.array([b - a for a, b in sessions])
    before = np.concatenate([[0.0], np.cumsum(lengths)])
    cycle = before[-1] / bursts
    need = BURST_FRAMES * FRAME_GAP_S * 1.25
    slack = max(0.0, cycle - need)
    spent = np.arange(bursts) * cycle + rng.uniform(0.0, 0.8 * slack + 1e-9, size=bursts)
    day = np.minimum(np.searchsorted(before, spent, side="right") - 1, len(sessions) - 1)
    return np.asarray(np.array([sessions[d][0] for d in day]) + spent - before[day])


def _free_cells(world: World) -> NDArray[np.bool_]:
    """Return the cells a robot of 0.2 m radius may stand in: chairs and furniture are not."""
    columns, rows = round(WIDTH / CELL_M), round(LENGTH / CELL_M)
    x = (np.arange(columns) + 0.5) * CELL_M
    y = (np.arange(rows) + 0.5) * CELL_M
    free = ((x > 0.3) & (x < WIDTH - 0.3))[:, None] & ((y > 0.3) & (y < LENGTH - 0.3))[None]
    solids = [s for piece in world.room.pieces for s in piece.solids]
    for stand in world.stands:
        if world.things[stand.thing].category == "chair":
            centre, half = np.array(stand.position), np.array(world.things[stand.thing].size) / 2
            solids.append((*(centre - half), *(centre + half)))
    for x0, y0, z0, x1, y1, _ in solids:
        if z0 < 1.2:
            inside_x = (x > x0 - 0.2) & (x < x1 + 0.2)
            inside_y = (y > y0 - 0.2) & (y < y1 + 0.2)
            free &= ~(inside_x[:, None] & inside_y[None])
    reach = _distances(free, _nearest_free(free, (columns // 2, rows // 2)))
    return np.asarray(free & (reach >= 0))


def _nearest_free(free: NDArray[np.bool_], cell: Cell) -> Cell:
    cells = np.argwhere(free)
    best = cells[np.abs(cells - np.array(cell)).sum(axis=1).argmin()]
    return int(best[0]), int(best[1])


def _distances(free: NDArray[np.bool_], goal: Cell) -> NDArray[np.intp]:
    """Return steps from each free cell to `goal`, -1 where there is no way."""
    steps = np.full(free.shape, -1)
    steps[goal] = 0
    queue = deque([goal])
    while queue:
        i, j = queue.popleft()
        for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b] and steps[a, b] < 0:
                steps[a, b] = steps[i, j] + 1
                queue.append((a, b))
    return steps


def _way_points(free: NDArray[np.bool_], rng: np.random.Generator) -> list[Cell]:
    """Pick way points far from each other, the first by chance."""
    cells = np.argwhere(free)
    chosen = [cells[rng.integers(len(cells))]]
    while len(chosen) < WAY_POINTS:
        apart = np.min([np.linalg.norm(cells - c, axis=1) for c in chosen], axis=0)
        chosen.append(cells[apart.argmax()])
    return [(int(c[0]), int(c[1])) for c in chosen]


def _drive(
    free: NDArray[np.bool_],
    points: list[Cell],
    sights: list[Floats64],
    liked: Floats64,
    even: bool,
    at: int,
    duration: float,
    rng: np.random.Generator,
) -> tuple[int, Floats64]:
    """Drive for `duration`; return the last way point and rows of (time, x, y, heading)."""
    here = points[at]
    rows = [(0.0, *_metres(here), float(rng.uniform(-np.pi, np.pi)))]
    while rows[-1][0] < duration:
        if even:
            at = (at + 1) % len(points)
        else:
            chance = np.where(np.arange(len(points)) == at, 0.0, liked)
            at = int(rng.choice(len(points), p=chance / chance.sum()))
        steps = _distances(free, points[at])
        while here != points[at]:
            here = min(_around(here, steps), key=lambda cell: steps[cell])
            _go(rows, *_metres(here))
        for k in rng.choice(HEADINGS, size=4, replace=False, p=sights[at]):
            _turn(rows, float(k) * 2 * np.pi / HEADINGS)
            rows.append((rows[-1][0] + float(rng.uniform(3.0, 10.0)), *rows[-1][1:]))
    return at, np.array(rows)


def _sights(world: World, x: float, y: float) -> Floats64:
    """Return how worth looking at each heading is, (16,): by the things that lie there at first."""
    first = [stand for stand in world.stands if stand.start_s == world.sessions[0][0]]
    offset = np.array([stand.position[:2] for stand in first]) - (x, y)
    distance = np.linalg.norm(offset, axis=1)
    bearing = np.arctan2(offset[:, 1], offset[:, 0])
    heading = np.arange(HEADINGS) * 2 * np.pi / HEADINGS
    apart = np.abs((bearing[None] - heading[:, None] + np.pi) % (2 * np.pi) - np.pi)
    count = ((apart < np.deg2rad(25)) & (distance > 0.5) & (distance < 4.5)).sum(axis=1)
    return np.asarray((count + 0.2) / (count + 0.2).sum())


def _around(cell: Cell, steps: NDArray[np.intp]) -> list[Cell]:
    i, j = cell
    beside = ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1))
    return [
        c
        for c in beside
        if 0 <= c[0] < steps.shape[0] and 0 <= c[1] < steps.shape[1] and steps[c] >= 0
    ]


def _metres(cell: Cell) -> tuple[float, float]:
    return (cell[0] + 0.5) * CELL_M, (cell[1] + 0.5) * CELL_M


def _go(rows: list[tuple[float, float, float, float]], x: float, y: float) -> None:
    time, x0, y0, yaw = rows[-1]
    ahead = float(np.arctan2(y - y0, x - x0))
    swing = 0.5 * float(np.sin(time / 5.0))  # the head looks about while driving
    turn = (ahead + swing - yaw + np.pi) % (2 * np.pi) - np.pi
    step = float(np.hypot(x - x0, y - y0)) / SPEED
    rows.append((time + max(step, abs(turn) / (2 * TURN)), x, y, yaw + 0.5 * turn))


def _turn(rows: list[tuple[float, float, float, float]], yaw: float) -> None:
    time, x, y, old = rows[-1]
    turn = (yaw - old + np.pi) % (2 * np.pi) - np.pi
    rows.append((time + abs(turn) / TURN, x, y, old + turn))
