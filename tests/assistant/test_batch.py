"""Many questions: an answer a line, in order, whatever the lines are."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assistant.batch import run
from d3a.store.base import Store
from tests.worlds.made import NOW, Home, at
from tests.worlds.oracle import OracleStore


@pytest.fixture(scope="module")
def store() -> Store:
    home = Home()
    home.thing("cup", "cup")
    home.seen("cup", 0, 10)
    return home.into(OracleStore())


def test_lines_of_text_and_of_json_in_order(store: Store) -> None:
    lines = [
        "Did you see a cup?\n",
        "\n",
        json.dumps({"id": 7, "text": "Did you see a bowl?"}),
        json.dumps({"id": "b", "text": "Did you see a cup?", "now": "2024-05-14T12:20:00-04:00"}),
    ]
    answers = list(run(store, lines, now=NOW))
    assert [(a.id, a.status) for a in answers] == [
        (None, "found"),
        (None, "not_understood"),
        ("7", "unknown_object"),
        ("b", "found"),
    ]
    assert answers[1].answer == "This line is empty."
    assert "10 minutes ago" in answers[3].answer
    assert answers[3].query is not None
    assert answers[3].query.text == "Did you see a cup?"


def test_a_record_s_now_without_an_offset_is_the_home_s(store: Store) -> None:
    line = json.dumps({"text": "Did you see a cup today?", "now": "2024-05-14T12:20:00"})
    (answer,) = run(store, [line], now=NOW)
    assert answer.status == "found"
    assert answer.keyframes[0].end == at(10)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("{", "not JSON"),
        ('{"id": 1}', "no question"),
        ('{"text": ""}', "no question"),
        ('{"text": 5}', "no question"),
        ('{"text": "Did you see a cup?", "now": "noon"}', "not an ISO time"),
        ('{"a":' * 5000, "nested too deeply"),
    ],
)
def test_a_bad_line_is_a_record_and_not_a_stop(store: Store, line: str, said: str) -> None:
    bad, good = run(store, [line, "Did you see a cup?"], now=NOW)
    assert bad.status == "not_understood"
    assert said in (bad.message or "")
    assert good.status == "found"


@settings(deadline=None, max_examples=40)
@given(st.lists(st.text(max_size=60), max_size=5))
def test_any_text_is_answered(lines: list[str]) -> None:
    answers = list(run(OracleStore(), lines, now=NOW))
    assert len(answers) == len(lines)
    for answer in answers:
        json.dumps(answer.to_json())


def test_limit_reaches_every_answer(store: Store) -> None:
    (answer,) = run(store, ["Did you see a cup?"], now=NOW, limit=0)
    assert answer.keyframes == ()
    assert answer.truncated
