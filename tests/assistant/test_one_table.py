"""What the bench compares with: hand-written SQL over one table tells what Naive's store does."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing
from datetime import datetime
from pathlib import Path

import pytest

from assistant.asking import read_question, store_parameters
from assistant.evaluation.asking_stores import EVERYTHING, RETRIEVING
from assistant.lexicon import VocabularyLexicon
from d3a.answer import RankedKeyframe
from d3a.baselines import fill_naive
from d3a.execute import execute
from d3a.plan import Plan, plan
from d3a.readers.recording import RecordingReader
from d3a.simulate import simulate
from d3a.store import open_store
from d3a.store.base import Store
from tests.bench import one_table
from tests.bench.bench_scale import now_of

Asked = tuple[Store, datetime]


@pytest.fixture(scope="module")
def naive(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Asked]:
    folder = tmp_path_factory.mktemp("naive")
    simulate(folder / "world", hours=0.5, seed=1, depth=False)
    with closing(open_store(str(folder / "naive.db"))) as store:
        fill_naive(RecordingReader(folder / "world"), store)
        yield store, now_of(store)


def by_sql(asked: Asked, text: str, file: Path) -> list[RankedKeyframe]:
    store, now = asked
    query = read_question(store, text, now=now)
    with closing(one_table.fill(file, store)) as table:
        return one_table.ask(table, query, now, store_parameters(store))


def by_plan(asked: Asked, text: str) -> tuple[RankedKeyframe, ...]:
    store, now = asked
    parameters = store_parameters(store)
    query = read_question(store, text, now=now)
    steps = plan(query, parameters=parameters, precision="category").steps
    kept = Plan(query, tuple(step for step in steps if isinstance(step, RETRIEVING)))
    lexicon = VocabularyLexicon()
    return execute(kept, store, lexicon, now=now, limit=EVERYTHING, parameters=parameters).keyframes


@pytest.mark.parametrize(
    "text",
    [
        "Where is the chair?",
        "Did you see a red chair?",
        "Where did you last see the chair?",
        "When did you first see the chair?",
        "Did you see a chair this morning?",
    ],
)
def test_the_same_detections_are_told(naive: Asked, text: str, tmp_path: Path) -> None:
    ours, theirs = by_plan(naive, text), by_sql(naive, text, tmp_path / "table.db")
    assert ours
    assert {k.object_id for k in theirs} == {k.object_id for k in ours}
    assert [k.rank for k in theirs] == list(range(1, len(ours) + 1))
    known = {k.object_id: k for k in ours}
    for one in theirs:
        other = known[one.object_id]
        assert (one.frame, one.start, one.box) == (other.frame, other.start, other.box)
        repeat = other.why.get("repeat", 1.0)  # that of a list which shows new things first
        assert one.score == pytest.approx(other.score / repeat, abs=2e-4)


def test_two_are_told_of_one_frame_and_near(naive: Asked, tmp_path: Path) -> None:
    told = by_sql(naive, "Did you see a cup with a bottle?", tmp_path / "table.db")
    reach = store_parameters(naive[0]).together_m
    assert len(told) % 2 == 0
    assert told
    for one, other in zip(told[::2], told[1::2], strict=True):
        assert one.frame == other.frame
        assert one.position is not None
        assert other.position is not None
        assert math.dist(one.position, other.position) <= reach + 1e-9
