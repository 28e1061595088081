"""Days of a spoken time: each form of a day as a span of calendar dates, in the past of `now`."""

from __future__ import annotations

import calendar
from dataclasses import dataclass, replace
from datetime import date, timedelta

from grammar import timeforms as tf

DaySpan = tuple[date, date]  # the first day, and the day after the last one


class TimeError(ValueError):
    """A spoken time that names no time: the thirtieth of February, two days at once."""


class TimesApartError(TimeError):
    """Times joined by `and` or `or` with a gap between them: no one slice holds both."""


class TimeAmbiguityError(TimeError):
    """A date that two countries read in two ways; `readings` are both, month first."""

    def __init__(self, readings: tuple[tf.Date, tf.Date]) -> None:
        super().__init__("day and month can be read in two orders")
        self.readings = readings


@dataclass(frozen=True, slots=True)
class Reference:
    """What dates are relative to. after: the first day after this one, instead of the last past.

    month_first: how 3/4 is read: True March 4, False 3 April, None unknown.
    """

    today: date
    after: date | None = None
    month_first: bool | None = True


def span_of(days: tuple[tf.Day, ...], ref: Reference) -> DaySpan:
    """Return the dates that all of `days` together name; raises TimeError when they disagree."""
    first, *rest = sorted(days, key=_rank)
    if not rest:
        return _single(first, ref)
    outer = rest[-1]
    if isinstance(first, tf.Weekday) and isinstance(outer, tf.Date) and outer.day is not None:
        return _weekday_date(first, outer, ref)
    if (
        isinstance(first, tf.Date)
        and isinstance(outer, tf.Calendar)
        and outer.unit in ("year", "month")
    ):
        start, _ = _single(outer, ref)
        month = start.month if outer.unit == "month" else None
        return _date(tf.with_month(first, tf.Date(start.year, month)), ref)
    if isinstance(first, tf.Date) and isinstance(outer, tf.Date):
        return _date(_merged(first, outer), ref)
    if isinstance(first, tf.Holiday | tf.Season) and isinstance(outer, tf.Date | tf.Calendar):
        start, _ = _single(outer, ref)
        return _single(replace(first, year=start.year), ref)
    if isinstance(first, tf.Weekday) and isinstance(outer, tf.Days) and outer.back % 7 == 0:
        rest = [tf.Calendar("week", outer.back // 7)]  # a week ago on monday
    outside = span_of(tuple(rest), ref)
    if isinstance(first, tf.Weekday):
        return _weekday_within(first.number, outside)
    if isinstance(first, tf.Nth):
        return _nth(first, outside)
    inside = _single(first, ref)
    start, end = max(inside[0], outside[0]), min(inside[1], outside[1])
    if start >= end:
        raise TimeError("it names two different days")
    return start, end


def _rank(day: tf.Day) -> int:
    """Order forms from the narrowest to the widest."""
    if isinstance(day, tf.Weekday | tf.Nth):
        return 0
    if isinstance(day, tf.Date):
        return 1 if day.day is not None else 3 if day.month is not None else 5
    if isinstance(day, tf.Calendar):
        return {"day": 1, "week": 2, "month": 4}.get(day.unit, 5)
    return 2


def _single(day: tf.Day, ref: Reference) -> DaySpan:
    match day:
        case tf.Days():
            return _one(ref.today - timedelta(days=day.back))
        case tf.Weekday():
            return _weekday(day, ref)
        case tf.Date():
            return _date(day, ref)
        case tf.Calendar():
            return _calendar(day, ref.today)
        case tf.Weekend():
            return _weekend(day, ref)
        case tf.Holiday():
            return _holiday(day, ref)
        case tf.Season():
            return _season(day, ref)
        case tf.Decade():
            year = day.year
            if year < 100:
                century = ref.today.year // 100 * 100
                year += century if century + year <= ref.today.year else century - 100
            return date(year, 1, 1), date(year + 10, 1, 1)
        case tf.Nth(unit="quarter" | "half"):
            span = _nth(day, _calendar(tf.Calendar("year", 0), ref.today))
            future = span[0] > ref.today
            return _nth(day, _calendar(tf.Calendar("year", 1), ref.today)) if future else span
        case tf.Nth():
            return _nth(day, _calendar(tf.Calendar("month", 0), ref.today))


def _one(day: date) -> DaySpan:
    return day, day + timedelta(days=1)


def _weekday(day: tf.Weekday, ref: Reference) -> DaySpan:
    if ref.after is not None:
        ahead = (day.number - ref.after.weekday() - 1) % 7 + 1
        return _one(ref.after + timedelta(days=ahead))
    back = (ref.today.weekday() - day.number) % 7
    if day.which == "last" and back == 0:
        back = 7
    return _one(ref.today - timedelta(days=back + 7 * (day.back - 1)))


def _weekday_within(number: int, span: DaySpan) -> DaySpan:
    start, end = span
    found = start + timedelta(days=(number - start.weekday()) % 7)
    if found >= end:
        raise TimeError("that day is not in that time")
    return _one(found)


def _weekday_date(day: tf.Weekday, said: tf.Date, ref: Reference) -> DaySpan:
    """Return the last such date that falls on the weekday: `Tuesday, May 5th`."""
    if said.year is not None or said.slashed:
        return _date(said, ref)
    for candidate in _candidates(said, ref):
        if candidate.weekday() == day.number:
            return _one(candidate)
    raise TimeError("that date does not fall on that weekday")


def _candidates(said: tf.Date, ref: Reference) -> list[date]:
    """Past dates that a day, or a day and month, may mean, newest first."""
    found: list[date] = []
    year, month = ref.today.year, ref.today.month
    for _ in range(8 if said.month is None else 8 * 12):
        if (said.month is None or month == said.month) and said.day is not None:
            day = _day(year, month, said.day)
            if day is not None and day <= ref.today:
                found.append(day)
        year, month = (year, month - 1) if month > 1 else (year - 1, 12)
    return found


def _day(year: int, month: int, day: int) -> date | None:
    try:
        return date(year, month, day)
    except ValueError:
        return None


def _date(said: tf.Date, ref: Reference) -> DaySpan:
    if said.slashed:
        said = ordered(said, ref.month_first)
    if said.day is None:
        return _month_or_year(said, ref)
    if said.year is not None and said.month is not None:
        day = _day(said.year, said.month, said.day)
        if day is None:
            raise TimeError("there is no such date")
        return _one(day)
    if ref.after is not None:
        return _one(_date_after(said, ref.after))
    candidates = _candidates(said, ref)
    if not candidates:
        raise TimeError("there is no such date")
    return _one(candidates[0])


def ordered(said: tf.Date, month_first: bool | None) -> tf.Date:
    """Return a date in digits with its month found; TimeAmbiguityError where nothing tells."""
    first, second = said.month or 0, said.day or 0
    us, other = tf.Date(said.year, first, second), tf.Date(said.year, second, first)
    if first > 12 or second > 12 or first == second:
        return other if first > 12 else us
    if month_first is None:
        raise TimeAmbiguityError((us, other))
    return us if month_first else other


def _date_after(said: tf.Date, after: date) -> date:
    year, month = after.year, after.month
    for _ in range(8 * 12):
        if said.month is None or month == said.month:
            day = _day(year, month, said.day or 1)
            if day is not None and day > after:
                return day
        year, month = (year, month + 1) if month < 12 else (year + 1, 1)
    raise TimeError("there is no such date")


def _month_or_year(said: tf.Date, ref: Reference) -> DaySpan:
    if said.month is None:
        year = said.year or ref.today.year
        return date(year, 1, 1), date(year + 1, 1, 1)
    year = said.year if said.year is not None else _year_of_month(said, ref)
    return date(year, said.month, 1), _months_on(date(year, said.month, 1), 1)


def _year_of_month(said: tf.Date, ref: Reference) -> int:
    month = said.month or 1
    if ref.after is not None:
        return ref.after.year if month > ref.after.month else ref.after.year + 1
    current = month == ref.today.month
    if month > ref.today.month or (current and said.last):
        return ref.today.year - 1
    return ref.today.year


def _months_on(day: date, months: int) -> date:
    """Return the date `months` later (or earlier), the last day of a shorter month."""
    count = day.year * 12 + day.month - 1 + months
    year, month = divmod(count, 12)
    last = calendar.monthrange(year, month + 1)[1]
    return date(year, month + 1, min(day.day, last))


months_on = _months_on


def _calendar(said: tf.Calendar, today: date) -> DaySpan:
    match said.unit:
        case "week":
            start = today - timedelta(days=today.weekday() + 7 * said.back)
            return start, start + timedelta(days=7)
        case "fortnight":
            start = today - timedelta(days=today.weekday() + 14 * said.back)
            return start, start + timedelta(days=14)
        case "month":
            start = _months_on(today.replace(day=1), -said.back)
            return start, _months_on(start, 1)
        case "quarter":
            first = today.replace(month=(today.month - 1) // 3 * 3 + 1, day=1)
            start = _months_on(first, -3 * said.back)
            return start, _months_on(start, 3)
        case "year":
            return date(today.year - said.back, 1, 1), date(today.year - said.back + 1, 1, 1)
        case "decade":
            start = date((today.year // 10 - said.back) * 10, 1, 1)
            return start, date(start.year + 10, 1, 1)
        case _:
            return _one(today - timedelta(days=said.back))


def holding(day: date, unit: str) -> DaySpan:
    """Return the week from Monday, or the weekend, that holds `day` or comes next to it."""
    monday = day - timedelta(days=day.weekday())
    if unit == "weekend":
        return monday + timedelta(days=5), monday + timedelta(days=7)
    return monday, monday + timedelta(days=7)


def edged(span: DaySpan, edge: tf.EdgeName | None) -> DaySpan:
    """Return the first, middle or last third of a span."""
    if edge is None:
        return span
    start, end = span
    third = timedelta(days=round((end - start).days / 3))
    if edge == "early":
        return start, start + third
    if edge == "late":
        return end - third, end
    return start + third, end - third


def _weekend(said: tf.Weekend, ref: Reference) -> DaySpan:
    back = (ref.today.weekday() - 5) % 7
    if said.last and ref.today.weekday() >= 5:
        back += 7
    saturday = ref.today - timedelta(days=back + 7 * said.back)
    return saturday, saturday + timedelta(days=2)


def _season(said: tf.Season, ref: Reference) -> DaySpan:
    year = said.year
    if year is None:
        year = ref.today.year
        if date(year, said.month, 1) > ref.today or (
            said.last and _months_on(date(year, said.month, 1), 3) > ref.today
        ):
            year -= 1
    start = date(year, said.month, 1)
    return start, _months_on(start, 3)


def _holiday(said: tf.Holiday, ref: Reference) -> DaySpan:
    if said.year is not None:
        return _one(_holiday_in(said, said.year))
    for year in (ref.today.year, ref.today.year - 1):
        day = _holiday_in(said, year)
        if day <= ref.today:
            return _one(day)
    raise TimeError("there is no such day")


def _holiday_in(said: tf.Holiday, year: int) -> date:
    if said.month:
        return date(year, said.month, said.day)
    match said.day:
        case 1:
            return _nth_weekday(year, 1, 0, 3)
        case 2:
            return _nth_weekday(year, 2, 0, 3)
        case 3:
            return _nth_weekday(year, 5, 6, 2)
        case 4:
            return _nth_weekday(year, 5, 0, -1)
        case 5:
            return _nth_weekday(year, 6, 6, 3)
        case 6:
            return _nth_weekday(year, 9, 0, 1)
        case 7:
            return _nth_weekday(year, 10, 0, 2)
        case 8:
            return _nth_weekday(year, 11, 3, 4)
        case 9:
            return _nth_weekday(year, 11, 3, 4) + timedelta(days=1)
        case _:
            return _easter(year) + timedelta(days={10: 0, 11: -2, 12: 1}[said.day])


def _nth_weekday(year: int, month: int, weekday: int, n: int) -> date:
    weeks = [week[weekday] for week in calendar.monthcalendar(year, month) if week[weekday]]
    return date(year, month, weeks[n - 1] if n > 0 else weeks[n])


def _easter(year: int) -> date:
    """Easter Sunday of the Gregorian calendar (the Meeus rule)."""
    a, b, c = year % 19, year // 100, year % 100
    d, e = divmod(b, 4)
    g = (8 * b + 13) // 25
    h = (19 * a + b - d - g + 15) % 30
    i, k = divmod(c, 4)
    m = (32 + 2 * e + 2 * i - h - k) % 7
    n = (a + 11 * h + 19 * m) // 433
    month = (h + m - 7 * n + 90) // 25
    return date(year, month, (h + m - 7 * n + 33 * month + 19) % 32)


def _nth(said: tf.Nth, span: DaySpan) -> DaySpan:
    start, end = span
    if said.weekday is not None or said.unit == "weekend":
        number = said.weekday if said.weekday is not None else 5
        days = [start + timedelta(days=i) for i in range((end - start).days)]
        hits = [day for day in days if day.weekday() == number]
        index = said.number - 1 if said.number > 0 else said.number
        if not -len(hits) <= index < len(hits):
            raise TimeError("there is no such day in that time")
        return hits[index], hits[index] + timedelta(days=1 + (said.unit == "weekend"))
    if said.unit in ("second", "minute", "hour"):
        raise TimeError("I cannot count hours within it; say from when to when")
    length = {"week": 7, "day": 1}.get(said.unit)
    if length is None:
        months = {"quarter": 3, "half": 6}.get(said.unit, 1)
        number = said.number - 1 if said.number > 0 else 12 // months + said.number
        first = _months_on(start, number * months)
        if not 0 <= number < 12 // months:
            raise TimeError("there is no such part of the year")
        return first, _months_on(first, months)
    if said.number < 0:
        return end - timedelta(days=length), end
    first = start + timedelta(days=length * (said.number - 1))
    if first >= end:
        raise TimeError("there is no such day in that time")
    return first, min(first + timedelta(days=length), end)


def _merged(narrow: tf.Date, wide: tf.Date) -> tf.Date:
    for name in ("year", "month", "day"):
        a, b = getattr(narrow, name), getattr(wide, name)
        if a is not None and b is not None and a != b:
            raise TimeError("it names two different days")
    merged = tf.with_month(narrow, wide)
    return tf.Date(merged.year, merged.month, merged.day if merged.day else wide.day)
