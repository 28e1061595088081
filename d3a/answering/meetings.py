"""Where things met, over thousands of sightings as columns: what `joins.links` tells of records.

Two things meet in a shared frame, or where their intervals overlap and their places are near.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import relations
from d3a.answering import columns
from d3a.answering.columns import Ints, Mask
from d3a.answering.joins import HOLDS, overlapping
from d3a.answering.linked import FAR_M
from d3a.answering.pairs import DEFAULT_SIGMA_M, Floats, Pairs, placed_together
from d3a.answering.places import SUREST_M
from d3a.parameters import Parameters
from d3a.store.base import Encounter, Positions, SightingKey, Spans, StayKey

ENCOUNTER = -1
"""In place of the row of a sighting: a shared frame tells of the meeting."""


@dataclass(frozen=True, slots=True)
class Side:
    """What was seen of the things of a variable.

    every: as the store tells them. spans: those that its limit split joined, by object, place and
    start. places: of their stays. at (n,): the row of the place of each of these.
    """

    every: Spans
    spans: Spans
    places: Positions
    at: Ints

    @classmethod
    def of(cls, spans: Spans, places: Positions) -> Side:
        """Return the side of sightings as the store tells them."""
        whole = columns.joined(spans)
        return cls(spans, whole, places, places.rows_of(whole))

    def which(self, rows: Ints) -> list[SightingKey]:
        """Return what is to be read of the sightings in some rows: all parts of each."""
        return self.every.chosen(np.isin(columns.parts(self.every), rows)).which()

    def stays(self, rows: Ints) -> list[StayKey]:
        """Return the stays at some rows of the places."""
        of, place = self.places.of[rows].tolist(), self.places.place[rows].tolist()
        return [(self.places.ids[n], number) for n, number in zip(of, place, strict=True)]

    def rows_of(self, stays: Sequence[StayKey]) -> Ints:
        """Return the row of each stay among the places (n,), -1 of what is not among them."""
        row = {stay: n for n, stay in enumerate(self.stays(np.arange(len(self.places))))}
        return np.array([row.get(stay, -1) for stay in stays], dtype=np.int64)

    def showed(self, stay: Ints, start_ms: Ints, end_ms: Ints) -> Mask:
        """Return at which stays (n,), by row, something was seen in these closed intervals."""
        return _touched(self.at, self.spans.start_ms, self.spans.end_ms, stay, start_ms, end_ms)


@dataclass(frozen=True, slots=True)
class Meetings:
    """n meetings of two sides, by start and stays.

    figure, ground (n,): the rows of their places. start_ms, end_ms (n,): when they met. own, other
    (n,): the rows of their sightings, or `ENCOUNTER` and the number of the shared frame.
    """

    figure: Ints
    ground: Ints
    start_ms: Ints
    end_ms: Ints
    own: Ints
    other: Ints

    def __len__(self) -> int:
        """Return how many meetings there are."""
        return len(self.figure)

    def at(self, rows: NDArray[np.intp] | Mask) -> Meetings:
        """Return some of the meetings, in that order."""
        return Meetings(
            *(
                each[rows]
                for each in (
                    self.figure,
                    self.ground,
                    self.start_ms,
                    self.end_ms,
                    self.own,
                    self.other,
                )
            )
        )

    @property
    def apart(self) -> Mask:
        """Which meetings no shared frame tells of (n,)."""
        return np.asarray(self.own != ENCOUNTER)


def met(
    one: Side, other: Side, encounters: Sequence[Encounter], reach_m: float, *, once: bool
) -> Meetings:
    """Return where two sides met, as `joins.links` does."""
    shared = _shared(one, other, encounters)
    apart = _apart(one, other, shared, reach_m)
    names = (
        np.concatenate([getattr(part, name) for part in (shared, apart)])
        for name in ("figure", "ground", "start_ms", "end_ms", "own", "other")
    )
    found = Meetings(*names)
    if once:
        found = found.at(~_mirrored(one, other, found))
    return found.at(np.lexsort((found.ground, found.figure, found.start_ms)))


def together(one: Side, other: Side, found: Meetings, parameters: Parameters) -> Floats:
    """Return how likely the two of each meeting were together (n,), NaN where nothing tells.

    A shared frame settles it, whatever the geometry.
    """
    held = np.ones(len(found))
    apart = found.apart
    if apart.any():
        both = found.figure[apart] * len(other.places) + found.ground[apart]
        known, at = np.unique(both, return_inverse=True)
        pairs = pairs_of_places(one, other, *np.divmod(known, len(other.places)))
        held[apart] = relations.probability("together", pairs, parameters)[at]
    return held


def pairs_of_places(one: Side, other: Side, figure: Ints, ground: Ints) -> Pairs:
    """Return the geometry of stays by their places alone; of sizes nothing is known."""
    nothing = np.full((len(figure), 7), np.nan)
    sites = np.array(one.places.sites)[one.places.site[figure]]
    elsewhere = sites != np.array(other.places.sites)[other.places.site[ground]]
    pairs = Pairs(
        position_a=_positions(one.places)[figure],
        position_b=_positions(other.places)[ground] + FAR_M * elsewhere[:, None],
        sigma=np.hypot(_sigma(one.places)[figure], _sigma(other.places)[ground]),
        box_a=nothing[:, :4],
        box_b=nothing[:, :4],
        viewer=nothing,
        extent_a=nothing[:, :2],
        extent_b=nothing[:, :2],
        sigma_up=nothing[:, 0],
        usual_b=np.zeros(len(figure), dtype=np.bool_),
    )
    return placed_together(pairs, nothing[:, :4])


def likely(probability: Floats) -> NDArray[np.intp]:
    """Return the rows of what is more likely than not; NaN is not."""
    return np.flatnonzero(probability >= HOLDS)


def cores(found: Meetings, stays: int) -> list[Meetings]:
    """Return, for two things, for three and so on, the meetings that may be of so many at once.

    As long as there are any. found: within one side of so many stays. Whatever is one of n that all
    met each other met n - 1 others of these.
    """
    out: list[Meetings] = []
    while len(found := _core(found, stays, len(out) + 1)):
        out.append(found)
    return out


def _core(found: Meetings, stays: int, least: int) -> Meetings:
    """Return the meetings among stays that each met so many others of them at least."""
    number = -1
    while number != len(found):
        number = len(found)
        both = np.unique(found.figure * stays + found.ground)  # each two once
        others = np.bincount(np.concatenate(np.divmod(both, stays)), minlength=stays)
        found = found.at((others[found.figure] >= least) & (others[found.ground] >= least))
    return found


def _shared(one: Side, other: Side, encounters: Sequence[Encounter]) -> Meetings:
    """Return what shared frames tell, either way round, of what was seen of both sides."""
    stays = [(e.object_a, e.place_a) for e in encounters]
    stays += [(e.object_b, e.place_b) for e in encounters]
    start = np.array([e.start_ms for e in encounters], dtype=np.int64)
    end = np.array([e.end_ms for e in encounters], dtype=np.int64)
    ones, others = (side.rows_of(stays).reshape(2, -1) for side in (one, other))
    parts = []
    for figure, ground in ((ones[0], others[1]), (ones[1], others[0])):
        rows = np.flatnonzero((figure >= 0) & (ground >= 0))
        seen = one.showed(figure[rows], start[rows], end[rows])
        rows = rows[seen & other.showed(ground[rows], start[rows], end[rows])]
        parts.append((figure[rows], ground[rows], start[rows], end[rows], rows))
    figure, ground, start, end, rows = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Meetings(figure, ground, start, end, np.full(len(rows), ENCOUNTER), rows)


def _apart(one: Side, other: Side, shared: Meetings, reach_m: float) -> Meetings:
    """Return what intervals and places tell, where no shared frame tells it."""
    rows_a, rows_b = (np.flatnonzero(~np.isnan(side.places.x[side.at])) for side in (one, other))
    place_a, place_b = (_positions(side.places)[side.at] for side in (one, other))
    ids = np.array([*one.spans.ids, *other.spans.ids])
    _, number = np.unique(ids, return_inverse=True)
    id_a, id_b = number[: len(one.spans.ids)], number[len(one.spans.ids) :]
    found = []
    for i, j in overlapping(_intervals(one.spans, rows_a), _intervals(other.spans, rows_b)):
        own, its = rows_a[i], rows_b[j]
        away = place_a[own] - place_b[its]
        near = np.einsum("ik,ik->i", away, away) <= reach_m**2
        near &= id_a[one.spans.of[own]] != id_b[other.spans.of[its]]
        found.append((own[near], its[near]))
    own, its = (
        np.concatenate([part[k] for part in found]) if found else np.zeros(0, dtype=np.intp)
        for k in range(2)
    )
    start = np.maximum(one.spans.start_ms[own], other.spans.start_ms[its])
    end = np.minimum(one.spans.end_ms[own], other.spans.end_ms[its])
    figure, ground = one.at[own], other.at[its]
    width = len(other.places)
    both, asked = shared.figure * width + shared.ground, figure * width + ground
    order = np.lexsort((shared.start_ms, both))
    told = _touched(both[order], shared.start_ms[order], shared.end_ms[order], asked, start, end)
    return Meetings(figure, ground, start, end, own, its).at(~told)


def _touched(of: Ints, start: Ints, end: Ints, asked: Ints, start_ms: Ints, end_ms: Ints) -> Mask:
    """Return which closed intervals (m,) touch one of the same group among others (n,).

    of (n,): the group of each of the others, these by group and start. asked (m,): of each.
    """
    if not len(of) or not len(asked):
        return np.zeros(len(asked), dtype=np.bool_)
    known, number = np.unique(of, return_inverse=True)
    group = np.minimum(np.searchsorted(known, asked), len(known) - 1)
    low = int(start.min())
    width = int(start.max()) - low + 2
    reached = columns.reached(number, end)
    before = group * width + np.clip(end_ms - low, -1, width - 1)
    last = np.searchsorted(number * width + (start - low), before, side="right") - 1
    there = (known[group] == asked) & (last >= 0) & (number[last] == group)
    return np.asarray(there & (reached[last] >= start_ms))


def _mirrored(one: Side, other: Side, found: Meetings) -> Mask:
    """Return which meetings are told the other way round as well, and are told so (n,)."""
    ids_a, ids_b = np.array(one.places.ids), np.array(other.places.ids)
    of_a, of_b = one.places.of[found.figure], other.places.of[found.ground]
    both = np.isin(ids_b, ids_a)[of_b] & np.isin(ids_a, ids_b)[of_a]
    return np.asarray(both & (ids_a[of_a] > ids_b[of_b]))


def _intervals(spans: Spans, rows: NDArray[np.intp]) -> Ints:
    return np.stack([spans.start_ms[rows], spans.end_ms[rows]], axis=1)


def _positions(places: Positions) -> Floats:
    return np.stack([places.x, places.y, places.z], axis=1)


def _sigma(places: Positions) -> Floats:
    """Return what `places.sigma_of` does (n,)."""
    sigma = np.maximum(np.sqrt(np.maximum(places.variance, 0.0)), SUREST_M)
    return np.where(np.isnan(places.variance), DEFAULT_SIGMA_M, sigma)
