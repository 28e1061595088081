"""Default profile: two things in memory that are one.

A bad position or look may found a second thing beside a known one; then detections go now to the
one, now to the other. They are made one when a look finds one and not the other, which it had in
view, where place, look and category together say the same, and no frame ever showed both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.ledger import Ledger
from d3a.parameters import Parameters
from d3a.sightings import Interval, joined
from d3a.store.base import StayKey
from d3a.symmetric import added, inverse, plus, times
from d3a.tracking import likelihood
from d3a.tracking.absence import Judged
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import BESIDE, OTHER, CategoryModel, LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.neighbours import Neighbours
from d3a.tracking.positions import Row
from d3a.tracking.sides import LOOKS_KEPT, SIDES_KEPT

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

    def likely(self, looks: list[Judged]) -> list[tuple[Known, list[Known]]]:
        """Return what looks did not show with what they found that it likely is, likeliest first.

        By all but time, as the look has left them. Things with names, several places or no position
        are left alone, and so is what was seen beside the other. What looks otherwise from the
        other side is a second thing there, and never missed: any plain view counts. Without a look
        it may as well be another of its kind, and has to be missed where it was seen.
        """
        likely: dict[int, tuple[Known, list[tuple[float, int, Known]]]] = {}
        apart = dict.fromkeys(pair for look in looks for pair in _apart(look))
        for odds, (one, other) in self._odds(self._near(list(apart))):
            are_pictured = one.look_weight > 0 and other.look_weight > 0
            if are_pictured or odds >= self.parameters.plain_odds:
                likely.setdefault(one.number, (one, []))[1].append((-odds, other.number, other))
        return [(one, [other for *_, other in sorted(each)]) for one, each in likely.values()]

    def _near(self, pairs: list[tuple[Known, Known]]) -> list[tuple[Known, Known]]:
        """Return those of some pairs that are within each other's gate."""
        if not pairs:
            return []
        columns = self.memory.positions.columns
        a, b = (columns[:, [pair[k].places[0].row for pair in pairs]] for k in (0, 1))
        off, _ = likelihood.squared_distances(a[:3] - b[:3], a[3:] + b[3:])
        return [pairs[k] for k in (off <= self.parameters.gate_sigmas**2).nonzero()[0].tolist()]

    def _odds(self, pairs: list[tuple[Known, Known]]) -> list[tuple[float, tuple[Known, Known]]]:
        """Return the log-odds that pairs are one, of those that likely are."""
        if not pairs:
            return []
        agreed, differing = self._told(pairs)
        most = np.logaddexp(agreed, differing) + self.parameters.look_most
        at = (most >= self.parameters.merge_odds).nonzero()[0]
        if len(at) == 0:
            return []
        pairs = [pairs[k] for k in at.tolist()]
        same, beside = self._looks_told(pairs)
        odds: list[float] = np.logaddexp(agreed[at] + same, differing[at] + beside).tolist()
        least = self.parameters.merge_odds
        return [(each, pair) for each, pair in zip(odds, pairs, strict=True) if each >= least]

    def _told(self, pairs: list[tuple[Known, Known]]) -> tuple[Floats, Floats]:
        """Return what category and place say of pairs, (k,).

        All are at one place each. First if the names agree, then if one of them is wrong.
        """
        columns = self.memory.positions.columns
        a, b = (columns[:, [pair[k].places[0].row for pair in pairs]] for k in (0, 1))
        away = a[:3] - b[:3]
        off, determinant = likelihood.squared_distances(away, a[3:] + b[3:])
        beside_m3 = self.neighbours.space_m3((away**2).sum(axis=0))
        spaces = (self.parameters.space_m3, beside_m3)
        place, beside = likelihood.position_ratios(off, determinant, spaces, self.parameters)
        ones, others = ({pair[k].number: pair[k] for pair in pairs} for k in (0, 1))
        names = [(one.category, one.weight / one.seen) for one in ones.values()]
        evidence = self.categories.evidence(names, [other.shares for other in others.values()])
        row = {number: k for k, number in enumerate(ones)}
        column = {number: k for k, number in enumerate(others)}
        at = [row[one.number] for one, _ in pairs], [column[other.number] for _, other in pairs]
        return evidence[0][at] + place, evidence[1][at] + beside

    def _looks_told(self, pairs: list[tuple[Known, Known]]) -> Floats:
        """Return what the looks of pairs say, (2, k): against another of a kind, and one beside."""
        views = np.array([min(one.look_weight, other.look_weight) for one, other in pairs])
        if not views.any():
            return np.zeros((2, len(pairs)))
        units = self.memory.looks.units([thing for pair in pairs for thing in pair], self.space)
        likeness = np.einsum("kd,kd->k", units[::2], units[1::2], dtype=np.float64)
        told = self.looks.against(likeness[None], views, (OTHER, BESIDE))[:, 0]
        return np.where(views > 0, told, 0.0)


def _apart(look: Judged) -> Iterator[tuple[Known, Known]]:
    """Yield what a look did not show, each with what it found and no frame showed beside it."""
    asked = {thing.number: thing for thing in look.unseen if thing.look_weight > 0}
    asked |= {thing.number: thing for thing in look.missed}
    found = [thing for thing in look.found if _is_simple(thing)]
    for number in sorted(asked):
        one = asked[number]
        if found and _is_simple(one):
            met = one.met
            for other in found:
                if other.number not in met and other is not one:
                    yield one, other


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
    ledger.remove_objects({gone.object_id})
    for sighting in sightings:
        if sighting.stay == becomes:
            ledger.remove_sighting(sighting)
    seen = (Interval.from_sighting(each) for each in sightings)
    intervals = joined(seen, parameters, parameters.unbroken_gap_s)
    for interval in intervals:
        ledger.put_sighting(interval.sighting(becomes))
    for encounter in encounters:
        if (renamed := encounter.renamed({was: becomes})) is not None:
            ledger.put_encounter(renamed)
    place.open = intervals[-1] if intervals else place.open
    _join(kept, gone, memory, parameters)
    return was, becomes


def _join(kept: Known, gone: Known, memory: Memory, parameters: Parameters) -> None:
    place, lost = kept.places[0], gone.places[0]
    _join_positions(place, lost, memory, parameters)
    for category, weight in gone.votes.items():
        kept.vote(category, weight)
    memory.touch(kept)
    look = memory.looks.of(gone)
    if look is not None:
        memory.looks.blend(kept, look, gone.look_weight, parameters.looks_remembered)
    for into, of in ((kept, gone), (place, lost)):
        into.weight += of.weight
        into.seen += of.seen
        into.first_ms = min(into.first_ms, of.first_ms)
        into.last_ms = max(into.last_ms, of.last_ms)
    # the look that missed one of them found the other: both times are the same
    if place.last_absent_ms is not None and place.last_absent_ms <= place.last_ms:
        place.last_absent_ms = None
    place.hits += lost.hits
    place.chances = max(place.chances, place.hits)
    place.misses, place.throughs, place.evidence, place.missed_from = 0, 0, 0.0, []
    place.there = 0.0
    memory.positions.put_there(place)
    place.seen_from = [*place.seen_from, *lost.seen_from][-SIDES_KEPT:]
    memory.positions.put_sides(place)
    # each was looked for in vain where the other was found
    place.looks = [look for look in (*place.looks, *lost.looks) if look[-1]][-LOOKS_KEPT:]
    place.looked = len(place.looks)
    memory.positions.put_looks(place)
    kept.met |= gone.met
    kept.dirty = True
    memory.remove(gone)


def _join_positions(place: Place, lost: Place, memory: Memory, parameters: Parameters) -> None:
    """Average both positions by what is known of each."""
    one, other = memory.positions.of(place), memory.positions.of(lost)
    p, q = inverse(one.error), inverse(other.error)
    error = inverse(added(p, q))
    mean, raw = (
        times(error, plus(times(p, a), times(q, b)))
        for a, b in ((one.mean, other.mean), (one.raw, other.raw))
    )
    scale = one.scale[0] + other.scale[0], one.scale[1] + other.scale[1]
    memory.positions.put(place, Row.of(mean, raw, error, scale, parameters))
