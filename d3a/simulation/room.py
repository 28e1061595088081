"""The furniture of a home-like lab, 8 x 12 m: a kitchen corner, tables, desks, shelves, a couch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WIDTH, LENGTH, HEIGHT = 8.0, 12.0, 2.6
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Piece:
    """A fixed thing: its solids, and the annotated category it counts as, if any.

    solids: rows x0 y0 z0 x1 y1 z1. category: None for what no detector names (a counter).
    """

    name: str
    solids: tuple[tuple[float, ...], ...]
    category: str | None = None


@dataclass(frozen=True, slots=True)
class Support:
    """A level surface that things stand on: x0 y0 x1 y1 and its height, metres."""

    name: str
    area: Rectangle
    z: float
    clearance: float = 0.65


@dataclass(frozen=True, slots=True)
class Room:
    """All that stands still: pieces, the surfaces for small things, and where chairs go."""

    pieces: tuple[Piece, ...]
    supports: tuple[Support, ...]
    seats: tuple[Rectangle, ...]


def _slab(x0: float, y0: float, x1: float, y1: float, z0: float, z1: float) -> tuple[float, ...]:
    return (x0, y0, z0, x1, y1, z1)


def _table(name: str, area: Rectangle, height: float, category: str | None) -> Piece:
    x0, y0, x1, y1 = area
    legs = tuple(
        _slab(x, y, x + 0.05, y + 0.05, 0.0, height - 0.04)
        for x in (x0 + 0.05, x1 - 0.10)
        for y in (y0 + 0.05, y1 - 0.10)
    )
    return Piece(name, (_slab(*area, height - 0.04, height), *legs), category)


def _shelf(name: str, area: Rectangle, boards: tuple[float, ...]) -> Piece:
    """Return boards between two ends, with a back at the side of x0."""
    x0, y0, x1, y1 = area
    top = boards[-1]
    back = _slab(x0, y0, x0 + 0.02, y1, 0, top)
    ends = (_slab(x0, y0, x1, y0 + 0.02, 0, top), _slab(x0, y1 - 0.02, x1, y1, 0, top))
    return Piece(name, (back, *ends, *(_slab(*area, z - 0.02, z) for z in boards)))


def furnish(rng: np.random.Generator) -> Room:
    """Return a room: the same kinds of furniture, shifted, and mirrored, by the seed."""
    shift = rng.uniform(-0.2, 0.2, size=16)
    flip = bool(rng.random() < 0.5)
    pieces = [*_kitchen(shift), *_corner(shift)]
    supports = [*_kitchen_tops(shift), *_corner_tops()]
    seats = []
    for k, (x, y) in enumerate(((2.6, 8.0), (5.4, 7.4))):
        cx, cy = x + shift[4 + 2 * k], y + shift[5 + 2 * k]
        area = (cx - 0.75, cy - 0.42, cx + 0.75, cy + 0.42)
        pieces.append(_table(f"table {k}", area, 0.75, "dining table"))
        supports.append(Support(f"table {k}", area, 0.75))
        seats.append((cx - 0.6, cy - 0.95, cx + 0.6, cy - 0.35))
        seats.append((cx - 0.6, cy + 0.35, cx + 0.6, cy + 0.95))
    for k, (x, y) in enumerate(((0.05, 4.9), (0.05, 2.6), (7.2, 4.3), (7.2, 1.6))):
        y0 = y + shift[8 + k]
        area = (x, y0, x + 0.75, y0 + 1.6)
        pieces.append(_table(f"desk {k}", area, 0.74, None))
        supports.append(Support(f"desk {k}", area, 0.74))
        front = x + 0.6 if x < WIDTH / 2 else x - 0.4
        seats.append((front, y0 + 0.2, front + 0.5, y0 + 1.4))
    room = Room(tuple(pieces), tuple(supports), tuple(seats))
    return _mirrored(room) if flip else room


def _corner(shift: NDArray[np.float64]) -> tuple[Piece, ...]:
    """Return what divides the room, and the corner with couch and books."""
    x, y = 4.0 + shift[12], 4.2 + shift[13]
    seat, back = _slab(2.2, 0.5, 4.2, 1.3, 0.0, 0.42), _slab(2.2, 0.25, 4.2, 0.5, 0.0, 0.82)
    return (
        Piece("partition", (_slab(x - 0.06, y - 0.9, x + 0.06, y + 0.9, 0, 1.5),)),
        Piece("pillar", (_slab(3.0, 5.6, 3.3, 5.9, 0, HEIGHT),)),
        _shelf("bookcase", (0.02, 0.5, 0.35, 2.0), (0.45, 0.85, 1.25)),
        Piece("couch", (seat, back), "couch"),
        _table("low table", (2.6, 1.75, 3.8, 2.25), 0.42, None),
    )


def _corner_tops() -> tuple[Support, ...]:
    boards = tuple(Support("bookcase", (0.05, 0.55, 0.33, 1.95), z, 0.36) for z in (0.45, 0.85))
    couch = Support("couch", (2.3, 0.6, 4.1, 1.2), 0.42)
    return (*boards, couch, Support("low table", (2.6, 1.75, 3.8, 2.25), 0.42))


def _kitchen(shift: NDArray[np.float64]) -> tuple[Piece, ...]:
    y = 11.3
    sink, oven = 2.2 + shift[0], 4.3 + shift[1]
    return (
        Piece("counter", (_slab(0.2, y, 5.6, 11.95, 0, 0.9),)),
        Piece("wall cupboard", (_slab(0.2, 11.6, 3.8, 11.95, 1.5, 2.2),)),
        Piece("refrigerator", (_slab(6.1, 11.2, 6.9, 11.95, 0, 1.75),), "refrigerator"),
        Piece("sink", (_slab(sink, 11.4, sink + 0.6, 11.85, 0.88, 0.95),), "sink"),
        Piece("microwave", (_slab(oven, 11.5, oven + 0.5, 11.9, 0.9, 1.2),), "microwave"),
        _table("island", (1.6 + shift[2], 9.6, 3.4 + shift[2], 10.2), 0.95, None),
    )


def _kitchen_tops(shift: NDArray[np.float64]) -> tuple[Support, ...]:
    left = 1.6 + shift[2]
    return (
        Support("counter", (0.3, 11.35, 2.1 + shift[0], 11.85), 0.9),
        Support("counter", (2.9 + shift[0], 11.35, 4.2 + shift[1], 11.85), 0.9),
        Support("counter", (4.9 + shift[1], 11.35, 5.55, 11.85), 0.9),
        Support("island", (left, 9.6, left + 1.8, 10.2), 0.95),
    )


def _mirrored(room: Room) -> Room:
    """Return the room as in a mirror: x runs the other way."""

    def solid(row: tuple[float, ...]) -> tuple[float, ...]:
        return (WIDTH - row[3], row[1], row[2], WIDTH - row[0], row[4], row[5])

    def area(a: Rectangle) -> Rectangle:
        return (WIDTH - a[2], a[1], WIDTH - a[0], a[3])

    return Room(
        tuple(Piece(p.name, tuple(map(solid, p.solids)), p.category) for p in room.pieces),
        tuple(Support(s.name, area(s.area), s.z, s.clearance) for s in room.supports),
        tuple(map(area, room.seats)),
    )


def walls() -> tuple[tuple[float, ...], ...]:
    """Return floor, ceiling and the four walls, for depth alone."""
    w, n, h = WIDTH, LENGTH, HEIGHT
    return (
        _slab(-1, -1, w + 1, n + 1, -0.1, 0.0),
        _slab(-1, -1, w + 1, n + 1, h, h + 0.1),
        _slab(-0.1, -1, 0.0, n + 1, 0, h),
        _slab(w, -1, w + 0.1, n + 1, 0, h),
        _slab(-1, -0.1, w + 1, 0.0, 0, h),
        _slab(-1, n, w + 1, n + 0.1, 0, h),
    )
