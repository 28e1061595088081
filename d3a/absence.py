"""Default profile: negative evidence ("I looked there again, and it was gone").

A look is a view of `coverage`: all frames from nearly one viewpoint count once, because what hides
a thing in one of them hides it in the next. In a look a place is found, or hidden by something
nearer, or seen through (depth shows what is behind it), or missed: then only the chance that the
detector overlooks a present thing speaks for it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from d3a.geometry import in_view, project
from d3a.memory import Known, Memory, Place
from d3a.model import Json
from d3a.parameters import Parameters
from d3a.sightings import Metres, Scene

PATCH = 3
"""Half the side, in pixels, of the patch of depth that is looked at."""
SURE_M = 1.0
"""A place whose position may err by more than this (one sigma) cannot be looked at."""
SEEN_THROUGH_ODDS = 2.5
"""Log-odds of one look that saw through a place: poses and shapes err, so not certainty."""


@dataclass(slots=True)
class Glance:
    """What the current look showed of a place: frames in which it was in view, hidden, through."""

    thing: Known
    place: Place
    frames: int = 0
    hidden: int = 0
    through: int = 0
    found: bool = False


class Absence:
    """Collects what each look shows of the known places, and judges when the look ends."""

    def __init__(self, memory: Memory, parameters: Parameters) -> None:
        self._memory = memory
        self._parameters = parameters
        self._glances: dict[tuple[int, int], Glance] = {}
        self._end_ms = 0

    def watch(self, scene: Scene, found: list[tuple[Known, Place]]) -> None:
        """Take in a frame: which places it should have shown, and which it did."""
        self._end_ms = scene.ref.time_ms
        for thing, place in found:
            self._glance(thing, place).found = True
        positions = self._memory.positions
        if scene.pose is None or scene.camera is None or not positions.owners:
            return
        seen = project(positions.mean, scene.pose, scene.camera)
        parameters = self._parameters
        visible = in_view(seen, scene.camera, parameters.view_range_m, parameters.view_margin)
        sigma = np.sqrt(np.trace(positions.spread, axis1=1, axis2=2) / 3)
        for row in np.flatnonzero(visible & (sigma <= SURE_M)).tolist():
            thing, place = positions.owners[row]
            glance = self._glance(thing, place)
            glance.frames += 1
            behind = _behind(
                scene.depth, float(seen.u[row]), float(seen.v[row]), float(seen.depth_m[row])
            )
            margin = parameters.seen_through_m + 2 * float(sigma[row])
            glance.hidden += behind is not None and behind < -margin
            glance.through += behind is not None and behind > margin

    def _glance(self, thing: Known, place: Place) -> Glance:
        return self._glances.setdefault((thing.number, place.number), Glance(thing, place))

    def end_look(self) -> list[tuple[Known, Place]]:
        """Judge the look that ended; return the places that it shows to be empty now.

        Updates evidence, chances and `last_absent_ms` of every place that was in view.
        """
        emptied = []
        for key in sorted(self._glances):
            glance = self._glances[key]
            thing, place = glance.thing, glance.place
            if thing.row < 0:  # evicted or expired meanwhile
                continue
            if glance.found:
                place.hits += 1
                place.chances += 1
                place.misses = 0
                place.evidence = 0.0
                if place.last_absent_ms is not None:
                    place.last_absent_ms, thing.dirty = None, True
            elif glance.hidden < glance.frames:
                emptied += self._missed(glance)
        self._glances.clear()
        return emptied

    def _missed(self, glance: Glance) -> list[tuple[Known, Place]]:
        place = glance.place
        parameters = self._parameters
        if 2 * glance.through >= glance.frames - glance.hidden:
            place.evidence += SEEN_THROUGH_ODDS
        else:
            # How often this very thing is found when it should be, with two looks' worth of prior.
            chance = (place.hits + 2 * parameters.detect_chance) / (place.chances + 2)
            place.evidence -= math.log(1 - min(chance, 0.95))
        place.chances += 1
        place.misses += 1
        if place.evidence < parameters.absent_odds:
            return []
        first = place.last_absent_ms is None
        place.last_absent_ms = self._end_ms
        glance.thing.dirty = True
        return [(glance.thing, place)] if first else []

    def to_state(self) -> Json:
        """Return the look that is going on as JSON."""
        glances = [
            [*key, g.frames, g.hidden, g.through, g.found] for key, g in self._glances.items()
        ]
        return {"end_ms": self._end_ms, "glances": glances}

    def restore(self, record: Json) -> None:
        """Go on where `to_state` was called; the memory is restored already."""
        self._end_ms = record["end_ms"]
        for number, place_number, frames, hidden, through, found in record["glances"]:
            thing = self._memory.things.get(number)
            if thing is not None:
                place = thing.place(place_number)
                glance = Glance(thing, place, frames, hidden, through, found)
                self._glances[number, place_number] = glance


def _behind(depth: Metres | None, u: float, v: float, expected_m: float) -> float | None:
    """Return how far behind the expected place the depth there is, None where unmeasured."""
    if depth is None:
        return None
    row, column = round(v), round(u)
    patch = depth[
        max(0, row - PATCH) : row + PATCH + 1, max(0, column - PATCH) : column + PATCH + 1
    ]
    patch = patch[patch > 0]
    return float(np.median(patch)) - expected_m if len(patch) else None
