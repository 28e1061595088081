"""The same thing by another name: a later sighting that the detector called otherwise.

Where the last sighting is asked for, one wrong word of the detector hides it. What was seen next
at the same spot, looks the same and was never beside the thing is most likely the thing. This
only goes on from a find: it cannot turn a no into a yes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.answering.facts import Facts
from d3a.answering.match import Candidate
from d3a.answering.moments import Entry, Found
from d3a.answering.places import sigma_of
from d3a.parameters import Parameters
from d3a.store.base import Area, ObjectRecord, Sighting, StayRecord, Store

LIKELY = 0.5
"""A look-alike is taken in where it is more likely the same thing than not."""
EVEN_LIKENESS = 0.6
"""Bhattacharyya's coefficient at which two boxes show one thing as likely as two."""
LIKENESS_SLOPE = 14.0
"""Log-odds a unit of it: means 0.36 apart with a deviation of 0.16 (same 0.78, other 0.42)."""


def later_names(facts: Facts, entry: Entry, found: Found, parameters: Parameters) -> None:
    """Add to `found` what may be the entry's thing, seen soon after it under another category.

    It keeps match and attributes of the thing, which were judged on more views, and `same` says
    how likely it is the thing.
    """
    position = entry.stay.position if entry.stay is not None else None
    if position is None:
        return
    x, y, reach = position[0], position[1], parameters.near_m
    last_ms = entry.sighting.end_ms
    store = facts.store
    later = store.sightings(
        area=Area(x - reach, y - reach, x + reach, y + reach),
        start_ms=last_ms + 1,
        end_ms=last_ms + round(parameters.interval_gap_s * 1000),
    )
    others = sorted({s.object_id for s in later} - set(found.candidates))
    stays = facts.stays(others)
    later = [s for s in later if same_spot(entry.stay, stays.get(s.stay), parameters)]
    others = sorted({s.object_id for s in later} & set(others))
    if not others:
        return
    own = entry.sighting.object_id
    beside = seen_beside(store, own, others)
    records = store.objects(ids=[own, *(name for name in others if name not in beside)])
    look = next((record.embedding for record in records if record.object_id == own), None)
    if look is None:
        return
    for record in records:
        if record.object_id == own:
            continue
        same = same_look(look, record)
        theirs = [s for s in later if s.object_id == record.object_id]
        if same >= LIKELY and theirs:
            _take_in(found, entry.candidate, record, same, theirs, stays)


def seen_beside(store: Store, object_id: str, others: Sequence[str]) -> set[str]:
    """Return which of some others a frame shows beside an object, so that they are not it."""
    met = store.encounters(object_ids=[object_id], with_ids=others)
    return {name for e in met for name in (e.object_a, e.object_b)} - {object_id}


def same_look(look: NDArray[np.float32], record: ObjectRecord) -> float:
    """Return how likely two histograms show one thing, as the association weighs looks; 0..1."""
    other = record.embedding
    if other is None or len(other) != len(look):
        return 0.0
    a, b = (np.maximum(v, 0.0).astype(np.float64) for v in (look, other))
    if not a.any() or not b.any():
        return 0.0
    likeness = float(np.sqrt(a / a.sum()) @ np.sqrt(b / b.sum()))
    return 1.0 / (1.0 + math.exp(-LIKENESS_SLOPE * (likeness - EVEN_LIKENESS)))


def same_spot(one: StayRecord | None, other: StayRecord | None, parameters: Parameters) -> bool:
    """Whether two stays may be at one spot, by what their positions may be off."""
    if one is None or other is None or one.position is None or other.position is None:
        return False
    apart = math.dist(one.position, other.position)
    return apart <= min(parameters.near_m, 2 * math.hypot(sigma_of(one), sigma_of(other)))


def _take_in(
    found: Found,
    thing: Candidate,
    record: ObjectRecord,
    same: float,
    sightings: list[Sighting],
    stays: dict[tuple[str, int], StayRecord],
) -> None:
    found.candidates[record.object_id] = Candidate(
        record, thing.match, dict(thing.attributes), same
    )
    found.sightings += sightings
    for sighting in sightings:
        found.stays[sighting.stay] = stays[sighting.stay]
