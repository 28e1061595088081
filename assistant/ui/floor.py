"""The map as lines of text: rooms with their names, numbered places, the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from assistant.terminal import clean, shorten, width_of
from d3a.answer import RankedKeyframe
from d3a.store.base import Region, Store

Point = tuple[float, float]
_NORTH, _EAST, _SOUTH, _WEST = 1, 2, 4, 8
_LINES = " ╵╶└╷│┌├╴┘─┴┐┤┬┼"  # by the bits above
_SAME_PLACE_M = 0.5


@dataclass(frozen=True, slots=True)
class Floor:
    """What a map is drawn from: named rooms, where things have been seen, the robot; metres."""

    regions: tuple[Region, ...] = ()
    places: tuple[Point, ...] = ()
    robot: Point | None = None


@dataclass(frozen=True, slots=True)
class Mark:
    """A numbered place of an answer: the rank of its best keyframe, and where."""

    label: str
    at: Point


def read_floor(store: Store) -> Floor:
    """Return the floor of a store: rooms, the places of its stays, the newest known pose."""
    places = {
        (round(stay.position[0], 1), round(stay.position[1], 1))
        for stay in store.stays()
        if stay.position is not None
    }
    newest = store.last_view_ms()
    views = [] if newest is None else store.views(start_ms=newest)
    robot = next(((v.x, v.y) for v in reversed(views) if v.x is not None and v.y is not None), None)
    return Floor(tuple(store.regions()), tuple(sorted(places)), robot)


def marks_of(keyframes: Sequence[RankedKeyframe]) -> tuple[Mark, ...]:
    """Return a mark for each different place among the first nine keyframes."""
    marks: list[Mark] = []
    for keyframe in keyframes[:9]:
        if keyframe.position is None:
            continue
        x, y, _ = keyframe.position
        near = any(
            (x - mark.at[0]) ** 2 + (y - mark.at[1]) ** 2 < _SAME_PLACE_M**2 for mark in marks
        )
        if not near:
            marks.append(Mark(str(keyframe.rank), (x, y)))
    return tuple(marks)


class _Canvas:
    """A grid of characters over a stretch of floor; y points up, as on a map."""

    def __init__(self, bounds: tuple[float, float, float, float], columns: int, rows: int) -> None:
        x_min, y_min, x_max, y_max = bounds
        self.columns, self.rows = columns, rows
        spare_x, spare_y = max(x_max - x_min, 0.5), max(y_max - y_min, 0.5)
        # One scale for both directions, a row being twice as high as a column is wide.
        self._scale = min((columns - 1) / spare_x, (rows - 1) * 2 / spare_y)
        self._left = x_min - ((columns - 1) / self._scale - spare_x) / 2
        self._top = y_max + ((rows - 1) * 2 / self._scale - spare_y) / 2
        self._lines = [[0] * columns for _ in range(rows)]
        self._text: dict[tuple[int, int], str] = {}

    def cell(self, point: Point) -> tuple[int, int]:
        """Return the column and row of a point, kept inside."""
        column = round((point[0] - self._left) * self._scale)
        row = round((self._top - point[1]) * self._scale / 2)
        return min(max(column, 0), self.columns - 1), min(max(row, 0), self.rows - 1)

    def wall(self, start: Point, end: Point) -> None:
        """Draw a wall: across, then down, in line characters that join where walls meet."""
        (x1, y1), (x2, y2) = self.cell(start), self.cell(end)
        steps = max(abs(x2 - x1), abs(y2 - y1), 1)
        at_x, at_y = x1, y1
        for step in range(1, steps + 1):
            to_x = round(x1 + (x2 - x1) * step / steps)
            to_y = round(y1 + (y2 - y1) * step / steps)
            if to_x != at_x:
                self._join(at_x, at_y, _EAST if to_x > at_x else _WEST)
                self._join(to_x, at_y, _WEST if to_x > at_x else _EAST)
            if to_y != at_y:
                self._join(to_x, at_y, _SOUTH if to_y > at_y else _NORTH)
                self._join(to_x, to_y, _NORTH if to_y > at_y else _SOUTH)
            at_x, at_y = to_x, to_y

    def _join(self, column: int, row: int, bit: int) -> None:
        self._lines[row][column] |= bit

    def free(self, column: int, row: int, length: int) -> bool:
        """Whether `length` cells from there hold neither wall nor text."""
        inside = 0 <= row < self.rows and column >= 0 and column + length <= self.columns
        return inside and all(
            (column + i, row) not in self._text and not self._lines[row][column + i]
            for i in range(length)
        )

    def write(self, column: int, row: int, words: str) -> None:
        """Write words over whatever is there."""
        for i, char in enumerate(words):
            self._text[column + i, row] = char

    def write_near(self, point: Point, words: str) -> None:
        """Write words at a point, or beside it where something else has its cell already."""
        column, row = self.cell(point)
        tries = [(0, 0), (1, 0), (-1, 0), (0, -1), (0, 1), (2, 0), (-2, 0), (1, 1), (-1, -1)]
        for dx, dy in tries:
            if (column + dx, row + dy) not in self._text and 0 <= row + dy < self.rows:
                self.write(min(max(column + dx, 0), self.columns - 1), row + dy, words)
                return

    def lines(self, *, ascii_only: bool) -> list[str]:
        """Return the rows as text."""
        drawn = []
        for y, row in enumerate(self._lines):
            chars = [
                self._text.get((x, y)) or _line(bits, ascii_only) for x, bits in enumerate(row)
            ]
            drawn.append("".join(chars).rstrip())
        return drawn


def _line(bits: int, ascii_only: bool) -> str:
    if not ascii_only:
        return _LINES[bits]
    if bits in (0, _NORTH | _SOUTH, _NORTH, _SOUTH):
        return "|" if bits else " "
    return "-" if not bits & (_NORTH | _SOUTH) else "+"


def draw_floor(
    floor: Floor,
    marks: Sequence[Mark],
    columns: int,
    rows: int,
    *,
    robot: str = "R",
    ascii_only: bool = False,
) -> list[str]:
    """Return the map in at most columns x rows characters, [] where there is nothing to draw.

    Rooms come with walls and names; a home without rooms gets a frame and a dot for each place
    where something was seen. Marks stand over everything else.
    """
    bounds = _bounds(floor, marks)
    if bounds is None or columns < 8 or rows < 4:
        return []
    canvas = _Canvas(bounds, columns, rows)
    for polygon in [region.polygon for region in floor.regions] or [_corners(bounds)]:
        for i, corner in enumerate(polygon):
            canvas.wall(corner, polygon[(i + 1) % len(polygon)])
    for mark in marks:
        column, row = canvas.cell(mark.at)
        canvas.write(column, row, mark.label)
    if floor.robot is not None:
        canvas.write_near(floor.robot, robot)
    for region in floor.regions:
        _name_room(canvas, region)
    if not floor.regions:
        for place in floor.places:
            column, row = canvas.cell(place)
            if canvas.free(column, row, 1):
                canvas.write(column, row, "." if ascii_only else "·")
    return canvas.lines(ascii_only=ascii_only)


def is_drawable(floor: Floor, marks: Sequence[Mark]) -> bool:
    """Whether there is anything to draw, however little room there may be for it."""
    return _bounds(floor, marks) is not None


def _name_room(canvas: _Canvas, region: Region) -> None:
    """Write a room's name near its middle, on the nearest row where nothing stands in its way."""
    xs, ys = [x for x, _ in region.polygon], [y for _, y in region.polygon]
    left, top = canvas.cell((min(xs), max(ys)))
    right, bottom = canvas.cell((max(xs), min(ys)))
    name = shorten(clean(region.name), max(right - left - 1, 0))
    if width_of(name) != len(name):  # wide letters would push the wall aside
        return
    column = (left + right + 1 - len(name)) // 2
    middle = (top + bottom) // 2
    for row in sorted(range(top + 1, bottom), key=lambda row: abs(row - middle)):
        if name and canvas.free(column, row, len(name)):
            canvas.write(column, row, name)
            return


def _bounds(floor: Floor, marks: Sequence[Mark]) -> tuple[float, float, float, float] | None:
    points = [corner for region in floor.regions for corner in region.polygon]
    points += [mark.at for mark in marks]
    if not floor.regions:
        points += list(floor.places)
        points += [floor.robot] if floor.robot else []
    if not points:
        return None
    margin = 0.0 if floor.regions else 0.5
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs) - margin, min(ys) - margin, max(xs) + margin, max(ys) + margin


def _corners(bounds: tuple[float, float, float, float]) -> tuple[Point, ...]:
    x_min, y_min, x_max, y_max = bounds
    return (x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)
