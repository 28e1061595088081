"""Whole conversations with the demo home, through the session that the chat uses."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Iterator
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from assistant.cli import clock
from assistant.commands.chat import session_of
from assistant.config import Settings
from assistant.home.folder import recording_folder
from assistant.pointing import shown
from assistant.session import Session
from d3a.answer import Answer
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store import open_store
from d3a.store.base import Batch

CORPUS: dict[str, Any] = tomllib.loads(
    (Path(__file__).parents[1] / "corpus" / "conversations.toml").read_text(encoding="utf-8")
)
CONVERSATIONS: list[dict[str, Any]] = CORPUS["conversation"]
KNOWN = {"say", "status", "place", "kind", "says", "unsaid", "rows", "thing", "offers", "at"}


@pytest.fixture(scope="session")
def filled_home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The demo home's store, to be copied for each conversation."""
    path = tmp_path_factory.mktemp("conversations") / "home.db"
    with closing(open_store(str(path))) as store:
        ingest(open_source(recording_folder()), store, DEFAULT)
    return path


@contextmanager
def talking(filled: Path, folder: Path) -> Iterator[Session]:
    """Yield a session over a copy of the home, as `d3a demo` makes it."""
    path = folder / "home.db"
    shutil.copy(filled, path)
    with closing(open_store(str(path), create=False)) as store:
        yield session_of(Settings(clock=clock), store, title="the demo home")


def test_a_chat_whose_clock_is_behind_tells_what_is_newest(
    filled_home: Path, tmp_path: Path
) -> None:
    path = tmp_path / "home.db"
    shutil.copy(filled_home, path)
    with closing(open_store(str(path), create=False)) as store:
        store.apply(Batch(meta={"now": None}))
        newest = store.last_view_ms()
        assert newest is not None
        late = datetime.fromtimestamp(newest / 1000 - 36 * 3600, tz=UTC)
        behind = session_of(Settings(clock=lambda: late), store).ask("Where are my keys?")
        fixed = session_of(Settings(clock=clock, now=late.isoformat()), store)
        then = fixed.ask("Where are my keys?")
    assert behind.keyframes[0].end > late >= then.keyframes[0].end


def judge(turn: dict[str, Any], answer: Answer, session: Session, things: dict[str, str]) -> None:
    rows = shown(answer)
    at = session.pointer.row
    best = at if at in rows else next(iter(rows), None)
    assert answer.status == turn.get("status", "found"), answer.answer
    for part in turn.get("says", ()):
        assert part in answer.answer
    for part in turn.get("unsaid", ()):
        assert part not in answer.answer
    if "place" in turn:
        assert best is not None
        assert best.place == turn["place"], answer.answer
    if "kind" in turn:
        assert best is not None
        assert best.category == turn["kind"], answer.answer
    if "rows" in turn:
        ids = {row.object_id for row in rows}
        said = ("none", "1", "many")[min(len(ids), 2)]
        assert said == turn["rows"], rows
    if "thing" in turn:
        assert best is not None
        known = things.setdefault(turn["thing"], best.object_id)
        assert known == best.object_id, answer.answer
        assert len(set(things.values())) == len(things), things
    if "offers" in turn:
        assert len(answer.suggestions) == turn["offers"], answer.suggestions
    if "at" in turn:
        assert session.pointer.row is not None
        assert session.pointer.row.rank == turn["at"]


@pytest.mark.parametrize("conversation", CONVERSATIONS, ids=lambda each: each["title"])
def test_conversation(conversation: dict[str, Any], filled_home: Path, tmp_path: Path) -> None:
    things: dict[str, str] = {}
    with talking(filled_home, tmp_path) as session:
        for turn in conversation["turns"]:
            judge(turn, session.safely(turn["say"]), session, things)


def test_there_are_thirty_of_three_turns_and_each_turn_is_judged() -> None:
    assert len(CONVERSATIONS) >= 30
    titles = [each["title"] for each in CONVERSATIONS]
    assert len(set(titles)) == len(titles)
    for conversation in CONVERSATIONS:
        assert len(conversation["turns"]) >= 3
        for turn in conversation["turns"]:
            assert len(turn) >= 2, turn
            assert turn.keys() <= KNOWN, turn
    said = [turn["say"] for each in CONVERSATIONS for turn in each["turns"]]
    assert sum("undo" in each for each in said) >= 10
