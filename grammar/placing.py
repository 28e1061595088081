"""Placing of spoken times: taken out of the words, joined, and resolved by the clock.

Loaded for a question that names a time; many do not.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

from grammar import clock
from grammar.closed import is_open
from grammar.cursor import TIME_GAP
from grammar.days import TimeAmbiguityError, TimeError, TimesApartError
from grammar.errors import Ambiguous, NotUnderstood, QuestionError
from grammar.forms import TimeSlice
from grammar.suggestions import suggestions
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
    Unplaced,
    Whole,
)
from grammar.timespan import Found
from grammar.timewords import MONTHS
from grammar.words import Word

if TYPE_CHECKING:
    from grammar.reading import Reading


def placed(
    reading: Reading, words: list[Word], times: list[Found]
) -> tuple[list[Word], TimeSlice | None, bool]:
    """Return the words without their times, the slice that these name, whether it is now.

    The slice is None where they narrow nothing: at any time.
    Raises NotUnderstood for a time that the calendar has not, Ambiguous for two that it has.
    """
    words, times = _corrected(words, times)
    _refuse_denied(reading, words, times)
    rest = _without(words, times)
    times = [time for time in times if time.said != SpokenTime()]
    if not times:
        return rest, None, False
    present = all(_is_present(time.said) for time in times)
    try:
        said = _joined(times, [w.text for w in words])
        return rest, clock.resolve(said, reading.now, month_first(reading.now)), present
    except TimeAmbiguityError as error:
        raise _ambiguous_date(reading, words, error) from error
    except TimesApartError as error:
        raise _ambiguous_times(reading, words, times, error) from error
    except TimeError as error:
        first = words[times[0].first].start
        said_text = reading.text[first : words[times[-1].last - 1].end]
        raise NotUnderstood(
            reading.text,
            first,
            f"“{said_text}” is no time I can place: {error}.",
            suggestions(rest, reading.lexicon),
        ) from error


def _corrected(words: list[Word], times: list[Found]) -> tuple[list[Word], list[Found]]:
    """Take out a time that is denied for the next one: not yesterday but on monday.

    One that is denied and ends what is said leaves many: did you see the cup not yesterday.
    """
    texts = [w.text for w in words]
    for i, (denied, meant) in enumerate(itertools.pairwise(times)):
        first, last = denied.first - 1, denied.last + 1
        joined = texts[denied.last : last] == ["but"] and meant.first == last
        if first >= 0 and texts[first] == "not" and joined:
            gap = last - first
            moved = [replace(t, first=t.first - gap, last=t.last - gap) for t in times[i + 1 :]]
            return _corrected(words[:first] + words[last:], times[:i] + moved)
    *others, time = times
    leads = texts[max(0, time.first - 2) : time.first]
    denied_alone = time.last == len(texts) and leads[1:] == ["not"] and is_open(leads[0])
    if not denied_alone:
        return words, times
    said = SpokenTime((Unplaced("it says when not; ask for when"),))
    return words, [*others, replace(time, said=said)]


def _refuse_denied(reading: Reading, words: list[Word], times: list[Found]) -> None:
    """Raise NotUnderstood for a time and another when it was not: yesterday but not today.

    Each is asked for by itself; what is offered says the one, and then the other.
    """
    for meant, denied in itertools.pairwise(times):
        texts = [w.text for w in words[meant.last : denied.first]]
        if texts not in (["but", "not"], ["and", "not"]):
            continue
        first, end = words[meant.first].start, words[meant.last - 1].end
        other, last = words[denied.first].start, words[denied.last - 1].end
        text = reading.text
        offered = (text[:end] + text[last:], text[:first] + text[other:last] + text[last:])
        reason = "It tells when, and when not; ask for one time and then for the other."
        raise NotUnderstood(text, words[meant.last].start, reason, offered)


def _without(words: list[Word], times: list[Found]) -> list[Word]:
    """Return the words with a gap where a time, or a list of times, was: as long as it."""
    rest: list[Word] = []
    last = 0
    listed = _listed(times, [w.text for w in words])
    for i, time in enumerate(times):
        joined = listed is not None and listed[0] < i <= listed[1]
        rest += [] if joined else words[last : time.first]
        rest.append(replace(words[time.first], text=TIME_GAP, end=words[time.last - 1].end))
        last = time.last
    return rest + words[last:]


def month_first(now: datetime) -> bool | None:
    """Return whether the country of `now`'s zone writes the month first, None where unknown.

    A named zone of the Americas and an offset that only the Americas have write 3/4 for March 4.
    """
    key = str(getattr(now.tzinfo, "key", ""))
    if key.startswith(("America/", "US/")):
        return True
    if "/" in key and not key.startswith("Etc/"):
        return False
    offset = now.utcoffset()
    return True if offset is not None and offset <= timedelta(hours=-4) else None


def _ambiguous_times(
    reading: Reading, words: list[Word], times: list[Found], error: TimesApartError
) -> QuestionError:
    """Return the question with each of two times that lie apart: on monday and friday."""
    pair = _listed(times, [w.text for w in words])
    assert pair is not None  # only times that are listed lie apart
    spelled: list[str] = []
    first, last = words[times[pair[0]].first].start, words[times[pair[1]].last - 1].end
    lead = _lead(words, times[pair[0]])
    for time in times[pair[0] : pair[1] + 1]:
        said = reading.text[words[time.first].start : words[time.last - 1].end]
        led = "" if _lead(words, time) else "".join(f"{word} " for word in lead)
        spelled.append(f"{reading.text[:first]}{led}{said}{reading.text[last:]}")
    return _ambiguous(reading, words[times[pair[0]].first].start, error, spelled[:3])


def _lead(words: list[Word], time: Found) -> list[str]:
    """Return the little words that a time begins with: `on the` of `on the 5th`."""
    said = (w.text for w in words[time.first : time.last])
    return list(itertools.takewhile(lambda text: text in ("on", "in", "at", "the"), said))


def _ambiguous_date(
    reading: Reading, words: list[Word], error: TimeAmbiguityError
) -> QuestionError:
    """Return both readings of a date in digits, each spelled with its month's name."""
    date = next(w for w in words if _is_slashed(w.text))
    spelled: list[str] = []
    for meant in error.readings:
        said = _in_words(meant)
        spelled.append(f"{reading.text[: date.start]}{said}{reading.text[date.end :]}")
    return _ambiguous(reading, date.start, error, spelled)


def _ambiguous(
    reading: Reading, position: int, error: TimeError, spelled: list[str]
) -> QuestionError:
    """Return the error that offers each spelling of the question with what it means."""
    try:
        queries = tuple(reading.again(text) for text in spelled)
    except QuestionError as other:
        # the question fails however its time is read
        return replace(other, text=reading.text, position=position)
    reason = f"{str(error).capitalize()}."
    return Ambiguous(reading.text, position, reason, tuple(spelled), queries)


def _listed(times: list[Found], words: list[str]) -> tuple[int, int] | None:
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


def _joined(times: list[Found], words: list[str]) -> SpokenTime:
    """Return the times of a question as one: they narrow each other wherever they stand."""
    if len(times) == 1:
        return times[0].said
    pair = _listed(times, words)
    if pair is not None:
        first, last = pair
        sides = tuple(time.said.pieces for time in times[first : last + 1])
        both = Found(SpokenTime((), (Bound("both", sides),)), times[first].first, times[last].last)
        return _joined([*times[:first], both, *times[last + 1 :]], words)
    offset = next((t.said for t in times if t.said.offset is not None), None)
    return SpokenTime(
        tuple(piece for t in times for piece in t.said.pieces),
        tuple(bound for t in times for bound in t.said.bounds),
        offset.offset if offset else None,
        offset.offset_sign if offset else 0,
    )


def _is_present(said: SpokenTime) -> bool:
    """Whether a time says no more than now: currently, at the moment."""
    return not said.bounds and said.offset is None and all(isinstance(p, Now) for p in said.pieces)


def _is_slashed(word: str) -> bool:
    """Whether a word is a date in digits whose order tells nothing: 3/4/2018."""
    return re.fullmatch(r"\d{1,2}[-/.]\d{1,2}([-/.]\d{2,4})?", word) is not None


def _in_words(date: Date) -> str:
    """Return a date as it is said, month by its name: `March 4, 2018`."""
    month = MONTHS[(date.month or 1) - 1].capitalize()
    return f"{month} {date.day}" + (f", {date.year}" if date.year is not None else "")
