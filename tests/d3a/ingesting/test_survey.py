"""What a recording holds and lacks, told before it is taken in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from d3a.ingesting.sieve import DUPLICATE
from d3a.ingesting.survey import Gap, Survey, lacks, survey, to_json
from d3a.readers.base import Link, Stream
from d3a.readers.opening import open_source
from tests.worlds.folders import as_recording, as_tum, moments
from tests.worlds.rounds import ListReader, Thing, depth_png, jpeg, rounds


def edited(folder: Path, file: str, **changes: object) -> Path:
    """The folder with fields of each of its JSON lines changed."""
    rows = [json.loads(line) | changes for line in (folder / file).read_text().splitlines()]
    (folder / file).write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder


def missing(found: Survey) -> list[str]:
    return [lack.what for lack in lacks(found)]


def test_a_whole_recording_lacks_next_to_nothing(tmp_path: Path) -> None:
    found = survey(open_source(as_recording(tmp_path / "r")))
    assert found.frames == Stream(
        "frames", "frames", 8, moments()[0].time_ms, moments()[-1].time_ms, 0.5
    )
    assert (found.step_s, found.frames.rate_hz, found.gaps) == (0.5, 2.0, ())
    parts = ("image", "depth", "pose", "camera", "detections", "located")
    assert found.having == dict.fromkeys(parts, 8)
    assert (found.detections, dict(found.categories)) == (12, {"cup": 8, "bowl": 4})
    assert found.sampled.pictures == 8
    assert dict(found.sampled.sizes) == {(64, 48): 8}
    assert missing(found) == ["the detector's list of classes"]
    assert [(s.name, s.count) for s in found.streams] == [
        ("frames.jsonl", 8),
        ("detections.jsonl", 12),
    ]
    assert json.loads(json.dumps(to_json(found)))["frames"]["rate_hz"] == 2.0


@pytest.mark.parametrize(
    ("field", "file", "what"),
    [
        ("image", "frames.jsonl", "pictures"),
        ("pose", "frames.jsonl", "poses"),
        ("depth", "frames.jsonl", "depth"),
    ],
)
def test_each_lack_is_named_with_its_cost(tmp_path: Path, field: str, file: str, what: str) -> None:
    found = survey(open_source(edited(as_recording(tmp_path / "r"), file, **{field: None})))
    assert found.having[field] == 0
    first = next(lacks(found))
    assert first.what == what
    assert first.cost
    assert not first.needed


def test_recorded_positions_need_no_depth(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r", depth=False, poses=False)
    edited(folder, "detections.jsonl", position=[1, 2, 3])
    found = survey(open_source(folder))
    assert found.positions == 12
    (poses, _) = lacks(found)
    assert poses.what == "poses"
    assert "gone" in poses.cost


def test_poses_by_the_frames_names_are_counted(tmp_path: Path) -> None:
    for number in range(3):
        (tmp_path / f"{number}.jpg").write_bytes(jpeg(number))
    (tmp_path / "times.csv").write_text(
        "file,time\n" + "".join(f"{n}.jpg,{1_700_000_000 + n}\n" for n in range(3))
    )
    (tmp_path / "poses.csv").write_text(
        "file,x,y,z,qx,qy,qz,qw\n" + "".join(f"{n}.jpg,{n},0,0,0,0,0,1\n" for n in range(3))
    )
    found = survey(open_source(tmp_path))
    assert found.having["pose"] == 3
    assert [each.count for each in found.streams if each.kind == "poses"] == [3]


def test_what_is_there_in_part_is_counted(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    (folder / "depth" / f"{moments()[2].name}.png").unlink()
    (folder / "depth" / f"{moments()[3].name}.png").write_bytes(depth_png(2.0, 32, 24))
    (folder / "images" / f"{moments()[4].name}.jpg").write_bytes(jpeg(3, 32, 24))
    (folder / "images" / f"{moments()[5].name}.jpg").write_bytes(b"")
    found = survey(open_source(folder))
    assert "depth in 1 of 8 frames" in missing(found)
    said = "; ".join(found.sampled.problems)
    assert "32 x 24, and the picture is 64 x 48" in said
    assert "32 x 24, and the camera's are 64 x 48" in said
    assert "the file is empty" in said
    assert found.skipped.counts == {"missing picture": 1}


def test_without_boxes_or_frames_it_cannot_be_taken_in(tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    (folder / "detections.jsonl").unlink()
    needed = [lack.what for lack in lacks(survey(open_source(folder))) if lack.needed]
    assert needed == ["boxes of a detector"]
    (folder / "frames.jsonl").write_text('{"frame": "1", "time": "noon"}\n')
    found = survey(open_source(folder))
    assert found.skipped.counts == {"broken frame": 1}
    assert [lack.needed for lack in lacks(found)] == [True]


def test_a_wrong_scale_is_doubted(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t", 5000.0)
    said = missing(survey(open_source(folder, zone="UTC", options={"depth-scale": "50000"})))
    assert said[-1].startswith("a plausible depth: 0.2 m")
    assert "plausible" not in str(missing(survey(open_source(folder))))


def test_clocks_that_do_not_meet_are_told(tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    text = (folder / "groundtruth.txt").read_text().replace("\n16000", "\n16100")
    (folder / "groundtruth.txt").write_text(text)
    found = survey(open_source(folder))
    assert found.coverage == {"rgb.txt": 1.0, "depth.txt": 1.0, "groundtruth.txt": 0.0}
    assert "poses for 100% of the time (groundtruth.txt)" in missing(found)
    assert found.having["pose"] == 0


def test_gaps_and_frames_out_of_order_are_told() -> None:
    frames = rounds([Thing("cup", (0, 0, 0), 1)], 40)
    late = [*frames[:10], *frames[25:], frames[3], frames[30]]
    found = survey(ListReader(late))
    assert found.gaps == (Gap(frames[9].time_ms, 80.0),)
    assert found.frames.count == 25
    assert found.skipped.counts == {DUPLICATE: 2}


def test_a_reader_may_tell_its_tree() -> None:
    class Robot(ListReader):
        def streams(self) -> list[Stream]:
            return [Stream("/camera/image", "sensor_msgs/msg/Image", 3)]

        def links(self) -> list[Link]:
            return [Link("map", "odom", False, 7)]

    found = survey(Robot(rounds([Thing("cup", (0, 0, 0), 1)], 3)))
    assert to_json(found)["tf"] == [
        {"parent": "map", "child": "odom", "is_fixed": False, "count": 7}
    ]
    assert to_json(found)["streams"][0]["kind"] == "sensor_msgs/msg/Image"
