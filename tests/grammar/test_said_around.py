"""What people say around a question, and how they break off and mend it."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest

from grammar import QuestionError, parse

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")


def alike(said: str, plainly: str) -> bool:
    """Whether two sayings are one query, but for their tense."""
    found, meant = (replace(parse(t, now=NOW), text="", now=False) for t in (said, plainly))
    return found == meant


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("I hate to be a pest, but where is my tent?", "where is my tent"),
        ("The bus leaves soon and it is icy, where are my boots", "where are my boots"),
        ("Be an angel and tell me what lies on the stool", "what lies on the stool"),
        ("My aunt put it away: is the quilt in the trunk?", "is the quilt in the trunk"),
        ("I would be glad to learn how many jars are in the sink", "how many jars are in the sink"),
        ("We got home at nine last night and wonder where the pram is", "where is the pram"),
        ("where is my raincoat, it is pouring", "where is my raincoat"),
        ("have you seen the leash, my dog wants to go out", "have you seen the leash"),
        ("Would you know, if you don't mind, where the stapler is?", "where is the stapler"),
        ("where is, for heaven's sake, my blasted purse", "where is my purse"),
        ("sorry to disturb you again, where's the tripod, my dear", "where is the tripod"),
        ("nephew where is my rake", "where is my rake"),
        ("sir where is my rake kindly tell", "where is my rake"),
        ("where is my rake only I need it", "where is my rake"),
        ("wait where did i no where did anna leave her rake", "where did anna leave her rake"),
        ("where did i put the where did i put my rake", "where did i put my rake"),
        ("any idea where the rake's got to", "where the rake has got to"),
        ("do you know where the rake's gone", "where has the rake gone"),
        ("was there like a green um jar here", "was there a green jar here"),
        ("how many number of rakes are there", "how many rakes are there"),
        ("what it is on the table", "what is on the table"),
        ("where... is my rake", "where is my rake"),
        ("is the rake on the... bench", "is the rake on the bench"),
        ("where are the pruning... shears", "where are the pruning shears"),
        ("where is, you know, my rake", "where is my rake"),
        ("is you know the rake in the hall", "is the rake in the hall"),
        ("did you like see my rake", "did you see my rake"),
        ("where was the rake between like 9 am and 11 am", "where was the rake from 9 am to 11 am"),
        ("is there anything like missing in the hall", "is anything missing in the hall"),
        ("did you by any um chance see my rake", "did you see my rake"),
        ("my rake is gone, where um did you last see it", "where did you last see my rake"),
        ("where is the rake that isn't that isn't red", "where is the rake that isn't red"),
        ("was there no no rake on the bench", "was there no rake on the bench"),
        ("is the rake on the bench, anyone", "is the rake on the bench"),
        ("where is my rake anyone", "where is my rake"),
        ("where did i leave my rake please hurry", "where did i leave my rake"),
        ("when did you last see the rake I can't find it", "when did you last see the rake"),
        ("how many rakes are in the hall I need it back", "how many rakes are in the hall"),
        ("next question where is my rake", "where is my rake"),
        ("in case you know is the rake in the hall", "is the rake in the hall"),
        ("robot quick is the rake in the hall", "is the rake in the hall"),
        ("nobody can tell me where the rake is", "where is the rake"),
        ("the thing is I don't know where the rake is", "where is the rake"),
        ("any chance you know where the rake is", "where is the rake"),
        ("ask the robot if the rake is in the hall", "is the rake in the hall"),
        ("where did my little brother leave the rake", "where did my brother leave the rake"),
        ("where is the room where is my rake", "where is my rake"),
        ("do the needful and tell me the location where is my rake", "where is my rake"),
        ("in the morning i left my rake here where is it now", "where is my rake"),
        ("i am not getting my rake", "i can not find my rake"),
        ("how many nos of rakes are there", "how many rakes are there"),
        ("is the rake still in the hall or did it move", "is the rake still in the hall"),
        ("list the places where the rake was", "all the places where the rake was"),
        ("do we have any rakes left", "do we have any rakes"),
        ("where are my rakes the ones with a handle", "where are my rakes with a handle"),
        ("where is the rake what i had", "where is the rake i had"),
        ("we are off and I need the rake, any idea where it is", "where is the rake"),
        ("pretty please tell me where my rake is", "where is my rake"),
        ("Give the last observed location of the rake", "last known location of the rake"),
        ("count of rakes on the bench", "how many rakes are on the bench"),
        ("Time of first appearance of the rake", "time of the first sighting of the rake"),
        ("During which hours was the rake here", "when was the rake here"),
        ("where is the rake most frequently located", "where is the rake most often"),
        ("has my rake fallen behind the bench", "was my rake behind the bench"),
        ("where i put it my rake", "where i put my rake"),
        ("my rake, where it is?", "where is my rake"),
        ("is somewhere my rake", "is my rake somewhere"),
        ("bro have u seen my rake tho", "have you seen my rake"),
        ("where is the rattle my daughter always plays with", "where is the rattle"),
        ("kindly indicate where the rake was last placed", "where was the rake last placed"),
        ("do you happen to recall when you last saw my flute", "when did you last see my flute"),
    ],
)  # fmt: skip
def test_what_is_told_around_a_question_is_left_out(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    "said",
    [
        "I hate to be a pest, but why is the tap dripping?",
        "I have a fever, where can I lie down",
        "does anna have my keys",
        "what is the sofa like",
        "do you like the sofa",
        "is the baby asleep in the crib",
        "where would you put the sofa",
        "when does the bus leave",
        "do we have guests",
        "how many euros are in my wallet",
        "turn the fan off, is the cup on the table",
        "where is the cup, where is the bowl",
        "is the heating on, or where is the blanket",
        "attic where is the cup",
        "where is the cup the bowl",
        "where is the rattle my daughter played with yesterday",
        "which rooms still need painting",
        "I was glad when the cup was on the table",
        "where did you see my wallet, I had it an hour ago",
    ],
)
def test_nothing_that_asks_orders_or_tells_a_time_is_cut_off(said: str) -> None:
    with pytest.raises(QuestionError):
        parse(said, now=NOW)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("is there a spade, a rake I mean, in the garage", "is there a rake in the garage"),
        ("where is the pencil, pen rather?", "where is the pen"),
        ("what was in the attic, er, the shed yesterday", "what was in the shed yesterday"),
        ("did you see my scarf, or let's say my shawl, today", "did you see my shawl today"),
        ("where is my... erm... kettle", "where is my kettle"),
        ("where are the gloves... er, Tom's gloves?", "where are tom's gloves"),
        ("where is, um, where is the soup bowl", "where is the soup bowl"),
        ("did you see my, what's it called, my ruler", "did you see my ruler"),
        ("where did I leave the, uh, the thing, the drill", "where did I leave the drill"),
        ("where is the fork \u2014 no, the ladle", "where is the ladle"),
        ("where did you, when did you last see the vase", "when did you last see the vase"),
        ("where is my cap, the red one I mean", "where is my red cap"),
        ("was the rope yesterday, um, in the garage", "was the rope in the garage yesterday"),
    ],
)  # fmt: skip
def test_a_speaker_mends_what_she_said(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("where can be found the ladder", "where can i find the ladder"),
        ("is in the garage a rake", "is there a rake in the garage"),
        ("are there on the shelf any jars", "are there any jars on the shelf"),
        ("exists a mirror near of the bed", "is there a mirror near the bed"),
        ("my boots where", "where are my boots"),
        ("boots last seen where", "where were the boots last seen"),
        ("when last seen stapler", "when was the stapler last seen"),
        ("where it is my ruler", "where is my ruler"),
        ("is it there a rake in the garage", "is there a rake in the garage"),
        ("where was it, the rake", "where was the rake"),
        ("where oh where is my rake", "where is my rake"),
        ("in which location is the rake", "in which place is the rake"),
        ("the present whereabouts of the rake", "where is the rake"),
        ("in which room may I find the rake", "in which room can I find the rake"),
        ("can we assume that the rake is in the attic", "is the rake in the attic"),
        ("for what length of time was the rake in the attic", "how long was the rake in the attic"),
        ("anybody seen the rake", "have you seen the rake"),
        ("where was mrs. hall's rake last seen", "where was mrs hall's rake last seen"),
        ("where's my trusty rake", "where is my rake"),
        ("has the rake been in the attic at all today", "has the rake been in the attic today"),
        ("are none of the jars on the shelf", "are no jars on the shelf"),
        ("is there a rake set up in the attic", "is there a rake in the attic"),
        ("what is inn the box", "what is in the box"),
        ("where did eye leave my rake", "where did i leave my rake"),
        ("where on god's green earth is my rake", "where is my rake"),
        ("might there be a rake in the attic", "could there be a rake in the attic"),
        ("anything moved in the attic?", "has anything moved in the attic"),
        ("anything missing from the shelf?", "is anything missing from the shelf"),
        ("did you happen to see where I put my rake", "where did i put my rake"),
        ("where might one find the rake", "where might i find the rake"),
        ("what is the usual place for the rake", "the usual place for the rake"),
        ("search the attic for my rake", "look for my rake in the attic"),
        ("look under the bench for my rake", "look for my rake under the bench"),
        ("see if my rake is in the attic", "is my rake in the attic"),
        ("the cat, when did you last see her", "the cat, when did you last see it"),
        ("my rake is lost, help", "my rake is lost"),
        ("which places did you see my rake", "in which places did you see my rake"),
        ("what used to be on the shelf", "what was on the shelf"),
        ("where lies the ruler", "where is the ruler"),
        ("where are the boots from anna", "where are anna's boots"),
        ("report the last known position of the rake", "where was the rake last seen"),
        ("list all jars seen in the attic", "show me all the jars in the attic"),
        ("show every jar that was noticed on the shelf", "show me every jar on the shelf"),
        ("everything in the attic", "show me everything in the attic"),
        ("rake in the garage?", "is there a rake in the garage"),
        ("my boots on the mat?", "are my boots on the mat"),
        ("last place you saw the rake", "the last place you saw the rake"),
        ("what is it that hangs on the hook", "what hangs on the hook"),
        ("when was it the last time you saw my bike", "when was the last time you saw my bike"),
        ("wen did you last see my bike", "when did you last see my bike"),
        ("how many distinct jars are on the shelf", "how many jars are on the shelf"),
    ],
)
def test_another_order_of_words_asks_the_same(said: str, plainly: str) -> None:
    assert alike(said, plainly)


ASKED = (
    "where is my green jar",
    "did you see anna's rake yesterday",
    "is there no rug in the attic",
    "how many jars are on the shelf",
)


@pytest.mark.parametrize(
    "said",
    [
        "oh my god {}",
        "quick question: {}",
        "do me a favor: {}",
        "not sure if you know but {}",
        "I'm back. {}",
        "{}, no rush",
        "{}, would you know",
        "{} thank you very much",
        "{}, any idea",
        "{}, honey",
        "{}, pretty please",
        "{}, just asking",
    ],
)
@pytest.mark.parametrize("asked", ASKED)
def test_what_stands_before_or_after_changes_nothing(said: str, asked: str) -> None:
    assert alike(said.format(asked), asked)


@pytest.mark.parametrize(
    "opening",
    [
        "my neighbour wants to know",
        "mom asks",
        "I keep asking myself",
        "I am asking you",
        "help me figure out",
        "could you find out for me",
        "please tell me, robot,",
        "it would be useful to know",
    ],
)
def test_a_question_may_be_told(opening: str) -> None:
    assert alike(f"{opening} where my green jar is", "where is my green jar")
    assert alike(f"{opening} how many jars are on the shelf", "how many jars are on the shelf")


@pytest.mark.parametrize(
    "mark", ["no", "I mean", "or rather", "actually", ", sorry,", "... no,", "- no -", "wait no"]
)
@pytest.mark.parametrize(
    ("asked", "first", "then"),
    [
        ("where is {}", "the rake", "the broom"),
        ("have you seen {} today", "my keys", "anna's keys"),
        ("where was the jar {}", "on the 3rd", "on the 4th of march"),
        ("did you see the jar {}", "last night", "this morning"),
        ("is the jar {}", "on the shelf", "under the bench"),
    ],
)
def test_the_later_words_count(asked: str, first: str, then: str, mark: str) -> None:
    assert alike(asked.format(f"{first} {mark} {then}"), asked.format(then))


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("Where is the rake? And the broom?", "where is the rake and the broom"),
        ("Did you see my jar. And what about my rake?", "did you see my jar and my rake"),
        ("Where is the rake? And where is the broom?", "where is the broom"),
        ("Is the rake in the hall? The broom is.", "is the rake in the hall"),
    ],
)
def test_things_asked_for_after_the_question_belong_to_it(said: str, plainly: str) -> None:
    assert alike(said, plainly)


@pytest.mark.parametrize(
    ("said", "thing"),
    [
        ("She can't find her purse", "handbag"),
        ("my wife cannot find her purse", "handbag"),
        ("mum can't find her glasses", "glasses"),
        ("she is looking for her phone", "cell phone"),
        ("They can't find the scissors", "scissors"),
    ],
)
def test_what_another_person_looks_for_is_asked_for(said: str, thing: str) -> None:
    query = parse(said, now=NOW)
    assert (query.ask, query.select, query.negated) == ("where", "last", False)
    assert [term.category for term in query.objects] == [thing]
