"""What of a recording is taken in: since when, each which frame, and what is never stored.

An ignored category and an off-limits place leave no record, no look and no view; their boxes are
painted over in the pictures that are kept, and a picture from inside of such a place is not kept.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from d3a.geometry import rotation
from d3a.images import Pixels
from d3a.model import BadInput, Box, Camera, Frame, Json, Pose
from d3a.store.base import Batch, Region, Store

META = "intakes"
"""Where the store keeps how each recording was taken in, by the recording's key."""
NOT_YET = "frame before the time to begin at (--since)"
NOT_EACH = "frame between those to take (--every)"
IN_OFF_LIMITS = "frame taken in an off-limits place"
NOWHERE = "frame without a pose, which may be of an off-limits place"
THING_OFF_LIMITS = "detection in an off-limits place"
GREY = 96
"""What is painted over what must not be kept."""


@dataclass(frozen=True, slots=True)
class Intake:
    """Which frames and detections go in.

    since_ms: no frame before. every: the frames number 0, n, 2n... of the recording. ignore:
    categories, in any case. off_limits: places; one without a polygon is a region of the recording
    or of the store, by its name.
    """

    since_ms: int | None = None
    every: int = 1
    ignore: frozenset[str] = frozenset()
    off_limits: tuple[Region, ...] = ()

    def __post_init__(self) -> None:
        if self.every < 1:
            raise BadInput(f"every {self.every} must be 1 or more")
        object.__setattr__(self, "ignore", frozenset(word.casefold() for word in self.ignore))

    def to_json(self) -> Json:
        """Return the fields as JSON, for the store's record of how it was filled."""
        return {
            "since_ms": self.since_ms,
            "every": self.every,
            "ignore": sorted(self.ignore),
            "off_limits": sorted(
                [place.name, *map(list, place.polygon)] for place in self.off_limits
            ),
        }

    def why_not(self, number: int, time_ms: int) -> str | None:
        """Return why a frame is not asked for, None where it is; number: from 0."""
        if self.since_ms is not None and time_ms < self.since_ms:
            return NOT_YET
        return NOT_EACH if number % self.every else None

    def why_off_limits(self, frame: Frame) -> str | None:
        """Return why a whole frame must not be stored, None where it may be.

        Where places are off limits, a frame that does not know where it is may be of one.
        """
        if not self.off_limits:
            return None
        if frame.pose is None:
            return NOWHERE
        return IN_OFF_LIMITS if self.holds(frame.pose.position) else None

    def ignores(self, category: str) -> bool:
        """Say whether things of the category are never stored."""
        return category.casefold() in self.ignore

    def holds(self, position: Sequence[float] | None) -> bool:
        """Say whether a place in the map is off limits; one that is not known is not."""
        if position is None:
            return False
        x, y = np.array([position[0]]), np.array([position[1]])
        return any(bool(inside(place.polygon, x, y)[0]) for place in self.off_limits)

    def painted(
        self,
        pixels: Pixels,
        boxes: Iterable[Box],
        depth: NDArray[np.float32] | None,
        pose: Pose | None,
        camera: Camera | None,
    ) -> Pixels:
        """Return a copy of the picture without the boxes, and without what depth puts off limits.

        A pixel without depth is only painted where it is in a box.
        """
        kept = pixels.copy()
        for x1, y1, x2, y2 in boxes:
            kept[max(int(y1), 0) : int(np.ceil(y2)), max(int(x1), 0) : int(np.ceil(x2))] = GREY
        if depth is not None and pose is not None and camera is not None:
            kept[self._seen_off_limits(depth, pose, camera)] = GREY
        return kept

    def _seen_off_limits(
        self, depth: NDArray[np.float32], pose: Pose, camera: Camera
    ) -> NDArray[np.bool_]:
        """Return which pixels (h, w) show an off-limits place, by depth."""
        hidden = np.zeros(depth.shape, dtype=bool)
        if not self.off_limits:
            return hidden
        rows, columns = np.nonzero(depth > 0)
        z = depth[rows, columns].astype(np.float64)
        rays = np.stack(
            [(columns - camera.cx) / camera.fx * z, (rows - camera.cy) / camera.fy * z, z]
        )
        places = rotation(pose) @ rays + np.array(pose.position)[:, None]
        for place in self.off_limits:
            hidden[rows, columns] |= inside(place.polygon, places[0], places[1])
        return hidden


EVERYTHING = Intake()


def inside(
    polygon: Sequence[tuple[float, float]], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return which points (n,) lie in a polygon, by the crossings of a ray to the right."""
    odd = np.zeros(len(x), dtype=bool)
    for (x1, y1), (x2, y2) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        crosses = (y1 > y) != (y2 > y)
        if y1 != y2:
            odd ^= crosses & (x < (x2 - x1) * (y - y1) / (y2 - y1) + x1)
    return odd


def placed(intake: Intake, known: Iterable[Region]) -> Intake:
    """Return the intake with a polygon for each of its places.

    known: the recording's and the store's regions. Raises BadInput for a name that none has.
    """
    polygons = {region.name.casefold(): region for region in known}
    places = []
    for place in intake.off_limits:
        found = place if place.polygon else polygons.get(place.name.casefold())
        if found is None:
            near = difflib.get_close_matches(place.name.casefold(), polygons, n=1)
            there = ", ".join(sorted(r.name for r in polygons.values())) or "none"
            hint = f" Did you mean {polygons[near[0]].name}?" if near else ""
            raise BadInput(
                f"there is no region {place.name!r} to be off limits; there are {there}.{hint} "
                'A polygon in metres would do too: "0,0 4,0 4,3"'
            )
        places.append(Region(found.name, found.polygon))
    return Intake(intake.since_ms, intake.every, intake.ignore, tuple(places))


def off_limits_of(text: str) -> Region:
    """Return a place as a person writes it: a region's name, or corners "x,y x,y x,y" in metres."""
    parts = text.split()
    corners = [part.split(",") for part in parts]
    if not parts or any(len(corner) != 2 for corner in corners):
        return Region(text.strip(), ())
    try:
        polygon = tuple((float(x), float(y)) for x, y in corners)
    except ValueError as error:
        raise BadInput(f"{text!r} is no polygon: corners x,y in metres, three or more") from error
    if len(polygon) < 3 or not np.isfinite(polygon).all():
        raise BadInput(f"{text!r} is no polygon: corners x,y in metres, three or more")
    return Region(text.strip(), polygon)


def check_known(intake: Intake, classes: Sequence[str]) -> None:
    """Raise BadInput for an ignored category that the detector does not have: a slip would store.

    classes: () where they are not known; then nothing can be checked.
    """
    known = {name.casefold(): name for name in classes}
    for word in sorted(intake.ignore - known.keys()) if known else ():
        near = difflib.get_close_matches(word, known, n=1)
        hint = f" Did you mean {known[near[0]]}?" if near else ""
        raise BadInput(f"the detector has no category {word!r} to ignore.{hint}")


def agree(intake: Intake, store: Store, key: str, detector: str = "") -> None:
    """Note how a recording is taken in; BadInput where a part of it was taken in otherwise.

    detector: what made its boxes, "" for those that came with it.
    """
    noted = store.meta(META) or {}
    was = noted.get(key, EVERYTHING.to_json())
    now = intake.to_json() | ({"detector": detector} if detector else {})
    if was == now:
        return
    known = next((record for record in store.recordings() if record.key == key), None)
    if known is not None:
        differing = ", ".join(
            f"{_option(name)} {_said(name, was)}, not {_said(name, now)}"
            for name in {**now, **was}
            if was.get(name) != now.get(name)
        )
        raise BadInput(
            f"the recording {known.name!r} was taken in with {differing}: say the same again, or "
            "use another store"
        )
    others = {name: value for name, value in noted.items() if name != key}
    store.apply(Batch(meta={META: {**others, key: now}}))


def _said(name: str, noted: Json) -> str:
    value = noted.get(name)
    if isinstance(value, list):
        return _listed([str(each[0] if isinstance(each, list) else each) for each in value])
    if value is None:
        return "recorded" if name == "detector" else "none"
    if name == "since_ms" and isinstance(value, int):
        return datetime.fromtimestamp(value / 1000, UTC).isoformat(timespec="milliseconds")
    return str(value)


def _listed(words: Sequence[str]) -> str:
    return " and ".join(words) or "none"


def _option(name: str) -> str:
    """Return how a person says it: since_ms is --since."""
    return "--" + name.removesuffix("_ms").replace("_", "-")
