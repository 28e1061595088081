"""Spoken times against a clock: `resolve` turns what was said into a slice of the past.

All results are in the zone of `now`, day lengths and offsets as that zone has them.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timedelta

from grammar import timeforms as tf
from grammar.days import TimeError, TimesApartError
from grammar.forms import TimeSlice
from grammar.moment import PART_HOURS, Moment, Setting, before

_MEALS = ("breakfast", "brunch", "lunch", "tea", "dinner", "bedtime")
_DAYS = frozenset(("day", "week", "fortnight", "weekend", "month", "year", "decade"))
AROUND = timedelta(minutes=30)
_CLOCK_READINGS = 4
"""How many starts a range of the past may have: mornings and evenings of two days."""
_MERIDIEMS = {"morning": "am", "afternoon": "pm", "evening": "pm"}
"""What a part of the day said after two clock times says of both of them."""


def resolve(said: tf.SpokenTime, now: datetime, month_first: bool | None) -> TimeSlice:
    """Return the slice a spoken time names; raises TimeError when it names none."""
    setting = Setting(now, month_first)
    try:
        return _resolved(said, setting)
    except (OverflowError, ValueError) as error:
        if isinstance(error, TimeError):
            raise
        raise TimeError("it is out of the calendar") from error


def _resolved(said: tf.SpokenTime, setting: Setting) -> TimeSlice:
    if said.offset is not None:
        moment = Moment.of(said.pieces)
        start, end = moment.span(setting)
        anchor = start if said.offset_sign < 0 else end
        units = {unit for _, unit in said.offset.amounts}
        if moment.clock is None and start < end and units <= _DAYS:  # two days before christmas
            return TimeSlice(
                *(before(t, said.offset, setting, said.offset_sign) for t in (start, end))
            )
        point = before(anchor, said.offset, setting, said.offset_sign)
        return TimeSlice(point, point)
    if not said.bounds:
        return TimeSlice(*Moment.of(said.pieces).span(setting))
    beside = _weekday_beside(said, setting)
    if beside is not None:
        return beside
    bounds = _paired(said.bounds)
    slices = [_bound(bound, said.pieces, setting) for bound in bounds]
    starts = [s.start for s in slices if s.start is not None]
    ends = [s.end for s in slices if s.end is not None]
    if said.pieces and any(b.kind in ("since", "until", "before", "after") for b in bounds):
        outer = Moment.of(said.pieces).span(setting)
        if outer[0] < outer[1]:
            starts.append(outer[0])
            ends.append(outer[1])
    latest, earliest = (max(starts) if starts else None), (min(ends) if ends else None)
    if latest is not None and earliest is not None and earliest < latest:
        raise TimeError("it ends before it starts")
    return TimeSlice(latest, earliest)


def _paired(bounds: tuple[tf.Bound, ...]) -> tuple[tf.Bound, ...]:
    """Return one interval for two half-open ones between clock times: after eight, before ten."""
    opens = [b.sides[0] for b in bounds if b.kind in ("since", "after")]
    closes = [b.sides[0] for b in bounds if b.kind in ("until", "before")]
    if len(bounds) != 2 or len(opens) != 1 or len(closes) != 1:
        return bounds
    moments = [Moment.of(side) for side in (*opens, *closes)]
    if any(m.clock is None for m in moments) or all(m.dated for m in moments):
        return bounds
    return (tf.Bound("between", (opens[0], closes[0])),)


def _weekday_beside(said: tf.SpokenTime, setting: Setting) -> TimeSlice | None:
    """Return the weekday next to a day: the friday after christmas; None for any other time."""
    if len(said.pieces) != 1 or len(said.bounds) != 1:
        return None
    day, bound = said.pieces[0], said.bounds[0]
    if not isinstance(day, tf.Weekday) or bound.kind not in ("before", "after"):
        return None
    other = Moment.of(bound.sides[0])
    if not other.days or other.clock is not None or other.part_name() is not None:
        return None
    start, end = other.span(setting)
    if bound.kind == "before":
        ahead = (start.weekday() - day.number - 1) % 7 + 1
        found = start.date() - timedelta(days=ahead)
    else:
        found = end.date() + timedelta(days=(day.number - end.weekday()) % 7)
    return TimeSlice(setting.at(found, 0), setting.at(found + timedelta(days=1), 0))


def _beside(kind: str, start: datetime, end: datetime, setting: Setting) -> TimeSlice:
    """Return the week, weekend or part of the day right before or after [start, end)."""
    unit, _, side = kind.partition(" ")
    earlier = side == "before"
    if unit == "week":
        first = start.date() - timedelta(days=7) if earlier else end.date()
        return TimeSlice(setting.at(first, 0), setting.at(first + timedelta(days=7), 0))
    if unit == "weekend":
        ahead = (start.weekday() - 7) % 7 + 1 if earlier else (5 - end.weekday()) % 7
        first = start.date() - timedelta(days=ahead + 1) if earlier else end.date()
        first += timedelta(days=0 if earlier else ahead)
        return TimeSlice(setting.at(first, 0), setting.at(first + timedelta(days=2), 0))
    day = start.date() - timedelta(days=1) if earlier else end.date()
    first_hour, last_hour = PART_HOURS[unit]
    return TimeSlice(setting.at(day, first_hour * 60), setting.at(day, last_hour * 60))


def _bound(bound: tf.Bound, around: tf.Pieces, setting: Setting) -> TimeSlice:
    if bound.length is not None:
        return TimeSlice(before(setting.now, bound.length, setting), setting.now)
    if bound.kind == "between":
        return _between(bound.sides[0], bound.sides[1], around, setting)
    if bound.kind == "both":
        return _row(bound.sides, around, setting)
    context = Moment.of(around)
    moment = Moment.of(bound.sides[0]).completed(context)
    if moment.clock is None and moment.dated:
        moment = replace(moment, clock=context.clock)  # at 2 pm since monday
    start, end = moment.span(setting)
    if " " in bound.kind:
        return _beside(bound.kind, start, end, setting)
    match bound.kind:
        case "since":
            return TimeSlice(start, None)
        case "until":
            return TimeSlice(None, end)
        case "before":
            return TimeSlice(None, start)
        case "after":
            return TimeSlice(end, None)
        case _:
            margin = AROUND.total_seconds() if start == end else 0
            return TimeSlice(setting.shifted(start, -margin), setting.shifted(end, margin))


def _row(sides: tuple[tf.Pieces, ...], around: tf.Pieces, setting: Setting) -> TimeSlice:
    """Return the slice of times that follow each other: monday and tuesday, 2016 and 2017."""
    context = Moment.of(around)
    moments = [Moment.of(side) for side in sides]
    last = moments[-1]
    spans: list[tuple[datetime, datetime]] = []
    for i, moment in enumerate(moments):
        moment = _shared_week(moment, (*last.days[1:], *context.days))
        moment = _shared_dates(moment, last)[0] if i + 1 < len(moments) else moment
        if i and not moment.dated:
            moment = moment.completed(moments[0])
        spans.append(moment.completed(last).completed(context).span(setting))
    spans.sort()
    start, end = spans[0]
    for following in spans[1:]:
        if following[0] > end:
            raise TimesApartError("it names times that lie apart; ask for one at a time")
        end = max(end, following[1])
    return TimeSlice(start, end)


def _between(first: tf.Pieces, second: tf.Pieces, around: tf.Pieces, setting: Setting) -> TimeSlice:
    """Resolve both sides of an interval, each lending the other what it left out."""
    if Moment.of(first).now:  # between now and noon
        first, second = second, first
    context = Moment.of(around)
    one = _night_between(Moment.of(first), Moment.of(second), context, setting)
    if one is not None:
        return one
    a, b = _dates_from_numbers(*_between_meals(Moment.of(first), Moment.of(second)))
    a, b, context = _days_of_month(a, b, context)
    if a.clock and b.clock and not b.dated and not a.dated:
        a, b = a.completed(context), b
        if b.part is None and a.part is None and context.part is not None:
            b = replace(b, part=context.part)
        b = replace(b, part=b.part or a.part)
    elif not a.dated and b.dated and a.clock is not None:
        a = a.completed(b)
    a, b = _shared_dates(a, b)
    a, b = _shared_week(a, (*b.days[1:], *context.days)), _shared_week(b, context.days)
    a = _shared_meridiem(a, b)
    if not a.dated:
        a = a.completed(context)
    part_of_context = context.part_name()
    if b.clock is not None and not b.dated and b.part is None and part_of_context is not None:
        b = replace(b, part=tf.Part(part_of_context))
    start, start_end = a.span(setting)
    same_day = a.dated and a.days == b.days and a.part_day == b.part_day
    night = a.part_name() in ("night", "tonight") and b.part_name() in ("night", "tonight")
    if b.clock is not None and same_day:
        b = replace(b, days=(), part_day=None)
    if b.clock is not None and not b.dated and night:
        b = replace(b, part=None)
    _, end = b.span(setting, after=None if same_day and b.clock is None else start)
    if end > setting.now and a.clock is not None and b.clock is not None and not b.dated:
        start, end = _last_ended(a, b, setting) or (start, end)
    early = _before_noon(a)
    if end.date() > start.date() and a.dated and early is not None and _before_noon(b):
        begin = early.span(setting)[0]
        finish = b.span(setting, after=begin)[1]
        start, end = (begin, finish) if finish.date() == begin.date() else (start, end)
    if start > setting.now and start.date() < end.date() and a.clock and b.clock:
        day = tf.Length(((1, "day"),))  # from 10 pm to 6 am today: the night that ended today
        start, end = before(start, day, setting), before(end, day, setting)
    if end < start:
        raise TimeError("it ends before it starts")
    return TimeSlice(start, max(end, start_end if a.clock is None and end == start else end))


def _between_meals(a: Moment, b: Moment) -> tuple[Moment, Moment]:
    """Read an interval from a meal as from its end, and one to a meal as to where that begins."""
    first, second = a.part_name() or "", b.part_name() or ""
    if first in _MEALS and second in _MEALS and PART_HOURS[first][1] >= PART_HOURS[second][0]:
        return a, b  # from lunch to brunch: they are not apart
    if first in _MEALS and a.clock is None:
        a = replace(a, part=None, clock=tf.Clock(PART_HOURS[first][1], exact=True))
    if second in _MEALS and b.clock is None:
        b = replace(b, part=None, clock=tf.Clock(PART_HOURS[second][0], exact=True))
    return a, b


def _night_between(a: Moment, b: Moment, context: Moment, setting: Setting) -> TimeSlice | None:
    """Return the night of two days in a row: the night from saturday to sunday; else None."""
    named = a.part_name() or (context.part_name() if not context.dated else None)
    if named != "night" or a.clock or b.clock or b.part_name() or not (a.dated and b.dated):
        return None
    day = replace(a, part=None)
    end = day.span(setting)[1]
    if b.span(setting, after=day.span(setting)[0])[0] != end:
        return None
    return TimeSlice(*replace(day, part=tf.Part("night")).span(setting))


def _before_noon(side: Moment) -> Moment | None:
    """Return a clock time that may be of either half of the day as one before noon."""
    clock = side.clock
    if clock is None or clock.exact or clock.meridiem or side.part_name() is not None:
        return None
    return replace(side, clock=replace(clock, meridiem="am"))


def _last_ended(a: Moment, b: Moment, setting: Setting) -> tuple[datetime, datetime] | None:
    """Return the last range of two clock times that is over, on one day where one is.

    None where `a` names a day on which no such range is over.
    """
    found: list[tuple[datetime, datetime]] = []
    now = setting.now
    for _ in range(_CLOCK_READINGS):
        start = a.span(replace(setting, now=now))[0]
        if start > now:
            break
        end = b.span(setting, after=start)[1]
        if end <= setting.now:
            found.append((start, end))
        now = start - timedelta(minutes=1)
        if a.dated and now.date() != setting.now.date():
            break
    within = (span for span in found if span[0].date() == span[1].date())
    return next(within, found[0] if found else None)


def _dates_from_numbers(a: Moment, b: Moment) -> tuple[Moment, Moment]:
    """Read a bare number beside a date as a day of the month: `from 2 to 10 july`."""
    if a.clock and a.clock.bare and not a.days and _has_day(b) and b.clock is None:
        a = replace(a, clock=None, days=(tf.Date(None, None, a.clock.hour),))
    if b.clock and b.clock.bare and not b.days and _has_day(a) and a.clock is None:
        b = replace(b, clock=None, days=(tf.Date(None, None, b.clock.hour),))
    return a, b


def _days_of_month(a: Moment, b: Moment, context: Moment) -> tuple[Moment, Moment, Moment]:
    """Read two bare numbers beside a month as its days: `in november between 19 and 20`."""
    month = context.days[0] if len(context.days) == 1 else None
    if not isinstance(month, tf.Date) or month.month is None or month.day is not None:
        return a, b, context
    if a.dated or b.dated or not (a.clock and a.clock.bare and b.clock and b.clock.bare):
        return a, b, context
    sides = [
        replace(side, clock=None, days=(replace(month, day=side.clock.hour),))
        for side in (a, b)
        if side.clock is not None
    ]
    return sides[0], sides[1], replace(context, days=())


def _shared_week(side: Moment, days: tuple[tf.Day, ...]) -> Moment:
    """Lend a lone weekday the week that is named with its like: `monday to friday last week`."""
    weeks = [day for day in days if isinstance(day, tf.Calendar)]
    lone = len(side.days) == 1 and isinstance(side.days[0], tf.Weekday)
    return replace(side, days=(*side.days, weeks[0])) if lone and weeks else side


def _has_day(moment: Moment) -> bool:
    return any(isinstance(day, tf.Date) and day.day is not None for day in moment.days)


def _shared_dates(a: Moment, b: Moment) -> tuple[Moment, Moment]:
    """Lend month and year from one date to the other: `the 2nd to the 22nd of october 2016`."""
    if len(a.days) != 1 or len(b.days) != 1:
        return a, b
    first, second = a.days[0], b.days[0]
    if not isinstance(first, tf.Date) or not isinstance(second, tf.Date):
        return a, b
    if first.slashed or second.slashed:
        return a, b
    if first.day is not None and first.month is None:
        first = tf.with_month(first, second)
    if second.day is not None and second.month is None and first.month is not None:
        second = tf.with_month(second, first)
    if first.year is None and second.year is not None:
        later = (second.month or 13, second.day or 32)
        year = second.year if (first.month or 0, first.day or 0) <= later else second.year - 1
        first = replace(first, year=year)
    return replace(a, days=(first,)), replace(b, days=(second,))


def _shared_meridiem(a: Moment, b: Moment) -> Moment:
    """Lend the second clock's am or pm to the first: `between 5 and 6pm`, `11 to 1 pm`."""
    if a.clock is None or b.clock is None or a.clock.meridiem or a.clock.exact:
        return a
    if b.clock.hour == 24 or (b.clock.exact and b.clock.hour == 12) or a.part_name():
        return a
    meridiem = b.clock.meridiem or _MERIDIEMS.get(b.part_name() or "")
    if meridiem is None:
        return a
    first = a.clock.hour % 12 * 60 + a.clock.minute
    second = b.clock.hour % 12 * 60 + b.clock.minute
    other = "am" if meridiem == "pm" else "pm"
    return replace(a, clock=replace(a.clock, meridiem=meridiem if first < second else other))
