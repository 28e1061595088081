"""Default profile, tier 2: which thing each detection of a frame is.

One-to-one by likelihood, twice: the first assignment tells how far off the whole frame is (a
localisation's error is common to all its detections, and drifts slowly), the second uses that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.frame_offset import FrameOffset
from d3a.known import Known, Place
from d3a.likelihood import BESIDE, OTHER, SAME, UPPER, VARIANCES, CategoryModel, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Memory
from d3a.model import Pose
from d3a.neighbours import REACH_M, Neighbours
from d3a.observed import Observed
from d3a.parameters import Parameters
from d3a.symmetric import of_rows

Floats = NDArray[np.float64]
NEVER = -1e9
"""Score of a pair that is not compared: out of the gate."""

Match = tuple[Known, Place | None] | None
"""The thing and the place of it that a detection is at, None for a new thing."""


@dataclass(frozen=True, slots=True)
class Frame:
    """What of a frame's things is the same for all that they are compared with.

    places: (3, n). noise: (6, n), the numbers xx xy xz yy yz zz of each detection's own, corrected
    by what is learned. placed: (n,), whose places tell what stands beside them. near: pairs of
    things, both ways, that stand side by side. shells_m3: see `Neighbours`.
    """

    observed: Observed
    places: Floats
    noise: Floats
    placed: NDArray[np.bool_]
    near: frozenset[tuple[int, int]]
    shells_m3: Floats


@dataclass(frozen=True, slots=True)
class Gated:
    """Where rows of places go in a table of things: each thing's first, and its further ones.

    rows: in the table of positions, by thing; columns: those of that table. first: indices of
    rows, and target, the thing that each is of. further: the same of things that moved, in turns
    that have each thing once. placeless: columns of things without a position. things: how many.
    """

    rows: NDArray[np.intp]
    columns: Floats
    first: NDArray[np.intp]
    target: NDArray[np.intp]
    further: list[tuple[NDArray[np.intp], NDArray[np.intp]]]
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


def _beside(observed: Observed, placed: NDArray[np.bool_]) -> dict[tuple[int, int], float]:
    """Return the pairs of a frame's things that stand side by side, and how far apart they are."""
    found: dict[tuple[int, int], float] = {}
    rows = observed.places.tolist()
    known = [i for i in np.flatnonzero(placed).tolist() if not math.isnan(rows[i][0])]
    for k, i in enumerate(known):
        x, y, z = rows[i]
        for j in known[:k]:
            dx, dy, dz = x - rows[j][0], y - rows[j][1], z - rows[j][2]
            if -REACH_M <= dx <= REACH_M and -REACH_M <= dy <= REACH_M:
                apart_m = math.sqrt(dx * dx + dy * dy + dz * dz)
                if apart_m <= REACH_M:
                    found[j, i] = apart_m
    return found


def _indices(numbers: list[int]) -> NDArray[np.intp]:
    return np.array(numbers, dtype=np.intp)


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

    def _scale(self, pose: Pose | None) -> float:
        """Return the correction of a frame's noise by how far positions scatter in truth.

        Learned from things that were recognised, so that precise positions separate neighbours.
        Without a pose a position and its covariance are the recording's own, and believed.
        """
        if pose is None:
            return 1.0
        learned = float(self.residuals[0] / self.residuals[1])
        return max(self._parameters.noise_least, learned)

    def match(self, observed: Observed, time_ms: int, pose: Pose | None) -> list[Match]:
        """Return for each observed thing what it is; updates the frame's offset."""
        self.offset.predict(time_ms, pose)
        if not observed.things:
            return []
        frame = self._frame(observed, pose)
        self.space.add(observed.looks)
        rows, owners = self._gate(frame)
        things = self._candidates(observed, owners)
        if not things:
            return [None] * len(observed.things)
        for thing in things:
            thing.compared_ms = time_ms
        scoring = self._scoring(frame, things)
        gated = self._gated(things, rows, owners)
        place, at = self._place(frame, gated)
        score = scoring.total(place)
        new = self._parameters.new_thing_odds
        taken = likelihood.assign(score, new)
        if self._align(frame, things, taken, at):
            place, at = self._place(frame, gated)
            score = scoring.total(place)
            taken = likelihood.assign(score, new)
        if scoring.likeness is not None:
            self._learn(frame, things, taken, scoring.likeness, scoring.without_look(place))
        return [
            None if column < 0 else (things[column], self._at(int(at[i, column])))
            for i, column in enumerate(taken)
        ]

    def _at(self, row: int) -> Place | None:
        return self._memory.positions.owners[row][1] if row >= 0 else None

    def _frame(self, observed: Observed, pose: Pose | None) -> Frame:
        """Return the frame's own share, and learn how near to each other its things stand."""
        noise = observed.noise.reshape(-1, 9).T[UPPER] * self._scale(pose)
        sigma = np.sqrt((noise[0] + noise[3] + noise[5]) / 3)
        placed = sigma <= REACH_M / 2
        apart = _beside(observed, placed)
        names = [thing.detection.category for thing in observed.things]
        self.neighbours.add(
            len(names), [apart_m for (i, j), apart_m in apart.items() if names[i] != names[j]]
        )
        near = frozenset([*apart, *((j, i) for i, j in apart)])
        shells_m3 = self.neighbours.shells_m3()
        return Frame(observed, observed.places.T, noise, placed, near, shells_m3)

    def _gate(self, frame: Frame) -> tuple[NDArray[np.intp], list[int]]:
        """Return the rows of places that any detection may be at, and numbers of their things.

        By thing and place.
        """
        positions = self._memory.positions
        noise = frame.noise[VARIANCES] + self.offset.covariance.diagonal()[:, None]
        places = frame.places - self.offset.mean[:, None]
        away = places[:, :, None] - positions.columns[:3, None]
        # Along each axis alone: no pair within the gate is outside of this, and it is quick.
        reach = noise[:, :, None] + positions.variance[:, None]
        reach *= self._parameters.gate_sigmas**2
        away *= away
        near = np.logical_and.reduce(away <= reach, axis=0)
        return positions.sorted_rows(np.logical_or.reduce(near, axis=0))

    def _candidates(self, observed: Observed, owners: list[int]) -> list[Known]:
        """Return the things to compare with, by number.

        What has no position is near everything, and to a detection without one all are.
        """
        known = self._memory.things
        if observed.nowhere.any():
            return [known[number] for number in sorted(known)]
        placeless = self._memory.placeless()
        if not placeless:
            return [known[number] for number in dict.fromkeys(owners)]
        return [known[number] for number in sorted({*owners, *(t.number for t in placeless)})]

    def _scoring(self, frame: Frame, things: list[Known]) -> Scoring:
        """Return the evidence of category and look; of a thing named twice one name may agree."""
        observed = frame.observed
        names = [name for thing in observed.things for name in thing.votes]
        agreed, differing = self._categories.evidence(names, [thing.shares for thing in things])
        if len(names) > len(observed.things):
            starts = np.cumsum([0, *(len(thing.votes) for thing in observed.things)])[:-1]
            agreed = np.maximum.reduceat(agreed, starts, axis=0)
            differing = np.maximum.reduceat(differing, starts, axis=0)
        looks = self._memory.looks
        if observed.looks.shape[1] == 0 or looks.length == 0:
            return Scoring(agreed, differing)
        views = np.array([thing.look_weight for thing in things])
        known = observed.pictured[:, None] & (views > 0)
        is_known = known.all()
        likeness = looks.likeness(observed.looks, things, self.space)
        same, beside = self.looks.against(likeness, views, (OTHER, BESIDE))
        if not is_known:
            likeness[~known] = np.nan
            same[~known] = beside[~known] = 0.0
        if self.one and any(told := [thing.object_id in self.one for thing in things]):
            same = np.where(told, np.maximum(same, 0.0), same)  # no look of its own to differ from
        if not frame.placed.all():
            beside = np.where(frame.placed[:, None], beside, same)
        return Scoring(agreed, differing, same, beside, likeness)

    def _gated(self, things: list[Known], rows: NDArray[np.intp], owners: list[int]) -> Gated:
        """Return where the rows of places, with the numbers of their things, are in the table."""
        number = {thing.number: column for column, thing in enumerate(things)}
        first: list[int] = []
        target: list[int] = []
        further: list[tuple[list[int], list[int]]] = []
        last, turn = -1, 0
        for k, owner in enumerate(owners):  # they are by thing
            column = number[owner]
            if column != last:
                first.append(k)
                target.append(column)
                last, turn = column, 0
                continue
            if turn == len(further):
                further.append(([], []))
            further[turn][0].append(k)
            further[turn][1].append(column)
            turn += 1
        placeless: list[int] = []
        if len(first) < len(things):
            placeless = [j for j, t in enumerate(things) if all(p.row < 0 for p in t.places)]
        columns = self._memory.positions.columns[:, rows]
        turns = [(_indices(places), _indices(of)) for places, of in ((first, target), *further)]
        return Gated(rows, columns, *turns[0], turns[1:], placeless, len(things))

    def _place(self, frame: Frame, gated: Gated) -> tuple[Floats, NDArray[np.intp]]:
        """Return the evidence of place, (2, n, m), and the row of the place it is of.

        First against another thing anywhere, then against one that stands beside. Row -1: none.
        """
        shape = (frame.places.shape[1], gated.things)
        at = np.full(shape, -1, dtype=np.intp)
        rows = gated.rows
        if len(rows) == gated.things == len(gated.first):
            place = self._place_ratios(frame, gated.columns)
            at[:] = rows
        else:
            place = np.full((2, *shape), NEVER)
            if len(rows):
                ratios = self._place_ratios(frame, gated.columns)
                place[:, :, gated.target] = ratios[:, :, gated.first]
                at[:, gated.target] = rows[gated.first]
            for places, columns in gated.further:  # of things that moved
                found, old = ratios[:, :, places], place[:, :, columns]
                better = found[0] > old[0]
                place[:, :, columns] = np.where(better, found, old)
                at[:, columns] = np.where(better, rows[places], at[:, columns])
        nowhere = frame.observed.nowhere
        if nowhere.any():
            place[:, nowhere] = 0.0
            at[nowhere] = -1
        if gated.placeless:
            place[:, :, gated.placeless] = 0.0
        return place, at

    def _learn(
        self,
        frame: Frame,
        things: list[Known],
        taken: list[int],
        likeness: Floats,
        evidence: Floats,
    ) -> None:
        """Teach the look model by what place and category (`evidence`) decided without it."""
        least = self._parameters.plain_odds
        speaks = evidence >= 0
        mine, its = np.add.reduce(speaks, axis=1).tolist(), np.add.reduce(speaks, axis=0)
        at = [max(column, 0) for column in taken]
        rivals, alike, decided = (
            its[at].tolist(),
            likeness[:, at].tolist(),
            evidence[:, at].tolist(),
        )
        for i, column in enumerate(taken):
            if column < 0 or things[column].seen < self._parameters.confirm_sightings:
                continue
            thing = things[column]
            for j, other in enumerate(taken):  # the frame's other detections are other things
                if j == i or math.isnan(alike[j][i]):
                    continue
                if other >= 0 and things[other].category == thing.category:
                    self.looks.add(OTHER, alike[j][i], thing.look_weight)
                elif (i, j) in frame.near:
                    self.looks.add(BESIDE, alike[j][i], thing.look_weight)
            # itself speaks for it in its row and in its column
            is_plain = decided[i][i] >= least and mine[i] == rivals[i] == 1
            if is_plain and not math.isnan(alike[i][i]):
                self.looks.add(SAME, alike[i][i], thing.look_weight)
                mean = self._memory.looks.row(thing)
                self.space.add_same(frame.observed.looks[i], mean, thing.look_weight)

    def _place_ratios(self, frame: Frame, columns: Floats) -> Floats:
        """Return the evidence of place (2, n, k) as `_place` does, NEVER out of the gate."""
        offset, parameters = self.offset, self._parameters
        count = frame.places.shape[1]
        noise = frame.noise + offset.covariance.reshape(9)[UPPER][:, None]
        places = frame.places - offset.mean[:, None]
        residuals = (places[:, :, None] - columns[:3, None]).reshape(3, -1)
        covariances = (noise[:, :, None] + columns[3:, None]).reshape(6, -1)
        squared, determinant = likelihood.squared_distances(residuals, covariances)
        residuals *= residuals
        beside = self.neighbours.space_m3(np.add.reduce(residuals, axis=0), frame.shells_m3)
        ratios = likelihood.position_ratios(
            squared, determinant, (parameters.space_m3, beside), parameters
        )
        np.copyto(ratios, NEVER, where=~(squared <= parameters.gate_sigmas**2))
        return ratios.reshape(2, count, -1)

    def _align(
        self, frame: Frame, things: list[Known], taken: list[int], at: NDArray[np.intp]
    ) -> bool:
        """Correct the frame's offset by what was recognised; say whether there was anything.

        Only what was seen before in another frame tells: a tentative thing may be a mistake.
        """
        if not self.offset.covariance.any():
            return False
        pairs = [
            (i, row)
            for i, column in enumerate(taken)
            if column >= 0
            and things[column].seen >= self._parameters.confirm_sightings
            and (row := int(at[i, column])) >= 0
        ]
        if not pairs:
            return False
        seen, rows = (list(each) for each in zip(*pairs, strict=True))
        columns = self._memory.positions.columns[:, rows]
        residuals, noise = frame.places[:, seen] - columns[:3], frame.noise[:, seen] + columns[3:]
        self.offset.correct(zip(residuals.T.tolist(), noise.T.tolist(), strict=True))
        return True

    def update(self, observed: Observed, pairs: list[tuple[int, Place]], pose: Pose | None) -> None:
        """Move the matched places towards what was observed: Kalman, robust."""
        if not pairs:
            return
        positions = self._memory.positions
        scale, mean = self._scale(pose), self.offset.mean.tolist()
        shared = of_rows(self.offset.covariance.ravel().tolist())
        nine, places = observed.noise.reshape(-1, 9).tolist(), observed.places.tolist()
        summed, count = self.residuals.tolist()
        for i, place in pairs:
            noise = [n * scale + o for n, o in zip(of_rows(nine[i]), shared, strict=True)]
            squared = positions.pull(place.row, places[i], mean, noise, self._parameters)
            if pose is not None and squared <= self._parameters.noise_gate:
                summed, count = summed + squared / 3, count + 1.0
        self.residuals = np.array([summed, count])
