"""Default profile: a frame's things and what they are compared with, as arrays of tier 2."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.observed import Observed

Floats = NDArray[np.float64]
NEVER = -1e9
"""Score of a pair that is not compared: out of the gate."""


Aim = tuple[Floats, Floats]
"""Places (3, n) and noise (6, n) of a frame's things in the map, by what is known of its offset."""


class Frame(NamedTuple):
    """What of a frame's things is the same for all that they are compared with.

    scale: correction of each detection's own noise by what is learned. placed: whose places tell
    what stands beside them. near: pairs of things, both ways, that stand side by side. shells_m3:
    see `Neighbours`.
    """

    observed: Observed
    scale: float
    placed: list[bool]
    near: frozenset[tuple[int, int]]
    shells_m3: Floats

    def aim(self, offset: FrameOffset) -> Aim:
        """Return where the things are, the frame being off by so much."""
        mean, covariance = np.array(offset.mean), np.array(offset.covariance)
        noise = self.observed.noise * self.scale + covariance[:, None]
        return self.observed.places - mean[:, None], noise

    def part(self, wanted: list[int]) -> Frame:
        """Return some things of the frame, as if nothing stood beside them."""
        placed = [self.placed[i] for i in wanted]
        return Frame(self.observed.part(wanted), self.scale, placed, frozenset(), self.shells_m3)


class Gated(NamedTuple):
    """The things that a frame's may be, and where they may be.

    rows: in the table of positions, by thing; columns, there: those of that table. spans: of each
    thing where its rows begin and end among these; equal where it has none. placeless: indices of
    things without a position. nowhere: detections without one.
    """

    things: list[Known]
    rows: list[int]
    columns: Floats
    there: Floats
    spans: list[tuple[int, int]]
    placeless: list[int]
    nowhere: list[int]

    def by_thing(self, ratios: Floats) -> Floats:
        """Return the evidence of each thing's likeliest place, (2, n, m), from that of rows."""
        if len(self.things) == len(self.rows) and not self.nowhere and not self.placeless:
            return ratios  # each has one place
        known = [k for k, (start, stop) in enumerate(self.spans) if start < stop]
        place = np.full((*ratios.shape[:2], len(self.things)), NEVER)
        if known:
            starts = [self.spans[k][0] for k in known]
            place[:, :, known] = np.maximum.reduceat(ratios, starts, axis=2)
        place[:, self.nowhere] = 0.0
        place[:, :, self.placeless] = 0.0
        return place

    def at(self, ratios: Floats, taken: list[int]) -> list[int]:
        """Return the row of the place where each detection is, from the evidence of rows (n, k).

        taken: as in `Assigned`. Row -1: it is new, or nowhere.
        """
        found = [-1] * len(taken)
        for i, column in enumerate(taken):
            start, stop = self.spans[column] if column >= 0 else (0, 0)
            if start < stop and i not in self.nowhere:
                best = int(ratios[i, start:stop].argmax()) if stop - start > 1 else 0
                found[i] = self.rows[start + best]
        return found


class Scoring(NamedTuple):
    """The evidence of category and look of each detection for each thing, all (n, m).

    agreed, differing: of the category, if the thing is of it, and if it was named wrongly.
    same, beside: of the look, against another thing of the category, and against one of another
    category that stands beside. likeness: the cosines, NaN if unknown; None without pictures.
    """

    agreed: Floats
    differing: Floats
    same: Floats | float = 0.0
    beside: Floats | float = 0.0
    likeness: Floats | None = None

    def total(self, place: Floats) -> Floats:
        """Return all evidence (n, m) with that of place (2, n, m)."""
        return np.asarray(
            np.logaddexp(
                self.agreed + place[0] + self.same, self.differing + place[1] + self.beside
            )
        )

    def without_look(self, place: Floats) -> Floats:
        """Return the evidence of place and category alone."""
        return np.asarray(np.logaddexp(self.agreed + place[0], self.differing + place[1]))


class Misplaced(NamedTuple):
    """What a detection is, if a range is wrong. by_view: its own; else that of the known place."""

    thing: Known
    place: Place
    by_view: bool
    odds: float


class Assigned(NamedTuple):
    """One way to explain a frame, with its localisation off by so much.

    taken: for each thing of the frame the column of `things`, -1 for a new one. at: the row of its
    place, see `Gated.at`. place: its evidence, (2, n, m), see `Matcher._place_ratios`. score: all
    evidence (n, m). misplaced: what new ones are else, by the frame's thing. strange: how many of
    the new ones look like something known.
    """

    things: list[Known]
    taken: list[int]
    at: list[int]
    place: Floats
    scoring: Scoring
    score: Floats
    misplaced: dict[int, Misplaced]
    strange: int

    def is_known_place(self) -> bool:
        """Say whether most of the frame's things are known, as they are where a robot has been.

        In a room that is new to it a few may lie as others like them do elsewhere.
        """
        return 2 * (self.taken.count(-1) - len(self.misplaced)) < len(self.taken)

    def worth(self, new_score: float) -> float:
        """Return the log-odds of it all against "all are new"."""
        known = [
            self.score[i, column] - new_score for i, column in enumerate(self.taken) if column >= 0
        ]
        return float(sum(known)) + sum(each.odds for each in self.misplaced.values())
