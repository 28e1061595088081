"""What a spoken time says, before it is resolved against a clock."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

EdgeName = Literal["early", "mid", "late"]


@dataclass(frozen=True, slots=True)
class Edge:
    """The beginning, middle or end of the period that is named with it."""

    name: EdgeName


@dataclass(frozen=True, slots=True)
class Whole:
    """The week or weekend that holds the day named with it."""

    unit: str


@dataclass(frozen=True, slots=True)
class Clock:
    """A time of day. meridiem: am or pm as said. exact: a 24-hour time, read as it stands.

    bare: only a number was said, which beside a date may be a day of the month.
    """

    hour: int
    minute: int = 0
    meridiem: str | None = None
    exact: bool = False
    bare: bool = False
    second: int = 0


@dataclass(frozen=True, slots=True)
class Days:
    """Whole days back from today: 0 is today."""

    back: int


@dataclass(frozen=True, slots=True)
class Weekday:
    """A day of the week, Monday 0. which: gone (today counts), last (it does not), this week's.

    back: how many of them ago: two mondays ago is 2.
    """

    number: int
    which: Literal["gone", "last", "this"] = "gone"
    back: int = 1


@dataclass(frozen=True, slots=True)
class Date:
    """A date with what was said of it; a month or year without a day is the whole of it."""

    year: int | None = None
    month: int | None = None
    day: int | None = None
    last: bool = False
    slashed: bool = False


@dataclass(frozen=True, slots=True)
class Calendar:
    """A calendar week, month or year, `back` of them ago; 0 is the current one."""

    unit: str
    back: int


@dataclass(frozen=True, slots=True)
class Weekend:
    """Saturday and Sunday. last: one that is over, not the one that runs. back: weeks before it."""

    last: bool = False
    back: int = 0


@dataclass(frozen=True, slots=True)
class Nth:
    """The n-th week, day or weekday of a month or year; -1 is the last."""

    number: int
    unit: str
    weekday: int | None = None


@dataclass(frozen=True, slots=True)
class Holiday:
    """A holiday: a month and day, or month 0 and the number of a rule."""

    month: int
    day: int
    year: int | None = None


@dataclass(frozen=True, slots=True)
class Season:
    """Three months from the first of `month`."""

    month: int
    year: int | None = None
    last: bool = False


@dataclass(frozen=True, slots=True)
class Decade:
    """Ten years from `year`; of a year below 100, the last such ten years that have begun."""

    year: int


@dataclass(frozen=True, slots=True)
class Length:
    """A length of time: (count, unit) pairs."""

    amounts: tuple[tuple[float, str], ...]


@dataclass(frozen=True, slots=True)
class Ago:
    """A length of time before now."""

    length: Length


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the day: morning, night."""

    name: str


@dataclass(frozen=True, slots=True)
class PartAgo:
    """A part of the day `back` days ago: three evenings ago."""

    name: str
    back: int


@dataclass(frozen=True, slots=True)
class PartDay:
    """A part of a certain day: last night, this morning."""

    name: str


@dataclass(frozen=True, slots=True)
class Now:
    """The moment of asking."""


@dataclass(frozen=True, slots=True)
class SameTime:
    """The clock time of asking, on the day that is named with it."""


@dataclass(frozen=True, slots=True)
class Stamp:
    """A date and time in digits."""

    date: Date
    clock: Clock


@dataclass(frozen=True, slots=True)
class Unplaced:
    """What names no one time, and why: every morning, a quarter past."""

    why: str


Day: TypeAlias = Days | Weekday | Date | Calendar | Weekend | Nth | Holiday | Season | Decade
Piece: TypeAlias = (
    Day | Clock | Ago | Edge | Whole | Part | PartAgo | PartDay | Now | SameTime | Stamp | Unplaced
)
Pieces: TypeAlias = tuple[Piece, ...]


@dataclass(frozen=True, slots=True)
class Bound:
    """An interval by its sides.

    kind: between, since, until, before, after, around, past, both (all sides in a row), or what is
    next to its side: "week before", "night after".
    """

    kind: str
    sides: tuple[Pieces, ...] = ()
    length: Length | None = None


@dataclass(frozen=True, slots=True)
class SpokenTime:
    """A whole spoken time: free pieces, and the intervals that narrow them.

    offset: a length before (negative) or after the pieces: "an hour before noon".
    """

    pieces: Pieces = ()
    bounds: tuple[Bound, ...] = ()
    offset: Length | None = None
    offset_sign: int = 0


def with_month(date: Date, other: Date) -> Date:
    """Return `date` with the month and year of `other` where it has none."""
    return replace(
        date,
        month=date.month if date.month is not None else other.month,
        year=date.year if date.year is not None else other.year,
    )
