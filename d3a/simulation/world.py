"""Things and where they are when: 59 of them, some of which people move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a.simulation.appearance import Looks, dress
from d3a.simulation.room import Room, furnish
from d3a.simulation.solids import Floats, centred, overlap

Spot = tuple[float, float, float]
SESSION_S = 5.5 * 3600.0  # the paper's 22 h are four days
DAY_S = 86400.0
MOVES_3H = (1, 1, 1, 1, 2, 2, 2, 3, 3, 5)  # 2.1 +- 1.3, at most 5 (paper, Table 2)
MOVABLE = ("cup", "bottle", "bowl")
SIZES: dict[str, tuple[int, Spot]] = {
    "cup": (13, (0.09, 0.09, 0.11)),
    "bottle": (12, (0.08, 0.08, 0.25)),
    "bowl": (8, (0.17, 0.17, 0.09)),
    "chair": (10, (0.46, 0.46, 0.85)),
    "tv": (3, (0.10, 0.60, 0.38)),
    "laptop": (2, (0.26, 0.33, 0.23)),
    "potted plant": (2, (0.26, 0.26, 0.50)),
    "book": (2, (0.17, 0.23, 0.05)),
    "vase": (1, (0.13, 0.13, 0.28)),
}


@dataclass(frozen=True, slots=True)
class Thing:
    """One true object: its name ("cup-3"), category, colour word and size in metres.

    piece: the furniture that it is, None for what stands on or beside furniture.
    """

    name: str
    category: str
    colour: str
    size: Spot
    piece: str | None = None


@dataclass(frozen=True, slots=True)
class Stand:
    """One thing at one place: index of the thing, centre in metres, [start, end] in seconds."""

    thing: int
    position: Spot
    start_s: float
    end_s: float
    support: str


@dataclass(frozen=True, slots=True)
class World:
    """A seed's world: room, things, looks and every stay, by thing and time.

    sessions: [start, end] in seconds from the first moment; the robot rests between them.
    """

    room: Room
    things: tuple[Thing, ...]
    looks: Looks = field(repr=False)
    stands: tuple[Stand, ...] = field(repr=False)
    sessions: tuple[tuple[float, float], ...]

    @property
    def sizes(self) -> NDArray[np.float64]:
        """Width, depth and height of each thing, (n, 3)."""
        return np.array([thing.size for thing in self.things])

    def fixed(self) -> tuple[Floats, NDArray[np.intp]]:
        """Return the furniture's solids (b, 6) and the thing each is part of, -1 for none."""
        owner = {thing.piece: k for k, thing in enumerate(self.things) if thing.piece}
        rows = [(s, owner.get(p.name, -1)) for p in self.room.pieces for s in p.solids]
        return np.array([s for s, _ in rows], dtype=np.float32), np.array([o for _, o in rows])

    def positions(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the centre of each thing at each time, (m, n, 3); NaN while it is carried."""
        out = np.full((len(times), len(self.things), 3), np.nan)
        for stand in self.stands:
            here = (times >= stand.start_s) & (times <= stand.end_s)
            out[here, stand.thing] = stand.position
        return out


def sessions_of(hours: float) -> tuple[tuple[float, float], ...]:
    """Return the times at which the robot works, at most 5.5 h a day, seconds from the start."""
    left, day, out = hours * 3600.0, 0, []
    while left > 1e-6:
        length = min(left, SESSION_S)
        out.append((day * DAY_S, day * DAY_S + length))
        left, day = left - length, day + 1
    return tuple(out)


def build(hours: float, rng: np.random.Generator) -> World:
    """Return a world with the paper's numbers (Table 2) and moves in proportion to `hours`."""
    room = furnish(rng)
    categories = [c for c, (count, _) in SIZES.items() for _ in range(count)]
    pieces = [p for p in room.pieces if p.category]
    named = [*categories, *(str(p.category) for p in pieces)]
    words, looks = dress(named, rng)
    sizes = [_size(c, rng) for c in categories] + [_extent(p.solids)[1] for p in pieces]
    number: dict[str, int] = {}
    things = []
    for k, category in enumerate(named):
        number[category] = number.get(category, 0) + 1
        piece = pieces[k - len(categories)].name if k >= len(categories) else None
        name = f"{category.replace(' ', '-')}-{number[category]}"
        things.append(Thing(name, category, words[k], sizes[k], piece))
    sessions = sessions_of(hours)
    stands = _live(room, things, sessions, hours, rng)
    return World(room, tuple(things), looks, tuple(stands), sessions)


def _size(category: str, rng: np.random.Generator) -> Spot:
    x, y, z = np.array(SIZES[category][1]) * rng.uniform(0.85, 1.2)
    return float(x), float(y), float(z)


def _extent(solids: Sequence[Sequence[float]]) -> tuple[Spot, Spot]:
    """Return the centre and the size of the box around some solids."""
    rows = np.array(solids)
    low, high = rows[:, :3].min(axis=0), rows[:, 3:].max(axis=0)
    centre, size = (low + high) / 2, high - low
    return (float(centre[0]), float(centre[1]), float(centre[2])), (
        float(size[0]),
        float(size[1]),
        float(size[2]),
    )


def _live(
    room: Room,
    things: list[Thing],
    sessions: tuple[tuple[float, float], ...],
    hours: float,
    rng: np.random.Generator,
) -> list[Stand]:
    """Place everything, then carry things about in the order of time; nothing overlaps."""
    start, end = sessions[0][0], sessions[-1][1]
    now: dict[int, tuple[Spot, str, float]] = {}
    for k, thing in enumerate(things):
        now[k] = (*_first_spot(room, things, k, thing, now, rng), start)
    stands = []
    for moment, k in _moves(things, sessions, hours, rng):
        old, support, since = now[k]
        if moment <= since:  # still in somebody's hand
            continue
        found = _free_spot(room, things, k, now, rng, away_from=old)
        if found is None:
            continue
        stands.append(Stand(k, old, since, moment, support))
        now[k] = (*found, moment + float(rng.uniform(20.0, 90.0)))
    stands += [Stand(k, spot, since, end, on) for k, (spot, on, since) in now.items()]
    return sorted(stands, key=lambda stand: (stand.thing, stand.start_s))


def _moves(
    things: list[Thing],
    sessions: tuple[tuple[float, float], ...],
    hours: float,
    rng: np.random.Generator,
) -> list[tuple[float, int]]:
    """Return (time, thing) of every move: 10 movers in 3 h, up to 20 in 22 h, .7 moves an hour."""
    movable = [k for k, thing in enumerate(things) if thing.category in MOVABLE]
    count = 10 + round(10 * min(1.0, max(0.0, hours - 3.0) / 19.0))
    movers = rng.permutation(movable)[:count]
    if 2.5 <= hours <= 3.5:
        times_each = rng.permutation(MOVES_3H)
    else:
        times_each = np.maximum(1, rng.poisson(0.7 * hours, size=count))
    lengths = np.array([b - a for a, b in sessions])
    before = np.concatenate([[0.0], np.cumsum(lengths)])
    out = []
    for k, times in zip(movers, times_each, strict=True):
        apart = min(300.0, 0.5 * before[-1] / int(times))  # people put things down for a while
        free = 0.92 * before[-1] - apart * (int(times) - 1)
        drawn = np.sort(rng.uniform(0.0, free, size=int(times)))
        for spent in 0.04 * before[-1] + drawn + apart * np.arange(int(times)):
            day = int(np.searchsorted(before, spent, side="right")) - 1
            out.append((float(sessions[day][0] + spent - before[day]), int(k)))
    return sorted(out)


def _first_spot(
    room: Room,
    things: list[Thing],
    k: int,
    thing: Thing,
    now: dict[int, tuple[Spot, str, float]],
    rng: np.random.Generator,
) -> tuple[Spot, str]:
    if thing.piece is not None:
        piece = next(p for p in room.pieces if p.name == thing.piece)
        return _extent(piece.solids)[0], "floor"
    found = _free_spot(room, things, k, now, rng)
    if found is None:  # 400 tries on 20 m2 of surface: the room is full
        raise ValueError(f"no room left for {thing.name}")
    return found


def _free_spot(
    room: Room,
    things: list[Thing],
    k: int,
    now: dict[int, tuple[Spot, str, float]],
    rng: np.random.Generator,
    away_from: Spot | None = None,
) -> tuple[Spot, str] | None:
    """Draw a spot where the thing stands free of all others; at least 1 m from `away_from`."""
    size = np.array(things[k].size)
    loose = [j for j in now if things[j].piece is None and j != k]
    others = np.array([now[j][0] for j in loose]).reshape(-1, 3)
    solids = centred(others, np.array([things[j].size for j in loose]).reshape(-1, 3))
    furniture = np.array([s for p in room.pieces for s in p.solids])
    for _ in range(400):
        spot, support = _try(room, things[k].category, size, rng)
        solid = centred(spot, size)
        if away_from is not None and np.linalg.norm(spot - np.array(away_from)) < 1.0:
            continue
        raised = solid + np.array([0, 0, 0.03, 0, 0, 0])
        if overlap(raised, solids, 0.03) or overlap(raised, furniture, 0.0):
            continue
        return (float(spot[0]), float(spot[1]), float(spot[2])), support
    return None


def _try(
    room: Room, category: str, size: NDArray[np.float64], rng: np.random.Generator
) -> tuple[NDArray[np.float64], str]:
    """Draw one place of the right kind: chairs at tables, screens on desks, the rest anywhere."""
    if category == "chair":
        x0, y0, x1, y1 = room.seats[rng.integers(len(room.seats))]
        return np.array([rng.uniform(x0, x1), rng.uniform(y0, y1), size[2] / 2]), "floor"
    kinds = {"tv": ("desk",), "laptop": ("desk", "table"), "potted plant": ("desk", "counter")}
    wanted = kinds.get(category, ("",))
    fitting = [s for s in room.supports if s.name.startswith(wanted) and s.clearance >= size[2]]
    weights = np.array([(s.area[2] - s.area[0]) * (s.area[3] - s.area[1]) for s in fitting])
    support = fitting[rng.choice(len(fitting), p=weights / weights.sum())]
    x0, y0, x1, y1 = support.area
    margin = np.minimum(size[:2] / 2, [(x1 - x0) / 2 - 0.01, (y1 - y0) / 2 - 0.01])
    x, y = rng.uniform(np.array([x0, y0]) + margin, np.array([x1, y1]) - margin)
    return np.array([x, y, support.z + size[2] / 2]), support.name
