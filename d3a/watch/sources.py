"""Choose how a source is followed, by looking at it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from d3a.model import BadInput
from d3a.readers.base import Follower, Reader
from d3a.readers.opening import format_of, open_source
from d3a.readers.options import Options
from d3a.watch.folder import FolderFollower
from d3a.watch.patience import Patience
from d3a.watch.recording import RecordingFollower
from d3a.watch.rosbridge import OPTIONS, RosbridgeFollower, is_address

READ_ANEW = ("pictures", "tum", "csv")
"""Formats that a growing folder may have besides `recording`."""


def follow(
    source: str | Path,
    patience: Patience,
    *,
    format: str | None = None,  # noqa: A002
    zone: str | None = None,
    options: Mapping[str, str] | None = None,
    has_detector: bool = False,
    on_note: Callable[[str], None] = lambda _: None,
) -> Follower | None:
    """Return the reader that follows a growing recording; None where it was stopped before.

    A source ws://... is a robot's rosbridge. What is not there yet is waited for; on_note is told
    what is missing. Arguments as of `open_source`. has_detector: boxes in the folder are not
    waited for. Raises BadInput for what is no recording that can be followed, or did not become
    one while patience lasted.
    """
    if isinstance(source, str) and is_address(source):
        chosen = Options(Path(), options, known=OPTIONS, zone=zone, reader="a live robot")
        return RosbridgeFollower(source, patience, chosen, on_note)
    path = Path(source)
    told = False
    while not patience.should_stop():
        try:
            return _follower(path, patience, format, zone, dict(options or {}), has_detector)
        except _NotYet as error:
            if patience.is_over():
                raise BadInput(str(error)) from error
            if not told:
                on_note(f"waiting: {error}")
                told = True
            patience.pause()
    return None


class _NotYet(BadInput):
    """What is missing may still come."""


def _follower(
    source: Path,
    patience: Patience,
    format_name: str | None,
    zone: str | None,
    options: dict[str, str],
    has_detector: bool,
) -> Follower:
    try:
        kind = format_of(source, format_name)
    except BadInput as error:
        raise _NotYet(str(error)) from error
    if kind == "recording":
        chosen = Options(source, options, known={}, zone=zone, reader="the reader of 'recording'")
        return _recording(source, patience, chosen, needs_boxes=not has_detector)
    if kind not in READ_ANEW:
        followed = ", ".join(("recording", *READ_ANEW))
        raise BadInput(
            f"{source} is of the format {kind!r}, which cannot be followed while it grows; these "
            f"can: {followed}. `d3a ingest` takes it in as it is"
        )

    def opened() -> Reader:
        return open_source(source, format=kind, zone=zone, options=options)

    try:
        return FolderFollower(source, opened, patience)
    except BadInput as error:
        raise _NotYet(str(error)) from error


def _recording(
    source: Path, patience: Patience, options: Options, *, needs_boxes: bool
) -> RecordingFollower:
    try:
        follower = RecordingFollower(source, patience, zone=options.zone, needs_boxes=needs_boxes)
    except BadInput as error:
        raise _NotYet(str(error)) from error
    follower.facts = options.named(follower.facts)
    return follower
