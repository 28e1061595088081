"""Finding the spoken times of a question: the only words a clock ever sees are those found here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from grammar import lalr
from grammar.closed import is_open
from grammar.timedigits import TimeToken
from grammar.timelexer import tokenise

if TYPE_CHECKING:  # many a question names no time and needs no form of any
    from grammar.timeforms import SpokenTime

TIME = lalr.Source("time.lark")


@dataclass(frozen=True, slots=True)
class Found:
    """A spoken time in words[first:last]."""

    said: SpokenTime
    first: int
    last: int


@lru_cache(maxsize=1)
def _parser() -> lalr.Parser:
    from grammar.timetransform import TimeForms

    return lalr.Parser(TIME.tables(), TimeForms())


def find(words: list[str]) -> list[Found]:
    """Return the spoken times in the words, left to right, each as long as it can be."""
    found: list[Found] = []
    run: list[TimeToken] = []
    for token in [*tokenise(words), None]:
        if token is not None:
            run.append(token)
            continue
        found += _in_run(run, words)
        run = []
    return found


def _in_run(run: list[TimeToken], words: list[str]) -> list[Found]:
    found: list[Found] = []
    start = 0
    while start < len(run):
        hit = _longest(run, start, words)
        if hit is None:
            start += 1
            continue
        said, stop = hit
        found.append(Found(said, run[start].first, run[stop - 1].last))
        start = stop
    return found


def _longest(run: list[TimeToken], start: int, words: list[str]) -> tuple[SpokenTime, int] | None:
    """Return the longest time that starts at `start`, and where it stops."""
    stop = len(run)
    if all(t.type == "LINK" for t in run[start:]):
        return _any_time(run[start], start, words)
    while stop > start:
        while stop > start and run[stop - 1].type == "LINK":
            stop -= 1
        kept = [t for t in run[start:stop] if t.type != "LINK"]
        if all(t.type == "EDGE" for t in kept):
            return None
        said, reach = _parse(kept)
        if said is not None and not _false_friend(run, start, stop, words):
            closing = stop < len(run) and run[stop].value in _CLOSING
            return said, stop + closing
        bad = kept[reach] if said is None and reach < len(kept) else kept[-1]
        stop = min(stop - 1, run.index(bad) if said is None and reach else stop - 1)
        if said is None and reach == 0:
            return None
    return None


_CLOSING = ("sharp", "exactly", "precisely", "promptly", "past", "last")
"""What may follow a time: that it is meant to the minute, that the weekday is the last one."""


def _any_time(token: TimeToken, start: int, words: list[str]) -> tuple[SpokenTime, int] | None:
    """Return the time that `at any time` says: one that narrows nothing."""
    following = words[token.last] if token.last < len(words) else ""
    if token.value != "some time" or is_open(following):
        return None
    from grammar.timeforms import SpokenTime

    return SpokenTime(), start + 1


def _parse(tokens: list[TimeToken]) -> tuple[SpokenTime | None, int]:
    """Parse the tokens; without success, return how many of them could be read."""
    try:
        said: SpokenTime = _parser().parse(tokens)
    except lalr.UnreadError as error:
        return None, error.index
    return said, len(tokens)


def _false_friend(run: list[TimeToken], start: int, stop: int, words: list[str]) -> bool:
    """Whether the words are part of a noun phrase: `the second cup`, `my sunday hat`."""
    last = run[stop - 1]
    following = words[last.last] if last.last < len(words) else ""
    if not is_open(following) or following in _CLOSING:
        return False
    led = run[start].type == "LINK" and run[start].value not in ("the", "of", ",")
    kept = [t for t in run[start:stop] if t.type != "LINK"]
    if last.type in ("ORD", "SEASON", "HOUR", "YEAR", "MINUTE"):
        return True
    if len(kept) == 1 and last.type in ("WEEKDAY", "PART", "MONTH", "HOLIDAY", "WEEKEND"):
        return not led
    return False
