"""The `d3a` command with nothing of this machine's settings, over the fixed home."""

from __future__ import annotations

import os
import sys
from contextlib import closing
from pathlib import Path

from d3a.store import open_store
from tests.worlds import small_home

ROOT = Path(__file__).parents[2]


def bare(folder: Path, *, term: str = "xterm-256color") -> tuple[list[str], dict[str, str]]:
    """Return what runs `d3a` and nothing else, and its environment; the store is made for it."""
    with closing(open_store(str(folder / "home.db"))) as store:
        small_home.fill(store)
    kept = {name: os.environ[name] for name in ("PATH", "SYSTEMROOT") if name in os.environ}
    environment = kept | {
        "HOME": str(folder),
        "LANG": "C.UTF-8",
        "TERM": term,
        "PYTHONPATH": str(ROOT),
        "D3A_STORE": str(folder / "home.db"),
        "D3A_IMAGES": "cells",
    }
    return [sys.executable, "-m", "assistant.cli"], environment
