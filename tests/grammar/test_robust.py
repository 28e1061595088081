"""Whatever is said: a query or a QuestionError, in bounded time, and nothing else."""

from __future__ import annotations

import random
import time
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.lark import from_lark
from lark import Lark

from grammar import NotUnderstood, QuestionError, parse
from grammar.forms import FormalQuery
from grammar.reading import QUESTION
from grammar.tables import declared
from grammar.words import MAX_CHARACTERS, MAX_WORDS
from tests.worlds.vocabulary import vocabulary_words

NOW = datetime(2026, 3, 8, 3, 30, tzinfo=ZoneInfo("America/New_York"))
SAID = {
    "AND": "and", "ATTR": "red", "AT_PLACE": "in the kitchen", "AUX": "did", "BE": "was",
    "DET": "the", "HAVE": "have", "HERE": "somewhere", "GO": "go", "MISSING": "missing",
    "MOVED": "moved", "NOT_ATTR": "not red", "NOUN": "cup", "NUMBER": "two", "ONE": "one",
    "OR": "or", "OR_ITEM": "or", "OR_LOOK": "or", "AND_ITEM": "and", "OWNED": "of mine",
    "OWNER": "my", "PART": "handle", "PIED": "on", "PREDICATE": "red",
    "IS_OWNED": "anna's", "POSSESSOR": "anna", "NOT_AT_PLACE": "that is not in the kitchen",
    "_EXACTLY": "exactly", "_MOST": "at most",
    "STRANDED": "on", "REL": "next to", "SIDE_BY_SIDE": "together",
    "THAT_NOT_REL": "that is not on", "THERE": "there", "WHO": "you", "SEE": "see",
    "LEAVE": "leave", "FINDS": "find", "_BUT": "besides", "_EXCEPT": "but not", "_FIND": "find",
    "_HOWLONG": "how long", "_HOWMANY": "how many", "_HOWOFTEN": "how often",
    "_MADE_OF": "made of", "_NOT_MADE_OF": "not made of", "_SEEK": "i am looking for",
    "_SHOW": "show me", "_THAT_IS": "that is", "_THAT_IS_NOT": "that is not", "_WHAT": "what",
    "_WHEN": "when", "_WHERE": "where", "_WHETHER": "whether", "_WHICH": "which",
    "_WITHOUT_PART": "without", "_WITH_PART": "with",
}  # fmt: skip
"""What is said for each terminal of question.lark."""
TIMES = ("", "yesterday", "at half past three", "between 1 and 4 pm", "since monday", "last night")
WORDS = [
    "where",
    "is",
    "the",
    "cup",
    "did",
    "you",
    "see",
    "my",
    "red",
    "keys",
    "on",
    "in",
    "under",
    "next",
    "to",
    "not",
    "without",
    "with",
    "that",
    "anna's",
    "and",
    "or",
    "no",
    "between",
    "from",
    "to",
    "last",
    "past",
    "ago",
    "half",
    "quarter",
    "three",
    "3",
    "pm",
    "a.m.",
    "monday",
    "may",
    "march",
    "second",
    "31st",
    "2020",
    "13/13/2020",
    "1/2/2020",
    "24:00",
    "noon",
    "midnight",
    "yesterday",
    "tomorrow",
    "how",
    "many",
    "what",
    "which",
    "when",
    "it",
    "them",
    "there",
    "one",
    "ones",
    "kitchen",
    "hall",
    "living",
    "room",
    "of",
    ",",
    "?",
    ".",
    "'",
    '"',
    "|",
    "(",
    ")",
    "um",
    "hey",
    "robot",
    "please",
    "is",
    "was",
    "thing",
    "nothing",
    "other",
    "than",
    "belongs",
    "week",
    "month",
    "99",
    "-5",
    "0",
    "zero",
    "twenty",
    "first",
    "february",
    "30",
]


def outcome(text: str) -> FormalQuery | QuestionError:
    """Return what `parse` makes of a text; any other exception passes through."""
    try:
        return parse(text, now=NOW)
    except QuestionError as error:
        return error


def check(text: str) -> None:
    """Assert what holds of every outcome."""
    found = outcome(text)
    if isinstance(found, QuestionError):
        assert found.text == text
        assert 0 <= found.position <= len(text)
        assert len(found.suggestions) <= 3
        found.to_json()
    else:
        assert FormalQuery.from_json(found.to_json()) == found


def sentences_of_the_grammar() -> st.SearchStrategy[str]:
    """Return sentences drawn from question.lark, each terminal said in words."""
    said = {name: st.just(f"{word} ") for name, word in SAID.items()}
    grammar = Lark(declared(QUESTION), parser="lalr", lexer="basic", start=["start"])
    return from_lark(grammar, start="start", explicit=said)


@settings(max_examples=300, deadline=None)
@given(sentences_of_the_grammar(), st.sampled_from(TIMES))
def test_sentences_of_the_grammar_survive(sentence: str, said: str) -> None:
    check(f"{sentence.strip()} {said}".strip())


@settings(max_examples=500, deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_a_query_or_a_question_error(text: str) -> None:
    check(text)


def test_twenty_thousand_word_salads() -> None:
    draw = random.Random(3)
    for _ in range(20_000):
        check(" ".join(draw.choice(WORDS) for _ in range(draw.randint(1, 14))))


def test_the_vocabulary_alone_and_in_short_salads() -> None:
    """Few words fit few sayings: what looks back or ahead of them must find nothing there."""
    known = vocabulary_words()
    for word in known:
        check(word)
    draw = random.Random(4)
    short = [word for word in known if len(word) <= 6]
    for _ in range(15_000):
        check(" ".join(draw.choice(short) for _ in range(draw.randint(2, 4))))


@pytest.mark.parametrize(
    "text",
    [
        "where is the cup " * 1000,
        "a" * 10_000,
        "where is " + "the red " * 60 + "cup",
        "at half past " * 40,
        "1 " * 200,
        "between 1 and 2 " * 30,
        "and " * 50 + "cup",
        "where is the cup " + "next to the cup " * 20,
    ],
)
def test_long_texts_cost_no_time(text: str) -> None:
    outcome("where is the cup")
    began = time.process_time()
    outcome(text)
    assert time.process_time() - began < 0.25


def test_too_long_is_said_with_its_place() -> None:
    with pytest.raises(NotUnderstood) as caught:
        parse("where is the cup " * 1000, now=NOW)
    assert caught.value.position == MAX_CHARACTERS
    with pytest.raises(NotUnderstood, match=str(MAX_WORDS)):
        parse("a b c d e " * 20, now=NOW)


def test_a_naive_now_is_the_callers_mistake() -> None:
    naive = NOW.replace(tzinfo=None)
    with pytest.raises(ValueError, match="zone"):
        parse("where is the cup", now=naive)


def test_grammar_imports_neither_numpy_nor_a_store() -> None:
    heavy = {"numpy", "pymongo", "d3a", "assistant", "textual", "dateutil", "cv2"}
    for path in (Path(__file__).parents[2] / "grammar").rglob("*.py"):
        for line in path.read_text(encoding="utf-8").splitlines():
            if line.startswith(("import ", "from ")):
                root = line.split()[1].split(".")[0]
                assert root not in heavy, f"{path.name}: {line}"
