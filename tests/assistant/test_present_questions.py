"""Questions of the present: what is there now, in a follow-up and in a query without words too."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assistant.asking import ask, ask_query, read_question
from assistant.dialogue import follow
from grammar import StoreWords
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

WORDS = StoreWords(places=("kitchen", "living room"))


@pytest.fixture
def store() -> OracleStore:
    """A cup and a bowl that went from the kitchen to the living room."""
    home = Home(classes=("cup", "bowl"))
    for name, x in (("cup", 1), ("bowl", 2)):
        home.thing(name, name)
        home.seen(name, 0, 30, at=(x, 1, 1))
        home.seen(name, 200, 210, at=(x + 5, 1, 1), place=1)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    made = OracleStore()
    home.into(made)
    return made


@pytest.mark.parametrize(
    ("first", "then", "whole"),
    [
        ("Is the cup in the kitchen?", "and the bowl?", "Is the bowl in the kitchen?"),
        ("Is the bowl in the living room?", "and in the kitchen?", "Is the bowl in the kitchen?"),
        ("Was the cup in the kitchen?", "and the bowl?", "Was the bowl in the kitchen?"),
        ("How many cups are in the kitchen?", "and bowls?", "How many bowls are in the kitchen?"),
        ("Did I leave the cup in the kitchen?", "or the bowl?", "Is the bowl in the kitchen?"),
    ],
)
def test_a_follow_up_keeps_the_tense(store: OracleStore, first: str, then: str, whole: str) -> None:
    query = follow(then, now=NOW, words=WORDS, last=read_question(store, first, now=NOW))
    followed, asked = ask_query(store, query, now=NOW), ask(store, whole, now=NOW)
    assert (followed.status, followed.reason) == (asked.status, asked.reason)
    assert followed.answer == asked.answer


def test_a_follow_up_with_a_verb_has_its_own_tense(store: OracleStore) -> None:
    last = read_question(store, "Are there cups in the kitchen?", now=NOW)
    were = follow("how many were there?", now=NOW, words=WORDS, last=last)
    are = follow("how many are there?", now=NOW, words=WORDS, last=were)
    assert (last.now, were.now, are.now) == (True, False, True)
    since = follow("since yesterday", now=NOW, words=WORDS, last=last)
    assert not since.now, "of a time it is no present"


def test_what_was_left_somewhere_is_looked_for_there(store: OracleStore) -> None:
    left = ask(store, "Did I leave the cup in the kitchen?", now=NOW)
    assert (left.status, left.reason) == ("not_found", "gone")
    assert "in the living room" in left.answer
    assert ask(store, "Did I leave the cup in the living room?", now=NOW).status == "found"
    assert ask(store, "Did I ever leave the cup in the kitchen?", now=NOW).status == "found"


def test_what_was_somewhere_is_asked_to_be_there_still(store: OracleStore) -> None:
    still = ask(store, "Is the cup that was in the kitchen still there?", now=NOW)
    assert (still.status, still.reason) == ("not_found", "gone")


def test_a_query_without_its_words_asks_the_same(store: OracleStore) -> None:
    asked = ask(store, "Is the cup in the kitchen?", now=NOW)
    query = read_question(store, "Is the cup in the kitchen?", now=NOW)
    bare = ask_query(store, replace(query, text=""), now=NOW)
    formal = ask(store, query.formal, now=NOW)
    assert {a.reason for a in (asked, bare, formal)} == {"gone"}


def test_what_was_spoken_of_is_known_in_a_follow_up() -> None:
    home = Home(classes=("cup",))
    for name, minute, x in (("cup", 0, 1), ("cup again", 200, 6)):
        home.thing(name, "cup")
        home.seen(name, minute, minute + 5, at=(x, 1, 1))
    home.look(250, 1, 1)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    store = OracleStore()
    home.into(store)
    first = read_question(store, "Is the cup in the living room?", now=NOW)
    followed = follow("and in the kitchen?", now=NOW, words=WORDS, last=first)
    asked = ask(store, "Is the cup in the kitchen?", now=NOW)
    assert asked.answer.startswith("No, not any more. I last saw the cup")
    assert ask_query(store, followed, now=NOW).answer == asked.answer
