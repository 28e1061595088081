"""Tables beside the pictures: times of frames, and the camera's poses over time."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from d3a.model import BadInput, Pose
from d3a.readers import parsing
from d3a.readers.base import Skipped
from d3a.readers.clock import Clock
from d3a.readers.tables import Row, read_table

BROKEN_POSE = "broken pose"
BROKEN_TIME = "broken time"
TIME_NAMES = ("timestamp", "stamp", "seconds", "datetime", "date_time", "t", "time_ms", "time_ns")
FRAME_NAMES = ("frame_id", "frame_number", "frame_name", "image_id")
PICTURE_NAMES = ("file", "file_name", "filename", "image", "picture", "path", "color", "rgb")
POSE_FIELDS = ("x", "y", "z", "qx", "qy", "qz", "qw")
_POSE_NAMES = {
    **{axis: (f"t{axis}", f"p{axis}", f"pose_{axis}", f"position_{axis}") for axis in "xyz"},
    **{q: (f"pose_{q}", f"orientation_{q[1]}", f"rotation_{q[1]}") for q in POSE_FIELDS[3:]},
}
_NAMES = {"frame": (*FRAME_NAMES, "id", "index", "name"), "picture": PICTURE_NAMES}


def read_times(path: Path, clock: Clock, skipped: Skipped) -> dict[str, int]:
    """Return UTC milliseconds by the name of the frame or of its picture, in the file's order.

    Columns: a time, and a frame or a picture; without names a line is a time and then the picture,
    as in TUM's lists. Broken lines are counted.
    """
    table = read_table(path, {"time": TIME_NAMES, **_NAMES}, ("time", "picture"), skipped)
    if "time" not in table.columns or not table.columns & _NAMES.keys():
        raise BadInput(f"{path.name} needs two columns: a time, and the picture or frame it is of")
    times: dict[str, int] = {}
    for number, row in table.rows:
        try:
            times.setdefault(_name(row), clock.ms(_needed(row, "time")))
        except BadInput as error:
            skipped.add(BROKEN_TIME, f"{path.name}:{number} ({error})")
    return times


def _name(row: Row) -> str:
    """Return what names the frame: its picture's path, else its own name."""
    return row["picture"] if "picture" in row else _needed(row, "frame")


def _needed(row: Row, name: str) -> str:
    if name not in row:
        raise BadInput(f"no {name}")
    return row[name]


def nearest_at(times: Sequence[int], wanted: int, gap: float) -> int | None:
    """Return which of some sorted times is nearest, the earlier of two; None beyond the gap."""
    after = bisect_left(times, wanted)
    near = [at for at in (after - 1, after) if 0 <= at < len(times)]
    near = [at for at in near if abs(times[at] - wanted) <= gap]
    return min(near, key=lambda at: (abs(times[at] - wanted), at), default=None)


@dataclass(slots=True)
class Track:
    """Poses by time, or by the frame's name."""

    times: list[int] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)
    by_name: Mapping[str, Pose] = field(default_factory=dict)

    def nearest(self, time_ms: int, gap_ms: float) -> Pose | None:
        """Return the pose nearest in time, the earlier of two; None where it is farther off."""
        at = nearest_at(self.times, time_ms, gap_ms)
        return None if at is None else self.poses[at]

    def at(self, time_ms: int, gap_ms: float) -> Pose | None:
        """Return the pose at a time: between the two around it where both are near enough."""
        after = bisect_left(self.times, time_ms)
        if 0 < after < len(self.times) and self.times[after] != time_ms:
            before_ms, after_ms = self.times[after - 1], self.times[after]
            if max(time_ms - before_ms, after_ms - time_ms) <= gap_ms:
                share = (time_ms - before_ms) / (after_ms - before_ms)
                return between(self.poses[after - 1], self.poses[after], share)
        return self.nearest(time_ms, gap_ms)


def read_track(path: Path, clock: Clock, skipped: Skipped) -> Track:
    """Return the poses of a table: TUM's lines, or named columns with a time or a frame.

    Lines may be in any order. Broken ones are counted; a table without any column for the place or
    the turn is BadInput.
    """
    aliases = {"time": TIME_NAMES, **_NAMES, **_POSE_NAMES}
    table = read_table(path, aliases, ("time", *POSE_FIELDS), skipped)
    lacking = [name for name in POSE_FIELDS if name not in table.columns]
    if lacking or not table.columns & {"time", *_NAMES}:
        raise BadInput(
            f"{path.name} lacks {', '.join(lacking) or 'a time or a frame'}: a pose is a time (or "
            "a frame) and x y z qx qy qz qw, of the camera's optical centre"
        )
    timed: list[tuple[int, Pose]] = []
    named: dict[str, Pose] = {}
    for number, row in table.rows:
        try:
            pose = pose_of(row)
            if "time" in row:
                timed.append((clock.ms(row["time"]), pose))
            else:
                named.setdefault(_name(row), pose)
        except BadInput as error:
            skipped.add(BROKEN_POSE, f"{path.name}:{number} ({error})")
    timed.sort(key=lambda each: each[0])
    return Track([t for t, _ in timed], [pose for _, pose in timed], named)


def pose_of(row: Row, prefix: str = "") -> Pose:
    """Return the pose of a row's seven columns; BadInput where one is missing or no number."""
    x, y, z, qx, qy, qz, qw = (
        parsing.number(_needed(row, prefix + name), name) for name in POSE_FIELDS
    )
    return Pose((x, y, z), (qx, qy, qz, qw))


def between(first: Pose, second: Pose, share: float) -> Pose:
    """Return the pose `share` (0 to 1) of the way: straight in place, on the sphere in turn.

    The first's covariance is kept.
    """
    place = tuple(a + (b - a) * share for a, b in zip(first.position, second.position, strict=True))
    a, b = first.quaternion, second.quaternion
    cosine = sum(p * q for p, q in zip(a, b, strict=True))
    if cosine < 0:  # q and -q are one rotation: take the shorter way
        b, cosine = (-b[0], -b[1], -b[2], -b[3]), -cosine
    angle = math.acos(min(cosine, 1.0))
    if angle < 1e-6:
        start, end = 1 - share, share
    else:
        start = math.sin((1 - share) * angle) / math.sin(angle)
        end = math.sin(share * angle) / math.sin(angle)
    turn = tuple(start * p + end * q for p, q in zip(a, b, strict=True))
    return Pose(
        (place[0], place[1], place[2]), (turn[0], turn[1], turn[2], turn[3]), first.covariance
    )
