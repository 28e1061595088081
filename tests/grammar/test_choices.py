"""Questions that ask for one thing or another: how each is spelled, and when they are one."""

from __future__ import annotations

from datetime import datetime

import pytest

from grammar import parse
from grammar.errors import Ambiguous

NOW = datetime.fromisoformat("2020-01-01T18:00:00-05:00")


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("Where is the laptop or the kettle?", ("Where is the laptop?", "Where is the kettle?")),
        ("the laptop or the kettle?", ("the laptop?", "the kettle?")),
        (
            "How many cups and bowls are on the counter?",
            ("How many cups are on the counter?", "How many bowls are on the counter?"),
        ),
        (
            "did the cup and the bowl on the table next to the sofa move yesterday",
            (
                "did the cup on the table next to the sofa move yesterday",
                "did the bowl on the table next to the sofa move yesterday",
            ),
        ),
        (
            "Were the cup and the bowl between the lamp and the vase?",
            (
                "Were the cup between the lamp and the vase?",
                "Were the bowl between the lamp and the vase?",
            ),
        ),
        (
            "what is on the table and on the chair?",
            ("what is on the table?", "what is on the chair?"),
        ),
        (
            "Where was my cup or bowl this morning?",
            ("Where was my cup this morning?", "Where was my bowl this morning?"),
        ),
        (
            "where were Anna's red cup, bowl or blue plate in the kitchen?",
            (
                "where were Anna's red cup in the kitchen?",
                "where were Anna's bowl in the kitchen?",
                "where were Anna's blue plate in the kitchen?",
            ),
        ),
        (
            "where was the cup, the bowl or the kettle today?",
            (
                "where was the cup today?",
                "where was the bowl today?",
                "where was the kettle today?",
            ),
        ),
        ("where is a cup or apple", ("where is a cup", "where is an apple")),
        ("where is a bowl or the cup", ("where is a bowl", "where is the cup")),
        ("where are two cups or bowls", ("where are two cups", "where are bowls")),
        (
            "what was on the table and on the chair yesterday",
            ("what was on the table yesterday", "what was on the chair yesterday"),
        ),
        (
            "um, can you tell me where the cup or the bowl is please",
            (
                "um, can you tell me where the cup is please",
                "um, can you tell me where the bowl is please",
            ),
        ),
    ],
)
def test_each_choice_is_the_question_with_one_thing_said(
    text: str, offered: tuple[str, ...]
) -> None:
    with pytest.raises(Ambiguous) as caught:
        parse(text, now=NOW)
    assert caught.value.suggestions == offered


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("anna's or tom's keys", ("Where is anna's key?", "Where is tom's key?")),
        (
            "what was on or under the table",
            ("What is on the table?", "What is under the table?"),
        ),
    ],
)
def test_what_cannot_be_cut_out_of_the_text_is_spelled(text: str, offered: tuple[str, ...]) -> None:
    with pytest.raises(Ambiguous) as caught:
        parse(text, now=NOW)
    assert caught.value.suggestions == offered


@pytest.mark.parametrize(
    "text",
    [
        "Where is the laptop or the kettle?",
        "what is on the table and on the chair?",
        "is the book under or on the table",
        "is the lamp on the left or right of the bed",
        "where are anna's or tom's keys",
    ],
)
def test_each_choice_means_its_reading(text: str) -> None:
    with pytest.raises(Ambiguous) as caught:
        parse(text, now=NOW)
    for said, meant in zip(caught.value.suggestions, caught.value.readings, strict=True):
        got = parse(said, now=NOW)
        assert (got.objects, got.relation, got.place, got.ask, got.time) == (
            meant.objects,
            meant.relation,
            meant.place,
            meant.ask,
            meant.time,
        )


def test_near_two_things_is_one_place() -> None:
    found = parse("what is near the table and the lamp", now=NOW)
    assert [term.category for term in found.objects] == ["object", "table", "lamp"]
