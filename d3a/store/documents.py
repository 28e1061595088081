"""Records of OIc and STc, and of what goes with them. Import them from `d3a.store.base`.

Paper: the appendix (two collections). Times are UTC milliseconds, intervals are closed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from d3a.model import Box, Position

StayKey = tuple[str, int]
"""(object_id, place): one object at one location."""
Apart = tuple[float, float, float, float]
"""x, y, z from one thing to another and the deviation of that along each axis, metres."""
LEAST_SIGMA_M = 0.001
"""The least deviation that counts: what is measured is no surer than this."""


@dataclass(frozen=True, slots=True)
class TaughtName:
    """What a person calls an object: "keys" of "anna"; owner None where nobody is named."""

    word: str
    owner: str | None = None


@dataclass(frozen=True, slots=True)
class ObjectRecord:
    """A document of OIc: one object, wherever it was.

    weight: summed detection weight (paper, appendix). categories: (category, weight) votes, the
    heaviest first. extent_m: width, height from depth. tentative: seen too seldom to be sure.
    volatile: still in the STM; replaced or removed when tier 3 has merged it.
    """

    object_id: str
    category: str
    weight: float
    first_ms: int
    last_ms: int
    site: str = ""
    categories: tuple[tuple[str, float], ...] = ()
    names: tuple[TaughtName, ...] = ()
    embedding: NDArray[np.float32] | None = field(default=None, repr=False, compare=False)
    embedding_model: str | None = None
    extent_m: tuple[float, float] | None = None
    tentative: bool = False
    volatile: bool = False


@dataclass(frozen=True, slots=True)
class StayRecord:
    """A document of STc without its intervals: one object at one location.

    position: metres in the map frame, None where nothing told it; covariance: 3 x 3 row-major.
    seen: detections over all intervals. moved_from: (place of the same object, score 0..1).
    last_absent_ms: when the place was last seen without the object, after `last_ms`.
    """

    object_id: str
    place: int
    position: Position | None
    first_ms: int
    last_ms: int
    weight: float
    site: str = ""
    covariance: tuple[float, ...] | None = None
    seen: int = 1
    moved_from: tuple[int, float] | None = None
    last_absent_ms: int | None = None
    tentative: bool = False
    volatile: bool = False

    @property
    def key(self) -> StayKey:
        """(object_id, place)."""
        return self.object_id, self.place


@dataclass(frozen=True, slots=True)
class Sighting:
    """One interval of a stay, with the keyframe that shows it best.

    frame: the recording's own name. image: key of the stored picture, None without one.
    box: pixels of that frame. seen: frames with a detection in the interval.
    viewer: the camera's pose in that frame (x y z qx qy qz qw), None where unknown.
    """

    object_id: str
    place: int
    start_ms: int
    end_ms: int
    frame: str
    probability: float
    box: Box
    image: str | None = None
    seen: int = 1
    category: str = ""
    recording: str = ""
    keyframe_ms: int | None = None
    viewer: tuple[float, ...] | None = None

    @property
    def stay(self) -> StayKey:
        """(object_id, place)."""
        return self.object_id, self.place


@dataclass(frozen=True, slots=True)
class Encounter:
    """Two objects seen in the same frames, over one interval; object_a < object_b.

    frame, image, box_a, box_b, viewer: the frame that shows both best. seen: shared frames.
    apart: x, y, z from a to b as the shared frames measured it, and the deviation of that along
    each, metres. Unlike the places of the two it has no error of the robot's place in it. None
    where nothing was measured.
    """

    object_a: str
    object_b: str
    place_a: int
    place_b: int
    start_ms: int
    end_ms: int
    frame: str
    box_a: Box
    box_b: Box
    probability: float
    image: str | None = None
    seen: int = 1
    recording: str = ""
    viewer: tuple[float, ...] | None = None
    apart: Apart | None = None

    def renamed(self, becomes: Mapping[StayKey, StayKey]) -> Encounter | None:
        """Return the encounter with its stays renamed; None where a thing would meet itself."""
        ends = ((self.object_a, self.place_a), (self.object_b, self.place_b))
        a, b = (becomes.get(stay, stay) for stay in ends)
        if a[0] == b[0]:
            return None
        named = replace(self, object_a=a[0], place_a=a[1], object_b=b[0], place_b=b[1])
        return named if a < b else named._flipped()

    def _flipped(self) -> Encounter:
        apart = self.apart
        return replace(
            self,
            object_a=self.object_b,
            object_b=self.object_a,
            place_a=self.place_b,
            place_b=self.place_a,
            box_a=self.box_b,
            box_b=self.box_a,
            apart=None if apart is None else (-apart[0], -apart[1], -apart[2], apart[3]),
        )

    def is_between(self, ids: Collection[str] | None, others: Collection[str] | None) -> bool:
        """Whether one of the two is of `ids` and the other one of `others`; None: any object."""
        a, b = self.object_a, self.object_b
        return any(
            (ids is None or one in ids) and (others is None or other in others)
            for one, other in ((a, b), (b, a))
        )


@dataclass(frozen=True, slots=True)
class View:
    """Where the robot looked: a sector seen over a time span (coverage).

    x, y: the camera in metres; yaw: heading, radians in the map's ground plane (up axis aside);
    half_angle in radians; range_m: how far it could see. None where the pose is unknown.
    A view is put by (site, recording, start): one that goes on replaces what it was.
    """

    start_ms: int
    end_ms: int
    frames: int
    site: str = ""
    recording: str = ""
    x: float | None = None
    y: float | None = None
    yaw: float | None = None
    half_angle: float | None = None
    range_m: float | None = None


@dataclass(frozen=True, slots=True)
class Region:
    """A named room: a polygon in metres in the map frame, corners (x, y) in order."""

    name: str
    polygon: tuple[tuple[float, float], ...]
    site: str = ""


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A stored picture: JPEG bytes, and the size of the original that boxes refer to."""

    key: str
    jpeg: bytes = field(repr=False)
    width: int
    height: int
    time_ms: int


@dataclass(frozen=True, slots=True)
class RecordingRecord:
    """How far a recording has been ingested, so that a second run adds nothing.

    key: name, first frame and its time. frames: how many are in the store.
    skipped: reason -> count. done: closed, the STM was flushed.
    """

    key: str
    name: str
    site: str
    zone: str | None
    frames: int
    detections: int
    first_ms: int | None
    last_ms: int | None
    last_frame: str | None
    done: bool
    skipped: tuple[tuple[str, int], ...] = ()
