"""Default profile: negative evidence ("I looked there again, and it was gone").

A look is a view of `coverage`: all frames from nearly one viewpoint count once, because what hides
a thing in one of them hides it in the next. In a look a place is found, or hidden by something
nearer, or seen through (depth shows only what is behind it), or missed. A miss tells something
where the thing was seen before from that same side; how much, is learned from how often things are
found again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.arrivals import Looked
from d3a.depths import NEAREST_SHARE, nearer, samples
from d3a.frame_offset import FrameOffset
from d3a.geometry import in_view, project
from d3a.known import Known, Place
from d3a.memory import Memory
from d3a.model import Json, Position
from d3a.parameters import Parameters
from d3a.sides import chance, is_familiar, remember_side, share_of_look
from d3a.sightings import Scene

Floats = NDArray[np.float64]
PATCH, PATCH_MOST = 3, 40
"""Half the side, in pixels, of the patch of depth that is looked at, at least and at most."""
SURE_M = 1.0
"""A place whose position may err by more than this (one sigma) cannot be looked at."""
SURE_SEEN = 4
"""Views from which a thing counts as one of its own. Fewer may be strays of a neighbour, off by one
bad localisation: that they are not seen again says nothing of where a thing went."""
THROUGH_PRIOR = 6.0
THROUGH_PRESENT, THROUGH_GONE = 0.08, 0.5
"""How often a place is seen through while its thing is there (poses and shapes err), and when it
is not (clutter, a patch as wide as the error), before any was looked at; worth so many looks."""
THROUGH_LEAST, THROUGH_MOST = 0.3, 2.5
"""Bounds of the log-odds of one look that saw through a place."""


@dataclass(slots=True)
class Glance:
    """What the current look showed of a place, in frames.

    frames: in view. hidden: behind something. through: only what is behind it was seen. familiar:
    whether it was in plain view from a side that has shown it before.
    """

    thing: Known
    place: Place
    frames: int = 0
    hidden: int = 0
    through: int = 0
    familiar: bool = False
    found: bool = False
    eye: Position | None = None

    def add(self, hidden: bool, through: bool) -> None:
        """Count a frame."""
        self.frames += 1
        self.hidden += hidden
        self.through += through

    @property
    def is_through(self) -> bool:
        """Whether most frames without something before the place show what is behind it."""
        return 2 * self.through > self.frames - self.hidden


class Absence:
    """Collects what each look shows of the known places, and judges when the look ends."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters
        self._glances: dict[tuple[int, int], Glance] = {}
        self._end_ms = 0
        self._refound, self._relooked = 0, 0.0
        self._through = np.array([[THROUGH_PRESENT, 1.0], [THROUGH_GONE, 1.0]]) * THROUGH_PRIOR
        self.looked = Looked(parameters)

    def watch(self, scene: Scene, found: list[tuple[Known, Place]], offset: FrameOffset) -> None:
        """Take in a frame: which places it should have shown, and which it did.

        offset: how far the frame's pose is off the map of things.
        """
        self._end_ms = scene.ref.time_ms
        for thing, place in found:
            self._glance(thing, place).found = True
        positions = self._memory.positions
        if scene.pose is None or scene.camera is None:
            return
        x, y, z = (np.array(scene.pose.position) - offset.mean).tolist()
        self.looked.watch(scene, (x, y, z))
        if not positions.owners:
            return
        for _, place in found:
            remember_side(place, (x, y, z))
        seen = project(positions.mean + offset.mean, scene.pose, scene.camera)
        parameters = self._parameters
        visible = in_view(seen, scene.camera, parameters.view_range_m, parameters.view_margin)
        rows = np.flatnonzero(visible)
        if len(rows) == 0:
            return
        sigma = positions.sigmas(rows, offset.covariance)
        is_sure = sigma <= SURE_M
        rows, sigma = rows[is_sure], sigma[is_sure]
        spots = seen.u[rows], seen.v[rows], seen.depth_m[rows], sigma
        hidden, through = self._depths(scene, *spots)
        away_m = spots[2].tolist()
        for k, row in enumerate(rows.tolist()):
            thing, place = positions.owners[row]
            glance = self._glance(thing, place)
            if not glance.familiar and not hidden[k]:
                glance.familiar = is_familiar(place, (x, y, z), away_m[k])
            glance.add(hidden[k], through[k])
            glance.eye = (x, y, z)

    def _depths(
        self, scene: Scene, u: Floats, v: Floats, away_m: Floats, sigma_m: Floats
    ) -> tuple[list[bool], list[bool]]:
        """Say of places (k,) whether something hides them, and whether only what is behind shows.

        A thing may be anywhere in its error around (u, v): nothing there may be as near as it.
        """
        assert scene.camera is not None
        if scene.depth is None or len(u) == 0:
            return [False] * len(u), [False] * len(u)
        spot = np.full(len(u), float(PATCH))
        margin = self._parameters.seen_through_m + 2 * sigma_m
        before, measured = nearer(samples(scene.depth, u, v, spot, 2 * PATCH + 1), away_m - margin)
        hidden = 2 * before > measured
        wide = PATCH + np.round(2 * sigma_m * scene.camera.fx / away_m)
        around = samples(scene.depth, u, v, np.minimum(wide, PATCH_MOST))
        near, count = nearer(around, away_m + self._parameters.seen_through_m)
        through = ~hidden & (measured > 0) & (near < NEAREST_SHARE * count) & (wide <= PATCH_MOST)
        return hidden.tolist(), through.tolist()

    def _glance(self, thing: Known, place: Place) -> Glance:
        key = thing.number, place.number
        found = self._glances.get(key)
        if found is None:
            found = self._glances[key] = Glance(thing, place)
        return found

    def found(self) -> list[Known]:
        """Return the things that the current look has found, by number."""
        found = {g.thing.number: g.thing for g in self._glances.values() if g.found}
        return [found[number] for number in sorted(found)]

    def end_look(self) -> list[Known]:
        """Judge the look that ended; return the things that it missed.

        Updates evidence, chances and `last_absent_ms` of every place that was in view.
        """
        missed: list[Known] = []
        for key in sorted(self._glances):
            glance = self._glances[key]
            thing, place = glance.thing, glance.place
            if glance.found:
                self._found(glance)
                continue
            if glance.is_through:
                odds = self._through_odds()
            elif glance.familiar:
                odds = -math.log(1 - chance(place, self._usual()))
            else:
                continue
            missed.append(thing)
            self._missed(glance, odds, self._share_of_look(glance))
        self._glances.clear()
        self.looked.end_look()
        return missed

    def _usual(self) -> float:
        """Return how likely a look finds a thing that is there, by all things."""
        return (self._refound + 2 * self._parameters.detect_chance) / (self._relooked + 2)

    def came(self, place: Place) -> float:
        """Return the log-odds that what is at a place was brought while the robot was about."""
        if place.row < 0:
            return 0.0
        return self.looked.came(place, self._memory.positions.mean[place.row], self._usual())

    def _share_of_look(self, glance: Glance) -> float:
        """Return how much a look in vain tells that others from there have not told already."""
        place, eye = glance.place, glance.eye
        if eye is None:
            return 1.0
        share, place.missed_from = share_of_look(place.missed_from, eye, self._end_ms)
        return share

    def _through_odds(self) -> float:
        """Return how much likelier a place is seen through when its thing has left."""
        (there, of), (gone, among) = self._through.tolist()
        odds = math.log(gone / among) - math.log(there / of)
        return min(THROUGH_MOST, max(THROUGH_LEAST, odds))

    def _found(self, glance: Glance) -> None:
        thing, place = glance.thing, glance.place
        if thing.seen > self._parameters.confirm_sightings and glance.familiar:
            self._refound += 1
            self._relooked += 1
            if glance.frames > glance.hidden:
                self._through[0] += (glance.is_through, 1.0)
        self._through[0] += place.throughs  # it was there all the time
        place.hits += 1
        place.chances += 1
        place.misses = place.throughs = 0
        place.missed_from = []
        place.evidence = 0.0
        if place.last_absent_ms is not None:
            place.last_absent_ms, thing.dirty = None, True

    def _missed(self, glance: Glance, odds: float, share: float) -> None:
        """Count a share of a miss; enough of them say that the place is empty.

        Where that is known already (its thing was moved, see `moves`), each says that it still is.
        """
        thing, place = glance.thing, glance.place
        if thing.seen > self._parameters.confirm_sightings and place.last_absent_ms is None:
            self._relooked += share
        elif place.last_absent_ms is not None and glance.frames > glance.hidden:
            self._through[1] += (glance.is_through, 1.0)
        place.evidence += share * odds
        place.chances += share
        place.misses += 1
        place.throughs += glance.is_through
        was_empty = place.last_absent_ms is not None
        is_gone = place.evidence >= self._parameters.absent_odds and thing.seen >= SURE_SEEN
        if was_empty or is_gone:
            place.last_absent_ms = self._end_ms
            thing.dirty = True

    def forget(self, thing: Known) -> None:
        """Forget what the look showed of a thing that leaves the memory."""
        for place in thing.places:
            self._glances.pop((thing.number, place.number), None)

    def to_state(self) -> Json:
        """Return the look that is going on as JSON."""
        glances = [
            [*key, g.frames, g.hidden, g.through, g.familiar, g.found, g.eye]
            for key, g in self._glances.items()
        ]
        counts = [self._refound, self._relooked]
        through = self._through.tolist()
        return {
            "end_ms": self._end_ms,
            "glances": glances,
            "again": counts,
            "through": through,
            "looking": self.looked.is_open,
        }

    def restore(self, record: Json, looked: Floats) -> None:
        """Go on where `to_state` was called, with `looked.rows`; the memory is restored already."""
        self.looked.restore(looked, record["looking"])
        self._end_ms = record["end_ms"]
        self._refound, self._relooked = record["again"]
        self._through = np.array(record["through"])
        for number, place_number, *counted, eye in record["glances"]:
            thing = self._memory.things[number]
            glance = Glance(thing, thing.place(place_number), *counted)
            glance.eye = None if eye is None else (eye[0], eye[1], eye[2])
            self._glances[number, place_number] = glance
