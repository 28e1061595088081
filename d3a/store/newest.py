"""Which sightings count where there are too many to tell: the newest of each stay."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from d3a.store.base import Sighting, StayKey


def newest_of(sightings: Sequence[Sighting], limit: int, *, oldest: bool = False) -> list[Sighting]:
    """Return at most `limit` of the sightings, as `Store.newest` says; both in its order."""
    if len(sightings) <= limit:
        return list(sightings)
    each = max(1, limit // len({sighting.stay for sighting in sightings}))
    taken: Counter[StayKey] = Counter()
    found: list[Sighting] = []
    for sighting in sightings if oldest else reversed(sightings):
        if taken[sighting.stay] < each:
            taken[sighting.stay] += 1
            found.append(sighting)
            if len(found) == limit:
                break
    return found if oldest else found[::-1]
