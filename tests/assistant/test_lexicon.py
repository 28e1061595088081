"""The vocabulary as d3a sees it."""

from __future__ import annotations

import pytest

from assistant.lexicon import VocabularyLexicon
from d3a.answering.match import BROADER, EXACT, NARROWER, SYNONYM, rungs
from d3a.plan import FindObjects

STORE = ("cup", "pottedplant", "sportsball", "tv")


@pytest.mark.parametrize(
    ("category", "word", "found", "worth"),
    [
        ("sports ball", "sports ball", "sportsball", EXACT),
        ("ball", "ball", "sportsball", NARROWER),
        ("cup", "mug", "cup", SYNONYM),
        ("potted plant", "potted plant", "pottedplant", EXACT),
        ("tv", "television", "tv", SYNONYM),
    ],
)
def test_detector_spellings_and_synonyms(
    category: str, word: str, found: str, worth: float
) -> None:
    assert rungs(FindObjects("x", category, word), STORE, VocabularyLexicon()) == {found: worth}


def test_nearest_is_by_kind_and_by_spelling() -> None:
    lexicon = VocabularyLexicon()
    assert lexicon.nearest("botle", ["bottle", "bowl", "tv"])[0] == "bottle"
    assert "couch" in lexicon.nearest("armchair", ["couch", "cup", "spoon"])
    assert lexicon.nearest("elephant", ["tv", "cup"]) == ()


@pytest.mark.parametrize(
    ("word", "among"),
    [
        ("shoe", ["shelf", "couch"]),
        ("pill box", ["pillow"]),
        ("monster", ["counter", "toaster", "remote"]),
        ("novels", ["oven"]),
    ],
)
def test_letters_alone_make_no_other_thing_a_suggestion(word: str, among: list[str]) -> None:
    assert VocabularyLexicon().nearest(word, among) == ()


def test_a_thing_that_people_call_so_too_is_found_by_the_wider_word() -> None:
    found = rungs(FindObjects("x", "cushion", "cushion"), ("pillow", "couch"), VocabularyLexicon())
    assert found == {"pillow": BROADER}


def test_parts_of_things() -> None:
    lexicon = VocabularyLexicon()
    assert lexicon.is_part("handle")
    assert not lexicon.is_part("cup")
