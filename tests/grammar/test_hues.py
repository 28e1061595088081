"""Every name of the public lists is a look where it is said of a thing, and a thing elsewhere."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest

from d3a.answering.attributes import merged_shades
from d3a.colours import is_colour
from d3a.colours.names import table
from grammar.errors import QuestionError
from grammar.forms import FormalQuery
from grammar.parser import parse
from grammar.vocabulary import lexicon
from grammar.vocabulary.hues import as_said, carried, hues

NOW = datetime(2026, 5, 14, 20, 30, tzinfo=UTC)
NAMES = sorted({" ".join(name) for name in table().names})
MADE_OF = {"brick", "clay", "denim", "leather", "linen", "steel", "stone", "straw", "velvet"}
HELD = hues().things | {"cement", "dark", "pale", "red wine"}
"""What a cup may hold, and words that say of any colour how it is."""


def asked(text: str) -> FormalQuery:
    return parse(text, now=NOW)


def looks(text: str) -> tuple[str, tuple[str, ...]]:
    (term,) = asked(text).objects
    return term.category, term.attributes


def test_the_names_are_those_of_the_lists() -> None:
    known = {" ".join(name) for names in hues().beginning.values() for name in names}
    colours = {word for word, kind in lexicon().attributes.items() if kind == "colour"}
    assert known <= set(NAMES)
    assert set(NAMES) - known - colours == MADE_OF | {
        "cement", "dark", "mahogany", "pine", "terracotta"
    }  # fmt: skip


@pytest.mark.parametrize(
    "saying", ["Where is my {} chair?", "Is there a {} sofa?", "How many {} chairs are there?"]
)
def test_every_name_is_a_look_before_furniture(saying: str) -> None:
    wrong = []
    for name in NAMES:
        category, attributes = looks(saying.format(name))
        merged = merged_shades(attributes)
        right = category in ("chair", "couch") and merged == [name] and is_colour(merged[0])
        if not right and name not in MADE_OF:
            wrong.append((name, category, attributes))
    assert [name for name, _, _ in wrong] == ["cement", "dark", "pale"]


@pytest.mark.parametrize("saying", ["Is my cup {}?", "Which of the cups is {}?"])
def test_every_name_is_a_look_where_it_is_said_of_a_thing(saying: str) -> None:
    wrong = []
    for name in NAMES:
        try:
            told = looks(saying.format(name))
        except QuestionError:
            told = ("", ())
        if told != ("cup", (name,)):
            wrong.append(name)
    assert set(wrong) <= {"cement", "dark", "red wine"}


@pytest.mark.parametrize("name", sorted(set(NAMES) - HELD - MADE_OF))
def test_a_name_before_a_cup_is_a_look_unless_a_cup_may_hold_it(name: str) -> None:
    assert looks(f"Did you see the {name} mug?") == ("cup", (name,))


@pytest.mark.parametrize(
    ("said", "category", "attributes"),
    [
        ("Where is the lime cup?", "cup", ("lime",)),
        ("Where is the lime?", "lime", ()),
        ("Is there a rose pillow?", "pillow", ("rose",)),
        ("Is there a rose?", "rose", ()),
        ("Is there a red rose?", "rose", ("red",)),
        ("Where is the vase with the rose?", "vase", ()),
        ("Where is my burnt-sienna cup?", "cup", ("burnt sienna",)),
        ("Where is the Light Goldenrod cup?", "cup", ("light goldenrod",)),
        ("Where is my lightgray cup?", "cup", ("lightgray",)),
        ("Where is my slate gray cup?", "cup", ("slate gray",)),
        ("Where is the blue and green cup?", "cup", ("blue", "green")),
        ("Where is the blue green cup?", "cup", ("blue green",)),
        ("Where is the big apple green plastic bowl?", "bowl", ("big", "apple green", "plastic")),
        ("Where is the wine glass?", "wine glass", ()),
        ("Where is the wine sofa?", "couch", ("wine",)),
        ("Where is the wine-coloured bottle?", "bottle", ("wine-coloured",)),
        ("Where is the orange orange?", "orange", ("orange",)),
        ("Where is the orange?", "orange", ()),
        ("Where is the light green one?", "object", ("light green",)),
        ("Are there dark or light blue cups?", "cup", ("dark blue",)),
        ("Where is the rose colored pillow?", "pillow", ("rose",)),
        ("Where is the wine coloured bottle?", "bottle", ("wine",)),
        ("Where is the jade plant?", "jade plant", ()),
        ("Is there anything burnt orange?", "object", ("burnt orange",)),
        ("Did you see something lime green?", "object", ("lime green",)),
        ("Where is the Rose Gold phone?", "cell phone", ("rose", "gold")),
        ("Did you see a burnt orange or red cup?", "cup", ("burnt orange",)),
        ("Did you see a red or burnt orange cup?", "cup", ("red",)),
        ("Where is the cup that is burnt orange?", "cup", ("burnt orange",)),
    ],
)
def test_the_place_in_the_sentence_decides(
    said: str, category: str, attributes: tuple[str, ...]
) -> None:
    term = asked(said).objects[0]
    assert (term.category, term.attributes) == (category, attributes)


def test_a_name_may_be_denied_of_a_thing() -> None:
    (term,) = asked("Where is the cup which isn't apple green?").objects
    assert (term.category, term.without) == ("cup", ("apple green",))


@pytest.mark.parametrize("said", ["What is tea?", "What is wine?"])
def test_what_a_thing_is_is_not_asked_of_a_memory(said: str) -> None:
    with pytest.raises(QuestionError):
        asked(said)


def test_a_carried_name_is_said_as_it_was() -> None:
    assert as_said(carried("robin's egg blue")) == "robin's egg blue"
    assert as_said(f"light {carried('burnt sienna')}") == "light burnt sienna"
    assert as_said("a blue-huede cup") == "a blue-huede cup"
