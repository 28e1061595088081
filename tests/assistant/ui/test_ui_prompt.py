"""Suggestions and history of the question line."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest

from assistant.history import KEPT, History
from assistant.suggesting import completion

EARLIER = ("where is the cup?", "Where are my keys?")
WORDS = ("glasses", "dining table", "table", "keys")


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("where a", "where are my keys?"),
        ("where", "where are my keys?"),  # the newest question that fits
        ("where is the c", "where is the cup?"),
        ("did I leave my gl", "did I leave my glasses"),
        ("what is on the dining t", "what is on the dining table"),
        ("what is on the t", None),  # one letter fits too much
        ("what is on the TA", "what is on the TAble"),
        ("Where are my keys?", None),
        ("", None),
        ("   ", None),
    ],
)
def test_completion(typed: str, completed: str | None) -> None:
    assert completion(typed, EARLIER, WORDS) == completed


def test_history_comes_back_and_is_private(tmp_path: Path) -> None:
    path = tmp_path / "history.jsonl"
    first = History(path)
    for question in ("a?", "b\nc?", "a?"):
        first.add(question)
    assert History(path).questions == ("b\nc?", "a?")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    first.wipe()
    assert not path.exists()
    assert History(path).questions == ()


def test_history_survives_a_cut_line_and_stays_small(tmp_path: Path) -> None:
    path = tmp_path / "history.jsonl"
    path.write_text("".join(f'"{i}?"\n' for i in range(3 * KEPT)) + '"cut sh')
    history = History(path)
    assert len(history.questions) == KEPT
    assert history.questions[-1] == f"{3 * KEPT - 1}?"
    assert len(path.read_text().splitlines()) == KEPT


def test_history_that_cannot_be_kept_says_so(tmp_path: Path) -> None:
    history = History(tmp_path)  # a folder
    assert history.problem is not None
    history.add("a?")
    assert history.questions == ("a?",)
