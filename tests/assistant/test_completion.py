"""Tab in a shell: commands, options, and the words of an embedded store."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from assistant.cli import COMMANDS, main
from assistant.commands.completion import SHELLS
from d3a.store import open_store
from tests.worlds import small_home

ROOT = Path(__file__).parents[2]


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    for name in list(os.environ):
        if name.startswith("D3A_"):
            monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    path = str(tmp_path / "memory.db")
    opened = open_store(path)
    small_home.fill(opened)
    opened.close()
    return path


def completed(line: str, word: str = "", *, shell: str = "bash") -> list[str]:
    """Return what Tab offers after `line`, `word` being typed."""
    words = line.split(" ")
    environment = {
        "_D3A_COMPLETE": f"{shell}_complete",
        "COMP_WORDS": " ".join([*words, word]),
        "COMP_CWORD": str(len(words)),
    }
    result = CliRunner().invoke(main, [], env=environment, prog_name="d3a")
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    return [entry.partition(",")[2] for entry in result.stdout.splitlines() if entry]


def test_commands_and_options_are_completed(store: str) -> None:
    assert completed("d3a", "e") == ["evaluate", "explain", "export"]
    assert set(completed("d3a")) == set(COMMANDS)
    assert "--store" in completed("d3a ask", "--s")
    assert completed("d3a completion", "z") == ["zsh"]
    assert completed("d3a export --format", "c") == ["coco", "csv"]


@pytest.mark.parametrize(
    ("line", "word", "offered"),
    [
        ("teach", "", ["bowl-1", "couch-1", "cup-1", "keys-1"]),
        ("merge bowl-1", "c", ["couch-1", "cup-1"]),
        ("split", "k", ["keys-1"]),
        ("objects --category", "", ["bowl", "couch", "cup", "keys"]),
        ("forget", "c", ["couch", "couch-1", "cup", "cup-1"]),
        ("forget --place", "K", ["kitchen"]),
        ("export --what", "bo", ["bowl", "bowl-1"]),
        ("place remove", "", ["hall", "kitchen", "lab"]),
        ("place rename", "h", ["hall"]),
    ],
)
def test_the_words_of_the_store_are_completed(
    store: str, line: str, word: str, offered: list[str]
) -> None:
    assert completed(f"d3a --store {store} {line}", word) == offered
    command, *rest = line.split(" ", 1)
    if command != "place":
        after = " ".join([command, "--store", store, *rest])
        assert completed(f"d3a {after}", word) == offered


@pytest.mark.parametrize(
    "uri", ["mongodb://robot:s3cret@192.0.2.1/home", "none.db", "text.db", "ftp://x"]
)
def test_a_store_that_is_not_at_hand_completes_nothing_and_says_nothing(
    store: str, uri: str
) -> None:
    Path("text.db").write_text("Dear diary. " * 100)
    assert completed(f"d3a teach --store {uri}") == []
    assert not Path("none.db").exists()


def test_a_broken_settings_file_completes_no_words_but_commands(store: str) -> None:
    Path("d3a.toml").write_text("stor = 1")
    assert completed(f"d3a teach --store {store}") == []
    assert "teach" in completed("d3a", "t")


@pytest.mark.parametrize("shell", SHELLS)
def test_each_shell_gets_its_lines(store: str, shell: str) -> None:
    result = CliRunner().invoke(main, ["completion", shell])
    assert result.exit_code == 0
    assert f"_D3A_COMPLETE={shell}_complete" in result.stdout
    if shutil.which(shell) is not None:  # the shell itself takes them for a program
        subprocess.run([shell, "-n"], input=result.stdout, text=True, check=True)


def test_bash_itself_completes_an_id(store: str, tmp_path: Path) -> None:
    if shutil.which("bash") is None:
        pytest.skip("bash is not installed")
    program = tmp_path / "d3a"
    program.write_text(
        f"#!/bin/sh\nPYTHONPATH='{ROOT}' exec '{sys.executable}' "
        f'-c \'from assistant.cli import main; main(prog_name="d3a")\' "$@"\n'
    )
    program.chmod(0o755)
    script = (
        'eval "$(d3a completion bash)"\n'
        "COMP_WORDS=(d3a teach k) COMP_CWORD=2\n"
        'complete -p d3a >&2\n_d3a_completion d3a k teach\necho "${COMPREPLY[@]}"\n'
    )
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", script],
        env={**os.environ, "PATH": path, "D3A_STORE": store},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "keys-1", done.stderr
