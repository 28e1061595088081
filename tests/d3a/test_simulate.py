"""The simulator: the paper's numbers, the recording's form, and a truth that agrees with itself."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from d3a.model import BadInput
from d3a.simulate import codes, simulate
from d3a.simulation.statistics import statistics
from d3a.truth import Truth, lines_of, place_at, read_truth


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("world") / "nominal"
    simulate(folder, seed=7, depth=False)
    return folder


@pytest.fixture(scope="module")
def truth(world: Path) -> Truth:
    return read_truth(world)


def test_three_hours_have_the_numbers_of_table_2(tmp_path: Path) -> None:
    made = simulate(tmp_path / "w", seed=11, depth=False)
    assert (made.objects, made.movers, made.frames) == (59, 10, 991)
    assert made.objects - made.movers == 49
    assert abs(made.detections - 2558) < 100
    assert np.mean(made.moves) == pytest.approx(2.1)
    assert np.std(made.moves, ddof=1) == pytest.approx(1.3, abs=0.05)
    assert max(made.moves) == 5


def test_four_days_have_the_numbers_of_table_2(tmp_path: Path) -> None:
    made = simulate(tmp_path / "w", hours=22, seed=3, depth=False)
    assert made.frames == 10132
    assert abs(made.detections - 13565) < 0.03 * 13565
    assert made.movers == 20
    assert 10 < np.mean(made.moves) < 20


def test_world_looks_like_the_lab(world: Path) -> None:
    found = statistics(world)
    same, other = (found["cosines"]["raw"][k] for k in ("same_object", "other_same_category"))
    assert same[0] == pytest.approx(0.25, abs=0.12)
    assert same[1] == pytest.approx(0.65, abs=0.08)
    assert 0.3 < other[1] < same[1] - 0.1
    assert found["false_positives"] == pytest.approx(0.04, abs=0.01)
    assert found["confused"] == pytest.approx(0.08, abs=0.02)
    x, y, z = found["position_error_m"]
    assert 0.25 < x < 0.5
    assert 0.25 < y < 0.5
    assert z < 0.1
    assert found["detections_per_object"]["max"] > 3 * found["detections_per_object"]["mean"]


def test_same_arguments_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        simulate(tmp_path / name, hours=0.3, seed=5)
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*.*"))
    assert len(files) > 100
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file


def test_interrupted_world_has_no_truth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An evaluation that is run again takes a world with its truth for a whole one."""

    def cut(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("d3a.simulation.writer.write_depth", cut)
    with pytest.raises(KeyboardInterrupt):
        simulate(tmp_path / "w", hours=0.05)
    assert (tmp_path / "w" / "detections.jsonl").exists()
    assert not (tmp_path / "w" / "truth.jsonl").exists()


def test_another_seed_is_another_world(tmp_path: Path) -> None:
    for seed in (1, 2):
        simulate(tmp_path / str(seed), hours=0.2, seed=seed, depth=False)
    one, two = (json.loads(next(iter(open_truth(tmp_path / s)))) for s in ("1", "2"))
    assert one["places"][0]["position"] != two["places"][0]["position"]


def open_truth(folder: Path) -> list[str]:
    return (folder / "truth.jsonl").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("condition", ["pose-0.5", "confusion-20", "colour-x2", "perfect"])
def test_condition_changes_noise_and_not_the_world(
    world: Path, tmp_path: Path, truth: Truth, condition: str
) -> None:
    simulate(tmp_path / "w", seed=7, condition=condition, depth=False)
    other = read_truth(tmp_path / "w")
    assert [o.places for o in other.objects] == [o.places for o in truth.objects]
    assert [o.colour for o in other.objects] == [o.colour for o in truth.objects]
    counts = [len(o.detections) for o in truth.objects]
    assert [len(o.detections) for o in other.objects] == counts


def test_false_positives_come_on_top(tmp_path: Path, truth: Truth) -> None:
    made = simulate(tmp_path / "w", seed=7, condition="false-positives-15", depth=False)
    assert made.false_positives == round(0.15 * 2558)
    assert made.detections - made.false_positives == int((truth.owner >= 0).sum())


def test_detection_shows_a_thing_that_is_there(truth: Truth) -> None:
    for k, thing in enumerate(truth.objects):
        for row in thing.detections:
            assert truth.owner[row] == k
            assert place_at(thing.places, int(truth.time_ms[row])) is not None


def test_places_of_a_thing_follow_each_other(truth: Truth) -> None:
    for thing in truth.objects:
        for before, after in zip(thing.places, thing.places[1:], strict=False):
            assert before.end_ms < after.start_ms
            distance = np.linalg.norm(np.subtract(before.position, after.position))
            assert distance >= 1.0


def test_empty_place_was_seen_after_its_end_and_not_refilled(truth: Truth) -> None:
    ended = [p for thing in truth.objects for p in thing.places[:-1]]
    known = [p for p in ended if p.seen_empty_ms]
    assert known
    for place in known:
        assert place.seen_empty_ms is not None
        assert place.end_ms < place.seen_empty_ms[0] <= place.seen_empty_ms[1]
    last = [thing.places[-1] for thing in truth.objects]
    assert all(place.seen_empty_ms is None for place in last)


def test_relations_are_mutual_and_on_means_above(truth: Truth) -> None:
    height = {
        thing.name: {p.start_ms: p.position[2] for p in thing.places} for thing in truth.objects
    }
    near, on = set(), []
    for thing in truth.objects:
        for place in thing.places:
            for relation in place.relations:
                if relation.kind == "near":
                    near.add((thing.name, relation.object, relation.start_ms, relation.end_ms))
                if relation.kind == "on":
                    on.append((place, relation))
    assert near
    assert {(b, a, s, e) for a, b, s, e in near} == near
    assert on
    for place, relation in on:
        assert place.position[2] > min(height[relation.object].values())


def test_frames_are_in_order_and_poses_are_unit(world: Path) -> None:
    frames = list(lines_of(world / "frames.jsonl"))
    times = [datetime.fromisoformat(row["time"]) for row in frames]
    assert times == sorted(times)
    assert len(set(times)) == len(times)
    turns = np.array([row["pose"][3:] for row in frames])
    assert np.linalg.norm(turns, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert all(len(row["pose_covariance"]) == 36 for row in frames)


def test_position_lies_on_the_ray_through_the_box_of_the_reported_pose(world: Path) -> None:
    """What a reader would compute from box, depth and pose is what the recording says."""
    facts = json.loads((world / "recording.json").read_text(encoding="utf-8"))
    camera = facts["camera"]
    poses = {row["frame"]: row["pose"] for row in lines_of(world / "frames.jsonl")}
    for row in list(lines_of(world / "detections.jsonl"))[::50]:
        x, y, z, *q = poses[row["frame"]]
        local = turned_back(np.array(row["position"]) - (x, y, z), np.array(q))
        u = camera["cx"] + camera["fx"] * local[0] / local[2]
        v = camera["cy"] + camera["fy"] * local[1] / local[2]
        x1, y1, x2, y2 = row["box"]
        assert local[2] > 0
        assert (u, v) == pytest.approx(((x1 + x2) / 2, (y1 + y2) / 2), abs=0.5)


def turned_back(vector: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Rotate by the inverse of a unit quaternion x y z w."""
    axis, w = -q[:3], q[3]
    return np.asarray(vector + 2 * np.cross(axis, np.cross(axis, vector) + w * vector))


def test_histograms_count_the_pixels_of_the_box(world: Path) -> None:
    vectors = np.load(world / "embeddings.npy")
    rows = list(lines_of(world / "detections.jsonl"))
    assert vectors.shape == (len(rows), 512)
    for k in range(0, len(rows), 100):
        x1, y1, x2, y2 = rows[k]["box"]
        assert vectors[k].sum() == pytest.approx((x2 - x1) * (y2 - y1), rel=0.25, abs=40)


def test_codes_flip_bits_at_the_given_rates(tmp_path: Path) -> None:
    simulate(tmp_path / "w", seed=7, condition=codes(0.2, 0.05), depth=False)
    truth, bits = read_truth(tmp_path / "w"), np.load(tmp_path / "w" / "embeddings.npy")
    own = bits[np.arange(len(bits)), truth.owner]
    others = (bits[:, :59].sum() - own.sum()) / (58 * len(bits))
    assert own.mean() == pytest.approx(0.95, abs=0.02)
    assert others == pytest.approx(0.2, abs=0.01)
    assert not bits[:, 59:].any()
    assert (truth.owner >= 0).all()


def test_depth_image_agrees_with_the_positions(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    simulate(tmp_path / "w", hours=0.5, seed=2, condition="noiseless")
    checked = 0
    for row in lines_of(tmp_path / "w" / "detections.jsonl"):
        if row["category"] not in ("cup", "bottle", "bowl"):
            continue
        depth = np.asarray(image.open(tmp_path / "w" / "depth" / f"{row['frame']}.png")) / 1000
        x1, y1, x2, y2 = row["box"]
        middle = depth[int((y1 + y2) / 2), int((x1 + x2) / 2)]
        pose = next(
            r["pose"]
            for r in lines_of(tmp_path / "w" / "frames.jsonl")
            if r["frame"] == row["frame"]
        )
        local = turned_back(np.array(row["position"]) - pose[:3], np.array(pose[3:]))
        checked += abs(middle - local[2]) < 0.25
    total = sum(
        r["category"] in ("cup", "bottle", "bowl")
        for r in lines_of(tmp_path / "w" / "detections.jsonl")
    )
    assert checked > 0.75 * total  # the rest: the grid's 5 pixels look past a small thing


def test_refuses_what_cannot_be_made(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no condition 'foggy'; there are nominal"):
        simulate(tmp_path / "w", condition="foggy")
    with pytest.raises(BadInput, match="hours"):
        simulate(tmp_path / "w", hours=0)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("keep me", encoding="utf-8")
    with pytest.raises(BadInput, match="was not simulated"):
        simulate(tmp_path / "mine", hours=0.1)
    assert (tmp_path / "mine" / "letter.txt").exists()


def test_replaces_an_older_recording(tmp_path: Path) -> None:
    simulate(tmp_path / "w", hours=0.2, seed=1)
    made = simulate(tmp_path / "w", hours=0.1, seed=1, depth=False)
    assert not (tmp_path / "w" / "depth").exists()
    assert read_truth(tmp_path / "w").frames == made.frames


def test_leaves_a_recording_of_somebody_alone(tmp_path: Path) -> None:
    mine = '{"schema": 1, "recording": "my kitchen"}'
    (tmp_path / "recording.json").write_text(mine, encoding="utf-8")
    with pytest.raises(BadInput, match="was not simulated"):
        simulate(tmp_path, hours=0.05, depth=False)
    assert (tmp_path / "recording.json").read_text(encoding="utf-8") == mine


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("frames.jsonl", ""),
        ("frames.jsonl", "[]\n"),
        ("detections.jsonl", ""),
        ("truth.jsonl", '{"object": "cup-1", "category": "cup", "places": 3}\n'),
    ],
)
def test_says_what_cannot_be_judged(tmp_path: Path, name: str, text: str) -> None:
    simulate(tmp_path, hours=0.1, depth=False)
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(BadInput, match="is not a"):
        read_truth(tmp_path)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("detections.jsonl", "", "is of row 0, and detections.jsonl has 0 rows"),
        ("frames.jsonl", "", "does not list '000001', which has detections"),
        ("truth.jsonl", '{"object": "cup-1"}\n', "a line lacks 'category'"),
    ],
)
def test_what_cannot_be_judged_is_said(tmp_path: Path, name: str, text: str, said: str) -> None:
    detection = '{"frame": "000001", "category": "cup", "probability": 1, "box": [0, 0, 1, 1]}\n'
    truth = '{"object": "cup-1", "category": "cup", "places": [], "detections": [0]}\n'
    frame = '{"frame": "000001", "time": "2020-02-24T09:00:00-05:00"}\n'
    written = {"detections.jsonl": detection, "truth.jsonl": truth, "frames.jsonl": frame}
    for file, content in (written | {name: text}).items():
        (tmp_path / file).write_text(content, encoding="utf-8")
    with pytest.raises(BadInput, match=said):
        read_truth(tmp_path)
