"""Questions over too many sightings to read one by one have the answers of those read whole."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from datetime import datetime, timedelta
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from assistant.asking import ask, ask_query, store_now
from d3a.answer import Answer
from d3a.answering import facts, late, many
from d3a.store import open_store
from d3a.store.base import Batch, NativeQuery, Region, Store
from grammar.forms import (
    ASKS,
    RELATION_KINDS,
    SELECTS,
    Ask,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
)
from tests.bench import bench_forms
from tests.worlds import drawn, scaled
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

SAID = (
    "How many cups did you see?",
    "How many things are there?",
    "How many cups are in the kitchen?",
    "How many books were in the kitchen yesterday?",
    "How long did you see the cup?",
    "How often did you see the book in the kitchen?",
    "Did you see more than three cups?",
    "What is in the kitchen?",
    "What is in the den?",
    "Is the cup in the den?",
    "Is the lamp in the kitchen?",
    "Was the cup ever in the kitchen?",
    "Was the cup ever in the den?",
    "When was the book last in the office?",
    "Did you see a cup outside the kitchen?",
    "What was the first thing you saw in the kitchen?",
    "What is missing?",
    "What is missing from the kitchen?",
    "What went missing yesterday?",
    "What moved yesterday?",
    "What moved in the den?",
    "Did the cup move?",
    "Where is the cup usually?",
    "What is usually in the kitchen?",
    "What is usually in the den?",
    "What was usually in the office yesterday?",
    "How long was the cup in the kitchen?",
    "How long was the book in the den yesterday?",
    "Since when has the cup been in the kitchen?",
    "How long has the book been in the den?",
    "How long were things in the attic?",
    "Was the cup in the kitchen or in the den?",
    "What is in the office or the kitchen?",
    "What is not in the kitchen?",
    "How many cups are not in the den?",
    "Which books were not in the office yesterday?",
    "What did you see outside the den?",
    "What moved outside the kitchen yesterday?",
    "Is the cup usually in the kitchen or the den?",
    "Did you see a cup and a book?",
    "Is there a zebra in the kitchen?",
    "How many cups were together?",
    "How many things were together yesterday?",
    "How many umbrellas were together?",
    "How often was the cup with the book?",
    "How often was the cup with a thing yesterday?",
    "How often was the umbrella with the couch?",
    "How long was the cup with the book?",
    "How long was the book with the bottle yesterday?",
    "How many cups were with a book?",
    "How many things were with a cup?",
    "How long was a thing with the cup in the kitchen?",
    "How often was a thing with the cup in the den?",
    "How many things were together in the den?",
    "How many things were with a cup outside the kitchen?",
    "How many things were near a cup?",
    "How often was a thing next to the couch?",
    "How long was the cup near a book?",
    "How many things were to the left of a cup?",
    "How many things are next to the couch?",
    "How many things are on the table?",
)
DEN = Region("den", ((1.0, 1.0), (9.0, 2.0), (8.0, 9.0), (4.0, 4.0)))
"""A room that is no box."""


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """A small drawn home, of which some things were then seen gone."""
    path = tmp_path_factory.mktemp("many") / "home.db"
    opened = open_store(str(path))
    scaled.fill(opened, 300, seed=5)
    stays = opened.stays()
    last = {stay.object_id: stay for stay in sorted(stays, key=lambda s: s.last_ms)}
    gone = [replace(stay, last_absent_ms=stay.last_ms + 60_000) for stay in [*last.values()][::3]]
    opened.apply(Batch(stays=gone, regions=[DEN]))
    return opened


def told(answer: Answer) -> dict[str, Any]:
    record = answer.to_json()
    del record["elapsed_ms"]
    return record


def read_as(monkeypatch: pytest.MonkeyPatch, whole: int) -> None:
    """Have so many sightings read whole at most, and nothing known from before."""
    facts.forget()
    for module in (facts, late, many):
        monkeypatch.setattr(module, "MOST_WHOLE", whole)


@pytest.mark.parametrize("said", SAID)
def test_columns_give_the_answer_of_records(
    store: Store, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = store_now(store, "last", lambda: NOW)
    answers = []
    for whole in (100_000, 0):
        read_as(monkeypatch, whole)
        answers.append(told(ask(store, said, now=now, limit=2_000)))
    assert answers[1] == answers[0]


def test_the_bench_times_every_form_once(store: Store) -> None:
    forms = [*bench_forms.forms(store_now(store, "last", lambda: NOW))]
    assert len({*forms}) == len(forms)
    assert {form.ask for form in forms} == {*ASKS}
    assert {form.select for form in forms} == {*SELECTS}
    assert {form.relation.kind for form in forms if form.relation} == {*RELATION_KINDS}


@given(home=drawn.homes(), query=drawn.queries())
@settings(
    max_examples=40,
    deadline=None,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],  # shrinking takes minutes
    suppress_health_check=list(HealthCheck),
)
def test_drawn_queries_have_the_answers_of_records(home: Home, query: FormalQuery) -> None:
    store = OracleStore()
    home.into(store)
    answers = []
    with pytest.MonkeyPatch.context() as patch:
        for whole in (100_000, 0):
            read_as(patch, whole)
            answers.append(told(ask_query(store, query, now=NOW, limit=500)))
    assert answers[1] == answers[0]


@given(
    home=drawn.homes(),
    ask=st.sampled_from(("count", "how_long", "how_often")),
    kind=st.just("together") | st.sampled_from(RELATION_KINDS),
    select=st.sampled_from(("all", "last")),
    place=st.none() | st.sampled_from(drawn.ROOMS),
    words=st.lists(st.sampled_from(drawn.WORDS), min_size=1, max_size=2),
    time=st.none() | drawn.slices(),
)
@settings(
    max_examples=100,
    deadline=None,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
def test_what_stood_in_a_relation_is_counted_as_of_records(
    home: Home,
    ask: Ask,
    kind: RelationKind,
    select: Select,
    place: str | None,
    words: list[str],
    time: TimeSlice | None,
) -> None:
    store = OracleStore()
    home.into(store)
    words = words if kind == "together" else [words[0], words[-1]]
    terms = tuple(ObjectTerm(word, word, var=var) for word, var in zip(words, "xy", strict=False))
    query = FormalQuery("drawn", "Q2", ask, terms, Relation(kind), place, time, select)
    answers = []
    with pytest.MonkeyPatch.context() as patch:
        for whole in (100_000, 0):
            read_as(patch, whole)
            answers.append(told(ask_query(store, query, now=NOW, limit=500)))
    assert answers[1] == answers[0]


@pytest.mark.parametrize(
    "said",
    [
        "How many things were together?",
        "How many things were with a cup?",
        "How often was the cup with a thing?",
        "How long was a thing with the cup?",
        "How often was a thing with the cup in the kitchen?",
        "How many things were next to the couch?",
        "How often was a thing next to the couch?",
    ],
)
def test_a_relation_is_counted_without_reading_all_sightings(
    store: Store, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = store_now(store, "last", lambda: NOW)
    read_as(monkeypatch, 0)
    monkeypatch.setattr(facts, "FEW_OBJECTS", 0)
    monkeypatch.setattr(type(store), "sightings", None)
    answer = ask(store, said, now=now, limit=1)
    assert answer.status == "found"
    assert answer.truncated
    assert (answer.value or 0) > 0


def test_what_was_seen_is_read_once_for_all_rooms(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = store_now(store, "last", lambda: NOW)
    read_as(monkeypatch, 0)
    monkeypatch.setattr(facts, "FEW_OBJECTS", 0)
    known: list[NativeQuery] = []
    store.tracing(known.append)
    answer = ask(store, "What is in each room?", now=now)
    store.tracing(None)
    assert answer.status == "found"
    reading = ("FROM sighting", "FROM stc", "CROSS JOIN sighting", "CROSS JOIN stc")
    texts = [one.text for one in known if any(part in one.text for part in reading)]
    asked = Counter(text for text in texts if "LIMIT :limit" not in text)  # whether they are many
    assert {text: number for text, number in asked.items() if number > 1} == {}


def test_what_the_limit_of_the_store_split_is_told_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    home, store = Home(), OracleStore()
    home.thing("o0", "cup")
    home.seen("o0", 0, 5)
    home.seen("o0", 5, 9, absent=100)
    home.into(store)
    answers = []
    for whole in (100_000, 0):
        read_as(monkeypatch, whole)
        answers.append(told(ask(store, "What is missing?", now=NOW)))
    assert answers[1] == answers[0]
    (missing,) = answers[1]["keyframes"]
    assert datetime.fromisoformat(missing["end"]) - datetime.fromisoformat(
        missing["start"]
    ) == timedelta(minutes=9)


def test_no_first_is_told_of_what_is_cut(store: Store) -> None:
    now = store_now(store, "last", lambda: NOW)
    said = "When did you see a cup?"
    whole, cut = (ask(store, said, now=now, limit=limit) for limit in (2_000, 2))
    assert cut.truncated
    assert not whole.truncated
    said_whole, said_cut = (one.answer.split(". ")[0] for one in (whole, cut))
    assert ", first " in said_whole
    assert " or more, last " in said_cut
    assert said_cut.split(" last ")[1] == said_whole.split(" last ")[1]
