"""Dates and clock times written in digits, and what every reader of time words looks at."""

from __future__ import annotations

import re
from dataclasses import dataclass

from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.lalr import Token

_ISO = re.compile(r"(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})(?:t(\d{1,2}):(\d{2})(?::(\d{2}))?)?$")
_SLASHED = re.compile(r"(\d{1,2})[-/.](\d{1,2})(?:[-/.](\d{4}|\d{2}))?$")
_NAMED = re.compile(r"(\d{1,2})-([a-z]{3,9})-(\d{2,4})$")
_MONTH_NAMED = re.compile(r"([a-z]{3,9})-(\d{1,2})-(\d{4})$")
_YEAR_NAMED = re.compile(r"(\d{4})-([a-z]{3,9})-(\d{1,2})$")
CLOCK = re.compile(r"(\d{1,2})[:.h](\d{2})(?::(\d{2}))?$")
CLOCK_ENDS = words_of("HOUR MINUTE HHMM FIXED MERIDIEM _OCLOCK")
"""The terminals in which a clock time may end."""
_QUARTER = re.compile(r"q([1-4])$")
_LENGTH = re.compile(r"(\d+\.\d+)$|(\d)/(\d)$")
_MONTH = re.compile(r"(\d{4})[-/](\d{1,2})$|(\d{1,2})/(\d{4})$")


@dataclass(frozen=True, slots=True)
class TimeToken(Token):
    """A terminal of time.lark with its value; it covers words[first:last]."""

    first: int
    last: int


class DigitReader:
    """Sees the word at `i`, the words around it, the tokens before it; reads what is in digits."""

    def __init__(self, words: list[str], i: int, before: list[TimeToken | None]) -> None:
        self.words, self.i = words, i
        self.before = before
        self.previous = next((t for t in reversed(before) if not t or t.type != "LINK"), None)
        self.word = words[i]

    def _make(self, kind: str, value: object, count: int) -> TimeToken:
        return TimeToken(kind, value, self.i, self.i + count)

    def _at(self, k: int) -> str:
        return self.words[self.i + k] if 0 <= self.i + k < len(self.words) else ""

    def _is(self, *kinds: str) -> bool:
        return self.previous is not None and self.previous.type in kinds

    # -- written with digits -----------------------------------------------------------------

    def _written(self) -> TimeToken | None:
        if self._at(1) in tw.UNITS and (length := _LENGTH.match(self.word)):
            count = float(length[1] or 0) + float(length[2] or 0)
            over = int(length[3]) if length[3] else 1
            return self._make("COUNT", count / over, 1) if over else None
        if match := _ISO.match(self.word):
            year, month, day, hour, minute, second = (int(g) if g else None for g in match.groups())
            if hour is not None:
                return self._make("STAMP", (year, month, day, hour, minute, second or 0), 1)
            return self._make("DATE", ("ymd", year, month, day), 1)
        if match := _NAMED.match(self.word) or _YEAR_NAMED.match(self.word):
            named = tw.MONTH_NUMBER.get(match[2])
            first, last = match[1], match[3]
            in_year, on = (first, last) if len(first) == 4 else (last, first)
            return self._make("DATE", ("ymd", _year(in_year), named, int(on)), 1) if named else None
        if (match := _MONTH_NAMED.match(self.word)) and match[1] in tw.MONTH_NUMBER:
            named, on, in_year = tw.MONTH_NUMBER[match[1]], int(match[2]), int(match[3])
            return self._make("DATE", ("ymd", in_year, named, on), 1)  # feb-14-2025
        if (match := CLOCK.match(self.word)) and int(match[1]) <= 24 and int(match[2]) < 60:
            exact = len(match[1]) == 2 and match[1][0] == "0"
            second = int(match[3] or 0)
            signed = self._at(1) in ("h", "hrs", "hours")  # 18:30 h
            return self._make("HHMM", (int(match[1]), int(match[2]), exact, second), 1 + signed)
        if match and ":" in self.word:
            return self._make("UNPLACED", "no day has such an hour or minute", 1)
        if match := _MONTH.match(self.word):
            year, month = int(match[1] or match[4]), int(match[2] or match[3])
            return self._make("DATE", ("ymd", year, month, None), 1) if 1 <= month <= 12 else None
        if match := _SLASHED.match(self.word):
            year = _year(match[3]) if match[3] else None
            return self._make("DATE", ("slashed", year, int(match[1]), int(match[2])), 1)
        if match := _QUARTER.match(self.word):
            dated = self._at(-1) in _LEADS_QUARTER or self._at(1)[:2] in ("19", "20")
            noun = is_open(self._at(1)) and self._at(1) not in ("last", "this")
            return self._make("QUARTER", int(match[1]), 1) if dated and not noun else None
        return self._dashed()

    def _dashed(self) -> TimeToken | None:
        """Read 4-22 as a date where a day is due: on 4-22; elsewhere it is a range."""
        second = self._at(2)
        if self._at(-1) != "on" or self._at(1) != "-" or self._at(3) in tw.MONTH_NUMBER:
            return None
        if not (self.word.isdecimal() and second.isdecimal()) or self._meridiem_at(3):
            return None
        first, last = int(self.word), int(second)
        fits = 1 <= min(first, last) <= 12 and max(first, last) <= 31
        return self._make("DATE", ("slashed", None, first, last), 3) if fits else None

    def _meridiem_at(self, k: int) -> bool:
        compact = self._at(k).replace(".", "").replace(" ", "")
        return compact in ("am", "pm") or (compact in ("a", "p") and self._at(k + 1) == "m")


_LEADS_QUARTER = words_of("in during since of until till before after from to between and last by")


def _year(text: str) -> int:
    value = int(text)
    if value >= 100:
        return value
    return 2000 + value if value < 70 else 1900 + value
