"""Default profile, tier 2: which thing each detection of a frame is.

One-to-one by likelihood, twice: the first assignment tells how far off the whole frame is (a
localisation's error is common to all its detections, and drifts slowly), the second uses that.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a import likelihood
from d3a.compared import NEVER, Assigned, Frame, Gated, Scoring
from d3a.frame_offset import FrameOffset
from d3a.known import Known, Place
from d3a.likelihood import BESIDE, OTHER, SAME, UPPER, VARIANCES, CategoryModel, LookModel
from d3a.look_space import LookSpace
from d3a.memory import Memory
from d3a.model import Pose
from d3a.neighbours import REACH_M, Neighbours, beside
from d3a.observed import Observed
from d3a.parameters import Parameters
from d3a.symmetric import of_rows
from d3a.wrong_range import WrongRanges

Floats = NDArray[np.float64]
STRANGE_LEAST = 2
"""So many things of a frame that look like known ones elsewhere ask whether the robot is elsewhere:
one may have been moved."""
JUMP_ODDS = 5.0
"""Log-odds (150 to 1) that a frame's localisation did not jump, before it is looked at."""


class Match(NamedTuple):
    """The thing and the place of it that a detection is at; None: its only one, without position.

    in_range: False where the detection's own range, and so its position and size, is wrong.
    """

    thing: Known
    place: Place | None
    in_range: bool = True


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
        self._ranges = WrongRanges(memory, parameters)
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

    def match(self, observed: Observed, time_ms: int, pose: Pose | None) -> list[Match | None]:
        """Return for each observed thing what it is, None for new; updates the frame's offset."""
        self.offset.predict(time_ms, pose)
        if not observed.things:
            return []
        frame = self._frame(observed, pose)
        self.space.add(observed.looks)
        before = replace(self.offset)
        found = self._explained(frame, pose)
        if pose is not None and found.strange >= STRANGE_LEAST:
            found = self._elsewhere(frame, pose, found, before)
        for thing in found.things:
            thing.compared_ms = time_ms
        if found.scoring.likeness is not None:
            evidence = found.scoring.without_look(found.place)
            self._learn(frame, found.things, found.taken, found.scoring.likeness, evidence)
        for lost in found.misplaced.values():
            lost.thing.compared_ms = time_ms
            if not lost.by_view:
                self._ranges.loosen(lost.place)
        return [self._match(found, i) for i in range(len(found.taken))]

    def _match(self, found: Assigned, i: int) -> Match | None:
        column = found.taken[i]
        if column >= 0:
            return Match(found.things[column], self._at(int(found.at[i, column])))
        if (lost := found.misplaced.get(i)) is None:
            return None
        return Match(lost.thing, lost.place, not lost.by_view)

    def _elsewhere(
        self, frame: Frame, pose: Pose, found: Assigned, before: FrameOffset
    ) -> Assigned:
        """Ask whether the robot is elsewhere than it thinks: a localisation jumps at times.

        before: how far off it was, before the frame.
        """
        new, kept = self._parameters.new_thing_odds, self.offset
        lost = before.lost(pose)
        self.offset = replace(lost)
        other = self._explained(frame, pose)
        jumped = other.worth(new) + self.offset.likely(lost) - JUMP_ODDS
        if jumped > found.worth(new) + kept.likely(before):
            return other
        self.offset = kept
        return found

    def _explained(self, frame: Frame, pose: Pose | None) -> Assigned:
        """Return what a frame's things are, where the localisation is off as is known by now."""
        found = self._assigned(frame)
        new = [i for i, c in enumerate(found.taken) if c < 0 and not frame.observed.nowhere[i]]
        if pose is None or not new:
            return found
        taken = {found.things[c].number for c in found.taken if c >= 0}
        part = frame.part(new)
        things = self._ranges.alike(part.observed.things, taken)
        if not things:
            return found
        scoring = self._scoring(part, things)
        strange, misplaced = self._ranges.find(part, pose, self.offset, things, scoring)
        misplaced = {new[k]: each for k, each in misplaced.items()}
        return replace(found, misplaced=misplaced, strange=strange)

    def _assigned(self, frame: Frame) -> Assigned:
        """Return the likeliest assignment; corrects the frame's offset by it."""
        rows, owners = self._gate(frame)
        things = self._candidates(frame.observed, owners)
        if not things:
            none = np.zeros((len(frame.observed.things), 0))
            taken = [-1] * len(none)
            return Assigned([], taken, none.astype(np.intp), none, Scoring(none, none), none)
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
        return Assigned(things, taken, at, place, scoring, score)

    def _at(self, row: int) -> Place | None:
        return self._memory.positions.owners[row][1] if row >= 0 else None

    def _frame(self, observed: Observed, pose: Pose | None) -> Frame:
        """Return the frame's own share, and learn how near to each other its things stand."""
        noise = observed.noise.reshape(-1, 9).T[UPPER] * self._scale(pose)
        sigma = np.sqrt((noise[0] + noise[3] + noise[5]) / 3)
        placed = sigma <= REACH_M / 2
        apart = beside(observed.places, placed)
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
