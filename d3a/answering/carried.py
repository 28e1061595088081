"""What carries a thing, or roofs it: of all that it may lie on or under, one.

A cup at the height of a desk lies on the desk, not on the chair beside it that is as high; a bottle
under the low table is not under the couch; and what lies on a thing is neither before it nor
behind it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from d3a import relations
from d3a.answering.linked import Link, agreed, numbered, pairs_of, usual_of
from d3a.answering.moments import Found, extents, positions
from d3a.answering.pairs import Floats, Pairs, normal_cdf, swapped
from d3a.answering.standing import within_reach
from d3a.parameters import Parameters
from d3a.store.base import StayKey
from grammar.forms import RelationKind

CONTACT_M = 2.0
"""What lies on, under, in or beside a thing is no further from its middle than this."""
LEAST = 0.2
"""Where it is less likely that one is on or under the other, nothing else is asked for."""
LIKELY = 0.5
"""What is more likely than not on a thing is told so, and so not behind it."""
UNLIKELY = 0.02
"""What is less likely to carry or roof a thing speaks against nothing."""
OUTLINE_SHARE, OUTLINE_M = 0.4, 0.15
"""What stands on a thing or is part of it is no further from its middle than this share of its
width, and how well that is known, metres."""
UPON = 0.3
"""Furniture stands on the floor: how likely it is over other furniture, where it seems so."""
MOST = 0.99
"""No place is so sure that nothing may speak against it."""


@dataclass(frozen=True, slots=True)
class Lying:
    """Rows of two things at their places, with their geometry: what is on, under or above what.

    usual: by relation, the categories of what is usual as a ground. carriers: what is large and
    stays. All that is told agrees among the rows of one pair.
    """

    rows: Sequence[Link]
    pairs: Pairs
    figure: Found
    ground: Found
    carriers: Found
    usual: Mapping[RelationKind, Collection[str]]
    parameters: Parameters

    def told(self, kind: RelationKind) -> Floats:
        """Return how likely figures are on, under or above grounds (n,), NaN where nothing tells.

        Of any other relation: how likely neither of the two lies on the other.
        """
        match kind:
            case "on":
                return self._of_one("on")
            case "under":
                return self._beneath()
            case "above":
                return self._turned()._beneath()
            case _:
                return self._off_each_other()

    def _beneath(self) -> Floats:
        """Return how likely figures are under grounds: roofed, or with these on or over them.

        So above is the inverse of under, and what a thing lies on is under it.
        """
        over = self._turned()
        parts = (self._of_one("under"), over._of_one("on"), over._of_pair("above"))
        return np.asarray(np.fmax.reduce(parts))

    def _off_each_other(self) -> Floats:
        """Return 1 where nothing tells and it is not likely: sides have doubts of their own."""
        either = np.fmax(self._of_one("on"), self._turned()._of_one("on"))
        return np.where(either >= LIKELY, 1.0 - either, 1.0)

    def _turned(self) -> Lying:
        """Return the same with figures and grounds the other way round."""
        rows = [link.turned() for link in self.rows]
        return replace(
            self, rows=rows, pairs=swapped(self.pairs), figure=self.ground, ground=self.figure
        )

    def _of_pair(self, kind: RelationKind) -> Floats:
        """Return what two things alone tell, as frames agree on it."""
        grounds, usual = [k.ground for k in self.rows], self.usual.get(kind, ())
        pairs = replace(self.pairs, usual_b=usual_of(grounds, self.ground, usual))
        held = agreed(self.rows, relations.probability(kind, pairs, self.parameters))
        if kind == "under":
            return held
        figures, furniture = [k.figure for k in self.rows], self.usual.get("under", ())
        upon = usual_of(figures, self.figure, furniture) & usual_of(grounds, self.ground, furniture)
        return np.where(upon, UPON * held, held)

    def _of_one(self, kind: RelationKind) -> Floats:
        """Return how likely figures are on or under these grounds, of all that there are.

        Each carrier that the figure may be on, or under, as well speaks against the ground, by its
        odds; but not what is part of the ground, or lies on it itself.
        """
        held = self._of_pair(kind)
        likely = held >= LEAST  # False for NaN
        if not self.carriers.stays or not likely.any():
            return held
        pair = numbered((link.figure, link.ground) for link in self.rows)  # all its rows agree
        _, first = np.unique(np.where(likely, pair, -1), return_index=True)
        asked = [self.rows[k] for k in first.tolist() if likely[k]]
        at, rivals = _rivals(asked, self.figure, self.carriers)
        usual = self.usual.get(kind, ())
        pairs = pairs_of(rivals, self.figure, self.carriers, usual)
        other = relations.probability(kind, pairs, self.parameters)
        told = np.flatnonzero(other >= UNLIKELY).tolist()
        if not told:
            return held
        grounds, others = [asked[at[k]].ground for k in told], [rivals[k].ground for k in told]
        odds = _odds(other[told]) * _apart(grounds, self.ground, others, self.carriers)
        of = pair[first[likely[first]]][[at[k] for k in told]]
        against = np.bincount(of, odds, minlength=int(pair.max()) + 1)
        own = _odds(held)
        return np.where(against[pair] > 0, own / (1.0 + own + against[pair]), held)


def _odds(p: Floats) -> Floats:
    likely = np.clip(np.nan_to_num(p), 0.0, MOST)
    return np.asarray(likely / (1.0 - likely))


def _apart(ones: Sequence[StayKey], one: Found, others: Sequence[StayKey], other: Found) -> Floats:
    """Return how likely neither of two stays stands on the other or is part of it (n,)."""
    away = positions([one.stays.get(key) for key in ones])
    away -= positions([other.stays[key] for key in others])
    widths = [
        extents(of, [name for name, _ in keys]) for of, keys in ((one, ones), (other, others))
    ]
    half = np.fmax(widths[0][:, 0], widths[1][:, 0]) * OUTLINE_SHARE
    off = np.hypot(away[:, 0], away[:, 1])  # floors are in the x-y plane
    return normal_cdf(np.nan_to_num((off - half) / OUTLINE_M))


def _rivals(met: Sequence[Link], figure: Found, carriers: Found) -> tuple[list[int], list[Link]]:
    """Return each link's row with its figure and another thing in reach that may carry it."""
    keys = sorted(carriers.stays)
    here = positions([figure.stays.get(link.figure) for link in met])
    there = positions([carriers.stays[key] for key in keys])
    row, column = within_reach(here, there, CONTACT_M)
    rows: list[int] = []
    found: list[Link] = []
    for k, at in zip(row.tolist(), column.tolist(), strict=True):
        link, key = met[k], keys[at]
        if key[0] not in (link.figure[0], link.ground[0]):
            seen = link.seen()[0] if link.encounter is not None else None
            rows.append(k)
            both = None if seen is None else (seen, seen)
            found.append(Link(link.figure, key, link.start_ms, link.end_ms, sightings=both))
    return rows, found
