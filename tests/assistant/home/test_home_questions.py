"""The demo home's questions, asked of the product: what is told against what was true there."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest

from assistant.asking import ask, store_now
from assistant.cli import clock
from assistant.home.folder import recording_folder
from assistant.phrases import newest_of
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store import open_store
from d3a.store.base import Store

QUESTIONS: list[dict[str, Any]] = tomllib.loads(
    (recording_folder().parent / "questions.toml").read_text(encoding="utf-8")
)["question"]


@pytest.fixture(scope="session")
def home_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with closing(open_store(str(tmp_path_factory.mktemp("home") / "home.db"))) as store:
        ingest(open_source(recording_folder()), store, DEFAULT)
        yield store


@pytest.mark.parametrize("fact", QUESTIONS, ids=lambda fact: fact["text"])
def test_what_is_told_is_true(home_store: Store, fact: dict[str, Any]) -> None:
    answer = ask(home_store, fact["text"], now=store_now(home_store, None, clock))
    if not fact.get("seen", True):
        assert answer.status in ("not_found", "unknown_object"), answer.answer
        assert answer.keyframes == ()
        return
    assert answer.status == "found", answer.answer
    if "count" in fact:
        assert answer.value is not None
        assert answer.value <= fact["count"] <= answer.count
        return
    told = answer.keyframes[0]
    if answer.query is not None and answer.query.ask == "whether":
        told = newest_of(answer)  # a yes tells when it was last
    assert told.place == fact["region"], answer.answer
    if fact.get("alone"):
        kinds = {name.rpartition("-")[0] for name in fact["objects"]}
        assert kinds <= {keyframe.category for keyframe in answer.keyframes}
        assert "I last saw" in answer.answer  # of each thing its last look, which may be older
        assert " key" not in answer.answer  # seen there this morning, and elsewhere since
        return
    assert told.start < fact["end"], answer.answer
    assert told.end >= fact["start"], answer.answer
