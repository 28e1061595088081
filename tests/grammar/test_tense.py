"""The tense of a question: `now` says that it is asked for what is so, not what was ever seen."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest

from grammar import notation, parse
from grammar.forms import FormalQuery

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


@pytest.mark.parametrize(
    "text",
    [
        "Is the wallet in the hall?",
        "What's on the table?",
        "How many cups are in the kitchen?",
        "Is there a lamp?",
        "Do I still have a lamp?",
        "Is the cup to the left of the bowl?",
        "Did I leave the bag on the couch?",
        "Have I left my keys in the kitchen?",
        "Has the bag been left on the couch?",
        "What did I forget in the bedroom?",
        "Is the book that was on the bed still there?",
        "Is the book I left on the bed still there?",
        "Are the keys you saw on the shelf there?",
        "Where is the book that was on the bed?",
        "Since when is the lamp on the desk?",
        "How long has the lamp been on the desk?",
    ],
)
def test_the_present_is_told_by_the_verb(text: str) -> None:
    assert parse(text, now=NOW).now


@pytest.mark.parametrize(
    "text",
    [
        "Was the wallet in the hall?",
        "What was on the table?",
        "Did you see a cup in the kitchen?",
        "Has the wallet been in the hall?",
        "Has the cup been to the left of the bowl?",
        "Did I ever leave my keys in the kitchen?",
        "Did I leave my keys in the kitchen yesterday?",
        "Where are my keys?",
        "Where was the book that was on the bed?",
        "How long was the lamp on the desk?",
    ],
)
def test_the_past_and_a_time_that_is_named_are_not_the_present(text: str) -> None:
    assert not parse(text, now=NOW).now


def test_the_present_is_in_the_record_and_in_the_notation() -> None:
    query = parse("Is the wallet in the hall?", now=NOW)
    assert FormalQuery.from_json(query.to_json()) == query
    assert replace(notation.read(query.formal, now=NOW), text=query.text) == query
    assert "now" not in parse("Was the wallet in the hall?", now=NOW).to_json()
