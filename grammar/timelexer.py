"""Words into the terminals of time.lark: each word is typed by its neighbours, none by guessing."""

from __future__ import annotations

import re
from dataclasses import replace

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.timedigits import CLOCK, CLOCK_ENDS, TimeToken
from grammar.unplaced import UnplacedReader

_MAX_PHRASE = max(len(phrase.split()) for phrase in (*tw.PHRASES, *tw.HOLIDAYS))

_DECADE = re.compile(r"(\d{3}0)s?$")

_LEADS_PART = words_of(
    "the at in this last early late by yesterday that of on all during evening every before after "
    "since until around each whole entire"
)
_LEADS_MEAL = words_of("at before after since until during around by over")
_LEADS_THE_PART = words_of("in during since of through at before after until all for over")
_LEADS_SEASON = words_of("the in last this since during past previous")
_COUNTED_WITHIN = words_of("minute hour day week weekend month")
_LEADS_SHY = words_of(
    "on in last this since until before after by from between to and of during early late till "
    "through every past previous mid -"
)
_BEFORE_PART = words_of(
    "WEEKDAY DAYS DATE DAY_AFTER MONTH_OF MERIDIEM HOUR MINUTE ORD EDGE _AGO HOLIDAY YEAR_OF "
    "_OCLOCK _AND _TO COUNT"
)


def tokenise(words: list[str]) -> list[TimeToken | None]:
    """Return the time tokens of the words in order; None stands for a word of no time."""
    found: list[TimeToken | None] = []
    i = 0
    while i < len(words):
        token = _Reader(words, i, found).token()
        if token is not None and token.type == "_ISH":
            _approximate(found, token.last)
        else:
            found.append(token)
        i = token.last if token else i + 1
    return found


def _approximate(found: list[TimeToken | None], last: int) -> None:
    """Put `around` before the clock time that ends in -ish, at `last`: eightish, around eight."""
    if found and (ends := found[-1]) is not None:
        found[-1] = replace(ends, last=last)
    k = len(found)
    while k and (token := found[k - 1]) is not None and token.type in _CLOCK_TIMES:
        k -= 1
    first = found[k]
    assert first is not None  # _ISH is read after a clock time alone
    before = next((t for t in reversed(found[:k]) if t is None or t.type != "LINK"), None)
    if before is None or before.type != "_AROUND":
        found.insert(k, TimeToken("_AROUND", 0, first.first, first.first))


_SHORT = ("second", "minute", "hour")
_JOINING = ("_OR", "_ISH", "_BEFORE_LAST", "_BUT_ONE")
_DAYS = words_of("WEEKDAY DAYS ORD DATE DAY_AFTER MONTH MONTH_OF HOLIDAY")
_CLOCK_TIMES = CLOCK_ENDS | words_of("CMIN _CPAST _CTO _HALF_OF")


class _Reader(UnplacedReader):
    """Types the word at `i`, seeing the words around it and the tokens before it."""

    def token(self) -> TimeToken | None:
        """Return the token at `i`, or None."""
        for read in (
            self._unplaced,
            self._written,
            self._comparative,
            self._beyond,
            self._meridiem,
            self._clock_minutes,
            self._past_or_last,
            self._year,
            self._ordinal,
            self._number,
            self._phrase,
            self._name,
        ):
            token = read()
            if token is not None:
                return token
        narrowed = self.word == "but" and self.previous and self._at(1) in ("before", "after")
        if (
            self.word in tw.LINKS and not self._parts_list()
        ) or narrowed:  # after five but before eight
            return self._make("LINK", self.word, 1)
        return None

    def _comparative(self) -> TimeToken | None:
        """Pass over `earlier` and `later` before a time: earlier this morning, later on friday."""
        if self.word not in ("earlier", "later") or self._is("UNIT", "MORE"):
            return None
        k = 1
        while self._at(k) in ("on", "in", "the"):
            k += 1
        timed = self._at(k) in ("this", "last", "yesterday", "today", "tonight")
        timed = timed or self._at(k) in tw.WEEKDAY_NUMBER or (k > 1 and self._at(k) in tw.PARTS)
        return self._make("LINK", self.word, 1) if timed else None

    def _beyond(self) -> TimeToken | None:
        """Take over and under a length of time that is gone: over an hour ago, as more than it."""
        if self.word not in ("over", "under") or not self._length_follows(1):
            return None
        if "ago" not in self.words[self.i + 2 : self.i + 6]:
            return None
        return self._make("_BEFORE" if self.word == "over" else "_AFTER", 0, 1)

    # -- past and last before a length of time ------------------------------------------------

    def _past_or_last(self) -> TimeToken | None:
        if self.word == "this":  # this past hour, this hour
            k = 1 + (self._at(1) in ("past", "last"))
            short = tw.UNITS.get(self._at(k)) in _SHORT and not is_open(self._at(k + 1))
            return self._make("_LASTN1", 0, k) if short else None
        if self.word not in ("past", "last", "previous", "preceding", "recent"):
            return None
        following = self._at(1)
        if not following and self._is("WEEKDAY"):
            return self._make("LINK", self.word, 1)  # on monday last, on sunday past
        counted = following in _COUNTED_WITHIN or following in tw.WEEKDAY_NUMBER
        inside = self._at(2) == "of"
        if self.word == "last" and counted and inside:
            return self._make("NTH", -1, 1)
        if following in tw.UNITS and following != "night":
            unit = tw.UNITS[following]
            article = self._at(-1) in ("the", "this") and self._at(-2) != "of"
            if unit in _SHORT or self.word == "past" or article:
                return self._make("_LASTN1" if following != "weekend" else "_LAST", 0, 1)
            return None
        if self._length_follows(1):
            return self._make("_LASTN", 0, 1)
        return None

    def _length_follows(self, k: int) -> bool:
        """Whether a number and a unit of time stand at `k`."""
        joined = " ".join(self.words[self.i + k : self.i + k + 5])
        for phrase, (kind, _) in tw.PHRASES.items():
            if kind == "COUNT" and joined.startswith(phrase + " "):
                rest = joined[len(phrase) + 1 :].split(" ")
                if rest and rest[0] in tw.UNITS:
                    return True
        number = numbers.cardinal(self.words, self.i + k) if self._at(k) else None
        if number is None:
            return False
        k += number[1]
        half = [self._at(k + n) for n in range(3)] == ["and", "a", "half"]
        return self._at(k + 3 * half) in tw.UNITS

    # -- phrases and names ----------------------------------------------------------------------

    def _phrase(self) -> TimeToken | None:
        for length in range(min(_MAX_PHRASE, len(self.words) - self.i), 0, -1):
            said = " ".join(self.words[self.i : self.i + length])
            if said in tw.HOLIDAYS:
                return self._make("HOLIDAY", tw.HOLIDAYS[said], length)
            entry = tw.PHRASES.get(said)
            if entry is None:
                continue
            kind, value = entry
            if kind == "COUNT" and self._at(length) not in tw.UNITS and not self._recurs(length):
                continue
            if kind in ("_AGO", "MORE") and not self._lasts():
                continue
            if kind in _JOINING and not self._joins(kind, length):
                continue
            if kind == "WEEKEND" and self._is("NTH"):
                continue
            if kind == "SAME" and not (self._day_named(length) or self._is("DAYS", "WEEKDAY")):
                continue
            named = self._at(length) in tw.WEEKDAY_NUMBER or self._holiday_at(length)
            if said.endswith(" before last") and named:
                continue  # the day before last friday
            if kind == "EDGE" and not self._edges(length):
                continue
            if kind == "_ONWARD" and not self._opens_only(length):
                continue
            if kind == "_DAY_EARLIER" and self._listed("DAYS") and not self._dated_at(length):
                return self._make("DAYS", 2, length)  # yesterday or the day before
            if kind in ("_DAY_EARLIER", "_DAY_LATER", "SPAN_BEFORE", "WHOLE") and (
                self._is("NTH", "_LAST", "COUNT") or not self._dated_at(length)
            ):
                continue
            either = self._either(1, length) if kind == "COUNT" and value == 1 else None
            return either or self._retyped(kind, value, length)
        if self.word in ("oh", "o") and self._is("HOUR"):
            unit = numbers.CARDINALS.get(self._at(1), 10)
            return self._make("MINUTE", unit, 2) if unit < 10 else None
        return None

    def _lasts(self) -> bool:
        """Whether a length of time, or a count of weekdays, has just been said."""
        if self._is("WEEKDAY", "PART", "COUNT"):
            before = [t.type if t else "" for t in self.before if t is None or t.type != "LINK"]
            return before[-1] == "COUNT" if before[-1:] == ["COUNT"] else before[-2:-1] == ["COUNT"]
        return self._is("UNIT", "MORE")

    def _day_named(self, k: int) -> bool:
        """Whether a day, or last week, stands at `k`: this time yesterday."""
        k += self._at(k) == "on"
        following = self._at(k)
        return following in ("yesterday", "last") or following in tw.WEEKDAY_NUMBER

    def _opens_only(self, length: int) -> bool:
        """Whether `on` ends what `from` began: from monday on."""
        following = self._at(length)
        timely = self._time_word(following) or following[:1].isdecimal() or following == "the"
        leads = timely and self.words[self.i + length - 1] == "on"  # from noon on friday
        named = not (self.previous is None or self.previous.type.startswith("_"))
        return named and not leads and self._open("_FROM", "_TO")

    def _dated_at(self, k: int) -> bool:
        """Whether a date stands at `k`: the week of the 15th, of may 3."""
        while self._at(k) in ("the", "of"):
            k += 1
        named = k + (self._at(k) == "last")
        return (
            self._at(k)[:1].isdecimal()
            or self._at(k) in tw.MONTH_NUMBER
            or bool(self._at(k) and numbers.ordinal(self.words, self.i + k))
            or self._at(named) in tw.WEEKDAY_NUMBER
            or self._holiday_at(named)
        )

    def _holiday_at(self, k: int) -> bool:
        start = self.i + k
        return any(" ".join(self.words[start : start + n]) in tw.HOLIDAYS for n in (1, 2, 3))

    def _edges(self, length: int) -> bool:
        following = self._at(length)
        return (
            following in tw.PARTS
            or following in tw.MONTH_NUMBER
            or following in ("this", "last", "the", "in", "on", "yesterday", "today")
            or following in tw.WEEKDAY_NUMBER
            or self._is("DAYS", "PARTDAY", "WEEKDAY")
            or following.isdecimal()
        )

    def _retyped(self, kind: str, value: object, length: int) -> TimeToken | None:
        following = self._at(length)
        if kind == "_BEFORE" and self._is("UNIT") and self._counted():
            return self._make("_EARLIER_THAN", 0, length)
        if kind == "_AFTER" and self._is("UNIT") and self._counted():
            return self._make("_LATER_THAN", 0, length)
        if kind == "_AND" and not self._open("_BETWEEN", "_AND"):
            joins = (
                self._is("UNIT") and following in (*numbers.CARDINALS, "a", "an")
            ) or following.isdecimal()
            return self._make("LINK", "and", length) if joins and self._is("UNIT") else None
        if kind == "_UNTIL" and (self._open("_FROM", "_TO") or self._ends_range(length)):
            return self._make("_TO", 0, length)
        if kind == "_FROM" and self._from_then():
            return self._make("LINK", "from", length)
        if kind == "_TO" and self._open("_BETWEEN", "_AND"):
            return self._make("_AND", 0, length)
        if kind == "_TO" and self.word == "-" and self._joins_clock(length):
            return self._make("LINK", "-", length)
        if kind == "_TO" and not (self.previous and self.previous.type != "LINK"):
            return None
        return self._make(kind, value, length)

    def _ends_range(self, k: int) -> bool:
        """Whether `until` stands between two days or clock times: monday till wednesday."""
        if self.word == "by" or not self.before or self.before[-1] is None:
            return False
        following = self._at(k)
        dated = self._dated_at(k) and not following.isdecimal()
        if dated or following in ("today", "yesterday"):
            return self._is(*_DAYS, *_CLOCK_TIMES)
        number = numbers.cardinal(self.words, self.i + k) if following else None
        digital = CLOCK.match(following) or following in tw.FIXED_CLOCKS
        return self._is(*_CLOCK_TIMES) and (number is not None or bool(digital))

    def _joins_clock(self, k: int) -> bool:
        """Whether a dash only parts a date from its clock time: 6 jan 2017 - 6:37 am."""
        dated = self._is("YEAR_OF", "DATE", "DAY_AFTER", "MONTH_OF", "DAYS", "WEEKDAY")
        if not dated or self._open("_FROM", "_TO"):
            return False
        following = self._at(k)
        return ":" in following or (following.isdecimal() and self._meridiem_at(k + 1))

    def _counted(self) -> bool:
        return (
            len(self.before) > 1 and self.before[-2] is not None and self.before[-2].type == "COUNT"
        )

    def _name(self) -> TimeToken | None:
        word = self.word
        if word in ("quarter", "half") and self._is("NTH"):
            return self._make("UNIT", word, 1)
        if word == "quarter" and self._is("_LAST", "_THIS"):
            return self._make("UNIT", word, 1)
        if word in tw.UNITS and (
            self._is("COUNT", "COUNT_OR", "_LASTN", "_LAST", "_LASTN1", "_THIS", "NTH")
        ):
            back = self._is("COUNT") and self._at(1) in ("ago", "back")
            nights = word in ("night", "nights")
            if nights and (back or self._is("_LAST", "_THIS")):
                return self._make("PART", "night", 1)  # two nights ago
            weekend = word in ("weekend", "weekends")
            if weekend and not self._is("COUNT", "NTH"):
                return self._make("WEEKEND", 0, 1)
            return self._make("UNIT", "weekend" if weekend else tw.UNITS[word], 1)
        if word in tw.UNITS and self._is("EDGE") and self._at(-1) == "the" and word not in tw.PARTS:
            return self._make("CURRENT", tw.UNITS[word], 1)
        if word == "year" and self._at(1).isdecimal() and len(self._at(1)) == 4:
            return self._make("LINK", word, 1)
        if word in tw.FIXED_CLOCKS:
            return self._make("FIXED", tw.FIXED_CLOCKS[word], 1)
        if word in tw.PARTS:
            return self._part(word)
        if word.rstrip("s") in tw.WEEKDAYS or word in tw.WEEKDAY_SHORT or word[:-2] in tw.WEEKDAYS:
            stem = word if word in tw.WEEKDAY_NUMBER else word.rstrip("s").rstrip("'")
            if stem in tw.SHY and not self._timely():
                return None
            return self._make("WEEKDAY", tw.WEEKDAY_NUMBER[stem], 1)
        if word in tw.MONTH_NUMBER:
            return self._month(word)
        year = self._at(1).isdecimal() and len(self._at(1)) == 4
        if word in tw.SEASONS and (self._at(-1) in _LEADS_SEASON or year):
            return None if is_open(self._at(1)) else self._make("SEASON", tw.SEASONS[word], 1)
        if self._at(-1) == "the" and not is_open(self._at(1)):
            if match := _DECADE.match(word):
                return self._make("DECADE", int(match[1]), 1)
            if word in tw.DECADES:
                return self._make("DECADE", tw.DECADES[word], 1)
        return None

    def _part(self, word: str) -> TimeToken | None:
        part = tw.PARTS[word]
        if part in ("lunch", "breakfast", "dinner", "tea", "bedtime", "midday", "day"):
            led = self._at(-1) in _LEADS_MEAL or self._meal_bounds()
            if not led and not (word == "daytime" and self._at(-1) == "the"):
                return None
            return None if self._noun(self._at(1)) else self._make("PART", part, 1)
        if (
            self._listed("PART", "PARTDAY")
            or self._at(-1) in _LEADS_PART
            or self._is(*_BEFORE_PART)
        ):
            following = self._at(1)
            alone = self._at(-1) == "the" and self._at(-2) not in _LEADS_THE_PART
            if alone and self._noun(following):
                return None
            return self._make("PART", part, 1)
        return None

    def _month(self, word: str) -> TimeToken | None:
        day_before = self._is("DAY_BEFORE")
        following = self._at(1) if self._at(1) != "the" else self._at(2)
        day_follows = bool(following) and (self._day_at(1 if self._at(1) != "the" else 2))
        if day_before or day_follows:
            return self._make("MONTH_OF", tw.MONTH_NUMBER[word], 1)
        if word in tw.SHY and not self._timely():
            return None
        if word in tw.SHY and is_open(self._at(1)):
            return None
        return self._make("MONTH", tw.MONTH_NUMBER[word], 1)

    def _day_at(self, k: int) -> bool:
        """Whether a day of the month stands at `k`, and no year in two words."""
        if numbers.ordinal(self.words, self.i + k):
            return True
        number = numbers.cardinal(self.words, self.i + k)
        if number is None or not 1 <= number[0] <= 31:
            return False
        after = _Reader(self.words, self.i + k, self.before)
        year, count = after._year_value()
        if not year:
            return True
        rest = self._at(k + count)
        return bool(rest) and numbers.cardinal(self.words, self.i + k + count) is not None

    def _timely(self) -> bool:
        """Whether a neighbour says that a shy name is a day or a month here."""
        ranges = self._at(1) in ("to", "till", "til", "until", "through", "-")
        if ranges and (self._at(2) in tw.MONTH_NUMBER or self._at(2) in tw.WEEKDAY_NUMBER):
            return True
        named = self._is("NTH", "DAY_BEFORE", "WEEKDAY") or self._year_named(1)
        named = named or (self._at(1) in tw.PARTS and self.word in tw.WEEKDAY_NUMBER)
        return self._at(-1) in _LEADS_SHY or named
