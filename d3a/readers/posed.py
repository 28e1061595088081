"""Triples of colour, depth and pose, as RGB-D sequences are often given out.

`frames/frame-N.color.jpg`, `.depth.png` (16-bit millimetres), `.pose.txt` (4 x 4 camera to world,
metres); `camera-intrinsics.txt` (3 x 3); `frames.csv` (frame, seconds); optional
`detections.jsonl` (frame, category, probability, bbox).
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from d3a import images
from d3a.geometry import quaternion
from d3a.model import BadInput, Camera, Detection, Frame, Pose
from d3a.readers import parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.beside import line_count

FRAMES = "frames.csv"
INTRINSICS = "camera-intrinsics.txt"
DETECTIONS = "detections.jsonl"
EPOCH = datetime(2000, 1, 1, tzinfo=UTC)
"""Seconds below UNIX_FROM_S count from the recording's start, whose date nobody noted: they are
put at a date that nobody takes for the real one. Larger ones are seconds since 1970."""
UNIX_FROM_S = 1e8
USUAL_PROBABILITY = 0.25
"""The usual threshold of the detectors that write such files with all they have (down to 0.1)."""
POSE_SIGMA_M, POSE_SIGMA_RAD = 0.02, 0.01
"""Poses of such sequences come from dense tracking against a model: centimetres, half degrees."""
_KNOWN = frozenset({"frame", "category", "probability", "bbox", "box"})


def looks_like(folder: Path) -> bool:
    """Say whether the folder has this format's table, intrinsics and frames."""
    return (folder / FRAMES).is_file() and (folder / INTRINSICS).is_file()


class PosedReader:
    """Frames of an RGB-D sequence with camera poses, in time order."""

    looked_for = f"{FRAMES}, {INTRINSICS} and frames/frame-N.color.jpg, .depth.png, .pose.txt"

    def __init__(self, folder: Path, *, zone: str | None = None) -> None:
        self._folder = folder
        self.skipped = Skipped()
        self._table = self._read_table()
        self._camera: Camera | None = None
        self.facts = RecordingFacts(
            name=folder.resolve().name,
            zone=parsing.zone_of(zone),
            frames=len(self._table),
            min_probability=USUAL_PROBABILITY,
            notes=("seconds count from an unknown start: put at 1 January 2000",)
            if any(seconds < UNIX_FROM_S for seconds in self._seconds())
            else (),
        )

    def _seconds(self) -> Iterator[float]:
        for _, record in self._table:
            with suppress(BadInput):  # it is counted where the frames are read
                yield parsing.number(record["seconds"], "seconds")

    def streams(self) -> Sequence[Stream]:
        """Return the table of frames with its times, and the boxes where there are any."""
        start = EPOCH.timestamp()
        times = [round((s + (0 if s >= UNIX_FROM_S else start)) * 1000) for s in self._seconds()]
        found = [Stream.of(FRAMES, "frames listed", times)]
        if (self._folder / DETECTIONS).is_file():
            found.append(Stream(DETECTIONS, "detections", line_count(self._folder / DETECTIONS)))
        return found

    def links(self) -> Sequence[Link]:
        """Return nothing: poses are the camera's in the map."""
        return ()

    def _read_table(self) -> list[tuple[int, dict[str, str]]]:
        with (self._folder / FRAMES).open(encoding="utf-8", errors="replace", newline="") as lines:
            table = csv.DictReader(lines)
            missing = {"frame", "seconds", "color"} - set(table.fieldnames or ())
            if missing:
                raise BadInput(f"{FRAMES} lacks the columns {', '.join(sorted(missing))}")
            return list(enumerate(table))

    def _intrinsics(self, picture: Path) -> Camera:
        """Return the camera; its size is that of a picture, as the file does not say it."""
        try:
            matrix = np.loadtxt(self._folder / INTRINSICS)
        except (ValueError, OSError) as error:
            raise BadInput(f"{INTRINSICS} is not a 3 x 3 matrix of numbers") from error
        if matrix.shape != (3, 3):
            raise BadInput(f"{INTRINSICS} is not a 3 x 3 matrix of numbers")
        height, width = images.decode(picture).shape[:2]
        fx, fy, cx, cy = (float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
        return Camera(width, height, fx, fy, cx, cy)

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames in the table's order."""
        self.skipped = Skipped()
        rows = self._detections()
        for number, record in self._table:
            where = f"{FRAMES}:{number + 2}"
            try:
                frame = self._frame(record, rows)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"{where} ({error})")
            else:
                yield frame
        if rows is not None:
            rows.count_left(self.skipped)

    def _frame(self, record: dict[str, str], rows: parsing.Rows | None) -> Frame:
        name = parsing.frame_name(record["frame"])
        seconds = parsing.number(record["seconds"], "seconds")
        start = 0.0 if seconds >= UNIX_FROM_S else EPOCH.timestamp()
        picture = parsing.picture(self._folder, record["color"], self.skipped)
        if picture is not None and self._camera is None:
            self._camera = self._camera_of(picture)
        return Frame(
            name=name,
            time_ms=round((start + seconds) * 1000),
            pose=self._pose(record.get("pose") or None),
            camera=self._camera,
            image=picture,
            depth=parsing.picture(self._folder, record.get("depth") or None, self.skipped),
            detections=None if rows is None else rows.take(name),
        )

    def _camera_of(self, picture: Path) -> Camera | None:
        try:
            images.decode(picture)
        except BadInput:
            return None  # the ingest counts and names the broken picture; the next one may do
        return self._intrinsics(picture)

    def _pose(self, name: str | None) -> Pose | None:
        if name is None:
            return None
        try:
            path = parsing.inside(self._folder, name)
            matrix = np.empty(0) if path is None else np.loadtxt(path)
        except (BadInput, ValueError, OSError):
            matrix = np.empty(0)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            self.skipped.add("broken pose", str(name))
            return None
        x, y, z = (float(v) for v in matrix[:3, 3])
        variances = [POSE_SIGMA_M**2] * 3 + [POSE_SIGMA_RAD**2] * 3
        covariance = tuple(float(v) for v in np.diag(variances).ravel())
        return Pose((x, y, z), quaternion(matrix[:3, :3]), covariance)

    def _detections(self) -> parsing.Rows | None:
        path = self._folder / DETECTIONS
        if not path.is_file():
            return None
        rows = parsing.Rows()
        for number, record in parsing.json_lines(path, self.skipped):
            where = f"{DETECTIONS}:{number + 1}"
            parsing.warn_unknown(record, _KNOWN, DETECTIONS, self.skipped)
            try:
                detection = Detection(
                    category=parsing.category_of(record.get("category"), self.skipped, where),
                    probability=parsing.number(record.get("probability"), "probability"),
                    box=parsing.box_of(record.get("bbox", record.get("box"))),
                    row=number,
                )
                rows.add(parsing.frame_name(record.get("frame")), detection)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_DETECTION, f"{where} ({error})")
        return rows
