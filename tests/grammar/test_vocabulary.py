"""The vocabulary: synonyms, plurals, detector spellings, and files that agree with each other."""

from __future__ import annotations

from collections import Counter
from datetime import datetime

import pytest

from grammar import QuestionError, parse
from grammar.adjectives import describes
from grammar.forms import RELATION_KINDS, SELECTS
from grammar.phrases import phrases
from grammar.reading import QUESTION
from grammar.vocabulary import (
    StoreWords,
    broader,
    canonical,
    files,
    lexicon,
    narrower,
    plural,
    singular,
    synonyms,
    unlisted_lead,
)

NOW = datetime.fromisoformat("2026-05-14T20:30:00+01:00")
COCO = [
    " ".join(name.split())
    for name in """
        person, bicycle, car, motorcycle, airplane, bus, train, truck, boat, traffic light, fire
        hydrant, stop sign, parking meter, bench, bird, cat, dog, horse, sheep, cow, elephant,
        bear, zebra, giraffe, backpack, umbrella, handbag, tie, suitcase, frisbee, skis,
        snowboard, sports ball, kite, baseball bat, baseball glove, skateboard, surfboard,
        tennis racket, bottle, wine glass, cup, fork, knife, spoon, bowl, banana, apple,
        sandwich, orange, broccoli, carrot, hot dog, pizza, donut, cake, chair, couch, potted
        plant, bed, dining table, toilet, tv, laptop, mouse, remote, keyboard, cell phone,
        microwave, oven, toaster, sink, refrigerator, book, clock, vase, scissors, teddy bear,
        hair drier, toothbrush
    """.replace("\n", " ").split(",")
]


@pytest.mark.parametrize("category", COCO)
def test_a_detectors_category_is_its_own(category: str) -> None:
    assert canonical(category) == category
    assert canonical(category.replace(" ", "")) == category
    assert canonical(plural(category)) == category


@pytest.mark.parametrize(
    ("said", "category"),
    [
        ("mug", "cup"),
        ("mugs", "cup"),
        ("sofa", "couch"),
        ("sportsball", "sports ball"),
        ("pottedplant", "potted plant"),
        ("tvmonitor", "tv"),
        ("wineglass", "wine glass"),
        ("diningtable", "dining table"),
        ("cellphone", "cell phone"),
        ("phone", "cell phone"),
        ("lap top", "laptop"),
        ("tooth brush", "toothbrush"),
        ("things", "object"),
        ("zorbs", "zorb"),
        ("fruit bowl", "fruit bowl"),
    ],
)
def test_canonical(said: str, category: str) -> None:
    assert canonical(said) == category


@pytest.mark.parametrize(
    ("many", "one"),
    [
        ("keys", "key"),
        ("glasses", "glasses"),
        ("shelves", "shelf"),
        ("knives", "knife"),
        ("boxes", "box"),
        ("scissors", "scissors"),
        ("batteries", "battery"),
        ("shoes", "shoe"),
        ("potatoes", "potato"),
        ("coffee machines", "coffee machine"),
        ("pencil cases", "pencil case"),
        ("buses", "bus"),
        ("toothbrushes", "toothbrush"),
        ("children", "child"),
    ],
)
def test_singular(many: str, one: str) -> None:
    assert singular(many) == one


def test_every_noun_and_its_plural_have_one_category() -> None:
    wrong = [noun for noun in lexicon().nouns if canonical(plural(noun)) != canonical(noun)]
    assert wrong == []


def test_broader_and_narrower_are_inverse() -> None:
    assert "ball" in broader("sports ball")
    assert "sports ball" in narrower("ball")
    assert broader("fruit bowl")[0] == "bowl"
    assert broader("zorb") == ()
    for category in lexicon().broader:
        for wide in broader(category):
            assert category in narrower(wide) or wide not in lexicon().nouns


def test_synonyms_share_a_category() -> None:
    assert "mug" in synonyms("cup")
    assert {canonical(word) for word in synonyms("cup")} == {"cup"}


def test_no_category_is_a_synonym_of_another() -> None:
    nouns = lexicon().nouns
    assert [c for c in nouns.values() if nouns[c] != c] == []


def test_relations_are_of_the_contract() -> None:
    assert set(lexicon().relations.values()) == set(RELATION_KINDS)


def test_phrases_are_terminals_of_the_grammar() -> None:
    own = {
        "drop", "last", "first", "usual", "negative", "where_room", "where_last",
        "where_first", "when_last",
        "when_first", "where_all", "when_all", "same_place", "seen_alone", "any_alone", "what_last",
        "what_first", "same_room",
        "BE_PRESENT", "BE_PAST", "AUX_DO",
        "AUX_DID", "AUX_HAVE", "AUX_CAN", "stands", "stood",
    }  # fmt: skip
    found = {terminal for entries in phrases().by_first.values() for _, terminal in entries}
    plain = {terminal for terminal in found if not terminal.startswith("REL ")}
    assert plain - own <= set(QUESTION.text.rpartition("%declare")[2].split())
    assert {"last", "first", "usual"} <= set(SELECTS)


@pytest.mark.parametrize(
    ("own", "said", "place"),
    [
        ((), "hallway", "hallway"),
        (("hall",), "hallway", "hall"),
        (("Lounge",), "living room", "lounge"),
        (("lounge",), "sitting room", "lounge"),
        (("nook",), "nook", "nook"),
        (("reading-corner",), "reading corner", "reading-corner"),
        (("reading-corner",), "reading-corner", "reading-corner"),
        (("Play_Room",), "play room", "play_room"),
        (("sun room", "sun-room"), "sun room", "sun room"),
    ],
)
def test_a_place_is_spelled_as_said_or_as_the_store_has_it(
    own: tuple[str, ...], said: str, place: str
) -> None:
    assert lexicon(StoreWords(places=own)).places[said] == place


@pytest.mark.parametrize(
    ("word", "describes_it"),
    [
        ("quilted", True),
        ("woven", True),
        ("waterproof", True),
        ("greenish", True),
        ("leafy", True),
        ("silken", True),
        ("stained", True),
        ("tweed", False),
        ("puppy", False),
        ("kitchen", False),
        ("fairy", False),
    ],
)
def test_an_adjective_is_told_by_its_making(word: str, *, describes_it: bool) -> None:
    assert describes(word, lexicon().heads | {"silk"}) is describes_it


@pytest.mark.parametrize(
    ("joined", "listed"),
    [("dishwasher", True), ("dishwashers", True), ("headphones", True), ("today", False),
     ("carpet", True), ("coffee machine", False), ("mugs", False)],
)  # fmt: skip
def test_words_said_apart_are_one_noun_where_it_is_listed(joined: str, *, listed: bool) -> None:
    assert lexicon().is_one_word(joined) is listed


def test_no_noun_stands_in_two_lines() -> None:
    lines = [line.partition(">")[0] for line in files.lines("nouns.txt")]
    said = [word for line in lines for word in {*files.split(line.replace("=", ","))}]
    assert [word for word, count in Counter(said).items() if count > 1] == []


def test_a_noun_with_a_number_is_a_kind_of_the_noun() -> None:
    assert lexicon().wider("shelf 2")[0] == "shelf"
    assert lexicon().wider("box three")[0] == "box"


@pytest.mark.parametrize(
    "noun",
    [
        "beer can",
        "can opener",
        "saw blade",
        "record player",
        "glue stick",
        "train set",
        "cake stand",
        "ring light",
        "wine cork",
        "pizza stone",
        "door stop",
        "face wash",
        "coffee maker",
        "smoke alarm",
        "bird house",
        "toy robot",
        "spirit level",
        "tea cart",
        "clay",
        "mustard",
        "saw",
        "can",
    ],
)
@pytest.mark.parametrize(
    "asked",
    [
        "where is the {}",
        "is there a {} on the mat",
        "did you see the {} yesterday",
        "is the {} near the mat",
        "when did you last see the {}",
    ],
)
def test_a_noun_that_is_also_a_verb_a_look_or_no_thing(asked: str, noun: str) -> None:
    query = parse(asked.format(noun), now=NOW)
    assert query.objects[0].word == noun
    assert len(query.objects) == 1 + ("mat" in asked)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("was the cup set on the mat", "cup"),
        ("where did mom stick the cup", "cup"),
        ("is the cup on the mat clay", "cup"),
        ("where is the cup that is walnut", "cup"),
        ("which cup is leather", "cup"),
        ("where is the 12 mm bolt", "12 mm bolt"),
        ("is the jack under the mat", "jack"),
        ("where is the jack knife", "jack knife"),
    ],
)
def test_a_verb_or_a_look_stays_one(text: str, word: str) -> None:
    assert parse(text, now=NOW).objects[0].word == word


@pytest.mark.parametrize(
    "text",
    [
        "where is the noise level",
        "where is the music",
        "did mom wash",
        "is jack under the mat",
        "when is the party",
        "how many calories are in a cake",
        "is anything burning in the kitchen",
        "where can I hide the presents",
        "how many people can sit on the mat",
        "where is the bus going",
        "what goes with this hat",
        "which switch turns on the lamp",
        "which door leads to the garage",
        "where do the dishes go",
        "which room is the warmest",
        "how many people fit on the mat",
        "is there gas in the tank",
    ],
)
def test_no_thing_stays_none(text: str) -> None:
    with pytest.raises(QuestionError):
        parse(text, now=NOW)


@pytest.mark.parametrize(
    ("noun", "lead"),
    [
        ("blurple cup", "blurple"),
        ("dark blurple cup", "dark blurple"),
        ("coffee table", ""),
        ("kitchen cup", ""),
        ("cup", ""),
        ("blurple thingamajig", ""),
    ],
)
def test_what_stands_before_the_head_of_an_unlisted_compound(noun: str, lead: str) -> None:
    assert unlisted_lead(noun) == lead
