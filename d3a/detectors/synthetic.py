"""A detector for worlds whose truth is known: perfect, or with a real detector's faults.

It looks at what is truly visible in a frame and gives back boxes. A noisy one misses what is small
or hidden, moves boxes, takes a cup for a bowl, and sees what is not there, all in proportion to
`fnr`, `fpr` and `confusion`; the same Generator state gives the same boxes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from d3a.model import BadInput, Box, Camera, Detection, Position

MIN_SIDE_PX = 2.0

LOOK_ALIKES: Mapping[str, tuple[str, ...]] = {
    "apple": ("bowl",),
    "backpack": ("handbag",),
    "book": ("laptop", "wallet"),
    "bottle": ("vase", "cup"),
    "bowl": ("cup",),
    "cell phone": ("remote", "book"),
    "coffee table": ("bench", "dining table"),
    "couch": ("bed",),
    "cup": ("bowl", "vase"),
    "desk": ("dining table",),
    "dining table": ("desk",),
    "glasses": ("scissors",),
    "handbag": ("backpack",),
    "key": ("scissors",),
    "laptop": ("tv",),
    "microwave": ("oven",),
    "nightstand": ("cabinet",),
    "oven": ("microwave",),
    "remote": ("cell phone",),
    "scissors": ("key",),
    "tv": ("laptop",),
    "vase": ("bottle", "cup"),
    "wallet": ("book",),
    "wardrobe": ("refrigerator",),
}
"""What a detector trained on everyday pictures takes a category for when it errs."""


@dataclass(frozen=True, slots=True)
class VisibleObject:
    """A true object in a frame.

    box: around its visible pixels. visible: the share of it that is in the picture and not hidden,
    0 to 1. distance_m: from the camera. position: of its visible surface in the map frame, as the
    robot believes to stand; None without depth.
    """

    name: str
    category: str
    box: Box
    visible: float = 1.0
    distance_m: float = 1.0
    position: Position | None = None


@dataclass(frozen=True, slots=True)
class Sighted:
    """A detection, and the name of the object that caused it; None for a false one."""

    detection: Detection
    source: str | None


@dataclass(frozen=True, slots=True)
class DetectorNoise:
    """How a detector errs.

    fnr: chance to miss a large, unhidden object; small and hidden ones are missed more often.
    fpr: false boxes per visible object, on average. confusion: chance that an object in plain view
    gets a look-alike's category; doubled where it is hardly seen.
    half_seen_px: the side of a box (geometric mean) at which every other object is missed.
    box_jitter: standard deviation of a box's edges, as a share of its sides, besides one pixel.
    range_noise_m: standard deviation of the position at 1 m, growing with the distance's square as
    a depth camera's does, besides 1 cm.
    """

    fnr: float = 0.04
    fpr: float = 0.015
    confusion: float = 0.02
    half_seen_px: float = 11.0
    box_jitter: float = 0.02
    range_noise_m: float = 0.006
    look_alikes: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: LOOK_ALIKES)

    def __post_init__(self) -> None:
        for name in ("fnr", "fpr", "confusion"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise BadInput(f"{name} {getattr(self, name)} is outside of 0..1")
        if self.half_seen_px <= 0 or self.box_jitter < 0 or self.range_noise_m < 0:
            raise BadInput("half_seen_px must be above 0, box_jitter and range_noise_m not below")


@dataclass(frozen=True, slots=True)
class SyntheticDetector:
    """Boxes from the truth: exact and certain where `noise` is None, else with its faults.

    categories: what false boxes may be called; none are made where it is empty.
    """

    noise: DetectorNoise | None = None
    categories: tuple[str, ...] = ()

    def detect(
        self,
        visible: Sequence[VisibleObject],
        camera: Camera,
        rng: np.random.Generator,
        surface: Callable[[Box], Position | None] = lambda _box: None,
    ) -> tuple[Sighted, ...]:
        """Return what is detected of `visible`, in its order, then the false boxes.

        surface: gives the position of whatever fills a box, by which a false box is located.
        """
        if self.noise is None:
            return tuple(
                Sighted(Detection(seen.category, 1.0, seen.box, seen.position), seen.name)
                for seen in visible
            )
        found = [_look(seen, self.noise, camera, rng) for seen in visible]
        false = _false_boxes(self.categories, self.noise.fpr * len(visible), camera, rng)
        return (
            *(sighted for sighted in found if sighted is not None),
            *(
                Sighted(Detection(category, probability, box, surface(box)), None)
                for category, probability, box in false
            ),
        )


def _look(
    seen: VisibleObject, noise: DetectorNoise, camera: Camera, rng: np.random.Generator
) -> Sighted | None:
    """Return the noisy detection of one object, None where it is missed.

    The random numbers drawn are as many whether or not it is missed, so that one object's luck does
    not change the next one's.
    """
    fate, mistake, choice = rng.random(3)
    score, jitter, error = rng.normal(), rng.normal(size=4), rng.normal(size=3)
    clarity = _clarity(seen, noise.half_seen_px)
    if fate >= (1.0 - noise.fnr) * clarity:
        return None
    category = seen.category
    names = noise.look_alikes.get(category, ())
    probability = 0.36 + 0.58 * clarity + 0.06 * score
    if names and mistake < noise.confusion * (2.0 - clarity):
        category = names[int(choice * len(names))]
        probability *= 0.75  # a detector is less sure where it errs
    box = _jittered(seen.box, jitter, noise.box_jitter, camera)
    position = None
    if seen.position is not None:
        deviation = 0.01 + noise.range_noise_m * seen.distance_m**2
        x, y, z = (float(value) for value in np.add(seen.position, deviation * error))
        position = (x, y, z)
    probability = float(np.clip(probability, 0.25, 0.99))
    return Sighted(Detection(category, probability, box, position), seen.name)


def _clarity(seen: VisibleObject, half_seen_px: float) -> float:
    """Return 0 to 1, how plainly an object is seen, by its size and by what hides it."""
    x1, y1, x2, y2 = seen.box
    side = math.sqrt(max((x2 - x1) * (y2 - y1), 0.0))
    large = 1.0 - math.exp(-math.log(2.0) * (side / half_seen_px) ** 2)
    unhidden = min(max((seen.visible - 0.1) / 0.5, 0.0), 1.0)
    return large * unhidden


def _jittered(
    box: Box, draws: np.ndarray[tuple[int], np.dtype[np.float64]], share: float, camera: Camera
) -> Box:
    """Return the box with each edge moved, inside the picture and at least MIN_SIDE_PX wide."""
    x1, y1, x2, y2 = box
    spread = np.array([x2 - x1, y2 - y1, x2 - x1, y2 - y1]) * share + 0.7
    a, b, c, d = (float(edge) for edge in np.add(box, spread * draws))
    left, right = _span(a, c, camera.width)
    top, bottom = _span(b, d, camera.height)
    return (left, top, right, bottom)


def _span(low: float, high: float, limit: int) -> tuple[float, float]:
    """Return low <= high inside of 0..limit, at least MIN_SIDE_PX apart."""
    start = min(max(min(low, high), 0.0), limit - MIN_SIDE_PX)
    return start, max(min(max(low, high), float(limit)), start + MIN_SIDE_PX)


def _false_boxes(
    categories: Sequence[str], expected: float, camera: Camera, rng: np.random.Generator
) -> list[tuple[str, float, Box]]:
    """Return (category, probability, box) of a Poisson number of things that are not there."""
    if not categories:
        return []
    false = []
    for _ in range(int(rng.poisson(expected))):
        category = categories[int(rng.integers(len(categories)))]
        width, height = rng.uniform(0.05, 0.2, size=2) * (camera.width, camera.height)
        x, y = rng.uniform(size=2) * (camera.width - width, camera.height - height)
        probability = float(0.25 + 0.35 * rng.beta(1.5, 3.0))
        false.append(
            (category, probability, (float(x), float(y), float(x + width), float(y + height)))
        )
    return false
