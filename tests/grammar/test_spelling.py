"""Spelling: slips are corrected and reported; any noun may be asked for."""

from __future__ import annotations

from datetime import datetime

import pytest

from grammar import Correction, QuestionError, StoreWords, parse_report

NOW = datetime.fromisoformat("2020-01-01T18:00:00-05:00")


@pytest.mark.parametrize(
    ("said", "slip", "taken"),
    [
        ("where is my phon", "phon", "phone"),
        ("where is the backpak", "backpak", "backpack"),
        ("where is my walet", "walet", "wallet"),
        ("where is my wallett", "wallett", "wallet"),
        ("where is the umberlla", "umberlla", "umbrella"),
        ("wheer is the cup", "wheer", "where"),
        ("where was the cup yesterdya", "yesterdya", "yesterday"),
        ("is the cup on the tabel", "tabel", "table"),
        ("is there a cup in the kitchn", "kitchn", "kitchen"),
        ("where is the refridgeratr", "refridgeratr", "refrigerator"),
        ("where is my fone", "fone", "phone"),
        ("whay is on the desk", "whay", "what"),
        ("whete is the cup", "whete", "where"),
        ("is thhe cup on the desk", "thhe", "the"),
        ("is the cup in the kithen", "kithen", "kitchen"),
        ("what mooved in the hall", "mooved", "moved"),
        ("where was the cup this mornng", "mornng", "morning"),
        ("did ypu see the cup", "ypu", "you"),
        ("where is my read cup", "read", "red"),
        ("where is my sell phone", "sell", "cell"),
        ("did you see a teddy bare", "bare", "bear"),
        ("is the key in the draw", "draw", "drawer"),
        ("where is the vace", "vace", "vase"),
        ("where are the keyes", "keyes", "keys"),
        ("where are my keyz", "keyz", "keys"),
        ("where are my kees", "kees", "keys"),
        ("where is the trolly", "trolly", "trolley"),
        ("did you see my cup anywere", "anywere", "anywhere"),
        ("where is the cupp", "cupp", "cup"),
        ("where did i leve my bag", "leve", "leave"),
    ],
)
def test_a_slip_is_corrected_and_reported(said: str, slip: str, taken: str) -> None:
    found = parse_report(said, now=NOW)
    assert found.corrections == (Correction(slip, taken, said.index(slip)),)


@pytest.mark.parametrize(
    "noun",
    [
        "zorbulator",
        "burger",
        "clarinet",
        "cola",
        "packet",
        "spotlight",
        "slider",
        "magnetic board",
        "trowel",
        "crate",
        "poncho",
        "gizmo",
        "chain",
        "plank",
        "easel",
        "monocle",
        "ukulele",
    ],
)
def test_a_noun_that_is_no_slip_stays(noun: str) -> None:
    found = parse_report(f"where is the {noun}", now=NOW)
    assert found.corrections == ()
    assert found.query.objects[0].category == noun


def test_a_stores_words_are_known_and_targets() -> None:
    words = StoreWords(categories=("quadcopter",), names=(("tamagotchi", "anna"),))
    assert parse_report("where is the quadcopter", now=NOW, words=words).corrections == ()
    found = parse_report("where is the tamagotchy", now=NOW, words=words)
    assert [c.taken for c in found.corrections] == ["tamagotchi"]


def test_a_query_carries_its_corrections_and_its_record_names_them() -> None:
    query = parse_report("where is my umbrela", now=NOW).query
    assert query.corrections == (Correction("umbrela", "umbrella", 12),)
    record = query.to_json()
    assert record["corrections"] == [{"said": "umbrela", "taken": "umbrella", "position": 12}]
    assert type(query).from_json(record).corrections == query.corrections
    assert "corrections" not in parse_report("where is my umbrella", now=NOW).query.to_json()


@pytest.mark.parametrize(
    ("said", "slip", "taken"),
    [
        ("where did i leav my keys", "leav", "leave"),
        ("where did i levae my keys", "levae", "leave"),
        ("have you sen my keys", "sen", "seen"),
        ("did yu see my keys", "yu", "you"),
        ("did you lst see my keys", "lst", "last"),
        ("how meny cups are on the table", "meny", "many"),
        ("did you sea my keys", "sea", "see"),
        ("where our my keys", "our", "are"),
    ],
)
def test_a_slip_in_the_grammars_own_words_is_corrected_where_nothing_reads_it(
    said: str, slip: str, taken: str
) -> None:
    assert parse_report(said, now=NOW).corrections == (Correction(slip, taken, said.index(slip)),)


@pytest.mark.parametrize(
    "text", ["did you hire the plumber", "why did you sea my keys", "did you pet the dog"]
)
def test_no_slip_makes_a_question_of_what_is_none(text: str) -> None:
    with pytest.raises(QuestionError):
        parse_report(text, now=NOW)


def test_a_noun_that_sounds_like_a_verb_stays() -> None:
    assert parse_report("where is the sea", now=NOW).corrections == ()


def test_the_question_keeps_its_own_text() -> None:
    found = parse_report("where is my phon", now=NOW)
    assert found.query.text == "where is my phon"
    assert found.query.objects[0].word == "phone"


@pytest.mark.parametrize("thing", ["bees", "fees"])
def test_a_plural_is_no_slip_of_a_small_word(thing: str) -> None:
    assert parse_report(f"where are the {thing}", now=NOW).corrections == ()
