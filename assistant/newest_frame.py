"""When the newest picture of a store was taken: no question is asked before it by itself."""

from __future__ import annotations

from datetime import datetime

from d3a.store.base import Store


def newest_frame(store: Store, otherwise: datetime) -> datetime:
    """Return the time of the newest frame, in the zone of `otherwise`; that where there is none."""
    newest_ms = store.last_view_ms()
    if newest_ms is None:
        return otherwise
    return datetime.fromtimestamp(newest_ms / 1000, tz=otherwise.tzinfo)
