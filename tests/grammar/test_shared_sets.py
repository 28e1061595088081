"""The given question and time sets, judged by the rules that come with them, a test per id."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from grammar import QuestionError, parse
from grammar.forms import Json

FOLDER = os.environ.get("D3A_SHARED")
CLOCK = datetime(2026, 1, 1, 12, tzinfo=UTC)


def rows() -> Iterator[Any]:
    """Yield a test case for each line of the given sets; none without D3A_SHARED."""
    for name in ("questions-dev.jsonl", "times-dev.jsonl") if FOLDER else ():
        path = Path(FOLDER or "") / name
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                row = json.loads(line)
                yield pytest.param(row, id=row["id"])


def instant(value: Any) -> datetime | None:
    """Return a moment; the last second of a day is the next midnight."""
    if not isinstance(value, str):
        return None
    moment = datetime.fromisoformat(value)
    return moment + timedelta(seconds=1) if moment.second == 59 else moment


def same(want: Any, got: Any, field: str = "") -> bool:
    """Whether a want is met: only the given fields count, `any_of` admits several."""
    if isinstance(want, dict) and set(want) == {"any_of"}:
        return any(same(option, got, field) for option in want["any_of"])
    if field in ("attributes", "without"):
        return {w.replace("grey", "gray") for w in want} == {
            w.replace("grey", "gray") for w in got or ()
        }
    if field in ("start", "end"):
        return instant(want) == instant(got)
    if field == "objects":
        return len(want) == len(got or ()) and all(
            same(value, term.get(key), key)
            for term_want, term in zip(want, got, strict=True)
            for key, value in term_want.items()
        )
    if isinstance(want, dict):
        return isinstance(got, dict) and all(same(v, got.get(k), k) for k, v in want.items())
    return bool(want == got)


@pytest.mark.skipif(not FOLDER, reason="D3A_SHARED names no folder of question sets")
@pytest.mark.parametrize("row", list(rows()))
def test_given_question(row: Json) -> None:
    now = datetime.fromisoformat(row["now"]) if row["now"] else CLOCK
    try:
        got = parse(row["text"], now=now).to_json()
    except QuestionError as error:
        got = error.to_json()
    assert same(row["expect"], got)
