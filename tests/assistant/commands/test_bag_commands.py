"""`d3a doctor` and `d3a ingest` on a ROS bag, as a person calls them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from tests.worlds.bags import BOXES, COLOUR, World, as_bag, without
from tests.worlds.folders import moments

Run = Callable[..., Result]


def test_doctor_tells_topics_tree_and_lacks(run: Run, tmp_path: Path) -> None:
    as_bag(tmp_path / "tour", "mcap")
    result = run("doctor", "tour", "--zone", "Europe/Berlin")
    assert result.exit_code == 0, result.output
    for part in (
        "tour (format rosbag)",
        "/camera/color/image_raw/compressed: pictures (sensor_msgs/CompressedImage), 8, 2 a second",
        "map -> odom (8 transforms)",
        "camera_link -> camera_color_optical_frame (fixed)",
        "8 with depth, pose and intrinsics at once",
        "it can be taken in: d3a ingest tour",
    ):
        assert part in result.stdout, part
    assert "tf_static)" not in result.stdout  # once is enough for it: no lack


def test_doctor_says_what_a_bag_without_boxes_needs(run: Run, tmp_path: Path) -> None:
    World("mcap").write_changed(tmp_path / "tour", without(BOXES, "/tf"))
    result = run("doctor", "tour", "--json")
    assert result.exit_code == 1
    record = json.loads(result.stdout)
    assert record["ready"] is False
    assert "no transform leads from map" in record["notes"][0]
    what = [lack["what"] for lack in record["lacks"]]
    assert what[:2] == ["boxes of a detector", "poses"]


def test_ingest_takes_topics_and_asks_where_two_would_do(run: Run, tmp_path: Path) -> None:
    world = World("mcap")
    more = [world.jpeg(each, topic="/rear/image_raw/compressed") for each in moments()]
    more += [world.jpeg(each, topic="/front/image_raw/compressed") for each in moments()]
    world.write_changed(tmp_path / "two", without(COLOUR), more=more)
    result = run("ingest", "two")
    assert result.exit_code == 2
    assert "2 topics that may be the image: /front/image_raw/compressed" in result.stderr
    said = "image=/rear/image_raw/compressed"
    result = run("ingest", "two", "--topic", said, "--json")
    assert result.exit_code == 0, result.output
    (record,) = json.loads(result.stdout)["recordings"]
    assert (record["frames"], record["detections"], record["objects"]) == (8, 12, 2)
    again = run("ingest", "two", "--topic", said, "--json")
    assert json.loads(again.stdout)["recordings"][0]["frames"] == 0
