"""A plain folder of pictures with times: the same store as the recording it holds."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
from PIL import Image

from d3a.ingest import ingest
from d3a.ingesting.preparation import BROKEN_PICTURE, OUTSIDE
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers import parsing
from d3a.readers.base import Described
from d3a.readers.beside import NO_POSE
from d3a.readers.clock import Clock
from d3a.readers.opening import open_source
from d3a.readers.pictures import NO_TIME, time_in_name
from d3a.readers.tracks import BROKEN_POSE, BROKEN_TIME
from tests.worlds.folders import (
    NAMED,
    as_recording,
    boxes_file,
    camera_file,
    dumped,
    found,
    moments,
    pictures,
    pose_lines,
    taken_by,
    write_csv,
)
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import depth_png, jpeg

taken = partial(taken_by, "PicturesReader")


def as_pictures(folder: Path, *, poses: bool = True, boxes: bool = True) -> Path:
    pictures(folder)
    rows = [(f"{m.name}.jpg", m.iso) for m in reversed(moments())]
    write_csv(folder / "times.csv", ("File Name", "Timestamp"), rows)
    if poses:
        (folder / "poses.txt").write_text(pose_lines())
        camera_file(folder)
    if boxes:
        boxes_file(folder)
    return folder


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_the_store_is_that_of_the_recording(tmp_path: Path, parameters: Parameters) -> None:
    plain, store = OracleStore(), OracleStore()
    ingest(open_source(as_recording(tmp_path / "r", depth=False)), plain, parameters)
    reader = open_source(as_pictures(tmp_path / "p"), zone="UTC", options=NAMED)
    assert type(reader).__name__ == "PicturesReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)


def test_poses_are_optional_and_boxes_may_be_a_table(tmp_path: Path) -> None:
    folder = as_pictures(tmp_path / "p", poses=False, boxes=False)
    with pytest.raises(BadInput, match="detector"):
        taken(folder)
    rows = [
        (f"images/{m.name}.jpg", r["category"], r["probability"], *r["box"])
        for m in moments()
        for r in found(m)
    ]
    header = ("image", "Label", "Score", "xmin", "ymin", "xmax", "ymax")
    write_csv(folder / "detections.csv", header, rows)
    summary, store = taken(folder)
    assert (summary.frames, summary.detections, summary.skipped.counts) == (8, 12, {})
    plain = OracleStore()
    ingest(
        open_source(as_recording(tmp_path / "r", depth=False, poses=False)),
        plain,
        DEFAULT,
    )
    camera_file(folder)
    assert dumped(taken(folder)[1]) == dumped(plain)
    assert len(store.objects()) == len(plain.objects())


def test_poses_are_taken_between_two(tmp_path: Path) -> None:
    folder = as_pictures(tmp_path / "p")
    lines = (folder / "poses.txt").read_text().splitlines()
    (folder / "poses.txt").write_text("\n".join(lines[:2] + lines[3:]) + "\n")
    poses = [frame.pose for frame in open_source(folder)]
    assert poses[1] is not None
    assert poses[1].position == pytest.approx((0.1, 0, 1))
    reader = open_source(folder, options={"pose-gap": "0.1"})
    assert [frame.pose is None for frame in reader] == [False, True, *[False] * 6]
    assert reader.skipped.counts == {NO_POSE: 1}


def test_each_broken_part_is_counted_and_the_rest_ingested(tmp_path: Path) -> None:
    folder = as_pictures(tmp_path / "p")
    a, b, c, d, *_ = moments()
    (folder / f"{a.name}.jpg").write_bytes(jpeg(40)[:300])
    (folder / f"{b.name}.jpg").write_bytes(b"")
    huge = bytearray(depth_png(1.0))
    huge[16:20] = (1_000_000).to_bytes(4, "big")
    (folder / f"{c.name}.jpg").write_bytes(huge)
    (folder / f"{d.name}.jpg").unlink()
    (folder / "later.jpg").write_bytes(jpeg(40))
    with (folder / "times.csv").open("a") as lines:
        lines.write("gone.jpg,nan\n../../passwd.jpg,2020-09-13T12:30:00Z\nlast.jpg\n")
        lines.write('"unfinished.jpg,2020-09-13T')
    with (folder / "poses.txt").open("a") as lines:
        lines.write("1600000001.0 1 2 inf 0 0 0 1\n1600000001.0 1 2\n")
    with (folder / "detections.jsonl").open("a") as lines:
        lines.write(f'{{"frame": "{a.name}", "category": "cup", "probability": 1, ')
        lines.write('"box": [200, 5, 220, 9]}\n{"frame": "')
    summary, store = taken(folder)
    assert summary.skipped.counts == {
        BROKEN_PICTURE: 3,
        parsing.MISSING_PICTURE: 1,
        NO_TIME: 1,
        BROKEN_TIME: 3,
        parsing.NO_FILE: 1,
        BROKEN_POSE: 2,
        NO_POSE: 1,
        OUTSIDE: 1,
        parsing.BROKEN_LINE: 1,
    }
    assert "is outside of the recording" in str(summary.skipped.examples)
    assert summary.frames == 9
    assert store.check() == []


@pytest.mark.parametrize(
    ("stem", "zone", "said"),
    [
        ("1600000000.500", None, 1_600_000_000_500),
        ("frame_1600000000500000000", None, 1_600_000_000_500),
        ("IMG_20240501_100000", "Europe/Berlin", 1714550400000),
        ("20240501T100000123", "Europe/Berlin", 1714550400123),
        ("img-0001", None, "holds no time"),
        ("1600000000_1600000001", None, "or two"),
        ("20240501-100000", None, "no offset"),
        ("20241301-100000", "UTC", "no time"),
    ],
)
def test_times_in_names(stem: str, zone: str | None, said: int | str) -> None:
    clock = Clock(zone)
    if isinstance(said, int):
        assert time_in_name(stem, clock) == said
    else:
        with pytest.raises(BadInput, match=said):
            time_in_name(stem, clock)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1600000000", 1_600_000_000_000),
        ("1.6e9", 1_600_000_000_000),
        ("1600000000123", 1_600_000_000_123),
        ("1600000000123456", 1_600_000_000_123),
        ("1600000000123456789", 1_600_000_000_123),
        ("1600000000.0005", 1_600_000_000_000),
        ("0.05", 946_684_800_050),
        ("2020-09-13T12:26:40Z", 1_600_000_000_000),
        ("2020-09-13 14:26:40+02:00", 1_600_000_000_000),
        ("nan", "time is nan"),
        ("-1", "before the start"),
        ("1e30", "no time since 1970"),
        ("noon", "ISO 8601"),
        ("2020-09-13T12:26:40", "--zone"),
    ],
)
def test_times_in_tables(text: str, expected: int | str) -> None:
    if isinstance(expected, int):
        assert Clock().ms(text) == expected
    else:
        with pytest.raises(BadInput, match=expected):
            Clock().ms(text)


def test_times_come_from_names_or_the_camera_only_where_told(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    pictures(folder)
    with pytest.raises(BadInput, match=r"no table of their times.*times=exif"):
        open_source(folder)
    named = [frame.time_ms for frame in open_source(folder, options={"times": "names"})]
    assert named == [each.time_ms for each in moments()]
    taken_at = folder / f"{moments()[0].name}.jpg"
    exif = Image.Exif()
    exif.get_ifd(0x8769)[0x9003] = "2024:05:01 10:00:00"
    Image.new("RGB", (64, 48)).save(taken_at, exif=exif)
    reader = open_source(folder, zone="Europe/Berlin", options={"times": "exif"})
    (frame,) = reader
    assert frame.time_ms == 1714550400000
    assert reader.skipped.counts == {BROKEN_TIME: 7}
    assert "does not say when" in reader.skipped.examples[BROKEN_TIME][0]


def test_it_tells_its_streams(tmp_path: Path) -> None:
    reader = open_source(as_pictures(tmp_path / "p"))
    assert isinstance(reader, Described)
    counts = {stream.name: (stream.kind, stream.count) for stream in reader.streams()}
    assert counts == {
        "p/": ("pictures", 8),
        "times.csv": ("times", 8),
        "poses.txt": ("poses", 8),
        "detections.jsonl": ("detections", 12),
    }
