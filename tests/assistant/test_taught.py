"""What people say to teach, as a corpus; and what must stay a question."""

from __future__ import annotations

import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assistant.taught import read_teaching, row_of

CORPUS: dict[str, Any] = tomllib.loads(
    (Path(__file__).parents[1] / "corpus" / "teachings.toml").read_text(encoding="utf-8")
)
NO_ROW = {"row": "this", "other": "this", "new": "none"}


@pytest.mark.parametrize(
    ("said", "want"),
    [(said, meaning["want"]) for meaning in CORPUS["meaning"] for said in meaning["says"]],
)
def test_a_saying_teaches_what_it_says(said: str, want: dict[str, Any]) -> None:
    taught = read_teaching(said)
    assert taught is not None
    got = {"kind": type(taught).__name__} | asdict(taught)
    for name, value in want.items():
        wanted = tuple(value) if isinstance(value, list) else value
        assert got[name] == (None if NO_ROW.get(name) == value else wanted)


def test_no_saying_stands_there_twice() -> None:
    says = [said for meaning in CORPUS["meaning"] for said in meaning["says"]]
    assert len(says) == len(set(says)) >= 80


@pytest.mark.parametrize("said", CORPUS["none"]["says"])
def test_what_asks_teaches_nothing(said: str) -> None:
    assert read_teaching(said) is None


@pytest.mark.parametrize(
    ("said", "row"),
    [("number 12", 12), ("the 3rd one", 3), ("the last one", -1), ("this one", None), ("it", None)],
)
def test_rows_are_numbered_from_one(said: str, row: int | None) -> None:
    assert row_of(said) == row


WORDS = (
    "these are my keys call this place the same as number 2 not anna's undo that is and one second "
    "forget ' it"
)


@given(st.lists(st.sampled_from(WORDS.split()), max_size=9), st.text(max_size=30))
def test_any_text_is_read_or_left(words: list[str], other: str) -> None:
    for text in (" ".join(words), other):
        read_teaching(text)
        assert read_teaching(text + "?") is None
