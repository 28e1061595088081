"""Finding the spoken times of a question: the only words a clock ever sees are those found here."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from grammar import lalr
from grammar.closed import is_open
from grammar.timedigits import TimeToken
from grammar.timeforms import (
    Ago,
    Bound,
    Clock,
    Date,
    Edge,
    Now,
    Part,
    PartDay,
    SpokenTime,
    Whole,
)
from grammar.timelexer import tokenise
from grammar.timetransform import TimeForms
from grammar.timewords import MONTHS

TIME = lalr.Source("time.lark")


@dataclass(frozen=True, slots=True)
class Found:
    """A spoken time in words[first:last]."""

    said: SpokenTime
    first: int
    last: int


@lru_cache(maxsize=1)
def _parser() -> lalr.Parser:
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
    while stop > start:
        while stop > start and run[stop - 1].type == "LINK":
            stop -= 1
        kept = [t for t in run[start:stop] if t.type != "LINK"]
        if all(t.type == "EDGE" for t in kept):
            return None
        said, reach = _parse(kept)
        if said is not None and not _false_friend(run, start, stop, words):
            closing = stop < len(run) and run[stop].value in ("sharp", "exactly", "precisely")
            return said, stop + closing
        bad = kept[reach] if said is None and reach < len(kept) else kept[-1]
        stop = min(stop - 1, run.index(bad) if said is None and reach else stop - 1)
        if said is None and reach == 0:
            return None
    return None


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
    if not is_open(following):
        return False
    led = run[start].type == "LINK" and run[start].value not in ("the", "of", ",")
    kept = [t for t in run[start:stop] if t.type != "LINK"]
    if last.type in ("ORD", "SEASON", "HOUR", "YEAR", "MINUTE"):
        return True
    if len(kept) == 1 and last.type in ("WEEKDAY", "PART", "MONTH", "HOLIDAY", "WEEKEND"):
        return not led
    return False


def listed(times: list[Found], words: list[str]) -> tuple[int, int] | None:
    """Return the first and the last of times that `and` or `or` joins, None for none.

    Such are times of one kind: on monday and tuesday, in 2016 and 2017, this morning or afternoon.
    """
    pairs = [
        i
        for i in range(len(times) - 1)
        if {*words[times[i].last : times[i + 1].first]} <= {"and", "or", ","}
        and times[i].last < times[i + 1].first
        and _kinds(times[i]) & _kinds(times[i + 1])
    ]
    return (pairs[0], pairs[-1] + 1) if pairs else None


def _kinds(time: Found) -> set[str]:
    """Return whether days, parts of the day or clock times are named; none for an interval."""
    if time.said.bounds or time.said.offset is not None:
        return set()
    kinds = {Clock: "clock", Part: "part", PartDay: "day", Edge: "", Now: "", Whole: "", Ago: "ago"}
    return {kinds.get(type(piece), "day") for piece in time.said.pieces} - {""}


def joined(times: list[Found], words: list[str]) -> SpokenTime:
    """Return the times of a question as one: they narrow each other wherever they stand."""
    if len(times) == 1:
        return times[0].said
    pair = listed(times, words)
    if pair is not None:
        first, last = pair
        sides = tuple(time.said.pieces for time in times[first : last + 1])
        both = Found(SpokenTime((), (Bound("both", sides),)), times[first].first, times[last].last)
        return joined([*times[:first], both, *times[last + 1 :]], words)
    offset = next((t.said for t in times if t.said.offset is not None), None)
    return SpokenTime(
        tuple(piece for t in times for piece in t.said.pieces),
        tuple(bound for t in times for bound in t.said.bounds),
        offset.offset if offset else None,
        offset.offset_sign if offset else 0,
    )


def is_present(said: SpokenTime) -> bool:
    """Whether a time says no more than now: currently, at the moment."""
    return not said.bounds and said.offset is None and all(isinstance(p, Now) for p in said.pieces)


def is_slashed(word: str) -> bool:
    """Whether a word is a date in digits whose order tells nothing: 3/4/2018."""
    return re.fullmatch(r"\d{1,2}[-/.]\d{1,2}([-/.]\d{2,4})?", word) is not None


def date_in_words(date: Date) -> str:
    """Return a date as it is said, month by its name: `March 4, 2018`."""
    month = MONTHS[(date.month or 1) - 1].capitalize()
    return f"{month} {date.day}" + (f", {date.year}" if date.year is not None else "")
