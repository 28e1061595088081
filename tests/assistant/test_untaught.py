"""What may be the named thing under another id is told beside what is certain of the name."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from d3a.answer import Answer
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

LATER = "today at 17:10, 2 hours ago, in the living room."


@pytest.fixture
def home() -> Home:
    """My red cup in the kitchen; before and after that one like it that nobody named."""
    home = Home(classes=("cup", "couch"))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    home.thing("mine", "cup", paint="red", names=(("cup", "me"),))
    home.seen("mine", 0, 30, at=(1, 1, 1))
    home.thing("other", "cup", paint="red")
    home.seen("other", -100, -90, at=(6, 1, 1))
    home.seen("other", 300, 310, at=(6, 1, 1), place=1)
    return home


def asked(home: Home, question: str) -> Answer:
    return ask(home.into(OracleStore()), question, now=NOW)


def test_where_a_named_thing_was_is_told_for_certain_and_what_may_be_it_since(home: Home) -> None:
    answer = asked(home, "Where is my cup?")
    assert answer.answer == (
        "In the kitchen. I last saw your cup there for certain today at 12:30, 6 hours ago. "
        f"I saw a cup that may be yours {LATER}"
    )
    assert answer.keyframes[0].object_id == "mine"
    assert answer.otherwise is not None
    assert answer.otherwise.object_id == "other"


@pytest.mark.parametrize(
    "question", ["When did you last see my cup?", "How often did you see my cup?"]
)
def test_a_newer_look_alike_is_told_beside_its_times(home: Home, question: str) -> None:
    assert asked(home, question).answer.endswith(f"I saw a cup that may be yours {LATER}")


def test_what_is_there_now_is_doubted_by_a_newer_look_alike_elsewhere(home: Home) -> None:
    said = asked(home, "Is my cup in the kitchen?").answer
    assert said.startswith("I cannot be sure. I last saw your cup in the kitchen today at 12:30")
    assert said.endswith(f"I saw one that may be the same {LATER}")
    assert asked(home, "Did you see my cup in the kitchen?").answer.startswith("Yes. I saw your")


@pytest.mark.parametrize(
    ("question", "seen"),
    [
        ("Is my cup in the living room?", "in the living room today at 17:10, 2 hours ago."),
        ("Did you see my cup this morning?", "today at 10:30, 8 hours ago, in the living room."),
    ],
)
def test_a_no_of_the_name_alone_is_no_sure_one(home: Home, question: str, seen: str) -> None:
    answer = asked(home, question)
    assert answer.answer.startswith(f"I cannot be sure. I saw a cup that may be yours {seen}")
    assert "For certain I" in answer.answer
    assert "saw it today at 12:30, 6 hours ago, in the kitchen." in answer.answer
    assert (answer.status, [k.object_id for k in answer.perhaps]) == ("not_found", ["other"])


def test_a_name_without_an_owner_is_of_one_id_too(home: Home) -> None:
    home.thing("mine", "cup", paint="red", names=(("excalibur", None),))
    home.seen("mine", 0, 30, at=(1, 1, 1))
    said = asked(home, "Where is Excalibur?").answer
    assert said.endswith(f"I saw a cup that may be the same {LATER}")


@pytest.mark.parametrize("why", ["together", "look", "kind", "named", "mistake", "older"])
def test_what_cannot_be_the_named_thing_is_not_told(home: Home, why: str) -> None:
    if why == "together":
        home.seen("other", 10, 20, at=(6, 1, 1), place=2)
    elif why == "older":
        home.seen("mine", 400, 410, at=(1, 1, 1))
    else:
        home.thing(
            "other",
            "couch" if why == "kind" else "cup",
            paint="blue" if why == "look" else "red",
            names=(("cup", "anna"),) if why == "named" else (),
            tentative=why == "mistake",
        )
        home.seen("other", 300, 310, at=(6, 1, 1), place=1)
    answer = asked(home, "Where is my cup?")
    assert "may be" not in answer.answer
    assert answer.otherwise is None
    assert "I last saw your cup there today at" in answer.answer


def test_what_is_said_not_to_be_there_is_told_of_the_name_alone(home: Home) -> None:
    assert "may be yours" not in asked(home, "Is my cup not in the kitchen?").answer
