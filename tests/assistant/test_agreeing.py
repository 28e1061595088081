"""The status of a record says what its sentence says."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from assistant.plain import PlainChat, talk
from assistant.session import Session
from assistant.wording import answer_lines
from d3a.answer import Answer
from d3a.store.base import Store
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def home() -> Home:
    home = Home(classes=("cup", "bowl", "table", "bed"))
    home.thing("table", "table")
    home.seen("table", 0, 10, at=(1, 1, 0.5))
    home.thing("cup", "cup")
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.room("kitchen", -1, -1, 3, 3)
    return home


def stored(home: Home) -> Store:
    return home.into(OracleStore())


@pytest.mark.parametrize(
    "question",
    [
        "what did you see {}?",
        "how many things are {}?",
        "is anything {}?",
        "when was something {}?",
    ],
)
def test_all_that_was_seen_is_no_answer_about_an_unknown_place(home: Home, question: str) -> None:
    store = stored(home)
    for place, known in (("in the bathroom", "in the kitchen"), ("on the floor", "on the table")):
        answer = ask(store, question.format(place), now=NOW)
        assert (answer.status, answer.unjudged) == ("not_found", (place,))
        assert (answer.keyframes, answer.count, answer.value) == ((), 0, None)
        assert answer.answer.startswith(f"I cannot tell what is “{place}” here.")
        assert answer.suggestions == (question.format(known),)
        offered = f"Did you mean: {question.format(known)}"
        assert answer_lines(answer, NOW) == [answer.answer, offered]


def test_the_places_that_are_known_are_told_in_place_of_an_unknown_one(home: Home) -> None:
    question = "what is in the bathroom?"
    assert ask(stored(home), question, now=NOW).answer.endswith(
        "The one place that I know is the kitchen."
    )
    home.room("den", 4, 0, 6, 3)
    answer = ask(stored(home), question, now=NOW)
    assert "The places that I know are the " in answer.answer
    assert {"the den", "the kitchen"} == {
        words.removeprefix("what is in ").removesuffix("?") for words in answer.suggestions
    }
    for number in range(9):
        home.room(f"den {number}", 10 + number, 0, 11 + number, 1)
    answer = ask(stored(home), question, now=NOW)
    assert "Some of the places that I know are" in answer.answer
    assert len(answer.suggestions) == 3


def test_what_was_found_without_its_place_stays_found(home: Home) -> None:
    answer = ask(stored(home), "is the cup in the bathroom?", now=NOW)
    assert (answer.status, answer.unjudged) == ("found", ("in the bathroom",))
    assert [each.object_id for each in answer.keyframes] == ["cup"]


def test_a_refusal_is_printed_once(home: Home) -> None:
    answer = ask(stored(home), "Why did I leave my cup?", now=NOW)
    lines = answer_lines(answer, NOW)
    assert lines[0] == answer.message
    assert [line.partition(": ")[0] for line in lines[1:]] == ["Did you mean"] * 3
    assert ask(stored(home), "fhqwhgads", now=NOW).answer == "I do not know “fhqwhgads”."


def test_what_is_rather_not_there_is_told_with_a_doubt(home: Home) -> None:
    home.thing("bowl", "bowl", tentative=True)
    home.seen("bowl", 5, 10, at=(1.5, 1, 1), times=1)
    store = stored(home)
    said = ask(store, "What is in the kitchen?", now=NOW).answer
    assert "a cup, a table and perhaps a bowl in the kitchen" in said
    only = Home(classes=("bowl",))
    only.thing("bowl", "bowl", tentative=True)
    only.seen("bowl", 0, times=1, at=(1, 1, 1))
    only.room("kitchen", -1, -1, 3, 3)
    said = ask(stored(only), "What is in the kitchen?", now=NOW).answer
    assert said.startswith(("I am not sure: I last saw a bowl", "This is a guess: I last saw a b"))


@pytest.mark.parametrize("question", ["What is in the attic?", "Did you see a cup in the attic?"])
def test_a_room_that_was_never_looked_into_is_not_told_as_empty(home: Home, question: str) -> None:
    home.views.clear()
    home.look(0, 1, 1)
    home.room("attic", 40, 40, 44, 44)
    answer = ask(stored(home), question, now=NOW)
    assert answer.status == "not_found"
    assert answer.answer.startswith("I never looked in the attic, so I cannot tell.")
    home.look(20, 42, 42)
    assert ask(stored(home), question, now=NOW).answer.startswith("I did not see ")


def test_of_a_moment_without_a_sighting_did_you_see_is_a_no(home: Home) -> None:
    home.seen("cup", 200, 210, at=(1, 1, 1))
    answer = ask(stored(home), "Did you see the cup at 2 pm today?", now=NOW)
    assert (answer.status, answer.reason, answer.count) == ("not_found", "not_then", 0)
    assert answer.keyframes == ()
    assert [each.start.hour for each in answer.perhaps] == [12, 15]  # before it, and after it
    assert answer.otherwise == answer.perhaps[0]
    assert answer.answer.startswith("I was not looking today at 14:00. I had last seen ")


def test_what_was_so_before_and_after_a_moment_was_probably_so_then(home: Home) -> None:
    home.seen("cup", 200, 210, at=(1, 1, 1))
    answer = ask(stored(home), "Was the cup in the kitchen at 2 pm today?", now=NOW)
    assert (answer.status, len(answer.keyframes)) == ("found", 2)
    assert answer.answer.startswith("Probably. I was not looking in the kitchen today at 14:00. ")


@pytest.mark.parametrize(("absent", "status"), [(None, "found"), (200, "not_found")])
def test_what_was_last_seen_before_a_moment_may_be_gone_by_then(
    home: Home, absent: int | None, status: str
) -> None:
    home.seen("cup", 20, 30, at=(1, 1, 1), absent=absent)
    answer = ask(stored(home), "Was the cup in the kitchen at 2 pm today?", now=NOW)
    assert answer.status == status, answer.answer
    assert answer.answer.startswith("Probably. ") == (status == "found")


def test_what_was_seen_a_minute_later_was_probably_so(home: Home) -> None:
    store = stored(home)
    answer = ask(store, "Was the cup in the kitchen at 11:58 today?", now=NOW)
    assert answer.status == "found"
    assert answer.answer.startswith("Probably. I was not looking in the kitchen today at 11:58. ")
    assert ask(store, "Did you see the cup at 11:58 today?", now=NOW).status == "not_found"


def test_what_came_only_after_a_moment_was_not_seen_then(home: Home) -> None:
    answer = ask(stored(home), "Was the cup in the kitchen at 4 am today?", now=NOW)
    assert (answer.status, answer.reason) == ("not_found", "not_then")
    during = ask(stored(home), "Was the cup in the kitchen at 12:05 today?", now=NOW)
    assert (during.status, during.answer.split(".")[0]) == ("found", "Yes")


def test_a_place_that_is_offered_is_chosen_by_its_number(home: Home) -> None:
    store, heard = stored(home), list[str]()

    def answered(text: str) -> Answer:
        heard.append(text)
        return ask(store, text, now=NOW)

    session = Session(store, answered, lambda _: "", lambda: NOW)
    talk(PlainChat(session, lambda _: None), ["what is in the bathroom?", "1"])
    assert heard == ["what is in the bathroom?", "1"]
