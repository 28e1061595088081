"""Join the sightings of two objects in time, and tell how likely a relation held between them.

Above the store, in numpy: storage measurements showed this 4 to 900 times quicker than SQL.
Two things meet in a shared frame (an encounter), or where their intervals overlap.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a import relations
from d3a.answering.carried import CONTACT_M, Lying
from d3a.answering.linked import Link, agreed, pairs_of
from d3a.answering.moments import Found
from d3a.answering.standing import stood_together
from d3a.model import Position
from d3a.parameters import Parameters
from d3a.store.base import Encounter, Sighting, StayKey
from grammar.forms import RelationKind

HOLDS = 0.5
"""A relation is said to hold where it is more likely than not."""
REACH_M = 4.0
"""Things between two others may be this far from either."""
_PART = 4_000_000  # pairs compared at once: keeps the join's memory under 100 MB
Spans = dict[StayKey, list[tuple[int, int]]]
Rows = NDArray[np.intp]
Intervals = NDArray[np.int64]
STANDING: frozenset[RelationKind] = frozenset({"near", "on", "under", "in", "above", "same_place"})
"""These are between two places, whoever looks; sides are the viewer's."""
CARRIED: frozenset[RelationKind] = frozenset({"on", "under", "behind", "in_front_of"})
"""For these it counts what else may carry a thing, or be over it."""
SYMMETRIC: frozenset[RelationKind] = frozenset({"together", "near", "same_place"})


def links(
    figure: Found,
    ground: Found,
    encounters: Sequence[Encounter],
    *,
    reach_m: float = REACH_M,
    timeless: bool = False,
    once: bool = False,
) -> list[Link]:
    """Return where the sightings of figure and ground meet, shared frames first.

    reach_m: without a shared frame, things further apart than this do not meet.
    timeless: intervals need not overlap (the same place as). once: each unordered pair once, for
    a symmetric relation of a category with itself. Ordered by start, then by ids and places.
    """
    shown = _spans(figure), _spans(ground)
    shared = [link for e in encounters for link in _oriented(e, *shown)]
    met = {(link.figure, link.ground) for link in shared}
    apart = [
        Link(
            a.stay,
            b.stay,
            max(a.start_ms, b.start_ms),
            min(a.end_ms, b.end_ms),
            sightings=(a, b),
        )
        for a, b in _overlapping(figure, ground, reach_m, timeless=timeless)
        if (a.stay, b.stay) not in met and a.object_id != b.object_id
    ]
    found = shared + apart
    if once:
        found = [link for link in found if not _is_mirrored(link, figure, ground)]
    return sorted(found, key=lambda k: (k.start_ms, k.figure, k.ground))


def meeting(
    one: Sequence[Sighting], other: Sequence[Sighting], encounters: Sequence[Encounter]
) -> tuple[list[Sighting], list[Sighting]]:
    """Return of either list what may make a link with the other, by time alone; in their order.

    What overlaps something of the other, and the stays that a shared frame shows.
    """
    shown = {
        stay for e in encounters for stay in ((e.object_a, e.place_a), (e.object_b, e.place_b))
    }
    spans = _intervals(one), _intervals(other)
    met = _met(*spans).tolist(), _met(*spans[::-1]).tolist()
    return (
        [s for s, overlaps in zip(one, met[0], strict=True) if overlaps or s.stay in shown],
        [s for s, overlaps in zip(other, met[1], strict=True) if overlaps or s.stay in shown],
    )


def _met(span_a: Intervals, span_b: Intervals) -> NDArray[np.bool_]:
    """Return which of the first overlap any of the second, both (n, 2)."""
    ordered = span_b[np.argsort(span_b[:, 0], kind="stable")]
    last = np.maximum.accumulate(np.append(np.iinfo(np.int64).min, ordered[:, 1]))
    begun = np.searchsorted(ordered[:, 0], span_a[:, 1], side="right")
    return np.asarray(last[begun] >= span_a[:, 0])


def _is_mirrored(link: Link, figure: Found, ground: Found) -> bool:
    a, b = link.figure[0], link.ground[0]
    return a > b and b in figure.candidates and a in ground.candidates


def _spans(found: Found) -> Spans:
    spans: Spans = {}
    for sighting in found.sightings:
        stay = (sighting.object_id, sighting.place)
        spans.setdefault(stay, []).append((sighting.start_ms, sighting.end_ms))
    return spans


def _oriented(encounter: Encounter, figures: Spans, grounds: Spans) -> list[Link]:
    """Return the encounter as (figure, ground), both ways round where both may be either.

    Only where it belongs to sightings that were found: those of the asked place and time.
    """
    e = encounter
    first, second = (e.object_a, e.place_a), (e.object_b, e.place_b)
    start, end = e.start_ms, e.end_ms
    out: list[Link] = []
    for one, other in ((first, second), (second, first)):
        if one not in figures or other not in grounds:  # most are the one way round alone
            continue
        if _shown(figures[one], start, end) and _shown(grounds[other], start, end):
            out.append(Link(one, other, start, end, e, flipped=one is second))
    return out


def _shown(spans: Sequence[tuple[int, int]], start_ms: int, end_ms: int) -> bool:
    for a, b in spans:  # noqa: SIM110  asked of every encounter, twice as quick
        if a <= end_ms and b >= start_ms:
            return True
    return False


def _overlapping(
    figure: Found, ground: Found, reach_m: float, *, timeless: bool
) -> list[tuple[Sighting, Sighting]]:
    """Return sightings whose intervals overlap and whose positions are within reach."""
    rows_a, place_a = _placed(figure)
    rows_b, place_b = _placed(ground)
    span_a, span_b = _intervals(rows_a), _intervals(rows_b)
    meeting = _everyone(len(rows_a), len(rows_b)) if timeless else _at_once(span_a, span_b)
    found: list[tuple[Sighting, Sighting]] = []
    for i, j in meeting:
        apart = place_a[i] - place_b[j]
        near = np.einsum("ik,ik->i", apart, apart) <= reach_m**2
        pairs = zip(i[near].tolist(), j[near].tolist(), strict=True)
        found += [(rows_a[a], rows_b[b]) for a, b in pairs]
    return found


def _intervals(sightings: Sequence[Sighting]) -> Intervals:
    """Return start and end of each (n, 2)."""
    spans = [(s.start_ms, s.end_ms) for s in sightings]
    return np.array(spans, dtype=np.int64).reshape(-1, 2)


def _placed(found: Found) -> tuple[list[Sighting], NDArray[np.float64]]:
    """Return the sightings whose place is known, and where that is (n, 3) in metres."""
    rows: list[Sighting] = []
    places: list[Position] = []
    for sighting in found.sightings:
        stay = found.stays.get((sighting.object_id, sighting.place))
        if stay is not None and stay.position is not None:
            rows.append(sighting)
            places.append(stay.position)
    return rows, np.array(places, dtype=np.float64).reshape(-1, 3)


def _everyone(count_a: int, count_b: int) -> Iterator[tuple[Rows, Rows]]:
    """Yield all pairs of rows in parts, by the first row and then by the second."""
    step = max(1, _PART // max(count_b, 1))
    for at in range(0, count_a, step):
        i = np.arange(at, min(at + step, count_a))
        yield np.repeat(i, count_b), np.tile(np.arange(count_b), len(i))


def _at_once(span_a: Intervals, span_b: Intervals) -> Iterator[tuple[Rows, Rows]]:
    """Yield the pairs of rows whose closed intervals (n, 2) overlap, in the order of `_everyone`.

    A sweep: of the second, sorted by start, only those can overlap that begin before the first
    ends and no longer before it begins than the longest lasts.
    """
    order = np.argsort(span_b[:, 0], kind="stable")
    starts = span_b[order, 0]
    longest = int((span_b[:, 1] - span_b[:, 0]).max(initial=0))
    low = np.searchsorted(starts, span_a[:, 0] - longest, side="left")
    high = np.maximum(np.searchsorted(starts, span_a[:, 1], side="right"), low)
    sizes = np.cumsum(high - low)
    at = 0
    while at < len(span_a):
        before = sizes[at - 1] if at else 0
        end = max(at + 1, int(np.searchsorted(sizes, before + _PART, side="right")))
        counts = (high - low)[at:end]
        i = np.repeat(np.arange(at, end), counts)
        within = np.arange(len(i)) - np.repeat(np.cumsum(counts) - counts, counts)
        j = order[low[i] + within]
        meets = span_b[j, 1] >= span_a[i, 0]
        i, j = i[meets], j[meets]
        sorted_pairs = np.lexsort((j, i))
        yield i[sorted_pairs], j[sorted_pairs]
        at = end


@dataclass(frozen=True, slots=True)
class Related:
    """The links of a relation with how likely it held (n,), NaN where nothing tells."""

    links: list[Link]
    probability: NDArray[np.float64]

    @property
    def judged(self) -> bool:
        """Whether the relation could be judged for any link, or there was none to judge."""
        return len(self.links) == 0 or not bool(np.isnan(self.probability).all())

    @property
    def holds(self) -> bool:
        """Whether the relation is more likely than not for any link."""
        return bool((self.probability >= HOLDS).any())  # False for NaN


@dataclass(frozen=True, slots=True)
class Asked:
    """A relation that is asked of what was found for a figure and a ground.

    once: each unordered pair once, for a symmetric relation of a category with itself. usual: the
    categories of what is usual as a ground: things lie on tables, stand under furniture.
    carriers: what is large and stays: what is on or under one of these is so of no other.
    """

    kind: RelationKind
    figure: Found
    ground: Found
    parameters: Parameters
    once: bool = False
    usual: Collection[str] = ()
    carriers: Found = field(default_factory=Found)

    def met(self, encounters: Sequence[Encounter]) -> Related:
        """Return where figure and ground meet, with how likely the relation held."""
        return self._judged(
            links(
                self.figure,
                self.ground,
                encounters,
                reach_m=_reach_m(self.kind, self.parameters),
                timeless=self.kind == "same_place",
                once=self.once,
            )
        )

    def stood(self, met: Related) -> Related:
        """Return what was met, and what never met but stood at its places at one time."""
        if self.kind not in STANDING | {"between"}:
            return met
        known = {(link.figure, link.ground) for link in met.links}
        found = stood_together(
            self.figure, self.ground, known, _reach_m(self.kind, self.parameters)
        )
        if self.once:
            found = [k for k in found if not _is_mirrored(k, self.figure, self.ground)]
        more = self._judged(found)
        return Related(
            [*met.links, *more.links], np.concatenate([met.probability, more.probability])
        )

    def _judged(self, met: list[Link]) -> Related:
        # a shared frame settles that two were together, whatever the geometry
        told = [k for k in met if self.kind != "together" or k.encounter is None]
        pairs = pairs_of(told, self.figure, self.ground, self.usual)
        lying = Lying(
            met, pairs, self.figure, self.ground, self.carriers, self.usual, self.parameters
        )
        if self.kind in ("on", "under"):
            return Related(met, lying.held(self.kind))
        held = relations.probability(self.kind, pairs, self.parameters)
        if self.kind in CARRIED:
            held = held * lying.off_each_other()
        if self.kind == "together":
            apart = iter(held.tolist())
            held = np.array([next(apart) if k.encounter is None else 1.0 for k in met])
        return Related(met, agreed(met, held) if self.kind in STANDING else held)


def _reach_m(kind: RelationKind, parameters: Parameters) -> float:
    """Return how far apart two things may be for the relation to be more likely than not."""
    match kind:
        case "together":
            return parameters.together_m
        case "near":
            return parameters.near_m
        case "same_place":
            return parameters.d_thresh_m
        case "between":
            return REACH_M
        case _:
            return CONTACT_M
