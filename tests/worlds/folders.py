"""One small recording, written in the form of each reader: the same facts, other files."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from d3a.ingest import IngestSummary, ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, START_MS, jpeg, write_recording

STEP_MS = 500
NAMED = {"name": "same", "site": "lab"}
"""What the recording says of itself, for forms that cannot say it."""


@dataclass(frozen=True)
class Moment:
    """A frame of the small recording."""

    name: str
    time_ms: int
    pose: tuple[float, ...]
    shade: int
    depth_m: float

    @property
    def iso(self) -> str:
        return datetime.fromtimestamp(self.time_ms / 1000, UTC).isoformat(timespec="milliseconds")

    @property
    def seconds(self) -> str:
        return f"{self.time_ms // 1000}.{self.time_ms % 1000:03d}"


def moments(count: int = 8) -> list[Moment]:
    """A camera that moves 10 cm a frame; frames bear their time as their name."""
    made = []
    for n in range(count):
        time_ms = START_MS + n * STEP_MS
        name = f"{time_ms // 1000}.{time_ms % 1000:03d}"
        made.append(Moment(name, time_ms, (0.1 * n, 0, 1, 0, 0, 0, 1), 40 + n, 2.0 + 0.01 * n))
    return made


def found(moment: Moment) -> list[dict[str, Any]]:
    """What a detector saw in a frame: a cup, and now and then a bowl."""
    n = moment.shade - 40
    rows = [{"category": "cup", "probability": 0.9, "box": [10 + n, 10, 30 + n, 30]}]
    if n % 2:
        rows.append({"category": "bowl", "probability": 0.75, "box": [40, 12, 60, 40]})
    return rows


def depth_of(moment: Moment, scale: float) -> bytes:
    counts = np.full((CAMERA.height, CAMERA.width), round(moment.depth_m * scale), np.uint16)
    fine, buffer = cv2.imencode(".png", counts)
    assert fine
    return bytes(buffer)


def camera_json() -> dict[str, float]:
    return {name: getattr(CAMERA, name) for name in ("width", "height", "fx", "fy", "cx", "cy")}


def as_recording(folder: Path, *, depth: bool = True, poses: bool = True) -> Path:
    """The small recording in the form of `recording.md`; every other form must equal it."""
    frames, rows = [], []
    for each in moments():
        frames.append(
            {
                "frame": each.name,
                "time": each.iso,
                "pose": list(each.pose) if poses else None,
                "image": f"images/{each.name}.jpg",
                "depth": f"depth/{each.name}.png" if depth else None,
            }
        )
        rows += [{"frame": each.name} | row for row in found(each)]
    facts: dict[str, Any] = {"recording": "same", "site": "lab", "zone": "UTC"}
    write_recording(folder, frames, rows, **facts)
    pictures(folder / "images")
    if depth:
        depths(folder / "depth", 1000.0)
    return folder


def pictures(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for each in moments():
        (folder / f"{each.name}.jpg").write_bytes(jpeg(each.shade))


def depths(folder: Path, scale: float) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for each in moments():
        (folder / f"{each.name}.png").write_bytes(depth_of(each, scale))


def boxes_file(folder: Path) -> None:
    lines = [json.dumps({"frame": m.name} | row) for m in moments() for row in found(m)]
    (folder / "detections.jsonl").write_text("".join(line + "\n" for line in lines))


def camera_file(folder: Path) -> None:
    (folder / "camera.json").write_text(json.dumps(camera_json()))


def pose_lines(header: str = "# timestamp tx ty tz qx qy qz qw") -> str:
    rows = [" ".join(map(str, (m.seconds, *m.pose))) for m in moments()]
    return "\n".join((header, *rows)) + "\n"


def as_tum(folder: Path, scale: float = 5000.0) -> Path:
    pictures(folder / "rgb")
    depths(folder / "depth", scale)
    for name, suffix in (("rgb", "jpg"), ("depth", "png")):
        rows = [f"{m.seconds} {name}/{m.name}.{suffix}" for m in moments()]
        (folder / f"{name}.txt").write_text("\n".join(("# timestamp filename", *rows)) + "\n")
    (folder / "groundtruth.txt").write_text(pose_lines())
    boxes_file(folder)
    camera_file(folder)
    return folder


def write_csv(path: Path, header: Sequence[str], rows: Sequence[Sequence[object]]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as lines:
        csv.writer(lines).writerows([header, *rows])
    return path


def taken_by(reader: str, source: Path, **options: str) -> tuple[IngestSummary, OracleStore]:
    """Ingest a form of the small recording, which a reader of this name has to open."""
    store = OracleStore()
    opened = open_source(source, zone="UTC", options=NAMED | options)
    assert type(opened).__name__ == reader
    return ingest(opened, store, DEFAULT), store


def dumped(store: OracleStore, *, sizes: bool = True) -> list[dict[str, Any]]:
    """What a store holds; `sizes` False leaves out the bytes of pictures."""
    rows = [dict(row) for row in store.dump()]
    for row in rows:
        if row["kind"] == "keyframe" and not sizes:
            del row["size"]
    return rows
