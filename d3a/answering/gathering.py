"""Several things of one kind together: "two cups together", "the bowl with two spoons".

Pairs of things that were together are joined to groups in which each was together with each, at
one time.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from d3a.answering.joins import HOLDS, Related
from d3a.answering.linked import Link, pairs_of
from d3a.answering.moments import Entry, Found, Moment, entry_of
from d3a.parameters import Parameters
from d3a.store.base import LEAST_SIGMA_M, Sighting, StayKey

Span = tuple[int, int]
_ORDER = attrgetter("order")


class Member(NamedTuple):
    """A thing at a place, asked for by a variable of the query: its number, from 0."""

    var: int
    stay: StayKey


class Tie(NamedTuple):
    """Two members that were together over a closed interval, with how likely; each as seen then."""

    span: Span
    probability: float
    seen: tuple[Sighting, Sighting]


@dataclass(frozen=True, slots=True)
class Group:
    """Members each together with each within the span; probability: of the least likely two."""

    members: tuple[Member, ...]
    span: Span
    probability: float

    @property
    def order(self) -> tuple[float, Span, tuple[Member, ...]]:
        """Return what groups are ordered by: the likeliest first, then by time and members."""
        return (-self.probability, self.span, self.members)


class Ties:
    """Who was together with whom. tables: what was found for each variable."""

    def __init__(self, tables: Sequence[Found]) -> None:
        self._tables = tables
        self._of: dict[Member, dict[Member, list[Tie]]] = {}

    def add(self, one: int, other: int, related: Related) -> None:
        """Take in the links between the things of two variables, or among those of one."""
        for link, p in zip(related.links, related.probability, strict=True):
            if p >= HOLDS:  # False for NaN
                self._add(Member(one, link.figure), Member(other, link.ground), link, float(p))

    def _add(self, a: Member, b: Member, link: Link, probability: float) -> None:
        seen = link.seen()
        for mine, theirs, pair in ((a, b, seen), (b, a, seen[::-1])):
            tie = Tie((link.start_ms, link.end_ms), probability, (pair[0], pair[1]))
            self._of.setdefault(mine, {}).setdefault(theirs, []).append(tie)

    def groups(self, numbers: Sequence[int]) -> Iterator[Group]:
        """Yield a group of so many things of each variable for each two that any group begins with.

        Every two members are in a group that is yielded where they are in any at all; of several
        with the same two the likeliest by each further member.
        """
        slots = [var for var, number in enumerate(numbers) for _ in range(number)]
        for one, met in sorted(self._of.items()):
            for other, ties in sorted(met.items()):
                if [one.var, other.var] != slots[:2] or (one.var == other.var and other < one):
                    continue
                waiting = sorted(met.keys() & self._of[other].keys())
                for tie in ties:
                    pair = Group((one, other), tie.span, tie.probability)
                    whole = self._grown(pair, slots[2:], waiting)
                    if whole is not None:
                        yield whole

    def _grown(self, group: Group, slots: Sequence[int], waiting: Sequence[Member]) -> Group | None:
        """Return the group with a member a slot, None where there is none such."""
        if not slots:
            return group
        larger = [one for one in (self._with(group, m) for m in waiting) if one is not None]
        there = Counter(one.members[-1].var for one in larger)
        if any(there[var] < number for var, number in Counter(slots).items()):
            return None
        left = {one.members[-1] for one in larger}
        for one in sorted(larger, key=_ORDER):
            if one.members[-1].var == slots[0]:
                left.discard(one.members[-1])  # what it is a member of was looked for with it
                whole = self._grown(one, slots[1:], sorted(left))
                if whole is not None:
                    return whole
        return None

    def _with(self, group: Group, member: Member) -> Group | None:
        """Return the group with another member, None where it was not together with them all."""
        if any(member.stay[0] == other.stay[0] for other in group.members):
            return None
        span, probability = group.span, group.probability
        for other in group.members:
            tie = self._tie(other, member, span)
            if tie is None:
                return None
            span, probability = _common(span, tie.span), min(probability, tie.probability)
        return Group((*group.members, member), span, probability)

    def _tie(self, one: Member, other: Member, span: Span) -> Tie | None:
        """Return the longest tie of two members within a span."""
        lengths = [
            (end - start, -number, tie)
            for number, tie in enumerate(self._of[one].get(other, ()))
            for start, end in [_common(span, tie.span)]
            if start <= end
        ]
        return max(lengths)[2] if lengths else None

    def moment(self, group: Group) -> Moment:
        """Return the group as a moment, its members as they were seen with the first."""
        first, second, *others = group.members
        tie = self._tie(first, second, group.span)
        assert tie is not None
        seen = [*tie.seen]
        for member in others:
            more = self._tie(first, member, group.span)
            assert more is not None
            seen.append(more.seen[1])
        entries = tuple(
            entry_of(self._tables[member.var], sighting)
            for member, sighting in zip(group.members, seen, strict=True)
        )
        return Moment(entries, *group.span, relation=group.probability)


def of_two_things(related: Related, table: Found, parameters: Parameters) -> Related:
    """Return how likely the figure and the ground of links among one kind are two together.

    Two ids that no frame shows at once may be one thing, before their places are looked at as
    likely as not: of one thing these differ by their errors alone, of two by any distance at which
    they are together.
    """
    apart = [row for row, link in enumerate(related.links) if link.encounter is None]
    if not apart:
        return related
    pairs = pairs_of([related.links[row] for row in apart], table, table)
    away_m2 = np.sum((pairs.position_a - pairs.position_b)[:, :2] ** 2, axis=1)
    variance = np.maximum(pairs.sigma, LEAST_SIGMA_M) ** 2
    one = np.exp(-away_m2 / (2 * variance)) / (2 * math.pi * variance)
    two = 1.0 / (math.pi * parameters.together_m**2)
    held = related.probability.copy()
    held[apart] *= two / (one + two)
    return Related(related.links, held)


def gathered(ties: Ties, numbers: Sequence[int]) -> list[Moment]:
    """Return the moments in which so many things of each variable were together.

    No thing is told twice at one time: of four cups in one picture two and two are together. Of
    those about as likely the longest are told.
    """
    moments = [ties.moment(group) for group in sorted(ties.groups(numbers), key=_ORDER)]
    moments.sort(key=lambda moment: (-round(_worth(moment), 1), moment.start_ms - moment.end_ms))
    told: dict[str, list[Span]] = {}
    out: list[Moment] = []
    for moment in moments:
        span = (moment.start_ms, moment.end_ms)
        if not any(_touches(span, told.get(name, ())) for name in moment.ids):
            out.append(moment)
            for name in moment.ids:
                told.setdefault(name, []).append(span)
    return out


def scattered(ties: Ties, numbers: Sequence[int], figure: Found) -> list[Moment]:
    """Return the figure's sightings in which it was in no group of so many."""
    held: dict[StayKey, list[tuple[Span, float]]] = {}
    for group in ties.groups(numbers):
        for member in group.members:
            if member.var == 0:
                held.setdefault(member.stay, []).append((group.span, group.probability))
    out: list[Moment] = []
    for sighting in figure.sightings:
        span = (sighting.start_ms, sighting.end_ms)
        met = [p for other, p in held.get(sighting.stay, ()) if _touches(span, (other,))]
        absent = 1.0 - max(met, default=0.0)
        if absent >= HOLDS:
            out.append(Moment((entry_of(figure, sighting),), *span, relation=absent))
    return out


def _worth(moment: Moment) -> float:
    """Return how likely the members were together, and are what was asked for."""
    return (moment.relation or 1.0) * prod(map(_fit, moment.entries))


def _fit(entry: Entry) -> float:
    return entry.candidate.match * prod(entry.candidate.attributes.values())


def _common(one: Span, other: Span) -> Span:
    return max(one[0], other[0]), min(one[1], other[1])


def _touches(span: Span, others: Sequence[Span]) -> bool:
    return any(start <= span[1] and end >= span[0] for start, end in others)
