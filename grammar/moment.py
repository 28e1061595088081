"""A moment of a spoken time, and how it is placed on the clock and the calendar."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime, time, timedelta

from grammar import timeforms as tf
from grammar.days import DaySpan, Reference, TimeError, edged, holding, months_on, span_of

DAY_ENDS_AT = 4
"""Until this hour, `this morning` and `tonight` still are those of the day before."""
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
    "brunch": (10, 13),
    "small hours": (0, 5),
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
_WITHIN = {
    "tonight": ("evening", "night", "bedtime", "dinner", "dusk"),
    "evening": ("bedtime", "dinner", "dusk"),
    "night": ("tonight", "bedtime"),
    "morning": ("small hours", "breakfast", "dawn", "brunch"),
    "afternoon": ("lunch", "tea"),
}
"""Parts of the day that lie within another one."""
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
        return self.shifted(moment.replace(tzinfo=self.now.tzinfo), 0)  # an hour skipped is none

    def shifted(self, moment: datetime, seconds: float) -> datetime:
        """Return `moment` shifted by elapsed seconds, over a change of offset too."""
        moved = moment.astimezone(UTC) + timedelta(seconds=seconds)
        return moved.astimezone(self.now.tzinfo)


def before(moment: datetime, length: tf.Length, setting: Setting, sign: int = -1) -> datetime:
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
class Moment:
    """The pieces of one side, sorted out: days, part of the day, clock, or a point by length."""

    days: tuple[tf.Day, ...] = ()
    part: tf.Part | None = None
    part_day: tf.PartDay | None = None
    clock: tf.Clock | None = None
    ago: tf.Ago | None = None
    edge: tf.EdgeName | None = None
    now: bool = False
    same: bool = False
    whole: str | None = None

    @classmethod
    def of(cls, pieces: tf.Pieces) -> Moment:
        """Sort pieces; raises TimeError when two of a kind disagree."""
        moment = cls()
        for piece in pieces:
            match piece:
                case tf.Clock():
                    moment = moment.with_clock(piece)
                case tf.Part() | tf.PartDay():
                    moment = moment.with_part(piece)
                case tf.PartAgo():
                    moment = moment.with_part(tf.Part(piece.name))
                    moment = replace(moment, days=(*moment.days, tf.Days(piece.back)))
                case tf.Whole():
                    moment = replace(moment, whole=piece.unit)
                case tf.Ago():
                    moment = moment.with_ago(piece)
                case tf.Edge():
                    moment = replace(moment, edge=piece.name)
                case tf.Unplaced():
                    raise TimeError(piece.why)
                case tf.Now():
                    moment = replace(moment, now=True)
                case tf.SameTime():
                    moment = replace(moment, same=True)
                case tf.Stamp():
                    moment = replace(moment, days=(*moment.days, piece.date), clock=piece.clock)
                case _:
                    moment = replace(moment, days=(*moment.days, piece))
        return moment

    def with_part(self, part: tf.Part | tf.PartDay) -> Moment:
        """Add a part of the day; a second one that says something else is an error."""
        said = self.part if isinstance(part, tf.Part) else self.part_day
        if said is not None and part.name in _WITHIN.get(said.name, ()):
            said = None  # the narrower one counts
        if said is not None and said.name in _WITHIN.get(part.name, ()):
            return self
        if said is not None and said != part:
            raise TimeError("it names two parts of the day")
        if isinstance(part, tf.Part):
            return replace(self, part=part)
        return replace(self, part_day=part)

    def with_clock(self, clock: tf.Clock) -> Moment:
        """Add a clock time; a second one that says something else is an error."""
        if self.clock is not None and self.clock != clock:
            raise TimeError("it names two clock times")
        return replace(self, clock=clock)

    def with_ago(self, ago: tf.Ago) -> Moment:
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

    def completed(self, other: Moment) -> Moment:
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
        if self.same:
            return self._same_span(setting, after)
        if self.ago is not None:
            return self._ago_span(setting, self.ago)
        if self.clock is not None:
            point = self._point(setting, self.clock, after) + timedelta(seconds=self.clock.second)
            return point, point
        return self._period(setting, after)

    def _same_span(self, setting: Setting, after: datetime | None) -> Span:
        """Return the clock time of asking on another day: this time yesterday, last week."""
        day = self.days[0] if len(self.days) == 1 else None
        if isinstance(day, tf.Calendar) and day.unit in ("week", "fortnight", "month", "year"):
            point = before(setting.now, tf.Length(((day.back, day.unit),)), setting)
            return point, point
        span = self._day_span(setting, after)
        if span is None or (span[1] - span[0]).days > 1:
            raise TimeError("it names no day")
        point = setting.at(span[0], setting.now.hour * 60 + setting.now.minute)
        return point, point

    def _ago_span(self, setting: Setting, ago: tf.Ago) -> Span:
        point = before(setting.now, ago.length, setting)
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
        span = span_of(self.days, ref)
        return span if self.whole is None else holding(span[0], self.whole)

    def part_name(self) -> str | None:
        """Return the part of the day that is named, None where none is."""
        if self.part is not None:
            return self.part.name
        return _PART_OF_DAY[self.part_day.name][0] if self.part_day is not None else None

    def _period(self, setting: Setting, after: datetime | None) -> Span:
        """Return the span of days, or of a part of them."""
        span = self._day_span(setting, after)
        part = self.part_name()
        if self.part is not None and self.part_day is not None:
            named = _PART_OF_DAY[self.part_day.name][0]
            if part not in (named, *_WITHIN.get(named, ())):
                raise TimeError("it names two parts of the day")
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
        minutes = _clock_minutes(clock, self.part_name())
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
