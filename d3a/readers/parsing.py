"""What the readers share: clean words, times, zones, and JSON lines that may be broken."""

from __future__ import annotations

import difflib
import json
import math
import os
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
from numpy.typing import ArrayLike, NDArray

from d3a.model import BadInput, Box, Detection, Json
from d3a.readers.base import Skipped

NOTHING_M2 = 1e3
"""A variance from here on is how drivers say that they know nothing of an axis."""
NOTHING_RAD2 = math.pi**2 / 3
"""The same of a turn: it is the variance of a turn that may be any."""
MAX_CATEGORY = 100
"""Characters of a category; a longer one is no name of a thing."""
BROKEN_LINE = "broken line"
BROKEN_DETECTION = "broken detection"
BROKEN_FRAME = "broken frame"
BROKEN_SPREAD = "broken covariance of a position, not used"
MISSING_PICTURE = "missing picture"
NO_FILE = "picture that is no file of the recording, not read"
CLEANED = "control characters in a category, taken out"


def clean_text(text: str) -> str:
    """Return the text without control, format and surrogate characters, blanks made single.

    A name from a file ends up on a terminal; an escape sequence must not get that far.
    """
    kept = (" " if c.isspace() else c for c in text if c.isspace() or not _hidden(c))
    return " ".join("".join(kept).split())


def _hidden(character: str) -> bool:
    return unicodedata.category(character) in ("Cc", "Cf", "Cs", "Co", "Cn")


def category_of(value: Any, skipped: Skipped, where: str) -> str:
    """Return a detection's category as plain text; BadInput where it is none."""
    if not isinstance(value, str):
        raise BadInput(f"the category {value!r} is not text")
    cleaned = clean_text(value)
    if not cleaned or len(cleaned) > MAX_CATEGORY:
        raise BadInput(f"the category is empty or over {MAX_CATEGORY} characters")
    if any(_hidden(c) for c in value.strip()):
        skipped.add(CLEANED, where)
    return cleaned


def did_you_mean(said: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return the end of a message, which names what is spelt nearest; "" where nothing is near."""
    near = difflib.get_close_matches(said, list(known), n=1, cutoff=cutoff)
    return f" Did you mean {near[0]}?" if near else ""


def zone_of(name: str | None) -> str | None:
    """Return the IANA zone's name; BadInput where there is no such zone."""
    if name is None:
        return None
    try:
        ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError) as error:
        raise BadInput(
            f"unknown time zone {clean_text(str(name))!r}: an IANA name such as Europe/Berlin "
            "would do"
        ) from error
    return name


def time_ms(text: Any) -> int:
    """Return UTC milliseconds of an ISO time with an offset, rounded to the nearest."""
    if not isinstance(text, str):
        raise BadInput(f"the time {text!r} is not text")
    try:
        moment = datetime.fromisoformat(text)
    except ValueError as error:
        raise BadInput(f"{clean_text(text)!r} is not an ISO 8601 time") from error
    if moment.tzinfo is None:
        raise BadInput(f"the time {clean_text(text)!r} has no offset from UTC")
    return round(moment.timestamp() * 1000)


def number(value: Any, name: str) -> float:
    """Return a finite float; BadInput otherwise."""
    try:
        parsed = float(value)
    except OverflowError as error:  # a whole number of hundreds of digits
        raise BadInput(f"{name} is larger than any number") from error
    except (TypeError, ValueError) as error:
        raise BadInput(f"{name} {value!r} is not a number") from error
    if not math.isfinite(parsed):
        raise BadInput(f"{name} is {parsed}")
    return parsed


def numbers(value: Any, count: int, name: str) -> tuple[float, ...]:
    """Return `count` finite floats of a JSON array; BadInput otherwise."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != count:
        raise BadInput(f"{name} must have {count} numbers")
    return tuple(number(v, name) for v in value)


def is_covariance(values: ArrayLike) -> bool:
    """Whether numbers are a square covariance (36: of a pose): finite, symmetric, no variance < 0.

    What rounding does to one of its own size is let pass.
    """
    flat = np.asarray(values, dtype=np.float64).ravel()
    side = math.isqrt(len(flat))
    matrix = np.reshape(flat, (side, side))
    if not np.isfinite(matrix).all():
        return False
    slack = 1e-6 * float(np.abs(matrix).max())
    if float(np.abs(matrix - matrix.T).max()) > slack:
        return False
    return float(np.linalg.eigvalsh(matrix)[0]) >= -slack


def covariance_of(value: Any) -> tuple[float, ...]:
    """Return the 36 numbers of a pose's covariance, axes of which it knows nothing as fixed.

    Raises BadInput for what is none, and for one that knows nothing of x, y or the heading.
    """
    values = numbers(value, 36, "the covariance")
    if not is_covariance(values):
        raise BadInput("it is not symmetric, or has a variance below 0 along some axis")
    told = of_known_axes(np.reshape(values, (6, 6)))
    if told is None:
        raise BadInput("it knows nothing of x, y or the heading")
    return tuple(float(v) for v in told.ravel())


def spread_of(value: Any, skipped: Skipped, where: str) -> tuple[float, ...] | None:
    """Return the 9 numbers of a position's covariance, None for null.

    What is none is counted, and the position goes on without.
    """
    if value is None:
        return None
    try:
        values = numbers(value, 9, "the covariance")
        if not is_covariance(values):
            raise BadInput("it is not symmetric, or has a variance below 0 along some axis")  # noqa: TRY301
    except BadInput as error:
        skipped.add(BROKEN_SPREAD, f"{where} ({error})")
        return None
    return values


def of_known_axes(covariance: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return a (6, 6) covariance with axes of which it knows nothing as fixed.

    That is how drivers of robots on a floor mean it, of height and tilt. None where it knows
    nothing of x, y or the heading.
    """
    known = covariance.diagonal() < [NOTHING_M2] * 3 + [NOTHING_RAD2] * 3
    return covariance * np.outer(known, known) if known[[0, 1, 5]].all() else None


def box_of(value: Any) -> Box:
    """Return x1, y1, x2, y2 of a JSON array."""
    x1, y1, x2, y2 = numbers(value, 4, "the box")
    return x1, y1, x2, y2


def frame_name(value: Any) -> str:
    """Return a frame's name, which may be written as a number."""
    if isinstance(value, bool) or not isinstance(value, str | int) or value == "":
        raise BadInput(f"{value!r} is no name of a frame")
    cleaned = clean_text(str(value))
    if not cleaned or len(cleaned) > 255:
        raise BadInput("a frame's name is empty or over 255 characters")
    return cleaned


def json_lines(path: Path, skipped: Skipped) -> Iterator[tuple[int, Json]]:
    """Yield (number from 0, object) of each line; what is no JSON object is counted."""
    with path.open(encoding="utf-8", errors="replace") as lines:
        for number_, line in enumerate(lines):
            if not line.strip():
                continue
            record = json_line(line)
            if record is not None:
                yield number_, record
            else:
                skipped.add(BROKEN_LINE, f"{path.name}:{number_ + 1}")


def json_line(line: str) -> Json | None:
    """Return the object that a line holds, None for what is no JSON object."""
    try:
        record = json.loads(line)
    except (ValueError, RecursionError):  # the latter: thousands of brackets in each other
        return None
    return record if isinstance(record, dict) else None


def warn_unknown(
    record: Mapping[str, Any], known: frozenset[str], file: str, skipped: Skipped
) -> None:
    """Count each field that is not known once a file: it is ignored."""
    for name in sorted(record.keys() - known):
        reason = f"unknown field in {file}: {clean_text(name)[:50]}"
        if reason not in skipped.counts:
            skipped.add(reason, file)


def inside(folder: Path, name: Any) -> Path | None:
    """Return the path of a file that a record names, None for null; it must stay in the folder.

    A name cannot lead out of the recording, which may be a stranger's; a link that lies in it may:
    whoever keeps the folder has put it there.
    """
    if name is None:
        return None
    if not isinstance(name, str) or "\0" in name:
        raise BadInput(f"{name!r} is no file name")
    plain = Path(os.path.normpath(name))  # so "link/.." is the folder, not what is behind
    leads_out = plain.is_absolute() or plain.parts[:1] == ("..",)
    if leads_out and not (folder / plain).resolve().is_relative_to(folder.resolve()):
        raise BadInput(f"the file {clean_text(name)!r} is outside of the recording")
    return folder / plain


def existing(path: Path | None, skipped: Skipped, where: str) -> Path | None:
    """Return the path where there is such a file; else count it and return None."""
    if path is None or _is_file(path):
        return path
    skipped.add(MISSING_PICTURE, where)
    return None


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name longer than any file's
        return False


def picture(folder: Path, name: Any, skipped: Skipped) -> Path | None:
    """Return the file of a picture that a record names, None for null.

    One that cannot be is counted, and its frame goes on without.
    """
    try:
        path = inside(folder, name)
    except BadInput as error:
        skipped.add(NO_FILE, str(error))
        return None
    return existing(path, skipped, clean_text(str(name)))


class Rows:
    """Detections grouped by frame, from lines in any order."""

    def __init__(self) -> None:
        self._by_frame: dict[str, list[Detection]] = {}

    def __contains__(self, frame: str) -> bool:
        """Say whether there are detections of the frame, not taken yet."""
        return frame in self._by_frame

    def add(self, frame: str, detection: Detection) -> None:
        """Keep a detection of a frame."""
        self._by_frame.setdefault(frame, []).append(detection)

    def take(self, frame: str) -> tuple[Detection, ...]:
        """Return the frame's detections and forget them; the rest names frames there are not."""
        return tuple(self._by_frame.pop(frame, ()))

    def count_left(self, skipped: Skipped) -> None:
        """Count the detections of frames that the recording does not have."""
        for frame, left in self._by_frame.items():
            for _ in left:
                skipped.add("detection of an unknown frame", frame)
        self._by_frame.clear()
