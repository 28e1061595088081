"""Small English: articles, plurals, lists, times and durations as a person says them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from grammar import vocabulary
from grammar.forms import TimeSlice

WEEKDAYS = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
MONTHS = (
    *("January", "February", "March", "April", "May", "June", "July", "August", "September"),
    *("October", "November", "December"),
)
ORDINALS = (
    "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth",
)  # fmt: skip
_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_UNITS = (
    ("second", 1.0, 60.0),
    ("minute", 60.0, 3600.0),
    ("hour", 3600.0, 48 * 3600.0),
    ("day", 86400.0, 60 * 86400.0),
    ("month", 30.44 * 86400.0, 24 * 30.44 * 86400.0),
    ("year", 365.25 * 86400.0, float("inf")),
)
"""Units of time, their seconds, and up to where a length is told in them."""
_ROUGH_FROM_S = 60 * 86400.0
_SLIGHT, _ALMOST = 0.1, 0.75
_SILENT_H = ("hour", "honest", "heir")
_YOU_SOUND = ("uni", "use", "uku", "eu", "one", "ute")
_PAIRS = frozenset(
    {"scissors", "glasses", "eyeglasses", "sunglasses", "spectacles", "specs", "goggles", "shades"}
    | {"trousers", "jeans", "pants", "shorts", "tights", "leggings", "pajamas", "pyjamas"}
    | {"pliers", "tweezers", "tongs", "binoculars", "headphones", "chopsticks"}
)
"""Two halves make one of it: it is counted in pairs."""
_COMPARED = frozenset(
    {"biggest", "largest", "smallest", "tallest", "shortest"}
    | {"bigger", "larger", "smaller", "taller", "shorter"}
)
"""One of several is so, and so it is the one."""
_CLAUSE = " that is "
"""What begins what is said of a noun after it."""
_PLENTY = frozenset(
    {"clothes", "stairs", "blinds", "groceries", "cosmetics", "sweets", "meds", "dentures", "skis"}
)
"""These have no singular either, and are not counted."""


def article(words: str) -> str:
    """Return the words with "a" or "an"; "a pair of scissors", "some groceries", "the biggest"."""
    if words.partition(" ")[0] in _COMPARED:
        return f"the {words}"
    if is_many(words):
        return f"a pair of {words}" if _head(words) in _PAIRS else f"some {words}"
    first = words.lower()
    vowel = first[:1] in "aeio" or first.startswith(_SILENT_H)
    vowel = (vowel or (first[:1] == "u")) and not first.startswith(_YOU_SOUND)
    return f"{'an' if vowel else 'a'} {words}"


def is_many(words: str) -> bool:
    """Whether the noun has no singular: scissors, glasses, groceries."""
    return _head(words) in _PAIRS or _head(words) in _PLENTY


def _head(words: str) -> str:
    return _apart(words)[0].rpartition(" ")[2].lower()


def _apart(words: str) -> tuple[str, str]:
    """Return a noun phrase and what is said of it after it: red cup, "not mine"."""
    noun, _, clause = words.replace(" that are ", _CLAUSE).partition(_CLAUSE)
    return noun, clause


def plural(words: str) -> str:
    """Return the plural of a noun phrase: "red cups", "cups that are not red"."""
    noun, clause = _apart(words)
    many = noun if is_many(noun) else vocabulary.plural(noun)
    return f"{many} that are {clause}" if clause else many


def number_word(number: int) -> str:
    """Return "no", "one" and so on to "ten", figures from 11 on."""
    return _NUMBERS[number] if 0 <= number < len(_NUMBERS) else str(number)


def all_of(number: int) -> str:
    """Return "the only one", "both", "all three"."""
    return ("the only one", "both")[number - 1] if number < 3 else f"all {number_word(number)}"


def counted(number: int, words: str) -> str:
    """Return "two cups", "one cup", "no cups", "12 cups", "two pairs of glasses"."""
    said = number_word(number)
    if _head(words) in _PAIRS and number > 0:
        return f"{said} {'pair' if number == 1 else 'pairs'} of {words}"
    return f"{said} {words if number == 1 else plural(words)}"


def range_of(least: int, most: int) -> str:
    """Return "three", "two or three", "two to five"."""
    return f"{_from(least, most)}{number_word(most)}"


def counted_range(least: int, most: int, words: str) -> str:
    """Return "a cup", "three cups", "two or three cups", "two to five cups"."""
    return article(words) if most == 1 else f"{_from(least, most)}{counted(most, words)}"


def _from(least: int, most: int) -> str:
    if not 0 < least < most:
        return ""
    return f"{number_word(least)} {'or' if most == least + 1 else 'to'} "


def times(number: int) -> str:
    """Return "once", "twice", "three times", "12 times"."""
    if number in (1, 2):
        return ("once", "twice")[number - 1]
    return f"{number_word(number)} times"


def occasions(number: int) -> str:
    """Return "once", "on two occasions": at how many times apart, not in how many pictures."""
    return times(number) if number < 2 else f"on {counted(number, 'occasion')}"


def listed(words: Sequence[str]) -> str:
    """Return "a", "a and b", "a, b and c"."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"


def neither(words: Sequence[str]) -> str:
    """Return "not a", "neither a nor b", "neither a nor b nor c"."""
    return f"neither {' nor '.join(words)}" if len(words) > 1 else f"not {listed(words)}"


def sentence_case(words: str) -> str:
    """Return the words with a capital first letter, the rest as it is."""
    return words[:1].upper() + words[1:]


def clock(moment: datetime) -> str:
    """Return "9:42"."""
    return f"{moment.hour}:{moment.minute:02d}"


def day_of(moment: datetime, now: datetime) -> str:
    """Return the day as `now` calls it: today, yesterday, on Friday, on Friday 3 May (2019)."""
    days = (now.date() - moment.date()).days
    if days == 0:
        return "today"
    if days == 1:
        return "yesterday"
    weekday = WEEKDAYS[moment.weekday()]
    if 1 < days < 7:
        return f"on {weekday}"
    date = f"on {weekday} {moment.day} {MONTHS[moment.month - 1]}"
    return date if moment.year == now.year else f"{date} {moment.year}"


def ago(moment: datetime, now: datetime) -> str:
    """Return how long ago, in one unit: "20 minutes ago", "9 hours ago", "3 days ago".

    In real time, whatever the clocks did in between; from two days on, in days of the calendar,
    so that it agrees with the weekday said beside it.
    """
    seconds = (now.astimezone(UTC) - moment.astimezone(UTC)).total_seconds()
    if seconds < 0:
        return "after the time you ask at"
    if seconds < 60:
        return "just now"
    days = (now.date() - moment.astimezone(now.tzinfo).date()).days
    if 2 * 86400 <= seconds < _ROUGH_FROM_S:
        return f"{days} days ago"
    if seconds >= _ROUGH_FROM_S:
        return f"{_rough(seconds)} ago"
    return f"{duration(seconds)} ago"


def _rough(seconds: float) -> str:
    """Return months and years as people round them: "almost 7 years", "over 6 years".

    A tenth of a unit more or less is not told; from three quarters on it is almost the next.
    """
    name, unit, _ = _UNITS[-1] if seconds >= _UNITS[-2][2] else _UNITS[-2]
    whole, part = divmod(seconds / unit, 1.0)
    number = int(whole) + (part >= _ALMOST)
    said = f"{number} {name}{'' if number == 1 else 's'}"
    if part < _SLIGHT or part > 1 - _SLIGHT:
        return said
    return f"almost {said}" if part >= _ALMOST else f"over {said}"


def duration(seconds: float) -> str:
    """Return a length of time in its largest unit, rounded: "25 minutes", "3 days"."""
    for (name, unit, limit), following in zip(_UNITS, (*_UNITS[1:], _UNITS[-1]), strict=True):
        number = round(seconds / unit)
        if seconds < limit and number * unit < limit:
            return f"{number} {name}{'' if number == 1 else 's'}"
        if seconds < limit:  # 59.9 minutes are an hour
            name, unit, _ = following
            return f"{max(1, round(seconds / unit))} {name}"
    raise AssertionError("unreachable: the last unit has no limit")


def when(moment: datetime, now: datetime) -> str:
    """Return day, clock and distance: "today at 9:42, 9 hours ago"."""
    local = moment.astimezone(now.tzinfo)
    return f"{day_of(local, now)} at {clock(local)}, {ago(local, now)}"


def slice_words(time: TimeSlice, now: datetime) -> str:
    """Return a slice as it was taken: "between 8:00 and 11:00 today", "since Monday at 9:00"."""
    start = time.start.astimezone(now.tzinfo) if time.start else None
    end = time.end.astimezone(now.tzinfo) if time.end else None
    if start is not None and start == end:
        return f"{day_of(start, now)} at {clock(start)}"
    if start is None or end is None:
        edge, word = (end, "before") if end is not None else (start, "since")
        if edge is None:
            return "at any time"
        return f"{word} {day_of(edge, now).removeprefix('on ')} at {clock(edge)}"
    return _both_ends(start, end, now)


def _both_ends(start: datetime, end: datetime, now: datetime) -> str:
    midnights = (start.hour, start.minute, end.hour, end.minute) == (0, 0, 0, 0)
    last = end - timedelta(days=1)
    if midnights and last.date() == start.date():
        return day_of(start, now)
    if midnights:
        first, final = (day_of(m, now).removeprefix("on ") for m in (start, last))
        return f"from {first} to {final}"
    until_midnight = (end.hour, end.minute) == (0, 0) and last.date() == start.date()
    if start.date() == end.date() or until_midnight:
        return f"between {clock(start)} and {'midnight' if until_midnight else clock(end)} " + (
            day_of(start, now)
        )
    first, final = (day_of(m, now).removeprefix("on ") for m in (start, end))
    return f"between {first} at {clock(start)} and {final} at {clock(end)}"
