"""Default profile: negative evidence ("I looked there again, and it was gone").

A look is a view of `coverage`: all frames from nearly one viewpoint count once, because what hides
a thing in one of them hides it in the next. In a look a place is found, or hidden by something
nearer, or seen through (depth shows only what is behind it), or missed. A miss tells something
where the thing was seen before from that same side; how much, is learned from how often things are
found again.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

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


Glance = tuple[tuple[Known, Place], bool, bool, Position, tuple[float, float]]
"""What a look told of a thing at a place: whether it was in plain view in a frame, whether most
such frames show what is behind it, from where it was last in plain view, and how many looks from
near there were taken before, and found it."""


class Absence:
    """Collects what each look shows of the known places, and judges when the look ends."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters
        self._found: dict[Place, tuple[Known, Position | None]] = {}
        """What the current look has found at which places, and from where."""
        self._glimpses = Glimpses(memory.positions, parameters)
        self._end_ms = 0
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
        self._end_ms = scene.ref.time_ms
        if scene.pose is None or scene.camera is None:
            for thing, place in found:
                self._found[place] = thing, None
            return
        (x, y, z), (off_x, off_y, off_z) = scene.pose.position, offset.mean
        eye = x - off_x, y - off_y, z - off_z
        turn = axes(scene.pose)
        self.looked.watch(scene, eye, turn)
        for thing, place in found:
            self._found[place] = thing, eye
            if remember_side(place, eye) and place.row >= 0:
                self._memory.positions.put_sides(place)
        self._glimpses.add(scene, eye, turn, trace(offset.covariance))

    def found(self) -> list[Known]:
        """Return the things that the current look has found, by number."""
        found = {thing.number: thing for thing, _ in self._found.values()}
        return [found[number] for number in sorted(found)]

    def end_look(self) -> list[Known]:
        """Judge the look that ended; return the things that it missed.

        Updates evidence, chances and `last_absent_ms` of every place that was in view.
        """
        found, missed = self._found, []
        for (thing, place), is_plain, is_through, eye, near in self._told():
            if place not in found:
                missed.append(thing)
                share = 1.0
                if is_through:
                    odds = self._through_odds()
                else:
                    odds = -math.log(1 - chance_from(place, *near, self._usual()))
                if is_plain:
                    share, place.missed_from = share_of_look(place.missed_from, eye, self._end_ms)
                    self._remember(place, eye, share, found=False)
                self._missed(thing, place, share * odds, share, is_plain, is_through)
            elif is_plain and thing.seen > self._parameters.confirm_sightings:
                self._refound += 1
                self._relooked += 1
                self._present[0] += is_through
                self._present[1] += 1.0
        for place, (thing, seen_from) in found.items():
            self._is_there(thing, place, seen_from)
        found.clear()
        self.looked.end_look()
        return missed

    def _told(self) -> list[Glance]:
        """Return what the look told of the places that it had in view, by thing and place.

        Of those that it found, and of those that it should have shown: it saw through them, or had
        them in plain view from a side that has shown them before.
        """
        rows, shown = self._glimpses.take()
        if len(rows) == 0:
            return []
        frames, hidden, through = shown.counts
        is_plain, is_through = frames > hidden, 2 * through > frames - hidden
        positions, found = self._memory.positions, self._found
        tells = is_through | are_familiar(positions.sides(rows), shown.last)
        tells |= np.array([positions.owners[row][1] in found for row in rows.tolist()])
        at = tells.nonzero()[0]
        rows, last = rows[at], shown.last[:, at]
        near: list[list[float]] = looks_near(positions.looks(rows), last).T.tolist()
        parts = is_plain[at].tolist(), is_through[at].tolist(), last[:3].T.tolist()
        return [
            (positions.owners[row], plain, behind, (x, y, z), (looks, those))
            for row, plain, behind, (x, y, z), (looks, those) in zip(
                rows.tolist(), *parts, near, strict=True
            )
        ]

    def _remember(self, place: Place, eye: Position, share: float, found: bool) -> None:
        """Keep whether a look from somewhere found a thing."""
        at = remember_look(place, eye, share, found)
        if place.row >= 0:
            self._memory.positions.put_look(place, at)

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

    def _missed(
        self,
        thing: Known,
        place: Place,
        told: float,
        share: float,
        is_plain: bool,
        is_through: bool,
    ) -> None:
        """Count a share of a miss, that told so much; enough of them say that the place is empty.

        Where that is known already (its thing was moved, see `moves`), each says that it still is.
        """
        was_empty = place.last_absent_ms is not None
        if not was_empty and thing.seen > self._parameters.confirm_sightings:
            self._relooked += share
        elif was_empty and is_plain:
            self._gone[0] += is_through
            self._gone[1] += 1.0
        place.evidence += told
        place.chances += share
        place.misses += 1
        place.throughs += is_through
        gone = self._gone_odds(thing, place)
        self._expect(place, -math.log1p(math.exp(min(gone, GONE_MOST))))
        is_gone = thing.seen >= SURE_SEEN and gone >= self._parameters.absent_odds
        if was_empty or is_gone:
            place.last_absent_ms = self._end_ms
            thing.dirty = True

    def _gone_odds(self, thing: Known, place: Place) -> float:
        """Return the log-odds that a thing has left a place, by all looks in vain since."""
        return place.evidence + left_before(thing, place, self._end_ms)

    def _expect(self, place: Place, there: float) -> None:
        """Note how likely a place's thing is found there by the next frames."""
        place.there = there
        if place.row >= 0:
            self._memory.positions.put_there(place)

    def forget(self, things: Iterable[Known]) -> None:
        """Forget what the look showed of things that leave the memory."""
        for thing in things:
            for place in thing.places:
                self._found.pop(place, None)
            self._glimpses.forget(thing.number)

    def to_state(self) -> tuple[Json, Arrays]:
        """Return the look that is going on as JSON, and its frames."""
        camera, arrays = self._glimpses.to_state()
        record: Json = {
            "end_ms": self._end_ms,
            "found": [
                [thing.number, place.number, eye] for place, (thing, eye) in self._found.items()
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
        self._end_ms = record["end_ms"]
        self._refound, self._relooked = record["again"]
        self._present, self._gone = ([float(n) for n in each] for each in record["through"])
        if "waiting" not in arrays:  # an older checkpoint: what it tells of its last look is lost
            return
        self._glimpses.restore(record["camera"], arrays)
        for number, place_number, eye in record["found"]:
            thing = self._memory.things[number]
            self._found[thing.place(place_number)] = thing, None if eye is None else tuple(eye)
