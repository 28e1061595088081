"""Default profile, tier 2: which thing each detection of a frame is.

One-to-one by likelihood. The first assignment tells how far off the whole frame is: an error of the
localisation is common to all its detections, and drifts slowly. A second uses that, where the first
left anything open.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.checkpoint import Arrays
from d3a.model import Json, Pose
from d3a.parameters import Parameters
from d3a.symmetric import added, minus, scaled, trace
from d3a.tracking import likelihood
from d3a.tracking.compared import NEVER, Aim, Assigned, Frame, Gated, Scoring
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import BESIDE, OTHER, SAME, VARIANCES, CategoryModel, LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.neighbours import REACH_M, Neighbours, beside
from d3a.tracking.observed import Observed
from d3a.tracking.wrong_range import WrongRanges

Floats = NDArray[np.float64]
SETTLED = 3.0
"""Log-odds (20 to 1) of each detection's match against any other, from which it stands however far
off the frame is: of frames so sure a second assignment decides one in a thousand otherwise."""
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


class Matcher:
    """Scores a frame's detections against the memory and assigns them.

    is_histogram: whether looks are those of colour histograms, of which much is known before.
    """

    def __init__(
        self,
        memory: Memory,
        categories: CategoryModel,
        parameters: Parameters,
        is_histogram: bool,
    ) -> None:
        likelihood.load_solver()
        self._is_histogram = is_histogram
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
        self.residuals = parameters.noise_prior, parameters.noise_prior
        """Summed squared residuals by what was expected of them, and their number."""

    def _scale(self, pose: Pose | None) -> float:
        """Return the correction of a frame's noise by how far positions scatter in truth.

        Learned from things that were recognised, so that precise positions separate neighbours.
        Without a pose a position and its covariance are the recording's own, and believed.
        """
        if pose is None:
            return 1.0
        summed, count = self.residuals
        return max(self._parameters.noise_least, summed / count)

    def match(self, observed: Observed, time_ms: int, pose: Pose | None) -> list[Match | None]:
        """Return for each observed thing what it is, None for new; corrects the frame's offset."""
        frame = self._frame(observed, pose)
        self.space.add(observed.looks, observed.pictured)
        before = self.offset.copy()
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
            return Match(found.things[column], self._at(found.at[i]))
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
        self.offset = lost.copy()
        other = self._explained(frame, pose)
        jumped = other.worth(new) + self.offset.likely(lost) - JUMP_ODDS
        if other.is_known_place() and jumped > found.worth(new) + kept.likely(before):
            return other
        self.offset = kept
        return found

    def _explained(self, frame: Frame, pose: Pose | None) -> Assigned:
        """Return what a frame's things are, where the localisation is off as is known by now."""
        found = self._assigned(frame)
        new = [i for i, c in enumerate(found.taken) if c < 0 and frame.observed.spots[i]]
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
        return found._replace(misplaced=misplaced, strange=strange)

    def _assigned(self, frame: Frame) -> Assigned:
        """Return the likeliest assignment; corrects the frame's offset by it."""
        aim = frame.aim(self.offset)
        gated = self._gated(frame.observed, self._gate(aim))
        things = gated.things
        if not things:
            none = np.zeros((len(frame.observed.things), 0))
            taken = [-1] * len(none)
            return Assigned([], taken, taken, none, Scoring(none, none), none, {}, 0)
        scoring = self._scoring(frame, things)
        ratios = self._place_ratios(frame, aim, gated)
        place = gated.by_thing(ratios)
        score = scoring.total(place)
        new = self._parameters.new_thing_odds
        taken = likelihood.assign(score, new)
        is_corrected = self._align(frame, things, taken, gated.at(ratios[0], taken))
        if is_corrected and not likelihood.is_settled(score, taken, new, SETTLED):
            ratios = self._place_ratios(frame, frame.aim(self.offset), gated)
            place = gated.by_thing(ratios)
            score = scoring.total(place)
            taken = likelihood.assign(score, new)
        at = gated.at(ratios[0], taken)
        return Assigned(things, taken, at, place, scoring, score, {}, 0)

    def _at(self, row: int) -> Place | None:
        return self._memory.positions.owners[row][1] if row >= 0 else None

    def _frame(self, observed: Observed, pose: Pose | None) -> Frame:
        """Return the frame's own share, and learn how near to each other its things stand."""
        scale = self._scale(pose)
        most_m2 = 3 * (REACH_M / 2) ** 2 / scale
        placed = [trace(error) <= most_m2 for error in observed.errors]
        apart = beside(observed.spots, placed)
        names = [thing.detection.category for thing in observed.things]
        self.neighbours.add(
            len(names), [apart_m for (i, j), apart_m in apart.items() if names[i] != names[j]]
        )
        near = frozenset([*apart, *((j, i) for i, j in apart)])
        return Frame(observed, scale, placed, near, self.neighbours.shells_m3())

    def _gate(self, aim: Aim) -> NDArray[np.intp]:
        """Return the rows of places that any detection may be at, by thing and place."""
        positions = self._memory.positions
        places, noise = aim
        away = places[:, :, None] - positions.columns[:3, None]
        # Along each axis alone: no pair within the gate is outside of this, and it is quick.
        reach = noise[VARIANCES][:, :, None] + positions.variance[:, None]
        reach *= self._parameters.gate_sigmas**2
        away *= away
        near = np.logical_and.reduce(away <= reach, axis=0)
        return positions.in_order(np.logical_or.reduce(near, axis=0))

    def _gated(self, observed: Observed, rows: NDArray[np.intp]) -> Gated:
        """Return what to compare with: the things at some rows of places, by number.

        What has no position is near everything, and to a detection without one all are.
        """
        positions, known = self._memory.positions, self._memory.things
        at, owners = rows.tolist(), positions.owners
        spans: dict[int, tuple[int, int]] = {}
        last, start = None, 0
        for k, row in enumerate(at):  # they are by thing
            number = owners[row][0].number
            if number != last:
                last, start = number, k
            spans[number] = start, k + 1
        numbers, placeless, nowhere = list(spans), self._memory.placeless(), observed.nowhere
        if nowhere:
            numbers = sorted(known)
        elif placeless:
            numbers = sorted({*numbers, *(thing.number for thing in placeless)})
        things = [known[number] for number in numbers]
        unplaced = [k for k, thing in enumerate(things) if thing in placeless] if placeless else []
        of = [spans.get(number, (0, 0)) for number in numbers]
        columns, there = positions.columns[:, rows], positions.there[rows]
        return Gated(things, at, columns, there, of, unplaced, nowhere)

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
        weights = [thing.look_weight for thing in things]
        are_known = all(observed.pictured) and all(weights)
        likeness = looks.likeness(observed.looks, things, self.space, are_known)
        views = np.array(weights)
        same, beside = self.looks.against(likeness, views, (OTHER, BESIDE))
        if not are_known:
            unknown = ~(np.array(observed.pictured)[:, None] & (views > 0))
            likeness[unknown] = np.nan
            same[unknown] = beside[unknown] = 0.0
        if self.one and any(told := [thing.object_id in self.one for thing in things]):
            same = np.where(told, np.maximum(same, 0.0), same)  # no look of its own to differ from
        if not all(frame.placed):
            beside = np.where(np.array(frame.placed)[:, None], beside, same)
        return Scoring(agreed, differing, same, beside, likeness)

    def _learn(
        self,
        frame: Frame,
        things: list[Known],
        taken: list[int],
        likeness: Floats,
        evidence: Floats,
    ) -> None:
        """Teach the look model by what place and category (`evidence`) say without it."""
        alike = likeness.tolist()
        for i, column in enumerate(taken):
            if column < 0 or not self._teaches(things[column]):
                continue
            thing = things[column]
            for j, other in enumerate(taken):  # the frame's other detections are other things
                if j == i or math.isnan(alike[j][column]):
                    continue
                if other >= 0 and things[other].category == thing.category:
                    self.looks.add(OTHER, alike[j][column], thing.look_weight)
                elif (i, j) in frame.near:
                    self.looks.add(BESIDE, alike[j][column], thing.look_weight)
        for i, column in self._plain(things, taken, evidence):
            if not math.isnan(alike[i][column]):
                thing = things[column]
                self.looks.add(SAME, alike[i][column], thing.look_weight)
                mean = self._memory.looks.row(thing)
                self.space.add_same(frame.observed.looks[i], mean, thing.look_weight)

    def _plain(
        self, things: list[Known], taken: list[int], evidence: Floats
    ) -> list[tuple[int, int]]:
        """Return which detection is plainly which thing, by place and category alone.

        What is assumed of histograms holds of any well enough that a look may object: of what is
        plain, one pair in thirty is of two things. Of another embedding nothing is known. Taught
        by what it agreed to itself, the model would never learn that views of one thing are less
        alike than it assumed: there the look is not asked, and more has to be plain.
        """
        parameters = self._parameters
        speaks = evidence >= 0
        alone = np.add.reduce(speaks, axis=0) == 1
        if self._is_histogram:  # itself speaks for it in its row and in its column
            only = np.logical_and.outer(np.add.reduce(speaks, axis=1) == 1, alone)
            rows, columns = np.nonzero(only & (evidence >= parameters.plain_odds))
            pairs = zip(rows.tolist(), columns.tolist(), strict=True)
            return [(i, c) for i, c in pairs if taken[i] == c and self._teaches(things[c])]
        # what was seen once may be one of the views of this thing that were not recognised
        speaks &= [thing.seen >= parameters.confirm_sightings for thing in things]
        rivals = np.add.reduce(speaks, axis=1).tolist()
        best = evidence.argmax(axis=1).tolist()
        return [
            (i, c)
            for i, c in enumerate(best)
            if evidence[i, c] >= parameters.sure_odds and alone[c] and rivals[i] == speaks[i, c]
        ]

    def _teaches(self, thing: Known) -> bool:
        """Say whether the look model may learn of a thing: it is none by mistake, or all count."""
        return not self._is_histogram or thing.seen >= self._parameters.confirm_sightings

    def _place_ratios(self, frame: Frame, aim: Aim, gated: Gated) -> Floats:
        """Return the evidence of place (2, n, k), with rows of places; NEVER out of the gate.

        First against another thing anywhere, then against one that stands beside. What looks in
        vain have shown to be gone is least likely what is at its place.
        """
        parameters, (places, noise), columns = self._parameters, aim, gated.columns
        residuals = (places[:, :, None] - columns[:3, None]).reshape(3, -1)
        covariances = (noise[:, :, None] + columns[3:, None]).reshape(6, -1)
        squared, determinant = likelihood.squared_distances(residuals, covariances)
        residuals *= residuals
        beside = self.neighbours.space_m3(np.add.reduce(residuals, axis=0), frame.shells_m3)
        ratios = likelihood.position_ratios(
            squared, determinant, (parameters.space_m3, beside), parameters
        )
        np.copyto(ratios, NEVER, where=~(squared <= parameters.gate_sigmas**2))
        return ratios.reshape(2, len(frame.placed), -1) + gated.there

    def _align(self, frame: Frame, things: list[Known], taken: list[int], at: list[int]) -> bool:
        """Correct the frame's offset by what was recognised; say whether there was anything.

        Only what was seen before in another frame tells: a tentative thing may be a mistake.
        """
        if not any(self.offset.covariance):
            return False
        pairs = [
            (i, row)
            for i, column in enumerate(taken)
            if column >= 0
            and things[column].seen >= self._parameters.confirm_sightings
            and (row := at[i]) >= 0
        ]
        if not pairs:
            return False
        positions, observed, scale = self._memory.positions, frame.observed, frame.scale
        known = []
        for i, row in pairs:
            spot, its = observed.spots[i], positions.of(positions.owners[row][1])
            if spot is not None:
                noise = added(scaled(observed.errors[i], scale), its.spread)
                known.append((minus(spot, its.mean), noise))
        self.offset.correct(known)
        return True

    def update(self, observed: Observed, pairs: list[tuple[int, Place]], pose: Pose | None) -> None:
        """Move the matched places towards what was observed: Kalman, robust."""
        if not pairs:
            return
        positions, (summed, count) = self._memory.positions, self.residuals
        scale, mean, shared = self._scale(pose), self.offset.mean, self.offset.covariance
        for i, place in pairs:
            spot, noise = observed.spots[i], added(observed.error_again(i, pose, scale), shared)
            if spot is None:
                continue
            squared = positions.pull(place, spot, mean, noise, self._parameters)
            if pose is not None and squared <= self._parameters.noise_gate:
                summed, count = summed + squared / 3, count + 1.0
        self.residuals = summed, count

    def to_state(self) -> tuple[Json, Arrays]:
        """Return all that was learned, and how far off the latest frame was."""
        arrays: Arrays = {
            "look_model": self.looks.sums,
            "look_space": self.space.sums,
            "look_counts": self.space.counts,
            "look_scale": self.space.scale,
            "residuals": np.array(self.residuals),
            "neighbours": np.array(self.neighbours.pairs),
            "looked_around": np.array([self.neighbours.seen]),
        }
        return {"scaled_at": self.space.scaled_at, "offset": self.offset.to_state()}, arrays

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        self.looks.sums = np.array(arrays["look_model"])
        self.space.sums = np.array(arrays["look_space"])
        self.space.counts = np.array(arrays["look_counts"])
        self.space.scale = np.array(arrays["look_scale"])
        self.space.scaled_at = record["scaled_at"]
        summed, number = arrays["residuals"].tolist()
        self.residuals = summed, number
        self.neighbours.pairs = arrays["neighbours"].tolist()
        self.neighbours.seen = float(arrays["looked_around"][0])
        self.offset.restore(record["offset"])
