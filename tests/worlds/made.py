"""Small homes built by hand: things with colours, places and times, on any store."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import ClassVar
from zoneinfo import ZoneInfo

import numpy as np
from numpy.typing import NDArray

from d3a.store.base import (
    Batch,
    Encounter,
    ObjectRecord,
    Region,
    Sighting,
    StayRecord,
    Store,
    TaughtName,
    View,
)

ZONE = ZoneInfo("America/New_York")
NOON = datetime(2024, 5, 14, 12, 0, tzinfo=ZONE)  # a Tuesday
NOW = NOON + timedelta(hours=7)
WALL = (170.0, 168.0, 160.0)
PAINTS: dict[str, tuple[float, float, float]] = {
    # picked by eye from a paint shop's chart, not out of the lists that the product reads
    "red": (200, 30, 35),
    "green": (40, 140, 60),
    "blue": (40, 70, 180),
    "yellow": (235, 205, 40),
    "orange": (240, 130, 30),
    "pink": (235, 130, 165),
    "purple": (120, 50, 150),
    "brown": (110, 70, 40),
    "white": (238, 238, 235),
    "grey": (128, 130, 128),
    "black": (25, 25, 27),
}
Rgb = tuple[float, float, float]
Box = tuple[float, float, float, float]
HOUR_MS = 3_600_000
MUG_BOX: Box = (100.0, 100.0, 140.0, 150.0)


def ms(moment: datetime) -> int:
    return round(moment.timestamp() * 1000)


def painted(
    paint: Rgb,
    rng: np.random.Generator,
    *,
    wall: Rgb = WALL,
    light: float = 1.0,
    fill: float = 0.6,
) -> NDArray[np.float32]:
    """Return the histogram of a box: a thing of one paint, shaded, before a wall, with noise."""
    n = 2500
    on_thing = rng.random(n) < fill
    shade = np.where(on_thing, rng.uniform(0.35, 1.05, n), rng.uniform(0.6, 1.0, n))
    linear = np.where(on_thing[:, None], np.array(paint), np.array(wall)) / 255.0
    pixels = 255 * np.clip(linear**2.2 * shade[:, None] * light, 0, 1) ** (1 / 2.2)
    levels = np.clip(pixels + rng.normal(0, 6, (n, 3)), 0, 255).astype(int) // 32
    counts = np.bincount(levels @ np.array([64, 8, 1]), minlength=512).astype(np.float32)
    return np.asarray(counts / np.linalg.norm(counts), dtype=np.float32)


@dataclass
class Home:
    """Collects records; `into` writes them. Times are minutes after noon of 14 May 2024."""

    seed: int = 0
    objects: dict[str, ObjectRecord] = field(default_factory=dict)
    stays: dict[tuple[str, int], StayRecord] = field(default_factory=dict)
    sightings: list[Sighting] = field(default_factory=list)
    encounters: list[Encounter] = field(default_factory=list)
    views: list[View] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    classes: tuple[str, ...] | None = None

    def thing(
        self,
        name: str,
        category: str,
        *,
        paint: str | Rgb | None = None,
        names: Sequence[tuple[str, str | None]] = (),
        extent_m: tuple[float, float] | None = None,
        votes: Sequence[tuple[str, float]] = (),
        tentative: bool = False,
    ) -> None:
        """Add an object; its times follow from its sightings."""
        rng = np.random.default_rng([self.seed, len(self.objects)])
        rgb = PAINTS[paint] if isinstance(paint, str) else paint
        self.objects[name] = ObjectRecord(
            name,
            category,
            1.0,
            ms(NOON),
            ms(NOON),
            categories=tuple(votes),
            names=tuple(TaughtName(word, owner) for word, owner in names),
            embedding=painted(rgb, rng) if rgb is not None else None,
            embedding_model="rgb-8x8x8" if rgb is not None else None,
            extent_m=extent_m,
            tentative=tentative,
        )

    def seen(
        self,
        name: str,
        start: float,
        end: float | None = None,
        *,
        at: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
        place: int = 0,
        probability: float = 0.9,
        times: int = 5,
        box: Box = MUG_BOX,
        sigma: float = 0.05,
        absent: float | None = None,
        moved_from: tuple[int, float] | None = None,
        viewer: tuple[float, ...] | None = None,
    ) -> None:
        """Add a sighting of an object at a place, from minute to minute."""
        first, last = self.minute(start), self.minute(start if end is None else end)
        variance = sigma**2
        before = self.stays.get((name, place))
        self.stays[name, place] = StayRecord(
            name,
            place,
            at,
            min(first, before.first_ms if before else first),
            max(last, before.last_ms if before else last),
            1.0,
            covariance=(variance, 0, 0, 0, variance, 0, 0, 0, variance) if at else None,
            seen=times + (before.seen if before else 0),
            last_absent_ms=None if absent is None else self.minute(absent),
            moved_from=moved_from,
        )
        for begin in range(first, max(last, first + 1), HOUR_MS):  # the store's limit
            self.sightings.append(
                Sighting(
                    name,
                    place,
                    begin if begin == first else begin + 1,
                    min(begin + HOUR_MS, last),
                    f"{name}-{place}-{start:g}",
                    probability,
                    box,
                    seen=times,
                    viewer=viewer,
                    category=self.objects[name].category,
                )
            )
        self.views.append(View(first, last, times))

    def met(
        self,
        one: str,
        other: str,
        start: float,
        end: float | None = None,
        *,
        boxes: tuple[Box, Box] = (MUG_BOX, (300.0, 100.0, 360.0, 150.0)),
        places: tuple[int, int] = (0, 0),
        viewer: tuple[float, ...] | None = None,
        probability: float = 0.81,
    ) -> None:
        """Add an encounter: one frame shows both, `boxes` in the order of the arguments."""
        a, b = (0, 1) if one < other else (1, 0)
        names = (one, other)
        self.encounters.append(
            Encounter(
                names[a],
                names[b],
                places[a],
                places[b],
                self.minute(start),
                self.minute(start if end is None else end),
                f"both-{start:g}",
                boxes[a],
                boxes[b],
                probability,
                viewer=viewer,
            )
        )

    def room(self, name: str, x_min: float, y_min: float, x_max: float, y_max: float) -> None:
        """Add a rectangular room."""
        corners = ((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max))
        self.regions.append(Region(name, corners))

    def look(self, minute: float, x: float, y: float) -> None:
        """Add a look around at a place where nothing was seen."""
        at = self.minute(minute)
        self.views.append(View(at, at, 1, x=x, y=y, yaw=0.0, half_angle=0.5, range_m=3.0))

    @staticmethod
    def minute(minute: float) -> int:
        return ms(NOON + timedelta(minutes=minute))

    def into(self, store: Store) -> Store:
        """Write everything and return the store."""
        meta = {"zone": "America/New_York"} | (
            {"classes": list(self.classes)} if self.classes is not None else {}
        )
        views = {view.start_ms: view for view in self.views}
        store.apply(
            Batch(
                objects=list(self.objects.values()),
                stays=list(self.stays.values()),
                sightings=self.sightings,
                encounters=self.encounters,
                views=list(views.values()),
                regions=self.regions,
                meta=meta,
            )
        )
        return store


def at(minute: float) -> datetime:
    """Return the time of a minute after noon."""
    return (NOON.astimezone(UTC) + timedelta(minutes=minute)).astimezone(ZONE)


class Words:
    """A lexicon of a few words: a stand-in for the vocabulary where d3a is tested alone."""

    synonyms: ClassVar = {"mug": "cup", "sportsball": "sports ball", "sofa": "couch"}
    wider: ClassVar = {
        "cup": ("drinkware",),
        "sports ball": ("ball", "toy"),
        "couch": ("furniture",),
        "table": ("furniture",),
        "microwave": ("appliance",),
    }

    def canonical(self, word: str) -> str:
        return self.synonyms.get(word, word)

    def broader(self, category: str) -> Sequence[str]:
        return self.wider.get(category, ())

    def narrower(self, category: str) -> Sequence[str]:
        return tuple(word for word, wide in self.wider.items() if category in wide)

    def unlisted_lead(self, word: str) -> str:
        return word.rpartition(" ")[0] if word.startswith("blurple ") else ""

    def is_part(self, word: str) -> bool:
        return word in ("handle", "lid")

    def nearest(self, word: str, among: Sequence[str]) -> Sequence[str]:
        return tuple(sorted(other for other in among if other[:2] == word[:2]))[:3]
