"""Default profile: two things in memory that are one.

A bad position or look may found a second thing beside a known one; then detections go now to the
one, now to the other. They are made one when a look finds one and misses the other, where place,
look and category all say the same, and no frame ever showed both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from d3a import likelihood
from d3a.ledger import Ledger
from d3a.likelihood import BESIDE, CategoryModel, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Known, Memory, Place
from d3a.moves import rename
from d3a.neighbours import Neighbours
from d3a.parameters import Parameters
from d3a.sightings import Interval, joined
from d3a.store.base import StayKey


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

        Things with names, several places or no position are left alone; so is what has none near.
        """
        ones, others = ([t for t in each if _is_simple(t)] for each in (missed, found))
        if not ones or not others:
            return []
        positions = self.memory.positions
        row, rows = ([thing.places[0].row for thing in each] for each in (ones, others))
        away = positions.mean[row][:, None] - positions.mean[rows]
        axes = (0, 1, 2)
        variance = positions.spread[:, axes, axes]
        gate = self.parameters.gate_sigmas**2
        reach = gate * (variance[row][:, None] + variance[rows])
        near = np.all(away**2 <= reach, axis=2)  # no pair within the gate is outside of this
        i, j = np.nonzero(near)
        if len(i) == 0:
            return []
        spread = positions.spread[np.array(row)[i]] + positions.spread[np.array(rows)[j]]
        squared, _ = likelihood.mahalanobis(away[i, j], spread)
        near[i, j] = squared <= gate
        return [
            (thing, [others[k] for k in np.flatnonzero(line).tolist()])
            for thing, line in zip(ones, near, strict=True)
            if line.any()
        ]

    def odds(self, thing: Known, other: Known) -> float:
        """Return the log-odds that both, at one place each, are the same thing; by all but time."""
        positions = self.memory.positions
        row, at = thing.places[0].row, other.places[0].row
        apart = positions.mean[row] - positions.mean[at]
        spread = positions.spread[row] + positions.spread[at]
        squared, determinant = likelihood.mahalanobis(apart, spread)
        name = (thing.category, thing.weight / thing.seen)
        agreed, differing = (
            float(part[0, 0]) for part in self.categories.evidence([name], [other.shares])
        )
        space_m3 = self.neighbours.space_m3(np.array(np.linalg.norm(apart)))
        place, beside = (
            float(likelihood.position_ratio(squared, determinant, space, self.parameters))
            for space in (self.parameters.space_m3, space_m3)
        )
        agreed, differing = agreed + place, differing + beside
        a, b = self.memory.looks.of(thing), self.memory.looks.of(other)
        if a is not None and b is not None:
            views = np.array([min(thing.look_weight, other.look_weight)])
            one, two = self.space.of(np.stack([a, b]))
            likeness = np.array([[float(one @ two)]])
            agreed += float(self.looks.ratios(likeness, views)[0, 0])
            differing += float(self.looks.ratios(likeness, views, BESIDE)[0, 0])
        return float(np.logaddexp(agreed, differing))


def likely_same(missed: Known, near: list[Known], evidence: Evidence) -> list[Known]:
    """Return which of the found things near a missed one it may be, the likeliest first."""
    others = [thing for thing in near if thing is not missed and thing.number not in missed.met]
    scored = [(evidence.odds(missed, thing), -thing.number, thing) for thing in others]
    likely = [each for each in scored if each[0] >= evidence.parameters.merge_odds]
    return [thing for _, _, thing in sorted(likely, key=lambda each: each[:2], reverse=True)]


def never_together(thing: Known, others: list[Known], ledger: Ledger) -> Known | None:
    """Return the first of `others` that no frame shows beside `thing`; all is written."""
    met: set[str] = set()
    for encounter in ledger.encounters(thing.object_id):
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
    unbroken = parameters.with_changes(interval_gap_s=parameters.unbroken_gap_s)
    intervals = joined((Interval.from_sighting(each) for each in sightings), unbroken)
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
    precision = np.linalg.inv(positions.error[a]), np.linalg.inv(positions.error[b])
    error = np.linalg.inv(precision[0] + precision[1])
    for means in (positions.mean, positions.raw):
        means[a] = error @ (precision[0] @ means[a] + precision[1] @ means[b])
    positions.error[a] = error
    positions.scale[a] += positions.scale[b]
    positions.respread([a], parameters)
