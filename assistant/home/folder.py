"""Where the demo home's recording lies."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path


def recording_folder() -> Path:
    """Return the shipped recording's folder, of the form `recording`, to be read only."""
    return Path(str(files("assistant.home"))) / "recording"
