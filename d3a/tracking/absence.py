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

from d3a.geometry import Frustum, rotation
from d3a.model import Camera, Json, Position
from d3a.parameters import Parameters
from d3a.sightings import Scene
from d3a.symmetric import trace
from d3a.tracking.arrivals import Looked
from d3a.tracking.depths import NEAREST_SHARE, nearer, samples
from d3a.tracking.frame_offset import FrameOffset
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.sides import (
    LOOK_RANGE_M,
    chance_from,
    is_familiar,
    left,
    remember_look,
    remember_side,
    share_of_look,
)

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

    frames: in view. hidden: behind something. through: only what is behind it was seen. eye and
    away_m: from where it was last in plain view, and how far off.
    """

    thing: Known
    place: Place
    frames: int = 0
    hidden: int = 0
    through: int = 0
    away_m: float = 0.0
    found: bool = False
    eye: Position | None = None

    def add(self, eye: Position, away_m: float, hidden: bool, through: bool) -> None:
        """Count a frame taken from somewhere, so far off."""
        self.frames += 1
        self.through += through
        if hidden:
            self.hidden += 1
        else:
            self.eye, self.away_m = eye, away_m

    @property
    def is_plain(self) -> bool:
        """Whether it was in plain view in any frame."""
        return self.frames > self.hidden

    @property
    def is_familiar(self) -> bool:
        """Whether it was in plain view from a side that has shown it before."""
        return self.eye is not None and is_familiar(self.place, self.eye, self.away_m)

    @property
    def is_through(self) -> bool:
        """Whether most frames without something before the place show what is behind it."""
        return 2 * self.through > self.frames - self.hidden


class Absence:
    """Collects what each look shows of the known places, and judges when the look ends."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters
        self._glances: dict[Place, Glance] = {}
        self._end_ms = 0
        self._refound, self._relooked = 0, 0.0
        self._through = np.array([[THROUGH_PRESENT, 1.0], [THROUGH_GONE, 1.0]]) * THROUGH_PRIOR
        self.looked = Looked(parameters)
        self._frustum: tuple[Camera, Frustum] | None = None
        """Of the latest frame's camera, which is mostly the next one's too."""

    def watch(self, scene: Scene, found: list[tuple[Known, Place]], offset: FrameOffset) -> None:
        """Take in a frame: which places it should have shown, and which it did.

        offset: how far the frame's pose is off the map of things.
        """
        self._end_ms = scene.ref.time_ms
        for thing, place in found:
            self._glance(thing, place).found = True
        if scene.pose is None or scene.camera is None:
            return
        (x, y, z), (off_x, off_y, off_z) = scene.pose.position, offset.mean
        eye = x - off_x, y - off_y, z - off_z
        self.looked.watch(scene, eye)
        for thing, place in found:
            remember_side(place, eye)
            self._glance(thing, place).eye = eye
        positions = self._memory.positions
        if not positions.owners:
            return
        turn = rotation(scene.pose)
        spots = turn.T @ (positions.columns[:3] - np.array(eye)[:, None])
        rows = self._frustum_of(scene.camera).inside(spots)
        variance = positions.variances(rows) + trace(offset.covariance)
        sure = variance <= 3 * SURE_M**2
        rows, variance = rows[sure], variance[sure]
        self._glimpse(scene, eye, rows, spots[:, rows], np.sqrt(variance / 3))

    def _frustum_of(self, camera: Camera) -> Frustum:
        if self._frustum is None or self._frustum[0] != camera:
            parameters = self._parameters
            seen = Frustum.of(camera, LOOK_RANGE_M, parameters.view_margin)
            self._frustum = camera, seen
        return self._frustum[1]

    def _glimpse(
        self, scene: Scene, eye: Position, rows: NDArray[np.intp], spots: Floats, sigma_m: Floats
    ) -> None:
        """Count a frame for the places of rows (k,); spots: (3, k), along the camera's axes."""
        owners = self._memory.positions.owners
        hidden, through = self._depths(scene, spots, sigma_m)
        seen = zip(rows.tolist(), spots[2].tolist(), hidden, through, strict=True)
        for row, away_m, is_hidden, is_through in seen:
            self._glance(*owners[row]).add(eye, away_m, is_hidden, is_through)

    def _depths(
        self, scene: Scene, spots: Floats, sigma_m: Floats
    ) -> tuple[list[bool], list[bool]]:
        """Say of places (3, k) whether something hides them, and whether only what is behind shows.

        A thing may be anywhere in its error around its place: nothing there may be as near as it.
        """
        count, camera = len(sigma_m), scene.camera
        if scene.depth is None or camera is None or count == 0:
            return [False] * count, [False] * count
        x, y, away_m = spots
        u, v = camera.cx + camera.fx * x / away_m, camera.cy + camera.fy * y / away_m
        spot = np.full(count, float(PATCH))
        margin = self._parameters.seen_through_m + 2 * sigma_m
        before, measured = nearer(samples(scene.depth, u, v, spot, 2 * PATCH + 1), away_m - margin)
        hidden = 2 * before > measured
        wide = PATCH + np.round(2 * sigma_m * camera.fx / away_m)
        around = samples(scene.depth, u, v, np.minimum(wide, PATCH_MOST))
        near, of = nearer(around, away_m + self._parameters.seen_through_m)
        through = ~hidden & (measured > 0) & (near < NEAREST_SHARE * of) & (wide <= PATCH_MOST)
        return hidden.tolist(), through.tolist()

    def _glance(self, thing: Known, place: Place) -> Glance:
        found = self._glances.get(place)
        if found is None:
            found = self._glances[place] = Glance(thing, place)
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
        for glance in self._in_order():
            thing, place = glance.thing, glance.place
            if glance.found:
                self._found(glance)
                continue
            if glance.is_through:
                odds = self._through_odds()
            elif glance.eye is not None and glance.is_familiar:
                seen = chance_from(place, glance.eye, glance.away_m, self._usual())
                odds = -math.log(1 - seen)
            else:
                continue
            missed.append(thing)
            self._missed(glance, odds, self._share_of_look(glance))
        self._glances.clear()
        self.looked.end_look()
        return missed

    def _in_order(self) -> list[Glance]:
        """Return the glances by thing and place."""
        return sorted(self._glances.values(), key=lambda g: (g.thing.number, g.place.number))

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

    def _share_of_look(self, glance: Glance) -> float:
        """Return how much a look in vain tells that others from there have not told already."""
        place, eye = glance.place, glance.eye
        if eye is None:
            return 1.0
        share, place.missed_from = share_of_look(place.missed_from, eye, self._end_ms)
        remember_look(place, eye, share, found=False)
        return share

    def _through_odds(self) -> float:
        """Return how much likelier a place is seen through when its thing has left."""
        (there, of), (gone, among) = self._through.tolist()
        odds = math.log(gone / among) - math.log(there / of)
        return min(THROUGH_MOST, max(THROUGH_LEAST, odds))

    def _found(self, glance: Glance) -> None:
        thing, place = glance.thing, glance.place
        if thing.seen > self._parameters.confirm_sightings and glance.is_plain:
            self._refound += 1
            self._relooked += 1
            self._through[0] += (glance.is_through, 1.0)
        self._through[0] += place.throughs  # it was there all the time
        if glance.eye is not None and place.hits:  # see `chance` for the first
            remember_look(place, glance.eye, 1.0, found=True)
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
        elif place.last_absent_ms is not None and glance.is_plain:
            self._through[1] += (glance.is_through, 1.0)
        place.evidence += share * odds
        place.chances += share
        place.misses += 1
        place.throughs += glance.is_through
        was_empty = place.last_absent_ms is not None
        if was_empty or self._is_gone(thing, place):
            place.last_absent_ms = self._end_ms
            thing.dirty = True

    def _is_gone(self, thing: Known, place: Place) -> bool:
        """Say whether a thing has most likely left a place, by all looks in vain since."""
        if thing.seen < SURE_SEEN:
            return False
        known_ms, since_ms = self._end_ms - thing.first_ms, self._end_ms - place.last_ms
        odds = place.evidence + left(len(thing.places) - 1, known_ms, since_ms)
        return odds >= self._parameters.absent_odds

    def forget(self, thing: Known) -> None:
        """Forget what the look showed of a thing that leaves the memory."""
        for place in thing.places:
            self._glances.pop(place, None)

    def to_state(self) -> Json:
        """Return the look that is going on as JSON."""
        glances = [
            [
                g.thing.number,
                g.place.number,
                g.frames,
                g.hidden,
                g.through,
                g.away_m,
                g.found,
                g.eye,
            ]
            for g in self._glances.values()
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
            glance = self._glance(thing, thing.place(place_number))
            glance.frames, glance.hidden, glance.through, glance.away_m, glance.found = counted
            glance.eye = None if eye is None else (eye[0], eye[1], eye[2])
