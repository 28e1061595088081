"""How long a store keeps what was seen: a policy in the store, applied by every ingest.

Age is counted back from the newest frame, not from a clock: a recording of last year is forgotten
as it would have been then, and the same recordings always leave the same store.
"""

from __future__ import annotations

import re

from d3a.correcting.cutting import Slice
from d3a.correcting.forgetting import ForgetPlan, forget, plan_forgetting
from d3a.correcting.forgotten import Selection
from d3a.model import BadInput
from d3a.store.base import Batch, Store

RETENTION = "retention"
"""Key in the store's meta: {"seconds": n}, absent where everything is kept."""
_UNITS = {"h": 3_600, "d": 86_400, "w": 604_800, "y": 31_557_600}
_SPAN = re.compile(r"\s*(\d{1,6})\s*([hdwy])\s*")


def seconds_of(span: str) -> int:
    """Return the seconds of a span such as 12h, 30d, 8w or 1y; raises BadInput for another."""
    found = _SPAN.fullmatch(span.lower())
    if found is None or int(found[1]) == 0:
        raise BadInput(f"{span!r} is no span of time; 12h, 30d, 8w or 1y would do")
    return int(found[1]) * _UNITS[found[2]]


def retention_of(store: Store) -> int | None:
    """Return for how many seconds the store keeps what was seen; None for ever."""
    policy = store.meta(RETENTION)
    return int(policy["seconds"]) if isinstance(policy, dict) else None


def set_retention(store: Store, seconds: int | None) -> None:
    """Keep the policy in the store; None ends it. Nothing is forgotten yet."""
    store.apply(Batch(meta={RETENTION: None if seconds is None else {"seconds": seconds}}))


def plan_retention(store: Store, seconds: int) -> ForgetPlan | None:
    """Find what is older than so many seconds before the newest frame; None for nothing."""
    newest = store.last_view_ms()
    if newest is None:
        return None
    before = newest - seconds * 1000
    old_views = store.views(end_ms=before - 1)
    if not old_views and not store.sightings(end_ms=before - 1, limit=1):
        return None
    plan = plan_forgetting(store, Selection(time=Slice(None, before)))
    return None if plan.is_empty else plan


def retain(store: Store) -> ForgetPlan | None:
    """Apply the store's own policy; return what went, None where nothing had to."""
    seconds = retention_of(store)
    plan = None if seconds is None else plan_retention(store, seconds)
    return None if plan is None else forget(store, plan).plan
