"""What is said after a question, whom it calls, and marks that are dictated by their names."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest

from grammar import NotUnderstood, OutOfScope, QuestionError, parse

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


def alike(said: str, plainly: str) -> bool:
    """Whether two sayings are one query, but for their tense."""
    found, meant = (replace(parse(t, now=NOW), text="", now=False) for t in (said, plainly))
    return found == meant


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("Where's my kite? The yellow one.", "where is my yellow kite"),
        ("Where's my kite? Not the yellow one.", "where is my kite that is not yellow"),
        ("Where's my kite? Not the yellow one, the pink one.", "where is my pink kite"),
        ("Where's my kite? Not the yellow one but the pink one.", "where is my pink kite"),
        ("Where is my kite? I mean the pink one.", "where is my pink kite"),
        ("Where is my kite? It's pink.", "where is my pink kite"),
        ("Where is my kite, it's the pink one", "where is my pink kite"),
        ("Did you see my kite yesterday? The pink one.", "did you see my pink kite yesterday"),
        ("Is the kite on the lawn? The pink one.", "is the pink kite on the lawn"),
        ("How many kites are there? Pink ones.", "how many pink kites are there"),
        ("What is on the lawn? Anything pink?", "which pink things are on the lawn"),
        ("Did you see my hamster? She is small and brown.", "did you see my small brown hamster"),
        ("Have you seen my hamster? I need it.", "have you seen my hamster"),
        ("I can't find my kite. It's pink.", "i can not find my pink kite"),
        ("Where is the kite? Anna's.", "where is anna's kite"),
        ("Where are the keys? The car keys.", "where are the car keys"),
        ("Where is the kite? The one on the lawn.", "where is the kite on the lawn"),
        ("How many kites are there? On the lawn.", "how many kites are on the lawn"),
        ("How many kites did you see? Yesterday, I mean.", "how many kites did you see yesterday"),
        ("Where was the kite? Around noon.", "where was the kite around noon"),
        ("Where is the kite? The big one, not the double.", "where is the big kite"),
        ("My kite is gone. The pink one. Where is it?", "where is my pink kite"),
        ("I had a kite. The pink one. Where is it?", "where is the pink kite"),
        ("Skipper wants the kite, the pink one. Where is it?", "where is the pink kite"),
        ("have you seen my kite, not the red one, the pink one", "have you seen my pink kite"),
        ("How many kites are there? On the lawn. Red ones.", "how many red kites are on the lawn"),
    ],
)  # fmt: skip
def test_what_is_told_of_its_thing_goes_to_the_question(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("Where is my kite? It's urgent.", "where is my kite"),
        ("Where is my kite? The one I bought last week.", "where is my kite"),
        ("Where is my kite? My bag?", "where is my bag"),
        ("Where is my kite? Thanks.", "where is my kite"),
    ],
)
def test_what_tells_nothing_of_it_leaves_the_question(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    "said", ["Is the kite dirty? The pink one.", "What's that worth? My pink kite."]
)
def test_a_thing_named_after_a_refused_question_is_not_looked_for(said: str) -> None:
    with pytest.raises(OutOfScope):
        parse(said, now=NOW)


def test_what_tells_which_one_is_never_left_out() -> None:
    with pytest.raises(NotUnderstood, match="which you mean"):
        parse("Where is my kite? The one without much of a chance.", now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("where's my kite, hen?", "where is my kite"),
        ("where's my kite, Maureen?", "where is my kite"),
        ("is the kite on the lawn, big fella", "is the kite on the lawn"),
        ("is the kite in the kitchen, Moe", "is the kite in the kitchen"),
        ("did you see my kite, gaffer, yesterday", "did you see my kite yesterday"),
        ("where is my kite karen", "where is my kite"),
        ("is the kite in the kitchen grandma", "is the kite in the kitchen"),
        ("where is the car jack", "where is the car jack"),
    ],
)
def test_who_is_called_is_no_part_of_the_thing(said: str, plainly: str) -> None:
    found = parse(said, now=NOW)
    assert alike(said, plainly)
    assert found.objects[0].word in ("kite", "car jack")


@pytest.mark.parametrize(
    ("said", "things"),
    [
        ("where are the kite, the gizmo, and the bag", ["kite", "gizmo", "bag"]),
        ("where are my keys wallet and kite", ["key", "wallet", "kite"]),
        ("where are the cups plates bowls and kite", ["cup", "plate", "bowl", "kite"]),
        ("where are the shoes rack and the kite", ["shoes rack", "kite"]),
    ],
)
def test_a_list_calls_nobody_and_needs_no_pause(said: str, things: list[str]) -> None:
    assert [term.word for term in parse(said, now=NOW).objects] == things


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("nothing on the lawn?", "is there nothing on the lawn"),
        ("no kite in the kitchen?", "is there no kite in the kitchen"),
        ("Is the cup on the lawn? And the kite?", "is the kite on the lawn"),
        ("Did you see my cup yesterday? My kite?", "did you see my kite yesterday"),
        ("Is the kite on the lawn? Thanks.", "is the kite on the lawn"),
        ("what time did you see the tortoise", "at what time did you see the tortoise"),
    ],
)
def test_what_is_asked_stays_what_it_is(said: str, plainly: str) -> None:
    found, meant = (parse(t, now=NOW) for t in (said, plainly))
    assert (found.ask, found.negated, found.place) == (meant.ask, meant.negated, meant.place)
    assert [term.category for term in found.objects] == [term.category for term in meant.objects]


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("where is my kite question mark", "where is my kite?"),
        ("robot comma where is my kite full stop", "where is my kite"),
        ("is anything on the stairs period", "is anything on the stairs"),
        ("where are the kite comma the bag comma and the cup", "where are the kite, bag and cup"),
        ("my kite on the lawn question mark", "my kite on the lawn?"),
    ],
)
def test_a_mark_may_be_dictated(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize("said", ["question mark", "question mark poster", "big question mark"])
def test_a_thing_may_be_called_as_a_mark_is(said: str) -> None:
    assert parse(f"where is the {said}", now=NOW).objects[0].word in said


@pytest.mark.parametrize(
    "said",
    [
        "is the hall light on question mark",
        "what style is the furniture in",
        "which side of the bed is the lamp on",
        "what order are the books in",
        "what channel is the television on",
        "is the oven at 200 degrees",
        "was the battery at 20 percent",
        "is the lid on tight",
        "is the cup in the way",
        "is everything in its place",
        "are there stains on the rug",
        "did the drummer show up",
        "did somebody use my towel",
        "tell me when you see my kite",
        "when is the service",
        "when was the rehearsal",
        "is there ice in the freezer tray",
    ],
)
def test_what_no_thing_is_in_or_on_is_refused(said: str) -> None:
    with pytest.raises(QuestionError):
        parse(said, now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("which kites went missing yesterday", "which kites are missing yesterday"),
        ("last seen: kite", "kite last seen"),
        ("objects on the lawn", "what is on the lawn"),
        ("anything left on the lawn?", "is there anything left on the lawn"),
        ("kite location yesterday", "where was the kite yesterday"),
        ("show the positions of all kites", "where are all the kites"),
        ("give me everywhere the kite has been", "everywhere the kite has been"),
        ("where was the kite last time you saw it", "where was the kite the last time you saw it"),
        ("where was the kite when it was four o'clock", "where was the kite at four o'clock"),
        ("when did you last clap eyes on my kite", "when did you last see my kite"),
        ("did the delivery man leave a kite on the lawn", "did anna leave a kite on the lawn"),
        ("where's my kite I can't find it and mum says we must go", "where is my kite"),
        ("any chance the kite's in the bag", "any chance the kite is in the bag"),
        ("how many kite stands have we got", "how many kite stands are there"),
        ("please confirm whether or not the kite is here", "is the kite here"),
        ("where is the blue the dark blue kite", "where is the dark blue kite"),
        ("is my kite is it on the lawn", "is my kite on the lawn"),
        ("have you my kite seen", "have you seen my kite"),
        ("i wonder whether you know where my kite is", "where is my kite"),
        ("lost my kite smh where is it", "where is my kite"),
        ("where did i chuck my kite", "where did i leave my kite"),
        ("can you hear me okay where is my kite", "where is my kite"),
        ("did one of the blokes leave a kite here", "did anyone leave a kite here"),
        ("was the kite here on apr-14-2026", "was the kite here on april 14 2026"),
        ("where was the kite on monday last", "where was the kite last monday"),
        ("where was the kite on sunday past", "where was the kite last sunday"),
        ("where was the kite between breakfast and lunch", "where was the kite from 9 am to 11 am"),
        ("where was the kite from lunch until dinner", "where was the kite from 14:00 to 18:00"),
        ("where was the kite between 8 am and lunch", "where was the kite from 8 am to 11 am"),
    ],
)  # fmt: skip
def test_ways_to_say_it(said: str, plainly: str) -> None:
    found, meant = (parse(t, now=NOW) for t in (said, plainly))
    told = ("ask", "relation", "place", "time", "select", "negated")
    assert [getattr(found, name) for name in told] == [getattr(meant, name) for name in told]
    assert [term.category for term in found.objects] == [term.category for term in meant.objects]


def test_a_thing_that_nobody_knows_is_no_misspelled_look() -> None:
    assert parse("did anyone put my slime on the bench", now=NOW).objects[0].word == "slime"
