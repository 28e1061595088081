"""Bags with something wrong: a clear sentence, counted, and the rest ingested."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from d3a.ingest import IngestSummary, ingest
from d3a.ingesting.preparation import BROKEN_DEPTH, BROKEN_PICTURE, OTHER_CAMERA, OUTSIDE
from d3a.ingesting.survey import lacks, survey
from d3a.model import BadInput, Pose
from d3a.parameters import DEFAULT
from d3a.readers import parsing, rosbag
from d3a.readers.base import Described
from d3a.readers.opening import open_source
from d3a.readers.ros_bag import CUT
from d3a.readers.ros_index import BROKEN_MESSAGE, BROKEN_TRANSFORM, NO_CALIBRATION, NO_STAMP
from d3a.readers.rosbag import NO_DEPTH, NO_WAY, NOT_LOOKED
from d3a.readers.tracks import BROKEN_POSE

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import (
    BOXES,
    COLOUR,
    DEPTH,
    INFO,
    KINDS,
    LINK,
    Said,
    World,
    as_bag,
    base_of,
    put,
    without,
)
from tests.worlds.folders import found, moments
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, jpeg

WORLD = World("mcap")


def taken(bag: Path, **options: str) -> tuple[IngestSummary, OracleStore]:
    store = OracleStore()
    summary = ingest(open_source(bag, zone="UTC", options=options), store, DEFAULT)
    assert store.check() == []
    return summary, store


def bytes_of(content: bytes) -> Any:
    return np.frombuffer(content, np.uint8)


def test_a_bag_without_pictures_and_boxes_says_what_it_has(tmp_path: Path) -> None:
    bag = WORLD.write_changed(tmp_path / "b", without(COLOUR, DEPTH, BOXES))
    with pytest.raises(BadInput, match=r"no topic with pictures.*it has /camera/color/camera_info"):
        open_source(bag)


@pytest.mark.parametrize(
    ("topic", "part"), [(DEPTH, "depth"), (INFO, "camera"), (COLOUR, "image"), ("/tf", "pose")]
)
def test_each_topic_that_is_missing_is_told_with_its_cost(
    tmp_path: Path, topic: str, part: str
) -> None:
    bag = WORLD.write_changed(tmp_path / "b", without(topic))
    reader = open_source(bag)
    seen = survey(reader)
    assert seen.having[part] == 0
    assert seen.having["detections"] == 8
    assert all(lack.cost for lack in lacks(seen))
    if topic == "/tf":
        assert any("no transform leads from map" in note for note in seen.facts.notes)
    summary, store = taken(bag)
    assert summary.frames == 8
    assert len(store.objects()) == 2


def test_a_camera_that_is_not_calibrated_is_counted_and_can_be_told(tmp_path: Path) -> None:
    bag = WORLD.write_changed(tmp_path / "b", put(INFO, None, k=np.zeros(9)))
    reader = open_source(bag)
    assert [f.camera for f in reader] == [None] * 8
    assert reader.skipped.counts == {NO_CALIBRATION: 1}
    assert "not calibrated" in str(reader.skipped.examples)
    said = open_source(bag, options={"camera": "50,50,32,24"})
    assert {f.camera for f in said} == {CAMERA}


def test_a_camera_of_another_size_is_resized_or_left(tmp_path: Path) -> None:
    double = put(
        INFO, None, width=128, height=96, k=np.array([100.0, 0, 64.5, 0, 100, 48.5, 0, 0, 1])
    )
    assert {f.camera for f in open_source(WORLD.write_changed(tmp_path / "a", double))} == {CAMERA}
    cropped = WORLD.write_changed(tmp_path / "b", put(INFO, None, width=128, height=48))
    summary, _ = taken(cropped)
    assert summary.skipped.counts[OTHER_CAMERA] == 8
    assert summary.frames == 8


def test_pictures_depth_and_boxes_that_are_broken(tmp_path: Path) -> None:
    a, b, c, d, e, f, g, h = range(8)
    small = np.full((24, 32), 2000, "<u2")
    nan = found(moments()[f])[0] | {"box": [float("nan"), 1, 2, 3]}
    outside = found(moments()[g])[0] | {"box": [200, 5, 220, 9]}
    nameless = WORLD.make("vision_msgs/Detection2D")
    bag = WORLD.write_changed(
        tmp_path / "b",
        put(COLOUR, a, data=bytes_of(jpeg(40)[:300])),
        put(COLOUR, b, data=bytes_of(b"")),
        put(COLOUR, c, data=bytes_of(wide_png())),
        put(DEPTH, d, **WORLD.raw("16UC1", small)),
        put(DEPTH, e, data=np.zeros(10, np.uint8)),
        put(BOXES, f, detections=[WORLD.detection(nan)]),
        put(BOXES, g, detections=[WORLD.detection(outside)]),
        put(BOXES, h, detections=[nameless, WORLD.detection(found(moments()[h])[0])]),
    )
    summary, _ = taken(bag)
    assert summary.skipped.counts == {
        BROKEN_PICTURE: 3,
        BROKEN_DEPTH: 2,
        parsing.BROKEN_DETECTION: 2,
        OUTSIDE: 1,
    }
    examples = str(summary.skipped.examples)
    assert "too large to decode: 1000000 x 1 pixels" in examples
    assert "the file is empty" in examples
    assert "not of the picture's size" in examples
    assert (rosbag.BROKEN_PICTURE, rosbag.BROKEN_DEPTH) == (BROKEN_PICTURE, BROKEN_DEPTH)
    assert summary.frames == 8


def wide_png() -> bytes:
    import cv2

    fine, buffer = cv2.imencode(".png", np.zeros((1, 1_000_000), np.uint8))
    assert fine
    return bytes(buffer)


def test_a_raw_picture_a_million_pixels_wide_is_refused(tmp_path: Path) -> None:
    wide = WORLD.raw("mono8", np.zeros((1, 1_000_000), np.uint8))
    said = [
        Said("/wide", "sensor_msgs/Image", moments()[n].time_ms, wide, "camera_color_optical_frame")
        for n in range(8)
    ]
    summary, store = taken(
        WORLD.write_changed(tmp_path / "b", more=tuple(said)),
        **{"topic.image": "/wide", "topic.depth": "none"},
    )
    assert summary.skipped.counts == {BROKEN_PICTURE: 8}
    assert summary.frames == 8
    assert len(store.objects()) == 2


def test_time_that_runs_backwards(tmp_path: Path) -> None:
    early, late = moments()[1].time_ms, moments()[5].time_ms
    back = {COLOUR, DEPTH, BOXES}
    bag = WORLD.write_changed(
        tmp_path / "b",
        lambda said: (
            replace(said, time_ms=early - 100, late_ms=late - early + 100)
            if said.topic in back and said.time_ms == late
            else said
        ),
    )
    summary, _ = taken(bag)
    assert sum(summary.skipped.counts.values()) == 1
    assert "backwards" in next(iter(summary.skipped.counts))
    assert summary.frames == 7


def test_a_gap_in_tf_costs_the_poses_of_that_time(tmp_path: Path) -> None:
    first, last = moments()[2].time_ms, moments()[5].time_ms
    bag = WORLD.write_changed(
        tmp_path / "b",
        lambda said: None if said.topic == "/tf" and first <= said.time_ms <= last else said,
    )
    reader = open_source(bag, options={"pose-hold": "0.6"})
    assert [f.pose is None for f in reader] == [False] * 3 + [True, True] + [False] * 3
    assert reader.skipped.counts == {NO_WAY: 2}
    assert "(map -> odom)" in reader.skipped.examples[NO_WAY][0]
    assert taken(bag)[0].frames == 8
    wide = open_source(bag, options={"pose-gap": "3"})
    assert [f.pose and f.pose.position[0] for f in wide] == pytest.approx(
        [m.pose[0] for m in moments()]
    )


def test_transforms_and_poses_with_nan(tmp_path: Path) -> None:
    broken = WORLD.tf(moments()[3].time_ms, "odom", "base_link", base_of(moments()[3]))
    broken.fields["transforms"][0].transform.translation.x = float("nan")
    turned = WORLD.tf(moments()[3].time_ms, "odom", "base_link", base_of(moments()[3]))
    turned.fields["transforms"][0].transform.rotation.w = 0.0
    for axis in "xyz":
        setattr(turned.fields["transforms"][0].transform.rotation, axis, 0.0)
    unset = WORLD.tf(0, "odom", "base_link", base_of(moments()[3]))
    place = WORLD.make("geometry_msgs/PoseWithCovariance", pose=WORLD.pose(base_of(moments()[0])))
    place.pose.position.y = float("inf")
    odometry = Said(
        "/odom",
        "nav_msgs/Odometry",
        moments()[0].time_ms,
        {"pose": place, "child_frame_id": "base_link"},
        "odom",
    )
    bag = WORLD.write_changed(tmp_path / "b", more=(broken, turned, unset, odometry))
    reader = open_source(bag)
    assert all(f.pose is not None for f in reader)
    assert reader.skipped.counts == {BROKEN_TRANSFORM: 2, NO_STAMP: 1, BROKEN_POSE: 1}


def test_odometry_in_place_of_tf_with_its_covariance(tmp_path: Path) -> None:
    said = []
    for each in moments():
        pose = WORLD.make("geometry_msgs/PoseWithCovariance", pose=WORLD.pose(base_of(each)))
        pose.covariance = np.diag([0.04, 0.09, 0, 0, 0, 0.01]).ravel()
        fields = {"pose": pose, "child_frame_id": "base_link"}
        said.append(Said("/odom", "nav_msgs/Odometry", each.time_ms, fields, "map"))
    reader = open_source(WORLD.write_changed(tmp_path / "b", without("/tf"), more=tuple(said)))
    for frame, moment in zip(reader, moments(), strict=True):
        assert frame.pose is not None
        assert frame.pose.position == pytest.approx(moment.pose[:3])
        assert abs(frame.pose.quaternion[3]) == pytest.approx(1)
        assert frame.pose.covariance is not None
        got = np.reshape(frame.pose.covariance, (6, 6)).diagonal()
        # the base lies below and behind the camera along the axes the map has here
        lever = np.array(frame.pose.position) - np.array(base_of(moment).position)
        assert np.hypot(*lever[[1, 2]]) == pytest.approx(np.hypot(*LINK.position[::2]))
        assert got[:2].tolist() == pytest.approx(
            [0.04 + 0.01 * lever[1] ** 2, 0.09 + 0.01 * lever[0] ** 2]
        )
    assert isinstance(reader, Described)
    assert "base_link (by /odom)" in [link.child for link in reader.links()]


def test_messages_that_cannot_be_read_are_counted(tmp_path: Path) -> None:
    bag = as_bag(tmp_path / "b", "sqlite")
    import sqlite3

    (file,) = bag.glob("*.db3")
    database = sqlite3.connect(file)
    for topic in (BOXES, "/tf", DEPTH, COLOUR):
        database.execute(
            "UPDATE messages SET data = substr(data, 1, 60) WHERE id = (SELECT max(messages.id) "
            "FROM messages JOIN topics ON topic_id = topics.id WHERE name = ?)",
            (topic,),
        )
    database.commit()
    database.close()
    reader = open_source(bag)
    frames = list(reader)
    assert len(frames) == 7  # nobody knows what the detector said of the last one
    assert reader.skipped.counts[BROKEN_MESSAGE] == 2
    assert "/detections" in str(reader.skipped.examples)


@pytest.mark.parametrize("share", [0.45, 0.8])
@pytest.mark.parametrize("kind", KINDS)
def test_a_bag_that_was_cut_off_is_read_as_far_as_it_goes(
    tmp_path: Path, kind: str, share: float
) -> None:
    world = World(kind, None if kind == "ros1" else 0)
    noise = np.random.default_rng(0).integers(0, 255, (240, 320, 3), np.uint8)
    said = [each for each in world.recording() if each.topic != "/tf_static"]
    said += world.fixed(moments()[0].time_ms)
    for each in moments(60):
        said += [] if each.time_ms <= moments()[-1].time_ms else world.of_moment(each)
        picture = world.raw("rgb8", noise)
        said.append(Said("/big", "sensor_msgs/Image", each.time_ms, picture))
    said = [
        replace(e, time_ms=moments()[0].time_ms) if e.topic == "/tf_static" else e for e in said
    ]
    bag = world.write(tmp_path / "b", said)
    file = bag if bag.is_file() else next(f for f in bag.iterdir() if f.suffix != ".yaml")
    with file.open("r+b") as content:
        content.truncate(int(file.stat().st_size * share))
    summary, _ = taken(bag, **{"topic.image": COLOUR})
    assert summary.skipped.counts[CUT] >= 1
    assert file.name in summary.skipped.examples[CUT][0]
    assert 60 * share - 12 < summary.frames <= 60 * share + 2


@pytest.mark.parametrize("kind", ["sqlite", "mcap"])
def test_a_bag_whose_recorder_was_killed_has_no_metadata(tmp_path: Path, kind: str) -> None:
    bag = as_bag(tmp_path / "b", kind)
    whole = list(open_source(bag))
    (bag / "metadata.yaml").unlink()
    assert list(open_source(bag)) == whole
    (file,) = bag.iterdir()
    assert list(open_source(file)) == whole
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: [")
    damaged = open_source(bag)
    assert list(damaged) == whole


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("content", [b"", b"x", b"no bag at all" * 9])
def test_a_file_that_is_no_bag_is_said_to_be_none(
    tmp_path: Path, kind: str, content: bytes
) -> None:
    bag = as_bag(tmp_path / "b", kind)
    file = bag if bag.is_file() else next(f for f in bag.iterdir() if f.suffix != ".yaml")
    file.write_bytes(content)
    with pytest.raises(BadInput, match="no message that can be read"):
        open_source(bag)


def test_a_broken_file_among_several_costs_itself_alone(tmp_path: Path) -> None:
    folder = tmp_path / "both"
    folder.mkdir()
    shutil.move(as_bag(tmp_path / "b", "ros1"), folder / "a.bag")
    (folder / "b.bag").write_bytes(b"#ROSBAG V2.0\nxxxx")
    reader = open_source(folder)
    assert len(list(reader)) == 8
    assert list(reader.skipped.counts) == [CUT]


def test_depth_of_another_place_is_said_to_be(tmp_path: Path) -> None:
    bag = WORLD.write_changed(
        tmp_path / "b",
        lambda said: (
            replace(said, frame_id="camera_depth_optical_frame") if said.topic == DEPTH else said
        ),
    )
    (note,) = open_source(bag).facts.notes
    assert "depth is seen from camera_depth_optical_frame" in note


def test_a_bent_lens_is_said_to_be(tmp_path: Path) -> None:
    bag = WORLD.write_changed(tmp_path / "b", put(INFO, None, d=np.array([0.31, -0.1])))
    (note,) = open_source(bag).facts.notes
    assert "bends the picture (coefficients up to 0.31)" in note


def test_depth_and_boxes_of_other_times_belong_to_no_picture(tmp_path: Path) -> None:
    moved = {DEPTH: 2, BOXES: 3}
    bag = WORLD.write_changed(
        tmp_path / "b",
        lambda said: (
            replace(said, time_ms=said.time_ms + 100)
            if said.topic in moved and said.time_ms == moments()[moved[said.topic]].time_ms
            else said
        ),
    )
    reader = open_source(bag)
    assert len(list(reader)) == 7
    assert reader.skipped.counts == {NO_DEPTH: 1, NOT_LOOKED: 1, rosbag.NO_PICTURE: 1}


def test_it_tells_its_topics_and_its_tree(tmp_path: Path) -> None:
    reader = open_source(WORLD.write_changed(tmp_path / "b"))
    assert isinstance(reader, Described)
    streams = {stream.name: stream for stream in reader.streams()}
    assert {s.kind for s in streams.values()} >= {
        "pictures (sensor_msgs/CompressedImage)",
        "depth (sensor_msgs/Image)",
        "boxes (vision_msgs/Detection2DArray)",
        "transforms (tf2_msgs/TFMessage)",
    }
    assert streams[COLOUR].first_ms == moments()[0].time_ms
    assert (streams["/tf"].count, streams["/tf_static"].spans) == (16, False)
    seen = survey(reader)
    assert seen.having["located"] == 8
    assert [(link.parent, link.child, link.is_fixed) for link in seen.links] == [
        ("base_link", "camera_link", True),
        ("camera_link", "camera_color_optical_frame", True),
        ("map", "odom", False),
        ("odom", "base_link", False),
    ]
    assert [lack.what for lack in lacks(seen)] == ["a time zone", "the detector's list of classes"]


def test_a_pose_stamped_and_no_tf_is_a_robots_that_looks_ahead(tmp_path: Path) -> None:
    said = []
    for each in moments():
        fields = {"pose": WORLD.pose(Pose((each.pose[0], 0, 0), (0, 0, 0, 1)))}
        said.append(Said("/pose", "geometry_msgs/PoseStamped", each.time_ms, fields, "map"))
    bag = WORLD.write_changed(tmp_path / "b", without("/tf", "/tf_static"), more=tuple(said))
    reader = open_source(bag)
    assert any("pose-of=FRAME" in note for note in reader.facts.notes)
    first = next(iter(reader)).pose
    assert first is not None
    assert np.abs(first.quaternion) == pytest.approx([0.5] * 4)
    own = open_source(bag, options={"pose-of": "camera_color_optical_frame"})
    pose = next(iter(own)).pose
    assert pose is not None
    assert pose.quaternion == (0, 0, 0, 1)
