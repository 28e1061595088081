"""What carries a thing, or roofs it: of all that it may lie on or under, one.

A cup at the height of a desk lies on the desk, not on the chair beside it that is as high; a bottle
under the low table is not under the couch; and what lies on a thing is neither before it nor
behind it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from d3a import relations
from d3a.answering.linked import Link, agreed, numbered, pairs_of
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
MOST = 0.99
"""No place is so sure that nothing may speak against it."""


class Lying(NamedTuple):
    """Links of figures and grounds, of which it is asked which lies on or under which.

    pairs: the geometry of the links. carriers: what is large and stays; each of them that a figure
    may be on, or under, as well speaks against its ground, by its odds; but not what is part of
    the ground, or lies on it itself. usual: the categories of what is usual as a ground.
    """

    met: Sequence[Link]
    pairs: Pairs
    figure: Found
    ground: Found
    carriers: Found
    usual: Collection[str]
    parameters: Parameters

    def held(self, kind: RelationKind) -> Floats:
        """Return how likely figures are on or under grounds (n,), NaN where nothing tells."""
        met, carriers = self.met, self.carriers
        held = agreed(met, relations.probability(kind, self.pairs, self.parameters))
        likely = held >= LEAST  # False for NaN
        if not carriers.stays or not likely.any():
            return held
        pair = numbered((link.figure, link.ground) for link in met)  # all its links agree
        _, first = np.unique(np.where(likely, pair, -1), return_index=True)
        asked = [met[k] for k in first.tolist() if likely[k]]
        rows, rivals = _rivals(asked, self.figure, carriers)
        rivalling = pairs_of(rivals, self.figure, carriers, self.usual)
        other = relations.probability(kind, rivalling, self.parameters)
        told = np.flatnonzero(other >= UNLIKELY).tolist()
        if not told:
            return held
        grounds, others = [asked[rows[k]].ground for k in told], [rivals[k].ground for k in told]
        odds = _odds(other[told]) * _apart(grounds, self.ground, others, carriers)
        of = pair[first[likely[first]]][[rows[k] for k in told]]
        against = np.bincount(of, odds, minlength=int(pair.max()) + 1)
        own = _odds(held)
        return np.where(against[pair] > 0, own / (1.0 + own + against[pair]), held)

    def turned(self) -> Lying:
        """Return the same of the grounds, as lying on or under the figures."""
        return self._replace(
            met=[link.turned() for link in self.met],
            pairs=swapped(self.pairs),
            figure=self.ground,
            ground=self.figure,
        )

    def off_each_other(self) -> Floats:
        """Return how likely neither of two lies on the other (n,).

        1 where nothing tells, and where it is not likely: before and behind have their own doubts.
        """
        over, below = self.held("on"), self.turned().held("on")
        either = np.fmax(np.nan_to_num(over), np.nan_to_num(below))
        return np.where(either >= LIKELY, 1.0 - either, 1.0)


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
            seen = link.seen()[0]
            rows.append(k)
            found.append(Link(link.figure, key, link.start_ms, link.end_ms, sightings=(seen, seen)))
    return rows, found
