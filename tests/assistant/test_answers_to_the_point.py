"""What is told is what was asked: within the slice, of each kind, of each room, since when."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from d3a.answer import Answer
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def home() -> Home:
    """A red cup on the table at noon, in the hall from two o'clock on; now is seven."""
    home = Home(classes=("cup", "bowl", "key", "table"))
    home.room("kitchen", -1, -1, 3, 3)
    home.room("hall", 5, -1, 9, 3)
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 50, at=(1, 1, 1))
    home.seen("cup", 120, 125, at=(6, 1, 1), place=1)
    home.seen("cup", 240, 241, at=(6, 1, 1), place=1)
    return home


def answered(home: Home, question: str) -> Answer:
    store = OracleStore()
    home.into(store)
    return ask(store, question, now=NOW)


def told(home: Home, question: str) -> str:
    return answered(home, question).answer


def test_no_time_is_told_that_lies_outside_of_the_slice(home: Home) -> None:
    answer = answered(home, "Did you see a cup between 12:10 and 12:30 today?")
    assert answer.answer.startswith("Yes. I saw a cup between 12:10 and 12:30 today, 6 hours ago")
    assert answer.keyframes[0].to_json()["end"].startswith("2024-05-14T12:50")  # the sighting's own
    said = told(home, "When did you last see the cup before 12:30 today?")
    assert said.startswith("Between 12:00 and 12:30 today")
    assert "12:50" not in told(home, "What did you see until 12:30 today?")
    assert "12:50" in told(home, "Did you see a cup today before 13:00?")


def test_each_of_several_kinds_is_counted(home: Home) -> None:
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 5, at=(1, 2, 1))
    for name in ("left", "right"):
        home.thing(name, "cup", paint="blue")
        home.seen(name, 0, 30, at=(1, 2 if name == "left" else 0, 1))
    said = told(home, "How many cups and bowls did you see?")
    assert said.startswith("Four cups and bowls, last seen")
    assert said.endswith(": three cups; one bowl.")
    assert told(home, "How many red cups and keys did you see?").endswith(": one red cup; no keys.")


def test_what_was_seen_but_once_is_not_counted_as_certain(home: Home) -> None:
    home.thing("maybe", "cup", tentative=True)
    home.seen("maybe", 3, 4, at=(1, 0, 1))
    answer = answered(home, "How many cups did you see?")
    assert (answer.value, answer.least, answer.count) == (1.0, 1, 2)
    assert answer.answer.startswith("At least one cup and at most two")
    assert answer.answer.endswith("One of them I saw only once.")
    assert told(home, "Did you see exactly one cup?").startswith("I cannot be sure: I saw at least")


def test_how_long_is_the_time_there_and_the_time_in_view_apart(home: Home) -> None:
    answer = answered(home, "How long was the cup in the hall?")
    assert answer.value == 121 * 60
    assert answer.answer == (
        "About 2 hours, from today at 14:00 to today at 16:01: whenever I looked I saw the cup in "
        "the hall. I had it in view for 6 minutes of that."
    )
    seen = answered(home, "How long did you see the cup in the hall?")
    assert seen.value == 6 * 60
    assert answered(home, "How long was the cup in the hall before 15:00 today?").value == 5 * 60


def test_time_there_ends_where_what_may_be_the_same_was_elsewhere(home: Home) -> None:
    home.thing("other", "cup", paint="red")
    home.seen("other", 180, 181, at=(1, 1, 1))
    answer = answered(home, "How long was the cup in the hall?")
    assert answer.value == 6 * 60
    home.seen("other", 121, 122, at=(1, 1, 1), place=1)  # both in one round: two cups
    assert answered(home, "How long was the cup in the hall?").value == 121 * 60


def test_since_when_is_the_beginning_of_what_is_so_still(home: Home) -> None:
    said = told(home, "Since when is the cup in the hall?")
    assert said == (
        "Since today at 14:00, 5 hours ago, at the latest: I saw the cup in the hall then. Before "
        "that I saw it today at 12:50, 6 hours ago, in the kitchen. I last saw it there today at "
        "16:01, 3 hours ago."
    )
    assert told(home, "How long has the cup been in the hall?") == said
    value = ask(home.into(OracleStore()), "How long has the cup been in the hall?", now=NOW).value
    assert value is not None
    assert value > 4 * 3600  # until now, as the sentence tells it
    assert told(home, "Since when is the cup in the kitchen?").startswith("Not any more. I last")
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 5, at=(1, 2, 1))
    said = told(home, "Since when is the bowl in the kitchen?")
    assert said.startswith("Since today at 12:00, 7 hours ago, or longer: that is when I first saw")


def test_what_is_usually_there_is_told_by_its_share_of_the_looks(home: Home) -> None:
    home.thing("bowl", "bowl")
    for minute in (0, 120, 240):
        home.seen("bowl", minute, minute + 2, at=(1, 2, 1))
    home.thing("key", "key")
    home.seen("key", 0, 2, at=(1, 0, 1))
    home.seen("key", 120, 122, at=(1, 0, 1))
    answer = answered(home, "What is usually in the kitchen?")
    assert answer.answer == (
        "Each time that I looked I saw a bowl in the kitchen. Most times I also saw a key (67 %). "
        "Now and then I saw a cup there."
    )
    shares = {k.category: k.why["share"] for k in answer.keyframes}
    assert shares == {"bowl": 1.0, "key": pytest.approx(2 / 3, abs=1e-3), "cup": 0.3333}


def test_what_is_usual_is_a_share_of_the_time_and_not_of_the_time_in_view(home: Home) -> None:
    """In view for 50 minutes in the kitchen, and for six in the hall, where it lay longer."""
    assert told(home, "Where is the cup usually?") == (
        "Most of the time the cup was in the hall (65 %) and in the kitchen (35 %), as far as I "
        "saw."
    )
    assert told(home, "Is the cup usually in the kitchen?") == (
        "No. The cup was in the kitchen 35 % of the time, as far as I saw."
    )
    assert told(home, "Is the cup usually in the hall?").startswith("Yes. The cup was in the hall")
    assert told(home, "Where was the cup usually before 13:00 today?").startswith(
        "Most of the time the cup was in the kitchen (100 %)"
    )


def test_each_room_is_told_by_itself(home: Home) -> None:
    home.thing("left", "cup", paint="blue")
    home.seen("left", 0, 30, at=(1, 2, 1))
    answer = answered(home, "How many cups were in each room?")
    assert answer.answer == "In the hall I saw one cup; in the kitchen two cups."
    assert (answer.status, answer.value, answer.count) == ("found", 3.0, 2)
    assert [k.rank for k in answer.keyframes] == [*range(1, len(answer.keyframes) + 1)]
    home.room("cellar", 20, 20, 22, 22)
    now = told(home, "Is there a cup in every room?")
    assert now == "No. In the hall I saw a cup; in the kitchen a cup. I saw no cups in the cellar."
    none = answered(home, "How many bowls are in each room?")
    assert none.answer == "I saw no bowls in the cellar, in the hall and in the kitchen."
    assert none.status == "not_found"


def test_where_everything_is_is_told_by_place(home: Home) -> None:
    for number in range(60):
        home.thing(f"b{number:02d}", "bowl")
        home.seen(f"b{number:02d}", 0, 30, at=(1, 2, 1))
    home.thing("gone", "key")
    home.seen("gone", 0, 5, at=(1, 0, 1), absent=90)
    home.thing("maybe", "table", tentative=True)
    home.seen("maybe", 0, at=(1, 0, 1))
    answer = answered(home, "Where is everything?")
    assert answer.answer == (
        "In the hall: a cup. In the kitchen: 60 bowls. One more thing I saw only once."
    )
    assert len(answer.keyframes) == 50
    assert answer.truncated


def test_what_is_asked_not_to_have_been_there_is_told_with_where_it_was_too(home: Home) -> None:
    said = told(home, "Was the cup not in the kitchen today?")
    assert said == (
        "Yes. I saw the cup not in the kitchen on two occasions in one place, last today at 16:01, "
        "3 hours ago, in the hall. I saw it there too, today at 12:50, 6 hours ago."
    )
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 5, at=(1, 2, 1))
    for question in ("Was the bowl outside of the kitchen?", "Was the bowl ever not there?"):
        said = told(home, question.replace("there", "in the kitchen"))
        assert said.startswith("I saw the bowl nowhere but in the kitchen."), question
    said = told(home, "Wasn't the cup in the kitchen today?")
    assert said.startswith("Yes. I saw a cup in the kitchen today at 12:50, 6 hours ago.")
    assert told(home, "Was there no cup in the kitchen today?").startswith("No, there was: I saw")


def test_what_is_asked_not_to_be_there_is_there_or_is_not(home: Home) -> None:
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 5, at=(6, 2, 1), place=1)  # in the hall, and in the kitchen since
    home.seen("bowl", 60, 65, at=(1, 2, 1))
    said = told(home, "Is the bowl not in the kitchen?")
    assert said.startswith("It was, as far as I saw: I last saw the bowl in the kitchen today")
    for question in ("Is the bowl no longer in the kitchen?", "Isn't the bowl there any more?"):
        said = told(home, question.replace("there", "in the kitchen"))
        assert said.startswith("No. I last saw the bowl in the kitchen today"), question
    for question in (
        "Isn't the bowl in the kitchen?",
        "And isn\u2019t there a bowl in the kitchen?",
    ):
        assert told(home, question).startswith("Yes. I last saw a bowl in the kitchen"), question
    assert told(home, "Isn't the bowl in the hall?").startswith("No, not any more. I last saw")
    assert told(home, "Is the bowl not in the hall?").startswith("That is right: I last saw")
    assert told(home, "Is a bowl not in the hall?").startswith("Yes. I last saw a bowl not in the")


def test_a_side_is_asked_of_as_it_is_now(home: Home) -> None:
    viewer = (6.0, -1.0, 1.0, -0.7071, 0.0, 0.0, 0.7071)
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 5, at=(5, 2, 1), viewer=viewer)
    home.thing("couch", "couch")
    home.seen("couch", 0, 5, at=(7, 2, 1), viewer=viewer)
    home.met("bowl", "couch", 0, 5, boxes=((0, 0, 40, 40), (200, 0, 240, 40)), viewer=viewer)
    for now, then in (("left", "right"), ("to the left", "to the right")):
        last = told(home, f"Is the bowl {now} of the couch?")
        assert "I last saw a bowl left of the couch today at 12:05" in last
        assert "I did not see" in told(home, f"Is the bowl {then} of the couch?")
    home.seen("bowl", 60, 65, at=(1, 2, 1), place=1)
    gone = told(home, "Is the bowl left of the couch?")
    assert gone.startswith("No, not any more. I last saw the bowl today at 13:05")
    assert "I saw a bowl left of" in told(home, "Was the bowl left of the couch?")


def test_a_thing_asked_about_is_told_as_moved_by_itself(home: Home) -> None:
    assert told(home, "Did the cup move?").startswith(
        "The cup may have moved: I saw it in the hall"
    )
    home.thing("key", "key")
    home.seen("key", 0, at=(1, 2, 1))
    home.seen("key", 100, 130, at=(6, 2, 1), place=1, moved_from=(0, 0.95))
    assert told(home, "Did the key move?") == (
        "Yes. The key had moved when I saw it in the hall, today at 13:40, 5 hours ago. Before "
        "that I saw it today at 12:00, 7 hours ago, in the kitchen."
    )
    home.seen("key", 150, at=(1, 2, 1))  # back where it was: one link tells that it is one key
    said = told(home, "Has the key been moved?")
    assert said.startswith("Yes. The key had moved when I saw it in the kitchen, today at 14:30")
    assert said.endswith("in the hall. That is the last of two moves that I know of.")


def test_a_thing_in_two_places_at_turns_may_be_one(home: Home) -> None:
    for name, minutes, x in (("a", (0, 200), 1), ("b", (100,), 6)):
        home.thing(name, "bowl")
        for minute in minutes:
            home.seen(name, minute, minute + 2, at=(x, 2, 1))
    for when in ("", " today"):
        assert told(home, f"Did the bowl move{when}?").startswith(
            f"I saw a bowl in two places{when}. I cannot be sure that it was the same one."
        )


def test_whose_a_thing_is_is_not_said_where_nobody_told(home: Home) -> None:
    assert told(home, "Where is Anna's cup?").startswith("In the hall. I last saw the cup there")
    assert told(home, "Where is Anna's cup?").endswith("Nobody told me what is Anna's.")
    assert told(home, "Where are my things?") == "Nobody told me what is yours."


def test_what_lay_there_and_may_be_elsewhere_is_told_apart(home: Home) -> None:
    for name, minutes, x in (("lies", (0,), 1), ("again", (-60, 100), 6)):
        home.thing(name, "bowl")
        for minute in minutes:
            home.seen(name, minute, minute + 2, at=(x, 2, 1))
    home.thing("key", "key")
    home.seen("key", 150, at=(1, 0, 1))
    answer = answered(home, "What is in the kitchen?")
    assert answer.answer == (
        "I last saw a key in the kitchen today at 14:30, 4 hours ago. A bowl that I "
        "saw there may be elsewhere by now."
    )
    assert [k.object_id for k in answer.keyframes] == ["key"]
    home.seen("again", 1, at=(6, 2, 1))  # both in one round: two bowls
    assert "elsewhere" not in told(home, "What is in the kitchen?")


def test_so_many_things_somewhere_are_those_there_now(home: Home) -> None:
    for name in ("left", "right"):
        home.thing(name, "cup", paint="blue")
        home.seen(name, 0, 30, at=(1, 2 if name == "left" else 0, 1))
    answer = answered(home, "Two cups in the kitchen")
    assert {k.object_id for k in answer.keyframes} == {"left", "right"}


def test_a_yes_is_none_where_it_is_more_likely_not_so(home: Home) -> None:
    home.thing("bowl", "bowl", tentative=True)
    home.seen("bowl", 0, at=(1, 2, 1), probability=0.3, times=1)
    assert told(home, "Did you see a bowl?").startswith("Maybe. I saw a bowl")
    assert told(home, "Did you see a cup?").startswith("Yes. I saw a cup")


def test_what_was_refused_for_its_look_is_told_where_it_was_seen_last(home: Home) -> None:
    home.thing("old", "bowl", paint="blue")
    home.seen("old", 0, at=(1, 2, 1))
    home.thing("new", "bowl", paint="white")
    home.seen("new", 150, at=(1, 2, 1))
    said = told(home, "Did you see a red bowl?")
    assert said.endswith(
        "none that looked red. I last saw one, which looked white, today at 14:30, 4 hours ago, in "
        "the kitchen."
    )


def test_whether_it_is_mine_is_what_somebody_told(home: Home) -> None:
    home.thing("hers", "key", names=[("key", "anna")])
    home.seen("hers", 0, at=(1, 2, 1))
    home.thing("any", "key")
    home.seen("any", 0, at=(1, 0, 1))
    said = told(home, "Are those keys mine?")
    assert said == "Nobody told me that the keys are yours. I know of some that are Anna's."
    assert told(home, "Are those keys Anna's?").startswith("Yes. I saw Anna's keys")
    assert told(home, "What does Anna have?").startswith("I saw a key, last today at 12:00")
    home.thing("mine", "key", names=[("key", "me")])
    home.seen("mine", 20, at=(1, 0, 1))
    assert told(home, "Are those keys mine?").startswith("Yes. I saw your keys")
    assert told(home, "Where are my things?") == "In the kitchen: a key."


def test_what_was_not_there_is_told_where_it_was_seen_last_of_all(home: Home) -> None:
    home.room("cellar", -9, -9, -2, -2)  # nearer to the kitchen, and the cup is in the hall
    said = told(home, "Was the cup ever in the cellar?")
    assert said.endswith("I last saw it today at 16:01, 3 hours ago, in the hall.")


def test_too_few_are_at_most_so_many_where_some_may_be_one(home: Home) -> None:
    home.thing("other", "cup", paint="red")
    home.seen("other", 180, 181, at=(1, 1, 1))
    assert told(home, "Did you see three cups?").startswith("No. I saw at most two cups, last")
    home.seen("other", 1, 2, at=(1, 2, 1), place=1)
    assert told(home, "Did you see three cups?").startswith("No. I saw only two cups, last")


def test_which_things_have_a_look_are_told_with_it(home: Home) -> None:
    assert told(home, "Which cups are red?").startswith("I saw a red cup, last today at 16:01")
    home.thing("key", "key")
    home.seen("key", 0, at=(1, 2, 1))
    home.seen("key", 100, 130, at=(6, 2, 1), place=1, moved_from=(0, 0.95))
    assert told(home, "Which keys moved?").startswith("A key had moved when I saw it in the hall")
    assert told(home, "When did the key move?").startswith("The key had moved when I saw it in")


def test_a_mistake_that_may_be_doubts_no_yes_about_now(home: Home) -> None:
    home.thing("maybe", "cup", tentative=True)
    home.seen("maybe", 300, at=(1, 1, 1))
    assert told(home, "Is there a cup in the hall?").startswith("Yes. I last saw a cup in the hall")


def test_one_thing_under_several_ids_is_told_as_what_may_be_the_same(home: Home) -> None:
    home.thing("other", "cup", paint="red")
    home.seen("other", 180, 181, at=(1, 1, 1))
    assert told(home, "Where is the cup?").endswith(
        "What I saw at one other place may be the same."
    )
    home.seen("other", 1, 2, at=(1, 2, 1), place=1)
    assert told(home, "Where is the cup?").endswith("There is one more it could be.")


def test_what_was_somewhere_is_told_where_it_is_now(home: Home) -> None:
    home.thing("table", "table")
    home.seen("table", 0, 50, at=(1, 1.4, 0.7))
    said = told(home, "Where is the cup that was next to the table?")
    assert said.startswith(
        "In the hall. I last saw the cup that was next to the table there today at 16:01"
    )
    assert told(home, "Where's the cup that was next to the table?") == said
    then = told(home, "Where was the cup that was next to the table?")
    assert then.startswith("In the kitchen. I saw the cup next to the table there today at 12:50")
    assert told(home, "Where is the cup that was next to the bowl?").startswith("In the hall. I")


def test_a_denial_that_is_right_has_the_status_of_nothing_found(home: Home) -> None:
    for question in ("Is there no cup in the kitchen?", "Was there at most one bowl?"):
        answer = answered(home, question)
        assert answer.answer.startswith("That is right:"), question
        assert (answer.status, answer.keyframes) == ("not_found", ())


def test_of_what_may_be_one_thing_the_newest_place_is_listed(home: Home) -> None:
    for name, minute, x in (("old", 0, 1), ("new", 150, 1.5)):
        home.thing(name, "bowl")
        home.seen(name, minute, at=(x, 2, 1))
    answer = answered(home, "What is in the kitchen?")
    assert [k.object_id for k in answer.keyframes] == ["new"]
    assert answer.answer.endswith("A bowl that I saw there may be elsewhere by now.")


@pytest.mark.parametrize(
    "question", ["Is there a key?", "Is there still a key?", "Is the key still there?"]
)
def test_what_was_gone_at_the_last_look_is_there_no_more(home: Home, question: str) -> None:
    home.thing("key", "key")
    home.seen("key", 0, 5, at=(1, 0, 1))
    assert told(home, question).startswith("Yes. I saw a key")
    home.seen("key", 0, 5, at=(1, 0, 1), absent=90)
    answer = answered(home, question)
    assert (answer.status, answer.reason) == ("not_found", "gone")
    assert answer.answer == (
        "No, not any more. I last saw the key today at 12:05, 7 hours ago, in the kitchen. When I "
        "looked there again today at 13:30, it was gone."
    )
    assert told(home, "Was there a key?").startswith("Yes. I saw a key")
    home.thing("another", "key")
    home.seen("another", 0, 5, at=(6, 0, 1))
    assert answered(home, question).status == "found"


def test_one_s_own_place_is_the_place(home: Home) -> None:
    home.thing("table", "table")
    home.seen("table", 238, 242, at=(6, 1, 0.5))
    home.met("cup", "table", 240, 241, boxes=((10, 10, 20, 20), (0, 18, 60, 60)))
    for question in ("What is on my table?", "How many cups are on my table?"):
        assert "cup on your table" in told(home, question)


def test_what_was_seen_next_is_nearest_in_time(home: Home) -> None:
    for name, minute in (("k1", -60), ("k2", 90), ("k1", 60)):
        if name not in home.objects:
            home.thing(name, "key")
        home.seen(name, minute, minute + 1, at=(1 if name == "k1" else 6, 0, 1))
    said = told(home, "Where was the key at 12:30 today?")
    assert "I saw it next today at 13:00" in said


def test_a_number_has_the_range_that_how_many_has(home: Home) -> None:
    for name, minute in (("left", 0), ("right", 0), ("again", 230)):
        home.thing(name, "bowl")
        home.seen(name, minute, minute + 1, at=(1, 0 if name == "left" else 2, 1))
    assert told(home, "How many bowls are in the kitchen?").startswith("At least two bowls and")
    assert told(home, "Are there more than two bowls in the kitchen?").startswith("I cannot be")


def test_since_when_is_told_of_what_is_there_for_certain(home: Home) -> None:
    for name, minute, x in (("old", 0, 1), ("away", 60, 6), ("new", 200, 1.5)):
        home.thing(name, "bowl")
        home.seen(name, minute, minute + 5, at=(x, 0, 1))
    assert told(home, "Since when has the bowl been in the kitchen?").startswith(
        "Since today at 15:20"
    )
