"""Times as files write them: ISO 8601, counts since 1970, or seconds from an unknown start."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from decimal import Decimal, InvalidOperation
from zoneinfo import ZoneInfo

from d3a.model import BadInput
from d3a.readers import parsing

UNDATED = datetime(2000, 1, 1, tzinfo=UTC)
"""Where seconds count from a start whose date nobody noted: a date that nobody takes for real."""
_UNITS = (
    (Decimal(10) ** 11, Decimal(1000)),  # seconds
    (Decimal(10) ** 14, Decimal(1)),
    (Decimal(10) ** 17, Decimal("1e-3")),
    (Decimal(10) ** 20, Decimal("1e-6")),  # nanoseconds
)
"""A count since 1970 below the first number is to be times the second, in milliseconds: a date from
1973 to 5138 has one unit only in which it can have been written."""
_FROM_1970 = Decimal(10) ** 8


@dataclass(slots=True)
class Clock:
    """Reads times of one recording.

    zone: for ISO times without an offset. start_ms: what seconds below 1e8 count from, None where
    unknown: then UNDATED. is_undated: whether that has happened.
    """

    zone: str | None = None
    start_ms: int | None = None
    is_undated: bool = False

    @property
    def origin_ms(self) -> int:
        """What seconds from the start count from: UNDATED where nobody knows."""
        return round(UNDATED.timestamp() * 1000) if self.start_ms is None else self.start_ms

    def ms(self, text: str) -> int:
        """Return UTC milliseconds; BadInput for what is no time, or one without an offset."""
        count = _count(text)
        if count is None or count >= _FROM_1970:
            return self.absolute_ms(text)
        if count < 0:
            raise BadInput(f"the time {parsing.clean_text(text)} is before the start")
        if self.start_ms is None:
            self.is_undated = True
        return self.origin_ms + round(count * 1000)

    def absolute_ms(self, text: str) -> int:
        """Return UTC milliseconds of a time that says its date; BadInput otherwise."""
        count = _count(text)
        if count is not None:
            for limit, factor in _UNITS:
                if _FROM_1970 <= count < limit:
                    return round(count * factor)
            raise BadInput(f"{parsing.clean_text(text)!r} is no time since 1970")
        return self._iso(parsing.clean_text(text))

    def _iso(self, text: str) -> int:
        try:
            moment = datetime.fromisoformat(text)
        except ValueError as error:
            raise BadInput(f"{text!r} is no time: ISO 8601, or a count since 1970") from error
        if moment.tzinfo is None:
            if self.zone is None:
                raise BadInput(f"the time {text!r} has no offset from UTC: --zone would tell it")
            moment = moment.replace(tzinfo=ZoneInfo(self.zone))
        return round(moment.timestamp() * 1000)


def _count(text: str) -> Decimal | None:
    """Return the number that a time is written as, None where it is none; BadInput for NaN."""
    try:
        count = Decimal(text.strip())
    except InvalidOperation:
        return None
    if not count.is_finite():
        raise BadInput(f"the time is {parsing.clean_text(text)}")
    return count
