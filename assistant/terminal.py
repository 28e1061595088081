"""What may be written to a terminal: words from people and recordings, made harmless.

A category name is data: it must not move the cursor, change the window's title, or reverse the
direction of the line. Here it loses what a terminal would obey; JSON keeps it, escaped.
"""

from __future__ import annotations

import json
import os
import sys
import unicodedata
from collections.abc import Mapping
from typing import Any, TextIO

import click

_SPACES = {"\n", "\r", "\t", "\v", "\f", "\x85", "\u2028", "\u2029"}
_HIDDEN = {"Cc", "Cf", "Cs", "Co", "Cn"}
_JOINERS = {"\u200c", "\u200d"}  # needed inside words of several scripts and in emoji


def clean(text: str) -> str:
    """Return `text` on one line without control, format and unassigned characters."""
    if text.isascii() and text.isprintable():
        return text
    kept = (
        " " if char in _SPACES else char
        for char in text
        if char in _SPACES or char in _JOINERS or unicodedata.category(char) not in _HIDDEN
    )
    return "".join(kept)


def clean_lines(text: str) -> str:
    """Return `text` with its line breaks, each line made `clean`."""
    return "\n".join(clean(line) for line in text.split("\n"))


def well_formed(text: str) -> str:
    """Return `text` with the bytes that were not UTF-8 replaced, as it came from the shell."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def json_line(record: Mapping[str, Any], *, ascii_only: bool = False) -> str:
    """Return `record` as one line of JSON that holds no raw control character.

    JSON escapes C0 itself; C1 and DEL, which terminals obey as well, are escaped here.
    """
    line = json.dumps(record, ensure_ascii=ascii_only, allow_nan=False)
    if line.isascii() and line.isprintable():
        return line
    return "".join(
        f"\\u{ord(char):04x}" if "\x7f" <= char <= "\x9f" or char in "\u2028\u2029" else char
        for char in line
    )


def emit(record: Mapping[str, Any]) -> None:
    """Print a record as a line of JSON."""
    click.echo(json_line(record, ascii_only=not speaks_unicode(sys.stdout)))


def tell(text: str) -> None:
    """Write a line of talk to standard error: above the bar, where one is drawn there.

    `click.echo` would write past the bar, into its line.
    """
    sys.stderr.write(clean(text) + "\n")
    sys.stderr.flush()


def speaks_unicode(stream: TextIO) -> bool:
    """Whether `stream` can carry every character: its encoding is a UTF."""
    return (getattr(stream, "encoding", None) or "").lower().replace("-", "").startswith("utf")


def is_terminal(stream: TextIO) -> bool:
    """Whether a person sits at `stream`; a closed stream has nobody."""
    try:
        return stream.isatty()
    except ValueError:
        return False


def why_not_full_screen(environ: Mapping[str, str] = os.environ) -> str | None:
    """Return why the full-screen chat cannot run here, or None where it can.

    The chat draws on standard error (Textual does, on Linux) and reads standard input.
    """
    if not (is_terminal(sys.stdin) and is_terminal(sys.stdout) and is_terminal(sys.stderr)):
        return "this is not a terminal"
    if environ.get("TERM", "") in ("", "dumb", "unknown"):
        return f"the terminal is {environ.get('TERM') or 'not named'} (TERM)"
    if not speaks_unicode(sys.stderr):
        return f"the terminal takes {sys.stderr.encoding}, which has no box characters"
    return None


def width_of(text: str) -> int:
    """Return how many cells `text` takes: wide and combining characters counted as drawn."""
    if text.isascii():
        return len(text)
    return sum(
        0
        if unicodedata.combining(char) or char in _JOINERS
        else 2
        if unicodedata.east_asian_width(char) in "WF"
        else 1
        for char in text
    )


def shorten(text: str, width: int) -> str:
    """Return `text` in at most `width` cells, with an ellipsis where it was cut."""
    if width_of(text) <= width:
        return text
    kept = ""
    for char in text:
        if width_of(kept + char) > width - 1:
            break
        kept += char
    return kept.rstrip() + "…" if width > 0 else ""


def table(rows: list[list[str]], *, limits: Mapping[int, int] | None = None) -> list[str]:
    """Return `rows` (the first is the header) as lines of aligned columns.

    Numbers stand to the right. limits: the widest a column may be, in cells.
    """
    if not rows:
        return []
    limits = limits or {}
    cells = [
        [shorten(clean(cell), limits.get(i, 60)) for i, cell in enumerate(row)] for row in rows
    ]
    widths = [max(width_of(row[i]) for row in cells) for i in range(len(cells[0]))]
    numeric = [
        all(_is_number(row[i]) for row in cells[1:]) and len(cells) > 1 for i in range(len(widths))
    ]
    lines = []
    for row in cells:
        padded = [
            " " * (widths[i] - width_of(cell)) + cell
            if numeric[i]
            else cell + " " * (widths[i] - width_of(cell))
            for i, cell in enumerate(row)
        ]
        lines.append("  ".join(padded).rstrip())
    return lines


def _is_number(cell: str) -> bool:
    return cell in ("", "-") or cell.replace(".", "", 1).isdecimal()
