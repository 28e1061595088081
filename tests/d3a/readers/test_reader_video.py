"""A video with poses: the same store as a recording of its decoded pictures."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest

from d3a.images import decode
from d3a.ingest import ingest
from d3a.ingesting.preparation import OUTSIDE
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers import parsing
from d3a.readers.base import Described, Outlined
from d3a.readers.beside import NO_POSE, UNDATED_NOTE
from d3a.readers.opening import open_source
from d3a.readers.tracks import BROKEN_POSE
from d3a.readers.video import ENDS_EARLY, NO_TIME
from d3a.videos import Video
from tests.worlds.folders import (
    NAMED,
    as_recording,
    camera_file,
    dumped,
    found,
    moments,
    pose_lines,
    taken_by,
    write_csv,
)
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import START_MS, jpeg

START = moments()[0].iso
taken = partial(taken_by, "VideoReader", start=START)


def write_video(path: Path, copies: int = 1, codec: str = "MJPG") -> Path:
    """The small recording's pictures at two a second, as its stamps are."""
    path.parent.mkdir(parents=True, exist_ok=True)
    code = cv2.VideoWriter.fourcc(*codec)
    writer = cv2.VideoWriter(str(path), code, 2.0, (64, 48))
    for _ in range(copies):
        for each in moments():
            pixels = decode(jpeg(each.shade))
            writer.write(cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR))
    writer.release()
    return path


def boxes_of_frames(path: Path) -> None:
    lines = [
        json.dumps({"frame": n} | row)
        for n, moment in enumerate(moments())
        for row in found(moment)
    ]
    path.write_text("\n".join(lines) + "\n")


def as_video(folder: Path) -> Path:
    write_video(folder / "tour.avi")
    (folder / "poses.txt").write_text(pose_lines())
    camera_file(folder)
    boxes_of_frames(folder / "detections.jsonl")
    return folder


def of_its_pictures(tmp_path: Path, video: Path) -> Path:
    """The recording whose pictures are what the video decodes to."""
    folder = as_recording(tmp_path / "r", depth=False)
    for shot, moment in zip(Video.open(video).shots(), moments(), strict=True):
        assert shot.pixels is not None
        fine, buffer = cv2.imencode(".png", cv2.cvtColor(shot.pixels, cv2.COLOR_RGB2BGR))
        assert fine
        (folder / "images" / f"{moment.name}.jpg").write_bytes(bytes(buffer))
    for name in ("frames.jsonl", "detections.jsonl"):
        rows = [json.loads(line) for line in (folder / name).read_text().splitlines()]
        numbers = {moment.name: n for n, moment in enumerate(moments())}
        for row in rows:
            row["frame"] = f"{numbers[row['frame']]:06d}"
        (folder / name).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_the_store_is_that_of_its_pictures(tmp_path: Path, parameters: Parameters) -> None:
    folder = as_video(tmp_path / "v")
    plain, store = OracleStore(), OracleStore()
    recording = of_its_pictures(tmp_path, folder / "tour.avi")
    ingest(open_source(recording), plain, parameters)
    reader = open_source(folder, zone="UTC", options=NAMED | {"start": START})
    assert type(reader).__name__ == "VideoReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store, sizes=False) == dumped(plain, sizes=False)


def test_a_file_has_its_own_tables_beside(tmp_path: Path) -> None:
    folder = as_video(tmp_path / "v")
    (folder / "poses.txt").rename(folder / "tour.poses.txt")
    (folder / "detections.jsonl").rename(folder / "tour.detections.jsonl")
    write_video(folder / "other.avi")
    with pytest.raises(BadInput, match=r"2 videos \(other\.avi, tour\.avi\)"):
        open_source(folder)
    store = taken(folder / "tour.avi")[1]
    assert dumped(store) == dumped(taken(as_video(tmp_path / "w"))[1])
    bare = open_source(folder / "other.avi", options={"start": START})
    assert {(f.pose, f.detections) for f in bare} == {(None, None)}
    assert bare.facts.name == "other"


def test_times_come_from_a_table_or_count_from_nowhere(tmp_path: Path) -> None:
    folder = as_video(tmp_path / "v")
    reader = open_source(folder)
    assert reader.facts.notes == (UNDATED_NOTE,)
    assert [f.pose for f in reader] == [None] * 8
    assert reader.skipped.counts == {NO_POSE: 8}
    rows = [(n, m.iso) for n, m in enumerate(moments()) if n != 3]
    write_csv(folder / "times.csv", ("frame", "time"), rows)
    timed = open_source(folder)
    assert timed.facts.notes == ()
    frames = list(timed)
    assert [frame.time_ms for frame in frames] == [
        m.time_ms for m in moments() if m != moments()[3]
    ]
    assert timed.skipped.counts == {NO_TIME: 1, "detection of an unknown frame": 2}


def test_an_mp4_has_the_times_of_its_header(tmp_path: Path) -> None:
    video = write_video(tmp_path / "tour.mp4", codec="mp4v")
    frames = list(open_source(video, options={"start": START}))
    assert [frame.time_ms - START_MS for frame in frames] == [n * 500 for n in range(8)]


def test_a_cut_video_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    video = write_video(tmp_path / "tour.avi", copies=40)
    content = video.read_bytes()
    video.write_bytes(content[: len(content) // 2])
    reader = open_source(video, options={"start": START})
    count = len(list(reader))
    assert 100 < count < 320
    assert count + reader.skipped.counts[parsing.BROKEN_FRAME] <= 320
    assert reader.skipped.counts[ENDS_EARLY] == 1


def test_each_broken_part_is_counted_and_the_rest_ingested(tmp_path: Path) -> None:
    folder = as_video(tmp_path / "v")
    with (folder / "poses.txt").open("a") as lines:
        lines.write("1600000001.0 1 2 nan 0 0 0 1\n16000")
    with (folder / "detections.jsonl").open("a") as lines:
        lines.write('{"frame": 2, "category": "cup", "probability": 1, "box": [200, 5, 220, 9]}\n')
        lines.write('{"frame": 99, "category": "cup", "probability": 1, "box": [2, 5, 20, 9]}\n{')
    summary, store = taken(folder)
    assert summary.skipped.counts == {
        BROKEN_POSE: 2,
        OUTSIDE: 1,
        parsing.BROKEN_LINE: 1,
        "detection of an unknown frame": 1,
    }
    assert summary.frames == 8
    assert store.check() == []
    backwards = [(n, m.iso) for n, m in enumerate((*moments()[4:], *moments()[:4]))]
    write_csv(folder / "times.csv", ("frame", "time"), backwards)
    assert taken(folder)[0].skipped.counts["time runs backwards or stands still"] == 4


@pytest.mark.parametrize("content", [b"", b"not a video at all" * 100])
def test_what_is_no_video_says_so(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "tour.mp4").write_bytes(content)
    with pytest.raises(BadInput, match="no video that can be decoded"):
        open_source(tmp_path / "tour.mp4")


def test_its_outline_has_the_frames_without_decoding_them(tmp_path: Path) -> None:
    reader = open_source(as_video(tmp_path / "v"), options={"start": START})
    assert isinstance(reader, Outlined)
    assert isinstance(reader, Described)
    outline = [(f.name, f.time_ms, f.pose, f.detections) for f in reader.outline()]
    assert outline == [(f.name, f.time_ms, f.pose, f.detections) for f in reader]
    assert [s.count for s in reader.streams()] == [8, 8, 12]
    assert np.asarray(next(iter(reader)).image).shape == (48, 64, 3)
