"""Folders of the TUM RGB-D benchmark's form, and of the tools that write it.

`rgb.txt` and `depth.txt` (time, path), `groundtruth.txt` (time tx ty tz qx qy qz qw: the colour
camera's optical centre). The streams are not synchronous: a picture gets the depth and the pose
nearest to it in time.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from d3a.model import BadInput, Frame, Pose
from d3a.readers import boxes, parsing
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.cameras import Intrinsics, Lens
from d3a.readers.options import CAMERA, DETECTIONS, POSES, TIMES, Options
from d3a.readers.tables import read_table
from d3a.readers.tracks import BROKEN_TIME, Track, read_track

COLOUR, DEPTH, POSE_FILE = "rgb.txt", "depth.txt", "groundtruth.txt"
DEPTH_SCALE = 5000.0
GAP_S = 0.02
"""Of depth and of poses to their picture: what the benchmark's own tool takes."""
CALIBRATED: dict[str, Intrinsics] = {
    "freiburg1": (517.3, 516.5, 318.6, 255.3),
    "freiburg2": (520.9, 521.0, 325.1, 249.7),
    "freiburg3": (535.4, 539.2, 320.1, 247.6),
}
"""The benchmark's three cameras, by a part of its folders' names."""
OPTIONS = {
    **POSES,
    **CAMERA,
    **DETECTIONS,
    "depth-scale": "counts a metre in the depth pictures (5000; other tools write 1000)",
    "depth-gap": "SECONDS to the nearest depth picture that still counts (0.02)",
    "start": TIMES["start"],
}
NO_DEPTH = "no depth picture near in time"
NO_POSE = "no pose near in time"


def looks_like(path: Path) -> bool:
    """Say whether the folder has the list of colour pictures, and one of depth or of poses."""
    return (path / COLOUR).is_file() and any((path / n).is_file() for n in (DEPTH, POSE_FILE))


@dataclass(frozen=True, slots=True)
class Listed:
    """A line of a list: when, and which file below the folder."""

    time_ms: int
    name: str
    where: str


class TumReader:
    """Frames of a TUM RGB-D folder, in the order of its list of colour pictures."""

    looked_for = f"{COLOUR} with {DEPTH} or {POSE_FILE}"

    def __init__(self, source: Path, options: Options) -> None:
        self._folder = source
        self._layout = options.choice("box", boxes.LAYOUTS)
        self._detections = options.file("detections", *boxes.USUAL_FILES)
        self._scale = options.positive("depth-scale", DEPTH_SCALE)
        self._depth_gap_ms = options.positive("depth-gap", GAP_S) * 1000
        self._pose_gap_ms = options.positive("pose-gap", GAP_S) * 1000
        self._poses = options.file("poses", POSE_FILE)
        known = next((c for n, c in CALIBRATED.items() if n in source.resolve().name), None)
        self._lens = Lens.of(options, known)
        self._clock = options.clock()
        self.skipped = Skipped()
        self._colour = self._list(COLOUR)
        self._left_out = self.skipped
        self.facts = RecordingFacts(
            name=source.resolve().name,
            zone=options.zone,
            frames=len(self._colour),
            notes=self._notes(known),
        )

    def _notes(self, known: Intrinsics | None) -> tuple[str, ...]:
        notes = []
        if known is not None and self._lens.intrinsics == known:
            notes.append("the camera is the benchmark's own, by the folder's name")
        if self._clock.is_undated:
            notes.append("seconds count from an unknown start: put at 1 January 2000")
        return tuple(notes)

    def _list(self, file: str) -> list[Listed]:
        """Return the lines of a list; broken ones are counted."""
        aliases = {"time": ("timestamp",), "name": ("filename", "file")}
        table = read_table(self._folder / file, aliases, ("time", "name"), self.skipped)
        listed = []
        for number, row in table.rows:
            where = f"{file}:{number}"
            try:
                if not row.keys() >= {"time", "name"}:
                    raise BadInput("a line is a time and a file")  # noqa: TRY301
                listed.append(Listed(self._clock.ms(row["time"]), row["name"], where))
            except BadInput as error:
                self.skipped.add(BROKEN_TIME, f"{where} ({error})")
        return listed

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each colour picture."""
        self.skipped = Skipped()
        self.skipped.join(self._left_out)
        depth = self._list(DEPTH) if (self._folder / DEPTH).is_file() else None
        depth = None if depth is None else sorted(depth, key=lambda each: each.time_ms)
        track = self._track()
        rows = self._rows()
        for listed in self._colour:
            try:
                yield self._frame(listed, depth, track, rows)
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_FRAME, f"{listed.where} ({error})")
        if rows is not None:
            rows.count_left(self.skipped)

    def _track(self) -> Track | None:
        if self._poses is None:
            return None
        return read_track(self._poses, self._clock, self.skipped)

    def _rows(self) -> parsing.Rows | None:
        if self._detections is None:
            return None
        names = boxes.FrameNames({Path(each.name).stem: each.name for each in self._colour})
        return boxes.read_boxes(self._detections, names, self._layout, self.skipped)

    def _frame(
        self,
        listed: Listed,
        depth: Sequence[Listed] | None,
        track: Track | None,
        rows: parsing.Rows | None,
    ) -> Frame:
        name = parsing.frame_name(Path(listed.name).stem)
        picture = parsing.picture(self._folder, listed.name, self.skipped)
        return Frame(
            name=name,
            time_ms=listed.time_ms,
            pose=self._pose(listed, track),
            camera=self._lens.camera(picture),
            image=picture,
            depth=self._depth(listed, depth),
            detections=None if rows is None else rows.take(name),
            depth_scale=self._scale,
        )

    def _pose(self, listed: Listed, track: Track | None) -> Pose | None:
        if track is None:
            return None
        pose = track.nearest(listed.time_ms, self._pose_gap_ms)
        if pose is None:
            self.skipped.add(NO_POSE, listed.where)
        return pose

    def _depth(self, listed: Listed, depth: Sequence[Listed] | None) -> Path | None:
        if depth is None:
            return None
        after = bisect_left(depth, listed.time_ms, key=lambda each: each.time_ms)
        near = [
            each
            for each in depth[max(after - 1, 0) : after + 1]
            if abs(each.time_ms - listed.time_ms) <= self._depth_gap_ms
        ]
        if not near:
            self.skipped.add(NO_DEPTH, listed.where)
            return None
        nearest = min(near, key=lambda each: abs(each.time_ms - listed.time_ms))
        return parsing.picture(self._folder, nearest.name, self.skipped)

    def streams(self) -> Sequence[Stream]:
        """Return the three lists with their times."""
        quiet, kept = Skipped(), self.skipped
        self.skipped = quiet  # what is broken is counted where the frames are read
        found = [Stream.of(COLOUR, "pictures", [each.time_ms for each in self._colour])]
        if (self._folder / DEPTH).is_file():
            found.append(Stream.of(DEPTH, "depth", [e.time_ms for e in self._list(DEPTH)]))
        track = self._track()
        if track is not None and self._poses is not None:
            found.append(Stream.of(self._poses.name, "poses", track.times))
        self.skipped = kept
        return found

    def links(self) -> Sequence[Link]:
        """Return nothing: the format has one camera, whose poses are in the map."""
        return ()
