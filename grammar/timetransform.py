"""The rules of time.lark as forms of time; each method bears its rule's name and keeps no state."""

from __future__ import annotations

from typing import Any

from grammar.lalr import Token
from grammar.timeforms import (
    Ago,
    Bound,
    Calendar,
    Clock,
    Date,
    Days,
    Decade,
    Edge,
    Holiday,
    Length,
    Now,
    Nth,
    Part,
    PartAgo,
    PartDay,
    Piece,
    Pieces,
    SameTime,
    Season,
    SpokenTime,
    Stamp,
    Unplaced,
    Weekday,
    Weekend,
    Whole,
)


class TimeForms:
    """The rules of time.lark; each method bears its rule's name."""

    def at(self, *pieces: Piece) -> SpokenTime:
        """start: piece+."""
        return SpokenTime(pieces)

    def range(self, first: Pieces, second: Pieces) -> SpokenTime:
        """start: side _TO side."""
        return SpokenTime((), (Bound("between", (first, second)),))

    def bounded(self, *found: Any) -> SpokenTime:
        """start: piece* bound+."""
        return SpokenTime(
            tuple(f for f in found if not isinstance(f, Bound)),
            tuple(f for f in found if isinstance(f, Bound)),
        )

    def ahead(self, length: Length, *pieces: Piece) -> SpokenTime:
        """start: duration _EARLIER_THAN piece+."""
        return SpokenTime(pieces, (), length, -1)

    def behind(self, length: Length, *pieces: Piece) -> SpokenTime:
        """start: duration _LATER_THAN piece+."""
        return SpokenTime(pieces, (), length, 1)

    def before_weekday(self, length: Length, day: Token) -> SpokenTime:
        """start: duration _LAST WEEKDAY. British: a week last monday is a week before it."""
        return self.ahead(length, self.last_weekday(day))

    def before_day(self, length: Length, day: Token) -> SpokenTime:
        """start: duration DAYS."""
        return self.ahead(length, self.days(day))

    def day_ahead(self, *pieces: Piece) -> SpokenTime:
        """start: _DAY_EARLIER piece+."""
        return SpokenTime(pieces, (), Length(((1, "day"),)), -1)

    def day_behind(self, *pieces: Piece) -> SpokenTime:
        """start: _DAY_LATER piece+."""
        return SpokenTime(pieces, (), Length(((1, "day"),)), 1)

    def side(self, *pieces: Piece) -> Pieces:
        """side: piece+."""
        return pieces

    def between(self, first: Pieces, second: Pieces) -> Bound:
        """bound: _BETWEEN side _AND side | _FROM side _TO side."""
        return Bound("between", (first, second))

    def onward(self, pieces: Pieces) -> Bound:
        """bound: _FROM side _ONWARD."""
        return Bound("since", (pieces,))

    def from_alone(self, pieces: Pieces) -> Bound:
        """bound: _FROM side. From noon is since noon; a day's cup may be the cup of that day."""
        if any(isinstance(piece, Clock) for piece in pieces):
            return Bound("since", (pieces,))
        return Bound("since", ((Unplaced("say since when, or from when until when"),),))

    def either_ago(self, most: Token, least: Token, unit: Token) -> Bound:
        """bound: COUNT_OR COUNT UNIT _AGO."""
        far, near = sorted((float(most.value), float(least.value)), reverse=True)
        sides = tuple((Ago(Length(((count, str(unit.value)),))),) for count in (far, near))
        return Bound("between", sides)

    def either_more_ago(self, least: Token, unit: Token, most: Token) -> Bound:
        """bound: COUNT_OR UNIT _OR COUNT _AGO."""
        return self.either_ago(most, least, unit)

    def beside(self, kind: Token, *pieces: Piece) -> Bound:
        """bound: SPAN_BEFORE piece+. A week, weekend or part of the day next to a day."""
        return Bound(str(kind.value), (pieces,))

    def since(self, *pieces: Piece) -> Bound:
        """bound: _SINCE piece+."""
        return Bound("since", (pieces,))

    def since_long(self, length: Length) -> Bound:
        """bound: _SINCE duration."""
        return Bound("since", ((Ago(length),),))

    def until(self, *pieces: Piece) -> Bound:
        """bound: _UNTIL piece+."""
        return Bound("until", (pieces,))

    def before(self, *pieces: Piece) -> Bound:
        """bound: _BEFORE piece+."""
        return Bound("before", (pieces,))

    def after(self, *pieces: Piece) -> Bound:
        """bound: _AFTER piece+."""
        return Bound("after", (pieces,))

    def around(self, *pieces: Piece) -> Bound:
        """bound: _AROUND piece+."""
        return Bound("around", (pieces,))

    def past(self, amount: tuple[float, str]) -> Bound:
        """bound: _LASTN amount."""
        return Bound("past", (), Length((amount,)))

    def past_one(self, unit: Token) -> Bound:
        """bound: _LASTN1 UNIT."""
        return Bound("past", (), Length(((1, unit.value),)))

    def past_one_more(self, unit: Token, more: Token) -> Bound:
        """bound: _LASTN1 UNIT MORE."""
        return Bound("past", (), Length(((1 + float(more.value), str(unit.value)),)))

    def ago(self, length: Length) -> Ago:
        """piece: duration _AGO."""
        return Ago(length)

    def edge(self, token: Token) -> Edge:
        """piece: EDGE."""
        return Edge(token.value)

    def whole(self, token: Token) -> Whole:
        """piece: WHOLE."""
        return Whole(token.value)

    def part(self, token: Token) -> Part:
        """piece: PART."""
        return Part(token.value)

    def partday(self, name: Token) -> PartDay:
        """piece: PARTDAY."""
        return PartDay(name.value)

    def moment_now(self, _now: Token) -> Now:
        """piece: NOW."""
        return Now()

    def same_time(self, _same: Token) -> SameTime:
        """piece: SAME."""
        return SameTime()

    def stamp(self, token: Token) -> Stamp:
        """piece: STAMP."""
        year, month, day, hour, minute, second = token.value
        return Stamp(Date(year, month, day), Clock(hour, minute, exact=True, second=second))

    def unplaced(self, token: Token) -> Unplaced:
        """piece: UNPLACED."""
        return Unplaced(token.value)

    def clock(self, hour: Token, *rest: Token) -> Clock:
        """clock: HOUR MINUTE? _OCLOCK? MERIDIEM?."""
        minute = next((t.value for t in rest if t.type == "MINUTE"), 0)
        exact = hour.value > 12 or hour.value == 0
        return Clock(hour.value, minute, _meridiem(rest), exact, bare=not rest)

    def digital(self, time: Token, *rest: Token) -> Clock:
        """clock: HHMM MERIDIEM?."""
        hour, minute, exact, second = time.value
        meridiem = _meridiem(rest)
        exact = (exact and not meridiem) or hour > 12 or hour == 0
        return Clock(hour, minute, meridiem, exact, second=second)

    def past_hour(self, minutes: Token, hour: Token, *rest: Token) -> Clock:
        """clock: CMIN _CPAST HOUR."""
        return Clock(hour.value, minutes.value, _meridiem(rest), hour.value > 12)

    def to_hour(self, minutes: Token, hour: Token, *rest: Token) -> Clock:
        """clock: CMIN _CTO HOUR."""
        before = hour.value - 1 if hour.value > 1 else 12
        meridiem = _meridiem(rest)
        if hour.value == 12 and meridiem:  # quarter to twelve pm is before noon
            meridiem = "am" if meridiem == "pm" else "pm"
        return Clock(before, 60 - minutes.value, meridiem, hour.value > 13)

    def half_hour(self, hour: Token, *rest: Token) -> Clock:
        """clock: _HALF_OF HOUR. British: half eight is half past eight."""
        return Clock(hour.value, 30, _meridiem(rest), hour.value > 12)

    def past_fixed(self, minutes: Token, fixed: Token) -> Clock:
        """clock: CMIN _CPAST FIXED."""
        return Clock(fixed.value % 24, minutes.value, exact=True)

    def to_fixed(self, minutes: Token, fixed: Token) -> Clock:
        """clock: CMIN _CTO FIXED."""
        return Clock(fixed.value - 1, 60 - minutes.value, exact=True)

    def fixed(self, token: Token) -> Clock:
        """clock: FIXED. Midnight is hour 24: the end of the day that is named with it."""
        return Clock(token.value, exact=True)

    def days(self, token: Token) -> Days:
        """day: DAYS."""
        return Days(token.value)

    def weekday(self, token: Token) -> Weekday:
        """day: WEEKDAY."""
        return Weekday(token.value)

    def last_weekday(self, token: Token) -> Weekday:
        """day: _LAST WEEKDAY."""
        return Weekday(token.value, "last")

    def weekday_before_last(self, token: Token) -> Weekday:
        """day: WEEKDAY _BEFORE_LAST | _LAST WEEKDAY _BUT_ONE."""
        return Weekday(token.value, "last", 2)

    def weekdays_ago(self, count: Token, token: Token) -> Weekday:
        """piece: COUNT WEEKDAY _AGO."""
        return Weekday(token.value, "last", int(count.value))

    def parts_ago(self, count: Token, part: Token) -> PartAgo:
        """piece: COUNT PART _AGO."""
        return PartAgo(str(part.value), int(count.value))

    def part_before_last(self, part: Token) -> PartAgo:
        """piece: PART _BEFORE_LAST."""
        return PartAgo(str(part.value), 2)

    def this_weekday(self, token: Token) -> Weekday:
        """day: _THIS WEEKDAY."""
        return Weekday(token.value, "this")

    def month(self, *words: Token) -> Date:
        """day: MONTH YEAR_OF?."""
        found = {t.type: t.value for t in words}
        return Date(found.get("YEAR_OF"), found["MONTH"])

    def last_month(self, month: Token) -> Date:
        """day: _LAST MONTH."""
        return Date(None, month.value, last=True)

    def month_day(self, month: Token, day: Token, *year: Token) -> Date:
        """day: _LAST? MONTH_OF DAY_AFTER YEAR_OF?."""
        return Date(year[0].value if year else None, month.value, day.value)

    def day_month(self, day: Token, month: Token, *year: Token) -> Date:
        """day: DAY_BEFORE MONTH_OF YEAR_OF?."""
        return Date(year[0].value if year else None, month.value, day.value)

    def day_of_month(self, day: Token) -> Date:
        """day: ORD."""
        return Date(None, None, day.value)

    def date(self, token: Token) -> Date:
        """day: DATE."""
        kind, year, first, second = token.value
        return Date(year, first, second, slashed=kind == "slashed")

    def holiday(self, token: Token, *year: Token) -> Holiday:
        """day: HOLIDAY YEAR_OF?."""
        month, day = token.value
        return Holiday(month, day, year[0].value if year else None)

    def season(self, token: Token, *year: Token) -> Season:
        """day: SEASON YEAR_OF?."""
        return Season(token.value, year[0].value if year else None)

    def last_season(self, token: Token) -> Season:
        """day: _LAST SEASON."""
        return Season(token.value, None, last=True)

    def last_unit(self, unit: Token) -> Calendar:
        """span: _LAST UNIT."""
        return Calendar(unit.value, 1)

    def this_unit(self, unit: Token) -> Calendar:
        """span: _THIS UNIT."""
        return Calendar(unit.value, 0)

    def back(self, unit: Token) -> Calendar | Weekend:
        """span: BACK | _LAST UNIT _BUT_ONE."""
        return Weekend(last=True, back=1) if unit.value == "weekend" else Calendar(unit.value, 2)

    def weekend(self, _weekend: Token) -> Weekend:
        """span: WEEKEND | _THIS WEEKEND."""
        return Weekend()

    def weekend_but_one(self, _weekend: Token) -> Weekend:
        """span: _LAST WEEKEND _BUT_ONE."""
        return Weekend(last=True, back=1)

    def last_weekend(self, _weekend: Token) -> Weekend:
        """span: _LAST WEEKEND."""
        return Weekend(last=True)

    def nth_unit(self, number: Token, unit: Token) -> Nth:
        """span: NTH UNIT."""
        return Nth(number.value, unit.value)

    def nth_weekday(self, number: Token, weekday: Token) -> Nth:
        """span: NTH WEEKDAY."""
        return Nth(number.value, "weekday", weekday.value)

    def quarter(self, number: Token) -> Nth:
        """span: _LAST? QUARTER. Without a year the last one begun, as for any other time."""
        return Nth(number.value, "quarter")

    def year(self, token: Token) -> Date:
        """span: YEAR."""
        return Date(token.value)

    def decade(self, token: Token) -> Decade:
        """span: DECADE."""
        return Decade(token.value)

    def duration(self, *amounts: tuple[float, str]) -> Length:
        """duration: amount+."""
        return Length(amounts)

    def amount(self, count: Token, unit: Token) -> tuple[float, str]:
        """amount: COUNT UNIT."""
        return (float(count.value), unit.value)

    def amount_more(self, count: Token, unit: Token, more: Token) -> tuple[float, str]:
        """amount: COUNT UNIT MORE."""
        return (float(count.value) + float(more.value), str(unit.value))


def _meridiem(tokens: tuple[Token, ...]) -> str | None:
    return next((t.value for t in tokens if t.type == "MERIDIEM"), None)
