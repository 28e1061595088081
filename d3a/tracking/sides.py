"""Default profile: the viewpoints from which a place was seen, or looked at in vain.

What hides a thing from one viewpoint does so for a while: looks from there in a short time are
mostly one and the same look. And a viewpoint that shows a thing tells most when it does not.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from d3a.model import Position
from d3a.tracking.known import Known, Place

Floats = NDArray[np.float64]
AGAIN_M, AGAIN_MS, AGAIN_SHARE = 0.8, 300_000, 0.3
"""A look from within so much of another, and so soon after it, is mostly the same look: what hid
the thing from the detector does so still. Its share of a look of its own."""
VISIT_SHARE = 0.5
"""The same of a look from elsewhere so soon after another: what made the thing hard to find on the
way up to it (the light, what stands before it) is in part the same."""
FAMILIAR_SHARE, FAMILIAR_M = 0.25, 0.5
"""A viewpoint is one known to show a thing if it is this near to one that did: a share of the
distance to the thing, or metres if that is more."""
CHANCE_PRIOR = 2.0
"""Looks that the usual chance of finding a thing again is worth against the thing's own."""
SIDE_PRIOR = 4.0
"""Looks that the thing's own chance is worth against what looks from there showed of it."""
CHANCE_MOST = 0.95
LEFT_PRIOR, LEFT_HOURS = 0.5, 4.0
"""Moves of a thing that are assumed before any is known, one in so many hours. What has been where
it is for long will mostly stay, and what was moved before is moved again."""
LOOK_RANGE_M = 10.0
"""What is farther away is not looked at: across a hall things are seen, and missed, as in a room;
from where a thing was never seen it is not missed anyway."""
SIDES_KEPT = 12
"""Viewpoints remembered for a place, the latest."""
LOOKS_KEPT = 32
"""Looks remembered for a place, the latest."""
HOUR_MS = 3_600_000
Look = tuple[Position, int]
"""Where the camera was in a look, and when it ended."""


def remember_side(place: Place, eye: Position) -> bool:
    """Keep the viewpoint, if it is another than those known; the oldest goes. Say whether it is."""
    for side in reversed(place.seen_from):  # a robot mostly is where it just was
        if math.dist(eye, side) < FAMILIAR_M:
            return False
    place.seen_from = [*place.seen_from[1 - SIDES_KEPT :], eye]
    return True


def is_familiar(place: Place, eye: Position, away_m: float) -> bool:
    """Say whether a viewpoint so far away from a place is near one that has shown it."""
    near_m = max(FAMILIAR_M, FAMILIAR_SHARE * away_m)
    return any(math.dist(eye, side) <= near_m for side in reversed(place.seen_from))


def are_familiar(sides: Floats, last: Floats) -> NDArray[np.bool_]:
    """Say the same of places (k,) with their sides (k, 3, n), NaN for none.

    last: (4, k), x y z of each one's viewpoint, and how far off the place; NaN: it is not familiar.
    """
    return np.asarray(np.logical_or.reduce(_near(sides, last), axis=1))


def remember_look(place: Place, eye: Position, share: float, found: bool) -> int:
    """Keep whether a look from somewhere found the thing, and its share; the oldest goes.

    Returns where in `place.looks` it is.
    """
    at, look = place.looked % LOOKS_KEPT, (*eye, share, found)
    if at < len(place.looks):
        place.looks[at] = look
    else:
        place.looks.append(look)
    place.looked += 1
    return at


def looks_near(looks: Floats, last: Floats) -> Floats:
    """Return the looks from near some viewpoints, and those that found it, (2, k), by their shares.

    looks: (k, 5, n), see `Positions.looks`; last: as for `are_familiar`.
    """
    near = _near(looks[:, :3], last)
    return np.asarray(np.add.reduce(looks[:, 3:] * near[:, None], axis=2).T)


def _near(eyes: Floats, last: Floats) -> NDArray[np.bool_]:
    """Say which viewpoints (k, 3, n) are near those of `last`, by how far off the places are."""
    away = eyes - last[:3].T[:, :, None]
    away *= away
    near_m2 = np.maximum(FAMILIAR_M, FAMILIAR_SHARE * last[3]) ** 2
    return np.asarray(np.add.reduce(away, axis=1) <= near_m2[:, None])


def share_of_look(latest: list[Look], eye: Position, time_ms: int) -> tuple[float, list[Look]]:
    """Return how much a look tells that others from there have not told already.

    Also the looks that the next one is to be compared with.
    """
    if not latest:
        return 1.0, [(eye, time_ms)]
    recent = [each for each in latest if time_ms - each[1] < AGAIN_MS]
    for side, _ in recent:
        if math.dist(eye, side) < AGAIN_M:
            return AGAIN_SHARE, recent
    share = VISIT_SHARE if recent else 1.0
    recent.append((eye, time_ms))
    return share, recent


def left(moves: int, known_ms: int, since_ms: int) -> float:
    """Return the log-odds, 0 at most, that a thing left in so long a time, before any look.

    moves: those that are known; known_ms: for how long it is.
    """
    hours, since = known_ms / HOUR_MS, max(since_ms, 1) / HOUR_MS
    rate = (moves + LEFT_PRIOR) / (hours + LEFT_PRIOR * LEFT_HOURS)
    return min(math.log(rate * since), 0.0)


def left_before(thing: Known, place: Place, time_ms: int) -> float:
    """Return the log-odds, 0 at most, that a thing left a place since it was last seen there."""
    return left(len(thing.places) - 1, time_ms - thing.first_ms, time_ms - place.last_ms)


def chance(place: Place, usual: float, vain: float = 0.0) -> float:
    """Return how likely a look finds a thing that is there, after so many more looks in vain.

    usual: of all things; it is worth `CHANCE_PRIOR` looks against the thing's own.
    """
    # Without the look that made it known: had that missed too, nobody would ask.
    hits, chances = max(0.0, place.hits - 1.0), max(0.0, place.chances - 1.0)
    own = (hits + CHANCE_PRIOR * usual) / (chances + vain + CHANCE_PRIOR)
    return min(own, CHANCE_MOST)


def chance_from(place: Place, looks: float, found: float, usual: float) -> float:
    """Return how likely a look finds a thing that is there, after so many from near that viewpoint.

    A thing that is found nine times in ten may never have been found from just here.
    """
    here = (found + SIDE_PRIOR * chance(place, usual)) / (looks + SIDE_PRIOR)
    return min(here, CHANCE_MOST)
