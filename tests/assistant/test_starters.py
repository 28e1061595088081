"""What a talk begins with: what was seen lately, and questions that have an answer."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from assistant.lately import lately
from assistant.session import Session
from assistant.starters import starters
from d3a.answer import Answer
from d3a.store.base import Encounter, ObjectRecord, Sighting
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

BOX = (0.0, 0.0, 9.0, 9.0)


def home() -> OracleStore:
    store = OracleStore()
    small_home.fill(store)
    return store


def test_of_a_small_store_lately_is_all() -> None:
    store = home()
    assert lately(store) == store.sightings()


def test_of_a_large_store_lately_is_its_end() -> None:
    minute = 60_000
    seen = [Sighting("cup", 0, at * minute, at * minute, str(at), 0.9, BOX) for at in range(5000)]

    class Large(OracleStore):
        def sightings(self, **conditions: Any) -> list[Sighting]:
            after = [each for each in seen if each.end_ms >= (conditions.get("start_ms") or 0)]
            return after[: conditions["limit"]]

        def last_view_ms(self) -> int:
            return 5000 * minute

    found = lately(Large(), 50)
    assert len(found) == 50
    assert found[0].start_ms == 4940 * minute  # an hour holds as many
    assert lately(Large(), 100)[0].start_ms == (5000 - 8 * 60) * minute
    assert lately(Large(), 5001) == seen


def test_the_search_for_examples_reads_no_collection_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    store = home()
    found, met = store.objects, store.encounters

    def some(**conditions: Any) -> list[ObjectRecord]:
        assert conditions["ids"] is not None
        return found(**conditions)

    def some_met(**conditions: Any) -> list[Encounter]:
        assert conditions["object_ids"] is not None
        return met(**conditions)

    monkeypatch.setattr(store, "objects", some)
    monkeypatch.setattr(store, "encounters", some_met)
    monkeypatch.delattr(OracleStore, "stays")
    session = replace(small_home.session(store), alone=None)
    asked = [question for question in starters(session) if question]
    assert asked[0] == "Where are the keys?"
    assert "together" in asked[1]


def test_each_step_tries_one_question_and_keeps_those_with_an_answer() -> None:
    tried: list[str] = []

    def ask(text: str) -> Answer:
        tried.append(text)
        return Answer(text=text, status="found" if "ever" in text else "not_found")

    session: Session = replace(small_home.session(home()), ask=ask, alone=None)
    steps = list(starters(session))
    assert len(steps) == len(tried) > 5
    assert [step for step in steps if step] == [tried[-1]]
