"""The moments of a relation: where it held, between whom, and where it did not.

A link whose relation is more likely than not makes a moment of its two sightings.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from math import prod

import numpy as np
from numpy.typing import NDArray

from d3a import relations
from d3a.answering.joins import HOLDS, Related
from d3a.answering.linked import Link, numbered
from d3a.answering.moments import Entry, Found, Moment, entry_of
from d3a.answering.standing import BY_START, Standing, Timeline, was_there
from d3a.store.base import Sighting, StayKey


def tellings(
    related: Related, figure: Found, ground: Found, settled: Container[StayKey]
) -> list[tuple[Link, float]]:
    """Return each time at which a relation is told that is more likely than not, and how likely.

    What stood together is told by each sighting of either at which the other was not seen, but was
    there by all that is known. settled: see `standing.was_there`.
    """
    likely = np.flatnonzero(related.probability >= HOLDS).tolist()  # False for NaN
    held = [(related.links[row], float(related.probability[row])) for row in likely]
    stood = [link for link, _ in held if link.standing is not None]
    standing = Standing(figure, ground, stood, settled)
    out: list[tuple[Link, float]] = []
    for link, p in held:
        told = (link,) if link.standing is None else standing.told(link)
        out += [(one, p) for one in told]
    return out


def pair_moments(
    related: Related, figure: Found, ground: Found, settled: Container[StayKey]
) -> list[Moment]:
    """Return the moments in which the relation held; settled: see `standing.was_there`."""
    out: list[Moment] = []
    for link, p in tellings(related, figure, ground, settled):
        a, b = link.seen()
        entries = (entry_of(figure, a), entry_of(ground, b))
        out.append(Moment(entries, link.start_ms, link.end_ms, relation=p))
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
    figure: Found,
    grounds: Sequence[Found],
    found: Sequence[Related],
    settled: Container[StayKey],
) -> list[Moment]:
    """Return the moments in which the figure was between one thing of each ground, by start.

    grounds, found: one for each of the two other things; the same twice for "between the chairs".
    It is told of what was seen of the three at once; and of three that stood at their places at one
    time by what was seen of any then. settled: see `standing.was_there`.
    """
    one, two = found[0], found[-1]
    left, right = _threes(one.links, two.links, same=grounds[0] is grounds[-1])
    if not len(left) or one.pairs is None or two.pairs is None:
        return []
    frames = numbered(_frame(link) for link in (*one.links, *two.links))
    shared = frames[left] == frames[len(one.links) + right]
    held = relations.between(one.pairs.at(left), two.pairs.at(right), shared)
    at_once = _AtOnce(figure, grounds, settled)
    so = np.flatnonzero(held >= HOLDS)  # False for NaN
    rows = [*zip(left[so].tolist(), right[so].tolist(), held[so].tolist(), strict=True)]
    told: list[Moment] = []
    for standing in (False, True):
        for i, j, p in rows:
            both = one.links[i], two.links[j]
            if (both[0].standing is not None) is standing:
                told += at_once.told(both, p) if standing else [at_once.seen(both, p)]
    return sorted(told, key=lambda moment: (moment.start_ms, moment.ids))


def _threes(
    first: Sequence[Link], second: Sequence[Link], *, same: bool
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows of links of one figure at one time with two different things (n,), (n,)."""
    links, split = [*first, *second], len(first)
    figures, things = numbered(k.figure for k in links), numbered(k.ground[0] for k in links)
    spans = np.array([k.stood for k in links], dtype=np.int64).reshape(-1, 2)
    stood = np.array([k.standing is not None for k in links], dtype=np.bool_)
    order = np.argsort(figures[split:], kind="stable")
    low = np.searchsorted(figures[split:][order], figures[:split])
    counts = np.searchsorted(figures[split:][order], figures[:split], side="right") - low
    left = np.repeat(np.arange(split), counts)
    within = np.arange(len(left)) - np.repeat(np.cumsum(counts) - counts, counts)
    right = order[np.repeat(low, counts) + within]
    other = split + right
    begun = np.maximum(spans[left, 0], spans[other, 0])
    meets = begun <= np.minimum(spans[left, 1], spans[other, 1])
    meets &= (stood[left] == stood[other]) & (things[left] != things[other])
    if same:
        names = [link.ground[0] for link in links]
        _, by_name = np.unique(np.array(names), return_inverse=True)
        meets &= by_name[left] < by_name[other]
    return left[meets], right[meets]


def _frame(link: Link) -> str | None:
    return None if link.encounter is None else link.encounter.frame


class _AtOnce:
    """The moments of three things at one time, each time told once for the same three stays."""

    def __init__(
        self, figure: Found, grounds: Sequence[Found], settled: Container[StayKey]
    ) -> None:
        self._tables, self._settled = (figure, grounds[0], grounds[-1]), settled
        self._seen = [Timeline(table, table.stays) for table in self._tables]
        self._told: dict[tuple[StayKey, ...], list[tuple[int, int]]] = {}
        self._shown: dict[int, tuple[Sighting, Sighting]] = {}
        self._entries: dict[tuple[int, int], Entry] = {}

    def seen(self, links: tuple[Link, Link], probability: float) -> Moment:
        """Return the moment of two links that tell what was seen at once."""
        one, two = links
        span = max(one.start_ms, two.start_ms), min(one.end_ms, two.end_ms)
        self._told.setdefault((one.figure, one.ground, two.ground), []).append(span)
        told = min(links, key=lambda k: (k.encounter is None, k.start_ms, k.ground))
        seen = self._of(told)[0], self._of(one)[1], self._of(two)[1]
        return self._moment(seen, span, probability)

    def _of(self, link: Link) -> tuple[Sighting, Sighting]:
        """Return the two sightings of a link, made once: it is of many threes."""
        shown = self._shown.get(id(link))
        if shown is None:
            shown = self._shown[id(link)] = link.seen()
        return shown

    def told(self, links: tuple[Link, Link], probability: float) -> list[Moment]:
        """Return the moments of two links of things that stood there, but of times told already."""
        one, two = links
        stays = one.figure, one.ground, two.ground
        low, high = max(one.stood[0], two.stood[0]), min(one.stood[1], two.stood[1])
        known = self._told.setdefault(stays, [])
        each = [*zip(self._seen, stays, strict=True)]
        seen = [(s, of.is_asked(s)) for of, stay in each for s in of.within(stay, (low, high))]
        out: list[Moment] = []
        for sighting, asked in sorted(seen, key=lambda one: BY_START(one[0])):
            span = max(sighting.start_ms, low), min(sighting.end_ms, high)
            if any(start <= span[1] and end >= span[0] for start, end in known):
                continue
            known.append(span)
            told = tuple(of.nearest(stay, sighting) for of, stay in each)
            if asked and all(was_there(sighting, one, self._settled) for one in told):
                out.append(self._moment(told, span, probability))
        return out

    def _moment(
        self, seen: tuple[Sighting, ...], span: tuple[int, int], probability: float
    ) -> Moment:
        told: list[Entry] = []
        for number, sighting in enumerate(seen):
            key = number, id(sighting)  # all sightings are of tables or links, which stay
            entry = self._entries.get(key)
            if entry is None:
                entry = self._entries[key] = entry_of(self._tables[number], sighting)
            told.append(entry)
        return Moment(tuple(told), *span, relation=probability)


def without_relation(
    figure: Found, found: Sequence[Related], grounds: Sequence[Found]
) -> list[Moment]:
    """Return the figure's sightings in which no ground stood in the relation.

    Each possible ground weakens it by how likely it was the asked thing and the relation held.
    """
    free: dict[StayKey, list[tuple[int, int, str, float]]] = {}
    for related, ground in zip(found, grounds, strict=True):
        for link, p in zip(related.links, related.probability, strict=True):
            if p > 0:
                candidate = ground.candidates[link.ground[0]]
                weight = float(p) * candidate.match
                for probability in candidate.attributes.values():
                    weight *= probability
                spans = free.setdefault(link.figure, [])
                spans.append((*link.stood, link.ground[0], min(weight, 1.0)))
    out: list[Moment] = []
    for sighting in figure.sightings:
        likeliest: dict[str, float] = {}
        for start, end, name, weight in free.get(sighting.stay, []):
            if start <= sighting.end_ms and end >= sighting.start_ms:
                likeliest[name] = max(likeliest.get(name, 0.0), weight)
        absent = prod(1.0 - weight for weight in likeliest.values())
        if absent >= HOLDS:
            out.append(_alone(figure, sighting, absent))
    return out


def not_between(figure: Found, held: Sequence[Moment]) -> list[Moment]:
    """Return the figure's sightings that touch none of the moments in which it was between."""
    spans: dict[StayKey, list[Moment]] = {}
    for moment in held:
        spans.setdefault(moment.figure.sighting.stay, []).append(moment)
    out: list[Moment] = []
    for sighting in figure.sightings:
        met = any(
            moment.start_ms <= sighting.end_ms and moment.end_ms >= sighting.start_ms
            for moment in spans.get(sighting.stay, ())
        )
        if not met:
            out.append(_alone(figure, sighting, 1.0))
    return out


def _alone(figure: Found, sighting: Sighting, absent: float) -> Moment:
    entry = entry_of(figure, sighting)
    return Moment((entry,), sighting.start_ms, sighting.end_ms, relation=absent)


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
