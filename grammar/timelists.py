"""Times in a list: on monday, tuesday or friday; each is a time of its own."""

from __future__ import annotations

from grammar import numbers
from grammar import timewords as tw
from grammar.timedigits import DigitReader

_JOINTS = ("and", "or")


class ListReader(DigitReader):
    """Sees whether the word at `i` joins, or is joined to, a time of the same kind."""

    def _listed(self, *kinds: str) -> bool:
        """Whether `and`, `or` or the comma of a list joins this word to a token of `kinds`."""
        if self._at(-1) not in (*_JOINTS, ","):
            return False
        before = self.before[-2] if len(self.before) > 1 and self.before[-1] is None else None
        return before is not None and before.type in kinds

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


_KINDS = {"WEEKDAY": "weekday", "MONTH": "month", "YEAR": "year", "ORD": "day"}
