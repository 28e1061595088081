"""Default profile, tier 2: detections at a wrong range.

What is measured in a box is at times what stands before the thing, or behind it: the direction is
right, and how far off it is, is not. What fits nothing that is known is compared once more with
what name and look speak for: as if its own range were wrong, and as if that of a thing were, which
was seen from one side only. The size tells: measured at half the range, a thing is half as large.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.model import Pose, Position
from d3a.parameters import Parameters
from d3a.symmetric import minus
from d3a.tier1 import Thing
from d3a.tracking import likelihood
from d3a.tracking.compared import NEVER, Frame, Misplaced, Scoring
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory

Floats = NDArray[np.float64]
WRONG_ODDS = 3.0
"""Log-odds (20 to 1) that a range is right, before more is known of it."""
WRONG_SHARE, WRONG_LEAST_M = 0.4, 1.0
"""How far off a wrong range is, one sigma: a share of it, or metres if that is more."""
SIZE_SIGMA, SIZES_SIGMA = 0.3, 0.4
"""How sizes vary, as natural logarithms: of one thing from all sides, and those of its category."""
SIZE_MOST = 3.0
"""Log-odds that a size speaks for one thing with at most."""
ALIKE = 3.0
"""Log-odds of name and look from which a new thing looks like a known one."""
ONE_SIDE = 0.9
"""Cosine of the angle within which all viewpoints of a thing are one side of it."""


class WrongRanges:
    """Finds what new things of a frame are, where a range is wrong."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters

    def alike(self, seen: Sequence[Thing], taken: Collection[int]) -> list[Known]:
        """Return the placed things that were called by any of these names; but not the taken."""
        names = {name for thing in seen for name, _ in thing.votes}
        return [
            thing
            for thing in self._memory.called(names)
            if thing.number not in taken and thing.latest.row >= 0
        ]

    def find(
        self,
        frame: Frame,
        pose: Pose,
        offset: FrameOffset,
        things: list[Known],
        scoring: Scoring,
    ) -> tuple[int, dict[int, Misplaced]]:
        """Return how many of a frame's things look like known ones, and what they are, by index.

        things: of their names; scoring: what name and look say of these. A name alone is no look,
        however rare: a few things may lie as others of their names do elsewhere.
        """
        told = scoring.total(np.zeros((2, len(frame.observed.things), len(things))))
        strange = int(((told >= ALIKE) & (np.asarray(scoring.same) > 0)).any(axis=1).sum())
        pairs = np.argwhere(told > 0).tolist()
        if not pairs:
            return strange, {}
        by_view, by_place = self._places(frame, pose, offset, [(i, things[j]) for i, j in pairs])
        score = np.full(told.shape, NEVER)
        at = tuple(np.array(pairs).T)
        score[at] = told[at] + np.maximum(by_view, by_place) - WRONG_ODDS
        is_view = np.zeros(told.shape, dtype=bool)
        is_view[at] = by_view >= by_place
        taken = likelihood.assign(score, self._parameters.new_thing_odds)
        return strange, {
            i: Misplaced(things[j], things[j].latest, bool(is_view[i, j]), float(score[i, j]))
            for i, j in enumerate(taken)
            if j >= 0
        }

    def _places(
        self, frame: Frame, pose: Pose, offset: FrameOffset, pairs: list[tuple[int, Known]]
    ) -> tuple[Floats, Floats]:
        """Return what place and size tell of pairs, (k,) each: if a view errs, or what is known."""
        seen = [i for i, _ in pairs]
        places = [thing.latest for _, thing in pairs]
        columns = self._memory.positions.columns[:, [place.row for place in places]]
        aimed, noise = frame.aim(offset)
        where, noise = aimed[:, seen], noise[:, seen] + columns[3:]
        eye = np.array(minus(pose.position, offset.mean))[:, None]
        known = columns[:3]
        sides = np.array(
            [_side(place, self._memory.positions.of(place).mean) for place in places]
        ).T
        sizes = np.array([_size(frame, i, thing) for i, thing in pairs])
        own = self._along(where - known, noise, where - eye)
        own += _size_told(sizes, _length(where - eye), _length(known - eye))
        theirs = self._along(where - known, noise, known - sides)
        theirs += _size_told(sizes, _length(where - sides), _length(known - sides))
        theirs -= np.log([place.seen for place in places])  # it was measured there so often
        return own, theirs

    def loosen(self, place: Place) -> None:
        """Take back how far off a place is from where it was seen: its next view tells."""
        positions = self._memory.positions
        beam = np.array(minus(positions.of(place).mean, place.seen_from[-1]))
        positions.loosen(place, _wrong(beam[:, None])[:, 0].tolist(), self._parameters)

    def _along(self, away: Floats, noise: Floats, beam: Floats) -> Floats:
        """Return what a place tells (k,), where it may be anywhere along a beam, all (3 | 6, k)."""
        x, y, z = _wrong(beam)
        wide = noise + np.array([x * x, x * y, x * z, y * y, y * z, z * z])
        squared, determinant = likelihood.squared_distances(away, wide)
        parameters = self._parameters
        spaces = (parameters.space_m3,)
        told = likelihood.position_ratios(squared, determinant, spaces, parameters)[0]
        return np.where(squared <= parameters.gate_sigmas**2, told, NEVER)


def _length(vectors: Floats) -> Floats:
    """Return the lengths of vectors (3, k), a millimetre at least."""
    return np.asarray(np.maximum(np.sqrt((vectors * vectors).sum(axis=0)), 1e-3))


def _wrong(beams: Floats) -> Floats:
    """Return how far off wrong ranges are along beams, (3, k)."""
    return beams * np.maximum(WRONG_SHARE, WRONG_LEAST_M / _length(beams))


def _side(place: Place, mean: Position) -> Position:
    """Return from where a place was seen, NaN where it was seen from more than one side."""
    first: Position | None = None
    for eye in place.seen_from:
        (x, y, z), length = minus(mean, eye), math.dist(mean, eye)
        if length == 0.0:
            return _NOWHERE
        beam = x / length, y / length, z / length
        first = beam if first is None else first
        if first[0] * beam[0] + first[1] * beam[1] + first[2] * beam[2] < ONE_SIDE:
            return _NOWHERE
    return place.seen_from[-1] if place.seen_from else _NOWHERE


_NOWHERE = (math.nan, math.nan, math.nan)


def _size(frame: Frame, i: int, thing: Known) -> float:
    """Return by how much larger a view's size is than a thing's, natural logarithm, else NaN."""
    seen, known = frame.observed.things[i].detection.extent_m, thing.extent_m
    if seen is None or known is None:
        return math.nan
    return math.log(seen[0] * seen[1] / (known[0] * known[1])) / 2


def _size_told(sizes: Floats, wrong_m: Floats, right_m: Floats) -> Floats:
    """Return what sizes say (k,) for one thing at another range against two of a category."""
    as_far = np.log(wrong_m / right_m)
    one, two = (sizes - as_far) / SIZE_SIGMA, sizes / SIZES_SIGMA
    told = (two**2 - one**2) / 2 + math.log(SIZES_SIGMA / SIZE_SIGMA)
    return np.minimum(np.nan_to_num(told), SIZE_MOST)
