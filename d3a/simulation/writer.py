"""Write a simulated recording in the form of a recording folder."""

from __future__ import annotations

import json
import struct
import zlib
from datetime import datetime, timedelta
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
from numpy.typing import NDArray

from d3a.model import Json
from d3a.simulation import appearance
from d3a.simulation.camera import CAMERA, axes, depth_image, quaternions
from d3a.simulation.conditions import Condition
from d3a.simulation.patrol import Track
from d3a.simulation.room import walls
from d3a.simulation.sensor import Reports
from d3a.simulation.solids import Floats
from d3a.simulation.truth import Emptiness
from d3a.simulation.world import World

ZONE = "America/New_York"
BEGIN = datetime(2020, 2, 24, 9, 0, tzinfo=ZoneInfo(ZONE))
CODE_DIM = 64


def moment(seconds: float) -> str:
    """Return the ISO time of so many seconds after the beginning, to the millisecond."""
    return (BEGIN + timedelta(milliseconds=round(seconds * 1000))).isoformat(
        timespec="milliseconds"
    )


SIMULATED = "simulated-"
"""How the names of simulated recordings begin."""


def frame_name(number: int) -> str:
    """Return a frame's name in the recording."""
    return f"{number:06d}"


def write_facts(out: Path, name: str, model: str, dim: int, *, whole: bool) -> None:
    """Write recording.json. whole: all of the recording is there; else it says so."""
    camera = {key: getattr(CAMERA, key) for key in ("width", "height", "fx", "fy", "cx", "cy")}
    record: Json = {
        "schema": 1,
        "recording": name,
        "site": "lab",
        "zone": ZONE,
        "camera": camera,
        "embedding": {"name": model, "dim": dim},
        "map": None,
    }
    if not whole:
        record["unfinished"] = True
    (out / "recording.json").write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def write_frames(out: Path, believed: Track, condition: Condition, depth: bool) -> None:
    """Write frames.jsonl with the poses that the robot believes in."""
    position, turn = condition.claimed_pose_m**2, np.deg2rad(condition.heading_deg) ** 2
    covariance = np.diag([position, position, 1e-4, 1e-4, 1e-4, max(turn, 1e-4)]).ravel()
    claimed = [round(float(v), 8) for v in covariance]
    rows = np.concatenate([believed.places, quaternions(believed.yaw)], axis=1).round(6)
    _write_lines(
        out / "frames.jsonl",
        [
            {
                "frame": frame_name(k),
                "time": moment(float(seconds)),
                "pose": rows[k].tolist(),
                "pose_covariance": claimed,
                "image": None,
                "depth": f"depth/{frame_name(k)}.png" if depth else None,
            }
            for k, seconds in enumerate(believed.times)
        ],
    )


def write_detections(out: Path, reports: Reports, vectors: NDArray[np.float32]) -> None:
    """Write detections.jsonl and embeddings.npy, a row of it per detection."""
    boxes, places = reports.box.round(2).tolist(), reports.position.round(4).tolist()
    _write_lines(
        out / "detections.jsonl",
        [
            {
                "frame": frame_name(int(reports.frame[k])),
                "category": reports.category[k],
                "probability": float(reports.probability[k]),
                "box": boxes[k],
                "position": places[k],
                "embedding": k,
            }
            for k in range(len(reports.frame))
        ],
    )
    np.save(out / "embeddings.npy", vectors)


def codes(
    reports: Reports, condition: Condition, things: int, rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return instance codes (d, 64) with flipped bits, and which detections keep any bit, (d,).

    Paper, Exp 1: every zero of a one-hot code turns to one with fpr, the one to zero with fnr.
    Bits past the number of things are padding and stay zero.
    """
    shape = (len(reports.thing), things)
    bits = reports.thing[:, None] == np.arange(things)
    draw = rng.random(shape)
    flipped = np.where(bits, draw >= condition.fnr, draw < condition.fpr)
    padded = np.zeros((shape[0], max(CODE_DIM, things)), dtype=np.float32)
    padded[:, :things] = flipped
    return padded, np.asarray(flipped.any(axis=1))


def write_depth(
    out: Path, track: Track, fixed: Floats, loose: Floats, noise: bool, rng: np.random.Generator
) -> None:
    """Write a depth image per frame, from where the camera truly was."""
    (out / "depth").mkdir(exist_ok=True)
    still = np.concatenate([fixed, np.array(walls(), dtype=np.float32)])
    turned = axes(track.yaw)
    for k in range(len(track.times)):
        there = loose[k][loose[k, :, 0] < 1e3]
        image = depth_image(track.places[k], turned[k], np.concatenate([still, there]), noise, rng)
        (out / "depth" / f"{frame_name(k)}.png").write_bytes(png16(image))


def png16(image: NDArray[np.uint16]) -> bytes:
    """Return a 16-bit grey PNG; rows are stored as differences to the row above."""
    height, width = image.shape
    raw = image.astype(">u2").view(np.uint8).reshape(height, 2 * width)
    up = raw.copy()
    up[1:] -= raw[:-1]  # bytes wrap around, as the PNG filter has it
    rows = np.concatenate([np.full((height, 1), 2, dtype=np.uint8), up], axis=1)

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1))
        + chunk(b"IEND", b"")
    )


def write_truth(
    out: Path,
    world: World,
    reports: Reports,
    empty: list[Emptiness | None],
    related: list[list[Json]],
) -> None:
    """Write truth.jsonl: a line per thing with its stays, relations and detections."""
    lines: list[Json] = []
    for k, thing in enumerate(world.things):
        places = [
            _place(world, j, empty[j], related[j])
            for j, stand in enumerate(world.stands)
            if stand.thing == k
        ]
        lines.append(
            {
                "object": thing.name,
                "category": thing.category,
                "colour": thing.colour,
                "size": [round(v, 3) for v in thing.size],
                "places": places,
                "detections": np.flatnonzero(reports.thing == k).tolist(),
            }
        )
    _write_lines(out / "truth.jsonl", lines)


def _place(world: World, stay: int, empty: Emptiness | None, related: list[Json]) -> Json:
    stand = world.stands[stay]
    return {
        "position": [round(v, 4) for v in stand.position],
        "start": moment(stand.start_s),
        "end": moment(stand.end_s),
        "support": stand.support,
        "seen_empty": None
        if empty is None
        else {
            "first": moment(empty.first_s),
            "last": moment(empty.last_s),
            "frames": empty.frames,
        },
        "relations": [
            {
                "kind": row["kind"],
                "object": row["object"],
                "start": moment(row["span"][0]),
                "end": moment(row["span"][1]),
            }
            for row in related
        ],
    }


def _write_lines(path: Path, records: list[Json]) -> None:
    with path.open("w", encoding="utf-8") as file:
        file.writelines(json.dumps(record, separators=(",", ":")) + "\n" for record in records)


def embedding_name(condition: Condition, things: int) -> tuple[str, int]:
    """Return the embedding's name and length under a condition."""
    if condition.codes:
        return "instance-code", max(CODE_DIM, things)
    return appearance.MODEL, appearance.DIM
