"""The file of assignments: whatever dies when, it ends up whole."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from d3a import teaching
from d3a.ingest import ingest
from d3a.ingesting import assignments
from d3a.ingesting.assignments import AssignmentLog
from d3a.ingesting.intake import NOT_EACH, Intake
from d3a.ingesting.sieve import BACKWARDS
from d3a.model import BadInput, Detection, Frame
from d3a.paper import NOISE
from d3a.parameters import DEFAULT, PROFILES, Parameters
from d3a.store.base import Batch
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, rounds

FRAMES = 30


class Killed(Exception):  # noqa: N818
    """Stands for SIGKILL."""


class DyingStore(OracleStore):
    """Dies once, at a batch, before or after it was committed."""

    def __init__(self, after: int, committed: bool) -> None:
        super().__init__()
        self._left, self._committed = after, committed

    def apply(self, batch: Batch) -> None:
        self._left -= 1
        if self._left == -1 and not self._committed:
            raise Killed
        super().apply(batch)
        if self._left == -1:
            raise Killed


def world() -> list[Frame]:
    """Three things whose detections are numbered, as a recording's are."""
    places = circle(1.5, 8)
    things = [Thing(c, places[2 * n], n, 4 * n) for n, c in enumerate(["cup", "bowl", "cup"])]
    frames, row = [], 0
    for frame in rounds(things, FRAMES, 5, noise_m=0.1, missed=0.3):
        numbered = []
        for each in frame.detections or ():
            numbered.append(replace(each, row=row))
            row += 1
        frames.append(replace(frame, detections=tuple(numbered)))
    return frames


def small(profile: str) -> Parameters:
    return PROFILES[profile].with_changes(stm_capacity=2, checkpoint_frames=7)


def rows_of(path: Path) -> list[dict[str, object]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def files_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def whole(folder: Path, profile: str, frames: list[Frame]) -> list[dict[str, object]]:
    path = folder / "whole.jsonl"
    ingest(ListReader(frames), OracleStore(), small(profile), assignments=path)
    rows = rows_of(path)
    path.unlink()
    assert [row["row"] for row in rows] == list(range(len(rows)))
    return rows


@pytest.mark.parametrize("profile", ["default", "paper"])
@pytest.mark.parametrize("committed", [False, True])
def test_it_is_whole_whatever_checkpoint_an_ingest_died_at(
    tmp_path: Path, profile: str, committed: bool
) -> None:
    frames, path = world(), tmp_path / "out.jsonl"
    wanted = whole(tmp_path, profile, frames)
    deaths = 0
    for after in range(20):
        store = DyingStore(after, committed)
        try:
            ingest(ListReader(frames), store, small(profile), assignments=path)
        except Killed:
            deaths += 1
            ingest(ListReader(frames), store, small(profile), assignments=path)
        assert rows_of(path) == wanted
        assert files_in(tmp_path) == ["out.jsonl"]
        path.unlink()
    assert deaths == FRAMES // 7 + 1  # the last of them ends the recording


@pytest.mark.parametrize("profile", ["default", "paper"])
@pytest.mark.parametrize("dies_at", ["before", "half", "moving", "after"])
def test_it_is_whole_where_an_ingest_died_between_the_last_checkpoint_and_the_file(
    tmp_path: Path, profile: str, dies_at: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    wanted = whole(tmp_path, profile, frames)
    places: dict[str, tuple[object, str]] = {
        "before": (AssignmentLog, "finish"),
        "half": (assignments, "_resolved"),
        "moving": (Path, "replace"),
        "after": (Path, "unlink"),
    }

    def die(*_: object, **__: object) -> None:
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(*places[dies_at], die)
        with pytest.raises(Killed):
            ingest(ListReader(frames), store, small(profile), assignments=path)
    assert store.recordings()[0].done
    assert path.exists() == (dies_at == "after")
    ingest(ListReader(frames), store, small(profile), assignments=path)
    assert rows_of(path) == wanted
    assert files_in(tmp_path) == ["out.jsonl"]


def test_a_recording_that_grew_after_such_a_death_is_told_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()

    def die(*_: object) -> None:
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", die)
        with pytest.raises(Killed):
            ingest(ListReader(frames[:20]), store, small("paper"), assignments=path)
    ingest(ListReader(frames), store, small("paper"), assignments=path)
    rows = sum(len(frame.detections or ()) for frame in frames)
    assert [row["row"] for row in rows_of(path)] == list(range(rows))
    assert files_in(tmp_path) == ["out.jsonl"]


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_a_rerun_leaves_a_whole_file_alone(tmp_path: Path, profile: str) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    ingest(ListReader(frames), store, small(profile), assignments=path)
    before, wanted = path.stat(), path.read_bytes()
    assert ingest(ListReader(frames), store, small(profile), assignments=path).already
    after = path.stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    assert path.read_bytes() == wanted
    assert files_in(tmp_path) == ["out.jsonl"]


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_detections_without_a_place_are_told_too(tmp_path: Path, profile: str) -> None:
    frames, path, store = [], tmp_path / "out.jsonl", OracleStore()
    for frame in world():
        bare = [replace(d, position=None, covariance=None) for d in frame.detections or ()]
        frames.append(replace(frame, pose=None, detections=tuple(bare)))
    ingest(ListReader(frames), store, small(profile), assignments=path)
    assert len(rows_of(path)) == store.recordings()[0].detections > 0
    assert ingest(ListReader(frames), store, small(profile), assignments=path).already


def test_a_whole_file_is_gone_on_with_where_the_recording_grew(tmp_path: Path) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    ingest(ListReader(frames[:20]), store, small("default"), assignments=path)
    first = rows_of(path)
    ingest(ListReader(frames), store, small("default"), assignments=path)
    rows = rows_of(path)
    assert [row["row"] for row in rows[: len(first)]] == [row["row"] for row in first]
    assert [row["row"] for row in rows] == list(range(len(rows)))
    assert len(rows) == sum(len(frame.detections or ()) for frame in frames)
    stays = {(stay.object_id, stay.place) for stay in store.stays()}
    assert {(row["object_id"], row["place"]) for row in rows if row["why"] is None} <= stays


@pytest.mark.parametrize(
    ("profile", "stopped_at"), [("default", None), ("default", 20), ("paper", None)]
)
@pytest.mark.parametrize("more", [0, 10])
def test_what_people_made_one_or_two_since_is_told_so(
    tmp_path: Path, profile: str, more: int, stopped_at: int | None
) -> None:
    """Also of rows that were written before they said it, and once it was taken back."""
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()

    def go_on(count: int, most: int | None = None) -> list[dict[str, object]]:
        given = small(profile)
        ingest(ListReader(frames[:count]), store, given, max_frames=most, assignments=path)
        stays = {stay.key for stay in store.stays()}
        rows = rows_of(path)
        assert {(row["object_id"], row["place"]) for row in rows if row["why"] is None} <= stays
        return rows

    before = go_on(20 if stopped_at is None else FRAMES, stopped_at)
    a, b, *_ = (record.object_id for record in store.objects() if not record.volatile)
    teaching.merge(store, a, b, force=True)
    rows = go_on(20 + more)
    assert {row["row"] for row in rows if row["object_id"] == a} >= {
        row["row"] for row in before if row["object_id"] in (a, b)
    }
    place = store.stays(object_ids=[a])[-1].place
    new = teaching.split(store, a, place).arguments["new"]
    rows = go_on(20 + more)
    assert sum(row["object_id"] == new for row in rows) > 0
    teaching.undo(store)
    assert new not in {row["object_id"] for row in go_on(FRAMES)}


@pytest.mark.parametrize("cut", ["half a line", "a line less", "undecided", "not ours", "gone"])
def test_a_file_that_is_not_whole_is_refused_and_left(tmp_path: Path, cut: str) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    ingest(ListReader(frames), store, small("default"), assignments=path)
    text = path.read_text(encoding="utf-8")
    undecided = json.dumps(rows_of(path)[0] | {"object_id": None, "why": assignments.UNDECIDED})
    damaged = {
        "half a line": text[:-20],
        "a line less": text[text.index("\n") + 1 :],
        "undecided": undecided + text[text.index("\n") :],
        "not ours": "a letter\n",
        "gone": "",
    }[cut]
    path.write_text(damaged, encoding="utf-8")
    if cut == "gone":
        path.unlink()
    with pytest.raises(BadInput, match=r"neither out\.jsonl nor out\.jsonl\.part tells"):
        ingest(ListReader(frames), store, small("default"), assignments=path)
    assert files_in(tmp_path) == ([] if cut == "gone" else ["out.jsonl"])
    assert cut == "gone" or path.read_text(encoding="utf-8") == damaged


def test_a_folder_that_is_none_is_refused_before_anything_is_stored(tmp_path: Path) -> None:
    store = OracleStore()
    (tmp_path / "letter").write_text("a letter")
    for folder in ("nowhere", "letter"):
        path = tmp_path / folder / "out.jsonl"
        with pytest.raises(BadInput, match=f"{folder} is no folder"):
            ingest(ListReader(world()), store, small("default"), assignments=path)
    assert list(store.recordings()) == []


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_detections_of_frames_that_are_left_out_are_told_with_why(
    tmp_path: Path, profile: str
) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    late = replace(frames[10], name="late", time_ms=frames[3].time_ms)
    frames[10] = late
    wanted = [None if n % 4 == 0 else NOT_EACH for n in range(FRAMES)]
    wanted[10] = BACKWARDS
    intake = Intake(every=4)
    parameters = small(profile)
    ingest(ListReader(frames), store, parameters, assignments=path, intake=intake, max_frames=3)
    for _ in range(2):
        ingest(ListReader(frames), store, parameters, assignments=path, intake=intake)
        told = {row["row"]: row["why"] for row in rows_of(path)}
        assert len(told) == len(rows_of(path))
        for frame, why in zip(frames, wanted, strict=True):
            for each in frame.detections or ():
                assert told[each.row] == why or why is None
    taken = sum(row["object_id"] is not None for row in rows_of(path))
    assert 0 < taken <= store.recordings()[0].detections


class _Finds:
    """Finds a cup in each frame."""

    classes = ("cup",)
    identity = "finds"

    def detect(self, frame: Frame, pixels: object) -> tuple[Detection, ...]:
        return (Detection("cup", 0.9, (10, 10, 20, 20)),)


def test_boxes_that_a_detector_replaces_are_not_told(tmp_path: Path) -> None:
    frames, path = world(), tmp_path / "out.jsonl"
    intake = Intake(every=4)
    ingest(
        ListReader(frames),
        OracleStore(),
        DEFAULT,
        detector=_Finds(),
        assignments=path,
        intake=intake,
    )
    assert [row["row"] for row in rows_of(path)] == [None] * len(range(0, FRAMES, 4))


@pytest.mark.parametrize("cut", [None, 8])
def test_the_paper_counts_what_its_association_leaves_out(tmp_path: Path, cut: int | None) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    for number, row in ((3, 1000), (20, 1001), (FRAMES - 1, 1002)):
        slip = Detection("vase", 0.5, (1, 1, 9, 9), (0.0, 0.0, float(number)), row=row)
        seen = (*(frames[number].detections or ()), slip)
        frames[number] = replace(frames[number], detections=seen)
    if cut is not None:
        ingest(ListReader(frames), store, small("paper"), assignments=path, max_frames=cut)
    summary = ingest(ListReader(frames), store, small("paper"), assignments=path)
    left_out = [row for row in rows_of(path) if row["why"] == NOISE]
    assert summary.skipped.counts == {NOISE: len(left_out)}
    assert {1000, 1001, 1002} <= {row["row"] for row in left_out}


def test_what_another_recording_left_open_is_not_told_as_this_ones(tmp_path: Path) -> None:
    frames, path, store = world(), tmp_path / "out.jsonl", OracleStore()
    ingest(ListReader(frames), store, small("paper"), max_frames=7)
    later = [
        replace(frame, name=f"g{n}", time_ms=frame.time_ms + 86_400_000)
        for n, frame in enumerate(frames)
    ]
    ingest(ListReader(later), store, small("paper"), assignments=path)
    assert all(str(row["frame"]).startswith("g") for row in rows_of(path))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no full device")
def test_a_full_disk_ends_it_with_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "out.jsonl"
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        log = AssignmentLog(path, full)
        with pytest.raises(BadInput, match=r"out\.jsonl cannot be written: .* goes on from what"):
            log.mark(3)
        with pytest.raises(BadInput, match="cannot be written"):
            log.finish({}, done=True)
        with pytest.raises(BadInput, match="cannot be written"):
            log.close()
