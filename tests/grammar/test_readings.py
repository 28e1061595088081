"""Readings that were once taken for something else, each by the rule that reads it now."""

from __future__ import annotations

from datetime import datetime

import pytest

from grammar import FormalQuery, QuestionError, parse

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


def read(text: str) -> FormalQuery:
    return parse(text, now=NOW)


@pytest.mark.parametrize(
    "text", ["did you see the cup but not the bowl", "did you see the cup and not the bowl"]
)
def test_one_thing_without_another_is_two_questions(text: str) -> None:
    with pytest.raises(QuestionError):
        read(text)


def test_what_else_lies_there_leaves_one_out() -> None:
    assert read("what is on the table but not the cup").objects[0].without == ("cup",)


@pytest.mark.parametrize(
    ("text", "word", "quantity"),
    [
        ("where is the five minute timer", "five minute timer", None),
        ("where is the 5 liter bottle", "5 liter bottle", None),
        ("where are the two cups", "cup", 2),
        ("did you see two wine glasses", "wine glass", 2),
    ],
)
def test_a_number_counts_many_and_measures_one(text: str, word: str, quantity: int | None) -> None:
    (term,) = read(text).objects
    assert (term.word, term.quantity) == (word, quantity)


@pytest.mark.parametrize(
    ("text", "word", "owner", "place"),
    [
        ("where are my keys kitchen", "key", "me", "kitchen"),
        ("remote control last night kitchen", "remote control", None, "kitchen"),
        ("where is the kitchen table", "kitchen table", None, None),
        ("where are anna s keys", "key", "anna", None),
        ("where are my sister anna's pills", "pill", "anna", None),
        ("where is the t v remote", "tv remote", None, None),
        ("where is the a4 paper", "a4 paper", None, None),
    ],
)
def test_words_that_a_recogniser_parts_or_runs_together(
    text: str, word: str, owner: str | None, place: str | None
) -> None:
    query = read(text)
    assert [(t.word, t.owner) for t in query.objects] == [(word, owner)]
    assert query.place == place


@pytest.mark.parametrize(
    ("text", "attributes"),
    [
        ("where is a bowl made of glass", ("glass",)),
        ("something made of glass yesterday", ("glass",)),
        ("something round and made of metal", ("round", "metal")),
    ],
)
def test_a_material_after_made_of_is_no_noun(text: str, attributes: tuple[str, ...]) -> None:
    assert [t.attributes for t in read(text).objects] == [attributes]


@pytest.mark.parametrize(
    ("text", "select"),
    [
        ("how long ago did you see my keys", "last"),
        ("how long ago did you first see my keys", "first"),
        ("what's the first time you saw the bowl on the counter", "first"),
    ],
)
def test_how_long_ago_is_of_the_last_time(text: str, select: str) -> None:
    query = read(text)
    assert (query.ask, query.select) == ("when", select)


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("is the milk cold", "Where is the milk?"),
        ("is the soup cold", "Where is the soup?"),
        ("where was the cup tomorrow", "Where is the cup?"),
    ],
)
def test_a_state_or_a_future_is_refused_with_what_may_be_asked_of_the_thing(
    text: str, offered: str
) -> None:
    with pytest.raises(QuestionError) as caught:
        read(text)
    assert caught.value.suggestions[0] == offered
