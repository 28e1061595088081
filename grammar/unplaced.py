"""Times that are no one time: every morning, on weekdays, at a quarter past, monday week.

Each is a token that says why, so that it is refused in words and never read as another time.
"""

from __future__ import annotations

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.timedigits import CLOCK_ENDS, TimeToken
from grammar.timenumbers import NumberReader

_RECURS = "it comes more than once; ask for one time"
_NO_HOUR = "it names no hour"
_TO_COME = "it has not come yet"
_OTHER_ZONE = "all times are those of the home; say it without a zone"
_ZONE_LETTERS = words_of("gmt utc pst pdt mst mdt cst cdt est edt bst cet cest")
_ZONES = words_of("pacific mountain central eastern greenwich")
_EACH = words_of("every each")
_BETWEEN_EACH = words_of("other single few second third of these those the couple")
_OFTEN = words_of("hourly daily nightly weekly monthly yearly annually")
_PLURALS = words_of("weekdays workdays weeknights weekends mornings afternoons evenings nights")
_KINDS_OF_DAY = words_of("weekday workday weeknight weekend morning afternoon evening night")
_BEFORE_CLOCK = words_of("at around about by since until")
_WEEKDAYS = frozenset((*tw.WEEKDAY_NUMBER, *(f"{day}s" for day in tw.WEEKDAYS)))
_FIRST = _EACH | _OFTEN | _PLURALS | _KINDS_OF_DAY | _WEEKDAYS | {"today", "tomorrow"}
"""Words that a time which is none, or many, may begin with; a clock's begins after `at`."""
_COUNTS = ("COUNT", "COUNT_OR", "NTH", "_OR", "_LAST", "_LASTN", "_THIS")


class UnplacedReader(NumberReader):
    """Reads what sounds like a time and names none, or many."""

    def _unplaced(self) -> TimeToken | None:
        if self._is(*CLOCK_ENDS) and (length := self._zone()):
            return self._make("UNPLACED", _OTHER_ZONE, length)
        if self.word not in _FIRST and self._at(-1) not in _BEFORE_CLOCK:
            return None
        for why, length in (
            (_RECURS, self._each() or self._plural() or self._often()),
            (_NO_HOUR, self._hourless()),
            (_TO_COME, self._week_on()),
        ):
            if length:
                return self._make("UNPLACED", why, length)
        return None

    def _each(self) -> int:
        """Return the words of `every monday`, `each evening`, `every two hours`; 0 for others."""
        if self.word not in _EACH:
            return 0
        k = 1
        while self._at(k) in _BETWEEN_EACH:
            k += 1
        number = numbers.cardinal(self.words, self.i + k) if self._at(k) else None
        k += number[1] if number is not None else 0
        name = self._at(k)
        timed = name in tw.UNITS or name in tw.PARTS or name in tw.SEASONS
        timed = timed or name in _KINDS_OF_DAY or name in tw.MONTH_NUMBER
        timed = timed or name.removesuffix("s") in tw.WEEKDAY_NUMBER or name in _PLURALS
        timed = timed or name in tw.HOLIDAYS
        if not timed:
            return 0
        k += 1
        while self._at(k) in tw.PARTS:  # every monday morning
            k += 1
        return 0 if self._noun(self._at(k)) else k

    def _plural(self) -> int:
        """Return the words of `weekdays`, `mondays`, `weekday mornings`; 0 for a count of them."""
        day = self.word.removesuffix("s")
        k = 0
        if self.word in _KINDS_OF_DAY or self.word in tw.WEEKDAYS:
            k = int(self._at(1) in _PLURALS)
        several = self._at(k) in _PLURALS or (day != self.word and day in tw.WEEKDAYS)
        counted = self._is(*_COUNTS) or self._at(k + 1) in ("ago", "back")
        return 0 if not several or counted or self._noun(self._at(k + 1)) else k + 1

    def _zone(self) -> int:
        """Return the words of `pst`, `eastern standard time` after a clock time; 0 for others."""
        k = int(self.word in _ZONES)
        k += k and self._at(k) in ("standard", "daylight", "summer")
        named = k and self._at(k) == "time"
        return k + 1 if named else int(self.word in _ZONE_LETTERS)

    def _often(self) -> int:
        """Return 1 for `daily` as an adverb, at the end of what is said; 0 for a daily paper."""
        said = self.word in _OFTEN and self._at(-1) not in _LEADS_NOUN
        return int(said and not self._noun(self._at(1)))

    def _hourless(self) -> int:
        """Return the words of `a quarter past` without its hour, after at or its like."""
        if self._at(-1) not in _BEFORE_CLOCK:
            return 0
        k = int(self.word in ("a", "the"))
        if self._at(k) in ("quarter", "half"):
            count = 1
        else:
            number = numbers.cardinal(self.words, self.i) if not k else None
            if number is None or not 0 < number[0] < 60:
                return 0
            count = number[1]
        k += count
        k += self._at(k) in ("minutes", "minute", "mins", "min")
        if self._at(k) not in ("past", "to"):
            return 0
        if [self._at(k + 1), self._at(k + 2)] == ["the", "hour"]:
            return k + 3
        following = self._at(k + 1)
        ends = not following or self._time_word(following) or following in ("on", "in", "this")
        return k + 1 if ends else 0

    def _week_on(self) -> int:
        """Return the words of `monday week`, the week after the coming monday; 0 for others."""
        if self.word not in tw.WEEKDAY_NUMBER and self.word not in ("today", "tomorrow"):
            return 0
        following = self._at(2)
        ends = following not in ("ago", "back", "before", "after") and not is_open(following)
        return 2 if self._at(1) == "week" and ends else 0


_LEADS_NOUN = words_of("the a an my your our his her their this that which what")
