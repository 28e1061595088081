"""Dialogues: follow-ups merged with the query before them, the last query of each judged."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assistant.dialogue import Seen, follow, is_of_the_listed, merge
from grammar import NotUnderstood, QuestionError, StoreWords, parse
from grammar.forms import FormalQuery, Json, ObjectTerm, TimeSlice
from grammar.fragments import Fragment, parse_fragment

CORPUS = Path(__file__).parents[1] / "corpus" / "dialogues.toml"
NOW = datetime.fromisoformat("2020-01-01T18:00:00-05:00")
WORDS = StoreWords()
FIRST = "was the red cup on the table yesterday"


def dialogues() -> Iterator[Any]:
    """Yield a test case for each dialogue, its title the id."""
    record = tomllib.loads(CORPUS.read_text(encoding="utf-8"))
    for dialogue in record["dialogue"]:
        seen_at = dialogue.get("seen_at")
        seen = datetime.fromisoformat(seen_at) if seen_at else None
        yield pytest.param(
            dialogue["turns"],
            Seen(seen, seen) if seen else None,
            id=dialogue["title"],
        )


def holds(want: Any, got: Any) -> bool:
    """Whether what is wanted is in what was got: only the named fields count."""
    if want == "none":
        return got is None
    if isinstance(want, dict):
        return isinstance(got, dict) and all(holds(v, got.get(k)) for k, v in want.items())
    if isinstance(want, list) and want and isinstance(want[0], dict):
        return len(want) == len(got) and all(map(holds, want, got))
    return bool(want == got)


@pytest.mark.parametrize(("turns", "seen"), list(dialogues()))
def test_dialogue(turns: list[Json], seen: Seen | None) -> None:
    last: FormalQuery | None = None
    for turn in turns:
        last = follow(turn["say"], now=NOW, words=WORDS, last=last, seen=seen)
        assert last.text == turn["say"]
        want = {**turn["want"]} if "want" in turn else {}
        if "time" in want:
            want["time"] = {"start": None, "end": None, **want["time"]}
        assert holds(want, last.to_json()), last.to_json()


def test_there_are_thirty_dialogues_of_three_turns() -> None:
    found = [param.values[0] for param in dialogues()]
    assert len(found) >= 30
    assert all(len(turns) >= 3 and "want" in turns[-1] for turns in found)


def test_the_first_turn_is_a_question_of_its_own() -> None:
    assert follow(FIRST, now=NOW, words=WORDS, last=None) == parse(FIRST, now=NOW)
    with pytest.raises(QuestionError):
        follow("and before that?", now=NOW, words=WORDS, last=None)


def test_before_that_needs_a_time_to_start_from() -> None:
    last = parse("where is the cup", now=NOW)
    with pytest.raises(NotUnderstood):
        follow("and before that?", now=NOW, words=WORDS, last=last)


def test_an_empty_fragment_changes_nothing_but_the_words() -> None:
    last = parse(FIRST, now=NOW)
    merged = merge(last, Fragment(text=FIRST))
    assert merged == last


def test_a_fragment_says_what_it_changes() -> None:
    last = parse(FIRST, now=NOW)
    found = parse_fragment("and the blue ones in the hall?", now=NOW, previous=last)
    assert isinstance(found, Fragment)
    assert found.terms[0].attributes == ("blue",)
    assert found.time is None
    merged = merge(last, found)
    assert merged.objects[0].category == "cup"
    assert merged.objects[0].attributes == ("blue",)
    assert merged.place == "hall"
    assert merged.time == last.time


@given(
    st.lists(
        st.sampled_from(
            [
                "and",
                "what",
                "about",
                "the",
                "red",
                "one",
                "cup",
                "bowl",
                "yesterday",
                "before",
                "that",
                "in",
                "kitchen",
                "on",
                "table",
                "when",
                "it",
                "was",
                "is",
                "where",
                "not",
                "how",
                "many",
                "anna's",
                "mine",
                "?",
                ",",
                "then",
                "since",
                "an",
                "hour",
                "earlier",
            ]
        ),
        max_size=8,
    )
)
@example(["about"])
def test_any_follow_up_is_a_query_or_a_question_error(words: list[str]) -> None:
    last = parse(FIRST, now=NOW)
    try:
        found = follow(" ".join(words), now=NOW, words=WORDS, last=last)
    except QuestionError:
        return
    assert FormalQuery.from_json(found.to_json()) == found


@pytest.mark.parametrize("text", ["thanks", "not those"])
def test_what_names_nothing_changes_nothing(text: str) -> None:
    with pytest.raises(NotUnderstood):
        follow(text, now=NOW, words=WORDS, last=parse("where is the cup", now=NOW))


LISTED = "what did you see on the table"
TOLD = Seen(NOW, NOW, ObjectTerm("cup", "cup"))


@pytest.mark.parametrize(
    ("text", "words", "place"),
    [
        ("did you see it yesterday?", ["cup"], None),
        ("is it on the chair?", ["cup", "chair"], None),
        ("was it in the hall this morning?", ["cup"], "hall"),
        ("did you see a bowl next to it?", ["bowl", "table"], None),
        ("what is under it?", ["thing", "table"], None),
        ("did you see them yesterday?", ["thing", "table"], None),
        ("did you see the table yesterday?", ["table"], None),
    ],
)
def test_after_a_list_it_is_the_thing_told(text: str, words: list[str], place: str | None) -> None:
    last = parse(LISTED, now=NOW)
    found = follow(text, now=NOW, words=WORDS, last=last, seen=TOLD)
    assert [term.word for term in found.objects] == words
    assert found.place == place
    of_it = found.objects[0] == TOLD.thing
    assert is_of_the_listed(found, last, TOLD, text) == of_it


@pytest.mark.parametrize("asked", ["what moved today", "what is missing"])
def test_before_that_is_before_the_thing_told_had_moved(asked: str) -> None:
    last = parse(asked, now=NOW)
    found = follow("where was it before?", now=NOW, words=WORDS, last=last, seen=TOLD)
    assert (found.ask, found.objects) == ("where", (TOLD.thing,))
    assert found.time == TimeSlice(None, TOLD.start)
    assert is_of_the_listed(found, last, TOLD, "where was it before?")


def test_all_of_a_list_is_not_asked_for_somewhere_else() -> None:
    with pytest.raises(NotUnderstood, match="which of them"):
        follow(
            "were they in the hall?", now=NOW, words=WORDS, last=parse(LISTED, now=NOW), seen=TOLD
        )


def test_what_names_the_thing_told_goes_on_about_no_single_one() -> None:
    last, text = parse(LISTED, now=NOW), "did you see a cup yesterday?"
    found = follow(text, now=NOW, words=WORDS, last=last, seen=TOLD)
    assert found.objects == (TOLD.thing,)
    assert not is_of_the_listed(found, last, TOLD, text)


def test_it_stays_what_a_list_was_asked_around_by_it() -> None:
    cup = parse("where is the blue cup?", now=NOW, words=WORDS)
    around = follow("what is next to it?", now=NOW, words=WORDS, last=cup)
    seen = Seen(NOW, NOW, ObjectTerm("bed", "bed"))
    query = follow("how often did you see it?", now=NOW, words=WORDS, last=around, seen=seen)
    assert [(term.word, term.attributes) for term in query.objects] == [("cup", ("blue",))]
    named = parse("what is next to the blue cup?", now=NOW, words=WORDS)
    query = follow("how often did you see it?", now=NOW, words=WORDS, last=named, seen=seen)
    assert [term.word for term in query.objects] == ["bed"]
