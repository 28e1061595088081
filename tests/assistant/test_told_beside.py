"""That a thing did not move and is not missing is told of it, with where it was seen last."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from d3a.answer import Answer
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def store() -> OracleStore:
    """A vase in the kitchen all along, and an apple that was gone from there; never a cup."""
    home = Home(classes=("vase", "apple", "cup", "scissors"))
    home.room("kitchen", -1, -1, 3, 3)
    for name, y in (("vase", 1), ("scissors", 2)):
        home.thing(name, name)
        home.seen(name, 0, 300, at=(2, y, 1))
    home.thing("apple", "apple")
    home.seen("apple", 0, 50, at=(2, 0, 1), absent=280)
    store = OracleStore()
    home.into(store)
    return store


def answered(store: OracleStore, question: str) -> Answer:
    return ask(store, question, now=NOW)


LAST = "I last saw it today at 17:00, 2 hours ago, in the kitchen."


@pytest.mark.parametrize(
    ("question", "told"),
    [
        ("Is the vase missing?", f"As far as I saw, the vase is not missing. {LAST}"),
        ("Is the vase gone?", f"As far as I saw, the vase is not missing. {LAST}"),
        ("Did the vase move?", f"I did not see the vase move. {LAST}"),
        ("Did the vase move today?", f"I did not see the vase move today. {LAST}"),
        (
            "Are the scissors missing?",
            f"As far as I saw, the scissors are not missing. {LAST.replace('it', 'them', 1)}",
        ),
    ],
)
def test_it_is_told_of_the_thing_with_where_it_is(
    store: OracleStore, question: str, told: str
) -> None:
    answer = answered(store, question)
    assert answer.status == "not_found"
    assert answer.answer == told
    assert answer.otherwise is not None
    assert answer.otherwise.object_id in ("vase", "scissors")


def test_of_what_was_never_seen_that_is_told(store: OracleStore) -> None:
    assert answered(store, "Is the cup missing?").answer.startswith("I never saw a cup.")
    assert answered(store, "Did the cup move?").answer.startswith("I never saw ")


def test_any_of_a_kind_is_told_as_none_of_it(store: OracleStore) -> None:
    said = answered(store, "Are any vases missing?").answer
    assert said.startswith("As far as I saw, no vase is missing. I last looked")
    assert answered(store, "Did anything move?").answer.startswith("As far as I saw, nothing moved")


def test_what_is_gone_is_not_told_as_not_missing(store: OracleStore) -> None:
    said = answered(store, "Did the apple move?").answer
    assert said.startswith("I looked again and the apple was gone. I last saw it today at 12:50")
    said = answered(store, "Did the apple go missing between 12:00 and 12:30 today?").answer
    assert said.startswith(
        "I last saw the apple today at 12:50, 6 hours ago, in the kitchen. When I looked there "
        "again today at 16:40, it was gone."
    )
