"""What really was where, and what the robot could have known: for judging, never for an ingest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from d3a.model import Json
from d3a.simulation.patrol import Track
from d3a.simulation.sensor import in_view
from d3a.simulation.solids import Floats, centred, visible
from d3a.simulation.world import Stand, World

CLEAR = 0.6  # share of an empty place in sight that is enough to say it is empty
NEAR_M = 1.5
OPEN_BELOW = frozenset({"dining table", "desk", "coffee table"})
"""What stands on legs: there is room beneath it."""


@dataclass(frozen=True, slots=True)
class Emptiness:
    """When an ended stay's place was in plain sight without its thing: first, last, frames."""

    first_s: float
    last_s: float
    frames: int


def emptiness(world: World, track: Track, loose: Floats) -> list[Emptiness | None]:
    """Return for each stay when the robot saw its place empty after its end; None: never."""
    fixed, owner = world.fixed()
    found: list[Emptiness | None] = []
    for stand in world.stands:
        later = np.flatnonzero(track.times > stand.end_s)
        spot = np.array(stand.position)
        if len(later):
            near, _ = in_view(track, later, np.broadcast_to(spot, (len(later), 3)))
            later = later[near]
        if not len(later):
            found.append(None)
            continue
        solid = centred(spot, np.array(world.things[stand.thing].size))
        shown = visible(
            track.places[later].astype(np.float32),
            np.repeat(solid[None], len(later), axis=0),
            np.full(len(later), -2),
            fixed,
            owner,
            loose,
            later,
        )
        clear = later[shown.mean(axis=1) >= CLEAR]
        times = track.times[clear]
        found.append(
            Emptiness(float(times[0]), float(times[-1]), len(times)) if len(times) else None
        )
    return found


def relations(world: World) -> list[list[Json]]:
    """Return for each stay what it was on, under or near, with the seconds that both were there.

    From the solids: `on` where one stands on the other's top, `under` where its middle is below
    the top of what stands on legs and inside its outline, `near` where centres are within 1.5 m.
    """
    out: list[list[Json]] = []
    for stand in world.stands:
        rows: list[Json] = []
        for other in world.stands:
            start, end = max(stand.start_s, other.start_s), min(stand.end_s, other.end_s)
            if other.thing == stand.thing or start >= end:
                continue
            kinds = _kinds(world, stand, other)
            rows += [
                {"kind": kind, "object": world.things[other.thing].name, "span": (start, end)}
                for kind in kinds
            ]
        out.append(rows)
    return out


def _kinds(world: World, a: Stand, b: Stand) -> list[str]:
    first, second = np.array(a.position), np.array(b.position)
    if np.linalg.norm(first - second) > NEAR_M:
        return []
    size, ground = np.array(world.things[a.thing].size), np.array(world.things[b.thing].size)
    kinds = ["near"]
    if (np.abs(first[:2] - second[:2]) <= ground[:2] / 2).all():
        bottom, top = first[2] - size[2] / 2, second[2] + ground[2] / 2
        category = world.things[b.thing].category
        if abs(bottom - top) < 0.02 or category == a.support == "couch":
            kinds.append("on")
        elif category in OPEN_BELOW and first[2] < top - 0.04:
            kinds.append("under")
    return kinds
