"""Records with a time slice cut out: what forgetting a time leaves of them.

Slices are [start, end), None is open; a sighting's interval is closed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from d3a.store.base import ObjectRecord, Sighting, StayRecord, View


@dataclass(frozen=True, slots=True)
class Slice:
    """A time slice in UTC milliseconds, [start, end); None is open."""

    start_ms: int | None = None
    end_ms: int | None = None

    @property
    def is_open(self) -> bool:
        """Whether it is all of time."""
        return self.start_ms is None and self.end_ms is None

    def holds(self, time_ms: int) -> bool:
        """Whether a moment is in it."""
        early = self.start_ms is not None and time_ms < self.start_ms
        return not early and (self.end_ms is None or time_ms < self.end_ms)

    def cuts(self, time_ms: int) -> bool:
        """Whether a moment is in it, where it is less than all of time."""
        return not self.is_open and self.holds(time_ms)

    def touches(self, start_ms: int, end_ms: int) -> bool:
        """Whether it shares a millisecond with a closed interval."""
        early = self.start_ms is not None and end_ms < self.start_ms
        return not early and (self.end_ms is None or start_ms < self.end_ms)

    def left_of(self, start_ms: int, end_ms: int) -> list[tuple[int, int]]:
        """Return the parts of a closed interval that are not in it: none, one or two."""
        parts = []
        if self.start_ms is not None and start_ms < self.start_ms:
            parts.append((start_ms, min(end_ms, self.start_ms - 1)))
        if self.end_ms is not None and end_ms >= self.end_ms:
            parts.append((max(start_ms, self.end_ms), end_ms))
        return parts


def share(count: int, part: tuple[int, int], whole: tuple[int, int]) -> int:
    """Return how many of the frames of a closed interval fall into a part of it, one at least."""
    length = whole[1] - whole[0] + 1
    return max(1, round(count * (part[1] - part[0] + 1) / length))


def cut_sighting(record: Sighting, time: Slice) -> Sighting | None:
    """Return what is left of a sighting: the part around its keyframe; None without that part.

    What lies beyond the slice from its keyframe goes too: no picture would prove it.
    """
    shown = record.start_ms if record.keyframe_ms is None else record.keyframe_ms
    if time.holds(shown):
        return None
    for part in time.left_of(record.start_ms, record.end_ms):
        if part[0] <= shown <= part[1]:
            seen = share(record.seen, part, (record.start_ms, record.end_ms))
            return replace(record, start_ms=part[0], end_ms=part[1], seen=seen)
    return None


def cut_view(record: View, time: Slice) -> list[View]:
    """Return what is left of a view."""
    whole = (record.start_ms, record.end_ms)
    return [
        replace(record, start_ms=part[0], end_ms=part[1], frames=share(record.frames, part, whole))
        for part in time.left_of(*whole)
    ]


def lessened_stay(
    record: StayRecord, left: Sequence[Sighting], time: Slice, gone_places: Iterable[int]
) -> StayRecord:
    """Return a stay that has only the sightings `left`, one at least.

    Its position stays the mean of all views: a mean cannot be unmixed.
    """
    seen = min(record.seen, sum(sighting.seen for sighting in left))
    moved = record.moved_from
    absent = record.last_absent_ms
    return replace(
        record,
        first_ms=min(sighting.start_ms for sighting in left),
        last_ms=max(sighting.end_ms for sighting in left),
        seen=seen,
        weight=record.weight * seen / record.seen if record.seen else record.weight,
        moved_from=None if moved is not None and moved[0] in set(gone_places) else moved,
        last_absent_ms=None if absent is not None and time.cuts(absent) else absent,
    )


def lessened_object(
    record: ObjectRecord, before: Sequence[StayRecord], left: Sequence[StayRecord]
) -> ObjectRecord:
    """Return an object that had the stays `before` and has only those `left`, one at least.

    Its look stays the mean of all views.
    """
    seen_before = sum(stay.seen for stay in before)
    part = sum(stay.seen for stay in left) / seen_before if seen_before else 1.0
    return replace(
        record,
        first_ms=min(stay.first_ms for stay in left),
        last_ms=max(stay.last_ms for stay in left),
        weight=record.weight * part,
        categories=tuple((category, weight * part) for category, weight in record.categories),
    )
