"""A seed's world with what it lacks: things under tables, and in shelves and open boxes.

The bookcase is a shelf that is annotated, desks and the low table are annotated too, open boxes
stand on desks, and things are put beneath all that has legs, onto the boards and into the boxes.
Nothing overlaps; all that was there stays as it was.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from d3a.simulation.appearance import Looks, dress
from d3a.simulation.room import Piece, Rectangle
from d3a.simulation.solids import centred, overlap
from d3a.simulation.truth import OPEN_BELOW
from d3a.simulation.world import SIZES, Spot, Stand, Thing, World

HOLLOW = ("shelf", "box")
"""The categories of what things are in."""
BOX_SIZE: Spot = (0.5, 0.5, 0.2)
WALL_M = 0.01
BENEATH, ON_BOARDS = ("bowl", "bottle", "cup"), ("book", "bowl", "bottle", "cup", "vase")
IN_BOX = ("bottle", "vase", "bottle")
NAMED = {"desk": "desk", "low table": "coffee table"}
"""What furniture, by the beginning of its name, is annotated besides, as what."""
TRIES = 300


def arranged(world: World) -> World:
    """Return the world with hollow things, and with things under and in them."""
    rng = np.random.default_rng([len(world.stands), round(1000 * world.stands[0].position[0])])
    shelf = next(p for p in world.room.pieces if p.name == "bookcase")
    world = _with_piece(world, shelf, "shelf", rng)
    for name, category in NAMED.items():
        for piece in [p for p in world.room.pieces if p.name.startswith(name)]:
            world = _with_piece(world, piece, category, rng)
    for desk in [p for p in world.room.pieces if p.category == "desk"]:
        world = _with_box(world, desk, rng)
    for table in [p for p in world.room.pieces if p.category in OPEN_BELOW]:
        for category in BENEATH:
            world = _with_thing(world, category, _outline(table), 0.0, "floor", rng)
    for board in {s.z: s for s in world.room.supports if s.name == "bookcase"}.values():
        for category in ON_BOARDS:
            world = _with_thing(world, category, board.area, board.z, "bookcase", rng)
    for box in [p for p in world.room.pieces if p.category == "box"]:
        for category in IN_BOX:
            world = _with_thing(world, category, _outline(box), box.solids[0][5], box.name, rng)
    return world


def _outline(piece: Piece) -> Rectangle:
    rows = np.array(piece.solids)
    (x0, y0), (x1, y1) = rows[:, :2].min(axis=0), rows[:, 3:5].max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def _with_box(world: World, desk: Piece, rng: np.random.Generator) -> World:
    """Put an open box onto a desk: a floor and four walls."""
    top = desk.solids[0][5]
    found = _spot(world, BOX_SIZE, _outline(desk), top, rng)
    if found is None:
        return world
    x0, y0, z0, x1, y1, z1 = (float(v) for v in centred(np.array(found), np.array(BOX_SIZE)))
    solids = (
        (x0, y0, z0, x1, y1, z0 + WALL_M),
        (x0, y0, z0, x0 + WALL_M, y1, z1),
        (x1 - WALL_M, y0, z0, x1, y1, z1),
        (x0, y0, z0, x1, y0 + WALL_M, z1),
        (x0, y1 - WALL_M, z0, x1, y1, z1),
    )
    box = Piece(f"box on {desk.name}", solids)
    room = replace(world.room, pieces=(*world.room.pieces, box))
    return _with_piece(replace(world, room=room), box, "box", rng)


def _with_piece(world: World, piece: Piece, category: str, rng: np.random.Generator) -> World:
    """Annotate a piece of furniture: it becomes one of the things, for all the time."""
    pieces = tuple(replace(p, category=category) if p is piece else p for p in world.room.pieces)
    rows = np.array(piece.solids)
    low, high = rows[:, :3].min(axis=0), rows[:, 3:].max(axis=0)
    world = replace(world, room=replace(world.room, pieces=pieces))
    return _with(world, category, tuple((low + high) / 2), tuple(high - low), piece.name, rng)


def _with_thing(
    world: World, category: str, area: Rectangle, z: float, support: str, rng: np.random.Generator
) -> World:
    """Put one more thing of a category somewhere onto a level area; where it is full, none."""
    x, y, height = np.array(SIZES[category][1]) * rng.uniform(0.85, 1.2)
    size = float(x), float(y), float(height)
    found = _spot(world, size, area, z, rng)
    return world if found is None else _with(world, category, found, size, None, rng, support)


def _spot(
    world: World, size: Spot, area: Rectangle, z: float, rng: np.random.Generator
) -> Spot | None:
    """Return a centre in the area at which a thing touches nothing that ever stands there."""
    loose = [s for s in world.stands if world.things[s.thing].piece is None]
    others = centred(
        np.array([s.position for s in loose]), np.array([world.things[s.thing].size for s in loose])
    )
    furniture = np.array([solid for p in world.room.pieces for solid in p.solids])
    low = np.array(area[:2]) + np.array(size[:2]) / 2
    high = np.array(area[2:]) - np.array(size[:2]) / 2
    for _ in range(TRIES):
        x, y = rng.uniform(low, np.maximum(low, high))
        spot = float(x), float(y), z + size[2] / 2
        raised = centred(np.array(spot), np.array(size)) + np.array([0, 0, 0.005, 0, 0, 0])
        if not overlap(raised, others, 0.02) and not overlap(raised, furniture, 0.0):
            return spot
    return None


def _with(
    world: World,
    category: str,
    position: tuple[float, ...],
    size: tuple[float, ...],
    piece: str | None,
    rng: np.random.Generator,
    support: str = "floor",
) -> World:
    """Return the world with one thing more, that stays where it is."""
    known = category if category in SIZES else "sink"  # what a hollow thing looks like
    words, looks = dress([known], rng)
    number = 1 + sum(thing.category == category for thing in world.things)
    (x, y, z), (width, deep, height) = map(float, position), map(float, size)
    name = f"{category.replace(' ', '-')}-{number}"
    thing = Thing(name, category, words[0], (width, deep, height), piece)
    start, end = world.sessions[0][0], world.sessions[-1][1]
    stand = Stand(len(world.things), (x, y, z), start, end, support)
    joined = {
        f.name: np.concatenate([getattr(world.looks, f.name), getattr(looks, f.name)])
        for f in fields(Looks)
    }
    return replace(
        world,
        things=(*world.things, thing),
        looks=Looks(**joined),
        stands=(*world.stands, stand),
    )
