"""Choose the reader of a recording by looking at it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from d3a.model import BadInput
from d3a.readers import (
    coco,
    csv_table,
    kuri,
    pictures,
    posed,
    recording,
    rosbag,
    tum,
    video,
)
from d3a.readers.base import Reader
from d3a.readers.options import Options
from d3a.readers.parsing import did_you_mean


@dataclass(frozen=True, slots=True)
class Format:
    """A kind of recording: how to know it, what reads it, and which options that takes.

    looks_like: cheap; of those that say yes the first in FORMATS reads. options: name -> what it
    is, besides those of every reader; a name that ends in a dot takes any key after it. may_be:
    what is asked instead of looks_like where a person names the format.
    """

    looks_like: Callable[[Path], bool]
    reader: Callable[[Path, Options], Reader]
    looked_for: str
    options: Mapping[str, str] = field(default_factory=dict)
    may_be: Callable[[Path], bool] | None = None


FORMATS: dict[str, Format] = {
    "recording": Format(
        recording.looks_like,
        lambda source, options: recording.RecordingReader(source, zone=options.zone),
        recording.RecordingReader.looked_for,
    ),
    "kuri": Format(
        kuri.looks_like,
        lambda source, options: kuri.KuriReader(source, zone=options.zone),
        kuri.KuriReader.looked_for,
    ),
    "posed": Format(
        posed.looks_like,
        lambda source, options: posed.PosedReader(source, zone=options.zone),
        posed.PosedReader.looked_for,
    ),
    "tum": Format(tum.looks_like, tum.TumReader, tum.TumReader.looked_for, tum.OPTIONS),
    "coco": Format(coco.looks_like, coco.CocoReader, coco.CocoReader.looked_for, coco.OPTIONS),
    "rosbag": Format(
        rosbag.looks_like, rosbag.RosbagReader, rosbag.RosbagReader.looked_for, rosbag.OPTIONS
    ),
    "video": Format(
        video.looks_like, video.VideoReader, video.VideoReader.looked_for, video.OPTIONS
    ),
    "csv": Format(
        csv_table.looks_like,
        csv_table.CsvReader,
        csv_table.CsvReader.looked_for,
        csv_table.OPTIONS,
        lambda source: csv_table.table_of(source).is_file(),
    ),
    "pictures": Format(
        pictures.looks_like,
        pictures.PicturesReader,
        pictures.PicturesReader.looked_for,
        pictures.OPTIONS,
    ),
}


def open_source(
    path: Path,
    *,
    format: str | None = None,  # noqa: A002
    zone: str | None = None,
    options: Mapping[str, str] | None = None,
) -> Reader:
    """Return the reader of the recording at `path`, a folder or a file.

    format: a name in FORMATS, None to look. zone: an IANA name that replaces the recording's own.
    options: what the person tells the reader, by name. Raises BadInput for a path that is not
    there, a format or an option that is not known, a source that is none of the known kinds (the
    message lists what was looked for), and an unknown zone.
    """
    name = format_of(path, format)
    kind = FORMATS[name]
    chosen = Options(path, options, known=kind.options, zone=zone, reader=f"the reader of {name!r}")
    reader = kind.reader(path, chosen)
    reader.facts = chosen.named(reader.facts)
    return reader


def format_of(path: Path, format: str | None = None) -> str:  # noqa: A002
    """Return the name in FORMATS of what is at `path`; BadInput as `open_source`."""
    if format is not None and format not in FORMATS:
        hint = did_you_mean(format, FORMATS)
        raise BadInput(f"unknown format {format!r}; there are {', '.join(FORMATS)}.{hint}")
    if "\0" in str(path) or not path.exists():
        raise BadInput(f"{path} does not exist")
    if format is not None:
        if (FORMATS[format].may_be or FORMATS[format].looks_like)(path):
            return format
        raise BadInput(f"{path} has not what {format!r} looks for: {_looked_for(format)}")
    for name, kind in FORMATS.items():
        if kind.looks_like(path):
            return name
    raise BadInput(f"{path} is no recording that can be read; looked for {_looked_for(format)}")


def _looked_for(format_name: str | None) -> str:
    kinds = FORMATS if format_name is None else {format_name: FORMATS[format_name]}
    return "; or ".join(f"{kind.looked_for} ({name})" for name, kind in kinds.items())
