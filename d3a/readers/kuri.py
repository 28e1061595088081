"""The sample that the paper's authors released: pictures and a table of detections.

`detections.csv` has a row per detection with its frame's number and time; `images/N.jpg` is the
picture of frame N. Columns of the annotators (gt_*) are never read.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from d3a.model import BadInput, Detection, Frame
from d3a.readers import parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream

TABLE = "detections.csv"
PICTURES = "images"
COLUMNS = frozenset(
    {"frame", "timestamp", "category", "probability", "x1", "y1", "x2", "y2"}
    | {"loc_x", "loc_y", "loc_z"}
)
KNOWN_ZONE = "America/New_York"
"""Brown University, where it was recorded; the times themselves carry the offset -05:00."""
LOCATION_SIGMA_M = 2.0
"""One location is given per frame, for things metres apart, and it lags the robot: by the sample's
own description it is 1.6 m off in the median and up to 9.7 m. Per axis, with that long tail."""


def looks_like(folder: Path) -> bool:
    """Say whether the folder has pictures and a table with this format's columns."""
    if not (folder / TABLE).is_file() or not (folder / PICTURES).is_dir():
        return False
    with (folder / TABLE).open(encoding="utf-8", errors="replace") as lines:
        return set(lines.readline().strip().split(",")) >= COLUMNS


class KuriReader:
    """Frames of the released sample, in time order."""

    looked_for = f"{TABLE} and {PICTURES}/N.jpg"

    def __init__(self, folder: Path, *, zone: str | None = None) -> None:
        self._folder = folder
        self.skipped = Skipped()
        self._rows = self._table()
        self.facts = RecordingFacts(
            name=folder.resolve().name,
            zone=parsing.zone_of(zone or KNOWN_ZONE),
            frames=len({row["frame"] for _, row in self._rows}),
        )

    def _table(self) -> list[tuple[int, dict[str, str]]]:
        with (self._folder / TABLE).open(encoding="utf-8", errors="replace", newline="") as lines:
            table = csv.DictReader(lines)
            missing = COLUMNS - set(table.fieldnames or ())
            if missing:
                raise BadInput(f"{TABLE} lacks the columns {', '.join(sorted(missing))}")
            return list(enumerate(table))

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames by time; pictures that no row gives a time are counted."""
        self.skipped = Skipped()
        times: dict[str, int] = {}
        rows = parsing.Rows()
        for number, row in self._rows:
            where = f"{TABLE}:{number + 2}"
            try:
                name = parsing.frame_name(row["frame"])
                times.setdefault(name, parsing.time_ms(row["timestamp"]))
                rows.add(name, self._detection(number, row, where))
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
        for picture in sorted((self._folder / PICTURES).iterdir()):
            if picture.suffix == ".jpg" and picture.stem not in times:
                self.skipped.add("no time: no detection names the picture", picture.name)
        for name, time_ms in sorted(times.items(), key=lambda each: (each[1], each[0])):
            picture_path = parsing.inside(self._folder / PICTURES, f"{name}.jpg")
            yield Frame(
                name=name,
                time_ms=time_ms,
                image=parsing.existing(picture_path, self.skipped, f"{name}.jpg"),
                detections=rows.take(name),
            )

    def streams(self) -> Sequence[Stream]:
        """Return the table and the folder of pictures."""
        times: list[int] = []
        for _, row in self._rows:
            with suppress(BadInput):  # it is counted where the frames are read
                times.append(parsing.time_ms(row["timestamp"]))
        pictures = sum(1 for each in (self._folder / PICTURES).iterdir() if each.suffix == ".jpg")
        return [
            Stream.of(TABLE, "detections", times),
            Stream(f"{PICTURES}/", "pictures", pictures),
        ]

    def links(self) -> Sequence[Link]:
        """Return nothing: the sample has no poses."""
        return ()

    def _detection(self, number: int, row: Mapping[str, str], where: str) -> Detection:
        box = [parsing.number(row[column], column) for column in ("x1", "y1", "x2", "y2")]
        x, y, z = (parsing.number(row[column], column) for column in ("loc_x", "loc_y", "loc_z"))
        variance = LOCATION_SIGMA_M**2
        return Detection(
            category=parsing.category_of(row["category"], self.skipped, where),
            probability=parsing.number(row["probability"], "probability"),
            box=(box[0], box[1], box[2], box[3]),
            position=(x, y, z),
            covariance=(variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance),
            row=number,
        )
