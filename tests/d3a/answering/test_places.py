"""Where a stay is told to be: the smallest room that holds it."""

from __future__ import annotations

from d3a.answering.places import holders_of, room_of, rooms_of
from d3a.store.base import Region


def test_of_several_rooms_the_smallest_on_the_map_holds_a_place() -> None:
    square = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))
    corner = ((0.0, 0.0), (2.0, 0.0), (0.0, 2.0))
    rooms = [Region("flat", square), Region("corner", corner), Region("upstairs", square, "two")]
    at = [((0.5, 0.5, 9.0), ""), ((3.0, 3.0, 0.0), ""), ((4.0, 1.0, 0.0), "two"), (None, "")]
    assert rooms_of(rooms, at) == ["corner", "flat", "flat", None]
    assert [room_of(rooms, *place) for place in at] == rooms_of(rooms, at)
    assert room_of(rooms, (1.5, 1.5, 0.0), "") == "flat"  # within the corner's bounds alone
    assert room_of(rooms[2:], (1.0, 1.0, 0.0), "one") is None
    assert [{r.name for r in held} for held in holders_of(rooms, at)] == [
        {"flat", "corner"},
        {"flat"},
        {"flat", "upstairs"},
        set(),
    ]
