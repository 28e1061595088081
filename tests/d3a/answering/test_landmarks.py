"""Landmarks: the nearest to a stay of those on its site that no wall hides."""

from __future__ import annotations

import math
import random

import pytest

from d3a.answering.landmarks import Landmarks
from d3a.store.base import StayRecord

ROOMS = ((), ("kitchen",), ("hall",), ("kitchen", "pantry"))
SITES = ("", "attic")


def stay(name: str, position: tuple[float, float, float] | None, site: str = "") -> StayRecord:
    return StayRecord(name, 0, position, 0, 1, 1.0, site=site)


def one_by_one(
    landmarks: Landmarks,
    of: StayRecord,
    limit_m: float,
    rooms: tuple[str, ...],
    ids: set[str],
    kinds: set[str],
) -> tuple[str, float] | None:
    best: tuple[str, float] | None = None
    table = (landmarks.stays, landmarks.categories, landmarks.places, landmarks.sites)
    for (name, _), kind, place, site, held in zip(*table, landmarks.rooms, strict=True):
        if of.position is None or name in {*ids, of.object_id} or kind in kinds:
            continue
        if site != of.site or (held and rooms and not {*held} & {*rooms}):
            continue
        apart = math.dist(of.position, place)
        if apart <= limit_m and (best is None or apart < best[1]):
            best = kind, apart
    return best


@pytest.mark.parametrize("many", [0, 1, 9, 300])
def test_the_nearest_landmark_is_the_one_found_one_by_one(many: int) -> None:
    draw = random.Random(many)
    kinds = ("table", "bed", "sink")
    landmarks = Landmarks(
        tuple((f"o{k}", 0) for k in range(many)),
        tuple(draw.choice(kinds) for _ in range(many)),
        tuple(_on_a_grid(draw) for _ in range(many)),  # many are exactly as near
        tuple(draw.choice(SITES) for _ in range(many)),
        tuple(draw.choice(ROOMS) for _ in range(many)),
    )
    stays = [
        stay(f"o{draw.randrange(40)}", _on_a_grid(draw), draw.choice((*SITES, "unmapped")))
        for _ in range(200)
    ]
    stays += [stay("x", None), stay("y", (1e9, 0.0, 0.0))]
    rooms = [draw.choice((*ROOMS, ("cellar",))) for _ in stays]
    for not_ids, not_kinds in ((set(), set()), ({"o1", "o7"}, {"bed"}), (set(), {*kinds})):
        named = zip(landmarks.stays, landmarks.categories, strict=True)
        without = [k for k, ((i, _), kind) in enumerate(named) if i in not_ids or kind in not_kinds]
        found = landmarks.nearest(stays, 3.0, rooms, without=without)
        assert found == [
            one_by_one(landmarks, s, 3.0, held, not_ids, not_kinds)
            for s, held in zip(stays, rooms, strict=True)
        ]


def _on_a_grid(draw: random.Random) -> tuple[float, float, float]:
    return draw.randrange(9) * 0.7, draw.randrange(9) * 0.7, draw.randrange(2) * 0.1
