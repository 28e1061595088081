"""Formal queries as text: their JSON record, the notation in any order, and wrong fields."""

from __future__ import annotations

import json

import pytest

import d3a
from assistant.asking import ask, read_question
from grammar.forms import FormalQuery, FormError, ObjectTerm
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def store() -> OracleStore:
    home = Home(classes=("cup",))
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 50, at=(1, 1, 1))
    store = OracleStore()
    home.into(store)
    return store


def test_a_record_is_read_as_text_too(store: OracleStore) -> None:
    query = read_question(store, "Where is the red cup?", now=NOW)
    record = json.dumps(query.to_json())
    assert read_question(store, record, now=NOW) == query
    assert ask(store, record, now=NOW).answer == ask(store, query.text, now=NOW).answer
    for broken, said in (
        ('{"text": ', "The record breaks off"),
        ("{}", "The record makes no query"),
    ):
        refused = ask(store, broken, now=NOW)
        assert (refused.status, refused.answer.startswith(said)) == ("not_understood", True)


def test_a_noun_may_stand_before_what_describes_it_in_the_notation(store: OracleStore) -> None:
    for line in ("cup(x), red(x) | OIc.find(x)", "red(x), cup(x) | OIc.find(x)"):
        (term,) = read_question(store, line, now=NOW).objects
        assert term == ObjectTerm("cup", "cup", ("red",))


def test_a_wrong_field_is_an_error_of_d3a() -> None:
    with pytest.raises(d3a.D3AError, match="ask is 'zz'"):
        FormalQuery("", "Q1", "zz")  # type: ignore[arg-type]
    assert issubclass(FormError, ValueError)
