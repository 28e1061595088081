"""How many things there must be: an id is no proof, a moved thing often gets a new one.

Two objects of one category may be one thing that was carried, unless one round showed both. So
the ids are the most that there may be, and the fullest round tells the least.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from d3a.store.base import Sighting

ROUND_GAP_MS = 600_000
"""Sightings further apart than this are of two rounds: between them a thing may be carried."""


def rounds(sightings: Iterable[Sighting]) -> list[list[Sighting]]:
    """Return the sightings in groups that no gap divides, by time."""
    out: list[list[Sighting]] = []
    end_ms = 0
    for sighting in sorted(sightings, key=lambda s: (s.start_ms, s.end_ms, s.object_id, s.place)):
        if out and sighting.start_ms - end_ms <= ROUND_GAP_MS:
            out[-1].append(sighting)
            end_ms = max(end_ms, sighting.end_ms)
        else:
            out.append([sighting])
            end_ms = sighting.end_ms
    return out


def least_number(sightings: Sequence[Sighting]) -> int:
    """Return how many things of one category there must be: the most objects of one round."""
    return max((len({s.object_id for s in one}) for one in rounds(sightings)), default=0)


def may_be_one(sightings: Sequence[Sighting]) -> bool:
    """Whether the objects of these sightings, of one category, may be fewer than their ids."""
    return least_number(sightings) < len({s.object_id for s in sightings})
