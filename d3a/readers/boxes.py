"""Boxes that a detector left in a file beside the pictures: a table, or JSON lines.

What the four numbers of a box are is told by the columns' names, or asked; it is never guessed.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from d3a.model import BadInput, Box, Detection, Json
from d3a.readers import parsing
from d3a.readers.base import Skipped
from d3a.readers.tables import Row, read_table
from d3a.readers.tracks import FRAME_NAMES, PICTURE_NAMES

LAYOUTS = ("xyxy", "xywh", "cxcywh")
"""Two corners; the upper left corner and the size; the centre and the size."""
USUAL_FILES = ("detections.jsonl", "detections.csv")
BOX_NAMES: Mapping[str, tuple[str, ...]] = {
    "x1": ("xmin", "x_min", "left", "bbox_x1", "box_x1", "bbox_left", "bb_left"),
    "y1": ("ymin", "y_min", "top", "bbox_y1", "box_y1", "bbox_top", "bb_top"),
    "x2": ("xmax", "x_max", "right", "bbox_x2", "box_x2"),
    "y2": ("ymax", "y_max", "bottom", "bbox_y2", "box_y2"),
    "cx": ("x_center", "xcenter", "center_x", "x_centre", "centre_x", "xc"),
    "cy": ("y_center", "ycenter", "center_y", "y_centre", "centre_y", "yc"),
    "x": ("bbox_x", "box_x"),
    "y": ("bbox_y", "box_y"),
    "z": (),
    "width": ("w", "bbox_width", "bbox_w", "box_width", "box_w", "bb_width"),
    "height": ("h", "bbox_height", "bbox_h", "box_height", "box_h", "bb_height"),
    "box": ("bbox",),
}
DETECTION_NAMES: Mapping[str, tuple[str, ...]] = {
    "category": ("class", "class_name", "category_name", "label", "name", "object"),
    "probability": ("score", "confidence", "conf", "prob", "p"),
    **BOX_NAMES,
    **{
        f"position_{axis}": (f"pos_{axis}", f"loc_{axis}", f"map_{axis}", f"world_{axis}")
        for axis in "xyz"
    },
}
_CORNERS, _SIZE = ("x1", "y1", "x2", "y2"), ("width", "height")
_KNOWN = frozenset(
    {"frame", "image", "category", "probability", "score", "box", "bbox", "position", "covariance"}
)


def as_box(numbers: tuple[float, ...], layout: str) -> Box:
    """Return x1, y1, x2, y2 of four numbers in one of LAYOUTS."""
    a, b, c, d = numbers
    if layout == "xyxy":
        return a, b, c, d
    if layout == "xywh":
        return a, b, a + c, b + d
    return a - c / 2, b - d / 2, a + c / 2, b + d / 2


def ask_for_layout(what: str) -> BadInput:
    """Return the error for boxes that do not say what their numbers are."""
    return BadInput(
        f"{what} does not say what the four numbers of a box are: give --reader box=xyxy (two "
        "corners), box=xywh (upper left corner and size) or box=cxcywh (centre and size)"
    )


@dataclass(frozen=True, slots=True)
class DetectionColumns:
    """How a table's rows become detections.

    columns: the four of a box, or its one. layout: what they are. position: three columns or ().
    """

    columns: tuple[str, ...]
    layout: str
    position: tuple[str, ...]

    @classmethod
    def of(cls, found: frozenset[str], said: str | None, file: str) -> DetectionColumns:
        """Return the columns of a table; BadInput where some lack, or a box may be two things.

        said: one of LAYOUTS where the person told it.
        """
        lacking = {"category", "probability"} - found
        if lacking:
            raise BadInput(f"{file} lacks the columns {', '.join(sorted(lacking))}")
        position = tuple(f"position_{axis}" for axis in "xyz")
        if not found.issuperset(position):
            is_place = found >= {"x", "y", "z"}  # a box in a picture has no z
            position = ("x", "y", "z") if is_place else ()
        columns, layout = _layout(found, said, file)
        return cls(columns, layout, position if set(position).isdisjoint(columns) else ())

    def detection(self, row: Row, number: int, skipped: Skipped, where: str) -> Detection:
        """Return a row's detection; BadInput where it is broken."""
        if self.columns == ("box",):
            numbers = parsing.numbers(_array(row.get("box")), 4, "the box")
        else:
            numbers = tuple(parsing.number(row.get(name), name) for name in self.columns)
        position = None
        if any(name in row for name in self.position):
            x, y, z = (parsing.number(row.get(name), name) for name in self.position)
            position = (x, y, z)
        return Detection(
            category=parsing.category_of(row.get("category"), skipped, where),
            probability=parsing.number(row.get("probability"), "probability"),
            box=as_box(numbers, self.layout),
            position=position,
            row=number,
        )


def _layout(found: frozenset[str], said: str | None, file: str) -> tuple[tuple[str, ...], str]:
    if found.issuperset(_CORNERS):
        return _CORNERS, "xyxy"
    if found.issuperset((*_CORNERS[:2], *_SIZE)):
        return (*_CORNERS[:2], *_SIZE), "xywh"
    if found.issuperset(("cx", "cy", *_SIZE)):
        return ("cx", "cy", *_SIZE), "cxcywh"
    if found.issuperset(("x", "y", *_SIZE)):
        if said not in ("xywh", "cxcywh"):
            raise ask_for_layout(f"{file} (x, y, width, height)")
        return ("x", "y", *_SIZE), said
    if "box" in found:
        if said is None:
            raise ask_for_layout(file)
        return ("box",), said
    raise BadInput(f"{file} lacks the columns of a box: x1, y1, x2, y2 would do")


def _array(text: str | None) -> Any:
    try:
        return json.loads(text or "")
    except ValueError as error:
        raise BadInput(f"the box {parsing.clean_text(text or '')!r} is no list") from error


class FrameNames:
    """Finds a frame by what a table calls it.

    That is its own name, its picture's path with or without the ending, or, where only one frame
    has it, the last part of the path or its number without leading zeros.
    """

    def __init__(self, pictures: Mapping[str, str]) -> None:
        """pictures: frame -> path of its picture, as the recording writes it; may be empty."""
        self._sure: dict[str, str] = {}
        self._short: dict[str, str | None] = {}
        for frame, picture in pictures.items():
            path = Path(picture)
            for name in (frame, path.as_posix(), path.with_suffix("").as_posix() or frame):
                self._sure.setdefault(name, frame)
            short = {path.name, path.stem, _number(path.stem), _number(frame)}
            for word in short - {None}:
                known = self._short.setdefault(str(word), frame)
                if known != frame:
                    self._short[str(word)] = None

    def find(self, said: str) -> str:
        """Return the frame's name; what was said where there is no such frame, or two."""
        found = self._sure.get(said) or self._short.get(said)
        if found is None:
            path = Path(said)
            found = self._short.get(path.name) or self._short.get(_number(path.stem) or path.stem)
        return found or said


def _number(stem: str) -> str | None:
    return str(int(stem)) if stem.isascii() and stem.isdigit() and len(stem) < 20 else None


def read_boxes(
    path: Path, frames: FrameNames, layout: str | None, skipped: Skipped
) -> parsing.Rows:
    """Return the boxes of a `.csv` table or of JSON lines, by frame; broken rows are counted.

    JSON lines are those of a recording folder, whose `box` is two corners; one called `bbox` may be
    anything, and needs the layout.
    """
    if path.suffix.lower() == ".csv":
        return _from_table(path, frames, layout, skipped)
    rows = parsing.Rows()
    for number, record in parsing.json_lines(path, skipped):
        where = f"{path.name}:{number + 1}"
        parsing.warn_unknown(record, _KNOWN, path.name, skipped)
        if layout is None and "box" not in record and "bbox" in record:
            raise ask_for_layout(f"{path.name} (bbox)")
        try:
            frame = parsing.frame_name(record.get("frame", record.get("image")))
            rows.add(frames.find(frame), _from_record(record, number, layout, skipped, where))
        except BadInput as error:
            skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
    return rows


def _from_record(
    record: Json, number: int, layout: str | None, skipped: Skipped, where: str
) -> Detection:
    numbers = parsing.numbers(record.get("box", record.get("bbox")), 4, "the box")
    position = record.get("position")
    if position is not None:
        x, y, z = parsing.numbers(position, 3, "the position")
        position = (x, y, z)
    return Detection(
        category=parsing.category_of(record.get("category"), skipped, where),
        probability=parsing.number(record.get("probability", record.get("score")), "probability"),
        box=as_box(numbers, layout or "xyxy"),
        position=position,
        covariance=parsing.spread_of(record.get("covariance"), skipped, where),
        row=number,
    )


def _from_table(
    path: Path, frames: FrameNames, layout: str | None, skipped: Skipped
) -> parsing.Rows:
    aliases = {"frame": FRAME_NAMES, "picture": PICTURE_NAMES, **DETECTION_NAMES}
    table = read_table(path, aliases, (), skipped)
    if not table.columns & {"frame", "picture"}:
        raise BadInput(f"{path.name} lacks a column that names the frame or its picture")
    columns = DetectionColumns.of(table.columns, layout, path.name)
    rows = parsing.Rows()
    for count, (number, row) in enumerate(table.rows):
        where = f"{path.name}:{number}"
        try:
            frame = parsing.frame_name(row.get("frame") or row.get("picture"))
            rows.add(frames.find(frame), columns.detection(row, count, skipped, where))
        except BadInput as error:
            skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
    return rows
