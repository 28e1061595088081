"""Numbers of a spoken time, typed by their neighbours: hours, minutes, days, years, counts."""

from __future__ import annotations

from grammar import numbers
from grammar import timewords as tw
from grammar.closed import is_open, words_of
from grammar.timedigits import CLOCK, TimeToken
from grammar.timejoints import JointReader

_BEFORE_HOUR_SIGN = words_of("at from between and to until till since before by -")
_AGO = ("ago", "earlier", "back")
_HOURS = ("hours", "hrs")


class NumberReader(JointReader):
    """Reads the numbers of a spoken time by their neighbours."""

    def _meridiem(self) -> TimeToken | None:
        """a.m., p m, am; and "in the morning" after a clock stays a part of the day."""
        if not self._is("HOUR", "MINUTE", "HHMM", "_OCLOCK", "FIXED"):
            return None
        compact = self.word.replace(".", "").replace(" ", "")
        if compact in ("am", "pm"):
            return self._make("MERIDIEM", compact, 1)
        if compact in ("a", "p") and self._at(1) == "m":
            return self._make("MERIDIEM", compact + "m", 2)
        return None

    # -- minutes past and to -----------------------------------------------------------------

    def _recurs(self, k: int) -> bool:
        """Whether a weekday or part of the day, and ago, stand at `k`: two mondays ago."""
        name = self._at(k).removesuffix("s")
        named = name in tw.WEEKDAY_NUMBER or name in tw.PARTS
        return named and self._at(k + 1) in ("ago", "back")

    def _clock_minutes(self) -> TimeToken | None:
        """quarter, half, ten (minutes) before past / to / after, and the word itself after it."""
        if self.word == "half" and self._half_hour():
            return self._make("_HALF_OF", 0, 1)
        if self._is("CMIN"):
            if self.word in ("past", "after"):
                return self._make("_CPAST", 0, 1)
            if self.word in ("to", "till", "til", "before", "of"):
                return self._make("_CTO", 0, 1)
        skip = 1 if self.word in ("a", "the") else 0
        word = self._at(skip)
        exact = False
        if word in ("quarter", "half"):
            count, value = 1, 15 if word == "quarter" else 30
        elif word in ("three", "3") and self._at(skip + 1) in ("quarters", "quarter"):
            count, value = 2, 45
        else:
            number = numbers.cardinal(self.words, self.i + skip) if word else None
            day_due = self._is("MONTH_OF") and not self._dated_month()
            minute_due = bool(self.before) and self._is("HOUR") and self.previous is self.before[-1]
            if number is None or not 0 < number[0] < 60 or skip or day_due or minute_due:
                return None
            value, count = number
        count += skip
        if self._at(count) in ("minutes", "minute", "mins", "min"):
            count, exact = count + 1, True
        return self._minutes(value, count) if self._turns(count, value, exact=exact) else None

    def _half_hour(self) -> bool:
        """Whether an hour follows `half` at once: half eight, which is half past eight."""
        number = numbers.cardinal(self.words, self.i + 1) if self._at(1) else None
        if number is None or not 1 <= number[0] <= 12:
            return False
        following = self._at(1 + number[1])
        introduced = self._at(-1) in tw.INTRODUCES_HOUR or self.previous is not None
        alone = (
            following == ""
            or self._time_word(following)
            or following in (*tw.LINKS, "this", "last")
        )
        return following not in tw.UNITS and (introduced or alone) and not self._noun(following)

    def _minutes(self, value: int, count: int) -> TimeToken:
        return self._make("CMIN", value, count)

    def _turns(self, count: int, value: int, *, exact: bool) -> bool:
        """Whether `past` or `to` at `count`, and an hour after it, make these minutes."""
        turn, hour = self._at(count), self._at(count + 1)
        if turn not in ("past", "to", "after", "before", "till", "til", "of"):
            return False
        number = numbers.cardinal(self.words, self.i + count + 1) if hour else None
        is_hour = hour in tw.FIXED_CLOCKS or (number is not None and 0 < number[0] <= 12)
        if not is_hour:
            return False
        if turn == "past":
            return True
        if turn in _ENDS_RANGE and self._open("_FROM", "_TO"):
            # "from ten to three" is a range unless a second `to` follows it
            rest = self.words[self.i + count + 2 :]
            return value == 15 or any(w in _ENDS_RANGE for w in rest)
        if turn in ("of", "before", "till", "til", "after"):
            return value in (5, 10, 15, 20, 25, 30)
        if value % 5 == 0 or self._at(-1) == "at":
            return True
        return exact  # nine to five is a range

    # -- numbers -----------------------------------------------------------------------------

    def _year(self) -> TimeToken | None:
        value, count = self._year_value()
        if not value:
            return None
        previous = self._at(-1)
        if self._is("EDGE", "QUARTER") or self._listed("YEAR"):
            return self._make("YEAR", value, count)
        if self._is("MONTH", "DAY_AFTER", "MONTH_OF", "HOLIDAY", "SEASON", "ORD", "DAY_BEFORE"):
            return self._make("YEAR_OF", value, count)
        if previous in ("in", "of", "since", "during", "before", "after", "until", "from", "to",
                        "year", "between", "and", "or", "till", "by", "through"):  # fmt: skip
            if count > 1 and previous not in ("in", "of", "since", "during", "year"):
                return None
            return self._make("YEAR", value, count)
        return None

    def _year_value(self) -> tuple[int, int]:
        """Return (year, words): 2015, twenty fifteen, nineteen oh five, two thousand (and) six."""
        word = self.word
        if word.isdecimal() and len(word) == 4 and 1900 <= int(word) <= 2099:
            return int(word), 1
        if word == "two" and self._at(1) == "thousand":
            skip = 3 if self._at(2) == "and" else 2
            rest = numbers.cardinal(self.words, self.i + skip) if self._at(skip) else None
            return (2000 + rest[0], skip + rest[1]) if rest and rest[0] < 100 else (2000, 2)
        if word not in ("nineteen", "twenty", "eighteen"):
            return 0, 0
        century = numbers.CARDINALS[word] * 100
        if self._at(1) in ("oh", "o", "0") and numbers.CARDINALS.get(self._at(2), 10) < 10:
            return century + numbers.CARDINALS[self._at(2)], 3
        if self._at(1) == "hundred":
            return century, 2
        rest = numbers.cardinal(self.words, self.i + 1) if self._at(1) else None
        if rest is None or not 10 <= rest[0] <= 99 or self._at(1).isdecimal():
            return 0, 0
        following = self._at(1 + rest[1])
        if (
            self._is("MONTH_OF") and numbers.cardinal(self.words, self.i + 1 + rest[1] - 1 + 1)
            if following
            else False
        ):
            return 0, 0  # "may twenty twenty twelve": the first twenty is the day
        return century + rest[0], 1 + rest[1]

    def _ordinal(self) -> TimeToken | None:
        number = numbers.ordinal(self.words, self.i)
        if number is None or not 1 <= number[0] <= 31:
            return None
        value, count = number
        following = self._at(count)
        month = following if following != "of" else self._at(count + 1)
        if month in tw.MONTH_NUMBER:
            return self._make("DAY_BEFORE", value, count)
        if following in ("day", "week", "weekend", "month", *tw.WEEKDAY_NUMBER) and self._at(
            count + 1
        ) in ("of", "in"):
            return self._make("NTH", value, count)
        if following in ("quarter", "half") and self._year_at(count + 1):
            return self._make("NTH", value, count)
        if self._is("MONTH_OF"):
            return self._make("DAY_AFTER", value, count)
        leads = self._at(-1) in tw.LEADS_DAY and self.word[:1].isdecimal()
        leads = leads or self._listed("DAY_AFTER", "ORD") or self._at(-1) == "the"
        if not leads and not self._is("WEEKDAY", "_AND", "_TO"):
            return None
        return None if self._noun(following) else self._make("ORD", value, count)

    def _year_at(self, k: int) -> bool:
        """Whether a year or `of last year` stands at `k`, or nothing goes on: the first quarter."""
        while self._at(k) in ("of", "in", "the", "year"):
            k += 1
        if self._at(k) in ("last", "this", ""):
            return True
        after = type(self)(self.words, self.i + k, self.before)
        return bool(after._year_value()[0])

    def _year_named(self, k: int) -> bool:
        """Whether a year in digits, or `of last year`, stands at `k`."""
        following = [self._at(k + n) for n in range(3)]
        in_digits = following[0][:2] in ("19", "20") and len(following[0]) == 4
        return in_digits or following == ["of", "last", "year"]

    def _noun(self, word: str) -> bool:
        """Whether a word may go on a noun phrase: open, and no word of time."""
        return is_open(word) and not self._time_word(word)

    def _number(self) -> TimeToken | None:
        if self.word in ("o", "oh", "zero") and self._at(2) == "hundred":
            hour = numbers.CARDINALS.get(self._at(1), 10)
            whole = 3 + (self._at(3) in ("hours", "hour"))
            return self._make("HHMM", (hour, 0, True, 0), whole) if hour < 10 else None
        if self.word == "o" or self.word == "oh":
            return None
        number = numbers.cardinal(self.words, self.i)
        if number is None:
            return None
        value, count = number
        signed = self._hour_signed(value, count)
        if signed is not None:
            return signed
        if self._at(count) == "-" and self._ranges(count + 1) and value <= 31:
            return self._make("HOUR", value, count)
        return (
            self._day_number(value, count)
            or self._count(value, count)
            or self._minute(value, count)
            or self._hour(value, count)
        )

    def _hour_signed(self, value: int, count: int) -> TimeToken | None:
        """Read a clock time by the sign after its hour: at 14 h, at 9 h 15, at 21 hours.

        Hours in words are a clock time after `at` alone: since 3 hours is a length.
        """
        sign, before = self._at(count), self._at(-1)
        clock = before in _BEFORE_HOUR_SIGN if sign == "h" else before == "at" and sign in _HOURS
        if value > 24 or not clock or self._at(count + 1) in _AGO:
            return None
        minute = numbers.cardinal(self.words, self.i + count + 1)
        if minute is None or minute[0] >= 60:
            return self._make("HHMM", (value, 0, True, 0), count + 1)
        return self._make("HHMM", (value, minute[0], True, 0), count + 1 + minute[1])

    def _ranges(self, k: int) -> bool:
        """Whether what ends a range stands at `k`, after a dash: `9-11 am`, `3-5 may`."""
        number = numbers.cardinal(self.words, self.i + k) if self._at(k) else None
        if CLOCK.match(self._at(k)):
            return self._meridiem_at(k + 1)
        if number is not None and self._at(k + number[1]) in tw.MONTH_NUMBER:
            return True
        return number is not None and self._at(k + number[1]) in (
            "am",
            "pm",
            "a.m.",
            "p.m.",
            "a",
            "p",
        )

    def _day_number(self, value: int, count: int) -> TimeToken | None:
        if not 1 <= value <= 31:
            return None
        skip = 1 if self._at(count) == "of" else 0
        following = self._at(count + skip)
        if following in tw.MONTH_NUMBER:
            day_after = skip and self._day_only(count + 2)  # from 5 to 6 of april 22
            return None if day_after else self._make("DAY_BEFORE", value, count)
        if self._is("MONTH_OF") and not self._dated_month() and not self._meridiem_at(count):
            return self._make("DAY_AFTER", value, count)
        return None

    def _day_only(self, k: int) -> bool:
        """Whether a day of the month, and no year, stands at `k`."""
        number = numbers.cardinal(self.words, self.i + k) if self._at(k) else None
        return number is not None and 1 <= number[0] <= 31

    def _dated_month(self) -> bool:
        """Whether the month before has its day already: `3 november at 2`."""
        kept = [t for t in self.before if t is None or t.type != "LINK"]
        return len(kept) > 1 and kept[-2] is not None and kept[-2].type == "DAY_BEFORE"

    def _count(self, value: int, count: int) -> TimeToken | None:
        following = self._at(count)
        if following == "more":
            following = self._at(count + 1)
        some_day = following == "day" or following in tw.PARTS
        if value == 1 and some_day and self._at(count + 1) in ("last", "this", "in"):
            return self._make("LINK", "one day", count + 1)
        either = self._either(value, count)
        if either is not None:
            return either
        if self._recurs(count) or (self._is("_OR") and self._at(count) == "ago"):
            return self._make("COUNT", value, count)
        if following in tw.UNITS:
            if value >= 100 and following == "hours":
                return None
            return self._make("COUNT", value, count)
        if [following, self._at(count + 1), self._at(count + 2)] == ["and", "a", "half"]:
            return self._make("COUNT", value + 0.5, count + 3)
        if following in ("quarters", "quarter") and self._at(count + 1) == "of":
            return self._make("COUNT", value / 4, count + 3)
        return None

    def _either(self, value: float, count: int) -> TimeToken | None:
        """Read the first of two counts: two or three days ago, an hour or two ago."""
        before_unit = self._at(count) in tw.UNITS
        k = count + before_unit
        second = numbers.cardinal(self.words, self.i + k + 1) if self._at(k) == "or" else None
        if second is None or not self._at(k + 1):
            return None
        after = k + 1 + second[1]
        if before_unit:
            return self._make("COUNT_OR", value, count) if self._at(after) == "ago" else None
        told = self._at(after) in tw.UNITS and self._at(after + 1) == "ago"
        return self._make("COUNT_OR", value, count + 1) if told else None

    def _minute(self, value: int, count: int) -> TimeToken | None:
        if not self._is("HOUR") or value >= 60:
            return None
        if value >= 10 or len(self.word) == 2:
            return self._make("MINUTE", value, count)
        spoken = not self.word.isdecimal() and not self.words[self.i - 1].isdecimal()
        alone = not self._noun(self._at(count)) and self._at(count) not in tw.UNITS
        return self._make("MINUTE", value, count) if spoken and alone and value else None

    def _hour(self, value: int, count: int) -> TimeToken | None:
        following = self._at(count)
        previous = self._at(-1)
        introduced = previous in tw.INTRODUCES_HOUR
        if previous in ("and", "to", "-") and self.previous is None:
            introduced = False  # the cup and two bowls
        introduced = introduced or self._ranges_to(count)
        if value >= 100:
            named = previous == "at" or following == "hours"
            year = 1900 <= value < 2100
            named = named or (previous in _BOUNDING and len(self.word) == 4 and not year)
            if named and value % 100 < 60 and value < 2400:
                digits = (value // 100, value % 100, True, 0)
                return self._make("HHMM", digits, count + (following == "hours"))
            return None
        if value > 24 or (following == "of" and self._at(count + 1) not in numbers.CARDINALS):
            return None  # exactly one of the cups
        if following == "hundred":
            whole = count + 1 + (self._at(count + 1) in ("hours", "hour"))
            return self._make("HHMM", (value, 0, True, 0), whole)
        second = numbers.cardinal(self.words, self.i + count) if following else None
        two = second is not None and second[0] < 60
        compact = following.replace(".", "").replace(" ", "")
        spoken = (
            compact in ("am", "pm", "oclock", "o'clock", "noon", "midnight", "ish")
            or (compact in ("a", "p", "o") and self._at(count + 1) in ("m", "clock"))
            or self._meridiem_after(count, second)
            or self._part_after(count)
        )
        if following in ("noon", "midnight") and value == 12:
            return self._make("FIXED", tw.FIXED_CLOCKS[following], count + 1)
        if spoken:
            return self._make("HOUR", value, count)
        plain = not self._noun(following)
        introduced = introduced or self._is("_CPAST", "_CTO", "_HALF_OF")
        near_day = self._is("WEEKDAY", "DAYS", "PARTDAY", "PART") and (two or plain)
        if (introduced and (plain or two)) or near_day:
            return self._make("HOUR", value, count)
        if following in ("oh", "o") and introduced:
            return self._make("HOUR", value, count)
        return None

    def _part_after(self, k: int) -> bool:
        """Whether a part of the day stands at `k`: three this afternoon, eight in the morning."""
        if self._at(k) == "in" and self._at(k + 1) == "the":
            return self._at(k + 2) in tw.PARTS
        return self._at(k) in ("this", "yesterday") and self._at(k + 1) in tw.PARTS

    def _ranges_to(self, k: int) -> bool:
        """Whether another hour follows at `k`: nine to five."""
        if self._at(k) not in _ENDS_RANGE:
            return False
        if self._at(k + 1) in tw.FIXED_CLOCKS:
            return True
        number = numbers.cardinal(self.words, self.i + k + 1) if self._at(k + 1) else None
        return (
            number is not None
            and 1 <= number[0] <= 12
            and not self._noun(self._at(k + 1 + number[1]))
        )

    def _meridiem_after(self, count: int, second: tuple[int, int] | None) -> bool:
        if second is None:
            return False
        k = count + second[1]
        compact = self._at(k).replace(".", "").replace(" ", "")
        return compact in ("am", "pm") or (compact in ("a", "p") and self._at(k + 1) == "m")


_BOUNDING = words_of("between and from to before after since until till by -")
_ENDS_RANGE = ("to", "until", "till", "til")
