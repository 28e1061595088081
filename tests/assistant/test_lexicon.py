"""The vocabulary as d3a sees it."""

from __future__ import annotations

import pytest

from assistant.lexicon import VocabularyLexicon
from d3a.answering.match import EXACT, NARROWER, SYNONYM, rungs
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


def test_parts_of_things() -> None:
    lexicon = VocabularyLexicon()
    assert lexicon.is_part("handle")
    assert not lexicon.is_part("cup")
