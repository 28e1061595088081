"""A link of two things that met, and the geometry of many links as arrays.

What one frame shows of two things tells how far they are apart without the error of the robot's
place. It counts before the difference of their places, which are means over visits.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterable, Sequence
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.answering.moments import Found, extents, positions
from d3a.answering.pairs import Floats, Pairs, placed_together, with_middles
from d3a.answering.places import sigma_of, up_of
from d3a.frozen import maker
from d3a.model import Box
from d3a.store.base import LEAST_SIGMA_M, Apart, Encounter, Sighting, StayKey


class Link(NamedTuple):
    """Where a figure's and a ground's stay meet in time.

    encounter: the shared frame, flipped where the figure is its second object; None where only
    the intervals overlap, then `sightings` are the two. standing: both were at their places from
    then to then, though nothing was seen of both at once. Neither is known of two places alone.
    A tuple: there are thousands of them.
    """

    figure: StayKey
    ground: StayKey
    start_ms: int
    end_ms: int
    encounter: Encounter | None = None
    flipped: bool = False
    sightings: tuple[Sighting, Sighting] | None = None
    standing: tuple[int, int] | None = None

    @property
    def stood(self) -> tuple[int, int]:
        """Return the interval in which what is told of the link was so."""
        return self.standing or (self.start_ms, self.end_ms)

    def seen(self) -> tuple[Sighting, Sighting]:
        """Return figure and ground as sightings, those of the shared frame where there is one."""
        if self.sightings is not None:
            return self.sightings
        e = self.encounter
        assert e is not None
        own, other = self.boxes()
        return _seen(e, self.figure, own), _seen(e, self.ground, other)

    def turned(self) -> Link:
        """Return the same with figure and ground the other way round."""
        seen = None if self.sightings is None else (self.sightings[1], self.sightings[0])
        return self._replace(
            figure=self.ground, ground=self.figure, flipped=not self.flipped, sightings=seen
        )

    def boxes(self) -> tuple[Box, Box]:
        """Return the boxes of figure and ground in the shared frame, NaN without one."""
        e = self.encounter
        if e is None:
            return _NO_BOX, _NO_BOX
        return (e.box_b, e.box_a) if self.flipped else (e.box_a, e.box_b)

    def apart(self) -> Apart:
        """Return how far the ground is from the figure as their frames measured it, else NaN."""
        told = None if self.encounter is None else self.encounter.apart
        if told is None:
            return _NO_BOX
        return (-told[0], -told[1], -told[2], told[3]) if self.flipped else told

    def viewer(self) -> tuple[float, ...]:
        """Return the camera's pose that the sides are told from, NaN where unknown.

        Of two frames the same one, whichever of the two things is asked about.
        """
        if self.encounter is not None:
            return self.encounter.viewer or _NO_POSE
        if self.sightings is None:
            return _NO_POSE
        one, other = sorted(self.sightings, key=_STAY)
        return one.viewer or other.viewer or _NO_POSE


_STAY = attrgetter("stay")
_sighting = maker(Sighting)
_NO_BOX: Box = (math.nan, math.nan, math.nan, math.nan)
_NO_POSE = (math.nan,) * 7
FAR_M = 1e6
"""How far apart the maps of two sites are laid; a store's places are nearer to zero."""


def _seen(encounter: Encounter, stay: StayKey, box: Box) -> Sighting:
    """Return one side of an encounter as a sighting in its frame."""
    e = encounter  # by position: there are hundreds of them
    return _sighting(
        stay[0],
        stay[1],
        e.start_ms,
        e.end_ms,
        e.frame,
        e.probability,
        box,
        e.image,
        e.seen,
        "",
        e.recording,
        None,
        e.viewer,
    )


def pairs_of(
    found: Sequence[Link],
    figure: Found,
    ground: Found,
    usual: Collection[str] = (),
    *,
    beside: Sequence[Link] = (),
) -> Pairs:
    """Return the geometry of links as arrays, a row a link. usual: see `joins.Asked`.

    beside: further links, of which only what their frames tell of the same two stays counts: it is
    the same at every time at which it is asked.
    """
    rows = [*found, *beside]
    stays_a = [figure.stays.get(link.figure) for link in rows]
    stays_b = [ground.stays.get(link.ground) for link in rows]
    boxes = [link.boxes() for link in rows]
    sigma = [math.hypot(sigma_of(a), sigma_of(b)) for a, b in zip(stays_a, stays_b, strict=True)]
    upright = [math.hypot(up_of(a), up_of(b)) for a, b in zip(stays_a, stays_b, strict=True)]
    # each site has a map of its own: another's is laid where nothing is near
    others = [a and b and a.site != b.site for a, b in zip(stays_a, stays_b, strict=True)]
    pairs = Pairs(
        position_a=positions(stays_a),
        position_b=positions(stays_b) + FAR_M * np.array(others, dtype=bool)[:, None],
        sigma=np.array(sigma, dtype=np.float64),
        box_a=_array([own for own, _ in boxes], 4),
        box_b=_array([other for _, other in boxes], 4),
        viewer=_array([link.viewer() for link in rows], 7),
        extent_a=extents(figure, [link.figure[0] for link in rows]),
        extent_b=extents(ground, [link.ground[0] for link in rows]),
        sigma_up=np.array(upright, dtype=np.float64),
        usual_b=usual_of([link.ground for link in rows], ground, usual),
    )
    group = numbered((link.figure, link.ground) for link in rows)
    told = with_middles(placed_together(pairs, _apart(rows, group)), group)
    return told.at(slice(len(found))) if beside else told


def usual_of(grounds: Sequence[StayKey], found: Found, usual: Collection[str]) -> NDArray[np.bool_]:
    """Return which grounds are of a category that is usual as one (n,)."""
    known = [found.candidates[name].record.category in usual for name, _ in grounds]
    return np.array(known, dtype=np.bool_)


def _apart(rows: Sequence[Link], group: NDArray[np.intp]) -> Floats:
    """Return what all shared frames of two stays measured between them (n, 4), see `Encounter`.

    Neither moved in between: the mean counts, and a link without a shared frame has it too.
    """
    told = _array([link.apart() for link in rows], 4)
    known = ~np.isnan(told[:, 3])
    if not known.any():
        return told
    weight = np.where(known, 1.0 / np.maximum(np.nan_to_num(told[:, 3]), LEAST_SIGMA_M) ** 2, 0.0)
    total = np.bincount(group, weight)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = [np.bincount(group, weight * np.nan_to_num(told[:, k])) / total for k in range(3)]
        return np.stack([*mean, np.where(total > 0, total**-0.5, np.nan)], axis=1)[group]


def numbered(keys: Iterable[Hashable]) -> NDArray[np.intp]:
    """Return a number for each key, equal ones for equal keys, in the order of appearance (n,)."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(key, len(numbers)) for key in keys], dtype=np.intp)


def agreed(found: Sequence[Link], held: Floats) -> Floats:
    """Return the mean of what the pictures of two stays say: neither moved in between (n,)."""
    group, told = numbered((link.figure, link.ground) for link in found), ~np.isnan(held)
    count = np.bincount(group, told)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(group, np.where(told, held, 0.0)) / count
    return np.where(told, mean[group], held) if len(found) else held


def _array(rows: Sequence[Sequence[float]], width: int) -> Floats:
    return np.array(rows, dtype=np.float64).reshape(len(rows), width)
