"""The plan of the home: rooms, walls with their openings, standing furniture, surfaces, the map.

The map frame has its origin at the home's south-west corner, x to the east, y to the north, z up,
metres. Rooms meet at the middle of their walls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assistant.home.meshes import box, joined
from assistant.home.model import Model, Part

WALL_HEIGHT = 2.7
WALL_THICKNESS = 0.1
CELL_M = 0.05
MAP_MARGIN_M = 0.5

Rectangle = tuple[float, float, float, float]
"""x1, y1, x2, y2 in metres."""


@dataclass(frozen=True, slots=True)
class Room:
    """A room: its name, its floor, the colours of its floor and of its walls."""

    name: str
    floor: Rectangle
    floor_colours: tuple[str, str]
    tile: tuple[float, float]
    wall_colour: str

    def polygon(self) -> list[list[float]]:
        """Return the room's corners [x, y], counter-clockwise."""
        x1, y1, x2, y2 = self.floor
        return [[x1, y1], [x2, y1], [x2, y2], [x1, y2]]

    def contains(self, x: float, y: float) -> bool:
        """Tell whether a point of the floor lies in the room."""
        x1, y1, x2, y2 = self.floor
        return x1 <= x <= x2 and y1 <= y <= y2


ROOMS = (
    Room("kitchen", (0.0, 4.0, 4.5, 8.0), ("#d5d3cd", "#c3c1bb"), (0.5, 0.5), "#eeeadd"),
    Room("living room", (4.5, 3.6, 10.0, 8.0), ("#b58a5c", "#ac8154"), (1.1, 0.2), "#dde3df"),
    Room("bedroom", (4.5, 0.0, 10.0, 3.6), ("#b7a58d", "#b2a088"), (1.1, 0.2), "#dfe1ea"),
    Room("hall", (0.0, 1.0, 4.5, 4.0), ("#9a7b5d", "#937457"), (1.1, 0.2), "#ebe4da"),
)


@dataclass(frozen=True, slots=True)
class Wall:
    """A straight wall along x or y; `gaps` are open to the top, as offsets from its start."""

    start: tuple[float, float]
    end: tuple[float, float]
    gaps: tuple[tuple[float, float], ...] = ()

    def pieces(self) -> list[Rectangle]:
        """Return the footprints of what stands between the gaps."""
        (x1, y1), (x2, y2) = self.start, self.end
        along_x = y1 == y2
        length = (x2 - x1) if along_x else (y2 - y1)
        half = WALL_THICKNESS / 2
        cuts = [-half, *(offset for gap in self.gaps for offset in gap), length + half]
        spans = zip(cuts[::2], cuts[1::2], strict=True)
        if along_x:
            return [(x1 + a, y1 - half, x1 + b, y1 + half) for a, b in spans]
        return [(x1 - half, y1 + a, x1 + half, y1 + b) for a, b in spans]


WALLS = (
    Wall((0.0, 8.0), (10.0, 8.0)),
    Wall((0.0, 1.0), (0.0, 8.0)),
    Wall((10.0, 0.0), (10.0, 8.0)),
    Wall((4.5, 0.0), (10.0, 0.0)),
    Wall((0.0, 1.0), (4.5, 1.0)),
    Wall((0.0, 4.0), (4.5, 4.0), ((0.9, 1.8),)),
    Wall((4.5, 0.0), (4.5, 8.0), ((2.2, 3.1), (4.6, 5.6))),
    Wall((4.5, 3.6), (10.0, 3.6)),
)


@dataclass(frozen=True, slots=True)
class Surface:
    """What things are put on: its name, and the point that places on it are counted from."""

    name: str
    x: float
    y: float
    z: float


SURFACES = {
    surface.name: surface
    for surface in (
        Surface("kitchen table", 2.2, 5.6, 0.74),
        Surface("kitchen counter", 0.0, 7.5, 0.9),
        Surface("kitchen floor", 0.0, 0.0, 0.0),
        Surface("hall shelf", 2.2, 1.22, 0.82),
        Surface("hall bench", 3.2, 3.74, 0.45),
        Surface("hall floor", 0.0, 0.0, 0.0),
        Surface("coffee table", 7.4, 6.2, 0.42),
        Surface("couch", 7.4, 7.45, 0.48),
        Surface("tv stand", 7.4, 3.86, 0.5),
        Surface("living room floor", 0.0, 0.0, 0.0),
        Surface("living room wall", 0.0, 0.0, 0.0),
        Surface("nightstand", 6.9, 0.27, 0.55),
        Surface("bed", 8.0, 1.1, 0.58),
        Surface("desk", 4.85, 1.0, 0.74),
        Surface("bedroom floor", 0.0, 0.0, 0.0),
        Surface("kitchen wall", 0.0, 0.0, 0.0),
    )
}


def room_at(x: float, y: float) -> str:
    """Return the name of the room at a point of the floor; ValueError outside of the home."""
    for room in ROOMS:
        if room.contains(x, y):
            return room.name
    raise ValueError(f"({x}, {y}) lies in no room")


def building(*, daylight: bool) -> Model:
    """Return floors, walls, skirting, windows, the front door, pictures, rugs and coats."""
    parts: list[Part] = []
    for room in ROOMS:
        parts += _floor(room)
        parts += _linings(room)
    blocks = [
        box(x2 - x1, y2 - y1, WALL_HEIGHT).moved((x1 + x2) / 2, (y1 + y2) / 2)
        for wall in WALLS
        for x1, y1, x2, y2 in wall.pieces()
    ]
    parts.append(Part(joined(blocks), "#f1efe9"))
    return (*parts, *_windows("#cfe6f7" if daylight else "#18233d"), *_dressing())


def _floor(room: Room) -> list[Part]:
    """Lay tiles, or boards that are shifted by half their length from row to row."""
    x1, y1, x2, y2 = room.floor
    width, depth = room.tile
    shift = 0.0 if width == depth else width / 2
    laid: tuple[list[Part], list[Part]] = ([], [])
    for row in range(int(np.ceil((y2 - y1) / depth))):
        for column in range(-1, int(np.ceil((x2 - x1) / width)) + 1):
            left = x1 + column * width + shift * (row % 2)
            a, b = max(left, x1), min(left + width, x2)
            low, high = y1 + row * depth, min(y1 + (row + 1) * depth, y2)
            if b - a < 1e-6:
                continue
            board = box(b - a, high - low, 0.02).moved((a + b) / 2, (low + high) / 2, -0.02)
            which = (row + column) % 2 if shift == 0 else (row * 3 + column * 5) % 2
            laid[which].append(Part(board, room.floor_colours[which]))
    return [Part(joined(part.mesh for part in parts), parts[0].colour) for parts in laid if parts]


def _linings(room: Room) -> list[Part]:
    """Return the room's wallpaper, in front of each piece of wall along its edge, and skirting."""
    x1, y1, x2, y2 = room.floor
    half = WALL_THICKNESS / 2
    paper, skirting = [], []
    for wall in WALLS:
        along_x = wall.start[1] == wall.end[1]
        for a, b, c, d in wall.pieces():
            if along_x and wall.start[1] in (y1, y2):
                left, right = max(a, x1), min(c, x2)
                y = wall.start[1] + (half if wall.start[1] == y1 else -half)
                size, at = (right - left, 0.006), ((left + right) / 2, y)
            elif not along_x and wall.start[0] in (x1, x2):
                low, high = max(b, y1), min(d, y2)
                x = wall.start[0] + (half if wall.start[0] == x1 else -half)
                size, at = (0.006, high - low), (x, (low + high) / 2)
            else:
                continue
            if max(size) > 0.05:
                paper.append(box(*size, WALL_HEIGHT).moved(*at))
                skirting.append(box(size[0] + 0.01, size[1] + 0.01, 0.09).moved(*at))
    return [Part(joined(paper), room.wall_colour), Part(joined(skirting), "#faf9f5")]


def _pane(along_x: bool, at: tuple[float, float], size: tuple[float, float], z: float) -> Model:
    """Return a window or a picture without its pane's colour: frame first, then the pane."""
    width, height = size
    frame = box(width + 0.12, 0.03, height + 0.12).moved(z=z - 0.06)
    pane = box(width, 0.04, height).moved(z=z)
    turn = 0.0 if along_x else 90.0
    return (
        Part(frame.turned(z=turn).moved(*at), "#fbfbf8"),
        Part(pane.turned(z=turn).moved(*at), "#ffffff"),
    )


def _windows(sky: str) -> Model:
    """Return the windows: two panes each, in the outer walls."""
    parts: list[Part] = []
    for along_x, x, y, width in (
        (False, 0.06, 5.9, 1.0),
        (False, 9.94, 6.0, 1.5),
        (False, 9.94, 1.4, 1.3),
        (True, 5.75, 0.06, 0.9),
    ):
        frame, pane = _pane(along_x, (x, y), (width, 1.05), 1.05)
        bar = box(0.05, 0.05, 1.05).moved(z=1.05).turned(z=0 if along_x else 90).moved(x, y)
        parts += [frame, Part(pane.mesh, sky), Part(bar, "#fbfbf8")]
    return tuple(parts)


def _dressing() -> Model:
    """Return what no detector knows: pictures on the walls, rugs, the front door, a coat rail."""
    parts: list[Part] = []
    for along_x, x, y, colours in (
        (True, 7.0, 7.93, ("#e8b04a", "#2f6a78")),
        (True, 8.1, 7.93, ("#d8d2c4", "#b8563c")),
        (True, 2.2, 1.07, ("#d9e2d0", "#5f7f5a")),
        (False, 4.57, 1.0, ("#e6d8e8", "#7a6a9c")),
    ):
        frame, pane = _pane(along_x, (x, y), (0.55, 0.45), 1.42)
        patch = box(0.3, 0.05, 0.2).moved(z=1.5).turned(z=0 if along_x else 90).moved(x, y)
        dark_frame = Part(frame.mesh, "#4d3a2a")
        parts += [dark_frame, Part(pane.mesh, colours[0]), Part(patch, colours[1])]
    parts.append(Part(box(2.6, 1.8, 0.012).moved(7.4, 6.1), "#55708c"))
    parts.append(Part(box(2.4, 1.6, 0.014).moved(7.4, 6.1), "#b9c4cc"))
    parts.append(Part(box(1.5, 0.7, 0.012).moved(2.2, 2.0), "#7f3b35"))
    parts.append(Part(box(0.04, 0.9, 2.05).moved(0.06, 2.45), "#3f5f4c"))
    parts.append(Part(box(0.05, 0.06, 0.02).moved(0.1, 2.75, 1.0), "#d9b24a", shiny=True))
    parts.append(Part(box(0.9, 0.03, 0.07).moved(3.3, 3.93, 1.55), "#8a6a44"))
    for x, colour in ((3.0, "#47525e"), (3.3, "#8b5a4a"), (3.6, "#59705a")):
        coat = box(0.2, 0.1, 0.62).moved(x, 3.88, 0.92)
        parts.append(Part(coat, colour))
    return tuple(parts)


def occupancy(footprints: list[Rectangle]) -> NDArray[np.uint8]:
    """Return the map's picture: 0 where walls or `footprints` are, 254 free floor, 205 unknown.

    Row 0 is the north edge, as map_server wants it; a cell has CELL_M, and the lower left corner
    of the picture lies MAP_MARGIN_M outside of the home's.
    """
    columns = round((10.0 + 2 * MAP_MARGIN_M) / CELL_M)
    rows = round((8.0 + 2 * MAP_MARGIN_M) / CELL_M)
    cells = np.full((rows, columns), 205, dtype=np.uint8)
    walls = [piece for wall in WALLS for piece in wall.pieces()]
    for value, rectangles in ((254, [room.floor for room in ROOMS]), (0, walls + footprints)):
        for x1, y1, x2, y2 in rectangles:
            left, right = (round((x + MAP_MARGIN_M) / CELL_M) for x in (x1, x2))
            low, high = (round((y + MAP_MARGIN_M) / CELL_M) for y in (y1, y2))
            cells[low : max(high, low + 1), left : max(right, left + 1)] = value
    return cells[::-1]
