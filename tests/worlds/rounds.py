"""A few coloured things and a camera that goes round them: recordings made in memory or on disk."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from d3a.images import encode, unit
from d3a.model import Camera, Detection, Frame, Pose
from d3a.readers.base import RecordingFacts, Skipped

CAMERA = Camera(64, 48, 50.0, 50.0, 32.0, 24.0)
START_MS = 1_600_000_000_000
FORWARD = (0.0, 0.7071067811865476, 0.0, 0.7071067811865476)
"""Turns the optical axis to the map's +x; the picture's down is then the map's +y."""


def colour(number: int) -> NDArray[np.float32]:
    """A look of its own for each number: most of it in one bin, the rest spread."""
    counts = np.full(512, 0.2, dtype=np.float32)
    counts[(number * 97) % 512] = 200.0
    counts[(number * 31 + 7) % 512] = 90.0
    return unit(counts)


@dataclass
class ListReader:
    """A reader of frames that are there already."""

    frames: Sequence[Frame]
    facts: RecordingFacts = field(default_factory=lambda: RecordingFacts("made", zone="UTC"))
    skipped: Skipped = field(default_factory=Skipped)

    def __iter__(self) -> Iterator[Frame]:
        self.skipped = Skipped()
        return iter(self.frames)


@dataclass(frozen=True)
class Thing:
    """Something to be seen: by frame number until `until`, at a place."""

    category: str
    position: tuple[float, float, float]
    number: int
    since: int = 0
    until: int = 10**9


def see(thing: Thing, rng: np.random.Generator, noise_m: float, row: int) -> Detection:
    x, y, z = np.array(thing.position) + rng.normal(0, noise_m, 3)
    counts = np.abs(colour(thing.number) + rng.normal(0, 0.004, 512)).astype(np.float32)
    left = float(rng.uniform(0, 40))
    return Detection(
        category=thing.category,
        probability=round(float(rng.uniform(0.5, 1.0)), 3),
        box=(left, 10.0, left + 12.0, 30.0),
        position=(float(x), float(y), float(z)),
        embedding=unit(counts),
        row=row,
    )


def rounds(
    things: Sequence[Thing],
    frames: int,
    seed: int = 0,
    *,
    step_s: float = 5.0,
    noise_m: float = 0.05,
    missed: float = 0.2,
    look: bool = True,
) -> list[Frame]:
    """Frames from one of four corners in turn; every thing is found unless missed."""
    rng = np.random.default_rng(seed)
    made, row = [], 0
    for number in range(frames):
        corner = number // 3 % 4
        pose = Pose((-3.0, float(corner), 0.0), FORWARD) if look else None
        found = []
        for thing in things:
            if thing.since <= number < thing.until and rng.random() >= missed:
                found.append(see(thing, rng, noise_m, row))
                row += 1
        time_ms = START_MS + round(number * step_s * 1000)
        made.append(Frame(f"f{number:04d}", time_ms, pose, CAMERA, None, None, tuple(found)))
    return made


def jpeg(shade: int, width: int = 64, height: int = 48) -> bytes:
    """A small picture of one shade with a gradient, so that it has something to encode."""
    ramp = np.linspace(0, 60, width, dtype=np.uint8)
    pixels = np.broadcast_to(ramp[None, :, None] + np.uint8(shade), (height, width, 3))
    return encode(np.ascontiguousarray(pixels), 1280, 90)


def depth_png(metres: float, width: int = 64, height: int = 48) -> bytes:
    fine, buffer = cv2.imencode(".png", np.full((height, width), round(metres * 1000), np.uint16))
    assert fine
    return bytes(buffer)


def write_recording(
    folder: Path,
    frames: Sequence[dict[str, Any]],
    detections: Sequence[dict[str, Any] | str],
    **facts: Any,
) -> Path:
    """A recording folder; a detection that is text is written as it is."""
    folder.mkdir(parents=True, exist_ok=True)
    camera = {n: getattr(CAMERA, n) for n in ("width", "height", "fx", "fy", "cx", "cy")}
    record = {"schema": 1, "recording": "lab", "site": "s", "zone": "Europe/Berlin"}
    (folder / "recording.json").write_text(json.dumps(record | {"camera": camera} | facts))
    lines = "".join(json.dumps(frame) + "\n" for frame in frames)
    (folder / "frames.jsonl").write_text(lines, encoding="utf-8")
    rows = [d if isinstance(d, str) else json.dumps(d, ensure_ascii=False) for d in detections]
    (folder / "detections.jsonl").write_text("".join(r + "\n" for r in rows), encoding="utf-8")
    return folder


def frame_line(number: int, **fields: Any) -> dict[str, Any]:
    minute, second = divmod(number * 10, 60)
    time = f"2024-05-01T10:{minute:02d}:{second:02d}.000+02:00"
    return {"frame": f"{number:06d}", "time": time, "pose": [0, 0, 0, 0, 0, 0, 1]} | fields


def detection_line(number: int, **fields: Any) -> dict[str, Any]:
    usual = {"category": "cup", "probability": 0.9, "box": [10, 10, 30, 30]}
    return {"frame": f"{number:06d}"} | usual | fields


def circle(radius_m: float, count: int) -> list[tuple[float, float, float]]:
    """Places on a circle, in order."""
    angles = [2 * math.pi * k / count for k in range(count)]
    return [(radius_m * math.cos(a), radius_m * math.sin(a), 0.0) for a in angles]
