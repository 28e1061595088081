"""Manners that every command has: schema numbers, masked passwords, plain terminals, statuses."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from assistant.cli import COMMANDS, main
from d3a.store import open_store
from tests.worlds import small_home, terminals

ROOT = Path(__file__).parents[2]
WITHOUT_JSON = {"chat", "completion"}
"""A conversation, and a shell's program."""
OF_ANOTHER_CONTRACT = {"parse"}
"""The formal query has no number: its contract does not name one."""


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in list(os.environ):
        if name.startswith("D3A_"):
            monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("D3A_STORE", "memory.db")
    monkeypatch.chdir(tmp_path)
    store = open_store("memory.db")
    small_home.fill(store)
    store.close()
    (tmp_path / "questions").write_text("where is the cup\nwhy\n")
    return tmp_path


def run(*args: str) -> Result:
    return CliRunner().invoke(main, list(args))


WRITTEN = (
    ("ask --json where are my keys", 0),
    ("ask --json zzz qqq", 5),
    ("ask --json where is my wallet", 1),
    ("ask --json where is the cup --store none.db", 3),
    ("batch questions", 0),
    ("explain --json where are my keys", 0),
    ("explain --json zzz qqq", 5),
    ("objects --json", 0),
    ("config show --json", 0),
    ("config path --json", 0),
    ("doctor --json", 0),
    ("teach keys-1 Excalibur --json", 0),
    ("teach none-1 Excalibur --json", 1),
    ("merge keys-1 couch-1 --json", 0),
    ("split keys-1 1 --json", 0),
    ("split keys-1 0 --from 2020-02-25T09:30 --json", 2),
    ("undo --list --json", 0),
    ("undo --json", 0),
    ("place add den --around 1,1 --json", 0),
    ("place list --json", 0),
    ("place rename den study --json", 0),
    ("place remove study --json", 0),
    ("store info --json", 0),
    ("store check --json", 0),
    ("store copy memory.db copied.db --json", 0),
    ("export out --format csv --json", 0),
    ("forget bowl --dry-run --json", 0),
    ("forget bowl --yes --json", 0),
    ("demo --tour --json", 0),
    ("simulate simulated --hours 0.05", 0),
    ("evaluate exp4 --world simulated --json --quiet", 0),
    ("evaluate exp4 --world . --json --quiet", 2),
    ("ingest simulated --json --store new.db", 0),
    ("watch simulated --json --until-idle 0.2 --store watched.db", 0),
)


def test_each_record_has_a_schema_number_and_its_status() -> None:
    seen = set()
    for line, status in WRITTEN:
        result = run(*line.split(" "))
        assert result.exit_code == status, (line, result.output)
        records = [json.loads(each) for each in result.stdout.splitlines()]
        assert records, line
        for record in records:
            assert record["schema"] == 1, line
        seen.add(line.split(" ")[0])
    assert seen | WITHOUT_JSON | OF_ANOTHER_CONTRACT == set(COMMANDS)


SECRET = "s3cr3t-pässwörd"
URIS = (
    f"mongodb://robot:{SECRET}@127.0.0.1:1/home?serverSelectionTimeoutMS=50",
    f"mongodb://robot:{SECRET}@127.0.0.1:port/home",
    f"mongodb://robot:{SECRET}",
    f"mongodb+srv://robot:{SECRET}@none.invalid/home",
    f"ftp://robot:{SECRET}@host/home",
    f"sqlite://robot:{SECRET}@host/home",
)
ASKED = (
    "ask where is the cup",
    "ask --json where is the cup",
    "batch questions",
    "explain where is the cup",
    "parse where is the cup --store {uri}",
    "objects",
    "objects --json",
    "config show",
    "config show --json",
    "doctor",
    "doctor --json",
    "chat --plain",
    "teach keys-1 Excalibur",
    "teach keys-1 Excalibur --json",
    "merge keys-1 couch-1",
    "split keys-1 1",
    "undo",
    "undo --list",
    "place list",
    "store info",
    "store check",
    "store copy memory.db {uri}",
    "store copy {uri} new.db",
    "export out --format csv",
    "forget bowl --yes",
    "forget bowl --dry-run --json",
    "ingest none",
)


@pytest.mark.parametrize("uri", URIS)
def test_a_password_is_never_printed(uri: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("D3A_STORE", uri)
    for line in ASKED:
        result = run(*(word.replace("{uri}", uri) for word in line.split(" ")))
        said = result.output + repr(result.exception)
        for part in (SECRET, SECRET[:6], "p%C3%A4ssw"):
            assert part not in said, (line, said)
        assert result.exception is None or isinstance(result.exception, SystemExit), line


def started(args: Sequence[str], said: str = "", **environment: str) -> tuple[int, bytes, bytes]:
    done = subprocess.run(
        [sys.executable, "-m", "assistant.cli", *args],
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        input=said.encode(),
        capture_output=True,
        timeout=60,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8", "utf-16"])
def test_any_encoding_gets_an_answer(encoding: str) -> None:
    status, out, _ = started(["ask", "where are my keys"], PYTHONIOENCODING=encoding)
    assert status == 0
    assert "kitchen" in out.decode(encoding)
    status, out, _ = started(["ask", "--json", "where are my keys"], PYTHONIOENCODING=encoding)
    assert json.loads(out.decode(encoding))["status"] == "found"


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_any_encoding_gets_a_chat_a_line_at_a_time(encoding: str) -> None:
    status, out, err = started(["chat"], "where are my keys\n", PYTHONIOENCODING=encoding)
    assert status == 0
    assert "kitchen" in out.decode(encoding)
    assert b"\x1b" not in out + err


def in_a_terminal(args: Sequence[str], typed: bytes, **environment: str) -> bytes:
    """Run in a pseudo-terminal that types and then ends the input; return what it showed."""
    command = [sys.executable, "-m", "assistant.cli", *args]
    given = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    with terminals.opened(command, given) as terminal:
        terminal.type(typed + b"\x04")
        shown = terminal.read_all()
        assert terminal.process.wait(30) in (0, 2)
    return shown


@pytest.mark.parametrize(
    ("environment", "why"),
    [
        ({"TERM": "dumb"}, b"the terminal is dumb"),
        ({"TERM": ""}, b"the terminal is not named"),
        ({"TERM": "xterm", "PYTHONIOENCODING": "latin-1"}, b"takes iso8859-1"),
    ],
)
def test_a_terminal_that_cannot_show_it_gets_lines(environment: dict[str, str], why: bytes) -> None:
    shown = in_a_terminal(["chat"], b"where are my keys\nquit\n", **environment)
    assert why in shown
    assert b"kitchen" in shown
    assert b"\x1b" not in shown


def test_no_color_means_none() -> None:
    coloured = in_a_terminal(["--color", "always", "ask", "where are my keys"], b"", TERM="xterm")
    plain = in_a_terminal(["ask", "where are my keys"], b"", TERM="xterm", NO_COLOR="1")
    assert b"kitchen" in plain
    assert b"\x1b[3" not in plain
    assert b"kitchen" in coloured


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError(28, "No space left on device"), "d3a: No space left on device\n"),
        (OSError(30, "Read-only", "a\x1b\nb"), "d3a: a b: Read-only\n"),
        (OSError("odd"), "d3a: odd\n"),
    ],
)
def test_a_disk_that_fails_anywhere_is_a_sentence(
    error: OSError, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("d3a.store.open_store", fail)
    result = CliRunner().invoke(main, ["ask", "where is the cup"])
    assert (result.exit_code, result.stderr) == (2, said)
