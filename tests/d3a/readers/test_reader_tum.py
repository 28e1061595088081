"""TUM RGB-D folders: the same store as the recording they hold, and what is broken counted."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.ingesting.preparation import BROKEN_DEPTH, BROKEN_PICTURE, OUTSIDE
from d3a.ingesting.sieve import BACKWARDS
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers import parsing
from d3a.readers.base import Described
from d3a.readers.opening import open_source
from d3a.readers.tracks import BROKEN_POSE, BROKEN_TIME
from d3a.readers.tum import NO_DEPTH, NO_POSE
from tests.worlds.folders import NAMED, as_recording, as_tum, dumped, moments, taken_by
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import depth_png

taken = partial(taken_by, "TumReader")


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("scale", [5000.0, 1000.0])
def test_the_store_is_that_of_the_recording(
    tmp_path: Path, parameters: Parameters, scale: float
) -> None:
    plain, store = OracleStore(), OracleStore()
    ingest(open_source(as_recording(tmp_path / "r")), plain, parameters)
    options = NAMED | ({} if scale == 5000 else {"depth-scale": "1000"})
    reader = open_source(as_tum(tmp_path / "t", scale), zone="UTC", options=options)
    assert type(reader).__name__ == "TumReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)
    assert len(store.objects()) == 2


def test_streams_are_paired_by_the_nearest_stamp(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    first, second = moments()[:2]
    edit(folder / "depth.txt", first.seconds, f"{first.time_ms / 1000 + 0.015:.3f}")
    edit(folder / "depth.txt", f"{second.seconds} ", f"{second.time_ms / 1000 + 0.2:.3f} ")
    edit(folder / "groundtruth.txt", f"{second.seconds} ", f"{second.time_ms / 1000 - 0.1:.3f} ")
    reader = open_source(folder)
    frames = list(reader)
    assert [frame.depth is None for frame in frames[:3]] == [False, True, False]
    assert [frame.pose is None for frame in frames[:3]] == [False, True, False]
    assert reader.skipped.counts == {NO_DEPTH: 1, NO_POSE: 1}
    wider = open_source(folder, options={"pose-gap": "0.15", "depth-gap": "0.25"})
    assert all(frame.pose and frame.depth for frame in wider)
    assert wider.skipped.counts == {}


def test_a_folder_of_the_benchmark_brings_its_camera(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "rgbd_dataset_freiburg3_office")
    (folder / "camera.json").unlink()
    reader = open_source(folder)
    camera = next(iter(reader)).camera
    assert camera is not None
    assert (camera.width, camera.height, camera.fx) == (64, 48, 535.4)
    assert "benchmark's own" in reader.facts.notes[0]
    (plain,) = {frame.camera for frame in open_source(as_tum(tmp_path / "t"))}
    assert plain is not None
    assert plain.fx == 50.0
    said = open_source(folder, options={"camera": "1,2,3,4"})
    assert next(iter(said)).camera != camera
    assert said.facts.notes == ()


def test_without_intrinsics_poses_or_depth_it_still_reads(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    for name in ("camera.json", "depth.txt"):
        (folder / name).unlink()
    frames = list(open_source(folder))
    assert {(f.camera, f.depth) for f in frames} == {(None, None)}
    summary, store = taken(folder)
    assert summary.frames == 8
    assert all(stay.position is not None for stay in store.stays())
    (folder / "groundtruth.txt").unlink()
    bare = open_source(folder)
    assert type(bare).__name__ == "PicturesReader"
    assert [frame.pose for frame in bare] == [None] * 8
    with pytest.raises(BadInput, match=r"rgb\.txt with depth\.txt or groundtruth\.txt"):
        open_source(folder, format="tum")


def wide_png(path: Path) -> None:
    fine, buffer = cv2.imencode(".png", np.zeros((1, 1_000_000), np.uint8))
    assert fine
    path.write_bytes(bytes(buffer))


def test_a_first_line_that_is_cut_does_not_spoil_the_others(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    for name in ("rgb.txt", "groundtruth.txt"):
        (folder / name).write_text("1599999999.0\n" + (folder / name).read_text())
    reader = open_source(folder)
    assert len([frame for frame in reader if frame.pose is not None]) == 8
    assert reader.skipped.counts == {BROKEN_TIME: 1, BROKEN_POSE: 1}


def test_each_broken_part_is_counted_and_the_rest_ingested(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    a, b, c, d, e, f, g, h = moments()
    jpeg_of = {m: folder / "rgb" / f"{m.name}.jpg" for m in moments()}
    jpeg_of[a].write_bytes(jpeg_of[a].read_bytes()[:300])
    jpeg_of[b].write_bytes(b"")
    wide_png(jpeg_of[c])
    (folder / "depth" / f"{d.name}.png").write_bytes(depth_png(2.0, 32, 24))
    edit(folder / "groundtruth.txt", f"{e.seconds} ", f"{e.seconds} nan ")
    edit(folder / "rgb.txt", f"{f.seconds} ", "yesterday ")
    edit(folder / "rgb.txt", f"{g.seconds} ", f"{a.seconds[:-1]}1 ")
    with (folder / "detections.jsonl").open("a") as lines:
        lines.write(f'{{"frame": "{h.name}", "category": "cup", "probability": 1, ')
        lines.write('"box": [200, 5, 220, 9]}\n{"frame": "')
    with (folder / "rgb.txt").open("a") as lines:
        lines.write("16000")
    summary, store = taken(folder)
    assert summary.skipped.counts == {
        BROKEN_PICTURE: 3,
        BROKEN_DEPTH: 1,
        BROKEN_POSE: 1,
        NO_POSE: 1,
        BROKEN_TIME: 2,
        BACKWARDS: 1,
        OUTSIDE: 1,
        parsing.BROKEN_LINE: 1,
        "detection of an unknown frame": 2,
    }
    assert "too large to decode: 1000000 x 1 pixels" in str(summary.skipped.examples)
    assert summary.frames == 6  # of 8: one has no time, one stands before its predecessor
    assert store.check() == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"depth_skale": "1000"}, "Did you mean depth-scale"),
        ({"depth-scale": "0"}, "above 0"),
        ({"depth-scale": "many"}, "not a number"),
        ({"poses": "none.txt"}, "no such file"),
        ({"camera": "0,0,1,1"}, "above 0"),
        ({"camera": "1,2,3"}, "no such file"),
        ({"box": "corners"}, "xyxy, xywh, cxcywh"),
        ({"topic": "/camera"}, "no option 'topic'"),
    ],
)
def test_an_option_that_cannot_be_is_refused(
    tmp_path: Path, options: dict[str, str], said: str
) -> None:
    with pytest.raises(BadInput, match=said):
        open_source(as_tum(tmp_path / "t"), options=options)


def test_it_tells_its_streams(tmp_path: Path) -> None:
    reader = open_source(as_tum(tmp_path / "t"))
    assert isinstance(reader, Described)
    streams = {stream.name: stream for stream in reader.streams()}
    assert set(streams) == {"rgb.txt", "depth.txt", "groundtruth.txt"}
    assert {stream.count for stream in streams.values()} == {8}
    assert streams["depth.txt"].longest_gap_s == 0.5
    assert streams["rgb.txt"].first_ms == moments()[0].time_ms
    assert reader.links() == ()


def test_seconds_from_an_unknown_start_are_said_to_be(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    for name in ("rgb.txt", "depth.txt", "groundtruth.txt"):
        text = (folder / name).read_text()
        for n, each in enumerate(moments()):
            text = text.replace(f"{each.seconds} ", f"{n / 2} ")
        (folder / name).write_text(text)
    reader = open_source(folder)
    assert "unknown start" in reader.facts.notes[-1]
    assert next(iter(reader)).time_ms == 946684800000
    dated = open_source(folder, options={"start": "2024-05-01T10:00:00+02:00"})
    assert dated.facts.notes == ()
    times = [frame.time_ms for frame in dated]
    assert (times[0], times[1] - times[0]) == (1714550400000, 500)
