"""Default profile, tier 2: which thing each detection of a frame is.

One-to-one by likelihood, twice: the first assignment tells how far off the whole frame is (a
localisation's error is common to all its detections, and drifts slowly), the second uses that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.frame_offset import FrameOffset
from d3a.likelihood import BESIDE, OTHER, SAME, CategoryModel, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Known, Memory, Place
from d3a.model import Pose
from d3a.neighbours import REACH_M, Neighbours
from d3a.parameters import Parameters
from d3a.tier1 import Thing

Floats = NDArray[np.float64]
NEVER = -1e9
"""Score of a pair that is not compared: out of the gate."""


@dataclass(frozen=True, slots=True)
class Observed:
    """The things of a frame as arrays. Unknown positions are NaN, unknown looks zeros.

    places: (n, 3). noise: (n, 3, 3), each detection's own. looks: (n, d), d = 0 without pictures.
    """

    things: tuple[Thing, ...]
    places: Floats
    noise: Floats
    looks: NDArray[np.float32]

    @property
    def nowhere(self) -> NDArray[np.bool_]:
        """(n,): which have no position."""
        return np.isnan(self.places[:, 0])

    @property
    def boxes(self) -> Floats:
        """(n, 4): in pixels."""
        boxes = [thing.detection.box for thing in self.things]
        return np.array(boxes, dtype=np.float64).reshape(-1, 4)

    @classmethod
    def of(cls, things: list[Thing], is_histogram: bool) -> Observed:
        """Return the arrays of a frame's things."""
        unknown = (math.nan,) * 3
        detections = [thing.detection for thing in things]
        places = np.array([d.position or unknown for d in detections], dtype=np.float64)
        noise = np.array([d.covariance or (0.0,) * 9 for d in detections], dtype=np.float64)
        found = [
            None if d.embedding is None else likelihood.feature(d.embedding, is_histogram)
            for d in detections
        ]
        length = next((len(row) for row in found if row is not None), 0)
        none = np.zeros(length, dtype=np.float32)
        looks = np.array([none if row is None else row for row in found], dtype=np.float32)
        count = len(things)
        return cls(
            tuple(things),
            places.reshape(count, 3),
            noise.reshape(count, 3, 3),
            looks.reshape(count, length),
        )


Match = tuple[Known, Place | None] | None
"""The thing and the place of it that a detection is at, None for a new thing."""


@dataclass(frozen=True, slots=True)
class Gated:
    """Where rows of places go in a table of things: each thing's first, and its further ones.

    rows: in the table of positions, by thing. columns: the thing of each. first, further: indices
    of them. placeless: columns of things without a position. things: how many columns there are.
    """

    rows: NDArray[np.intp]
    columns: list[int]
    first: list[int]
    further: list[int]
    placeless: list[int]
    things: int


@dataclass(frozen=True, slots=True)
class Scoring:
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


def _is_placed(observed: Observed) -> NDArray[np.bool_]:
    """Say which things (n,) have places precise enough to tell what stands beside them."""
    sigma = np.sqrt(np.trace(observed.noise, axis1=1, axis2=2) / 3)
    return np.asarray(sigma <= REACH_M / 2)


def _apart(observed: Observed) -> Floats:
    """Return the distances (n, n) between the things of a frame, NaN where unknown."""
    places = np.where(_is_placed(observed)[:, None], observed.places, np.nan)
    steps = places[:, None] - places[None]
    return np.asarray(np.sqrt(np.sum(steps**2, axis=2)))


class Matcher:
    """Scores a frame's detections against the memory and assigns them."""

    def __init__(self, memory: Memory, categories: CategoryModel, parameters: Parameters) -> None:
        likelihood.load_solver()
        self._memory = memory
        self._categories = categories
        self._parameters = parameters
        self.looks = LookModel(parameters)
        self.space = LookSpace(parameters)
        self.neighbours = Neighbours(parameters)
        self.offset = FrameOffset.unknown(parameters)
        self.one: frozenset[str] = frozenset()
        """Ids of what a person made one of several: it may look like any of them."""
        self.residuals = np.array([1.0, 1.0]) * parameters.noise_prior
        """Summed squared residuals by what was expected of them, and their number."""

    def _scaled(self, observed: Observed, pose: Pose | None) -> Observed:
        """Return the frame with its noise corrected by how far positions scatter in truth.

        Learned from things that were recognised, so that precise positions separate neighbours.
        Without a pose a position and its covariance are the recording's own, and believed.
        """
        if pose is None:
            return observed
        learned = float(self.residuals[0] / self.residuals[1])
        scale = max(self._parameters.noise_least, learned)
        return replace(observed, noise=observed.noise * scale)

    def match(self, observed: Observed, time_ms: int, pose: Pose | None) -> list[Match]:
        """Return for each observed thing what it is; updates the frame's offset."""
        self.offset.predict(time_ms, pose)
        if not observed.things:
            return []
        observed = self._scaled(observed, pose)
        apart = self._meet(observed)
        self.space.add(observed.looks)
        rows = self._gate(observed)
        things = self._candidates(observed, rows)
        if not things:
            return [None] * len(observed.things)
        scoring = self._scoring(observed, things)
        gated = self._gated(things, rows)
        place, at = self._place(observed, gated)
        score = scoring.total(place)
        new = self._parameters.new_thing_odds
        taken = likelihood.assign(score, new)
        if self._align(observed, things, taken, at):
            place, at = self._place(observed, gated)
            score = scoring.total(place)
            taken = likelihood.assign(score, new)
        if scoring.likeness is not None:
            self._learn(observed, things, taken, scoring, scoring.without_look(place), apart)
        owners = self._memory.positions.owners
        return [
            None
            if column < 0
            else (things[column], owners[at[i, column]][1] if at[i, column] >= 0 else None)
            for i, column in enumerate(taken)
        ]

    def _meet(self, observed: Observed) -> Floats:
        """Learn how near to each other things of different categories stand; give how near."""
        names = np.array([thing.detection.category for thing in observed.things])
        apart = _apart(observed)
        self.neighbours.add(np.where(names[:, None] == names[None], np.nan, apart))
        return apart

    def _gate(self, observed: Observed) -> NDArray[np.intp]:
        """Return the rows of places that any detection may be at, by thing and place."""
        positions = self._memory.positions
        if len(positions.owners) == 0:
            return np.empty(0, dtype=np.intp)
        axes = (0, 1, 2)
        spread = positions.spread[:, axes, axes]
        noise = (observed.noise + self.offset.covariance)[:, axes, axes]
        away = (observed.places - self.offset.mean)[:, None] - positions.mean[None]
        # Along each axis alone: no pair within the gate is outside of this, and it is quick.
        reach = self._parameters.gate_sigmas**2 * (noise[:, None] + spread[None])
        rows = np.flatnonzero(np.any(np.all(away**2 <= reach, axis=2), axis=0)).tolist()
        owners = positions.owners
        rows.sort(key=lambda row: (owners[row][0].number, owners[row][1].number))
        return np.array(rows, dtype=np.intp)

    def _candidates(self, observed: Observed, rows: NDArray[np.intp]) -> list[Known]:
        """Return the things to compare with, by number.

        What has no position is near everything, and to a detection without one all are.
        """
        if observed.nowhere.any():
            return [self._memory.things[number] for number in sorted(self._memory.things)]
        found = {self._memory.positions.owners[row][0].number for row in rows.tolist()}
        found |= {thing.number for thing in self._memory.placeless()}
        return [self._memory.things[number] for number in sorted(found)]

    def _scoring(self, observed: Observed, things: list[Known]) -> Scoring:
        """Return the evidence of category and look; of a thing named twice one name may agree."""
        names = [name for thing in observed.things for name in thing.votes]
        agreed, differing = self._categories.evidence(names, [thing.shares for thing in things])
        if len(names) > len(observed.things):
            starts = np.cumsum([0, *(len(thing.votes) for thing in observed.things)])[:-1]
            agreed = np.maximum.reduceat(agreed, starts, axis=0)
            differing = np.maximum.reduceat(differing, starts, axis=0)
        looks = self._memory.looks
        if observed.looks.shape[1] == 0 or looks.length == 0:
            return Scoring(agreed, differing)
        pictured = np.array([thing.look_weight > 0 for thing in things])
        known = np.any(observed.looks, axis=1, keepdims=True) & pictured
        seen, kept = self.space.of(observed.looks), looks.units(things, self.space)
        likeness = np.where(known, (seen @ kept.T).astype(np.float64), np.nan)
        views = np.array([thing.look_weight for thing in things])
        same, beside = (
            np.nan_to_num(self.looks.ratios(likeness, views, kind), nan=0.0)
            for kind in (OTHER, BESIDE)
        )
        if self.one and any(told := [thing.object_id in self.one for thing in things]):
            same = np.where(told, np.maximum(same, 0.0), same)  # no look of its own to differ from
        beside = np.where(_is_placed(observed)[:, None], beside, same)
        return Scoring(agreed, differing, same, beside, likeness)

    def _gated(self, things: list[Known], rows: NDArray[np.intp]) -> Gated:
        """Return the columns that the rows of places have in the table of these things."""
        owners = self._memory.positions.owners
        number = {thing.number: column for column, thing in enumerate(things)}
        columns = [number[owners[row][0].number] for row in rows.tolist()]
        first: list[int] = []
        further: list[int] = []
        for k, column in enumerate(columns):  # rows are by thing
            (further if k and column == columns[k - 1] else first).append(k)
        placeless = [j for j, thing in enumerate(things) if all(p.row < 0 for p in thing.places)]
        return Gated(rows, columns, first, further, placeless, len(things))

    def _place(self, observed: Observed, gated: Gated) -> tuple[Floats, NDArray[np.intp]]:
        """Return the evidence of place, (2, n, m), and the row of the place it is of.

        First against another thing anywhere, then against one that stands beside. Row -1: none.
        """
        shape = (len(observed.things), gated.things)
        place = np.full((2, *shape), NEVER)
        at = np.full(shape, -1, dtype=np.intp)
        rows, columns, first = gated.rows, gated.columns, gated.first
        if len(rows):
            ratios = self._place_ratios(observed, rows)
            if not gated.further and len(first) == gated.things:
                place, at[:] = ratios, rows
            else:
                target = [columns[k] for k in first]
                place[:, :, target] = ratios[:, :, first]
                at[:, target] = rows[first]
            for k in gated.further:  # places of a thing that moved
                better = ratios[0, :, k] > place[0, :, columns[k]]
                place[:, better, columns[k]] = ratios[:, better, k]
                at[better, columns[k]] = rows[k]
        nowhere = observed.nowhere
        if nowhere.any():
            place[:, nowhere] = 0.0
            at[nowhere] = -1
        if gated.placeless:
            place[:, :, gated.placeless] = 0.0
        return place, at

    def _learn(
        self,
        observed: Observed,
        things: list[Known],
        taken: list[int],
        scoring: Scoring,
        evidence: Floats,
        apart: Floats,
    ) -> None:
        """Teach the look model by what place and category (`evidence`) decided without it."""
        least = self._parameters.plain_odds
        confirmed = [thing.seen >= self._parameters.confirm_sightings for thing in things]
        likeness = scoring.likeness
        assert likeness is not None
        for i, column in enumerate(taken):
            if column < 0 or not confirmed[column]:
                continue
            thing = things[column]
            for j in range(len(taken)):  # the other detections of this frame are other things
                if j == i or math.isnan(likeness[j, column]):
                    continue
                if taken[j] >= 0 and things[taken[j]].category == thing.category:
                    self.looks.add(OTHER, float(likeness[j, column]), thing.look_weight)
                elif apart[i, j] <= REACH_M:
                    self.looks.add(BESIDE, float(likeness[j, column]), thing.look_weight)
            rivals = np.concatenate(
                [np.delete(evidence[i], column), np.delete(evidence[:, column], i)]
            )
            is_plain = evidence[i, column] >= least and (rivals < 0).all()
            if is_plain and not math.isnan(likeness[i, column]):
                self.looks.add(SAME, float(likeness[i, column]), thing.look_weight)
                mean = self._memory.looks.rows([thing])[0]
                self.space.add_same(observed.looks[i], mean, thing.look_weight)

    def _place_ratios(self, observed: Observed, rows: NDArray[np.intp]) -> Floats:
        """Return the evidence of place (2, n, rows) as `_place` does, NEVER out of the gate."""
        positions = self._memory.positions
        residuals = (observed.places - self.offset.mean)[:, None] - positions.mean[rows][None]
        covariances = (observed.noise + self.offset.covariance)[:, None] + positions.spread[rows]
        squared, determinant = likelihood.mahalanobis(residuals, covariances)
        beside = self.neighbours.space_m3(np.sqrt(np.sum(residuals**2, axis=2)))
        ratios = likelihood.position_ratios(
            squared, determinant, (self._parameters.space_m3, beside), self._parameters
        )
        return np.where(squared <= self._parameters.gate_sigmas**2, ratios, NEVER)

    def _align(
        self,
        observed: Observed,
        things: list[Known],
        taken: list[int],
        at: NDArray[np.intp],
    ) -> bool:
        """Correct the frame's offset by what was recognised; say whether there was anything.

        Only what was seen before in another frame tells: a tentative thing may be a mistake.
        """
        positions = self._memory.positions
        pairs = [
            (i, int(at[i, column]))
            for i, column in enumerate(taken)
            if column >= 0
            and at[i, column] >= 0
            and things[column].seen >= self._parameters.confirm_sightings
        ]
        if not pairs or not self.offset.covariance.any():
            return False
        seen, rows = (list(each) for each in zip(*pairs, strict=True))
        residuals = observed.places[seen] - positions.mean[rows]
        self.offset.correct(residuals, observed.noise[seen] + positions.spread[rows])
        return True

    def update(self, observed: Observed, pairs: list[tuple[int, Place]], pose: Pose | None) -> None:
        """Move the matched places towards what was observed: Kalman, robust, all at once."""
        positions = self._memory.positions
        if not pairs:
            return
        observed = self._scaled(observed, pose)
        seen = [i for i, _ in pairs]
        rows = [place.row for _, place in pairs]
        surface = np.eye(3) * self._parameters.object_spread_m**2
        noise = observed.noise[seen] + self.offset.covariance
        residuals = observed.places[seen] - self.offset.mean - positions.mean[rows]
        squared, _ = likelihood.mahalanobis(residuals, noise + positions.spread[rows])
        dof = self._parameters.outlier_dof
        weight = np.minimum(1.0, (dof + 3) / (dof + squared))[:, None, None]
        if pose is not None:
            inside = squared[squared <= self._parameters.noise_gate]
            self.residuals += (float(inside.sum()) / 3, len(inside))
        error = positions.error[rows]
        gain = error @ np.linalg.inv(error + (noise + surface) / weight)
        positions.mean[rows] += np.einsum("nij,nj->ni", gain, residuals)
        raw = observed.places[seen] - positions.raw[rows]
        positions.raw[rows] += np.einsum("nij,nj->ni", gain, raw)
        left = error - gain @ error
        positions.error[rows] = (left + left.transpose(0, 2, 1)) / 2
        positions.scale[rows] += np.stack(
            [np.minimum(squared, self._parameters.gate_sigmas**2) / 3, np.ones(len(rows))], axis=1
        )
        positions.respread(rows, self._parameters)
