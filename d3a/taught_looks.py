"""A thing that no detector knows, taught by a box on a picture: found again by its colours.

What is in the box more than around it and in the home's pictures is its look (log ratio of colour
shares; Swain and Ballard's histogram intersection over those colours alone). Each stored picture is
searched for windows that hold those colours in those shares. A thing is at one place in a picture,
so the best window that does not touch the best is a look-alike at most: what such runners-up reach,
over all pictures, is how well chance does here, and a find must do better. A look that is common in
the home finds nothing but itself. It is told by colour alone: no shape, no size in metres.

Finds are ordinary records of OIc and STc, at the place of the nearest thing that the detector knew
in the same picture, and tentative but for the one that the person drew.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.answer import BY_LOOK, is_by_look
from d3a.constraints import Correction
from d3a.model import BadInput, Box, Position
from d3a.store.base import (
    Keyframe,
    ObjectRecord,
    Sighting,
    StayRecord,
    Store,
    TaughtName,
)
from d3a.teaching import UnknownThing, commit

COLOURS = 12
"""So many colours of the box are looked for: those that tell most."""
SCALES = (0.6, 0.8, 1.0, 1.25, 1.6)
LEVEL = 0.99
"""Share of the runners-up that a find must do better than."""
CLOSE = 0.95
"""Two windows whose likenesses differ by less are as like the box."""
LEAST_SIDE, FINE_SIDE = 4, 32
"""Pixels: a smaller box holds no look; from `FINE_SIDE` on every other pixel is enough."""
SAME_PLACE_M = 1.0
NEAR_SIGMA_M = 0.7
"""Per axis: how far a thing may be from the nearest one that was placed in its picture."""
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
class _Look:
    """colours: those looked for (k,), wanted: their shares in the box, worth: what each tells.

    shares: of all 512 colours in the box. size: of the box.
    """

    shares: NDArray[np.float64]
    colours: _Bins
    wanted: NDArray[np.float64]
    worth: NDArray[np.float64]
    size: tuple[float, float]


def teach_look(
    store: Store, image: str, box: Box, name: str, owner: str | None = None,
    *, at_ms: int | None = None,
) -> Correction:  # fmt: skip
    """Call what is in a box of a stored picture by a name, and find its look in the others.

    image: key of a keyframe; box: pixels of the original frame. `arguments["found"]` of the result
    counts the pictures with it, `arguments["new"]` is its id. `teaching.undo` takes all of it back.
    Raises UnknownThing for a picture that is not there, BadInput for a box without a look of its
    own, StoreError.
    """
    word = " ".join(name.split()).lower()
    if not word:
        raise BadInput("a name needs a letter or a digit")
    finds = search(store, image, box)
    scene = _Scene(store)

    def make(number: int) -> tuple[Correction, dict[str, Any]]:
        taught = TaughtName(word, owner)
        new, stays, sightings = _records(f"{BY_LOOK}{number}", taught, finds, scene)
        whose = "" if owner is None else "my " if owner == "me" else f"{owner}'s "
        said = f"{new.object_id}, shown by a box, is {whose or 'the '}{word}"
        arguments = {"ids": [new.object_id], "new": new.object_id, "found": len(finds)}
        correction = Correction(number, "look", said, at_ms, arguments)
        return correction, {"objects": [new], "stays": stays, "sightings": sightings}

    return commit(store, make)


def search(store: Store, image: str, box: Box) -> list[Find]:
    """Return where the look of a box is in the stored pictures, the box itself first."""
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
    look = _look(bins, inner, home / home.sum())
    finds, runners = [], []
    for key, each in pictures.items():
        if each is None:
            continue
        best, second = _best_two(each, look)
        runners.append(second)
        if best is not None and key != image and second < CLOSE * best[0]:
            finds.append((best[0], key, best[1]))
    level = float(np.quantile(runners, LEVEL))
    kept = [
        Find(key, _unscaled(at, store, key, step), round(min(score, 1.0), 4))
        for score, key, at in sorted(finds, reverse=True)
        if score > level
    ]
    return [Find(image, box, 1.0), *kept]


def _strided(store: Store, key: str, step: int) -> _Bins | None:
    picture = store.keyframe(key)
    return None if picture is None else _quantised(picture, step)


def _quantised(picture: Keyframe, step: int) -> _Bins | None:
    """Return each pixel's colour of 512, every `step`-th; None for a damaged picture."""
    from d3a import images  # loads OpenCV, which a question does without

    try:
        pixels = images.decode(picture.jpeg)[::step, ::step].astype(np.intp) >> 5
    except BadInput:
        return None
    return np.asarray(pixels[..., 0] * 64 + pixels[..., 1] * 8 + pixels[..., 2])


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


def _look(bins: _Bins, inner: tuple[int, int, int, int], home: NDArray[np.float64]) -> _Look:
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
    return _Look(shares, colours, shares[colours], told[colours], (float(width), float(height)))


def _best_two(
    bins: _Bins, look: _Look
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


def _alike(bins: _Bins, window: tuple[int, int, int, int], look: _Look) -> float:
    """Return how alike all colours of a window and the box are: Bhattacharyya's coefficient."""
    x1, y1, x2, y2 = window
    held = np.bincount(bins[y1:y2, x1:x2].ravel(), minlength=512).astype(np.float64)
    return float(np.sqrt(held / held.sum() * look.shares).sum())


def _likeness_maps(
    bins: _Bins, look: _Look
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


def _unscaled(at: tuple[int, int, int, int], store: Store, key: str, step: int) -> Box:
    """Return a window in pixels of the original frame."""
    picture = store.keyframe(key)
    assert picture is not None  # it was searched a moment ago
    from d3a import images

    width, height = images.size(picture.jpeg)
    across, down = picture.width / width * step, picture.height / height * step
    x1, y1, x2, y2 = at
    right, below = min(x2 * across, picture.width), min(y2 * down, picture.height)
    return (x1 * across, y1 * down, right, below)


class _Scene:
    """What else is known of the store's pictures: when they were taken, what is where in them."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._seen: dict[str, list[Sighting]] = {}
        for sighting in store.sightings():
            if sighting.image is not None and not is_by_look(sighting.object_id):
                self._seen.setdefault(sighting.image, []).append(sighting)
        self._stays = {stay.key: stay for stay in store.stays()}

    def sighting(self, find: Find, key: tuple[str, int]) -> Sighting:
        """Return a find as a sighting of a stay, with the words of its picture."""
        picture = self._store.keyframe(find.image)
        beside = self._seen.get(find.image, [])
        time_ms = picture.time_ms if picture else 0
        base = beside[0] if beside else None
        return Sighting(
            *key, time_ms, time_ms,
            frame=base.frame if base else find.image,
            probability=find.likeness, box=find.box, image=find.image,
            recording=base.recording if base else "",
            keyframe_ms=time_ms, viewer=base.viewer if base else None,
        )  # fmt: skip

    def position(self, find: Find) -> tuple[Position | None, str]:
        """Return where the nearest thing in the picture is, and the site; None where none has."""
        near: list[tuple[float, StayRecord]] = []
        for other in self._seen.get(find.image, []):
            stay = self._stays.get(other.stay)
            if stay is not None and stay.position is not None:
                near.append((_apart(find.box, other.box), stay))
        if not near:
            return None, ""
        stay = min(near, key=lambda each: (each[0], each[1].key))[1]
        return stay.position, stay.site


def _apart(a: Box, b: Box) -> float:
    """Return the pixels between the middles of two boxes' lower edges: where things stand."""
    return math.hypot((a[0] + a[2] - b[0] - b[2]) / 2, a[3] - b[3])


def _records(
    object_id: str, name: TaughtName, finds: Sequence[Find], scene: _Scene
) -> tuple[ObjectRecord, list[StayRecord], list[Sighting]]:
    """Return the records of the finds: an object, a stay for each place, a sighting for each."""
    stays: list[StayRecord] = []
    sightings: dict[tuple[int, int], Sighting] = {}
    for number, find in enumerate(finds):
        position, site = scene.position(find)
        place = next((s.place for s in stays if _is_near(s.position, position)), len(stays))
        sighting = scene.sighting(find, (object_id, place))
        at = sighting.start_ms
        if place == len(stays):
            spread = NEAR_SIGMA_M**2
            covariance = (spread, 0.0, 0.0, 0.0, spread, 0.0, 0.0, 0.0, spread)
            stays.append(
                StayRecord(
                    object_id, place, position, at, at, find.likeness, site,
                    covariance=None if position is None else covariance, tentative=number > 0,
                )
            )  # fmt: skip
        else:
            old = stays[place]
            stays[place] = replace(
                old, first_ms=min(old.first_ms, at), last_ms=max(old.last_ms, at),
                weight=old.weight + find.likeness, seen=old.seen + 1,
            )  # fmt: skip
        sightings.setdefault((place, at), sighting)
    weight = sum(find.likeness for find in finds)
    first, last = min(s.first_ms for s in stays), max(s.last_ms for s in stays)
    new = ObjectRecord(
        object_id, name.word, weight, first, last, stays[0].site,
        categories=((name.word, weight),), names=(name,),
    )  # fmt: skip
    kept = [replace(each, category=name.word) for each in sightings.values()]
    return new, stays, kept


def _is_near(a: Position | None, b: Position | None) -> bool:
    if a is None or b is None:
        return a is b
    return math.dist(a, b) <= SAME_PLACE_M
