"""A table with a detection a row: a `.csv` file, or a folder with `detections.csv`.

A row has a time, a category, a probability and a box; it may have the frame's name, its picture and
depth, the camera's pose, and the thing's position. Columns go by their usual other names. A row
without a category is a frame in which nothing was found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from d3a.model import BadInput, Frame, Pose
from d3a.readers import beside, boxes, parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.beside import Beside
from d3a.readers.clock import Clock
from d3a.readers.options import CAMERA, POSES, TIMES, Options
from d3a.readers.tables import Row, Table, read_table
from d3a.readers.tracks import (
    BROKEN_POSE,
    FRAME_NAMES,
    PICTURE_NAMES,
    POSE_FIELDS,
    TIME_NAMES,
    pose_of,
    read_times,
)

TABLE = "detections.csv"
SUFFIXES = (".csv", ".tsv")
OPTIONS = {
    **TIMES,
    **POSES,
    **CAMERA,
    "box": "xywh or cxcywh where columns x, y, width, height may be either; xyxy too for one box",
    "depth-scale": "counts a metre in the depth pictures (1000: millimetres)",
}
ALIASES = {
    "frame": FRAME_NAMES,
    "time": TIME_NAMES,
    "picture": PICTURE_NAMES,
    "depth": ("depth_file", "depth_image", "depth_path"),
    **boxes.DETECTION_NAMES,
    **{f"pose_{axis}": (f"t{axis}", f"camera_{axis}", f"robot_{axis}") for axis in "xyz"},
    **{f"pose_{turn}": (turn, f"camera_{turn}", f"robot_{turn}") for turn in POSE_FIELDS[3:]},
}


def table_of(path: Path) -> Path:
    """Return the table of a source, which may be the table itself."""
    return path / TABLE if path.is_dir() else path


def looks_like(path: Path) -> bool:
    """Say whether it is such a file, or a folder whose table has times and categories."""
    if path.is_file():
        return path.suffix.lower() in SUFFIXES
    try:
        found = read_table(path / TABLE, ALIASES, (), Skipped()).columns
    except BadInput:
        return False
    return found >= {"time", "category"}


@dataclass(slots=True)
class Gathered:
    """What the rows say of a frame: the first of them that says it."""

    time_ms: int
    row: Row
    where: str


class CsvReader:
    """Frames of a table of detections, by their times."""

    looked_for = f"a .csv file or {TABLE} with a time and a detection a row"

    def __init__(self, source: Path, options: Options) -> None:
        self._path = table_of(source)
        self._folder = options.folder
        self._options = options
        self._times_file = options.file("times")
        self._said = options.choice("box", boxes.LAYOUTS)
        self._scale = options.positive("depth-scale", 1000.0)
        self._beside = replace(Beside.of(options), detections=None)  # the table has them
        self.skipped = Skipped()
        clock = options.clock()
        self._frames, _ = self._gathered(clock, self.skipped)
        self.facts = RecordingFacts(
            name=options.usual_name,
            zone=options.zone,
            frames=len(self._frames),
            notes=beside.undated((), is_undated=clock.is_undated),
        )

    def _gathered(self, clock: Clock, skipped: Skipped) -> tuple[dict[str, Gathered], parsing.Rows]:
        """Return the frames by time, and their detections; broken rows are counted."""
        table = read_table(self._path, ALIASES, (), skipped)
        times = {}
        if self._times_file is not None:
            times = read_times(self._times_file, clock, skipped)
        elif "time" not in table.columns:
            raise BadInput(
                f"{self._path.name} has no column for the time: ISO 8601, or a count since 1970; "
                "or give --reader times=FILE"
            )
        columns = boxes.DetectionColumns.of(table.columns, self._said, self._path.name)
        frames: dict[str, Gathered] = {}
        rows = parsing.Rows()
        for count, (where, name, row) in enumerate(self._named(table, skipped)):
            try:
                known = frames.get(name)
                if known is None:
                    known = Gathered(_time(row, name, times, clock), dict(row), where)
                    frames[name] = known
                known.row = row | known.row
                if "category" in row:
                    rows.add(name, columns.detection(row, count, skipped, where))
            except BadInput as error:
                skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
        by_time = sorted(frames.items(), key=lambda each: (each[1].time_ms, each[0]))
        return dict(by_time), rows

    def _named(self, table: Table, skipped: Skipped) -> Iterator[tuple[str, str, Row]]:
        """Yield (where, frame's name, row); a frame without a name goes by its picture or time."""
        for number, row in table.rows:
            where = f"{self._path.name}:{number}"
            try:
                picture = row.get("picture")
                name = row.get("frame") or (beside.frame_of(picture) if picture else None)
                yield where, parsing.frame_name(name or row.get("time")), row
            except BadInput as error:
                skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each time in the table."""
        self.skipped = Skipped()
        frames, rows = self._gathered(self._options.clock(), self.skipped)
        there = self._pictures()
        paths = {name: each.row.get("picture", "") or name for name, each in frames.items()}
        posed, _ = self._beside.read(self._options, paths, self.skipped)
        for name, gathered in frames.items():
            try:
                picture = self._file(gathered.row.get("picture") or there.get(name))
                yield Frame(
                    name=name,
                    time_ms=gathered.time_ms,
                    pose=self._pose(gathered) or posed.pose(name, gathered.time_ms),
                    camera=self._beside.camera(picture),
                    image=picture,
                    depth=self._file(gathered.row.get("depth")),
                    detections=rows.take(name),
                    depth_scale=self._scale,
                )
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"{gathered.where} ({error})")

    def _pictures(self) -> dict[str, str]:
        """Return the pictures beside the table by the name of a frame, where it names none."""
        folder = beside.picture_folder(self._folder)
        if folder is None:
            return {}
        below = folder.relative_to(self._folder)
        return {
            beside.frame_of(picture): (below / picture).as_posix()
            for picture in beside.pictures_below(folder)
        }

    def _file(self, name: str | None) -> Path | None:
        return parsing.picture(self._folder, name, self.skipped)

    def _pose(self, gathered: Gathered) -> Pose | None:
        if not any(f"pose_{name}" in gathered.row for name in POSE_FIELDS):
            return None
        try:
            return pose_of(gathered.row, "pose_")
        except BadInput as error:
            self.skipped.add(BROKEN_POSE, f"{gathered.where} ({error})")
            return None

    def streams(self) -> Sequence[Stream]:
        """Return the table with its times, and the poses where they lie beside."""
        times = [each.time_ms for each in self._frames.values()]
        found = [Stream.of(self._path.name, "detections", times)]
        return [*found, *self._beside.streams(self._options)]

    def links(self) -> Sequence[Link]:
        """Return nothing: the format has no tf tree."""
        return ()


def _time(row: Row, name: str, times: dict[str, int], clock: Clock) -> int:
    for said in (name, row.get("picture", name)):
        if said in times:
            return times[said]
    if "time" not in row:
        raise BadInput("no time")
    return clock.ms(row["time"])
