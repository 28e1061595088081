"""Default profile: negative evidence ("I looked there again, and it was gone").

A look is a view of `coverage`: all frames from nearly one viewpoint count once, because what hides
a thing in one of them hides it in the next. In a look a place is found, or hidden by something
nearer, or seen through (depth shows only what is behind it), or missed. A miss tells something
where the thing was seen before from that same side; how much, is learned from how often things are
found again. Looks are judged a handful at a time, each by itself and in their order: to tell what
they showed of all places costs as much for one as for four.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from d3a.checkpoint import Arrays
from d3a.geometry import axes
from d3a.model import Json, Position
from d3a.parameters import Parameters
from d3a.sightings import Scene
from d3a.symmetric import trace
from d3a.tracking.arrivals import Looked
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.glimpses import Glimpses
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.sides import (
    are_familiar,
    chance_from,
    left_before,
    looks_near,
    remember_look,
    remember_side,
    share_of_look,
)

SURE_SEEN = 4
"""Views from which a thing counts as one of its own. Fewer may be strays of a neighbour, off by one
bad localisation: that they are not seen again says nothing of where a thing went."""
GONE_MOST = 5.0
"""Log-odds that looks in vain count for at most, where it is asked what else is somewhere."""
THROUGH_PRIOR = 6.0
THROUGH_PRESENT, THROUGH_GONE = 0.08, 0.5
"""How often a place is seen through while its thing is there (poses and shapes err), and when it
is not (clutter, a patch as wide as the error), before any was looked at; worth so many looks."""
THROUGH_LEAST, THROUGH_MOST = 0.3, 2.5
"""Bounds of the log-odds of one look that saw through a place."""
TOGETHER_MOST, TOGETHER_MS = 4, 30_000
"""So many looks are judged together at most, and those that ended so long ago. What they missed
should be known while the robot is about: what is found there next is judged by it. Twice as many
are a twentieth quicker, and tell of one place in ten less that it was left."""


Miss = tuple[tuple[Known, Place], bool, bool, Position, tuple[float, float]]
"""What a look told of a thing that it did not find at a place: whether it was in plain view in a
frame, whether most such frames show what is behind it, from where it was last in plain view, and
how many looks from near there were taken before, and found it."""


@dataclass(slots=True)
class Look:
    """What a look has found at which places, and from where last; end_ms: of its last frame."""

    found: dict[Place, tuple[Known, Position | None]] = field(default_factory=dict)
    end_ms: int = 0


@dataclass(frozen=True, slots=True)
class Judged:
    """The things that a look missed, and those that it found, by number each.

    unseen: what it had in plain view from whatever side, and did not find.
    """

    missed: list[Known]
    found: list[Known]
    unseen: list[Known]


class Absence:
    """Collects what each look shows of the known places, and judges when the look ends."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters
        self._looks = [Look()]
        """The last of them goes on, the others wait to be judged."""
        self._glimpses = Glimpses(memory.positions, parameters)
        self._remembered: list[tuple[Place, int]] = []
        """What became of looks at places, and of their tables not yet."""
        self._refound, self._relooked = 0, 0.0
        self._present = [THROUGH_PRIOR * THROUGH_PRESENT, THROUGH_PRIOR]
        self._gone = [THROUGH_PRIOR * THROUGH_GONE, THROUGH_PRIOR]
        """How often places were seen through whose things are there, and are not, and of how many
        looks."""
        self.looked = Looked(parameters)

    def watch(self, scene: Scene, found: list[tuple[Known, Place]], offset: FrameOffset) -> None:
        """Take in a frame: which places it should have shown, and which it did.

        offset: how far the frame's pose is off the map of things.
        """
        look = self._looks[-1]
        look.end_ms = scene.ref.time_ms
        if scene.pose is None or scene.camera is None:
            for thing, place in found:
                look.found[place] = thing, None
            return
        (x, y, z), (off_x, off_y, off_z) = scene.pose.position, offset.mean
        eye = x - off_x, y - off_y, z - off_z
        turn = axes(scene.pose)
        self.looked.watch(scene, eye, turn)
        for thing, place in found:
            look.found[place] = thing, eye
            if remember_side(place, eye) and place.row >= 0:
                self._memory.positions.put_sides(place)
        self._glimpses.add(scene, eye, turn, trace(offset.covariance))

    def end_look(self) -> None:
        """Let the next frame begin a look; the one that ended waits to be judged."""
        self._looks.append(Look())
        self._glimpses.end_look()
        self.looked.end_look()

    def is_due(self, now_ms: int) -> bool:
        """Say whether looks have waited long enough to be judged."""
        waiting = len(self._looks) - 1
        is_old = waiting > 0 and now_ms - self._looks[0].end_ms > TOGETHER_MS
        return is_old or waiting >= TOGETHER_MOST

    def judge(self) -> list[Judged]:
        """Judge the looks that ended, and say what each missed and found.

        Updates evidence, chances and `last_absent_ms` of every place that was in view.
        """
        looks, self._looks = self._looks[:-1], self._looks[-1:]
        judged = []
        for look, (misses, unseen) in zip(looks, self._misses(looks), strict=True):
            for miss in misses:
                self._miss(look, miss)
            for place, (thing, eye) in look.found.items():
                self._is_there(thing, place, eye)
            found = {thing.number: thing for thing, _ in look.found.values()}
            missed = [thing for (thing, _), *_ in misses]
            judged.append(Judged(missed, [found[n] for n in sorted(found)], unseen))
        self._memory.positions.put_some_looks(self._remembered)
        self._remembered.clear()
        return judged

    def _misses(self, looks: list[Look]) -> list[tuple[list[Miss], list[Known]]]:
        """Return what each look told of what it should have shown, and did not, by thing and place.

        It saw through it, or had it in plain view from a side that has shown it before. And all
        that it had in plain view from whatever side, and did not find.
        """
        misses: list[tuple[list[Miss], list[Known]]] = [([], []) for _ in looks]
        of, rows, shown = self._glimpses.take()
        if len(rows) == 0:
            return misses
        frames, hidden, through = shown.counts
        positions, is_through = self._memory.positions, 2 * through > frames - hidden
        owners = [positions.owners[row] for row in rows.tolist()]
        by_look, plain, behind = of.tolist(), (frames > hidden).tolist(), is_through.tolist()
        asked = self._not_found([looks[k] for k in by_look], owners, plain, behind)
        for k in asked:
            if plain[k]:
                misses[by_look[k]][1].append(owners[k][0])
        rows, last = rows[asked], shown.last[:, asked]
        tells = is_through[asked] | are_familiar(positions.sides(rows), last)
        rows, last = rows[tells], last[:, tells]
        near: list[list[float]] = looks_near(positions.looks(rows), last).T.tolist()
        for k, (x, y, z), (before, those) in zip(
            np.array(asked, dtype=np.intp)[tells].tolist(), last[:3].T.tolist(), near, strict=True
        ):
            miss = owners[k], plain[k], behind[k], (x, y, z), (before, those)
            misses[by_look[k]][0].append(miss)
        return misses

    def _not_found(
        self,
        looks: list[Look],
        owners: list[tuple[Known, Place]],
        plain: list[bool],
        behind: list[bool],
    ) -> list[int]:
        """Return which of the places that looks had in view these did not find; count the others.

        What turned up after a look it could not find.
        """
        asked = []
        for k, (look, (thing, place)) in enumerate(zip(looks, owners, strict=True)):
            if place not in look.found:
                if place.first_ms <= look.end_ms:
                    asked.append(k)
            elif plain[k] and thing.seen > self._parameters.confirm_sightings:
                self._refound += 1
                self._relooked += 1
                self._present[0] += behind[k]
                self._present[1] += 1.0
        return asked

    def _remember(self, place: Place, eye: Position, share: float, found: bool) -> None:
        """Keep whether a look from somewhere found a thing."""
        at = remember_look(place, eye, share, found)
        if place.row >= 0:
            self._remembered.append((place, at))

    def _usual(self) -> float:
        """Return how likely a look finds a thing that is there, by all things."""
        return (self._refound + 2 * self._parameters.detect_chance) / (self._relooked + 2)

    def came(self, place: Place) -> float:
        """Return the log-odds that what is at a place was brought while the robot was about."""
        if place.row < 0:
            return 0.0
        return self.looked.came(
            place, np.array(self._memory.positions.of(place).mean), self._usual()
        )

    def _through_odds(self) -> float:
        """Return how much likelier a place is seen through when its thing has left."""
        (there, of), (gone, among) = self._present, self._gone
        odds = math.log(gone / among) - math.log(there / of)
        return min(THROUGH_MOST, max(THROUGH_LEAST, odds))

    def _is_there(self, thing: Known, place: Place, eye: Position | None) -> None:
        """Note that a look found a thing at its place: all looks in vain before tell nothing."""
        self._present[0] += place.throughs
        if eye is not None and place.hits:  # see `chance` for the first
            self._remember(place, eye, 1.0, found=True)
        place.hits += 1
        place.chances += 1
        place.misses = place.throughs = 0
        place.missed_from = []
        place.evidence = 0.0
        self._expect(place, 0.0)
        if place.last_absent_ms is not None:
            place.last_absent_ms, thing.dirty = None, True

    def _miss(self, look: Look, miss: Miss) -> None:
        """Count a miss for as much as it tells; enough of them say that the place is empty.

        Where that is known already (its thing was moved, see `moves`), each says that it still is.
        """
        (thing, place), is_plain, is_through, eye, near = miss
        share, was_empty = 1.0, place.last_absent_ms is not None
        if is_through:
            told = self._through_odds()
        else:
            told = -math.log(1 - chance_from(place, *near, self._usual()))
        if is_plain:
            share, place.missed_from = share_of_look(place.missed_from, eye, look.end_ms)
            self._remember(place, eye, share, found=False)
        if not was_empty and thing.seen > self._parameters.confirm_sightings:
            self._relooked += share
        elif was_empty and is_plain:
            self._gone[0] += is_through
            self._gone[1] += 1.0
        place.evidence += share * told
        place.chances += share
        place.misses += 1
        place.throughs += is_through
        gone = place.evidence + left_before(thing, place, look.end_ms)
        self._expect(place, -math.log1p(math.exp(min(gone, GONE_MOST))))
        is_gone = thing.seen >= SURE_SEEN and gone >= self._parameters.absent_odds
        if was_empty or is_gone:
            place.last_absent_ms = look.end_ms
            thing.dirty = True

    def _expect(self, place: Place, there: float) -> None:
        """Note how likely a place's thing is found there by the next frames."""
        place.there = there
        if place.row >= 0:
            self._memory.positions.put_there(place)

    def forget(self, things: Iterable[Known]) -> None:
        """Forget what the looks showed of things that leave the memory."""
        for thing in things:
            for look in self._looks:
                for place in thing.places:
                    look.found.pop(place, None)
            self._glimpses.forget(thing.number)

    def became(self, lost: Place, place: Place, thing: Known) -> None:
        """Note that what the look that goes on has found at a place is at a thing's place now."""
        found = self._looks[-1].found
        if lost in found:
            _, eye = found.pop(lost)
            found[place] = thing, eye

    def to_state(self) -> tuple[Json, Arrays]:
        """Return the looks that are not judged yet as JSON, and their frames."""
        camera, arrays = self._glimpses.to_state()
        record: Json = {
            "looks": [
                [look.end_ms, [[t.number, p.number, eye] for p, (t, eye) in look.found.items()]]
                for look in self._looks
            ],
            "camera": camera,
            "again": [self._refound, self._relooked],
            "through": [self._present, self._gone],
            "looking": self.looked.is_open,
        }
        return record, arrays | {"looked": self.looked.rows}

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called; the memory is restored already."""
        self.looked.restore(arrays["looked"], record["looking"])
        self._refound, self._relooked = record["again"]
        self._present, self._gone = ([float(n) for n in each] for each in record["through"])
        if "waiting" not in arrays:  # an older checkpoint: what it tells of its last look is lost
            return
        self._glimpses.restore(record["camera"], arrays)
        # older checkpoints hold no look but the one that goes on
        looks = record["looks"] if "looks" in record else [(record["end_ms"], record["found"])]
        self._looks = [Look(self._found_of(found), end_ms) for end_ms, found in looks]

    def _found_of(self, found: list[list[Any]]) -> dict[Place, tuple[Known, Position | None]]:
        """Return what a look has found, from what `to_state` told of it."""
        things = ((self._memory.things[n], number, eye) for n, number, eye in found)
        return {
            thing.place(number): (thing, None if eye is None else tuple(eye))
            for thing, number, eye in things
        }
