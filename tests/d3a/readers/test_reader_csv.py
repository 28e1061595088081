"""A detection a row: the same store as the recording it holds, under other column names too."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import pytest

from d3a.ingest import ingest
from d3a.ingesting.preparation import BROKEN_DEPTH, BROKEN_PICTURE, OUTSIDE
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers import parsing
from d3a.readers.base import Described
from d3a.readers.opening import open_source
from d3a.readers.tracks import BROKEN_POSE
from tests.worlds.folders import (
    NAMED,
    as_recording,
    camera_file,
    depths,
    dumped,
    found,
    moments,
    pictures,
    taken_by,
    write_csv,
)
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import depth_png

taken = partial(taken_by, "CsvReader")
PLAIN = ("frame", "time", "image", "depth", "category", "probability", "x1", "y1", "x2", "y2")
POSE = tuple(f"pose_{name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw"))
OTHER = ("Frame ID", "Timestamp", "file_name", "depth-file", "Label", "confidence")
OTHER_BOXES = {
    "corners": ("left", "top", "right", "bottom"),
    "size": ("xmin", "ymin", "width", "height"),
    "centre": ("x_center", "y_center", "w", "h"),
    "asked": ("x", "y", "w", "h"),
    "one": ("bbox",),
}


def numbers(kind: str, box: list[float]) -> list[Any]:
    x1, y1, x2, y2 = box
    written: dict[str, list[Any]] = {
        "corners": box,
        "size": [x1, y1, x2 - x1, y2 - y1],
        "centre": [(x1 + x2) / 2, (y1 + y2) / 2, x2 - x1, y2 - y1],
        "asked": [x1, y1, x2 - x1, y2 - y1],
        "one": [str([x1, y1, x2 - x1, y2 - y1])],
    }
    return written[kind]


def as_csv(
    folder: Path, header: tuple[str, ...] = PLAIN, kind: str = "corners", stamp: str = "iso"
) -> Path:
    pictures(folder / "images")
    depths(folder / "depth", 1000.0)
    camera_file(folder)
    rows = [
        (
            *(m.name, getattr(m, stamp), f"images/{m.name}.jpg", f"depth/{m.name}.png"),
            *(row["category"], row["probability"], *numbers(kind, row["box"]), *m.pose),
        )
        for m in moments()
        for row in found(m)
    ]
    write_csv(folder / "detections.csv", (*header, *POSE), rows)
    return folder


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_the_store_is_that_of_the_recording(tmp_path: Path, parameters: Parameters) -> None:
    plain, store = OracleStore(), OracleStore()
    ingest(open_source(as_recording(tmp_path / "r")), plain, parameters)
    folder = as_csv(tmp_path / "c")
    reader = open_source(folder, zone="UTC", options=NAMED)
    assert type(reader).__name__ == "CsvReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)


@pytest.mark.parametrize("kind", OTHER_BOXES)
@pytest.mark.parametrize("stamp", ["time_ms", "seconds"])
def test_other_names_and_boxes_give_the_same_store(tmp_path: Path, kind: str, stamp: str) -> None:
    plain = OracleStore()
    ingest(open_source(as_recording(tmp_path / "r")), plain, DEFAULT)
    folder = as_csv(tmp_path / "c", (*OTHER, *OTHER_BOXES[kind]), kind, stamp)
    if kind in ("asked", "one"):
        with pytest.raises(BadInput, match=r"box=xyxy .two corners.*box=cxcywh"):
            taken(folder)
        summary, store = taken(folder / "detections.csv", box="xywh")
    else:
        summary, store = taken(folder / "detections.csv")
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)


def test_positions_frames_without_detections_and_semicolons(tmp_path: Path) -> None:
    table = tmp_path / "seen.csv"
    table.write_text(
        "# made by hand\n"
        "t;class;score;xmin;ymin;xmax;ymax;x;y;z\n"
        "2024-05-01T10:00:00+02:00;cup;0.9;1;2;30;40;1;2;3\n"
        "2024-05-01T10:00:05+02:00;;;;;;;;;\n"
        "2024-05-01T10:00:09+02:00;bowl;0.9;1;2;30;40;;;\n"
    )
    reader = open_source(table)
    first, second, third = reader
    assert [d.position for d in first.detections or ()] == [(1.0, 2.0, 3.0)]
    assert second.detections == ()
    assert [d.position for d in third.detections or ()] == [None]
    assert (reader.facts.name, reader.facts.frames, reader.skipped.counts) == ("seen", 3, {})


def test_pictures_are_found_beside_and_times_may_be_another_table(tmp_path: Path) -> None:
    folder = as_csv(tmp_path / "c")
    lines = (folder / "detections.csv").read_text().splitlines()
    kept = [",".join([each.split(",")[0], *each.split(",")[4:10]]) for each in lines]
    (folder / "detections.csv").write_text("\n".join(kept) + "\n")
    write_csv(folder / "when.csv", ("frame", "time"), [(m.name, m.iso) for m in moments()])
    with pytest.raises(BadInput, match="no column for the time"):
        open_source(folder, format="csv")
    with pytest.raises(BadInput, match="no such file"):
        open_source(folder / "detections.csv", options={"times": "then.csv"})
    frames = list(open_source(folder / "detections.csv", options={"times": "when.csv"}))
    assert [frame.time_ms for frame in frames] == [each.time_ms for each in moments()]
    assert all(frame.image is not None for frame in frames)


def test_each_broken_row_is_counted_and_the_rest_ingested(tmp_path: Path) -> None:
    folder = as_csv(tmp_path / "c")
    a, b, c, d, e, f, *_ = moments()
    (folder / "images" / f"{a.name}.jpg").write_bytes(b"")
    (folder / "images" / f"{b.name}.jpg").unlink()
    huge = bytearray(depth_png(1.0))
    huge[16:20] = (1_000_000).to_bytes(4, "big")
    (folder / "images" / f"{c.name}.jpg").write_bytes(huge)
    (folder / "depth" / f"{d.name}.png").write_bytes(depth_png(2.0, 32, 24))
    table = folder / "detections.csv"
    text = table.read_text().replace(f"{e.name}.jpg,depth/{e.name}", f"{e.name}.jpg,../{e.name}", 1)
    rows = text.splitlines()
    at = next(n for n, row in enumerate(rows) if row.startswith(f.name))
    rows[at] = rows[at].rpartition(",")[0] + ",nan"
    rows[at + 1] = rows[at + 1].rpartition(",")[0] + ",nan"
    sound = rows[1].split(",")
    for place, value in ((1, "soon"), (4, "\x1b"), (5, "1.5"), (6, "nan"), (8, "1"), (8, "900")):
        broken = list(sound)
        broken[place] = value
        broken[0] = f"{a.name}" if place != 1 else "other"
        broken[6] = "800" if value == "900" else broken[6]
        rows.append(",".join(broken))
    rows.append("1600000009.0,2020-0")
    table.write_text("\n".join(rows))
    summary, store = taken(folder)
    assert summary.skipped.counts == {
        BROKEN_PICTURE: 2,
        parsing.MISSING_PICTURE: 1,
        BROKEN_DEPTH: 1,
        parsing.NO_FILE: 1,
        BROKEN_POSE: 1,
        parsing.BROKEN_DETECTION: 6,
        OUTSIDE: 1,
    }
    assert summary.frames == 8
    assert store.check() == []


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("time,category,x1,y1,x2,y2", "lacks the columns probability"),
        ("category,probability,x1,y1,x2,y2", "no column for the time"),
        ("time,category,probability,x1,y1", "lacks the columns of a box"),
        ("time,timestamp,category,probability,x1,y1,x2,y2", "two columns for the time"),
        ("", "is empty"),
        ("1,2,3", "no column for the time"),
    ],
)
def test_a_table_that_cannot_be_read_says_why(tmp_path: Path, header: str, said: str) -> None:
    table = tmp_path / "t.csv"
    table.write_text(header + "\n")
    with pytest.raises(BadInput, match=said):
        open_source(table)


def test_an_unknown_column_is_named_once(tmp_path: Path) -> None:
    table = tmp_path / "t.csv"
    table.write_text(
        "time,category,probability,x1,y1,x2,y2,mood\n1600000000,cup,1,1,2,30,40,good\n"
    )
    reader = open_source(table)
    (frame,) = reader
    assert len(frame.detections or ()) == 1
    assert reader.skipped.counts == {"unknown column in t.csv: mood": 1}
    assert isinstance(reader, Described)
    assert [(s.name, s.count) for s in reader.streams()] == [("t.csv", 1)]
