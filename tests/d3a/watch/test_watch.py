"""Recordings that grow: whatever is written when, the store is that of a plain ingest."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.ingesting.live import Live
from d3a.ingesting.sieve import BACKWARDS, JUMP
from d3a.model import BadInput, Frame, Json
from d3a.parameters import DEFAULT, PROFILES
from d3a.readers.base import Follower
from d3a.readers.opening import open_source
from d3a.watch import Patience, Watching, follow, watch
from d3a.watch.recording import LATE
from tests.worlds.folders import as_recording, as_tum, boxes_file, moments, pictures
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import (
    ListReader,
    Thing,
    detection_line,
    frame_line,
    jpeg,
    rounds,
    write_recording,
)

Act = Callable[[], None]


class Script:
    """A writer that does one thing at each look of the follower; time passes as they look."""

    def __init__(self, acts: list[Act], step_s: float = 0.1, idle_s: float | None = 5.0) -> None:
        self._acts = iter(acts)
        self._step_s = step_s
        self.now = 0.0
        self.stopped = False
        self.patience = Patience(
            idle_s,
            1.0,
            should_stop=lambda: self.stopped,
            clock=lambda: self.now,
            sleep=self._sleep,
        )

    def _sleep(self, _: float) -> None:
        self.now += self._step_s
        next(self._acts, lambda: None)()


def watched(folder: Path, script: Script, store: OracleStore, **options: str) -> Json:
    def opened() -> Follower | None:
        return follow(folder, script.patience, options=options)

    summary = watch(opened, store, Watching(DEFAULT, script.patience.should_stop))
    return {} if summary is None else summary.skipped.counts


def plain(folder: Path, **options: str) -> list[Json]:
    store = OracleStore()
    ingest(open_source(folder, options=options), store, DEFAULT)
    return list(store.dump())


def add(path: Path, text: str) -> Act:
    def act() -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a") as file:
            file.write(text)

    return act


def written(path: Path, content: bytes) -> Act:
    def act() -> None:
        path.write_bytes(content)

    return act


def lines_of(path: Path) -> list[str]:
    return path.read_text().splitlines(keepends=True)


def growing(tmp_path: Path) -> tuple[Path, Path]:
    """A whole recording, and a folder that has its facts and an empty list of frames."""
    whole, folder = as_recording(tmp_path / "whole"), tmp_path / "grows"
    folder.mkdir()
    shutil.copy(whole / "recording.json", folder)
    (folder / "frames.jsonl").touch()
    (folder / "detections.jsonl").touch()
    return whole, folder


def copy(source: Path, target: Path) -> Act:
    def act() -> None:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)

    return act


def by_frame(whole: Path) -> Iterator[tuple[str, str, list[str]]]:
    rows = lines_of(whole / "detections.jsonl")
    for line in lines_of(whole / "frames.jsonl"):
        name = json.loads(line)["frame"]
        yield name, line, [row for row in rows if json.loads(row)["frame"] == name]


ORDERS = ["frame first", "boxes first", "in pieces", "pictures last", "boxes late"]


def acts_of(order: str, whole: Path, folder: Path) -> list[Act]:
    """Write the recording in one of the orders in which a robot's program may."""
    acts: list[Act] = []
    for name, line, rows in by_frame(whole):
        shown = [
            copy(whole / f"images/{name}.jpg", folder / f"images/{name}.jpg"),
            copy(whole / f"depth/{name}.png", folder / f"depth/{name}.png"),
        ]
        frame = [add(folder / "frames.jsonl", line)]
        boxes = [add(folder / "detections.jsonl", row) for row in rows]
        if order == "in pieces":
            frame = [add(folder / "frames.jsonl", part) for part in (line[:9], line[9:-1], "\n")]
            boxes = [add(folder / "detections.jsonl", p) for r in rows for p in (r[:20], r[20:])]
        acts += {
            "frame first": [*shown, *frame, *boxes],
            "boxes first": [*shown, *boxes, *frame],
            "in pieces": [*shown, *frame, *boxes],
            "pictures last": [*frame, *boxes, *shown],
            "boxes late": [*shown, *frame, *([lambda: None] * 5), *boxes],
        }[order]
    return acts


@pytest.mark.parametrize("order", ORDERS)
def test_a_growing_recording_fills_the_store_of_a_plain_ingest(tmp_path: Path, order: str) -> None:
    whole, folder = growing(tmp_path)
    store = OracleStore()
    counts = watched(folder, Script(acts_of(order, whole, folder)), store)
    assert counts == {}
    assert list(store.dump()) == plain(whole)
    assert store.recordings()[0].done


@pytest.mark.parametrize("stop_after", [3, 9, 20, 31])
def test_it_is_stopped_and_goes_on(tmp_path: Path, stop_after: int) -> None:
    whole, folder = growing(tmp_path)
    acts = acts_of("frame first", whole, folder)
    store = OracleStore()
    script = Script([*acts[:stop_after], lambda: setattr(script, "stopped", True)])
    watched(folder, script, store)
    assert not any(record.done for record in store.recordings())
    had = sum(record.frames for record in store.recordings())
    assert had >= (5 if stop_after == 31 else 0)
    watched(folder, Script(acts[stop_after:]), store)
    assert list(store.dump()) == plain(whole)


def test_a_last_line_without_its_end_waits_and_counts_in_the_end(tmp_path: Path) -> None:
    whole, folder = growing(tmp_path)
    for path in (whole / "frames.jsonl", whole / "detections.jsonl"):
        path.write_text(path.read_text().rstrip("\n"))
    store = OracleStore()
    watched(folder, Script(acts_of("frame first", whole, folder)), store)
    assert list(store.dump()) == plain(whole)
    assert store.recordings()[0].frames == len(moments())


def test_broken_lines_are_counted_as_by_a_plain_ingest(tmp_path: Path) -> None:
    whole, folder = growing(tmp_path)
    for path, broken in (("frames.jsonl", '{"frame": 7\n'), ("detections.jsonl", "[1]\n\n{}\n")):
        lines = lines_of(whole / path)
        (whole / path).write_text("".join([*lines[:3], broken, *lines[3:]]))
    frames = [add(folder / "frames.jsonl", line) for line in lines_of(whole / "frames.jsonl")]
    rows = [add(folder / "detections.jsonl", x) for x in lines_of(whole / "detections.jsonl")]
    shutil.copytree(whole / "images", folder / "images")
    shutil.copytree(whole / "depth", folder / "depth")
    store = OracleStore()
    counts = watched(folder, Script([*rows, *frames]), store)
    assert sum(counts.values()) == 3
    assert list(store.dump()) == plain(whole)


def test_a_detection_after_its_time_is_counted_and_said(tmp_path: Path) -> None:
    whole, folder = growing(tmp_path)
    late = detection_line(0) | {"frame": moments()[0].name}
    acts = acts_of("frame first", whole, folder)
    acts += [*[lambda: None] * 15, add(folder / "detections.jsonl", json.dumps(late) + "\n")]
    counts = watched(folder, Script(acts), OracleStore())
    assert counts == {LATE: 1}


def test_embeddings_that_are_written_after_their_row_are_waited_for(tmp_path: Path) -> None:
    rows = [detection_line(n, embedding=n) for n in range(4)]
    frames = [frame_line(n) for n in range(4)]
    facts = {"embedding": {"name": "clip", "dim": 64}}
    whole = write_recording(tmp_path / "whole", frames, rows, **facts)
    folder = write_recording(tmp_path / "grows", [], [], **facts)
    vectors = np.eye(4, 64, dtype=np.float32) + 0.1
    np.save(whole / "embeddings.npy", vectors)

    def saved(count: int) -> Act:
        return lambda: np.save(folder / "embeddings.npy", vectors[:count])

    acts: list[Act] = []
    for n in range(4):
        acts.append(add(folder / "frames.jsonl", json.dumps(frames[n]) + "\n"))
        acts.append(add(folder / "detections.jsonl", json.dumps(rows[n]) + "\n"))
        acts += [lambda: None, saved(n + 1)]
    store = OracleStore()
    assert watched(folder, Script(acts), store) == {}
    assert list(store.dump()) == plain(whole)


def test_embeddings_of_another_width_than_is_said_end_the_watch(tmp_path: Path) -> None:
    facts = {"embedding": {"name": "clip", "dim": 128}}
    rows = [detection_line(0, embedding=0)]
    folder = write_recording(tmp_path / "grows", [frame_line(0)], rows, **facts)
    np.save(folder / "embeddings.npy", np.ones((1, 64), np.float32))
    with pytest.raises(BadInput, match=r"has 64 numbers a row, .* says 128 \(clip\)"):
        watched(folder, Script([lambda: None] * 3), OracleStore())


def test_a_recording_is_waited_for_until_it_is_there(tmp_path: Path) -> None:
    whole, folder = as_recording(tmp_path / "whole"), tmp_path / "later"
    store = OracleStore()
    notes: list[str] = []

    def appear() -> None:
        shutil.copytree(whole, folder)

    script = Script([lambda: None] * 7 + [appear])
    summary = watch(
        lambda: follow(folder, script.patience, on_note=notes.append),
        store,
        Watching(DEFAULT, script.patience.should_stop),
    )
    assert summary is not None
    assert len(notes) == 1
    assert "does not exist" in notes[0]
    assert list(store.dump()) == plain(whole)
    with pytest.raises(BadInput, match="does not exist"):
        follow(tmp_path / "never", Script([]).patience)


def test_a_file_that_gets_shorter_is_refused(tmp_path: Path) -> None:
    whole, folder = growing(tmp_path)
    acts = acts_of("frame first", whole, folder)[:12]
    acts.append(written(folder / "frames.jsonl", b""))
    with pytest.raises(BadInput, match="got shorter"):
        watched(folder, Script(acts), OracleStore())


def test_what_cannot_be_followed_is_said(tmp_path: Path) -> None:
    pictures(tmp_path / "c")
    (tmp_path / "c/instances.json").write_text(json.dumps({"images": [], "annotations": []}))
    with pytest.raises(BadInput, match=r"cannot be followed.*recording, pictures, tum, csv"):
        follow(tmp_path / "c", Script([]).patience, format="coco")


@pytest.mark.parametrize("has_boxes", [True, False], ids=["boxes first", "boxes after"])
def test_growing_pictures_with_a_growing_table(tmp_path: Path, has_boxes: bool) -> None:
    whole, folder = tmp_path / "same", tmp_path / "grows/same"
    pictures(whole)
    boxes_file(whole)
    rows = [f"{m.name}.jpg,{m.iso}\n" for m in moments()]
    (whole / "times.csv").write_text("file,time\n" + "".join(rows))
    folder.mkdir(parents=True)
    boxes = [add(folder / "detections.jsonl", x) for x in lines_of(whole / "detections.jsonl")]
    acts: list[Act] = [add(folder / "times.csv", "file,time\n")]
    if has_boxes:
        acts += boxes
    for moment, row in zip(moments(), rows, strict=True):
        acts.append(add(folder / "times.csv", row[:-9]))  # half a time is another time
        acts.append(add(folder / "times.csv", row[-9:]))
        acts.append(written(folder / f"{moment.name}.jpg", b"\xff\xd8"))
        acts.append(copy(whole / f"{moment.name}.jpg", folder / f"{moment.name}.jpg"))
        if not has_boxes:
            acts += [
                add(folder / "detections.jsonl", line)
                for line in lines_of(whole / "detections.jsonl")
                if json.loads(line)["frame"] == moment.name
            ]
    store = OracleStore()
    assert watched(folder, Script(acts), store) == {}
    assert list(store.dump()) == plain(whole)


def test_a_growing_tum_folder_is_read_anew(tmp_path: Path) -> None:
    whole, folder = as_tum(tmp_path / "a/same"), tmp_path / "b/same"
    boxes_file(whole)
    shutil.copytree(whole, folder)
    for name in ("rgb.txt", "depth.txt", "groundtruth.txt"):
        (folder / name).write_text("".join(lines_of(whole / name)[:4]))
    acts: list[Act] = []
    for n in range(4, max(len(lines_of(whole / name)) for name in ("rgb.txt", "groundtruth.txt"))):
        acts += [
            add(folder / name, "".join(lines_of(whole / name)[n : n + 1]))
            for name in ("rgb.txt", "depth.txt", "groundtruth.txt")
        ]
    store = OracleStore()
    watched(folder, Script(acts), store)
    assert list(store.dump()) == plain(whole)


def jumping(folder: Path) -> Path:
    """Frames each 10 s; the stamps of three, two of them in a row, are days ahead."""
    wrong = {7: "2024-05-09T10:00:00Z", 8: "2024-05-19T10:00:01Z", 20: "2025-01-01T00:00:00Z"}
    frames = [frame_line(n) | ({"time": wrong[n]} if n in wrong else {}) for n in range(30)]
    return write_recording(folder, frames, [detection_line(n) for n in range(30)])


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_a_stamp_that_jumps_ahead_is_left_out_alone(tmp_path: Path, profile: str) -> None:
    folder = jumping(tmp_path / "r")
    store, parts = OracleStore(), OracleStore()
    summary = ingest(open_source(folder), store, PROFILES[profile])
    assert summary.frames == 27
    assert summary.skipped.counts == {JUMP: 3}
    for cut in (7, 1, 12, 1, 30):
        ingest(open_source(folder), parts, PROFILES[profile], max_frames=cut)
    assert list(parts.dump()) == list(store.dump())


def test_watching_agrees_on_a_stamp_that_jumps_ahead(tmp_path: Path) -> None:
    whole = jumping(tmp_path / "r")
    folder = write_recording(tmp_path / "grows", [], [])
    acts: list[Act] = []
    columns = [lines_of(whole / f"{name}.jsonl") for name in ("frames", "detections")]
    for frame, row in zip(*columns, strict=True):
        acts += [add(folder / "frames.jsonl", frame), add(folder / "detections.jsonl", row)]
    acts_2 = acts[14:]  # the first is stopped while it waits for what follows the jump
    script = Script([*acts[:14], *[lambda: None] * 12, lambda: setattr(script, "stopped", True)])
    store = OracleStore()
    watched(folder, script, store)
    assert store.recordings()[0].frames == 7
    assert watched(folder, Script(acts_2), store) == {JUMP: 3}
    assert list(store.dump()) == plain(whole)


def test_a_pause_and_a_stamp_back_are_no_jump(tmp_path: Path) -> None:
    later = "2024-05-01T12:00:0{}Z"
    frames = [frame_line(0), frame_line(1)]
    frames += [frame_line(n) | {"time": later.format(n)} for n in range(2, 8)]
    frames.insert(5, frame_line(9))  # one from before the pause: it is the one out of order
    folder = write_recording(tmp_path / "r", frames, [detection_line(n) for n in range(8)])
    summary = ingest(open_source(folder), OracleStore(), DEFAULT)
    assert summary.skipped.counts == {BACKWARDS: 1}
    assert summary.frames == 8


def test_a_first_stamp_that_is_ahead_is_left_out(tmp_path: Path) -> None:
    frames = [frame_line(0) | {"time": "2031-01-01T00:00:00Z"}, *map(frame_line, range(1, 9))]
    folder = write_recording(tmp_path / "r", frames, [detection_line(n) for n in range(9)])
    summary = ingest(open_source(folder), OracleStore(), DEFAULT)
    assert (summary.frames, summary.skipped.counts) == (8, {JUMP: 1})


def test_the_store_is_fresh_while_frames_come(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a checkpoint per 100 frames and a handful of frames, time alone makes them."""
    monkeypatch.setattr("d3a.ingesting.live.Pulse.SHARE", 0)  # however long a checkpoint takes
    frames = rounds([Thing("cup", (1.0, 0.0, 0.0), 1)], 12, missed=0.0)
    store, seen = OracleStore(), []

    def note(done: int, _: int | None) -> None:
        seen.append(sum(r.frames for r in store.recordings()))

    ingest(ListReader(frames), store, DEFAULT, on_progress=note, live=Live(fresh_s=0.0))
    assert seen == list(range(12))
    assert list(store.dump()) == dump(frames)


def dump(frames: list[Frame]) -> list[Json]:
    store = OracleStore()
    ingest(ListReader(frames), store, DEFAULT)
    return list(store.dump())


def test_a_cut_picture_is_waited_for(tmp_path: Path) -> None:
    folder = write_recording(tmp_path / "r", [frame_line(0) | {"image": "images/0.jpg"}], [])
    (folder / "images").mkdir()
    content = jpeg(30)
    (folder / "images/0.jpg").write_bytes(content[: len(content) // 2])
    add(folder / "detections.jsonl", json.dumps(detection_line(0)) + "\n")()
    acts: list[Act] = [
        add(folder / "frames.jsonl", json.dumps(frame_line(1)) + "\n"),
        add(folder / "detections.jsonl", json.dumps(detection_line(1)) + "\n"),
        lambda: None,
        written(folder / "images/0.jpg", content),
    ]
    store = OracleStore()
    assert watched(folder, Script(acts), store) == {}
    assert list(store.dump()) == plain(folder)
