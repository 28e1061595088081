"""ROS bags: the same store as the recording they hold, whatever ROS or storage wrote them."""

from __future__ import annotations

import json
import math
import sys
import tracemalloc
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from d3a.floor_map import FREE, OCCUPIED, UNKNOWN, stored_map
from d3a.ingest import ingest
from d3a.model import BadInput, Pose
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.beside import NO_POSE
from d3a.readers.opening import open_source
from d3a.readers.recording import BROKEN_MAP
from d3a.readers.ros_index import NO_STAMP
from d3a.readers.ros_vision import LAYOUTS
from d3a.readers.rosbag import NO_PICTURE, NOT_LOOKED
from d3a.teaching import put_map

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import BOXES, COLOUR, DEPTH, KINDS, Said, World, as_bag, moved, put, without
from tests.worlds.folders import NAMED, as_recording, dumped, found, moments, pose_lines, taken_by
from tests.worlds.oracle import OracleStore

taken = partial(taken_by, "RosbagReader")


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_store_is_that_of_the_recording(
    tmp_path: Path, parameters: Parameters, kind: str
) -> None:
    plain, store = OracleStore(), OracleStore()
    folder = as_recording(tmp_path / "r")
    if kind == "ros1":  # the bag names the detector's classes
        facts = json.loads((folder / "recording.json").read_text())
        (folder / "recording.json").write_text(json.dumps(facts | {"classes": ["cup", "bowl"]}))
    ingest(open_source(folder), plain, parameters)
    reader = open_source(as_bag(tmp_path / "b", kind), zone="UTC", options=NAMED)
    assert type(reader).__name__ == "RosbagReader"
    summary = ingest(reader, store, parameters)
    assert summary.skipped.counts == {}
    assert dumped(store) == dumped(plain)
    assert len(store.objects()) == 2


@pytest.mark.parametrize("layout", range(len(LAYOUTS)))
def test_a_bag_without_definitions_is_read_by_the_layout_that_fits(
    tmp_path: Path, layout: int
) -> None:
    world = World("sqlite", layout)
    bag = world.write(tmp_path / "b", world.recording(), defined=False)
    (plain,) = (list(open_source(as_recording(tmp_path / "r"))),)
    assert [f.detections for f in open_source(bag)] == [f.detections for f in plain]


@pytest.mark.parametrize("kind", KINDS)
def test_several_files_are_one_recording(tmp_path: Path, kind: str) -> None:
    world = World(kind, None if kind == "ros1" else 0)
    said = world.recording()
    middle = moments()[4].time_ms
    first = world.write(tmp_path / "one" / "a", [e for e in said if e.time_ms < middle])
    second = world.write(tmp_path / "two" / "b", [e for e in said if e.time_ms >= middle])
    folder = tmp_path / "both"
    folder.mkdir()
    for bag in (first, second):
        files = [bag] if bag.is_file() else [f for f in bag.iterdir() if f.suffix != ".yaml"]
        for file in files:
            file.rename(folder / file.name)
    whole = open_source(as_bag(tmp_path / "whole", kind))
    both = open_source(folder)
    assert list(both) == list(whole)
    assert (both.facts.name, both.facts.frames, both.skipped.counts) == ("both", 8, {})


def test_stamps_are_the_headers_and_not_the_recorders(tmp_path: Path) -> None:
    bag = as_bag(tmp_path / "b", "mcap")
    assert [f.time_ms for f in open_source(bag)] == [m.time_ms for m in moments()]
    received = [f.time_ms for f in open_source(bag, options={"stamps": "receive"})]
    assert received == []  # boxes come 180 ms after their picture: no one belongs to one
    wider = open_source(bag, options={"stamps": "receive", "pair-gap": "0.2"})
    assert [f.time_ms - m.time_ms for f, m in zip(wider, moments(), strict=True)] == [37] * 8


def test_a_message_without_a_stamp_is_left_out(tmp_path: Path) -> None:
    bag = World("mcap").write_changed(tmp_path / "b", moved(COLOUR, 2, 0), moved(BOXES, 3, 0))
    reader = open_source(bag)
    assert len(list(reader)) == 6
    assert reader.skipped.counts == {NO_STAMP: 1, NO_PICTURE: 2, NOT_LOOKED: 1}


def test_stamps_of_a_simulation_get_a_date_that_nobody_takes_for_real(tmp_path: Path) -> None:
    start = moments()[0].time_ms - 12_500
    world = World("sqlite")
    bag = world.write(tmp_path / "b", world.recording(earlier_ms=start))
    reader = open_source(bag)
    assert "unknown start" in reader.facts.notes[-1]
    assert [f.time_ms for f in reader][:2] == [946684812500, 946684813000]
    assert all(f.pose is not None and f.depth is not None for f in reader)
    dated = open_source(bag, options={"start": "2024-05-01T10:00:00+02:00"})
    assert dated.facts.notes == ()
    assert next(iter(dated)).time_ms == 1714550412500


def test_boxes_alone_are_frames_too(tmp_path: Path) -> None:
    reader = open_source(World("mcap").write_changed(tmp_path / "b", without(COLOUR, DEPTH)))
    frames = list(reader)
    assert {(f.image, f.depth) for f in frames} == {(None, None)}
    assert all(f.pose and f.camera and f.detections for f in frames)
    assert reader.skipped.counts == {}


def test_pictures_alone_wait_for_a_detector(tmp_path: Path) -> None:
    bag = as_bag(tmp_path / "b", "mcap")
    frames = list(open_source(bag, options={"topic.detections": "none"}))
    assert [f.detections for f in frames] == [None] * 8
    with pytest.raises(BadInput, match="needs a detector"):
        ingest(open_source(bag, options={"topic.detections": "none"}), OracleStore(), DEFAULT)


def test_pictures_that_the_detector_passed_over_are_not_said_to_be_empty(tmp_path: Path) -> None:
    said = [e for e in World("mcap").recording() if e.topic != BOXES or e.time_ms % 1000 == 0]
    reader = open_source(World("mcap").write(tmp_path / "b", said))
    assert reader.facts.frames == 4
    assert len(list(reader)) == 4
    assert reader.skipped.counts == {NOT_LOOKED: 4}


def test_class_numbers_get_their_names(tmp_path: Path) -> None:
    world = World("ros1", None)
    assert open_source(as_bag(tmp_path / "a", "ros1")).facts.classes == ("cup", "bowl")
    bag = world.write_changed(tmp_path / "b", without("/vision_info"))
    assert {d.category for f in open_source(bag) for d in f.detections or ()} == {"41", "45"}
    names = tmp_path / "coco.txt"
    names.write_text("\n".join(["thing"] * 41 + ["cup", "x", "x", "x", "bowl"]))
    reader = open_source(bag, options={"classes": str(names)})
    assert {d.category for f in reader for d in f.detections or ()} == {"cup", "bowl"}


def test_a_things_own_position_is_taken_where_the_detector_tells_it(tmp_path: Path) -> None:
    world = World("mcap")
    record = world.detection(found(moments()[1])[0])
    record.results[1].pose.pose.position.z = 2.0
    pixels = world.detection(found(moments()[1])[0])
    pixels.results[1].pose.pose.position.x = 320.0
    change = put(BOXES, 1, detections=[record, pixels])
    frames = list(open_source(world.write_changed(tmp_path / "b", change)))
    detection, other = frames[1].detections or ()
    assert other.position is None
    assert detection.position == pytest.approx((0.1, 0.0, 3.0))
    assert all(d.position is None for f in frames[2:] for d in f.detections or ())


@pytest.mark.parametrize("kind", KINDS)
def test_an_occupancy_grid_is_kept_as_the_map(tmp_path: Path, kind: str) -> None:
    world = World(kind, None if kind == "ros1" else 0)
    values = np.array([0, 100, -1, 20, 65, 40], np.int8)
    origin = world.pose(Pose((-1.5, 2.0, 0.0), (0.0, 0.0, 0.6, 0.8)))
    info = world.make("nav_msgs/MapMetaData", resolution=0.5, width=3, height=2, origin=origin)
    grid = {"info": info, "data": values}
    time_ms = moments()[0].time_ms
    older = {"info": info, "data": np.zeros(6, np.int8)}
    said = [
        Said("/map", "nav_msgs/OccupancyGrid", time_ms, older, "map"),
        Said("/map", "nav_msgs/OccupancyGrid", time_ms + 1000, grid, "map"),
        Said("/local_costmap/costmap", "nav_msgs/OccupancyGrid", time_ms, older, "odom"),
    ]
    bag = world.write(tmp_path / "b", [*world.recording(), *said])
    _, store = taken(bag)
    floor = stored_map(store)
    assert floor is not None
    assert floor.cells.tolist() == [[FREE, OCCUPIED, UNKNOWN], [FREE, OCCUPIED, UNKNOWN]]
    assert floor.resolution == pytest.approx(0.5)
    assert floor.origin == pytest.approx((-1.5, 2.0, 2 * math.atan2(0.6, 0.8)))
    odd = world.write(tmp_path / "c", [*world.recording(), replace(said[0], frame_id="floor2")])
    reader = open_source(odd)
    assert reader.facts.map is None
    assert "it is in floor2, and poses are in map" in str(reader.skipped.examples)


def test_the_map_of_a_recording_folder_is_kept_unless_the_store_has_one(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    facts = json.loads((folder / "recording.json").read_text())
    (folder / "recording.json").write_text(json.dumps(facts | {"map": "map.yaml"}))
    (folder / "map.pgm").write_bytes(b"P5 2 1 255\n" + bytes([0, 254]))
    yaml = "image: map.pgm\nresolution: 0.5\norigin: [0, 0, 0]\noccupied_thresh: 0.65\n"
    (folder / "map.yaml").write_text(yaml + "free_thresh: 0.25\n")
    store = OracleStore()
    ingest(open_source(folder), store, DEFAULT)
    floor = stored_map(store)
    assert floor is not None
    assert floor.cells.tolist() == [[OCCUPIED, FREE]]
    other = OracleStore()
    put_map(other, floor.to_json() | {"resolution": 0.25}, "by hand")
    ingest(open_source(folder), other, DEFAULT)
    kept = stored_map(other)
    assert kept is not None
    assert kept.resolution == 0.25
    (folder / "map.yaml").unlink()
    reader = open_source(folder)
    assert reader.facts.map is None
    assert len(list(reader)) == 8
    assert reader.skipped.counts == {BROKEN_MAP: 1}


def test_poses_of_a_table_go_before_those_of_tf(tmp_path: Path) -> None:
    bag = World("mcap").write_changed(tmp_path / "b", without("/tf"))
    table = tmp_path / "track.txt"
    table.write_text(pose_lines())
    reader = open_source(bag, options={"poses": str(table)})
    for frame, moment in zip(reader, moments(), strict=True):
        assert frame.pose is not None
        assert frame.pose.position == moment.pose[:3]
    assert reader.skipped.counts == {}
    table.write_text(pose_lines().replace(moments()[0].seconds, "1500000000"))
    strict = open_source(bag, options={"poses": str(table), "pose-gap": "0.4"})
    assert [frame.pose is None for frame in strict] == [True] + [False] * 7
    assert strict.skipped.counts == {NO_POSE: 1}


def test_without_the_extra_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = as_bag(tmp_path / "b", "mcap")
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(BadInput, match=r"pip install 'd3a\[ros\]'"):
        open_source(bag)


def test_pictures_are_read_one_by_one(tmp_path: Path) -> None:
    world = World("mcap")
    said = world.recording()
    side = np.zeros((400, 600, 3), np.uint8)
    for each in moments(200)[8:]:
        said += [world.info(each.time_ms), world.boxes(each.time_ms, [])]
        said.append(Said("/rgb/image", "sensor_msgs/Image", each.time_ms, world.raw("rgb8", side)))
    bag = world.write(tmp_path / "b", said)
    reader = open_source(bag, options={"topic.image": "/rgb/image", "topic.depth": "none"})
    tracemalloc.start()
    try:
        assert sum(1 for _ in reader) == 192
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 40e6  # 192 pictures are 138 MB, and a chunk of the file is at most some MB
