"""A recording on disk to a store: what is broken is counted, the rest arrives."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from d3a.ingest import NOTED_FRAMES, ingest
from d3a.ingesting.lacking import LOOKLESS, UNPLACED, UNPOSED
from d3a.ingesting.preparation import (
    BROKEN_DEPTH,
    BROKEN_PICTURE,
    NO_CAMERA,
    OTHER_CAMERA,
    OUTSIDE,
    TOO_FAR,
    WEAK,
)
from d3a.ingesting.sieve import BACKWARDS, DUPLICATE, NO_DATE
from d3a.model import BadInput, Detection, Frame, Pose
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.opening import open_source
from d3a.store.base import Batch, TaughtName
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import (
    CAMERA,
    FORWARD,
    START_MS,
    ListReader,
    Thing,
    circle,
    colour,
    depth_png,
    detection_line,
    frame_line,
    jpeg,
    rounds,
    write_recording,
)


def pictured(folder: Path, count: int = 6) -> Path:
    """Frames with pictures and depth, a cup in each."""
    write_recording(
        folder,
        [frame_line(n, image=f"images/{n}.jpg", depth=f"depth/{n}.png") for n in range(count)],
        [detection_line(n) for n in range(count)],
        now="2024-05-01T18:00:00+02:00",
        regions=[{"name": "kitchen", "polygon": [[0, 0], [4, 0], [4, 3]]}],
        classes=["cup"],
    )
    for name in ("images", "depth"):
        (folder / name).mkdir()
    for n in range(count):
        (folder / "images" / f"{n}.jpg").write_bytes(jpeg(40))
        (folder / "depth" / f"{n}.png").write_bytes(depth_png(2.0))
    return folder


def test_everything_arrives(tmp_path: Path) -> None:
    store = OracleStore()
    done: list[tuple[int, int | None]] = []
    reader = open_source(pictured(tmp_path / "r"))
    summary = ingest(reader, store, DEFAULT, on_progress=lambda n, of: done.append((n, of)))
    assert (summary.frames, summary.detections) == (6, 6)
    assert (summary.objects, summary.places) == (1, 1)
    assert summary.skipped.counts == {}
    assert done == [(n, 6) for n in range(1, 7)]
    assert set(summary.seconds) == {"read", "decode", "detect", "embed", "tiers", "store"}
    assert summary.elapsed_s >= sum(summary.seconds.values())
    (record,) = store.objects()
    assert record.embedding is not None
    assert record.extent_m == pytest.approx((0.8, 0.8))
    (stay,) = store.stays()
    assert stay.position == pytest.approx((-0.48, -0.16, 2.0), abs=0.01)
    (sighting,) = store.sightings()
    assert sighting.image == "lab/000000"
    assert sighting.viewer is not None
    assert store.meta("zone") == "Europe/Berlin"
    assert store.meta("now") == "2024-05-01T18:00:00+02:00"
    assert store.meta("classes") == ["cup"]
    assert store.meta("categories") == ["cup"]
    assert store.meta("profile") == "default"
    assert [region.name for region in store.regions()] == ["kitchen"]
    (view,) = store.views()
    assert (view.frames, view.recording, view.site) == (6, "lab", "s")


def test_broken_pictures_are_counted_and_the_detections_kept(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r")
    whole = (folder / "images/1.jpg").read_bytes()
    (folder / "images/1.jpg").write_bytes(whole[: len(whole) // 2])
    (folder / "images/2.jpg").write_bytes(b"")
    (folder / "images/3.jpg").unlink()
    (folder / "depth/4.png").write_bytes(depth_png(2.0, 32, 24))
    (folder / "depth/5.png").write_bytes(jpeg(3))
    store = OracleStore()
    summary = ingest(open_source(folder), store, DEFAULT)
    assert summary.detections == 6
    assert summary.skipped.counts == {BROKEN_PICTURE: 2, "missing picture": 1, BROKEN_DEPTH: 2}
    assert summary.skipped.examples[BROKEN_PICTURE][0].startswith("000001 (")
    assert dict(store.recordings()[0].skipped) == summary.skipped.counts
    assert store.check() == []


def test_a_slip_beyond_the_stores_limits_does_not_end_an_ingest(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r")
    frames = [json.loads(line) for line in (folder / "frames.jsonl").read_text().splitlines()]
    frames[1]["time"] = "2950-01-01T00:00:00Z"
    frames[2]["pose"] = [1e9, 0, 0, 0, 0, 0, 1]
    (folder / "frames.jsonl").write_text("".join(json.dumps(f) + "\n" for f in frames))
    rows = [detection_line(n) for n in range(6)]
    rows[3]["position"] = [0, 0, -1e9]
    (folder / "detections.jsonl").write_text("".join(json.dumps(r) + "\n" for r in rows))
    store = OracleStore()
    summary = ingest(open_source(folder), store, DEFAULT)
    assert summary.frames == 5
    assert summary.skipped.counts == {NO_DATE: 1, TOO_FAR: 2}
    assert store.check() == []


def test_depth_that_no_intrinsics_make_use_of_is_counted(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r", 3)
    said = json.loads((folder / "recording.json").read_text())
    (folder / "recording.json").write_text(json.dumps(said | {"camera": None}))
    summary = ingest(open_source(folder), OracleStore(), DEFAULT)
    assert summary.skipped.counts == {NO_CAMERA: 3}
    assert (summary.frames, summary.detections) == (3, 3)


def test_a_picture_that_the_camera_did_not_take_goes_without_it(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r", 3)
    (folder / "images/1.jpg").write_bytes(jpeg(40, 80, 60))
    store = OracleStore()
    summary = ingest(open_source(folder), store, DEFAULT)
    assert summary.skipped.counts == {OTHER_CAMERA: 1, BROKEN_DEPTH: 1}
    assert summary.detections == 3


def test_boxes_are_cut_or_left_out_and_weak_ones_too(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r", 2)
    rows = [
        detection_line(0, box=[-20, 5, 20, 200]),
        detection_line(0, box=[70, 5, 90, 20]),
        detection_line(1, probability=0.2),
    ]
    (folder / "detections.jsonl").write_text("".join(json.dumps(r) + "\n" for r in rows))
    store = OracleStore()
    summary = ingest(open_source(folder), store, DEFAULT.with_changes(min_probability=0.25))
    assert summary.skipped.counts == {OUTSIDE: 1, WEAK: 1}
    (sighting,) = store.sightings()
    assert sighting.box == (0.0, 5.0, 20.0, 48.0)


def test_time_running_backwards_and_duplicates_are_left_out(tmp_path: Path) -> None:
    frames = [frame_line(0), frame_line(2), frame_line(1), frame_line(2), frame_line(3)]
    folder = write_recording(tmp_path / "r", frames, [detection_line(n) for n in range(4)])
    store = OracleStore()
    parameters = PAPER.with_changes(checkpoint_frames=2)
    summary = ingest(open_source(folder), store, parameters)
    assert summary.frames == 3
    assert summary.skipped.counts == {BACKWARDS: 1, DUPLICATE: 1}
    assert store.recordings()[0].last_frame == "000003"


def test_what_was_left_out_is_not_counted_twice_when_an_ingest_goes_on(tmp_path: Path) -> None:
    folder = pictured(tmp_path / "r")
    (folder / "images/1.jpg").write_bytes(b"")
    (folder / "images/5.jpg").write_bytes(b"")
    whole, parts = OracleStore(), OracleStore()
    ingest(open_source(folder), whole, DEFAULT)
    for _ in range(3):
        summary = ingest(open_source(folder), parts, DEFAULT, max_frames=2)
    ingest(open_source(folder), parts, DEFAULT)
    assert summary.skipped.counts == {BROKEN_PICTURE: 2}
    assert list(parts.dump()) == list(whole.dump())


def test_a_zone_or_now_that_the_store_has_is_not_overwritten(tmp_path: Path) -> None:
    store = OracleStore()
    ingest(open_source(pictured(tmp_path / "a")), store, DEFAULT)
    other = write_recording(
        tmp_path / "b", [frame_line(50)], [detection_line(50)], recording="b", zone="Asia/Tokyo"
    )
    ingest(open_source(other), store, DEFAULT)
    assert store.meta("zone") == "Europe/Berlin"
    assert len(store.recordings()) == 2


def teach(store: OracleStore, word: str) -> str:
    """Name the first object, as another process does; return its id."""
    record = store.objects()[0]
    store.apply(Batch(objects=[replace(record, names=(TaughtName(word, "me"),))]))
    return record.object_id


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("capacity", [1, 400])
def test_a_name_taught_while_an_ingest_runs_is_kept(parameters: Parameters, capacity: int) -> None:
    things = [Thing("cup", (0, 0, 0), 1), Thing("bowl", (0, 3, 0), 2), Thing("book", (3, 0, 0), 3)]
    frames, store, named = rounds(things, 90), OracleStore(), []

    def on_progress(done: int, _: int | None) -> None:
        if done == 45:
            named.append(teach(store, "mug"))

    chosen = parameters.with_changes(checkpoint_frames=20, stm_capacity=capacity)
    ingest(ListReader(frames), store, chosen, on_progress=on_progress)
    (record,) = store.objects(names=["mug"])
    assert record.object_id == named[0]
    assert record.names == (TaughtName("mug", "me"),)
    assert record.last_ms > frames[60].time_ms


def test_what_got_a_name_does_not_expire() -> None:
    ghost = Detection("cup", 0.4, (28, 20, 36, 28), embedding=colour(1))
    pose, away = Pose((0.0, 0.0, 0.0), FORWARD), Pose((0.0, 9.0, 0.0), FORWARD)
    frames = [
        Frame(
            f"f{n}", START_MS + n * 60_000, away if n % 2 else pose, CAMERA, None, depth_png(4.0),
            () if n else (ghost,),
        )
        for n in range(40)
    ]  # fmt: skip
    expired, kept = OracleStore(), OracleStore()
    often = DEFAULT.with_changes(checkpoint_frames=2)
    near = replace(frames[0], depth=depth_png(2.0))
    ingest(ListReader([near, *frames[1:]]), expired, often)

    def on_progress(done: int, _: int | None) -> None:
        if done == 3:
            teach(kept, "ghost")

    ingest(ListReader([near, *frames[1:]]), kept, often, on_progress=on_progress)
    assert expired.objects() == []
    assert [name.word for name in kept.names()] == ["ghost"]


def rows_of(path: Path) -> list[dict[str, object]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_every_detection_has_its_assignment(tmp_path: Path, parameters: object) -> None:
    folder = pictured(tmp_path / "r")
    with (folder / "detections.jsonl").open("a") as lines:
        lines.write(json.dumps(detection_line(5, category="vase", box=[40, 20, 60, 44])) + "\n")
        lines.write(json.dumps(detection_line(5, box=[90, 20, 99, 44])) + "\n")
    store, out = OracleStore(), tmp_path / "out.jsonl"
    assert parameters in (DEFAULT, PAPER)
    chosen = DEFAULT if parameters == DEFAULT else PAPER
    ingest(open_source(folder), store, chosen, assignments=out)
    rows = rows_of(out)
    assert [row["row"] for row in rows] == list(range(8))
    known = {(stay.object_id, stay.place) for stay in store.stays()}
    for row in rows[:6]:
        assert (row["object_id"], row["place"]) in known
        assert row["why"] is None
    assert rows[7]["object_id"] is None
    assert rows[7]["why"] == OUTSIDE
    if chosen is PAPER:
        assert rows[6]["object_id"] is None
        assert "one frame" in str(rows[6]["why"])
    assert not out.with_name("out.jsonl.part").exists()


@pytest.mark.parametrize("parameters", [DEFAULT, PAPER], ids=["default", "paper"])
def test_assignments_survive_an_interruption(tmp_path: Path, parameters: object) -> None:
    chosen = DEFAULT if parameters == DEFAULT else PAPER
    folder = pictured(tmp_path / "r")
    whole, parts = tmp_path / "whole.jsonl", tmp_path / "parts.jsonl"
    ingest(open_source(folder), OracleStore(), chosen, assignments=whole)
    store = OracleStore()
    ingest(open_source(folder), store, chosen, assignments=parts, max_frames=3)
    with parts.with_name("parts.jsonl.part").open("a") as lines:
        lines.write('{"row": 99, "frame": "later", "box": [], "entry": "never applied"}\n')
    ingest(open_source(folder), store, chosen, assignments=parts)
    assert rows_of(parts) == rows_of(whole)
    with pytest.raises(BadInput, match="has this recording already"):
        ingest(open_source(folder), store, chosen, assignments=tmp_path / "new.jsonl")


@pytest.mark.parametrize(("count", "told_at"), [(20, 20), (NOTED_FRAMES + 5, NOTED_FRAMES)])
def test_no_pose_at_all_is_noted_once_and_early(count: int, told_at: int) -> None:
    frames = rounds([Thing("cup", circle(1.5, 8)[0], 1)], count, 3)

    def without(**none: object) -> list[Frame]:
        """Return the frames without poses, their detections without what is named."""
        things = [tuple(replace(d, **none) for d in f.detections or ()) for f in frames]  # type: ignore[arg-type]
        return [replace(f, pose=None, detections=d) for f, d in zip(frames, things, strict=True)]

    bare = without(position=None, covariance=None)
    told: list[tuple[int, str]] = []
    done: list[int] = [0]

    def taken(reader: ListReader) -> None:
        ingest(
            reader,
            OracleStore(),
            DEFAULT,
            on_progress=lambda number, _: done.append(number),
            on_note=lambda note: told.append((done[-1], note)),
        )

    taken(ListReader(frames))
    assert told == []
    taken(ListReader(bare))
    assert told == [(told_at - (count > told_at), UNPLACED)]
    taken(ListReader([*bare[:9], *frames[9:12]]))
    assert len(told) == 1, "some have one"
    taken(ListReader(without(embedding=None)))
    assert [note for _, note in told[1:]] == [UNPOSED, LOOKLESS]
