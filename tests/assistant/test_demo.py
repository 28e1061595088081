"""The demo: filled once, answered from a pipe, and honest about it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from assistant import demo
from assistant.cli import clock
from assistant.config import Settings
from assistant.session import Session
from d3a.store import open_store
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

COMMAND = [sys.executable, "-c", "from assistant.cli import main; main(prog_name='d3a')"]


def run(*args: str, home: Path, given: str = "") -> subprocess.CompletedProcess[str]:
    environment: Mapping[str, str] = {
        **{name: value for name, value in os.environ.items() if not name.startswith("D3A_")},
        **{f"XDG_{name}_HOME": str(home / name) for name in ("CACHE", "CONFIG", "DATA", "STATE")},
    }
    return subprocess.run(
        [*COMMAND, *args],
        env=environment,
        input=given,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="module")
def first(home: Path) -> subprocess.CompletedProcess[str]:
    return run("demo", home=home)


def test_without_a_terminal_it_asks_five_questions_and_leaves(
    first: subprocess.CompletedProcess[str],
) -> None:
    assert first.returncode == 0, first.stderr
    blocks = first.stdout.strip().split("\n\nYou: ")
    assert len(blocks) == len(demo.TOUR) == 5
    keys, together, handbag, morning, umbrella = blocks
    assert keys.startswith("You: Where are my keys?\n")
    assert "living room" in keys.splitlines()[1]
    assert "1  key" in keys
    assert "cup with the bowl" in together
    assert "yesterday" in handbag
    assert "today" in morning  # understood after the question about the handbag
    assert "handbag" in morning
    assert "never saw an umbrella" in umbrella
    assert "Filling the demo home's memory, once" in first.stderr
    assert "--plain" in first.stderr  # a pipe's questions are not heard without it


def test_the_second_time_nothing_is_filled(
    home: Path, first: subprocess.CompletedProcess[str]
) -> None:
    [store] = (home / "CACHE" / "d3a").iterdir()
    before = store.stat().st_mtime_ns
    again = run("demo", "--tour", home=home)
    assert again.stdout == first.stdout
    assert again.stderr == ""
    assert store.stat().st_mtime_ns == before
    assert store.stat().st_mode & 0o077 == 0  # a home's pictures are their owner's


def test_the_chat_of_the_demo_can_be_held_through_a_pipe(
    home: Path, first: subprocess.CompletedProcess[str]
) -> None:
    said = run("demo", "--plain", home=home, given="where are my keys\nwhy\nquit\n")
    assert said.returncode == 0
    assert said.stdout.startswith("You: where are my keys\nAnswer: ")
    assert "\nplan\n  1. find objects x" in said.stdout
    assert "native queries" not in said.stdout  # it is read aloud; `d3a explain` has them


def test_an_interrupted_filling_leaves_no_store(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("d3a.ingest.ingest", interrupted)
    settings = Settings(clock=clock, quiet=True)
    with pytest.raises(KeyboardInterrupt):
        demo.demo_store(settings, lambda _: None)
    [draft] = (tmp_path / "d3a").glob("*.draft")
    draft.rename(draft.with_name("demo-0-999999999.draft"))  # of a program that is gone
    running = tmp_path / "d3a" / f"demo-0-{os.getppid()}.draft"
    running.write_text("")
    assert not list((tmp_path / "d3a").glob("demo-*.db"))
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    uri = demo.demo_store(settings, lambda _: None)
    store = open_store(uri, create=False)
    assert store.counts()["objects"] > 20
    assert store.check() == []
    store.close()
    assert list((tmp_path / "d3a").glob("*.draft*")) == [running]


def test_the_tour_shows_a_few_rows_of_each_answer() -> None:
    store = OracleStore()
    small_home.fill(store)
    session: Session = small_home.session(store)
    lines = list(demo.tour_lines(session))
    assert sum(line.startswith("You: ") for line in lines) == 5
    assert max(line.count("\n") for line in lines) <= demo.TOUR_ROWS + 4
