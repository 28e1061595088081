"""Sayings that were nearly read, beside plain ones of the same meaning, and near refusals."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest

from grammar import OutOfScope, QuestionError, parse, parse_report

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


def alike(said: str, plainly: str) -> bool:
    """Whether two sayings are one query, but for their tense."""
    found, meant = (replace(parse(t, now=NOW), text="", now=False) for t in (said, plainly))
    return found == meant


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("number of jars seen yesterday", "how many jars did you see yesterday"),
        ("count bins detected in the attic", "how many bins were detected in the attic"),
        ("position of the grey jar at 11:45", "where was the grey jar at 11:45"),
        ("whereabouts of my parrot", "where is my parrot"),
        ("what are the coordinates of the pallet", "where is the pallet"),
        ("have you seen my rake, and if so, where?", "have you seen my rake"),
        ("where are my glove's", "where is my glove"),
        ("have you seen my rake's today", "have you seen my rake today"),
    ],
)
def test_a_saying_means_what_the_plain_one_does(said: str, plainly: str) -> None:
    assert alike(said, plainly)


def test_the_glove_of_a_person_keeps_its_owner() -> None:
    assert parse("is the glove my mom's", now=NOW).objects[0].owner == "mom"
    assert parse("where is the dog's leash", now=NOW).objects[0].owner == "dog"


@pytest.mark.parametrize(
    ("text", "ground"),
    [
        ("was any jar seen near the robot arm", "robot arm"),
        ("is the jar on the window ledge", "window ledge"),
        ("is the rope on the boat deck", "boat deck"),
    ],
)
def test_an_unknown_word_after_a_known_one_is_their_noun(text: str, ground: str) -> None:
    assert parse(text, now=NOW).objects[1].word == ground


@pytest.mark.parametrize(
    "text",
    [
        "is the fern on the sill healthy",
        "is the loaf on the counter stale",
        "is the gate in the yard ajar",
        "is the bench on the porch wobbly",
        "you can peel the carrots?",
    ],
)
def test_states_and_doings_are_out_of_scope(text: str) -> None:
    with pytest.raises(OutOfScope):
        parse(text, now=NOW)


@pytest.mark.parametrize("text", ["where is my mother's", "was that the cat's yesterday"])
def test_an_owner_alone_is_no_thing(text: str) -> None:
    with pytest.raises(QuestionError):
        parse(text, now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("is it a jar on the bench", "is there a jar on the bench"),
        ("it is a jar on the bench?", "is there a jar on the bench"),
        ("has it any dog in the kitchen?", "is there any dog in the kitchen"),
        ("hi can you help me i lost my rake where is it", "where is my rake"),
        ("hello robot i lost my gloves have you seen them", "have you seen my gloves"),
    ],
)
def test_words_that_say_nothing_do_not_stand_in_the_way(said: str, plainly: str) -> None:
    assert alike(said, plainly)


def test_an_it_with_a_meaning_keeps_it() -> None:
    assert parse("Where is my jar? It is a red one.", now=NOW).ask == "where"
    with pytest.raises(OutOfScope):
        parse("is it a jar", now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("where is the ointment i had", "where is the ointment"),
        ("did you see the silk shawl, the striped one", "did you see the striped silk shawl"),
        ("where did i put the letter from the bank", "where did i put the letter"),
        ("have you seen the vase from my aunt", "have you seen the vase"),
        ("where did i leave like the tape", "where did i leave the tape"),
    ],
)
def test_what_is_said_of_a_thing_does_not_change_it(said: str, plainly: str) -> None:
    found, meant = (parse(text, now=NOW).objects[0] for text in (said, plainly))
    assert (found.word, found.owner) == (meant.word, meant.owner)
    assert (set(found.attributes), set(found.without)) == (
        set(meant.attributes),
        set(meant.without),
    )


def test_what_a_described_one_is_not_is_left_out() -> None:
    (box,) = parse("where is the big box, not the small cardboard one", now=NOW).objects
    assert (box.attributes, set(box.without)) == (("big",), {"small", "cardboard"})


def test_where_a_thing_came_from_or_belongs_is_not_where_it_is() -> None:
    assert parse("where is the box from the attic", now=NOW).place is None
    assert parse("where is the key to the shed", now=NOW).place is None
    assert parse("what is missing from the attic", now=NOW).place == "attic"
    with pytest.raises(QuestionError):
        parse("did you see the cup from the table", now=NOW)


@pytest.mark.parametrize(
    ("text", "kind", "negated"),
    [
        ("did you see the hamster outside the cage", "in", True),
        ("what is outside of the box", "in", True),
        ("is the parcel outside the front door", "near", False),
    ],
)
def test_outside_a_thing_is_not_in_it_and_outside_a_door_near_it(
    text: str, kind: str, *, negated: bool
) -> None:
    relation = parse(text, now=NOW).relation
    assert relation is not None
    assert (relation.kind, relation.negated) == (kind, negated)


@pytest.mark.parametrize(
    "text",
    ["when is the bill due", "when was the soup ready", "how many pages does the report have"],
)
def test_what_is_due_or_counted_inside_is_not_seen(text: str) -> None:
    with pytest.raises(OutOfScope):
        parse(text, now=NOW)


def test_parts_that_are_seen_are_counted() -> None:
    assert parse("how many drawers does the desk have", now=NOW).ask == "count"


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("what drawer did i leave the batteries in", "in which drawer did i leave the "
         "batteries"),
        ("have you seen me hat", "have you seen my hat"),
        ("which stool is nearest the window", "which stool is near the window"),
        ("which stool is the closest to the window", "which stool is near the window"),
        ("where is the washing up liquid", "where is the dishwashing liquid"),
    ],
)  # fmt: skip
def test_spoken_forms_mean_what_the_plain_ones_do(said: str, plainly: str) -> None:
    found, meant = (parse(text, now=NOW) for text in (said, plainly))
    assert [(t.category, t.owner) for t in found.objects] == [
        (t.category, t.owner) for t in meant.objects
    ]
    assert (found.relation, found.time, found.ask) == (meant.relation, meant.time, meant.ask)


@pytest.mark.parametrize("look", ["ancient", "spotty", "wavy", "petite", "mauve", "cashmere"])
def test_a_look_is_no_part_of_the_noun(look: str) -> None:
    (term,) = parse(f"where is the {look} scarf", now=NOW).objects
    assert (term.category, term.attributes) == ("scarf", (look,))


def test_a_state_is_refused_where_it_is_asked_for_and_not_where_it_says_which() -> None:
    assert parse("have you seen my wet red scarf", now=NOW).objects[0].attributes == ("wet", "red")
    for asked in ("is there a wet towel in the sink", "how many empty jars are on the shelf"):
        with pytest.raises(OutOfScope):
            parse(asked, now=NOW)


def test_nobody_is_counted_by_where_they_live() -> None:
    assert parse("how many people are in the attic", now=NOW).ask == "count"
    with pytest.raises(OutOfScope):
        parse("how many people live here", now=NOW)


@pytest.mark.parametrize("word", ["sand", "dill", "moose", "hutches", "scalpels"])
def test_ordinary_words_are_not_respelled(word: str) -> None:
    assert not parse_report(f"where is the {word}", now=NOW).corrections


@pytest.mark.parametrize(
    ("said", "ask", "select"),
    [
        ("last sighting of the red jar", "where", "last"),
        ("where was the first detection of the red jar", "where", "first"),
        ("when was the first detection of the red jar", "when", "first"),
        ("when was the latest observation of the red jar", "when", "last"),
        ("all sightings of the red jar", "what", "all"),
        ("how many detections of red jars were there", "how_often", "all"),
        ("number of sightings of the red jar", "how_often", "all"),
        ("red jar last seen", "where", "last"),
        ("current position of the red jar", "where", "last"),
        ("print all red jars", "what", "all"),
    ],
)
def test_a_sighting_is_no_thing_but_what_is_asked_of_one(said: str, ask: str, select: str) -> None:
    query = parse(said, now=NOW)
    assert (query.ask, query.select) == (ask, select)
    assert [(t.category, t.attributes) for t in query.objects] == [("jar", ("red",))]


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("does anyone know where my gloves are", "where are my gloves"),
        ("who knows whether the rake is in the shed", "is the rake in the shed"),
        ("i lost my rake can you help me", "i lost my rake"),
        ("where are my lost gloves", "where are my gloves"),
        ("where may my rake be", "where is my rake"),
    ],
)
def test_who_is_asked_and_for_what_changes_nothing(said: str, plainly: str) -> None:
    assert alike(said, plainly)


def test_spotted_is_a_pattern_before_a_noun_and_a_verb_after_it() -> None:
    assert parse("where is the spotted dog", now=NOW).objects[0].attributes == ("spotted",)
    assert parse("was the dog spotted in the attic", now=NOW).place == "attic"


@pytest.mark.parametrize("text", ["return the jar to the shelf", "print the invoice", "who knows"])
def test_orders_stay_orders(text: str) -> None:
    with pytest.raises(QuestionError):
        parse(text, now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("how many jars exist in the attic", "how many jars are in the attic"),
        ("please tell where is my jar", "where is my jar"),
        ("where does my jar is", "where is my jar"),
        ("where is he the cat", "where is the cat"),
        ("where may be the jar", "where is the jar"),
        ("my jar where is", "where is my jar"),
        ("where find i my jar", "where do i find my jar"),
        ("how long time was the jar on the sill", "how long was the jar on the sill"),
    ],
)
def test_other_orders_of_words_are_read(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    "text",
    [
        "is the clock on the wall correct",
        "is the clock on the wall right",
        "which door leads outside",
        "tell the time",
    ],
)
def test_what_a_tag_would_hide_is_refused(text: str) -> None:
    with pytest.raises(OutOfScope):
        parse(text, now=NOW)


def test_a_tag_after_a_comma_or_a_statement_is_one() -> None:
    assert alike("is the jar on the sill, right?", "is the jar on the sill")
    assert alike("the jar is on the sill right", "is the jar on the sill")


def test_where_something_was_done_with_a_thing_is_not_where_it_is() -> None:
    assert alike("where is the flask i took on the hike", "where is the flask")
    assert alike("where is the gown i wore in the garden", "where is the gown")
    assert parse("where is the jar i left on the sill", now=NOW).relation is not None
    assert parse("is the book i bought on the sill", now=NOW).relation is not None


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("where is my daughters bag", "where is my daughter's bag"),
        ("where are grandmas reading glasses", "where are grandma's reading glasses"),
        ("is chris blue backpack on the bench", "is chris's blue backpack on the bench"),
        ("is the jar infront of the oven", "is the jar in front of the oven"),
        ("is the jar in side the oven", "is the jar inside the oven"),
        ("is the jar inbetween the bowl and the oven", "is the jar between the bowl and the oven"),
    ],
)
def test_what_a_recogniser_leaves_out_is_put_back(said: str, plainly: str) -> None:
    assert alike(said, plainly)


def test_animals_and_people_in_the_plural_own_nothing_by_that() -> None:
    assert parse("are the dogs black", now=NOW).objects[0].owner is None
    assert parse("how many dogs did you see", now=NOW).objects[0].owner is None
    for text in ("are the dogs asleep", "where was my jar for hours ago"):
        with pytest.raises(QuestionError):
            parse(text, now=NOW)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("what is in the back of the closet", "in"),
        ("what is at the back of the sofa", "behind"),
        ("what is touching the wall", "near"),
        ("what is halfway between the sofa and the lamp", "between"),
    ],
)
def test_more_ways_to_say_a_relation(text: str, kind: str) -> None:
    relation = parse(text, now=NOW).relation
    assert relation is not None
    assert relation.kind == kind


@pytest.mark.parametrize(
    "text",
    [
        "what belongs on the shelf",
        "what goes on the shelf",
        "is the lamp plugged into the wall",
        "are the curtains covering the window",
    ],
)
def test_where_things_ought_to_go_and_how_they_are_is_refused(text: str) -> None:
    with pytest.raises(OutOfScope):
        parse(text, now=NOW)


@pytest.mark.parametrize(
    ("said", "ask"),
    [
        ("all things on the shelf between 9:00 and 9:30", "what"),
        ("every jar seen in the lab today", "what"),
        ("list every jar seen in the lab today", "what"),
        ("all my jars are gone", "where"),
        ("total number of jars in the attic", "count"),
        ("timestamp of the first detection of the jar", "when"),
        ("get the last known pose of the jar", "where"),
        ("mr robot where did daddy put my jar", "where"),
        ("i can't for the life of me find my jar", "where"),
    ],
)
def test_what_a_short_request_asks(said: str, ask: str) -> None:
    assert parse(said, now=NOW).ask == ask


def test_what_the_robot_uses_is_its_own_doing() -> None:
    with pytest.raises(OutOfScope):
        parse("which slam algorithm are you using", now=NOW)
    assert parse("which jar did i use last", now=NOW).select == "last"


@pytest.mark.parametrize("thing", ["plant", "mug"])
@pytest.mark.parametrize(
    "said",
    [
        "When were the {} and the radio seen together?",
        "When were the radio and the {} together?",
        "Was the {} ever seen with the radio?",
    ],
)
def test_a_thing_that_says_something_is_seen_together_with_another(said: str, thing: str) -> None:
    query = parse(said.format(thing), now=NOW)
    assert query.relation is not None
    assert query.relation.kind == "together"
    assert "radio" in [term.category for term in query.objects]
    with pytest.raises(OutOfScope, match="is no place for things"):
        parse(f"Is my {thing} on the radio?", now=NOW)
