"""The worlds made for measuring relations: they add to a seed's world and change nothing in it."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from d3a.simulation.solids import centred, overlap
from d3a.simulation.truth import relations
from d3a.simulation.world import World, build
from tests.worlds.arranged import HOLLOW, arranged


@pytest.fixture(scope="module", params=[0, 1])
def worlds(request: pytest.FixtureRequest) -> tuple[World, World]:
    # the worlds of bench_relations: their seed and their hours
    plain = build(3.0, np.random.default_rng([request.param, zlib.crc32(b"world")]))
    return plain, arranged(plain)


def test_what_was_there_stays(worlds: tuple[World, World]) -> None:
    plain, more = worlds
    assert more.things[: len(plain.things)] == plain.things
    assert more.stands[: len(plain.stands)] == plain.stands
    assert np.array_equal(more.looks.main[: len(plain.things)], plain.looks.main)
    assert len(more.looks.turn) == len(more.things) == len(more.sizes)


def test_there_are_hollow_things_with_something_inside_and_things_under_tables(
    worlds: tuple[World, World],
) -> None:
    plain, more = worlds
    assert {thing.category for thing in more.things} >= set(HOLLOW)
    under = [row for rows in relations(more) for row in rows if row["kind"] == "under"]
    assert len(under) >= 3
    added = {s.support for s in more.stands[len(plain.stands) :]}
    assert "bookcase" in added
    assert any(support.startswith("box on") for support in added)


def test_nothing_added_overlaps_anything(worlds: tuple[World, World]) -> None:
    plain, more = worlds
    loose = [s for s in more.stands if more.things[s.thing].piece is None]
    furniture = np.array([solid for piece in more.room.pieces for solid in piece.solids])
    for stand in more.stands[len(plain.stands) :]:
        thing = more.things[stand.thing]
        if thing.piece is not None:
            continue
        solid = centred(np.array(stand.position), np.array(thing.size))
        solid = solid + np.array([0, 0, 0.004, 0, 0, 0])
        others = [s for s in loose if s.thing != stand.thing]
        sizes = np.array([more.things[s.thing].size for s in others])
        assert not overlap(solid, centred(np.array([s.position for s in others]), sizes), 0.0)
        assert not overlap(solid, furniture, 0.0)
