"""The paper's own frames, asked: the questions of the sample, and what nobody wrote down."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import pytest

from assistant.asking import ask, store_now
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store import open_store
from d3a.store.base import Store


@pytest.fixture(scope="module")
def sample(shared: Path) -> Path:
    return shared / "data" / "kuri-sample"


@pytest.fixture(scope="module")
def store(sample: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with closing(open_store(str(tmp_path_factory.mktemp("kuri") / "kuri.db"))) as filled:
        ingest(open_source(sample), filled, DEFAULT)
        yield filled


def now_of(store: Store) -> datetime:
    return store_now(store, "last", lambda: datetime(2020, 3, 1, tzinfo=UTC))


def test_frames_of_the_sample_s_questions(store: Store, sample: Path) -> None:
    lines = (sample / "questions-dev.jsonl").read_text(encoding="utf-8").splitlines()
    wrong = []
    for record in map(json.loads, lines):
        answer, truth = ask(store, record["text"], now=now_of(store)), record["answer"]
        frames = [int(keyframe.frame) for keyframe in answer.keyframes[:3]]
        if truth["negative"]:
            good = answer.status in ("not_found", "unknown_object") and not frames
        else:
            good = bool(set(frames) & set(truth["frames_ok"]))
        if not good:
            wrong.append((record["text"], answer.status, frames))
    assert wrong == []


@pytest.mark.parametrize("colour", ["purple", "yellow"])
@pytest.mark.parametrize("thing", ["cup", "bottle", "refrigerator"])
def test_colours_that_are_not_there_are_refused(store: Store, colour: str, thing: str) -> None:
    answer = ask(store, f"Did you see a {colour} {thing}?", now=now_of(store))
    assert (answer.status, answer.reason) == ("not_found", "never")
