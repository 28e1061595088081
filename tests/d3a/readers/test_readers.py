from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.ingest import ingest
from d3a.model import BadInput
from d3a.parameters import Parameters
from d3a.readers import parsing
from d3a.readers.base import Skipped
from d3a.readers.opening import open_source
from d3a.readers.recording import BROKEN_EMBEDDING
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import depth_png, detection_line, frame_line, jpeg, write_recording

HEADER = (
    "frame,timestamp,category,probability,x1,y1,x2,y2,loc_x,loc_y,loc_z,gt_category,gt_object_id"
)
GOOD = "7,2020-02-20T01:00:43.963695-05:00,cup,0.96,10,10,30,40,1.5,2.7,0.4,secret,99"


def kuri(folder: Path, *rows: str, pictures: tuple[str, ...] = ("7",)) -> Path:
    (folder / "images").mkdir(parents=True)
    (folder / "detections.csv").write_text("\n".join((HEADER, *rows)) + "\n", encoding="utf-8")
    for name in pictures:
        (folder / "images" / f"{name}.jpg").write_bytes(jpeg(50))
    return folder


def posed(folder: Path, frames: int = 2) -> Path:
    (folder / "frames").mkdir(parents=True)
    np.savetxt(folder / "camera-intrinsics.txt", [[50, 0, 32], [0, 50, 24], [0, 0, 1]])
    lines = ["frame,seconds,color,depth,pose"]
    for n in range(frames):
        stem = f"frames/frame-{n:06d}"
        (folder / f"{stem}.color.jpg").write_bytes(jpeg(50))
        (folder / f"{stem}.depth.png").write_bytes(depth_png(2.0))
        np.savetxt(folder / f"{stem}.pose.txt", np.eye(4))
        lines.append(f"{n},{n / 30:.3f},{stem}.color.jpg,{stem}.depth.png,{stem}.pose.txt")
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
    row = {"frame": 0, "category": "cup", "probability": 0.5, "bbox": [1, 2, 30, 40]}
    (folder / "detections.jsonl").write_text(json.dumps(row) + "\n")
    return folder


# Opening


def test_each_format_is_known_by_its_looks(tmp_path: Path) -> None:
    assert type(open_source(kuri(tmp_path / "k", GOOD))).__name__ == "KuriReader"
    assert type(open_source(posed(tmp_path / "p"))).__name__ == "PosedReader"
    recording = write_recording(tmp_path / "r", [], [])
    assert type(open_source(recording)).__name__ == "RecordingReader"


def test_a_folder_that_is_none_lists_what_was_looked_for(tmp_path: Path) -> None:
    with pytest.raises(BadInput) as caught:
        open_source(tmp_path)
    for word in ("recording.json", "detections.csv", "camera-intrinsics.txt"):
        assert word in str(caught.value)


def test_a_wrong_path_format_or_zone_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="does not exist"):
        open_source(tmp_path / "none")
    (tmp_path / "file").write_text("x")
    with pytest.raises(BadInput, match="no recording that can be read"):
        open_source(tmp_path / "file")
    with pytest.raises(BadInput, match="there are recording, kuri, posed"):
        open_source(tmp_path, format="mp4")
    with pytest.raises(BadInput, match=r"frames\.csv"):
        open_source(kuri(tmp_path / "k", GOOD), format="posed")
    for zone in ("Mars/Olympus", "../../etc/passwd", "\0"):
        with pytest.raises(BadInput, match="time zone"):
            open_source(tmp_path / "k", zone=zone)


# Kuri


def test_kuri_rows_become_frames_by_time(tmp_path: Path) -> None:
    late = GOOD.replace("7,", "9,", 1).replace("01:00", "05:38")
    early = GOOD.replace("cup,", "bottle ,")
    reader = open_source(kuri(tmp_path / "k", late, GOOD, early, pictures=("7", "9", "4")))
    frames = list(reader)
    assert [frame.name for frame in frames] == ["7", "9"]
    assert frames[0].time_ms == 1582178443964
    assert [(d.category, d.row) for d in frames[0].detections or ()] == [("cup", 1), ("bottle", 2)]
    assert reader.facts.zone == "America/New_York"
    assert reader.skipped.counts == {"no time: no detection names the picture": 1}
    assert "secret" not in repr(frames)


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (GOOD.replace("0.96", "nan"), "probability is nan"),
        (GOOD.replace("1.5,", "inf,"), "loc_x is inf"),
        (GOOD.replace("01:00:43", "25:00:43"), "ISO 8601"),
        (GOOD.replace("-05:00", ""), "offset"),
        (GOOD.replace("10,10,30,40", "30,10,10,40"), "box"),
        (GOOD.replace("cup", ""), "category"),
        ("7,2020", "ISO 8601"),
    ],
)
def test_a_broken_kuri_row_is_counted_and_named(tmp_path: Path, broken: str, said: str) -> None:
    reader = open_source(kuri(tmp_path / "k", broken, GOOD))
    (frame,) = reader
    assert len(frame.detections or ()) == 1
    assert reader.skipped.counts == {parsing.BROKEN_DETECTION: 1}
    (example,) = reader.skipped.examples[parsing.BROKEN_DETECTION]
    assert "detections.csv:2" in example
    assert said in example


def test_a_missing_picture_is_counted_and_the_frame_kept(tmp_path: Path) -> None:
    reader = open_source(kuri(tmp_path / "k", GOOD, pictures=()))
    (frame,) = reader
    assert frame.image is None
    assert reader.skipped.counts == {parsing.MISSING_PICTURE: 1}


def test_a_table_without_its_columns_is_bad_input(tmp_path: Path) -> None:
    folder = kuri(tmp_path / "k", GOOD)
    (folder / "detections.csv").write_text("frame,category\n7,cup\n")
    with pytest.raises(BadInput, match=r"detections\.csv and images"):
        open_source(folder, format="kuri")
    (folder / "detections.csv").write_text(GOOD)
    with pytest.raises(BadInput, match="no table of their times"):
        open_source(folder)


# Posed


def test_posed_triples_have_pose_depth_and_camera(tmp_path: Path) -> None:
    reader = open_source(posed(tmp_path / "p"))
    first, second = reader
    assert first.camera is not None
    assert (first.camera.width, first.camera.height, first.camera.fx) == (64, 48, 50.0)
    assert first.pose is not None
    assert first.pose.quaternion == (0.0, 0.0, 0.0, 1.0)
    assert second.time_ms - first.time_ms == 33
    assert [d.box for d in first.detections or ()] == [(1.0, 2.0, 30.0, 40.0)]
    assert second.detections == ()
    assert reader.facts.min_probability == 0.25


def test_posed_seconds_since_1970_are_taken_as_they_are(tmp_path: Path) -> None:
    folder = posed(tmp_path / "p", 1)
    table = (folder / "frames.csv").read_text().replace("0,0.000", "0,1600000000.5")
    (folder / "frames.csv").write_text(table)
    (frame,) = open_source(folder)
    assert frame.time_ms == 1_600_000_000_500


def test_a_broken_pose_depth_or_row_is_counted(tmp_path: Path) -> None:
    folder = posed(tmp_path / "p", 3)
    (folder / "frames/frame-000000.pose.txt").write_text("1 0 0\n")
    (folder / "frames/frame-000001.depth.png").unlink()
    table = (folder / "frames.csv").read_text().replace("2,0.067", "2,soon")
    (folder / "frames.csv").write_text(table)
    with (folder / "detections.jsonl").open("a") as lines:
        lines.write(
            '{"frame": 77, "category": "cup", "probability": 1, "bbox": [1, 2, 3, 4]}\n[]\n'
        )
    reader = open_source(folder)
    first, second = reader
    assert first.pose is None
    assert second.depth is None
    assert reader.skipped.counts == {
        "broken pose": 1,
        parsing.MISSING_PICTURE: 1,
        parsing.BROKEN_FRAME: 1,
        parsing.BROKEN_LINE: 1,
        "detection of an unknown frame": 1,
    }


# Recording


def test_a_recording_gives_its_facts(tmp_path: Path) -> None:
    regions = [{"name": "kitchen", "polygon": [[0, 0], [4, 0], [4, 3]]}]
    folder = write_recording(
        tmp_path / "r",
        [frame_line(0)],
        [detection_line(0, position=[1, 2, 3])],
        now="2024-05-01T18:00:00+02:00",
        regions=regions,
        classes=["cup", "bowl"],
    )
    reader = open_source(folder)
    facts = reader.facts
    assert (facts.name, facts.site, facts.zone, facts.frames) == ("lab", "s", "Europe/Berlin", 1)
    assert facts.now == "2024-05-01T18:00:00+02:00"
    assert facts.classes == ("cup", "bowl")
    assert facts.regions.polygons == (("kitchen", ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))),)
    (frame,) = reader
    assert frame.detections is not None
    assert frame.detections[0].position == (1.0, 2.0, 3.0)
    assert reader.skipped.counts == {}


def wide(rows: list[list[float]], width: int = 512) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Rows of so many numbers that begin with these."""
    matrix = np.zeros((len(rows), width), np.float32)
    matrix[:, :2] = rows
    return matrix


def test_embeddings_come_by_row_at_unit_length(tmp_path: Path) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0)], [detection_line(0, embedding=1)])
    np.save(folder / "embeddings.npy", wide([[1, 0], [3, 4]]))
    reader = open_source(folder)
    (frame,) = reader
    (detection,) = frame.detections or ()
    assert detection.embedding is not None
    assert detection.embedding[:3].tolist() == pytest.approx([0.6, 0.8, 0.0])
    assert reader.skipped.counts == {}


@pytest.mark.parametrize(
    ("said", "width", "why"),
    [
        (
            {"name": "rgb-8x8x8", "dim": 512},
            100,
            r"has 100 numbers a row, .* says 512 \(rgb-8x8x8\)",
        ),
        ({"name": "rgb-8x8x8"}, 100, "says 512"),
        ({"name": "clip", "dim": 128}, 100, r"says 128 \(clip\)"),
        ({"name": "clip", "dim": 48}, 48, "a store keeps 64 to 4096"),
        ({"name": "clip"}, 5000, "a store keeps 64 to 4096"),
        (None, 100, '"embedding": {"name": "my-model", "dim": 100} would do'),
        ({"dim": 512}, 512, "embedding.name must be text"),
        ({"name": "clip", "dim": "512"}, 512, "dim must be a whole number"),
        ({"name": "rgb-8x8x8", "dim": 64}, 64, "rgb-8x8x8 has 512 numbers"),
        ([], 512, "must be an object"),
    ],
)
def test_embeddings_of_another_kind_than_is_said_are_refused_before_anything_is_stored(
    tmp_path: Path, said: Any, width: int, why: str
) -> None:
    rows = [detection_line(0, embedding=0)]
    folder = write_recording(tmp_path / "r", [frame_line(0)], rows, embedding=said)
    np.save(folder / "embeddings.npy", wide([[3, 4]], width))
    store = OracleStore()
    with pytest.raises(BadInput, match=why):
        ingest(open_source(folder), store, Parameters())
    assert store.counts()["recordings"] == 0


def test_a_count_of_pixels_below_none_is_no_look_of_colours(tmp_path: Path) -> None:
    rows = [detection_line(0, embedding=0)]
    for name, broken in (("rgb-8x8x8", 1), ("clip", 0)):
        facts = {"embedding": {"name": name, "dim": 512}}
        folder = write_recording(tmp_path / name, [frame_line(0)], rows, **facts)
        np.save(folder / "embeddings.npy", wide([[3, -4]]))
        reader = open_source(folder)
        (frame,) = reader
        assert [each.embedding is None for each in frame.detections or ()] == [broken == 1]
        assert reader.skipped.counts.get(BROKEN_EMBEDDING, 0) == broken


@pytest.mark.parametrize("row", [0, 1, 7, -1, True, "2"])
def test_a_detection_with_a_broken_embedding_is_kept_without_it(tmp_path: Path, row: Any) -> None:
    rows = [detection_line(0, embedding=2), detection_line(0, embedding=row)]
    folder = write_recording(tmp_path / "r", [frame_line(0)], rows)
    np.save(folder / "embeddings.npy", wide([[0, 0], [np.nan, 1], [3, 4]]))
    reader = open_source(folder)
    (frame,) = reader
    sound, broken = frame.detections or ()
    assert sound.embedding is not None
    assert broken.embedding is None
    assert (broken.category, broken.box, broken.row) == (sound.category, sound.box, 1)
    assert reader.skipped.counts == {BROKEN_EMBEDDING: 1}
    assert reader.skipped.examples[BROKEN_EMBEDDING][0].startswith("detections.jsonl:2 (embedding")


def test_pickled_embeddings_are_refused(tmp_path: Path) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0)], [])
    np.save(folder / "embeddings.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(BadInput, match="not an array of numbers"):
        list(open_source(folder))


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("{", parsing.BROKEN_LINE),
        ("[1, 2]", parsing.BROKEN_LINE),
        (json.dumps(detection_line(0, probability=float("nan"))), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, probability=1.2)), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, box=[1, 2, 3])), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, box="1234")), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, category=None)), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, category="\u001b\u200b")), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, position=[1, None, 3])), parsing.BROKEN_DETECTION),
        (json.dumps(detection_line(0, embedding=0)), BROKEN_EMBEDDING),
        (json.dumps(detection_line(9)), "detection of an unknown frame"),
        (json.dumps(detection_line(0, colour="red")), "unknown field in detections.jsonl: colour"),
    ],
)
def test_each_kind_of_broken_line_has_its_count(tmp_path: Path, line: str, reason: str) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0)], [detection_line(0), line])
    reader = open_source(folder)
    (frame,) = reader
    assert 1 <= len(frame.detections or ()) <= 2
    assert reader.skipped.counts == {reason: 1}


@pytest.mark.parametrize(
    ("facts", "why"),
    [
        ({"classes": 5}, "classes must be a list of names"),
        ({"classes": "cup"}, "classes must be a list of names"),
        ({"regions": 5}, "regions must be a list"),
        ({"regions": [{"name": "hall", "polygon": 5}]}, "needs a name and a polygon"),
        ({"recording": "x" * 5000}, "recording has 5000 characters"),
        ({"camera": {"width": 10**400}}, r"camera.width is larger than any number"),
    ],
)
def test_facts_of_a_wrong_kind_are_refused(tmp_path: Path, facts: Any, why: str) -> None:
    with pytest.raises(BadInput, match=why):
        open_source(write_recording(tmp_path / "r", [frame_line(0)], [], **facts))


def test_facts_may_begin_with_a_mark_of_their_encoding(tmp_path: Path) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0)], [])
    facts = folder / "recording.json"
    facts.write_bytes(b"\xef\xbb\xbf" + facts.read_bytes())
    assert open_source(folder).facts.name == "lab"
    facts.write_text("[" * 100_000)
    with pytest.raises(BadInput, match="is not JSON"):
        open_source(folder)


def test_numbers_beyond_all_numbers_and_nests_of_brackets_are_broken(tmp_path: Path) -> None:
    broken = detection_line(0, probability=10**400)
    rows: list[dict[str, Any] | str] = ["[" * 100_000, broken, detection_line(0)]
    folder = write_recording(tmp_path / "r", [frame_line(0, pose=[10**400] * 7)], rows)
    reader = open_source(folder)
    (frame,) = reader
    assert (frame.pose, len(frame.detections or ())) == (None, 1)
    assert reader.skipped.counts == {
        "broken pose": 1,
        parsing.BROKEN_LINE: 1,
        parsing.BROKEN_DETECTION: 1,
    }


def test_a_position_goes_on_without_what_is_no_covariance(tmp_path: Path) -> None:
    given = [[-1.0] * 9, "a", [1.0], [0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1]]
    rows = [detection_line(0, position=[1, 2, 3], covariance=each) for each in given]
    reader = open_source(write_recording(tmp_path / "r", [frame_line(0)], rows))
    (frame,) = reader
    found = frame.detections or ()
    assert [each.position for each in found] == [(1.0, 2.0, 3.0)] * 4
    assert [each.covariance is None for each in found] == [True] * 3 + [False]
    assert reader.skipped.counts == {parsing.BROKEN_SPREAD: 3}


def test_broken_frames_and_poses_are_counted(tmp_path: Path) -> None:
    frames = [
        frame_line(0, time="2024-05-01T10:00:00"),
        frame_line(1, pose=[0, 0, 0, 0, 0, 0, 0]),
        frame_line(2, image="../../secret.jpg"),
        frame_line(3, image="images/none.jpg"),
    ]
    reader = open_source(write_recording(tmp_path / "r", frames, []))
    kept = list(reader)
    assert [frame.name for frame in kept] == ["000001", "000002", "000003"]
    assert [frame.pose is None for frame in kept] == [True, False, False]
    assert [frame.image for frame in kept] == [None] * 3
    assert reader.skipped.counts == {
        parsing.BROKEN_FRAME: 1,
        "broken pose": 1,
        parsing.NO_FILE: 1,
        parsing.MISSING_PICTURE: 1,
    }


@pytest.mark.parametrize("name", ["../far.png", "depth/../../far.png", "{tmp}/far.png", "a\0b", 7])
def test_a_picture_that_leads_out_of_the_recording_costs_the_picture_alone(
    tmp_path: Path, name: Any
) -> None:
    (tmp_path / "far.png").write_bytes(depth_png(2.0))
    said = name.format(tmp=tmp_path) if isinstance(name, str) else name
    folder = write_recording(tmp_path / "r", [frame_line(0, depth=said)], [detection_line(0)])
    reader = open_source(folder)
    (frame,) = reader
    assert (frame.depth, len(frame.detections or ())) == (None, 1)
    assert reader.skipped.counts == {parsing.NO_FILE: 1}


def test_links_that_lie_in_a_recording_are_followed(tmp_path: Path) -> None:
    """A name cannot lead behind them: "depth/.." is the recording's folder."""
    (tmp_path / "disk" / "depth").mkdir(parents=True)
    for place in ("depth/0.png", "1.png", "secret.png"):
        (tmp_path / "disk" / place).write_bytes(depth_png(2.0))
    names = ["depth/0.png", "1.png", "depth/../secret.png"]
    frames = [frame_line(n, depth=name) for n, name in enumerate(names)]
    folder = write_recording(tmp_path / "r", frames, [])
    (folder / "depth").symlink_to(tmp_path / "disk" / "depth")
    (folder / "1.png").symlink_to(tmp_path / "disk" / "1.png")
    reader = open_source(folder)
    assert [frame.depth is None for frame in reader] == [False, False, True]
    assert reader.skipped.counts == {parsing.MISSING_PICTURE: 1}


def test_a_name_longer_than_any_file_s_is_a_missing_picture(tmp_path: Path) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0, image="a" * 5000)], [])
    reader = open_source(folder)
    (frame,) = reader
    assert frame.image is None
    assert reader.skipped.counts == {parsing.MISSING_PICTURE: 1}


def test_what_is_no_covariance_is_counted_and_the_pose_goes_on_without(tmp_path: Path) -> None:
    beyond = np.diag([0.01, 0.01, 0, 0, 0, 0.1])
    beyond[0, 1] = beyond[1, 0] = 0.05  # more shared than either has
    lopsided = np.diag([0.01] * 6)
    lopsided[0, 1] = 0.005
    given = [[1.0], [-1.0] * 36, beyond.ravel().tolist(), lopsided.ravel().tolist(), [0.0] * 36]
    frames = [frame_line(k, pose_covariance=each) for k, each in enumerate(given)]
    reader = open_source(write_recording(tmp_path / "r", frames, []))
    poses = [frame.pose for frame in reader]
    assert None not in poses
    assert [pose.covariance is None for pose in poses if pose] == [True] * 4 + [False]
    assert reader.skipped.counts == {"broken pose covariance": 4}


def test_axes_that_a_covariance_knows_nothing_of_are_fixed(tmp_path: Path) -> None:
    sure = [0.04, 0.04, 0, 0, 0, 0.01]
    planar = np.diag([0.04, 0.04, 1e6, 9.9, 1e300, 0.01])  # height and tilt of a robot on a floor
    lost = [
        np.diag([*at, 0.1, 0.1, 0.1, turn]) for *at, turn in ((1e4, 1, 1), (1, 1e6, 1), (1, 1, 9))
    ]
    given = [each.ravel().tolist() for each in (planar, *lost)]
    frames = [frame_line(k, pose_covariance=each) for k, each in enumerate(given)]
    reader = open_source(write_recording(tmp_path / "r", frames, []))
    first, *others = [frame.pose for frame in reader]
    assert first is not None
    assert first.covariance is not None
    assert np.reshape(first.covariance, (6, 6)).tolist() == np.diag(sure).tolist()
    assert [pose is not None and pose.covariance for pose in others] == [None] * 3
    assert reader.skipped.counts == {"broken pose covariance": 3}


@pytest.mark.parametrize(
    "facts",
    [
        {"schema": 2},
        {"zone": "Nowhere/Land"},
        {"camera": {"width": 0}},
        {"camera": 7},
        {"embedding": "clip"},
        {"now": "noon"},
        {"recording": 3},
        {"regions": [{"name": "a", "polygon": [[0, 0], [1, 1]]}]},
    ],
)
def test_facts_that_cannot_be_used_are_bad_input(tmp_path: Path, facts: dict[str, object]) -> None:
    folder = write_recording(tmp_path / "r", [], [], **facts)
    with pytest.raises(BadInput):
        open_source(folder)


# Words


def test_escapes_are_taken_out_of_a_category_and_counted() -> None:
    skipped = Skipped()
    found = parsing.category_of("\x1b[31mred\tcup\x07 [bold]", skipped, "here")
    assert found == "[31mred cup [bold]"
    assert skipped.counts == {parsing.CLEANED: 1}
    assert parsing.category_of(" bottle ", skipped, "here") == "bottle"
    assert skipped.counts == {parsing.CLEANED: 1}


@given(st.text())
def test_cleaned_text_is_safe_and_stays_clean(text: str) -> None:
    cleaned = parsing.clean_text(text)
    assert cleaned.isprintable() or not cleaned
    assert parsing.clean_text(cleaned) == cleaned
    cleaned.encode("utf-8")
