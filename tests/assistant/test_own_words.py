"""What was taught, said back in the words that it was taught in."""

from __future__ import annotations

import pytest

from assistant.own_words import said_back
from assistant.phrases import definite, indefinite
from assistant.taught import Naming, read_teaching
from grammar.forms import ObjectTerm


@pytest.mark.parametrize(
    ("heard", "said"),
    [
        ("my keys", "your keys"),
        ("My House Keys", "your House Keys"),
        ("our car", "your car"),
        ("mine", "your key"),
        ("Anna's", "Anna's key"),
        ("anna's keys", "Anna's keys"),
        ("the Bosch drill", "Bosch drill"),
        ("Excalibur", "Excalibur"),
        ("the", "the"),
    ],
)
def test_a_name_is_said_back_as_it_was_heard(heard: str, said: str) -> None:
    assert said_back(heard, "key") == said


@pytest.mark.parametrize(
    ("text", "heard"),
    [
        ("Call it  Excalibur, please", "Excalibur"),
        ("THESE ARE MY KEYS", "MY KEYS"),
        ("it's Anna\u2019s Mug!", "Anna's Mug"),
        ("it belongs to Tom", "tom's"),  # nobody wrote that word
        ("call it \u0130stanbul", "i\u0307stanbul"),  # its small letter is two: left as it is read
    ],
)
def test_a_naming_keeps_what_was_written(text: str, heard: str) -> None:
    taught = read_teaching(text)
    assert isinstance(taught, Naming)
    assert taught.heard == heard


@pytest.mark.parametrize(
    ("word", "the", "a"),
    [
        ("Excalibur", "Excalibur", "Excalibur"),
        ("Bosch drill", "the Bosch drill", "a Bosch drill"),
        ("gadget", "the gadget", "a gadget"),
        ("cup", "the cup", "a cup"),
    ],
)
def test_a_name_has_no_article(word: str, the: str, a: str) -> None:
    term = ObjectTerm(word.lower(), word)
    assert definite(term, word) == the
    assert indefinite(term, word) == a
    assert definite(ObjectTerm("cup", "cup", owner="me"), word) == f"your {word}"
