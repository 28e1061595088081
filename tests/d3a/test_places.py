"""Where a stay is told to be: the nearest landmark, and the smallest room that holds it."""

from __future__ import annotations

import math
import random

import pytest

from d3a.places import Landmarks, room_of, rooms_of
from d3a.store.base import Region, StayRecord


def stay(name: str, position: tuple[float, float, float] | None) -> StayRecord:
    return StayRecord(name, 0, position, 0, 1, 1.0)


def one_by_one(
    landmarks: Landmarks, of: StayRecord, limit_m: float, ids: set[str], kinds: set[str]
) -> tuple[str, float] | None:
    best: tuple[str, float] | None = None
    for name, kind, place in zip(
        landmarks.ids, landmarks.categories, landmarks.places, strict=True
    ):
        if of.position is None or name in {*ids, of.object_id} or kind in kinds:
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
        tuple(f"o{k}" for k in range(many)),
        tuple(draw.choice(kinds) for _ in range(many)),
        tuple(_on_a_grid(draw) for _ in range(many)),  # many are exactly as near
    )
    stays = [stay(f"o{draw.randrange(40)}", _on_a_grid(draw)) for _ in range(200)]
    stays += [stay("x", None), stay("y", (1e9, 0.0, 0.0))]
    for not_ids, not_kinds in ((set(), set()), ({"o1", "o7"}, {"bed"}), (set(), {*kinds})):
        found = landmarks.nearest(stays, 3.0, not_ids=not_ids, not_categories=not_kinds)
        assert found == [one_by_one(landmarks, s, 3.0, not_ids, not_kinds) for s in stays]


def _on_a_grid(draw: random.Random) -> tuple[float, float, float]:
    return draw.randrange(9) * 0.7, draw.randrange(9) * 0.7, draw.randrange(2) * 0.1


def test_of_several_rooms_the_smallest_on_the_map_holds_a_place() -> None:
    square = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
    corner = ((0.0, 0.0), (2.0, 0.0), (0.0, 2.0))
    rooms = [Region("flat", square), Region("corner", corner), Region("upstairs", square, "two")]
    at = [((0.5, 0.5, 9.0), ""), ((3.0, 3.0, 0.0), ""), ((4.0, 1.0, 0.0), "two"), (None, "")]
    assert rooms_of(rooms, at) == ["corner", "flat", "flat", None]
    assert [room_of(rooms, *place) for place in at] == rooms_of(rooms, at)
    assert room_of(rooms, (1.5, 1.5, 0.0), "") == "flat"  # within the corner's bounds alone
    assert room_of(rooms[2:], (1.0, 1.0, 0.0), "one") is None
