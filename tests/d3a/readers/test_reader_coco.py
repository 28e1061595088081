"""COCO results with a list of images and a table of times: the same store, boxes never guessed."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from d3a.ingest import ingest
from d3a.ingesting.preparation import BROKEN_PICTURE, OUTSIDE
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers import parsing
from d3a.readers.base import Described
from d3a.readers.coco import CERTAIN_NOTE, CUT_OFF, NO_TIME, UNKNOWN_IMAGE
from d3a.readers.opening import open_source
from tests.worlds.folders import (
    NAMED,
    as_recording,
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
from tests.worlds.rounds import depth_png

taken = partial(taken_by, "CocoReader")
CATEGORIES = [{"id": 47, "name": "cup"}, {"id": 51, "name": "bowl"}]


def results(layout: str = "xywh") -> list[dict[str, Any]]:
    rows = []
    for number, moment in enumerate(moments()):
        for row in found(moment):
            x1, y1, x2, y2 = row["box"]
            box = [x1, y1, x2 - x1, y2 - y1] if layout == "xywh" else [x1, y1, x2, y2]
            category = next(c["id"] for c in CATEGORIES if c["name"] == row["category"])
            rows.append({"image_id": number, "category_id": category, "bbox": box})
            rows[-1]["score"] = row["probability"]
    return rows


def images(size: bool = True) -> list[dict[str, Any]]:
    sized = {"width": 64, "height": 48} if size else {}
    return [
        {"id": n, "file_name": f"{m.name}.jpg", "date_captured": m.iso} | sized
        for n, m in enumerate(moments())
    ]


def as_coco(folder: Path, layout: str = "xywh", *, size: bool = True) -> Path:
    pictures(folder / "images")
    camera_file(folder)
    (folder / "results.json").write_text(json.dumps(results(layout)))
    listed = {"images": images(size), "categories": CATEGORIES}
    (folder / "images.json").write_text(json.dumps(listed))
    write_csv(folder / "times.csv", ("file_name", "time"), [(m.name, m.iso) for m in moments()])
    (folder / "poses.txt").write_text(pose_lines())
    return folder


def plain_store(tmp_path: Path, parameters: Parameters = DEFAULT) -> OracleStore:
    folder = as_recording(tmp_path / "r", depth=False)
    facts = json.loads((folder / "recording.json").read_text())
    facts["classes"] = ["bowl", "cup"]
    (folder / "recording.json").write_text(json.dumps(facts))
    store = OracleStore()
    ingest(open_source(folder), store, parameters)
    return store


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_the_store_is_that_of_the_recording(tmp_path: Path, parameters: Parameters) -> None:
    store = OracleStore()
    reader = open_source(as_coco(tmp_path / "c"), zone="UTC", options=NAMED)
    assert type(reader).__name__ == "CocoReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert reader.facts.notes == ()
    assert dumped(store) == dumped(plain_store(tmp_path, parameters))
    assert store.meta("classes") == ["bowl", "cup"]


@pytest.mark.parametrize("size", [True, False], ids=["sizes listed", "sizes from the pictures"])
def test_two_corners_are_told_by_boxes_that_would_leave_their_picture(
    tmp_path: Path, size: bool
) -> None:
    folder = as_coco(tmp_path / "c", "xyxy", size=size)
    (note,) = open_source(folder).facts.notes
    assert "two corners: 4 of 12 would leave" in note
    assert dumped(taken(folder)[1]) == dumped(plain_store(tmp_path))


def test_boxes_that_may_be_either_are_asked_for(tmp_path: Path) -> None:
    folder = as_coco(tmp_path / "c")
    either = [r | {"bbox": [5, 5, 20, 20]} for r in results()]
    (folder / "results.json").write_text(json.dumps(either))
    with pytest.raises(BadInput, match=r"0 of 12 boxes.*box=xyxy"):
        open_source(folder)
    for said, box in (("xywh", (5, 5, 25, 25)), ("xyxy", (5, 5, 20, 20))):
        frame = next(iter(open_source(folder, options={"box": said})))
        assert [d.box for d in frame.detections or ()] == [box]
    torn = [r | {"bbox": [30, 5, 20, 20]} for r in results()[:6]] + results("xyxy")[6:]
    (folder / "results.json").write_text(json.dumps(torn))
    with pytest.raises(BadInput, match="speak against"):
        open_source(folder)


def test_a_list_of_another_machine_is_found_by_its_files_names(tmp_path: Path) -> None:
    folder = as_coco(tmp_path / "c", "xyxy")
    listed = [{"id": i["id"], "file_name": f"/home/robot/{i['file_name']}"} for i in images()]
    text = json.dumps({"images": listed, "categories": CATEGORIES})
    (folder / "images.json").write_text(text)
    assert dumped(taken(folder)[1]) == dumped(plain_store(tmp_path))
    for picture in (folder / "images").iterdir():
        picture.unlink()
    with pytest.raises(BadInput, match="nothing tells the size of a picture"):
        open_source(folder)


def test_one_file_may_hold_all_and_dates_be_taken_from_it(tmp_path: Path) -> None:
    folder = as_coco(tmp_path / "c")
    whole = {"images": images(), "categories": CATEGORIES, "annotations": results()}
    for name in ("results.json", "images.json", "times.csv"):
        (folder / name).unlink()
    (folder / "kitchen.json").write_text(json.dumps(whole))
    with pytest.raises(BadInput, match="times=date_captured"):
        open_source(folder / "kitchen.json")
    for times in ("date_captured", "names"):
        _, store = taken(folder / "kitchen.json", times=times)
        assert dumped(store) == dumped(plain_store(tmp_path))
    bare = [{k: v for k, v in row.items() if k != "score"} for row in results()]
    whole["annotations"] = bare
    (folder / "kitchen.json").write_text(json.dumps(whole))
    reader = open_source(folder / "kitchen.json", options={"times": "names"})
    assert reader.facts.notes == (CERTAIN_NOTE,)
    assert {d.probability for frame in reader for d in frame.detections or ()} == {1.0}


def test_each_broken_part_is_counted_and_the_rest_ingested(tmp_path: Path) -> None:
    folder = as_coco(tmp_path / "c")
    a, b, c, *_ = moments()
    (folder / "images" / f"{a.name}.jpg").write_bytes(b"")
    (folder / "images" / f"{b.name}.jpg").unlink()
    huge = bytearray(depth_png(1.0))
    huge[16:20] = (1_000_000).to_bytes(4, "big")
    (folder / "images" / f"{c.name}.jpg").write_bytes(huge)
    first = results()[0]
    broken: list[Any] = [
        first | {"image_id": 99},
        first | {"category_id": 3},
        first | {"bbox": [1, 2, float("nan"), 4]},
        first | {"bbox": [1, 2]},
        first | {"bbox": [200, 5, 20, 4]},
        first | {"score": 7},
        "no object",
    ]
    text = json.dumps([*results(), *broken])
    (folder / "results.json").write_text(text[:-1] + ', {"image_id": 3, "cat')
    listed = {"images": [*images(), {"id": 8}, {"id": 9, "file_name": "late.jpg"}, 7]}
    (folder / "images.json").write_text(json.dumps(listed | {"categories": CATEGORIES}))
    with (folder / "times.csv").open("a") as lines:
        lines.write("gone.jpg,never\n")
    summary, store = taken(folder)
    assert summary.skipped.counts == {
        BROKEN_PICTURE: 2,
        parsing.MISSING_PICTURE: 1,
        UNKNOWN_IMAGE: 1,
        parsing.BROKEN_DETECTION: 5,
        OUTSIDE: 1,
        CUT_OFF: 1,
        NO_TIME: 1,
        parsing.BROKEN_FRAME: 2,
        "broken time": 1,
    }
    assert "after result 18" in summary.skipped.examples[CUT_OFF][0]
    assert summary.frames == 8
    assert store.check() == []


def test_what_is_missing_is_said(tmp_path: Path) -> None:
    folder = as_coco(tmp_path / "c")
    (folder / "images.json").unlink()
    with pytest.raises(BadInput, match="put their list"):
        open_source(folder)
    (folder / "images.json").write_text("{")
    with pytest.raises(BadInput, match=r"images\.json is not JSON"):
        open_source(folder)
    (folder / "images.json").write_text("{}")
    with pytest.raises(BadInput, match="no array `images`"):
        open_source(folder)


def test_it_tells_its_streams(tmp_path: Path) -> None:
    reader = open_source(as_coco(tmp_path / "c"))
    assert isinstance(reader, Described)
    counts = {stream.name: stream.count for stream in reader.streams()}
    assert counts == {"results.json": 12, "images": 8, "poses.txt": 8}
