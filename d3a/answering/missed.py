"""When a place was first looked at without the thing that was known later to be gone from it.

The store keeps the newest look that told so. The first one narrows down when a thing went: of one
that was looked for each evening a week ago, the newest says a week. A look before the one that
settled it may have overlooked the thing, so that it is told as what it was: it was not seen then.
"""

from __future__ import annotations

from d3a.answering.departures import Looks
from d3a.answering.distinct import ROUND_GAP_MS
from d3a.store.base import StayRecord, Store

_FIRST_WINDOW_MS = 3_600_000
"""So long after a thing was seen last looks are read first, then for twice as long and so on: what
a robot keeps looking at needs few of them."""


def first_missed(store: Store, stay: StayRecord, last_ms: int) -> int | None:
    """Return when a later round first looked at a stay's place, before it was seen without it.

    last_ms: when the thing was seen there last. None where it is not known to have gone, where no
    earlier round looked there, and where poses are unknown. Raises StoreError.
    """
    absent_ms = stay.last_absent_ms
    if absent_ms is None:
        return None
    begin_ms, length_ms = last_ms + ROUND_GAP_MS, _FIRST_WINDOW_MS
    until_ms = absent_ms - ROUND_GAP_MS
    while begin_ms < until_ms:
        end_ms = min(begin_ms + length_ms, until_ms)
        views = store.views(start_ms=begin_ms, end_ms=end_ms)
        looks = Looks([view for view in views if view.start_ms >= begin_ms]).at(stay, end_ms)
        if looks:
            return looks[0][0]
        begin_ms, length_ms = end_ms + 1, 2 * length_ms
    return None
