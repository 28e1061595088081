"""What must not be claimed: a moment, an absence, a look-alike, a spot that nobody is sure of."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from assistant.pointing import narrowed, shown
from assistant.wording import answer_lines
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def two_rooms() -> Home:
    home = Home(classes=("cup", "key", "couch"))
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 30, at=(1, 1, 1))
    home.seen("cup", 200, 210, at=(6, 1, 1), place=1)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    return home


def told(home: Home, question: str) -> str:
    store = OracleStore()
    home.into(store)
    return ask(store, question, now=NOW).answer


def test_at_a_moment_between_sightings_both_are_told(two_rooms: Home) -> None:
    two_rooms.look(120, 6, 1)
    said = told(two_rooms, "Did you see a cup at 2 pm today?")
    assert said == (
        "I did not see a cup today at 14:00. I had last seen one today at 12:30, 6 hours ago, in "
        "the kitchen. I next saw one today at 15:20, 4 hours ago, in the living room."
    )


def test_at_a_moment_within_a_sighting_the_answer_is_yes(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup at 12:10 today?")
    assert said == "Yes. I was seeing a cup today at 12:10, in the kitchen."


def test_at_a_moment_before_all_only_the_next_is_told(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup at 4 am today?")
    assert said.startswith("I was not looking today at 4:00. I next saw one today")


def test_a_moment_that_nobody_looked_at_is_no_plain_no(two_rooms: Home) -> None:
    said = told(two_rooms, "Was the cup in the kitchen at 2 pm today?")
    assert said == (
        "I was not looking in the kitchen today at 14:00. I had last seen it "
        "in the kitchen today at 12:30, 6 hours ago. I next saw it today at 15:20, 4 hours ago, "
        "in the living room."
    )


def test_a_moment_is_the_minute_that_a_clock_tells(two_rooms: Home) -> None:
    two_rooms.seen("cup", 100.5, 100.7, at=(1, 1, 1), place=2)
    said = told(two_rooms, "Did you see a cup at 1:40 pm today?")
    assert said == "Yes. I was seeing a cup today at 13:40, in the kitchen."
    said = told(two_rooms, "Where was the cup at 1:40 pm today?")
    assert said == "In the kitchen. I was seeing the cup there today at 13:40."


@pytest.mark.parametrize(
    ("question", "then"),
    [
        ("How many cups did you see", "One cup, seen today at 12:10."),
        ("How often did you see a cup", "Once. I saw the cup today at 12:10."),
        ("What did you see in the kitchen", "I saw a cup in the kitchen, today at 12:10."),
        (
            "How long was the cup in the kitchen",
            "About 30 minutes: that is how long I saw the cup in the kitchen, today at 12:10.",
        ),
    ],
)
def test_what_is_counted_at_a_moment_was_seen_then(
    two_rooms: Home, question: str, then: str
) -> None:
    assert told(two_rooms, f"{question} at 12:10 today?") == then
    said = told(two_rooms, f"{question} at 2 pm today?")
    assert said.startswith("I was not looking")
    assert "today at 14:00, so I cannot tell." in said


def test_what_moved_is_told_as_the_least_and_by_when_it_was_seen_again(two_rooms: Home) -> None:
    two_rooms.thing("key", "key")
    two_rooms.seen("key", 0, at=(1, 2, 1))
    two_rooms.seen("key", 100, 130, at=(6, 2, 1), place=1, moved_from=(0, 0.95))
    assert told(two_rooms, "What moved today?") == (
        "At least one thing had moved when I saw it again: the key, in the living room, today "
        "at 13:40, 5 hours ago. One other thing may have moved."
    )
    said = told(two_rooms, "What moved in the kitchen today?")
    assert said.startswith(
        "At least one thing had moved into, within or out of the kitchen when I saw it again: "
        "the key, in the living room, today"
    )
    said = told(two_rooms, "What moved in the kitchen at 5 am today?")
    assert said.startswith("I was not looking in the kitchen today at 5:00, so I cannot tell.")
    two_rooms.room("hall", 20, 20, 22, 22)
    assert told(two_rooms, "What moved in the hall?").startswith(
        "As far as I saw, nothing moved in the hall."
    )


def test_what_moved_next_to_a_thing_is_told_by_it(two_rooms: Home) -> None:
    two_rooms.thing("vase", "vase")
    two_rooms.seen("vase", 0, 130, at=(1, 2.2, 1))
    for name, y in (("key", 2.0), ("book", -0.5)):
        two_rooms.thing(name, name)
        two_rooms.seen(name, 0, at=(1, y, 1))
        two_rooms.seen(name, 100, 130, at=(6, y, 1), place=1, moved_from=(0, 0.95))
    said = told(two_rooms, "What moved next to the vase?")
    assert said.startswith("At least one thing had moved to or from a spot next to the vase when")
    assert ": the key, in the living room, today" in said
    assert told(two_rooms, "What is missing next to the vase?").startswith(
        "As far as I saw, nothing is missing that I saw next to the vase."
    )


def test_no_fewer_views_are_told_than_occasions(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup?")
    assert said.endswith(
        "on two occasions in two places, last today at 15:30, 4 hours ago, in the "
        "living room. I am fairly sure: seen ten times in all."
    )


def test_a_place_is_told_as_one_to_be_in_where_the_question_said_so(two_rooms: Home) -> None:
    two_rooms.room("galley", -1, -1, 3, 3)
    two_rooms.regions = [room for room in two_rooms.regions if room.name != "kitchen"]
    assert " in the galley today at 12:30" in told(two_rooms, "Did you see a cup in the galley?")
    assert " at the galley today at 12:30" in told(two_rooms, "Did you see a cup at the galley?")
    said = told(two_rooms, "Did you see a cup in the galley at 3 am?")
    assert said.startswith("I was not looking in the galley today at 3:00")


def test_anything_elsewhere_is_not_told_instead_of_what_is_in_the_room(two_rooms: Home) -> None:
    two_rooms.room("hall", 20, 20, 22, 22)
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, "What did you see in the hall?", now=NOW)
    assert (answer.reason, answer.otherwise) == ("not_there", None)
    assert answer.answer == "I did not see anything in the hall."


def test_a_day_without_a_look_is_not_told_as_absence(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup on 3 May 2024?")
    assert said.startswith("I was not looking on Friday 3 May, so I cannot tell. I saw one today")
    assert said.endswith("I last looked today at 15:30, 4 hours ago.")
    assert told(two_rooms, "Has anything moved yesterday?").startswith("I was not looking yester")


def test_a_room_that_was_not_looked_at_then_is_not_told_as_empty(two_rooms: Home) -> None:
    two_rooms.views.clear()
    two_rooms.look(5, 1, 1)
    two_rooms.look(120, 6, 1)
    question = "Did you see a cup in the kitchen between 1 pm and 3 pm today?"
    said = told(two_rooms, question)
    assert said.startswith("I was not looking in the kitchen between 13:00 and 15:00 today")
    two_rooms.look(90, 1, 1)
    said = told(two_rooms, question)
    assert said.startswith("I did not see a cup between 13:00 and 15:00 today.")


def test_a_refused_colour_is_told_with_what_was_seen(two_rooms: Home) -> None:
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, "Where is the purple cup?", now=NOW)
    assert (answer.status, answer.keyframes) == ("not_found", ())
    assert answer.otherwise is not None
    assert answer.otherwise.place == "living room"
    assert answer.answer.startswith(
        "I saw a cup, but none that looked purple. I last saw one, which looked red, tod"
    )


@pytest.mark.parametrize(
    ("sigma", "near", "words"),
    [(0.05, "couch", ", next to the couch"), (2.0, None, ", somewhere near the couch")],
)
def test_no_landmark_of_an_uncertain_position(
    two_rooms: Home, sigma: float, near: str | None, words: str
) -> None:
    two_rooms.thing("couch", "couch", paint="green")
    two_rooms.seen("couch", 200, 220, at=(6.5, 1, 1))
    two_rooms.thing("key", "key")
    two_rooms.seen("key", 205, 215, at=(6.2, 1, 1), sigma=sigma)
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, "Did you see a key?", now=NOW)
    assert answer.keyframes[0].near == near
    assert words in answer.answer


def test_what_was_seen_instead_of_anything_has_its_name(two_rooms: Home) -> None:
    two_rooms.look(300, 1, 1)
    said = told(two_rooms, "What did you see between 4 pm and 6 pm today?")
    assert "I did not see anything between 16:00 and 18:00 today. I saw a cup" in said


@pytest.fixture
def carried() -> Home:
    """Two cups in one round; later, elsewhere, one that may be either; keys likewise."""
    home = Home(classes=("cup", "key"))
    for name, start, x, absent in (("a", 0, 1, 95), ("b", 2, 2, None), ("c", 200, 6, None)):
        home.thing(name, "cup")
        home.seen(name, start, start + 5, at=(x, 1, 1), absent=absent)
    for name, start, x, absent in (("k1", 0, 1, 95), ("k2", 200, 6, None)):
        home.thing(name, "key")
        home.seen(name, start, start + 5, at=(x, 2, 1), absent=absent)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    return home


def test_a_count_is_what_one_round_proves_and_what_ids_allow(carried: Home) -> None:
    store = OracleStore()
    carried.into(store)
    answer = ask(store, "How many cups did you see?", now=NOW)
    assert (answer.value, answer.count) == (2.0, 3)
    assert answer.answer.startswith("At least two cups and at most three, last seen today")


def test_a_number_asked_for_is_confirmed_only_by_what_is_proven(carried: Home) -> None:
    assert told(carried, "Did you see two cups?").startswith("Yes. I saw at least two cups, last")
    assert told(carried, "Did you see three cups?").startswith("I cannot be sure: I saw at least")
    assert told(carried, "Did you see four cups?").startswith("No. I saw at most three cups")


def test_what_may_have_moved_is_not_told_as_still(carried: Home) -> None:
    said = told(carried, "Have my keys moved today?")
    assert said.startswith("I saw your keys in two places today. I cannot be sure that they are")
    assert "living room" in said


def test_what_may_have_moved_within_a_round_is_told_too(carried: Home) -> None:
    carried.thing("d", "bowl", paint="white")
    carried.seen("d", 0, 30, at=(1, 1, 1))
    carried.thing("e", "bowl", paint="white")
    carried.seen("e", 33, 60, at=(6, 1, 1))
    assert told(carried, "When did the white bowl move?").startswith(
        "I saw a white bowl in two places. I cannot be sure that it was the same one."
    )
    carried.seen("e", 20, 60, at=(6, 1, 1))  # both at once
    assert told(carried, "When did the white bowl move?").startswith(
        "I did not see the white bowl move."
    )
    carried.seen("d", 0, 30, at=(1, 1, 1), absent=50)
    assert told(carried, "When did the white bowl move?") == (
        "I looked again and the white bowl was gone. I last saw it today at 12:30, 6 hours ago, in "
        "the kitchen."
    )


def test_what_turned_up_elsewhere_under_another_id_is_not_missing(carried: Home) -> None:
    assert told(carried, "Is anything missing?").startswith("As far as I saw, nothing is missing.")
    del carried.objects["k2"]
    del carried.stays["k2", 0]
    carried.sightings = [s for s in carried.sightings if s.object_id != "k2"]
    assert told(carried, "Is anything missing?").startswith(
        "One thing is no longer in place: the k"
    )


def test_a_yes_about_now_is_doubted_where_one_like_it_turned_up_elsewhere(
    two_rooms: Home,
) -> None:
    assert told(two_rooms, "Is the cup in the living room?").startswith("Yes. I last saw a cup in")
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 300, 310, at=(1, 1, 1))
    said = told(two_rooms, "Is the cup in the living room?")
    assert said == (
        "I cannot be sure. I last saw a cup in the living room today at 15:30, 4 hours ago. I saw "
        "one that may be the same today at 17:10, 2 hours ago, in the kitchen."
    )


def test_the_one_is_where_it_was_seen_last_where_its_place_was_looked_at_since(
    two_rooms: Home,
) -> None:
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 300, 310, at=(1, 1, 1))
    two_rooms.look(250, 6, 1)
    gone = "No, not any more. I last saw {} cup today at 17:10, 2 hours ago, in the kitchen."
    assert told(two_rooms, "Is the cup in the living room?") == gone.format("the")
    assert told(two_rooms, "Is my cup in the living room?") == gone.format("your")
    assert told(two_rooms, "Is there a cup in the living room?").startswith("I cannot be sure.")
    two_rooms.seen("other", 209, 211, at=(1, 1, 1))  # there are two
    for asked in ("Is the cup in the living room?", "Is my cup in the living room?"):
        assert told(two_rooms, asked).startswith("Yes. I last saw")


def test_what_the_one_is_beside_is_one_thing_too(two_rooms: Home) -> None:
    two_rooms.thing("keys", "key", paint="black")
    two_rooms.seen("keys", 200, 210, at=(6.2, 1, 1))
    two_rooms.met("cup", "keys", 200, 210)
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 300, 310, at=(1, 1, 1))
    two_rooms.look(250, 6, 1)
    for asked in ("Is the cup with the keys?", "Are the keys with the cup?"):
        assert told(two_rooms, asked).startswith("No, not any more. I last saw"), asked


def test_one_known_before_may_be_the_same_unless_a_round_showed_both(two_rooms: Home) -> None:
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 130, 131, at=(1, 1, 1))
    two_rooms.seen("other", 300, 310, at=(1, 1, 1))
    said = told(two_rooms, "Is the cup in the living room?")
    assert said.startswith("I cannot be sure. I last saw a cup in the living room today at 15:30")
    two_rooms.seen("other", 209, 211, at=(1, 1, 1))
    said = told(two_rooms, "Is the cup in the living room?")
    assert said.startswith("Yes. I last saw a cup in the living room")


def test_of_a_doubtful_yes_the_newest_that_was_there_is_told(two_rooms: Home) -> None:
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 50, 60, at=(6, 2, 1))  # seen again after the cup was, in the other room
    two_rooms.seen("other", 300, 310, at=(1, 1, 1), place=1)
    two_rooms.seen("other", 250, 260, at=(6, 2, 1))
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, "Is the cup in the living room?", now=NOW)
    assert answer.answer.startswith(
        "I cannot be sure. I last saw a cup in the living room today at 16:20, 3 hours ago."
    )
    assert answer.answer.endswith("today at 17:10, 2 hours ago, in the kitchen.")


def test_when_it_was_somewhere_tells_a_later_doubtful_time_too(two_rooms: Home) -> None:
    two_rooms.seen("cup", 300, 301, at=(1, 1, 1), place=2, probability=0.2, times=1)
    said = told(two_rooms, "When was the cup in the kitchen?")
    assert "I saw the cup in the kitchen once. I may have seen it today at 17:01" in said


def test_a_list_of_what_is_there_leaves_out_what_may_have_moved(two_rooms: Home) -> None:
    two_rooms.thing("key", "key")
    two_rooms.seen("key", 200, 210, at=(6, 2, 1))
    assert "a key" in told(two_rooms, "What is in the living room?")
    two_rooms.thing("found", "key")
    two_rooms.seen("found", 300, 310, at=(1, 2, 1))
    assert "a key" not in told(two_rooms, "What is in the living room?")


@pytest.mark.parametrize(("beside", "doubted"), [(False, True), (True, False)])
def test_a_look_alike_known_before_doubts_only_if_never_seen_beside(
    two_rooms: Home, beside: bool, doubted: bool
) -> None:
    two_rooms.thing("other", "cup", paint="red")
    two_rooms.seen("other", 205 if beside else 100, at=(1, 1, 1))
    two_rooms.seen("other", 300, 310, at=(1, 1, 1))
    said = told(two_rooms, "Is the red cup in the living room?")
    assert said.startswith("I cannot be sure.") is doubted


def test_a_broader_word_names_the_kinds_that_it_covers(two_rooms: Home) -> None:
    for name, minute in (("banana", 0), ("apple", 40)):
        two_rooms.thing(name, name, paint="red")
        two_rooms.seen(name, minute, minute + 10, at=(1, 2, 1))
    assert told(two_rooms, "Did you see any fruit?").startswith(
        "Yes. I saw a banana and an apple, last today at 12:50"
    )
    said = told(two_rooms, "When did you see red fruit?")
    assert said.startswith("I saw the red apple and banana on two occasions")
    said = told(two_rooms, "Did you see red fruit?")
    assert said.startswith("Yes. I saw a red apple and a red banana, last")
    assert told(two_rooms, "When did you last see fruit?").endswith("seen five times.")
    assert "the apple" in told(two_rooms, "When did you last see fruit?")


def test_what_was_seen_first_or_last_is_that_alone(two_rooms: Home) -> None:
    for name, start, end in (("vase", -20, 5), ("book", -20, 10), ("clock", 220, 230)):
        two_rooms.thing(name, name)
        two_rooms.seen(name, start, end, at=(1, 2, 1))
    assert told(two_rooms, "What did you see last?") == (
        "I last saw a clock today at 15:50, 3 hours ago, in the kitchen."
    )
    assert told(two_rooms, "What did you see first today?") == (
        "I first saw a book and a vase today at 11:40, 7 hours ago."
    )


def test_where_several_things_usually_are_is_told_of_each(two_rooms: Home) -> None:
    for name, x in (("left", 1.0), ("right", 1.5), ("far", 6.0)):
        two_rooms.thing(name, "chair")
        two_rooms.seen(name, 0, 30, at=(x, 2, 1))
        two_rooms.seen(name, 60, 90, at=(x, 2, 1))
    assert told(two_rooms, "Where are the chairs?") == (
        "I last saw two of the chairs in the kitchen; one in the living room, the newest today at "
        "13:30, 6 hours ago."
    )
    assert told(two_rooms, "Where are the two cups?").startswith("In the living room. I last saw")
    assert told(two_rooms, "Where are the chairs usually?") == (
        "Most of the time I saw two of the chairs in the kitchen; one in the living room."
    )
    assert told(two_rooms, "Where is the chair usually?") == (
        "I know three chairs. "
        "Most of the time I saw two of the chairs in the kitchen; one in the living room."
    )
    two_rooms.thing("vase", "vase")
    two_rooms.seen("vase", 0, 10, at=(1, 1, 1))
    assert told(two_rooms, "Where are the chairs and the vase usually?").endswith(
        "Most of the time the vase was in the kitchen (100 %), as far as I saw."
    )


def test_where_a_thing_usually_is_leaves_room_for_what_may_be_it(carried: Home) -> None:
    said = told(carried, "Where do my keys usually lie?")
    assert said == (
        "Your keys were in the kitchen (50 %) and in the living room (50 %), as far as I saw. They "
        "may not have been the same ones each time."
    )


@pytest.mark.parametrize("question", ["When did you not see the cup?", "what has not moved"])
def test_no_sighting_shows_when_a_thing_was_not_seen(two_rooms: Home, question: str) -> None:
    said = told(two_rooms, question)
    assert said == "That asks for what was not seen, and I remember what was. Ask when it was seen."


def test_several_of_a_kind_together_are_told_by_their_number(two_rooms: Home) -> None:
    for number in (2, 3):
        two_rooms.thing(f"cup{number}", "cup", paint="blue")
        two_rooms.seen(f"cup{number}", 10 * number, 200, at=(0.55 + 0.45 * number, 1, 1))
    two_rooms.thing("couch", "couch")
    two_rooms.seen("couch", 0, 25, at=(1, 1.3, 0.6))
    assert told(two_rooms, "Did you see two cups together?").startswith(
        "Yes. I saw two cups together today at 15:20, 4 hours ago, in the kitchen"
    )
    assert told(two_rooms, "When did you see three cups together?").startswith(
        "Today at 12:30, 6 hours ago, in the kitchen, next to the couch. I saw three cups together"
    )
    assert told(two_rooms, "When did you see three cups?").startswith(
        "Today at 12:30, 6 hours ago, in the kitchen, next to the couch. I saw three cups at once "
    )
    assert told(two_rooms, "How many cups did you see together?").startswith(
        "Three cups together, last seen today at 12:30"
    )
    assert told(two_rooms, "Did you see the couch with two cups?").startswith(
        "Yes. I saw a couch with two cups today at"
    )
    assert told(two_rooms, "Did you see four cups together?").startswith(
        "I did not see four cups together. I last saw some today"
    )
    assert told(two_rooms, "When were the cups not together?").startswith(
        "Today at 15:30, 4 hours ago, in the living room. I saw the cups not together once."
    )


def test_nothing_has_a_colour_that_nothing_looked(two_rooms: Home) -> None:
    assert told(two_rooms, "Did you see anything purple?") == "Nothing that I saw looked purple."


@pytest.mark.parametrize("colour", ["grey", "brown", "orange", "purple", "white"])
def test_as_many_things_are_told_as_are_counted(two_rooms: Home, colour: str) -> None:
    """Doubtful ones are in the table below, and neither counted nor told beside others."""
    kinds = ("bowl", "book", "vase", "clock", "chair", "couch", "lamp", "bottle", "backpack")
    for number, kind in enumerate(kinds):
        share = number / (len(kinds) - 1)  # from orange over brown to grey
        red, green, blue = (120 * share + (1 - share) * part for part in (240, 130, 30))
        two_rooms.thing(kind, kind, paint=(red, green, blue))
        two_rooms.seen(kind, number, number + 5, at=(1, 2, 1))
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, f"Did you see anything {colour}?", now=NOW)
    yes = answer.answer.partition(", last")[0] if answer.keyframes else ""
    named = [kind for kind in ("cup", *kinds) if kind in yes]
    assert len(named) == answer.count
    assert len({k.object_id for k in answer.keyframes}) >= answer.count


def test_what_may_have_the_colour_is_told_with_a_doubt_and_listed(two_rooms: Home) -> None:
    paints = {"rusty": (152.0, 80.0, 45.0), "rustier": (140.0, 88.0, 50.0)}
    for number, (name, paint) in enumerate(paints.items()):
        two_rooms.thing(name, "vase", paint=paint)
        two_rooms.seen(name, 10 * number, 10 * number + 5, at=(1, 2 + number, 1))
    for name in ("green", "blue", "white", "brown", "orange"):
        two_rooms.thing(name, "bowl", paint=name)
        two_rooms.seen(name, 0, at=(1, 1, 1))
    store = OracleStore()
    two_rooms.into(store)
    answer = ask(store, "Where is the red vase?", now=NOW)
    assert answer.answer.startswith(
        "I saw vases, but I cannot be sure that any of them looked red. The likeliest I last saw "
    )
    assert [k.object_id for k in shown(answer)] == ["rusty", "rustier"]
    lines = answer_lines(answer, NOW, rows=1)
    assert sum("vase" in line for line in lines[1:]) == 1
    assert lines[-1] == "(1 more)"
    left = narrowed(answer, lambda k: k.object_id != "rusty", NOW, nothing="none")
    assert left.answer.startswith("I saw a vase, but I cannot be sure that it looked red.")
    assert [k.object_id for k in shown(left)] == ["rustier"]
    none = narrowed(left, lambda k: k.object_id != "rustier", NOW, nothing="none")
    assert (none.answer, shown(none)) == ("none", ())
    anything = ask(store, "Is there anything purple?", now=NOW)
    assert (anything.status, "I saw looked purple" in anything.answer) == ("not_found", True)


def test_what_is_gone_is_told_with_the_first_look_that_did_not_show_it() -> None:
    home = Home(classes=("cup",))
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 5, at=(1, 1, 1), absent=300)
    home.look(6, 1, 1)  # of the round that showed it
    home.look(300, 1, 1)
    plain = "When I looked there again today at 17:00, it was gone."
    assert plain in told(home, "Where is the cup?")
    home.look(250, 1, 1)
    home.look(120, 1, 1)
    home.look(60, 40, 40)  # elsewhere
    first = (
        "When I looked there again today at 14:00, I did not see it; today at 17:00 it was gone."
    )
    assert first in told(home, "Where is the cup?")
    assert first in told(home, "Was the cup there today?")
    store = OracleStore()
    home.into(store)
    record = ask(store, "Where is the cup?", now=NOW).to_json()["keyframes"][0]
    assert record["first_missed"] == "2024-05-14T14:00:00-04:00"
    assert record["last_absent"] == "2024-05-14T17:00:00-04:00"
    home.thing("other", "cup", paint="blue")
    home.seen("other", 299, 300, at=(3, 1, 1))
    assert "I did not see that one; today at" in told(home, "Was a cup there before 1 pm today?")
