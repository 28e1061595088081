"""How times are joined: in a list (on monday, tuesday or friday), or by from and its end."""

from __future__ import annotations

import itertools

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.timedigits import CLOCK_ENDS, DigitReader

_JOINTS = ("and", "or")


class JointReader(DigitReader):
    """Sees what the word at `i` joins, or is joined to."""

    def _listed(self, *kinds: str) -> bool:
        """Whether `and`, `or` or the comma of a list joins this word to a token of `kinds`."""
        if self._at(-1) not in (*_JOINTS, ","):
            return False
        before = self.before[-2] if len(self.before) > 1 and self.before[-1] is None else None
        return before is not None and before.type in kinds

    def _joins(self, kind: str, length: int) -> bool:
        """Whether `or` joins counts, `ish` ends a clock time, `before last` a day or its part."""
        match kind:
            case "_OR":
                counted = (
                    numbers.cardinal(self.words, self.i + length) if self._at(length) else None
                )
                return self._is("UNIT") and counted is not None
            case "_ISH":
                return self._is(*CLOCK_ENDS)
            case "_BUT_ONE":  # last tuesday but one
                led = self.before[-2] if len(self.before) > 1 else None
                return led is not None and led.type == "_LAST"
        return self._is("WEEKDAY", "PART")

    def _parts_list(self) -> bool:
        """Whether a comma parts two days, months or years of a list that `and` or `or` ends."""
        kind = self.previous.type if self.word == "," and self.previous is not None else ""
        named = _KINDS.get(kind)
        if named is None or not self._names_one(1, named):
            return False
        ends = (k for k in range(2, len(self.words) - self.i) if self._at(k) in _JOINTS)
        return self._names_one(next(ends, 0) + 1, named)

    def _names_one(self, k: int, named: str) -> bool:
        """Whether a weekday, a month, a day of the month or a year stands at `k`."""
        while self._at(k) in ("on", "in", "the", "at"):
            k += 1
        said = self._at(k)
        match named:
            case "weekday":
                return said in tw.WEEKDAY_NUMBER
            case "month":
                return said in tw.MONTH_NUMBER
            case "year":
                return said.isdecimal() and len(said) == 4
        number = numbers.ordinal(self.words, self.i + k) if said else None
        return number is not None and self._at(k + number[1]) not in tw.MONTH_NUMBER

    def _from_then(self) -> bool:
        """Whether `from` and a day tell which things are meant: show me cups from yesterday.

        Beside a verb of the past, or with an end, `from` is the beginning of a time.
        """
        rest = self.words[self.i + 1 :]
        verbs = _PAST.intersection(self.words[: self.i])
        if verbs or not is_open(self._at(-1)) or self._time_word(self._at(-1)) or not rest:
            return False
        ends = any(
            word in _CLOSES_FROM or (word == "to" and before not in _NEXT_TO)
            for before, word in itertools.pairwise(["", *rest])
        )
        then = rest[1] if rest[0] == "the" and len(rest) > 1 else rest[0]
        return not ends and rest[-1] != "on" and (then in _THEN or "ago" in rest)

    def _meal_bounds(self) -> bool:
        """Whether a meal begins or ends an interval: between breakfast and lunch, from 8 to tea."""
        if self._is("_AND", "_TO"):
            return len(self.before) > 1 and self.before[-2] is not None
        other = self._at(2)
        timed = other in tw.PARTS or other in tw.FIXED_CLOCKS or other[:1].isdecimal()
        joined = self._at(1) in ("and", "to", "until", "till")
        return self._is("_BETWEEN", "_FROM") and joined and (timed or other in numbers.CARDINALS)

    def _open(self, opens: str, closes: str) -> bool:
        """Whether an `opens` token still waits for its `closes`."""
        depth = 0
        for token in self.before:
            if token is not None:
                depth += (token.type == opens) - (token.type == closes)
        return depth > 0

    def _time_word(self, word: str) -> bool:
        timed = word in tw.PARTS or word in tw.WEEKDAY_NUMBER or word in tw.MONTH_NUMBER
        return timed or word in _TIMELY


_KINDS = {"WEEKDAY": "weekday", "MONTH": "month", "YEAR": "year", "ORD": "day"}
_PAST = words_of("was were been did do does have has had moved changed gone")
_CLOSES_FROM = words_of("until till til through thru - onward onwards forward and")
_NEXT_TO = words_of("next close left right nearest closest")
_THEN = frozenset(
    (
        "yesterday",
        "today",
        "tonight",
        "earlier",
        "last",
        "past",
        "previous",
        "weekend",
        "this",
        *tw.WEEKDAYS,
        *tw.MONTHS,
    )
)
_TIMELY = ("today", "yesterday", "tonight", "ago", "am", "pm", "sharp", "ish", "earlier", "later")
