"""Whether several things are somewhere: each is judged, whichever of them is said first."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assistant.asking import ask, explain
from assistant.several import told_of_each
from d3a.answer import Answer
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def store() -> OracleStore:
    """A red cup, a key and a vase in the kitchen; a wallet that went from there to the hall."""
    home = Home(classes=("cup", "key", "vase", "wallet", "bowl"))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("hall", 5, -1, 9, 3)
    for name, at in (("cup", (1, 1, 1)), ("key", (2, 1, 1)), ("vase", (2, 2, 1))):
        home.thing(name, name, paint="red" if name == "cup" else "white")
        home.seen(name, 0, 300, at=at)
    home.thing("other", "cup", paint="blue")
    home.seen("other", 0, 300, at=(6, 2, 1))
    home.thing("wallet", "wallet")
    home.seen("wallet", 0, 50, at=(2, 0, 1))
    home.seen("wallet", 120, 300, at=(6, 1, 1), place=1)
    store = OracleStore()
    home.into(store)
    return store


def answered(store: OracleStore, question: str) -> Answer:
    return ask(store, question, now=NOW)


@pytest.mark.parametrize("things", ["the key and the wallet", "the wallet and the key"])
def test_one_of_two_is_named_in_either_order(store: OracleStore, things: str) -> None:
    answer = answered(store, f"Are {things} in the kitchen?")
    assert answer.status == "not_found"
    assert answer.answer.startswith("No, only the key. I last saw ")
    assert "I last saw the wallet today at 17:00, 2 hours ago, in the hall." in answer.answer
    assert "I last saw a key in the kitchen today at 17:00" in answer.answer


def test_both_must_be_there(store: OracleStore) -> None:
    answer = answered(store, "Are the key and the vase in the kitchen?")
    assert answer.status == "found"
    assert answer.answer.startswith("Yes, both. I last saw a key in the kitchen today at 17:00")
    assert {k.object_id for k in answer.keyframes} == {"key", "vase"}
    assert [k.rank for k in answer.keyframes] == [1, 2]
    neither = answered(store, "Are the key and the vase in the hall?")
    assert neither.answer.startswith("No, neither. I did not see a key in the hall.")
    three = answered(store, "Are the key, the vase and the wallet in the kitchen?")
    assert three.answer.startswith("No, only the key and the vase.")


def test_things_of_one_kind_are_told_apart_by_their_looks(store: OracleStore) -> None:
    for things in ("the red cup and the blue cup", "the blue cup and the red cup"):
        said = answered(store, f"Are {things} in the kitchen?").answer
        assert said.startswith("No, only the red cup."), said
    seen = answered(store, "Did you see the red cup and the blue cup?")
    assert seen.answer.startswith("Yes, both. I saw a red cup today at 17:00")
    assert (seen.count, seen.least) == (2, 2)


def test_what_was_never_seen_is_not_there_and_what_has_no_word_is_open(store: OracleStore) -> None:
    said = answered(store, "Are the bowl and the key in the kitchen?").answer
    assert said.startswith("No, only the key. I never saw a bowl in the kitchen.")
    unknown = answered(store, "Are the key and the unicorn in the kitchen?")
    assert unknown.status == "unknown_object"
    assert unknown.answer.startswith("I cannot be sure of both. I last saw a key")


def test_of_a_moment_what_was_seen_then_is_told(store: OracleStore) -> None:
    said = answered(store, "Did you see the key and the wallet at 12:30 today?").answer
    assert said.startswith("Yes. I saw ")
    assert "a key" in said
    assert "a wallet" in said
    assert said.endswith("today at 12:30.")


def test_what_is_explained_is_what_is_answered(store: OracleStore) -> None:
    question = "Are the wallet and the key in the kitchen?"
    explained = explain(store, question, now=NOW)
    assert explained.answer.answer == answered(store, question).answer


@pytest.mark.parametrize("other", ["vase", "wallet"])  # a yes, and a no
def test_what_each_took_is_told_together(store: OracleStore, other: str) -> None:
    each = [answered(store, f"Is the {thing} in the kitchen?") for thing in ("key", other)]
    each = [replace(answer, elapsed_ms={"retrieve": 2.0}) for answer in each]
    query = answered(store, f"Are the key and the {other} in the kitchen?").query
    assert query is not None
    assert told_of_each(query, each).elapsed_ms == {"retrieve": 4.0}
