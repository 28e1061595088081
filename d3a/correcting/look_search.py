"""Searching pictures for a look: windows that hold the colours of a box in their shares.

What is in the box more than around it and in the home's pictures is its look (log ratio of colour
shares; Swain and Ballard's histogram intersection over those colours alone). Each picture is
searched for windows that hold those colours in those shares. A thing is at one place in a picture,
so the best window that does not touch the best is a look-alike at most: what such runners-up reach,
over all pictures, is how well chance does here, and a find must do better. A look that is common in
the home finds nothing but itself. It is told by colour alone: no shape, no size in metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from d3a.correcting.corrections import UnknownThing
from d3a.model import BadInput, Box, Json
from d3a.store.base import Keyframe, Store

COLOURS = 12
"""So many colours of the box are looked for: those that tell most."""
SCALES = (0.6, 0.8, 1.0, 1.25, 1.6)
LEVEL = 0.99
"""Share of the runners-up that a find must do better than."""
CLOSE = 0.95
"""Two windows whose likenesses differ by less are as like the box."""
LEAST_SIDE, FINE_SIDE = 4, 32
"""Pixels: a smaller box holds no look; from `FINE_SIDE` on every other pixel is enough."""
_SHARE = 1e-3
"""What a colour that was never seen counts as, of all pixels."""
_Plane = NDArray[np.int32]
_Bins = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Find:
    """Where a look was found. likeness: 0..1, 1 for the very box. box: pixels of the frame."""

    image: str
    box: Box
    likeness: float


@dataclass(frozen=True, slots=True)
class Look:
    """What a box looks like, to be found in pictures that are yet to come.

    shares: of all 512 colours in the box. colours: those looked for (k,); worth: what each tells.
    size: of the box, in cells of `step` pixels of the stored picture. level: a find does better.
    """

    shares: NDArray[np.float64]
    colours: _Bins
    worth: NDArray[np.float64]
    size: tuple[float, float]
    step: int
    level: float = 0.0

    @property
    def wanted(self) -> NDArray[np.float64]:
        """The shares of the colours looked for, in the box (k,)."""
        return np.asarray(self.shares[self.colours])

    def to_json(self) -> Json:
        """Return it as a store keeps it; `of_json` gives the very same."""
        held = np.flatnonzero(self.shares)
        return {
            "shares": [[int(colour), float(self.shares[colour])] for colour in held],
            "worth": [[int(c), float(w)] for c, w in zip(self.colours, self.worth, strict=True)],
            "size": list(self.size),
            "step": self.step,
            "level": self.level,
        }

    @classmethod
    def of_json(cls, record: Json) -> Look:
        """Return what `to_json` wrote."""
        shares = np.zeros(512)
        for colour, share in record["shares"]:
            shares[colour] = share
        width, height = record["size"]
        return cls(
            shares,
            np.array([colour for colour, _ in record["worth"]], dtype=np.intp),
            np.array([worth for _, worth in record["worth"]]),
            (width, height),
            record["step"],
            record["level"],
        )


def search(store: Store, image: str, box: Box) -> tuple[Look, list[Find]]:
    """Return the look of a box, and where it is in the stored pictures, the box itself first.

    Raises UnknownThing for a picture that is not there, BadInput for a box without a look.
    """
    shown = store.keyframe(image)
    if shown is None:
        raise UnknownThing(f"the store holds no picture {image!r}")
    step, bins = _bins_of(shown, box)
    inner = _inside(box, shown, bins.shape)
    pictures = {key: _strided(store, key, step) for key in store.keyframe_keys()}
    home = np.full(512, 1.0)
    for each in pictures.values():
        if each is not None:
            home += np.bincount(each.ravel(), minlength=512)
    look = _look(bins, inner, home / home.sum(), step)
    finds, runners = [], []
    for key, each in pictures.items():
        if each is None:
            continue
        best, second = _best_two(each, look)
        runners.append(second)
        if best is not None and key != image and second < CLOSE * best[0]:
            finds.append((best[0], key, best[1]))
    look = replace(look, level=float(np.quantile(runners, LEVEL)))
    kept = [
        found
        for score, key, at in sorted(finds, reverse=True)
        if score > look.level and (found := _found(store.keyframe(key), score, at, step))
    ]
    return look, [Find(image, box, 1.0), *kept]


class Searched:
    """One picture, decoded once for all the looks that are searched for in it."""

    def __init__(self, picture: Keyframe) -> None:
        self._picture = picture
        self._bins: dict[int, _Bins | None] = {}

    def find(self, look: Look) -> Find | None:
        """Return where a look is in the picture; None where it is not, or it is damaged."""
        if look.step not in self._bins:
            self._bins[look.step] = _quantised(self._picture, look.step)
        bins = self._bins[look.step]
        if bins is None:
            return None
        best, second = _best_two(bins, look)
        if best is None or best[0] <= look.level or second >= CLOSE * best[0]:
            return None
        return _found(self._picture, *best, look.step)


def _strided(store: Store, key: str, step: int) -> _Bins | None:
    picture = store.keyframe(key)
    return None if picture is None else _quantised(picture, step)


def _quantised(picture: Keyframe, step: int) -> _Bins | None:
    """Return each pixel's colour of 512, every `step`-th; None for a damaged picture."""
    from d3a import images  # loads OpenCV, which a question does without

    try:
        return images.bins(images.decode(picture.jpeg)[::step, ::step])
    except BadInput:
        return None


def _bins_of(shown: Keyframe, box: Box) -> tuple[int, _Bins]:
    x1, y1, x2, y2 = box
    inside = 0 <= x1 < x2 <= shown.width and 0 <= y1 < y2 <= shown.height
    if not all(map(math.isfinite, box)) or not inside:
        raise BadInput(f"the box must lie in the picture of {shown.width} x {shown.height} pixels")
    whole = _quantised(shown, 1)
    if whole is None:
        raise BadInput("the stored picture is damaged")
    scale = whole.shape[1] / shown.width
    side = min(x2 - x1, y2 - y1) * scale
    if side < LEAST_SIDE:
        raise BadInput("the box is too small: a few pixels hold no look")
    step = 2 if side >= FINE_SIDE else 1
    return step, whole[::step, ::step]


def _inside(box: Box, shown: Keyframe, shape: tuple[int, ...]) -> tuple[int, int, int, int]:
    """Return a box in cells of the quantised picture, at least one."""
    across, down = shape[1] / shown.width, shape[0] / shown.height
    x1, y1 = int(box[0] * across), int(box[1] * down)
    return x1, y1, max(round(box[2] * across), x1 + 1), max(round(box[3] * down), y1 + 1)


def _look(
    bins: _Bins, inner: tuple[int, int, int, int], home: NDArray[np.float64], step: int
) -> Look:
    """Return what sets a box apart from what is around it and from the home's pictures."""
    x1, y1, x2, y2 = inner
    width, height = x2 - x1, y2 - y1
    held = np.bincount(bins[y1:y2, x1:x2].ravel(), minlength=512).astype(np.float64)
    left, top = max(x1 - width // 2, 0), max(y1 - height // 2, 0)
    wide = bins[top : y2 + height // 2, left : x2 + width // 2]
    around = np.bincount(wide.ravel(), minlength=512) - held
    shares = held / held.sum()
    others = np.maximum(around / max(around.sum(), 1.0), home)
    told = np.log((shares + _SHARE) / (others + _SHARE))
    gain = shares * np.maximum(told, 0.0)
    colours = np.argsort(-gain, kind="stable")[:COLOURS]
    colours = colours[gain[colours] > 0]
    if gain.sum() < math.log(2.0) / 2:  # half of it doubles nowhere: the box is its background
        raise BadInput(
            "what is in the box has the colours of what is around it, so I could not tell it "
            "apart; draw the box closer around the thing"
        )
    return Look(shares, colours, told[colours], (float(width), float(height)), step)


def _best_two(
    bins: _Bins, look: Look
) -> tuple[tuple[float, tuple[int, int, int, int]] | None, float]:
    """Return the best window with its likeness, and that of the best which does not touch it.

    Windows are compared by the colours that tell; what is found then by all colours too.
    """
    maps = list(_likeness_maps(bins, look))
    if not maps:
        return None, 0.0
    tops = [float(likeness.max()) for likeness, _, _ in maps]
    # a small window in the thing is as like it as one around it: the largest of equals is meant
    widest = max(n for n, top in enumerate(tops) if top >= CLOSE * max(tops))
    best = _window(maps[widest][0], *maps[widest][1:])
    second, runner = 0.0, best[1]
    for likeness, (width, height), step in maps:
        x1, y1, x2, y2 = best[1]
        xs = np.arange(likeness.shape[1]) * step
        ys = np.arange(likeness.shape[0]) * step
        free_x, free_y = (xs + width <= x1) | (xs >= x2), (ys + height <= y1) | (ys >= y2)
        free = np.where(free_y[:, None] | free_x[None, :], likeness, 0.0)
        if free.max() > second:
            second, runner = _window(free, (width, height), step)
    found = best[0] * _alike(bins, best[1], look)
    return (found, best[1]), second * _alike(bins, runner, look)


def _window(
    likeness: NDArray[np.float64], size: tuple[int, int], step: int
) -> tuple[float, tuple[int, int, int, int]]:
    """Return the best of a scale: its likeness, and where it is."""
    y, x = np.unravel_index(int(likeness.argmax()), likeness.shape)
    left, top = int(x) * step, int(y) * step
    return float(likeness[y, x]), (left, top, left + size[0], top + size[1])


def _alike(bins: _Bins, window: tuple[int, int, int, int], look: Look) -> float:
    """Return how alike all colours of a window and the box are: Bhattacharyya's coefficient."""
    x1, y1, x2, y2 = window
    held = np.bincount(bins[y1:y2, x1:x2].ravel(), minlength=512).astype(np.float64)
    return float(np.sqrt(held / held.sum() * look.shares).sum())


def _likeness_maps(
    bins: _Bins, look: Look
) -> Iterator[tuple[NDArray[np.float64], tuple[int, int], int]]:
    """Yield (likeness of each window, its size, the step between windows), a scale at a time."""
    slots = np.zeros(512, dtype=np.intp)
    slots[look.colours] = np.arange(1, len(look.colours) + 1)
    label = slots[bins]
    sums = [_summed(label == slot) for slot in range(1, len(look.colours) + 1)]
    full = float((look.worth * look.wanted).sum())
    for scale in SCALES:
        width, height = (max(LEAST_SIDE, round(side * scale)) for side in look.size)
        if height > bins.shape[0] or width > bins.shape[1]:
            continue
        step = max(1, min(width, height) // 8)
        total = np.zeros((1, 1))
        for plane, wanted, worth in zip(sums, look.wanted, look.worth, strict=True):
            held = (
                plane[height::step, width::step]
                - plane[:-height:step, width::step]
                - plane[height::step, :-width:step]
                + plane[:-height:step, :-width:step]
            )
            total = total + worth * np.minimum(held / (width * height), wanted)
        yield total / full, (width, height), step


def _summed(plane: NDArray[np.bool_]) -> _Plane:
    """Return the sums of all pixels above and to the left: (h + 1, w + 1)."""
    sums = np.zeros((plane.shape[0] + 1, plane.shape[1] + 1), dtype=np.int32)
    sums[1:, 1:] = plane.cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32)
    return sums


def _found(
    picture: Keyframe | None, score: float, at: tuple[int, int, int, int], step: int
) -> Find | None:
    """Return a window as a find, in pixels of the original frame; None for a picture that went."""
    if picture is None:
        return None
    from d3a import images

    width, height = images.size(picture.jpeg)
    across, down = picture.width / width * step, picture.height / height * step
    x1, y1, x2, y2 = at
    right, below = min(x2 * across, picture.width), min(y2 * down, picture.height)
    return Find(picture.key, (x1 * across, y1 * down, right, below), round(min(score, 1.0), 4))
