"""Spoken times against a clock: `resolve` turns what was said into a slice of the past.

All results are in the zone of `now`, day lengths and offsets as that zone has them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, time, timedelta

from grammar import timeforms as tf
from grammar.days import DaySpan, Reference, TimeError, edged, months_on, ordered, span_of
from grammar.forms import TimeSlice

DAY_ENDS_AT = 4
"""Until this hour, `this morning` and `tonight` still are those of the day before."""
AROUND = timedelta(minutes=30)
PART_HOURS: dict[str, tuple[int, int]] = {
    "morning": (5, 12),
    "afternoon": (12, 18),
    "evening": (18, 22),
    "night": (22, 29),
    "tonight": (18, 29),
    "day": (5, 18),
    "midday": (11, 13),
    "breakfast": (6, 9),
    "lunch": (11, 14),
    "tea": (16, 18),
    "dinner": (18, 20),
    "bedtime": (21, 24),
    "dawn": (5, 7),
    "dusk": (18, 20),
}
"""Part of the day -> hours from the day's midnight; beyond 24 is the next morning."""
_PART_OF_DAY: dict[str, tuple[str, int]] = {
    "tonight": ("tonight", 0),
    "last night": ("tonight", 1),
    "yesterday night": ("night", 1),
    "night before last": ("tonight", 2),
    "yesterday evening": ("evening", 1),
    "yesterday afternoon": ("afternoon", 1),
    "yesterday morning": ("morning", 1),
    "this morning": ("morning", 0),
    "this afternoon": ("afternoon", 0),
    "this evening": ("evening", 0),
}
_SECONDS = {"second": 1, "minute": 60, "hour": 3600, "day": 86400, "week": 604800,
            "fortnight": 1209600, "weekend": 604800}  # fmt: skip
Span = tuple[datetime, datetime]


@dataclass(frozen=True, slots=True)
class Setting:
    """The moment of asking, and how its country writes a date in digits."""

    now: datetime
    month_first: bool | None

    @property
    def logical_today(self) -> date:
        """The day that `this morning` belongs to: the old one until 04:00."""
        early = self.now.hour < DAY_ENDS_AT
        return self.now.date() - timedelta(days=1) if early else self.now.date()

    def at(self, day: date, minutes: int) -> datetime:
        """Return the moment `minutes` of clock time after the day's midnight."""
        days, rest = divmod(minutes, 24 * 60)
        moment = datetime.combine(day + timedelta(days=days), time(rest // 60, rest % 60))
        return moment.replace(tzinfo=self.now.tzinfo)

    def shifted(self, moment: datetime, seconds: float) -> datetime:
        """Return `moment` shifted by elapsed seconds, over a change of offset too."""
        moved = moment.astimezone(UTC) + timedelta(seconds=seconds)
        return moved.astimezone(self.now.tzinfo)


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
        start, end = _Moment.of(said.pieces).span(setting)
        anchor = start if said.offset_sign < 0 else end
        point = _before(anchor, said.offset, setting, said.offset_sign)
        return TimeSlice(point, point)
    if not said.bounds:
        return TimeSlice(*_Moment.of(said.pieces).span(setting))
    slices = [_bound(bound, said.pieces, setting) for bound in said.bounds]
    starts = [s.start for s in slices if s.start is not None]
    ends = [s.end for s in slices if s.end is not None]
    if said.pieces and any(b.kind in ("since", "until", "before", "after") for b in said.bounds):
        outer = _Moment.of(said.pieces).span(setting)
        if outer[0] < outer[1]:
            starts.append(outer[0])
            ends.append(outer[1])
    start, end = (max(starts) if starts else None), (min(ends) if ends else None)
    if start is not None and end is not None and end < start:
        raise TimeError("it ends before it starts")
    return TimeSlice(start, end)


def _bound(bound: tf.Bound, around: tf.Pieces, setting: Setting) -> TimeSlice:
    if bound.length is not None:
        return TimeSlice(_before(setting.now, bound.length, setting), setting.now)
    if bound.kind == "between":
        return _between(bound.sides[0], bound.sides[1], around, setting)
    moment = _Moment.of(bound.sides[0]).completed(_Moment.of(around))
    start, end = moment.span(setting)
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


def _before(moment: datetime, length: tf.Length, setting: Setting, sign: int = -1) -> datetime:
    """Return `moment` moved by a length; months and years by the calendar."""
    seconds, months = 0.0, 0.0
    for count, unit in length.amounts:
        if unit in _SECONDS and not (
            unit in ("day", "week", "fortnight", "weekend") and count == int(count)
        ):
            seconds += count * _SECONDS[unit]
        elif unit in _SECONDS:
            days = int(count) * _SECONDS[unit] // 86400
            local = moment.replace(tzinfo=None) + timedelta(days=sign * days)
            moment = local.replace(tzinfo=setting.now.tzinfo)
        else:
            months += count * {"month": 1, "year": 12, "decade": 120}[unit]
    if months:
        day = months_on(moment.date(), sign * int(months))
        moment = moment.replace(year=day.year, month=day.month, day=day.day)
    return setting.shifted(moment, sign * seconds) if seconds else moment


@dataclass(frozen=True, slots=True)
class _Moment:
    """The pieces of one side, sorted out: days, part of the day, clock, or a point by length."""

    days: tuple[tf.Day, ...] = ()
    part: tf.Part | None = None
    part_day: tf.PartDay | None = None
    clock: tf.Clock | None = None
    ago: tf.Ago | None = None
    edge: tf.EdgeName | None = None
    now: bool = False

    @classmethod
    def of(cls, pieces: tf.Pieces) -> _Moment:
        """Sort pieces; raises TimeError when two of a kind disagree."""
        moment = cls()
        for piece in pieces:
            match piece:
                case tf.Clock():
                    moment = moment.with_clock(piece)
                case tf.Part():
                    moment = replace(moment, part=piece)
                case tf.PartDay():
                    moment = replace(moment, part_day=piece)
                case tf.Ago():
                    moment = moment.with_ago(piece)
                case tf.Edge():
                    moment = replace(moment, edge=piece.name)
                case tf.Now():
                    moment = replace(moment, now=True)
                case tf.Stamp():
                    moment = replace(moment, days=(*moment.days, piece.date), clock=piece.clock)
                case _:
                    moment = replace(moment, days=(*moment.days, piece))
        return moment

    def with_clock(self, clock: tf.Clock) -> _Moment:
        """Add a clock time; a second one that says something else is an error."""
        if self.clock is not None and self.clock != clock:
            raise TimeError("it names two clock times")
        return replace(self, clock=clock)

    def with_ago(self, ago: tf.Ago) -> _Moment:
        """Add `N units ago`: whole days count as a day, months and years too."""
        amounts = ago.length.amounts
        if len(amounts) == 1 and amounts[0][0] == int(amounts[0][0]):
            count, unit = int(amounts[0][0]), amounts[0][1]
            per = {"day": 1, "week": 7, "fortnight": 14}.get(unit)
            if unit == "weekend":
                weekend = tf.Weekend(last=True, back=count - 1)
                return replace(self, days=(*self.days, weekend))
            if per is not None:
                return replace(self, days=(*self.days, tf.Days(count * per)))
        return replace(self, ago=ago)

    @property
    def dated(self) -> bool:
        """Whether a day is named."""
        return bool(self.days) or self.part_day is not None or self.ago is not None or self.now

    def completed(self, other: _Moment) -> _Moment:
        """Return this moment with the day and part of the day of `other` where it has none."""
        filled = self
        if not self.dated:
            filled = replace(filled, days=other.days, part_day=other.part_day, ago=other.ago)
        if filled.part is None and self.clock is not None:
            filled = replace(filled, part=other.part)
        return filled

    # -- resolving -----------------------------------------------------------------------------

    def span(self, setting: Setting, after: datetime | None = None) -> Span:
        """Return (start, end), equal for a point; the last past one, or the first after `after`."""
        if self.now and self.clock is None and not self.days:
            return setting.now, setting.now
        if self.ago is not None:
            return self._ago_span(setting, self.ago)
        if self.clock is not None:
            point = self._point(setting, self.clock, after)
            return point, point
        return self._period(setting, after)

    def _ago_span(self, setting: Setting, ago: tf.Ago) -> Span:
        point = _before(setting.now, ago.length, setting)
        units = {unit for _, unit in ago.length.amounts}
        if units <= {"month", "year", "decade", "day", "week"} and units & {
            "month",
            "year",
            "decade",
        }:
            moment = replace(self, ago=None, days=(tf.Date(point.year, point.month, point.day),))
            return moment.span(setting)
        return point, point

    def _day_span(self, setting: Setting, after: datetime | None) -> DaySpan | None:
        """Return the dates that are named, None where none are."""
        if self.part_day is not None:
            back = _PART_OF_DAY[self.part_day.name][1]
            base = setting.logical_today if back == 0 else setting.now.date()
            day = base - timedelta(days=back)
            return day, day + timedelta(days=1)
        if not self.days:
            return None
        ref = Reference(setting.now.date(), after.date() if after else None, setting.month_first)
        return span_of(self.days, ref)

    def _part_name(self) -> str | None:
        if self.part is not None:
            return self.part.name
        return _PART_OF_DAY[self.part_day.name][0] if self.part_day is not None else None

    def _period(self, setting: Setting, after: datetime | None) -> Span:
        """Return the span of days, or of a part of them."""
        span = self._day_span(setting, after)
        part = self._part_name()
        if part is None:
            if span is None:
                raise TimeError("it names no time")
            if self.edge is not None and (span[1] - span[0]).days == 1:
                minutes = _edge_minutes(0, 24 * 60, self.edge)
                return setting.at(span[0], minutes[0]), setting.at(span[0], minutes[1])
            span = edged(span, self.edge)
            return setting.at(span[0], 0), setting.at(span[1], 0)
        first, last = PART_HOURS[part]
        start_minute, end_minute = _edge_minutes(first * 60, last * 60, self.edge)
        if span is None:
            day = after.date() if after else setting.logical_today
            if not after and setting.at(day, start_minute) > setting.now:
                day -= timedelta(days=1)
            span = day, day + timedelta(days=1)
        last_day = span[1] - timedelta(days=1)
        return setting.at(span[0], start_minute), setting.at(last_day, end_minute)

    def _point(self, setting: Setting, clock: tf.Clock, after: datetime | None) -> datetime:
        """Return the moment of a clock time on its day."""
        minutes = _clock_minutes(clock, self._part_name())
        span = self._day_span(setting, after)
        if span is not None and (span[1] - span[0]).days > 1:
            raise TimeError("a clock time needs a day")
        if span is None and after is not None:
            options = [
                setting.at(after.date() + timedelta(days=d), m) for d in (0, 1) for m in minutes
            ]
            return min(option for option in options if option > after)
        if span is None:
            today = setting.now.date()
            options = [
                setting.at(today - timedelta(days=d), m) for d in (-1, 0, 1, 2) for m in minutes
            ]
            return max(option for option in options if option <= setting.now)
        options = [setting.at(span[0], m) for m in minutes]
        if len(options) == 1:
            return options[0]
        if span[0] == setting.now.date():
            past = [option for option in options if option <= setting.now]
            return max(past) if past else min(options)
        return next(option for option in options if 7 <= option.hour < 19)


def _edge_minutes(start: int, end: int, edge: tf.EdgeName | None) -> tuple[int, int]:
    middle = (start + end) // 2
    if edge == "early":
        return start, middle
    if edge == "late":
        return middle, end
    return start, end


def _clock_minutes(clock: tf.Clock, part: str | None) -> list[int]:
    """Return the minutes after midnight that a clock time may mean, one or two of them."""
    if clock.hour == 24 and clock.exact:
        return [clock.minute if part == "morning" else 24 * 60]
    if clock.exact or clock.hour > 12:
        hour = clock.hour % 24
        late_night = part in ("night", "tonight") and hour < 6 and not clock.meridiem
        return [(hour + 24 * late_night) * 60 + clock.minute]
    hour = clock.hour % 12
    if clock.meridiem is not None:
        night = part in ("night", "tonight") and clock.meridiem == "am" and hour < 6
        return [(hour + 12 * (clock.meridiem == "pm") + 24 * night) * 60 + clock.minute]
    if part == "morning":
        return [hour * 60 + clock.minute]
    if part in ("night", "tonight"):
        late = hour if hour >= 5 else hour + 12
        return [(late + 12) * 60 + clock.minute]
    if part is not None and not (part in ("lunch", "midday", "day") and hour >= 10):
        return [(hour + 12) * 60 + clock.minute]
    if hour == 0:
        return [12 * 60 + clock.minute]
    return [hour * 60 + clock.minute, (hour + 12) * 60 + clock.minute]


def _between(first: tf.Pieces, second: tf.Pieces, around: tf.Pieces, setting: Setting) -> TimeSlice:
    """Resolve both sides of an interval, each lending the other what it left out."""
    a, b = _dates_from_numbers(_Moment.of(first), _Moment.of(second))
    context = _Moment.of(around)
    if a.clock and b.clock and not b.dated and not a.dated:
        a, b = a.completed(context), b
        if b.part is None and a.part is None and context.part is not None:
            b = replace(b, part=context.part)
        b = replace(b, part=b.part or a.part)
    elif not a.dated and b.dated and a.clock is not None:
        a = a.completed(b)
    a, b = _shared_dates(a, b)
    a = _shared_meridiem(a, b)
    if not a.dated:
        a = a.completed(context)
    part_of_context = context._part_name()
    if b.clock is not None and not b.dated and b.part is None and part_of_context is not None:
        b = replace(b, part=tf.Part(part_of_context))
    start, start_end = a.span(setting)
    same_day = a.dated and a.days == b.days and a.part_day == b.part_day
    night = a._part_name() in ("night", "tonight") and b._part_name() in ("night", "tonight")
    if b.clock is not None and same_day:
        b = replace(b, days=(), part_day=None)
    if b.clock is not None and not b.dated and night:
        b = replace(b, part=None)
    _, end = b.span(setting, after=None if same_day and b.clock is None else start)
    if end < start:
        raise TimeError("it ends before it starts")
    return TimeSlice(start, max(end, start_end if a.clock is None and end == start else end))


def _dates_from_numbers(a: _Moment, b: _Moment) -> tuple[_Moment, _Moment]:
    """Read a bare number beside a date as a day of the month: `from 2 to 10 july`."""
    if a.clock and a.clock.bare and not a.days and _has_day(b) and b.clock is None:
        a = replace(a, clock=None, days=(tf.Date(None, None, a.clock.hour),))
    if b.clock and b.clock.bare and not b.days and _has_day(a) and a.clock is None:
        b = replace(b, clock=None, days=(tf.Date(None, None, b.clock.hour),))
    return a, b


def _has_day(moment: _Moment) -> bool:
    return any(isinstance(day, tf.Date) and day.day is not None for day in moment.days)


def _shared_dates(a: _Moment, b: _Moment) -> tuple[_Moment, _Moment]:
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


def _shared_meridiem(a: _Moment, b: _Moment) -> _Moment:
    """Lend the second clock's am or pm to the first: `between 5 and 6pm`, `11 to 1 pm`."""
    if a.clock is None or b.clock is None or a.clock.meridiem or a.clock.exact:
        return a
    if b.clock.hour == 24 or (b.clock.exact and b.clock.hour == 12) or a._part_name():
        return a
    if b.clock.meridiem is None:
        return a
    first = a.clock.hour % 12 * 60 + a.clock.minute
    second = b.clock.hour % 12 * 60 + b.clock.minute
    other = "am" if b.clock.meridiem == "pm" else "pm"
    meridiem = b.clock.meridiem if first < second else other
    return replace(a, clock=replace(a.clock, meridiem=meridiem))


__all__ = ["Setting", "TimeError", "ordered", "resolve"]
