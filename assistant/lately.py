"""What a store saw lately: enough to begin a talk with, at a cost that does not grow with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from d3a.store.base import Sighting, Store

LATELY = 2_000
"""The sightings that are looked at: a few milliseconds of any store."""
_FIRST_SPAN_MS = 3_600_000
_WIDER = 8


def lately(store: Store, count: int = LATELY) -> list[Sighting]:
    """Return all sightings where there are fewer than `count`, else `count` of the latest time.

    That time is an hour, or so much longer that it holds as many; ordered as the store does.
    """
    found = store.sightings(limit=count)
    newest = store.last_view_ms()
    if len(found) < count or newest is None:
        return found
    span = _FIRST_SPAN_MS
    while len(found := store.sightings(start_ms=newest - span, limit=count)) < count:
        span *= _WIDER
    return found
