"""Choose the reader of a recording by looking at it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from d3a.model import BadInput
from d3a.readers import kuri, posed, recording
from d3a.readers.base import Reader


@dataclass(frozen=True, slots=True)
class Format:
    """A kind of recording: how to know it, and what reads it."""

    looks_like: Callable[[Path], bool]
    reader: Callable[[Path, str | None], Reader]
    looked_for: str


FORMATS: dict[str, Format] = {
    "recording": Format(
        recording.looks_like,
        lambda folder, zone: recording.RecordingReader(folder, zone=zone),
        recording.RecordingReader.looked_for,
    ),
    "kuri": Format(
        kuri.looks_like,
        lambda folder, zone: kuri.KuriReader(folder, zone=zone),
        kuri.KuriReader.looked_for,
    ),
    "posed": Format(
        posed.looks_like,
        lambda folder, zone: posed.PosedReader(folder, zone=zone),
        posed.PosedReader.looked_for,
    ),
}


def open_source(path: Path, *, format: str | None = None, zone: str | None = None) -> Reader:  # noqa: A002
    """Return the reader of the recording at `path`.

    format: a name in FORMATS, None to look. zone: an IANA name that replaces the recording's own.
    Raises BadInput for a path that is no folder, a format that is not known, a folder that is none
    of the known kinds (the message lists what was looked for), and an unknown zone.
    """
    if format is not None and format not in FORMATS:
        raise BadInput(f"unknown format {format!r}; there are {', '.join(FORMATS)}")
    if not path.is_dir():
        found = "is not a folder" if path.exists() else "does not exist"
        raise BadInput(f"{path} {found}; a recording is a folder with {_looked_for(format)}")
    for name, kind in FORMATS.items():
        if format in (None, name) and kind.looks_like(path):
            return kind.reader(path, zone)
    raise BadInput(f"{path} is no recording that can be read; looked for {_looked_for(format)}")


def _looked_for(format_name: str | None) -> str:
    kinds = FORMATS if format_name is None else {format_name: FORMATS[format_name]}
    return "; or ".join(f"{kind.looked_for} ({name})" for name, kind in kinds.items())
