"""Default profile: two things in memory that are one.

A bad position or look may found a second thing beside a known one; then detections go now to the
one, now to the other. They are made one when a look finds one and misses the other, where place,
look and category all say the same, and no frame ever showed both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.known import Known, Place
from d3a.ledger import Ledger
from d3a.likelihood import BESIDE, OTHER, VARIANCES, CategoryModel, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Memory
from d3a.moves import rename
from d3a.neighbours import Neighbours
from d3a.parameters import Parameters
from d3a.sightings import Interval, joined
from d3a.store.base import StayKey
from d3a.symmetric import FULL, of_rows

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Evidence:
    """What tells two things apart."""

    memory: Memory
    space: LookSpace
    looks: LookModel
    categories: CategoryModel
    neighbours: Neighbours
    parameters: Parameters

    def near(self, missed: list[Known], found: list[Known]) -> list[tuple[Known, list[Known]]]:
        """Return what was missed with those of the found things that are within its gate.

        Things with names, several places or no position are left alone; so is what has none near,
        and what was seen beside the other.
        """
        ones, others = ([t for t in each if _is_simple(t)] for each in (missed, found))
        if not ones or not others:
            return []
        away, spread = self._apart(ones, others)
        gate = self.parameters.gate_sigmas**2
        # no pair within the gate is outside of this
        i, j = np.nonzero(np.logical_and.reduce(away**2 <= gate * spread[VARIANCES], axis=0))
        if len(i) == 0:
            return []
        squared, _ = likelihood.squared_distances(away[:, i, j], spread[:, i, j])
        near: dict[int, list[Known]] = {}
        for k in np.flatnonzero(squared <= gate).tolist():
            one, other = ones[i[k]], others[j[k]]
            if other is not one and other.number not in one.met:
                near.setdefault(int(i[k]), []).append(other)
        return [(ones[k], each) for k, each in near.items()]

    def _apart(self, ones: list[Known], others: list[Known]) -> tuple[Floats, Floats]:
        """Return (3, n, m) how far apart things at one place each are, and (6, n, m) how surely."""
        columns = self.memory.positions.columns
        a, b = (columns[:, [t.places[0].row for t in each]] for each in (ones, others))
        return a[:3, :, None] - b[:3, None], a[3:, :, None] + b[3:, None]

    def odds(self, thing: Known, others: list[Known]) -> list[float]:
        """Return the log-odds that a thing is each of some others, by all but time.

        All are at one place each.
        """
        away, spread = (each[:, 0] for each in self._apart([thing], others))
        squared, determinant = likelihood.squared_distances(away, spread)
        name = (thing.category, thing.weight / thing.seen)
        parts = self.categories.evidence([name], [other.shares for other in others])
        agreed, differing = (part[0] for part in parts)
        beside_m3 = self.neighbours.space_m3((away**2).sum(axis=0))
        spaces = (self.parameters.space_m3, beside_m3)
        place, beside = likelihood.position_ratios(squared, determinant, spaces, self.parameters)
        agreed, differing = agreed + place, differing + beside
        if thing.look_weight > 0 and any(other.look_weight > 0 for other in others):
            looks, weights = self.memory.looks, np.array([other.look_weight for other in others])
            likeness = looks.units(others, self.space) @ looks.units([thing], self.space)[0]
            views = np.minimum(weights, thing.look_weight)
            same = self.looks.against(likeness.astype(np.float64), views, (OTHER, BESIDE))[:, 0]
            same[:, weights == 0] = 0.0
            agreed, differing = agreed + same[0], differing + same[1]
        odds: list[float] = np.logaddexp(agreed, differing).tolist()
        return odds


def likely_same(missed: Known, near: list[Known], evidence: Evidence) -> list[Known]:
    """Return which of the found things near a missed one it may be, the likeliest first."""
    if not near:
        return []
    scored = zip(evidence.odds(missed, near), near, strict=True)
    likely = [each for each in scored if each[0] >= evidence.parameters.merge_odds]
    return [thing for _, thing in sorted(likely, key=lambda each: (-each[0], each[1].number))]


def never_together(thing: Known, others: list[Known], ledger: Ledger) -> Known | None:
    """Return the first of `others` that no frame shows beside `thing`; all is written."""
    met: set[str] = set()
    ids = [other.object_id for other in others]
    for encounter in ledger.encounters(thing.object_id, with_ids=ids):
        met |= {encounter.object_a, encounter.object_b}
    for other in others:
        if other.object_id not in met:
            return other
        thing.met.add(other.number)  # not to be asked again
    return None


def _is_simple(thing: Known) -> bool:
    return (
        len(thing.places) == 1 and thing.row >= 0 and thing.places[0].row >= 0 and not thing.names
    )


def merge(
    one: Known, other: Known, memory: Memory, ledger: Ledger, parameters: Parameters
) -> tuple[StayKey, StayKey]:
    """Make two things one, in the memory and in what is written; the older keeps its id.

    Returns the stay that was, and the one that it is part of now.
    """
    kept, gone = (one, other) if one.number < other.number else (other, one)
    place, lost = kept.places[0], gone.places[0]
    becomes, was = (kept.object_id, place.number), (gone.object_id, lost.number)
    sightings = ledger.sightings([kept.object_id, gone.object_id])
    encounters = ledger.encounters(gone.object_id)
    ledger.remove_object(gone.object_id)
    for sighting in sightings:
        if sighting.stay == becomes:
            ledger.remove_sighting(sighting)
    seen = (Interval.from_sighting(each) for each in sightings)
    intervals = joined(seen, parameters, parameters.unbroken_gap_s)
    for interval in intervals:
        ledger.put_sighting(interval.sighting(becomes))
    for encounter in encounters:
        if (renamed := rename(encounter, was, becomes)) is not None:
            ledger.put_encounter(renamed)
    place.open = intervals[-1] if intervals else place.open
    _join(kept, gone, memory, parameters)
    return was, becomes


def _join(kept: Known, gone: Known, memory: Memory, parameters: Parameters) -> None:
    place, lost = kept.places[0], gone.places[0]
    _join_positions(place, lost, memory, parameters)
    for category, weight in gone.votes.items():
        kept.vote(category, weight)
    look = memory.looks.of(gone)
    if look is not None:
        memory.looks.blend(kept, look, gone.look_weight, parameters.looks_remembered)
    for into, of in ((kept, gone), (place, lost)):
        into.weight += of.weight
        into.seen += of.seen
        into.first_ms = min(into.first_ms, of.first_ms)
        into.last_ms = max(into.last_ms, of.last_ms)
    if place.last_absent_ms is not None and place.last_absent_ms < place.last_ms:
        place.last_absent_ms = None
    place.hits += lost.hits
    place.chances = max(place.chances, place.hits)
    place.misses, place.throughs, place.evidence, place.missed_from = 0, 0, 0.0, []
    place.seen_from = [*place.seen_from, *lost.seen_from]
    kept.met |= gone.met
    kept.dirty = True
    memory.remove(gone)


def _join_positions(place: Place, lost: Place, memory: Memory, parameters: Parameters) -> None:
    """Average both positions by what is known of each."""
    positions = memory.positions
    a, b = place.row, lost.row
    precision = np.linalg.inv(positions.error[[a, b]][:, FULL].reshape(2, 3, 3))
    error = np.linalg.inv(precision[0] + precision[1])
    for means in (positions.mean, positions.raw):
        means[a] = error @ (precision[0] @ means[a] + precision[1] @ means[b])
    positions.error[a] = of_rows(error.ravel().tolist())
    positions.scale[a] += positions.scale[b]
    positions.respread([a], parameters)
