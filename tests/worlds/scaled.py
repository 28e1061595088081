"""Large homes, drawn by a seed: months of rounds through rooms, as a long ingest leaves them.

A robot passes spots; a spot shows six things side by side, twice, as a stay has two sightings on
average. What is seen together is within two metres and has shared frames. Small things move from
spot to spot (about 40 stays each), furniture stays. Categories are Zipf. A day holds 5,000 stays,
so that a larger store is a longer memory of one home, not a busier day.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.store.base import (
    Batch,
    Encounter,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayRecord,
    Store,
    View,
)
from tests.worlds.made import PAINTS, painted

T0 = 1_582_178_400_000  # 2020-02-20 06:00 UTC
DAY_MS = 86_400_000
STAYS_A_DAY = 5_000
STAYS_AN_OBJECT = 40
AT_A_SPOT = 6
ZONE = "America/New_York"
MOVABLE = (
    "cup", "book", "bottle", "bowl", "cell phone", "remote", "chair", "keyboard", "mouse",
    "laptop", "backpack", "handbag", "umbrella", "tie", "suitcase", "sports ball", "ball",
    "fork", "knife", "spoon", "banana", "apple", "sandwich", "orange", "broccoli", "carrot",
    "pizza", "donut", "cake", "potted plant", "clock", "vase", "scissors", "teddy bear",
    "hair drier", "toothbrush", "plate", "lamp", "pillow", "towel", "box", "basket", "candle",
    "notebook", "pen", "wallet", "glasses", "hat", "shoe", "jacket", "toy", "helmet", "jar", "pot",
    "pan", "kettle", "tablet", "headphones", "charger", "flashlight",
)  # fmt: skip
FIXED = ("dining table", "couch", "tv", "refrigerator", "microwave", "oven", "sink", "bed")
ROOMS = ("kitchen", "living room", "bedroom", "hallway", "office", "bathroom", "garage", "studio")
WIDTH_M, DEPTH_M = 40.0, 20.0
VIEWER = (0.0, 0.0, 0.0, 0.7071067811865476)
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Plan:
    """The drawn rows before they are records. s spots of six stays, o objects.

    object_of, place_of (s, 6); position (s, 6, 3) in metres; start, end (s, 2, 6) in ms: of both
    passes; category (o,) and paint (o,): numbers. probability (s, 2, 6).
    """

    object_of: Ints
    place_of: Ints
    position: Floats
    start: Ints
    end: Ints
    category: Ints
    paint: Ints
    probability: Floats


def days(places: int) -> int:
    """Return how long the memory is: 4 days of 20 k stays, 200 of a million."""
    return max(4, places // STAYS_A_DAY)


def span_ms(places: int) -> tuple[int, int]:
    """Return the first and the last millisecond of the memory."""
    return T0, T0 + days(places) * DAY_MS


def drawn(places: int, seed: int = 0) -> Plan:
    """Draw a home with so many stays (to the next spot), each with two sightings."""
    draw = np.random.default_rng(seed)
    spots = max(1, places // AT_A_SPOT)
    objects = max(AT_A_SPOT + len(FIXED), places // STAYS_AN_OBJECT)
    weights = 1 / np.arange(1, len(MOVABLE) + 1)
    category = draw.choice(len(MOVABLE), objects, p=weights / weights.sum())
    fixed = max(len(FIXED), objects // 100)
    category[:fixed] = len(MOVABLE) + np.arange(fixed) % len(FIXED)
    object_of = _owners(draw, spots, objects, fixed)
    middle = draw.random((spots, 1, 3)) * (WIDTH_M - 2, DEPTH_M - 2, 1.5) + (1, 1, 0)
    beside = draw.uniform(-1, 1, (spots, AT_A_SPOT, 3)) * (1, 1, 0.3)
    first = T0 + draw.integers(0, days(places), spots) * DAY_MS + _time_of_day(draw, spots)
    again = first + 600_000 + draw.exponential(6 * 3_600_000, spots).astype(np.int64)
    again = np.minimum(again, T0 + days(places) * DAY_MS - 300_000)
    again = np.maximum(again, first + 600_000)
    shift = draw.integers(0, 20_000, (spots, 2, AT_A_SPOT))
    start = np.stack([first, again], axis=1)[:, :, None] + shift
    end = start + np.minimum(draw.exponential(60_000, start.shape), 300_000).astype(np.int64)
    return Plan(
        object_of,
        _places(object_of, first),
        middle + beside,
        start,
        end,
        category,
        draw.integers(0, len(PAINTS), objects),
        draw.beta(6, 2, start.shape).round(3),
    )


def _time_of_day(draw: np.random.Generator, count: int) -> Ints:
    """Return milliseconds from six in the morning UTC on: rounds between 7 and 23 at home."""
    return np.asarray(draw.integers(6 * 3_600_000, 22 * 3_600_000, count))


def _owners(draw: np.random.Generator, spots: int, objects: int, fixed: int) -> Ints:
    """Return who lies at each spot: nobody twice at one, furniture at one spot alone."""
    movable = objects - fixed
    column = np.arange(AT_A_SPOT) * (movable // AT_A_SPOT)  # a sixth of the things a column
    drawn_from = draw.integers(0, max(1, movable // AT_A_SPOT), (spots, AT_A_SPOT))
    owners = fixed + column[None, :] + drawn_from
    owners[: min(fixed, spots), 0] = np.arange(fixed)[:spots]
    return np.asarray(owners)


def _places(object_of: Ints, first: Ints) -> Ints:
    """Return the number of each stay among its object's, by time."""
    flat = object_of.ravel()
    order = np.lexsort((np.repeat(first, AT_A_SPOT), flat))
    sorted_owners = flat[order]
    begins = np.r_[0, np.flatnonzero(np.diff(sorted_owners)) + 1]
    run = np.arange(len(flat)) - np.repeat(begins, np.diff(np.r_[begins, len(flat)]))
    places = np.empty(len(flat), dtype=np.int64)
    places[order] = run
    return places.reshape(object_of.shape)


def name_of(number: int) -> str:
    """Return the id of an object."""
    return f"o{number:06}"


def category_of(number: int) -> str:
    """Return the name of a category."""
    return (MOVABLE + FIXED)[number]


def fill(store: Store, places: int, seed: int = 0, *, at_once: int = 500) -> None:
    """Write the home of a seed into an empty store, in the order of time."""
    for batch in batches(places, seed, at_once):
        store.apply(batch)


def batches(places: int, seed: int = 0, at_once: int = 500) -> Iterator[Batch]:
    """Yield the home: rooms and objects, then the passes of `at_once` spots a batch."""
    plan = drawn(places, seed)
    yield Batch(
        regions=_rooms(),
        recordings=[_recording(places, int(plan.end.max()))],
        meta={"zone": ZONE, "classes": sorted(MOVABLE + FIXED)},
    )
    yield from _objects(plan, seed)
    order = np.argsort(plan.start[:, :, 0].ravel(), kind="stable")
    for at in range(0, len(order), at_once):
        yield _passes(plan, [divmod(int(row), 2) for row in order[at : at + at_once]])


def _rooms() -> list[Region]:
    """Return four rooms on either side."""
    wide, deep = WIDTH_M / 4, DEPTH_M / 2
    return [
        Region(
            room,
            tuple(
                ((k % 4 + right) * wide, (k // 4 + up) * deep)
                for right, up in ((0, 0), (1, 0), (1, 1), (0, 1))
            ),
        )
        for k, room in enumerate(ROOMS)
    ]


def _recording(places: int, last_ms: int) -> RecordingRecord:
    frames = places // 3
    return RecordingRecord("made", "made", "", ZONE, frames, 12 * frames, T0, last_ms, "f", True)


def _objects(plan: Plan, seed: int) -> Iterator[Batch]:
    draw = np.random.default_rng(seed + 1)
    paints = [
        [painted(rgb, draw, light=draw.uniform(0.7, 1.0)) for _ in range(12)]
        for rgb in PAINTS.values()
    ]
    owners = plan.object_of.ravel()
    first = np.full(len(plan.category), np.iinfo(np.int64).max)
    last = np.zeros(len(plan.category), dtype=np.int64)
    np.minimum.at(first, owners, plan.start[:, 0].ravel())
    np.maximum.at(last, owners, plan.end[:, 1].ravel())
    seen = np.flatnonzero(last > 0).tolist()
    for at in range(0, len(seen), 1000):
        yield Batch(
            objects=[
                ObjectRecord(
                    name_of(n),
                    category_of(plan.category[n]),
                    24.0,
                    int(first[n]),
                    int(last[n]),
                    categories=((category_of(plan.category[n]), 24.0),),
                    embedding=paints[plan.paint[n]][int(draw.integers(0, 12))],
                    embedding_model="rgb-8x8x8",
                    extent_m=(1.6, 1.2) if plan.category[n] >= len(MOVABLE) else (0.2, 0.2),
                )
                for n in seen[at : at + 1000]
            ]
        )


def _passes(plan: Plan, passes: list[tuple[int, int]]) -> Batch:
    stays: list[StayRecord] = []
    sightings: list[Sighting] = []
    encounters: list[Encounter] = []
    views: list[View] = []
    for spot, turn in passes:
        if turn == 0:
            stays += [_stay(plan, spot, k) for k in range(AT_A_SPOT)]
        shown = [_sighting(plan, spot, turn, k) for k in range(AT_A_SPOT)]
        sightings += shown
        encounters += [_encounter(a, b) for a, b in zip(shown[::2], shown[1::2], strict=True)]
        x, y, _ = plan.position[spot, 0].tolist()
        begin, end = int(plan.start[spot, turn].min()), int(plan.end[spot, turn].max())
        views.append(View(begin, end, 12, "", "made", x - 2, y, 0.0, 0.5, 5.0))
    return Batch(stays=stays, sightings=sightings, encounters=encounters, views=views)


def _stay(plan: Plan, spot: int, k: int) -> StayRecord:
    x, y, z = plan.position[spot, k].tolist()
    return StayRecord(
        name_of(plan.object_of[spot, k]),
        int(plan.place_of[spot, k]),
        (x, y, z),
        int(plan.start[spot, 0, k]),
        int(plan.end[spot, 1, k]),
        12.0,
        covariance=(0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01),
        seen=12,
    )


def _sighting(plan: Plan, spot: int, turn: int, k: int) -> Sighting:
    x, y, z = plan.position[spot, 0].tolist()  # one look shows all of the spot
    start = int(plan.start[spot, turn, k])
    left = 40.0 + 90.0 * k
    return Sighting(
        name_of(plan.object_of[spot, k]),
        int(plan.place_of[spot, k]),
        start,
        int(plan.end[spot, turn, k]),
        f"f{start - T0}",
        float(plan.probability[spot, turn, k]),
        (left, 200.0, left + 60.0, 290.0),
        None,
        6,
        category_of(plan.category[plan.object_of[spot, k]]),
        "made",
        start,
        (x - 2.0, y, z, *VIEWER),
    )


def _encounter(one: Sighting, other: Sighting) -> Encounter:
    a, b = sorted((one, other), key=lambda s: s.object_id)
    start = max(a.start_ms, b.start_ms)
    return Encounter(
        a.object_id,
        b.object_id,
        a.place,
        b.place,
        start,
        max(start, min(a.end_ms, b.end_ms)),
        f"f{start - T0}",
        a.box,
        b.box,
        min(a.probability, b.probability),
        None,
        4,
        "made",
        a.viewer,
    )
