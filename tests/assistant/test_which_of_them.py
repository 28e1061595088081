"""Which of them it is: all or some, the one or the other, and how many must be different things."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assistant.asking import ask
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

TABLE, THINGS = (100.0, 200.0, 300.0, 400.0), (180.0, 170.0, 220.0, 230.0)


@pytest.fixture
def home() -> Home:
    """Two books on the table of the kitchen and one in the hall; a red cup in the kitchen."""
    home = Home(classes=("cup", "book", "table", "vase"))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("hall", 5, -1, 9, 3)
    home.thing("table", "table")
    home.seen("table", 0, 10, at=(1, 1, 0.7), box=TABLE)
    for name, x in (("one", 0.9), ("two", 1.1)):
        home.thing(name, "book", paint="red" if name == "one" else "blue")
        home.seen(name, 0, 10, at=(x, 1, 0.8), box=THINGS)
        home.met(name, "table", 0, 10, boxes=(THINGS, TABLE))
    home.thing("three", "book", paint="green")
    home.seen("three", 2, 8, at=(6, 1, 1))
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 10, at=(1, 2, 1))
    return home


def told(home: Home, question: str) -> str:
    return ask(home.into(OracleStore()), question, now=NOW).answer


def test_of_things_in_the_plural_all_or_some_are_there(home: Home) -> None:
    assert told(home, "Are the books on the table?") == (
        "Not all of them. I last saw two of the three books on the table, today at 12:10, "
        "7 hours ago. One I saw in the hall, today at 12:08, 7 hours ago."
    )
    assert told(home, "Are the books in the kitchen?").startswith("Not all of them. I last saw two")
    some = told(home, "Are the books not in the kitchen?")
    assert some.startswith("Some of them were, as far as I saw: I last saw two of the three books")
    home.seen("three", 40, 45, at=(1.1, 1.2, 0.8), place=1)
    assert told(home, "Are the books in the kitchen?").startswith("Yes. I last saw books in the")
    assert told(home, "Are the books in the hall?").startswith("No, not any more.")


def test_some_things_of_many_are_no_all(home: Home) -> None:
    """Some books, not the books; and keys are one thing, however often they were found anew."""
    assert told(home, "Are there books on the table?").startswith("Yes. I last saw books on the")
    for name, minute, x in (("found", 0, 6.0), ("again", 300, 1.0)):
        home.thing(name, "key")
        home.seen(name, minute, minute + 5, at=(x, 2, 1))
    assert told(home, "Are the keys in the kitchen?").startswith("Yes. I last saw keys in the")


def test_in_the_past_too(home: Home) -> None:
    assert told(home, "Were the books on the table today?").startswith(
        "Not all of them. I saw two of the three books on the table"
    )


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ("Is the cup in the hall or in the kitchen?", "Yes, in the kitchen. I last saw a cup in"),
        ("Is the cup in the hall or the kitchen?", "Yes, in the kitchen. I last saw a cup in"),
        ("Is the cup or the vase in the kitchen?", "Yes, the cup. I last saw a cup in"),
        ("Is the red cup or the blue cup in the kitchen?", "Yes, the red cup. I last saw a red"),
        ("Did you see a red or a blue book?", "Yes, both. I saw a red book"),
        ("Did you see a vase or a cup today?", "Yes, a cup. I saw a cup"),
        ("Was the red book on the table or the chair?", "Yes, on the table. I saw a red book"),
        ("Is the vase in the hall or in the kitchen?", "I never saw a vase in the hall or in the"),
    ],
)
def test_one_or_the_other(home: Home, question: str, said: str) -> None:
    assert told(home, question).startswith(said)


def test_what_is_listed_is_counted_as_what_is_asked_how_many(home: Home) -> None:
    home.thing("mug", "cup", paint="blue")
    home.seen("mug", 60, 65, at=(1, 2.5, 1))
    assert told(home, "How many cups are in the kitchen?").startswith(
        "At least one cup and at most"
    )
    assert told(home, "Which cups are in the kitchen?").startswith("I last saw one or two cups in")
    assert "three books" in told(home, "What did you see?")
    said = told(home, "Which books that are not yellow did you see?")
    assert said.startswith("I saw three books that are not yellow, last today at 12:10")


def test_what_was_seen_but_once_is_no_plain_yes(home: Home) -> None:
    home.thing("vase", "vase", tentative=True)
    home.seen("vase", 5, at=(1, 0, 1), probability=0.99)
    home.sightings[-1] = replace(home.sightings[-1], seen=1)
    said = told(home, "Did you see a vase?")
    assert said.startswith("Maybe. I saw a vase")
    assert "I am not sure" in said


def test_an_owner_is_known_by_whatever_word_the_thing_was_taught_by(home: Home) -> None:
    home.thing("mug", "cup", paint="blue", names=(("blue mug", "anna"),))
    home.seen("mug", 60, 65, at=(1, 2.5, 1))
    for question in ("Is the blue mug Anna's?", "Is the blue cup Anna's?", "Is the cup Anna's?"):
        assert told(home, question).startswith("Yes. I saw Anna's"), question
    assert told(home, "Is the book Anna's?") == "Nobody told me that the book is Anna's."
    assert told(home, "Is the blue cup mine?") == (
        "Nobody told me that the blue cup is yours. I know of some that are Anna's."
    )


def test_each_of_two_looks_is_judged_by_itself(home: Home) -> None:
    home.thing("mug", "cup", paint="blue")
    home.seen("mug", 2, 8, at=(6, 2, 1))
    said = told(home, "Are the red and blue cups in the kitchen?")
    assert said.startswith("No, only red cups. I last saw red cups in the kitchen")


def test_the_other_places_of_a_thing_are_told(home: Home) -> None:
    home.seen("cup", 100, 110, at=(6, 2, 1), place=1)
    assert "there today at 12:10, 7 hours ago. I also saw it in the hall." in told(
        home, "Where was the cup today?"
    )
    said = told(home, "Where is the cup, in the kitchen or in the hall?")
    assert said.startswith("In the hall. I last saw the cup there today at 13:50")
    assert told(home, "Is the red cup red?").startswith("Yes. I saw a red cup")


def test_what_no_memory_can_use_of_a_thing_is_said(home: Home) -> None:
    said = told(home, "Where is the book that I bought today?")
    assert said.endswith(
        "Which one is meant by “I bought” I cannot tell. I took the time as when I saw it."
    )
    said = told(home, "Where is the book I was reading?")
    assert said.endswith("Which one is meant by “I was reading” I cannot tell.")
    for question in ("Where is the cup I bought?", "Where is the book that I left?"):
        assert "I cannot tell" not in told(home, question), question


def test_exactly_so_many_together_and_at_most(home: Home) -> None:
    home.thing("mug", "cup", paint="blue")
    home.seen("mug", 0, 10, at=(1.3, 2, 1))
    home.met("cup", "mug", 0, 10)
    for bound in ("exactly", "at most"):
        said = told(home, f"Were {bound} two cups together?")
        assert said.startswith("Yes. I saw two cups together today"), bound
    home.thing("beaker", "cup", paint="white")
    home.seen("beaker", 0, 10, at=(1.2, 2.2, 1))
    for other in ("cup", "mug"):
        home.met("beaker", other, 0, 10)
    for bound in ("exactly", "at most"):
        said = told(home, f"Were {bound} two cups together?")
        assert said.startswith("No. I saw three cups together today"), bound
    assert told(home, "Were exactly four cups together?").startswith("I did not see four cups")
    assert told(home, "Were at most four cups together?").startswith("That is right. I did not")


def test_one_place_or_another_is_each_in_its_own_room(home: Home) -> None:
    """The table of the hall is none of the kitchen's."""
    home.thing("hall table", "table")
    home.seen("hall table", 60, 70, at=(6, 1, 0.7), box=TABLE)
    home.thing("shelf", "shelf")
    home.seen("shelf", 60, 70, at=(2, 2, 0.7))
    home.seen("one", 60, 70, at=(6, 1, 0.8), place=1, box=THINGS)
    home.met("one", "hall table", 60, 70, boxes=(THINGS, TABLE))
    for question in ("Is the red book on the kitchen table or the shelf?",
                     "Is the red book on the shelf or the kitchen table?"):  # fmt: skip
        assert told(home, question).startswith("No, not any more."), question
    assert told(home, "Is the red book on the shelf or the hall table?").startswith(
        "Yes, on the hall table."
    )
    said = told(home, "Are the books in the kitchen?")
    assert said.startswith("Not all of them. I last saw one of the three books in the kitchen")


@pytest.fixture
def shelf() -> Home:
    """Two bottles and two books in the kitchen: a detector that knows no kinds of them."""
    home = Home(classes=("bottle", "book", "table"))
    home.room("kitchen", -1, -1, 3, 3)
    for number, kind in enumerate(("bottle", "bottle", "book", "book")):
        name = f"{kind} {number}"
        home.thing(name, kind)
        home.seen(name, 0, 300, at=(number / 2, 1, 1))
    return home


@pytest.mark.parametrize(
    ("question", "seen", "which"),
    [
        ("Where is the water bottle?", "a bottle", "which bottle is the water bottle."),
        ("Where is my notebook?", "a book", "which book is your notebook."),
        ("When did you last see the notebook?", "a book", "which book is the notebook."),
        ("Where are the notebooks?", "two of the books", "which books are notebooks."),
        ("Is the water bottle in the kitchen?", "a bottle", "which bottle is the water bottle."),
    ],
)
def test_a_kind_that_was_found_by_a_wider_word_is_not_claimed(
    shelf: Home, question: str, seen: str, which: str
) -> None:
    said = told(shelf, question)
    assert f"saw {seen}" in said
    assert f"I cannot tell {which}" in said
    assert not said.startswith(("Yes", "Maybe"))


def test_what_was_found_by_its_own_word_leaves_nothing_open(shelf: Home) -> None:
    shelf.thing("flask", "water bottle")
    shelf.seen("flask", 0, 300, at=(2, 2, 1))
    assert "I cannot tell" not in told(shelf, "Where is the water bottle?")
    assert "I cannot tell" not in told(shelf, "Where is the bottle?")


def test_what_stood_beside_it_is_told_all_the_same(shelf: Home) -> None:
    said = told(shelf, "What is next to the water bottle?")
    assert said.startswith("This is a guess: I last saw two books and a bottle next to the bottle")
    assert said.endswith("I cannot tell which bottle is the water bottle.")


def test_a_misspelt_plural_is_told_in_the_plural(shelf: Home) -> None:
    shelf.thing("key", "key")
    shelf.seen("key", 0, 300, at=(2, 2, 1))
    assert "I last saw your keys there" in told(shelf, "Where are my kees?")


def test_which_it_is_of_several_is_told_by_its_colour(home: Home) -> None:
    assert told(home, "Which books are on the table?").startswith(
        "I last saw a red book and a blue book on the table"
    )
    assert told(home, "Which book is in the hall?").startswith("I last saw a green book in the")
    assert told(home, "Which green book is in the hall?").startswith("I last saw a green book in")
    assert told(home, "Which cup is in the kitchen?").startswith("I last saw a cup in the kitchen")
    home.thing("cup again", "cup", paint="red")  # never with the other: it may be the same
    home.seen("cup again", 300, 310, at=(6, 2, 1))
    assert told(home, "Which cup is in the hall?").startswith("I last saw a cup in the hall")


def test_what_moved_of_several_is_told_by_its_colour(home: Home) -> None:
    for name, x in (("one", 6.2), ("two", 6.6)):
        home.seen(name, 40, 45, at=(x, 2, 0.8), place=1, moved_from=(0, 0.99))
    said = told(home, "What moved?")
    assert "the red book, in the hall" in said
    assert "the blue book, in the hall" in said


def test_a_list_of_what_may_all_be_elsewhere_by_now_says_so_once(home: Home) -> None:
    home.thing("vase", "vase", paint="white")
    home.seen("vase", 0, 10, at=(6, 2, 1))
    assert told(home, "What vases are in the hall?").startswith("I last saw a vase in the hall")
    home.thing("vase again", "vase", paint="white")
    home.seen("vase again", 300, 310, at=(1, 2, 1))
    assert told(home, "What vases are in the hall?") == (
        "I cannot be sure. I last saw a vase in the hall today at 12:10, 7 hours ago. I saw a "
        "vase, maybe the same, today at 17:10, 2 hours ago, in the kitchen, next to the table."
    )


def test_what_moved_by_several_ids_is_no_flat_no(home: Home) -> None:
    home.thing("cup again", "cup", paint="red")
    home.seen("cup again", 300, 310, at=(6, 2, 1))
    answer = ask(home.into(OracleStore()), "Did the cup move?", now=NOW)
    assert answer.answer.startswith("I saw a cup in two places. I cannot be sure that it was the")
    assert [k.object_id for k in answer.perhaps] == ["cup again", "cup"]
    assert [k["place"] for k in answer.to_json()["perhaps"]] == ["hall", "kitchen"]


def test_what_a_person_left_is_nothing_that_always_stands_there(home: Home) -> None:
    home.seen("three", 40, 45, at=(1.1, 1.2, 0.8), place=1)  # later than all the others
    left = told(home, "What did I leave in the kitchen?")
    assert left.startswith("I last saw two or three books and a cup in the kitchen, the newest")
    assert "a cup and a table in the kitchen" in told(home, "What is in the kitchen?")
    assert told(home, "Did I leave anything in the kitchen?").startswith(
        "Yes. I last saw two or three books and a cup in the kitchen"
    )
    home.thing("bed", "bed")
    home.seen("bed", 0, 10, at=(8, 1, 0.7), box=TABLE)
    home.seen("bed", 40, 45, at=(8, 1, 0.7), box=TABLE)
    assert told(home, "What did I forget in the hall?").startswith("I last saw a bed in the hall")


def test_where_it_has_been_asks_for_all_its_places(home: Home) -> None:
    home.seen("cup", 40, 45, at=(6, 2, 1), place=1)
    assert "I also saw it in the" in told(home, "Where has the cup been?")
    assert told(home, "Where is the cup?").startswith("In the hall. I last saw the cup there")


def test_what_may_be_elsewhere_by_now_is_counted_as_at_most(home: Home) -> None:
    assert told(home, "How many cups are in the kitchen?").startswith("One cup in the kitchen")
    home.thing("cup again", "cup", paint="red")
    home.seen("cup again", 300, 310, at=(6, 2, 1))
    said = ask(home.into(OracleStore()), "How many cups are in the kitchen?", now=NOW)
    assert said.answer.startswith("At most one cup in the kitchen, last seen today at 12:10")
    assert (said.status, said.value, said.count) == ("found", 0.0, 1)
    assert told(home, "How many cups are in the hall?").startswith("One cup in the hall")
    home.seen("cup again", 5, 8, at=(6, 2, 1))  # one round showed both
    assert told(home, "How many cups are in the kitchen?").startswith("One cup in the kitchen")
