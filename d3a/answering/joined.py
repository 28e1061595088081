"""The moments of a relation: where it held, between whom, and where it did not.

A link whose relation is more likely than not makes a moment of its two sightings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from d3a import relations
from d3a.answering.joins import HOLDS, Related
from d3a.answering.linked import Link, ordered, pairs_of
from d3a.answering.moments import Found, Moment, entry_of
from d3a.store.base import StayKey


def pair_moments(related: Related, figure: Found, ground: Found) -> list[Moment]:
    """Return a moment a link whose relation is more likely than not."""
    out: list[Moment] = []
    for link, p in zip(related.links, related.probability.tolist(), strict=True):
        if p >= HOLDS:  # False for NaN
            a, b = link.seen()
            entries = (entry_of(figure, a), entry_of(ground, b))
            out.append(Moment(entries, *ordered(link), relation=p))
    return out


def chain_moments(moments: Sequence[Moment], more: Sequence[Moment]) -> list[Moment]:
    """Join moments of (x, y) with moments of (x, z) that share the figure's stay and overlap.

    The relation holds as likely as both do; the interval is the common one.
    """
    by_stay: dict[StayKey, list[Moment]] = {}
    for moment in more:
        by_stay.setdefault(moment.figure.sighting.stay, []).append(moment)
    out: list[Moment] = []
    for moment in moments:
        present = {entry.sighting.object_id for entry in moment.entries}
        for other in by_stay.get(moment.figure.sighting.stay, []):
            start = max(moment.start_ms, other.start_ms)
            end = min(moment.end_ms, other.end_ms)
            if start > end or other.entries[1].sighting.object_id in present:
                continue
            held = (moment.relation or 1.0) * (other.relation or 1.0)
            out.append(Moment((*moment.entries, other.entries[1]), start, end, relation=held))
    return out


def between_moments(
    figure: Found, grounds: Sequence[Found], found: Sequence[Related]
) -> list[Moment]:
    """Return the moments in which the figure was between one thing of each ground.

    grounds, found: one for each of the two other things; the same twice for "between the chairs".
    """
    first, second = found[0].links, found[-1].links
    by_stay: dict[StayKey, list[Link]] = {}
    for link in second:
        by_stay.setdefault(link.figure, []).append(link)
    both = [
        (one, two)
        for one in first
        for two in by_stay.get(one.figure, [])
        if _at_once(one, two)
        and one.ground[0] != two.ground[0]
        and (grounds[0] is not grounds[-1] or one.ground[0] < two.ground[0])
    ]
    left = pairs_of([one for one, _ in both], figure, grounds[0])
    right = pairs_of([two for _, two in both], figure, grounds[-1])
    held = relations.between(left, right) if both else np.zeros(0)
    out: list[Moment] = []
    for (one, two), p in zip(both, held, strict=True):
        if p >= HOLDS:
            entries = (
                entry_of(figure, one.seen()[0]),
                entry_of(grounds[0], one.seen()[1]),
                entry_of(grounds[-1], two.seen()[1]),
            )
            out.append(Moment(entries, *_common(one, two), relation=float(p)))
    return out


def _at_once(one: Link, two: Link) -> bool:
    (begun, ended), (start, end) = one.stood, two.stood
    return max(begun, start) <= min(ended, end)


def _common(one: Link, two: Link) -> tuple[int, int]:
    """Return the interval that is told of two links that stood at once.

    Of what was seen of both; else of the later of the two, as far as both stood then.
    """
    start, end = max(one.start_ms, two.start_ms), min(one.end_ms, two.end_ms)
    if start <= end:
        return start, end
    low, high = max(one.stood[0], two.stood[0]), min(one.stood[1], two.stood[1])
    start, end = max(ordered(one), ordered(two))
    return min(max(start, low), high), min(max(end, low), high)


def without_relation(
    figure: Found, found: Sequence[Related], grounds: Sequence[Found]
) -> list[Moment]:
    """Return the figure's sightings in which no ground stood in the relation.

    Each possible ground weakens it by how likely it was the asked thing and the relation held.
    """
    free: dict[StayKey, list[tuple[int, int, float]]] = {}
    for related, ground in zip(found, grounds, strict=True):
        for link, p in zip(related.links, related.probability, strict=True):
            if p > 0:
                candidate = ground.candidates[link.ground[0]]
                weight = float(p) * candidate.match
                for probability in candidate.attributes.values():
                    weight *= probability
                spans = free.setdefault(link.figure, [])
                spans.append((*link.stood, weight))
    out: list[Moment] = []
    for sighting in figure.sightings:
        absent = 1.0
        for start, end, weight in free.get(sighting.stay, []):
            if start <= sighting.end_ms and end >= sighting.start_ms:
                absent *= 1.0 - min(weight, 1.0)
        if absent >= HOLDS:
            entry = entry_of(figure, sighting)
            out.append(Moment((entry,), sighting.start_ms, sighting.end_ms, relation=absent))
    return out


def holders(found: Sequence[Related]) -> dict[StayKey, float]:
    """Return, for each stay of the figure, how likely the relation ever held for it.

    found: one for each ground; it must have held for all of them.
    """
    each: list[dict[StayKey, float]] = []
    for related in found:
        best: dict[StayKey, float] = {}
        for link, p in zip(related.links, related.probability, strict=True):
            if p >= HOLDS:
                best[link.figure] = max(best.get(link.figure, 0.0), float(p))
        each.append(best)
    return {stay: min(best[stay] for best in each) for stay in each[0] if _in_all(stay, each)}


def _in_all(stay: StayKey, each: Sequence[Mapping[StayKey, float]]) -> bool:
    return all(stay in best for best in each)
