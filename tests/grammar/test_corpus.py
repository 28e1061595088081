"""The corpus: one meaning, many sayings, none twice; adding a saying is adding a line."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from grammar import QuestionError, StoreWords, parse
from grammar.forms import VARIABLES, Json

CORPUS = Path(__file__).parents[1] / "corpus"
UNSAID: Json = {
    "objects": [],
    "relation": None,
    "place": None,
    "time": None,
    "select": "all",
    "negated": False,
}
UNSAID_OF_OBJECT: Json = {
    "attributes": [],
    "without": [],
    "owner": None,
    "quantity": None,
    "where": None,
}


def meanings() -> Iterator[tuple[str, datetime, Json, list[str]]]:
    """Yield (file, now, want, sayings) of every meaning."""
    for path in sorted(CORPUS.glob("*.toml")):
        record = tomllib.loads(path.read_text(encoding="utf-8"))
        if "now" not in record:  # sayings of the chat, judged with it
            continue
        for meaning in record.get("meaning", ()):
            now = datetime.fromisoformat(record["now"])
            yield path.stem, now, meaning["want"], meaning["says"]


def sayings() -> Iterator[Any]:
    """Yield a test case for each saying, its text the id."""
    for _, now, want, says in meanings():
        for said in says:
            yield pytest.param(said, now, want, id=said)


def whole(term: Json, var: str) -> Json:
    """Complete an object of a want with what goes without saying."""
    record = {"word": term["category"], **UNSAID_OF_OBJECT, **term, "var": var}
    if record["where"] is not None:
        record["where"] = {
            **record["where"],
            "object": whole(record["where"]["object"], "x"),
        }
    others = {name: record[name] for name in ("or_else", "other_than") if name in record}
    record |= {name: [whole(other, "x") for other in said] for name, said in others.items()}
    return record


def completed(want: Json) -> Json:
    """Complete a want: every field that the formal query has."""
    record = {**UNSAID, **want}
    record["objects"] = [whole(t, VARIABLES[i]) for i, t in enumerate(record["objects"])]
    if record["time"] is not None:
        record["time"] = {"start": None, "end": None, **record["time"]}
    return record


@pytest.mark.parametrize(("said", "now", "want"), list(sayings()))
def test_saying_has_its_meaning(said: str, now: datetime, want: Json) -> None:
    got = parse(said, now=now).to_json()
    del got["formal"]
    got.pop("now", None)  # a meaning has sayings of several tenses; they are test_tense's
    got.pop("corrections", None)  # what spelling was made good is test_spelling's
    assert got == {"text": said, **completed(want)}


def test_no_saying_stands_twice() -> None:
    counts = Counter(said.lower() for _, _, _, says in meanings() for said in says)
    assert [said for said, count in counts.items() if count > 1] == []


def test_each_meaning_has_eight_sayings_and_there_are_sixty() -> None:
    found = list(meanings())
    assert len(found) >= 60
    assert [want for _, _, want, says in found if len(says) < 8] == []


def refusals() -> Iterator[Any]:
    """Yield a test case for each text that must be refused."""
    for path in sorted(CORPUS.glob("*.toml")):
        record = tomllib.loads(path.read_text(encoding="utf-8"))
        for refusal in record.get("refusal", ()):
            now = datetime.fromisoformat(record["now"])
            for said in refusal["says"]:
                yield pytest.param(said, now, refusal["error"], id=said or "nothing")


@pytest.mark.parametrize(("said", "now", "kind"), list(refusals()))
def test_refused_with_its_error(said: str, now: datetime, kind: str) -> None:
    with pytest.raises(QuestionError) as caught:
        parse(said, now=now)
    error = caught.value
    assert error.kind == kind
    assert 0 <= error.position <= len(said)
    assert error.reason
    assert len(error.suggestions) <= 3
    for suggestion in error.suggestions:
        assert parse(suggestion, now=now)


@pytest.mark.parametrize(("said", "now", "kind"), list(refusals()))
def test_suggestions_share_a_word_with_the_question(said: str, now: datetime, kind: str) -> None:
    with pytest.raises(QuestionError) as caught:
        parse(said, now=now)
    words = {word.strip("?.,!").lower() for word in said.split()}
    for suggestion in caught.value.suggestions:
        assert words & {word.strip("?.,").lower() for word in suggestion.split()} - {"the"}


def test_a_store_hands_its_words_in() -> None:
    now = datetime.fromisoformat("2020-01-01T18:00:00-05:00")
    words = StoreWords(categories=("zibble",), names=(("floof", "anna"),), places=("snug",))
    found = parse("zibble in the snug?", now=now, words=words)
    assert (found.objects[0].category, found.place) == ("zibble", "snug")
    assert parse("floof?", now=now, words=words).objects[0].category == "floof"
    assert parse("where is the zibbel", now=now, words=words).objects[0].category == "zibble"
    with pytest.raises(QuestionError):
        parse("zibble?", now=now)
