"""The map as lines of text: rooms with their names, numbered places, the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from assistant.lately import lately
from assistant.terminal import clean, shorten, width_of
from d3a.answer import RankedKeyframe
from d3a.store.base import Region, Store

Point = tuple[float, float]
_NORTH, _EAST, _SOUTH, _WEST = 1, 2, 4, 8
_LINES = " ╵╶└╷│┌├╴┘─┴┐┤┬┼"  # by the bits above
_SAME_PLACE_M = 0.5
_LEAST_OF_A_NAME = 4


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
    """Return the floor of a store: rooms, places where it saw things, the newest known pose.

    Of a large store the places are those of lately.
    """
    stays = sorted({sighting.stay for sighting in lately(store)})
    places = {
        (round(stay.position[0], 1), round(stay.position[1], 1))
        for stay in store.stays_at(stays)
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

    def __init__(
        self,
        bounds: tuple[float, float, float, float],
        columns: int,
        rows: int,
        *,
        to_scale: bool = True,
    ) -> None:
        x_min, y_min, x_max, y_max = bounds
        self.columns, self.rows = columns, rows
        spare_x, spare_y = max(x_max - x_min, 0.5), max(y_max - y_min, 0.5)
        self._across, self._down = (columns - 1) / spare_x, (rows - 1) / spare_y
        if to_scale:  # a row is twice as high as a column is wide
            self._across = min(self._across, self._down * 2)
            self._down = self._across / 2
        self._left = x_min - ((columns - 1) / self._across - spare_x) / 2
        self._top = y_max + ((rows - 1) / self._down - spare_y) / 2
        self._lines = [[0] * columns for _ in range(rows)]
        self._text: dict[tuple[int, int], str] = {}
        self._beside: set[tuple[int, int]] = set()  # the cells next to names

    def cell(self, point: Point) -> tuple[int, int]:
        """Return the column and row of a point, kept inside."""
        column = round((point[0] - self._left) * self._across)
        row = round((self._top - point[1]) * self._down)
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
        """Write a sign at a point, or in the nearest cell of its room that has none yet.

        Next to a name it stands only where nothing else is left.
        """
        home = self.cell(point)
        free: list[tuple[int, int]] = []
        for walls in (False, True):
            free += [at for at in self._reach(home, walls=walls) if at not in self._text]
            apart = next((at for at in free if at not in self._beside), None)
            if apart is not None:
                self.write(*apart, words)
                return
        if free:
            self.write(*free[0], words)

    def write_inside(self, point: Point, words: str, *, gap: int) -> bool:
        """Write words on free cells of the room around a point, near it; False without room.

        gap: cells to leave to the next number or name.
        """
        home = self.cell(point)
        room = set(self._reach(home))
        starts = [at for at in room if self._takes(room, *at, len(words), gap)]
        if not starts:
            return False
        middle = home[0] - len(words) // 2
        column, row = min(
            starts, key=lambda at: (2 * abs(at[1] - home[1]) + abs(at[0] - middle), at)
        )
        self.write(column, row, words)
        self._beside |= {(column - 1, row), (column + len(words), row)}
        return True

    def _takes(
        self, room: set[tuple[int, int]], column: int, row: int, length: int, gap: int
    ) -> bool:
        around = range(column - gap, column + length + gap)
        return (
            all((column + i, row) in room for i in range(length))
            and self.free(column, row, length)
            and not any((x, row) in self._text for x in around)
        )

    def _reach(self, start: tuple[int, int], *, walls: bool = False) -> list[tuple[int, int]]:
        """Return the cells from `start` outwards, as far as no wall stands; walls: through them."""
        found, known, i = [start], {start}, 0
        while i < len(found):
            column, row = found[i]
            i += 1
            for to in ((column + 1, row), (column - 1, row), (column, row - 1), (column, row + 1)):
                inside = 0 <= to[0] < self.columns and 0 <= to[1] < self.rows
                if inside and to not in known and (walls or not self._lines[to[1]][to[0]]):
                    known.add(to)
                    found.append(to)
        return found

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
    signs = [*marks, *([Mark(robot, floor.robot)] if floor.robot is not None else [])]
    canvas, missing = _Canvas(bounds, columns, rows), 0
    # where a name is cut short: letters need the width; then a sign may stand a cell off its place
    for to_scale, names_first in ((True, False), (False, False), (False, True)):
        drawn = _Canvas(bounds, columns, rows, to_scale=to_scale)
        letters = _fill(drawn, bounds, floor.regions, signs, names_first=names_first)
        if to_scale or letters < missing:
            canvas, missing = drawn, letters
        if not missing:
            break
    if not floor.regions:
        for place in floor.places:
            column, row = canvas.cell(place)
            if canvas.free(column, row, 1):
                canvas.write(column, row, "." if ascii_only else "·")
    return canvas.lines(ascii_only=ascii_only)


def _fill(
    canvas: _Canvas,
    bounds: tuple[float, float, float, float],
    regions: Sequence[Region],
    signs: Sequence[Mark],
    *,
    names_first: bool,
) -> int:
    """Draw walls, numbers, the robot and names; return how many letters of names are missing."""
    walled = [region for region in regions if _has_walls(canvas, region, regions)]
    for polygon in [region.polygon for region in walled] if regions else [_corners(bounds)]:
        for i, corner in enumerate(polygon):
            canvas.wall(corner, polygon[(i + 1) % len(polygon)])
    rooms = [*walled, *(region for region in regions if region not in walled)]
    missing = sum(_name_room(canvas, room) for room in rooms) if names_first else 0
    for sign in signs:
        canvas.write_near(sign.at, sign.label)
    return missing if names_first else sum(_name_room(canvas, room) for room in rooms)


def is_drawable(floor: Floor, marks: Sequence[Mark]) -> bool:
    """Whether there is anything to draw, however little room there may be for it."""
    return _bounds(floor, marks) is not None


def _span(canvas: _Canvas, polygon: Sequence[Point]) -> tuple[int, int, int, int]:
    """Return the first and last column, the first and last row of a polygon."""
    x_min, y_min, x_max, y_max = _box_of(polygon)
    left, top = canvas.cell((x_min, y_max))
    right, bottom = canvas.cell((x_max, y_min))
    return left, right, top, bottom


def _has_walls(canvas: _Canvas, region: Region, regions: Sequence[Region]) -> bool:
    """Whether walls are drawn: a number fits between them; a spot in a room has its name there too.

    A desk on a small map has no walls, so that its name finds room around it.
    """
    left, right, top, bottom = _span(canvas, region.polygon)
    if right - left <= 3 or bottom - top <= 1:
        return False
    is_spot = any(_lies_in(region, other) for other in regions)
    return not is_spot or right - left > len(clean(region.name))


def _lies_in(region: Region, other: Region) -> bool:
    """Whether the middle of a region is in another, larger one, both taken as boxes."""
    (x, y), (x1, y1, x2, y2) = _middle(region), _box_of(other.polygon)
    a1, b1, a2, b2 = _box_of(region.polygon)
    is_larger = (x2 - x1) * (y2 - y1) > (a2 - a1) * (b2 - b1)
    return is_larger and x1 <= x <= x2 and y1 <= y <= y2


def _box_of(polygon: Sequence[Point]) -> tuple[float, float, float, float]:
    xs, ys = [x for x, _ in polygon], [y for _, y in polygon]
    return min(xs), min(ys), max(xs), max(ys)


def _middle(region: Region) -> Point:
    x_min, y_min, x_max, y_max = _box_of(region.polygon)
    return (x_min + x_max) / 2, (y_min + y_max) / 2


def _name_room(canvas: _Canvas, region: Region) -> int:
    """Write a room's name near its middle, where nothing stands in its way.

    Returns how many letters are missing.
    """
    middle, name = _middle(region), clean(region.name)
    if width_of(name) != len(name):  # wide letters would push the wall aside
        return 0
    if canvas.write_inside(middle, name, gap=1) or canvas.write_inside(middle, name, gap=0):
        return 0
    for width in range(len(name) - 1, _LEAST_OF_A_NAME - 1, -1):
        if canvas.write_inside(middle, shorten(name, width), gap=1):
            return len(name) - width
    return len(name)


def _bounds(floor: Floor, marks: Sequence[Mark]) -> tuple[float, float, float, float] | None:
    points = [corner for region in floor.regions for corner in region.polygon]
    points += [mark.at for mark in marks]
    if not floor.regions:
        points += list(floor.places)
        points += [floor.robot] if floor.robot else []
    if not points:
        return None
    margin = 0.0 if floor.regions else 0.5
    x_min, y_min, x_max, y_max = _box_of(points)
    return x_min - margin, y_min - margin, x_max + margin, y_max + margin


def _corners(bounds: tuple[float, float, float, float]) -> tuple[Point, ...]:
    x_min, y_min, x_max, y_max = bounds
    return (x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)
