"""The baselines: what they store, and how Naive+ spreads an answer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path

import pytest

from d3a.answer import Answer, RankedKeyframe
from d3a.baselines import diversify, fill_naive, moments_of
from d3a.readers.recording import RecordingReader
from d3a.simulate import simulate
from d3a.store.base import Store
from d3a.store.opening import open_store

SEEN = datetime(2020, 1, 1, tzinfo=UTC)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("naive") / "world"
    simulate(folder, hours=0.5, seed=1, depth=False)
    return folder


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    opened = open_store(str(tmp_path / "naive.db"))
    yield opened
    opened.close()


def test_naive_stores_every_detection_as_an_object(recording: Path, store: Store) -> None:
    run = fill_naive(RecordingReader(recording), store)
    lines = (recording / "detections.jsonl").read_text(encoding="utf-8").splitlines()
    assert run.detections == len(lines) == len(store.objects()) == len(store.sightings())
    assert sorted(run.assignments) == list(range(len(lines)))
    assert len(set(run.assignments.values())) == len(lines)
    assert store.encounters() == []
    assert store.check() == []


def test_naive_keeps_what_a_question_needs(recording: Path, store: Store) -> None:
    run = fill_naive(RecordingReader(recording), store)
    (done,) = store.recordings()
    assert (done.frames, done.detections, done.done) == (run.frames, run.detections, True)
    assert store.last_view_ms() == done.last_ms
    assert store.meta("zone") == "America/New_York"
    parameters = store.meta("parameters")
    assert parameters is not None
    assert parameters["profile"] == "paper"


def test_naive_plus_keeps_every_pair_of_a_frame(recording: Path, store: Store) -> None:
    fill_naive(RecordingReader(recording), store, together=True)
    per_frame: dict[str, int] = {}
    for sighting in store.sightings():
        per_frame[sighting.frame] = per_frame.get(sighting.frame, 0) + 1
    pairs = sum(n * (n - 1) // 2 for n in per_frame.values())
    encounters = store.encounters()
    assert len(encounters) == pairs > 0
    assert all(e.object_a < e.object_b for e in encounters)
    assert store.check() == []


def keyframe(
    rank: int, category: str, x: float | None, *, frame: str = "f", group: int | None = None
) -> RankedKeyframe:
    return RankedKeyframe(
        rank=rank,
        score=1.0 / rank,
        object_id=f"o{rank}",
        category=category,
        frame=frame,
        probability=0.9,
        box=None,
        start=SEEN,
        end=SEEN,
        position=None if x is None else (x, 0.0, 0.0),
        group=group,
    )


def ids(answer: Answer) -> Sequence[str]:
    return [one.object_id for one in answer.keyframes]


def test_diversified_answer_takes_turns_between_cells() -> None:
    cells = [("cup", 0.1), ("cup", 0.9), ("cup", 1.1), ("cup", 0.2), ("bowl", 0.1), ("cup", 1.2)]
    found = Answer(keyframes=tuple(keyframe(k, c, x) for k, (c, x) in enumerate(cells, 1)))
    spread = diversify(found)
    assert ids(spread) == ["o1", "o3", "o5", "o2", "o6", "o4"]
    assert [one.rank for one in spread.keyframes] == [1, 2, 3, 4, 5, 6]


def test_diversified_moments_cover_new_pairs_first_and_a_frame_once() -> None:
    rows = [("a", 0.0, 1.0), ("a", 0.0, 1.0), ("a", 0.0, 2.0), ("b", 0.0, 1.0), ("c", 0.0, 5.0)]
    keyframes: list[RankedKeyframe] = []
    for group, (frame, x, y) in enumerate(rows, 1):
        for category, place in (("cup", x), ("bowl", y)):
            rank = len(keyframes) + 1
            keyframes.append(keyframe(rank, category, place, frame=frame, group=group))
    spread = diversify(Answer(keyframes=tuple(keyframes)))
    groups = [moment[0].group for moment in moments_of(spread)]
    assert groups == [1, 5, 2, 3, 4]
    assert sorted(ids(spread)) == sorted(ids(Answer(keyframes=tuple(keyframes))))


def test_empty_answer_stays_empty() -> None:
    assert diversify(Answer()).keyframes == ()


def test_keyframe_without_a_position_is_a_cell_of_its_category() -> None:
    found = Answer(keyframes=(keyframe(1, "cup", None), keyframe(2, "cup", None)))
    assert ids(diversify(found)) == ["o1", "o2"]
