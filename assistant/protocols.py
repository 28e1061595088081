"""How the chat shows pictures here: in pixels by kitty's or sixel's protocol, in cells, or not.

A terminal is asked what it can do before the chat begins, and never where ssh, tmux or screen lie
between: a late answer would be read as typing. It is asked in two steps. The first is a question
whose answer Textual understands, however late it comes; only a terminal that answers it quickly
is asked the second, whose answers it would otherwise find in the question line.
"""

from __future__ import annotations

import importlib.util
import os
import re
import select
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, cast

Kind = Literal["kitty", "sixel", "cells", "ascii", "off"]
Cell = tuple[int, int]
"""Width and height of a cell in pixels."""

PIXELS: tuple[Kind, ...] = ("kitty", "sixel")
BETWEEN = ("SSH_CONNECTION", "TMUX", "STY")
"""Set where another program lies between the chat and the person's terminal."""
USUAL_CELL: Cell = (10, 20)
EXTRA = "pip install 'd3a[images]'"

_GREETING = b"\x1b[6n"
_GREETED = re.compile(rb"\x1b\[\d+;\d+R")
_QUESTIONS = b"\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\" + b"\x1b[16t" + b"\x1b[c"
_ANSWERS = re.compile(
    rb"\x1b_Gi=31;(?P<kitty>[^\x1b]*)\x1b\\"
    rb"|\x1b\[6;(?P<height>\d+);(?P<width>\d+)t"
    rb"|\x1b\[\?(?P<attributes>[\d;]*)c"
)
_SIXEL = b"4"
_GREETING_S = 0.3
"""A terminal that takes longer to answer lies far away: pixels would take long as well."""
_ANSWER_S = 10.0
"""For a terminal that has answered once in the time above; every one answers the last question."""


@dataclass(frozen=True, slots=True)
class Told:
    """What a terminal said of itself. typed: what the person typed meanwhile."""

    kitty: bool = False
    sixel: bool = False
    cell: Cell | None = None
    typed: str = ""
    silent: bool = False


@dataclass(frozen=True, slots=True)
class Chosen:
    """How pictures are shown, why so, and the size of a cell for those in pixels."""

    kind: Kind
    why: str
    cell: Cell = USUAL_CELL
    typed: str = ""


def choose(
    said: str,
    environ: Mapping[str, str] = os.environ,
    *,
    ask: Callable[[], Told] | None = None,
    has_extra: bool | None = None,
) -> Chosen:
    """Return how to show pictures, of the setting `said`; auto asks the terminal where it may.

    ask: how the terminal is asked, by default on standard input and error.
    """
    if said in ("cells", "ascii", "off"):
        return Chosen(cast("Kind", said), "as the settings say")
    if environ.get("TEXTUAL_DRIVER"):
        return Chosen("cells", "a browser shows no more")
    if not (extra_is_there() if has_extra is None else has_extra):
        return Chosen("cells", f"kitty and sixel need the extra: {EXTRA}")
    if said in PIXELS:
        kind: Kind = "kitty" if said == "kitty" else "sixel"
        return Chosen(kind, "as the settings say", cell_here() or USUAL_CELL)
    between = [name for name in BETWEEN if environ.get(name)]
    if between:
        return Chosen("cells", f"{' and '.join(between)} set: the terminal is not asked")
    return _of_the_terminal((ask or asked_here)())


def _of_the_terminal(told: Told) -> Chosen:
    cell = cell_here() or told.cell or USUAL_CELL
    if told.silent:
        return Chosen("cells", "the terminal did not answer at once", typed=told.typed)
    if told.sixel:  # some that speak kitty's protocol too lack its placeholders
        return Chosen("sixel", "the terminal says so", cell, told.typed)
    if told.kitty:
        return Chosen("kitty", "the terminal says so", cell, told.typed)
    return Chosen(
        "cells", "the terminal has neither kitty's nor sixel's protocol", cell, told.typed
    )


def extra_is_there() -> bool:
    """Whether the library that speaks both protocols is installed."""
    return importlib.util.find_spec("textual_image") is not None


def cell_here() -> Cell | None:
    """Return the size of a cell as the system knows it, None where it does not; asks nobody."""
    import fcntl
    import struct
    import termios

    if sys.__stderr__ is None:
        return None
    try:
        size = fcntl.ioctl(sys.__stderr__.fileno(), termios.TIOCGWINSZ, bytes(8))
    except (OSError, ValueError):  # no terminal there
        return None
    rows, columns, width, height = struct.unpack("HHHH", size)
    if not (rows and columns and width >= columns and height >= rows):
        return None
    return width // columns, height // rows


def asked_here() -> Told:
    """Ask the terminal at standard input and error; Told.silent where there is none."""
    try:
        return asked(sys.stdin.fileno(), sys.stderr.fileno())
    except (OSError, ValueError, AttributeError):  # closed, or no terminal
        return Told(silent=True)


def asked(read_from: int, write_to: int) -> Told:
    """Ask the terminal at two file descriptors what it can do. Raises OSError without one.

    Nothing that it sends is left to be read, and nothing that the person types is lost.
    """
    import termios
    import tty

    try:
        before = termios.tcgetattr(read_from)
    except termios.error as error:
        raise OSError(str(error)) from error
    try:
        tty.setcbreak(read_from)
        os.write(write_to, _GREETING)
        first = _read_until(read_from, _GREETED, _GREETING_S)
        greeted = _GREETED.search(first)
        if greeted is None:
            return Told(typed=_typed(first), silent=True)
        os.write(write_to, _QUESTIONS)
        rest = _read_until(read_from, re.compile(rb"\x1b\[\?[\d;]*c"), _ANSWER_S)
    finally:
        termios.tcsetattr(read_from, termios.TCSADRAIN, before)
    return told_by(first[: greeted.start()] + first[greeted.end() :] + rest)


def told_by(answers: bytes) -> Told:
    """Return what the bytes of a terminal say; what is no answer of its own was typed."""
    found: dict[str, bytes] = {}
    for match in _ANSWERS.finditer(answers):
        found |= {name: value for name, value in match.groupdict().items() if value is not None}
    cell = (int(found.get("width", 0)), int(found.get("height", 0)))
    return Told(
        kitty=found.get("kitty") == b"OK",
        sixel=_SIXEL in found.get("attributes", b"").split(b";")[1:],
        cell=cell if min(cell) > 0 else None,
        typed=_typed(_ANSWERS.sub(b"", answers)),
    )


def _typed(rest: bytes) -> str:
    """Return the letters among bytes, keys such as arrows left out."""
    keys = re.compile(rb"\x1b(\[[0-9;?]*[ -/]*[@-~]|O.|_[^\x1b]*(\x1b\\)?|.)?", re.DOTALL)
    text = keys.sub(b"", rest).decode("utf-8", "ignore")
    return "".join(letter for letter in text if letter.isprintable())


def _read_until(descriptor: int, end: re.Pattern[bytes], seconds: float) -> bytes:
    """Read until `end` is among it, or until nothing more is waited for."""
    got = b""
    given_up = time.monotonic() + seconds
    while end.search(got) is None:
        left = given_up - time.monotonic()
        if left <= 0 or not select.select([descriptor], [], [], left)[0]:
            return got
        more = os.read(descriptor, 1024)
        if not more:  # the terminal is gone
            return got
        got += more
    return got
