"""The demo home's shipped recording: whole, true, and rich enough for its questions."""

from __future__ import annotations

import json
import tomllib
from collections import Counter, defaultdict
from datetime import date, datetime
from importlib.resources import files
from itertools import pairwise
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from PIL import Image

from assistant.home import recording_folder
from assistant.home.inventory import inventory
from assistant.home.life import NOW
from assistant.home.plan import ROOMS, room_at
from d3a.geometry import project
from d3a.model import Camera, Pose

Json = dict[str, Any]
MAX_BYTES = 4_000_000
SMALL_M = 0.6
FOLDER = recording_folder()


def lines(name: str) -> list[Json]:
    text = (FOLDER / name).read_text(encoding="utf-8")
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture(scope="module")
def header() -> Json:
    record: Json = json.loads((FOLDER / "recording.json").read_text(encoding="utf-8"))
    return record


@pytest.fixture(scope="module")
def frames() -> dict[str, Json]:
    return {record["frame"]: record for record in lines("frames.jsonl")}


@pytest.fixture(scope="module")
def detections() -> list[Json]:
    return lines("detections.jsonl")


@pytest.fixture(scope="module")
def truth() -> dict[str, Json]:
    return {record["object"]: record for record in lines("truth.jsonl")}


def time_of(frame: Json) -> datetime:
    return datetime.fromisoformat(frame["time"])


def place_at(thing: Json, moment: datetime) -> Json | None:
    for place in thing["places"]:
        start, end = (datetime.fromisoformat(place[edge]) for edge in ("start", "end"))
        if start <= moment < end:
            found: Json = place
            return found
    return None


def test_package_stays_small() -> None:
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) <= MAX_BYTES


def test_header_names_the_home_its_zone_rooms_and_standing_clock(header: Json) -> None:
    assert header["schema"] == 1
    assert header["site"] == "home"
    assert ZoneInfo(header["zone"])
    assert datetime.fromisoformat(header["now"]) == NOW
    assert [region["name"] for region in header["regions"]] == [room.name for room in ROOMS]
    assert len(header["regions"]) >= 4
    assert all(len(region["polygon"]) >= 3 for region in header["regions"])
    assert {"umbrella", "pizza"} < set(header["classes"])


def test_map_is_one_that_map_server_reads(header: Json) -> None:
    text = (FOLDER / header["map"]).read_text(encoding="utf-8")
    facts = dict(line.split(": ", 1) for line in text.splitlines())
    assert float(facts["resolution"]) > 0
    assert len(json.loads(facts["origin"])) == 3
    with Image.open(FOLDER / facts["image"]) as picture:
        cells = np.asarray(picture)
    assert set(np.unique(cells)) == {0, 205, 254}
    resolution, (left, low, _) = float(facts["resolution"]), json.loads(facts["origin"])
    for room in ROOMS:  # the middle of a wall is occupied, that of a doorway free
        x, y = room.floor[0], room.floor[3]
        row = len(cells) - 1 - int((y - low) / resolution)
        assert cells[row, int((x - left) / resolution)] == 0
    row = len(cells) - 1 - int((4.0 - low) / resolution)
    assert cells[row, int((1.35 - left) / resolution)] == 254


def test_every_picture_is_there_and_decodes(header: Json, frames: dict[str, Json]) -> None:
    size = (header["camera"]["width"], header["camera"]["height"])
    for frame in frames.values():
        with Image.open(FOLDER / frame["image"]) as picture:
            picture.load()
            assert picture.size == size
            assert np.asarray(picture).std() > 8, f"{frame['image']} shows nothing"
    on_disk = {f"images/{path.name}" for path in (FOLDER / "images").iterdir()}
    assert on_disk == {frame["image"] for frame in frames.values()}


def test_frames_go_forward_in_time_and_end_before_now(frames: dict[str, Json]) -> None:
    times = [time_of(frame) for frame in frames.values()]
    assert all(earlier < later for earlier, later in pairwise(times))
    assert times[-1] < NOW
    assert len({moment.date() for moment in times}) == 3


def test_every_room_is_visited_in_the_morning_at_midday_and_in_the_evening_of_each_day(
    frames: dict[str, Json],
) -> None:
    visits: dict[tuple[date, int], Counter[str]] = defaultdict(Counter)
    for frame in frames.values():
        moment = time_of(frame)
        third = 0 if moment.hour < 12 else 1 if moment.hour < 17 else 2
        visits[moment.date(), third][room_at(*frame["pose"][:2])] += 1
    assert len(visits) == 9
    for rooms in visits.values():
        assert set(rooms) == {room.name for room in ROOMS}
        assert min(rooms.values()) >= 3


def test_detections_lie_in_pictures_that_exist(
    frames: dict[str, Json], detections: list[Json], header: Json
) -> None:
    width, height = header["camera"]["width"], header["camera"]["height"]
    for row in detections:
        x1, y1, x2, y2 = row["box"]
        assert 0 <= x1 < x2 <= width
        assert 0 <= y1 < y2 <= height
        assert 0 < row["probability"] <= 1
        assert row["frame"] in frames
        assert row["category"] in header["classes"]
    order = [row["frame"] for row in detections]
    assert order == sorted(order)


def test_truth_names_rows_once_and_leaves_out_only_false_boxes(
    truth: dict[str, Json], detections: list[Json]
) -> None:
    rows = [row for thing in truth.values() for row in thing["detections"]]
    assert len(rows) == len(set(rows))
    assert set(rows) <= set(range(len(detections)))
    false_share = 1 - len(rows) / len(detections)
    assert 0 < false_share < 0.05
    wrong = sum(
        detections[row]["category"] != thing["category"]
        for thing in truth.values()
        for row in thing["detections"]
    )
    assert 0 < wrong / len(rows) < 0.08


def test_home_is_rich_and_lives(truth: dict[str, Json]) -> None:
    detected = [thing for thing in truth.values() if len(thing["detections"]) >= 2]
    assert len(detected) >= 45
    moved = {
        thing["object"]
        for thing in detected
        if len({tuple(place["position"]) for place in thing["places"]}) > 1
    }
    assert len(moved) >= 8
    assert "keys-1" in moved
    assert len({thing["colour"] for thing in detected if thing["category"] == "cup"}) == 4
    assert not {"umbrella", "pizza"} & {thing["category"] for thing in truth.values()}


def test_keys_are_seen_where_the_days_put_them(
    truth: dict[str, Json], detections: list[Json], frames: dict[str, Json]
) -> None:
    keys = truth["keys-1"]
    seen: dict[tuple[int, str], set[str]] = defaultdict(set)
    for row in keys["detections"]:
        frame = frames[detections[row]["frame"]]
        place = place_at(keys, time_of(frame))
        assert place is not None, "a thing that is away cannot be detected"
        seen[time_of(frame).day, place["on"]].add(frame["frame"])
    for day_and_place in [(12, "kitchen table"), (12, "hall shelf"), (13, "kitchen table")]:
        assert len(seen[day_and_place]) >= 2
    assert len(seen[14, "coffee table"]) >= 2


def test_detected_positions_and_boxes_agree_with_the_truth(
    truth: dict[str, Json], detections: list[Json], frames: dict[str, Json], header: Json
) -> None:
    camera = Camera(**header["camera"])
    sizes = {thing.name: extent(thing.name) for thing in inventory()}
    errors, outside, count = [], 0, 0
    for name, thing in truth.items():
        if sizes[name] > SMALL_M:
            continue
        for row in thing["detections"]:
            found, frame = detections[row], frames[detections[row]["frame"]]
            place = place_at(thing, time_of(frame))
            assert place is not None
            errors.append(np.linalg.norm(np.subtract(found["position"], place["position"])))
            x, y, z, *turn = frame["pose"]
            pose = Pose((x, y, z), (turn[0], turn[1], turn[2], turn[3]))
            seen = project(np.array([found["position"]]), pose, camera)
            column, line = float(seen.u[0]), float(seen.v[0])
            x1, y1, x2, y2 = found["box"]
            spare = 0.25 * max(x2 - x1, y2 - y1) + 6
            outside += not (x1 - spare < column < x2 + spare and y1 - spare < line < y2 + spare)
            count += 1
    assert np.median(errors) < 0.1
    assert np.quantile(errors, 0.97) < 0.35
    assert outside / count < 0.03


def extent(name: str) -> float:
    thing = next(thing for thing in inventory() if thing.name == name)
    corners = np.concatenate([part.mesh.vertices for part in thing.model])
    return float(np.ptp(corners, axis=0).max())


def test_reported_pose_is_near_the_true_one_but_noisy(frames: dict[str, Json]) -> None:
    true = {record["frame"]: record["pose"] for record in lines("truth-poses.jsonl")}
    assert list(true) == list(frames)
    off = np.array([np.subtract(frames[name]["pose"][:3], true[name][:3]) for name in true])
    assert 0.005 < off[:, :2].std() < 0.03
    assert np.abs(off).max() < 0.1


def questions() -> list[Json]:
    text = (files("assistant.home") / "questions.toml").read_text(encoding="utf-8")
    found: list[Json] = tomllib.loads(text)["question"]
    return found


def evidence(
    name: str, truth: dict[str, Json], detections: list[Json], frames: dict[str, Json]
) -> dict[str, Json]:
    """Return the place of the thing in each frame in which it was detected as what it is."""
    thing = truth[name]
    seen = [row for row in thing["detections"] if detections[row]["category"] == thing["category"]]
    shown = {}
    for frame in (detections[row]["frame"] for row in seen):
        place = place_at(thing, time_of(frames[frame]))
        assert place is not None, "a thing that is away cannot be detected"
        shown[frame] = place
    return shown


@pytest.mark.parametrize("ask", questions(), ids=lambda ask: str(ask["text"]))
def test_question_has_its_answer_in_the_recording(
    ask: Json, truth: dict[str, Json], detections: list[Json], frames: dict[str, Json]
) -> None:
    if "count" in ask:
        named = [t for t in truth.values() if t["category"] == ask["category"] and t["detections"]]
        assert len(named) == ask["count"]
        return
    if "objects" not in ask:
        assert ask["seen"] is False
        assert ask["category"] not in {row["category"] for row in detections}
        return
    shown = [evidence(name, truth, detections, frames) for name in ask["objects"]]
    if ask.get("together"):
        both = set(shown[0]) & set(shown[1])
        shown = [{frame: seen[frame] for frame in both} for seen in shown]
    for seen in shown:
        asked = {f: p for f, p in seen.items() if ask["start"] <= time_of(frames[f]) < ask["end"]}
        assert bool(asked) is ask.get("seen", True)
        for place in asked.values():
            assert (place["region"], place["on"]) == (ask["region"], ask["on"])
            stay = [frame for frame, other in seen.items() if other == place]
            assert len(stay) >= 2, "one frame is no evidence of a stay"
    if ask.get("alone"):
        places = {name: place_at(thing, ask["start"]) for name, thing in truth.items()}
        there = {name for name, place in places.items() if place and place["on"] == ask["on"]}
        assert there == set(ask["objects"])
