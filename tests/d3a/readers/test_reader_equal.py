"""The older readers too: the store of a folder is that of the recording with the same facts."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.ingesting.preparation import BROKEN_PICTURE, OUTSIDE
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.kuri import LOCATION_SIGMA_M
from d3a.readers.opening import open_source
from d3a.readers.posed import EPOCH, POSE_SIGMA_M, POSE_SIGMA_RAD
from tests.worlds.folders import NAMED, depths, dumped, found, moments, pictures, write_csv
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, depth_png, write_recording

PROFILES = pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])


def filled(folder: Path, parameters: Parameters, **options: str) -> OracleStore:
    store = OracleStore()
    ingest(open_source(folder, zone="UTC", options=options), store, parameters)
    return store


def recorded(folder: Path, frames: list[dict[str, Any]], rows: list[dict[str, Any]]) -> Path:
    facts: dict[str, Any] = {"recording": "same", "site": "lab", "zone": "UTC"}
    return write_recording(folder, frames, rows, **facts)


def as_posed(folder: Path) -> Path:
    pictures(folder / "frames")
    depths(folder / "frames", 1000.0)
    matrix = np.array([[CAMERA.fx, 0, CAMERA.cx], [0, CAMERA.fy, CAMERA.cy], [0, 0, 1]])
    np.savetxt(folder / "camera-intrinsics.txt", matrix)
    rows = []
    for n, each in enumerate(moments()):
        pose = np.eye(4)
        pose[:3, 3] = each.pose[:3]
        np.savetxt(folder / "frames" / f"{each.name}.txt", pose)
        stem = f"frames/{each.name}"
        rows.append((each.name, n / 2, f"{stem}.jpg", f"{stem}.png", f"{stem}.txt"))
    write_csv(folder / "frames.csv", ("frame", "seconds", "color", "depth", "pose"), rows)
    lines = [json.dumps({"frame": m.name} | row) for m in moments() for row in found(m)]
    (folder / "detections.jsonl").write_text("\n".join(lines) + "\n")
    return folder


@PROFILES
def test_posed_gives_the_store_of_the_recording(tmp_path: Path, parameters: Parameters) -> None:
    variances = [POSE_SIGMA_M**2] * 3 + [POSE_SIGMA_RAD**2] * 3
    frames = [
        {
            "frame": each.name,
            "time": datetime.fromtimestamp(EPOCH.timestamp() + n / 2, UTC).isoformat(),
            "pose": list(each.pose),
            "pose_covariance": np.diag(variances).ravel().tolist(),
            "image": f"images/{each.name}.jpg",
            "depth": f"depth/{each.name}.png",
        }
        for n, each in enumerate(moments())
    ]
    rows = [{"frame": m.name} | row for m in moments() for row in found(m)]
    plain = recorded(tmp_path / "r", frames, rows)
    pictures(plain / "images")
    depths(plain / "depth", 1000.0)
    store = filled(as_posed(tmp_path / "p"), parameters, **NAMED)
    assert dumped(store) == dumped(filled(plain, parameters))
    assert len(store.objects()) == 2


def as_kuri(folder: Path) -> Path:
    pictures(folder / "images")
    rows = [
        (n, m.iso, r["category"], r["probability"], *r["box"], 1.5, 2.5, r["box"][0] / 50)
        for n, m in enumerate(moments())
        for r in found(m)
    ]
    for n, each in enumerate(moments()):
        (folder / "images" / f"{each.name}.jpg").rename(folder / "images" / f"{n}.jpg")
    header = ("frame", "timestamp", "category", "probability", "x1", "y1", "x2", "y2")
    write_csv(folder / "detections.csv", (*header, "loc_x", "loc_y", "loc_z"), rows)
    return folder


@PROFILES
def test_kuri_gives_the_store_of_the_recording(tmp_path: Path, parameters: Parameters) -> None:
    variance = LOCATION_SIGMA_M**2
    frames = [
        {"frame": str(n), "time": each.iso, "image": f"images/{each.name}.jpg"}
        for n, each in enumerate(moments())
    ]
    rows = [
        {
            "frame": str(n),
            "position": [1.5, 2.5, row["box"][0] / 50],
            "covariance": (variance * np.eye(3)).ravel().tolist(),
        }
        | row
        for n, moment in enumerate(moments())
        for row in found(moment)
    ]
    plain = recorded(tmp_path / "r", frames, rows)
    facts = json.loads((plain / "recording.json").read_text()) | {"camera": None}
    (plain / "recording.json").write_text(json.dumps(facts))
    pictures(plain / "images")
    store = filled(as_kuri(tmp_path / "k"), parameters, **NAMED)
    assert dumped(store) == dumped(filled(plain, parameters))


@pytest.mark.parametrize("kind", ["posed", "kuri"])
def test_broken_pictures_and_boxes_are_counted_and_the_rest_ingested(
    tmp_path: Path, kind: str
) -> None:
    folder = as_posed(tmp_path / "f") if kind == "posed" else as_kuri(tmp_path / "f")
    inside = sorted((folder / ("frames" if kind == "posed" else "images")).glob("*.jpg"))
    huge = bytearray(depth_png(1.0))
    huge[16:20] = (1_000_000).to_bytes(4, "big")
    inside[0].write_bytes(b"")
    inside[1].write_bytes(huge)
    inside[2].write_bytes(inside[2].read_bytes()[:300])
    with (folder / ("detections.jsonl" if kind == "posed" else "detections.csv")).open("a") as out:
        if kind == "posed":
            row = found(moments()[7])[0] | {"frame": moments()[7].name, "box": [90, 1, 99, 9]}
            out.write(json.dumps(row) + "\n")
        else:
            out.write(f"7,{moments()[7].iso},cup,0.9,90,1,99,9,1,2,3\n")
    store = OracleStore()
    summary = ingest(open_source(folder, zone="UTC"), store, DEFAULT)
    assert summary.skipped.counts == {BROKEN_PICTURE: 3, OUTSIDE: 1}
    assert "1000000 x 48 pixels" in str(summary.skipped.examples)
    assert summary.frames == 8
    assert store.check() == []
