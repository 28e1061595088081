"""What tests of the command line share: an environment of their own."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from assistant.cli import main

HOMES = ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME")


@pytest.fixture
def own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with empty settings and a home of its own."""
    for name in list(os.environ):
        if name.startswith("D3A_") and name != "D3A_SHARED":
            monkeypatch.delenv(name)
    for name in HOMES:
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(own_settings: Path) -> Callable[..., Result]:
    """Run `d3a` in an empty folder: `run("ask", "where is the cup")`."""
    return lambda *args, **options: CliRunner().invoke(main, list(args), **options)
