"""Scenes as the tiers take them, and the intervals that views of a thing grow into.

An interval is closed by a pause (`interval_gap_s`) and split where it gets longer than a store
takes (`max_interval_s`). Where it went on over a longer pause it is not split but ends: the next
begins at its own first view, so that it has all of its length before it and says nothing of a time
that no view shows. Its keyframe is the view with the highest probability, the earlier one of equals
(paper, Tier 2).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from d3a.frozen import maker
from d3a.model import Box, Camera, Detection, Json, Pose
from d3a.parameters import Parameters
from d3a.store.base import Sighting, StayKey

Metres = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class FrameRef:
    """What the store keeps of a frame. image: key of its picture; viewer: x y z qx qy qz qw."""

    name: str
    time_ms: int
    image: str | None = None
    viewer: tuple[float, ...] | None = None
    recording: str = ""


@dataclass(frozen=True, slots=True)
class Scene:
    """A frame ready for association: its detections have positions and embeddings.

    Detections are in a fixed order of their own, whatever order the detector gave. depth: metres
    (h, w), None where not recorded.
    """

    ref: FrameRef
    detections: tuple[Detection, ...]
    pose: Pose | None = None
    camera: Camera | None = None
    depth: Metres | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        ordered = sorted(self.detections, key=_own_order)
        object.__setattr__(self, "detections", tuple(ordered))


def _own_order(detection: Detection) -> tuple[object, ...]:
    return (-detection.probability, detection.category, detection.box, detection.row or 0)


@dataclass(frozen=True, slots=True)
class Interval:
    """Views of one thing over a time span, with the best of them; a `Sighting` without its stay."""

    start_ms: int
    end_ms: int
    seen: int
    probability: float
    category: str
    frame: str
    keyframe_ms: int
    box: Box
    image: str | None
    viewer: tuple[float, ...] | None
    recording: str

    @classmethod
    def of(cls, ref: FrameRef, detection: Detection) -> Interval:
        """Return the interval of a single view."""
        return _interval(
            ref.time_ms, ref.time_ms, 1, detection.probability, detection.category, ref.name,
            ref.time_ms, detection.box, ref.image, ref.viewer, ref.recording,
        )  # fmt: skip

    @classmethod
    def from_sighting(cls, sighting: Sighting) -> Interval:
        """Return a stored sighting's interval."""
        return cls(
            start_ms=sighting.start_ms,
            end_ms=sighting.end_ms,
            seen=sighting.seen,
            probability=sighting.probability,
            category=sighting.category,
            frame=sighting.frame,
            keyframe_ms=sighting.start_ms if sighting.keyframe_ms is None else sighting.keyframe_ms,
            box=sighting.box,
            image=sighting.image,
            viewer=sighting.viewer,
            recording=sighting.recording,
        )

    def sighting(self, stay: StayKey) -> Sighting:
        """Return the record of this interval at a stay."""
        object_id, place = stay
        return Sighting(
            object_id=object_id,
            place=place,
            start_ms=self.start_ms,
            end_ms=self.end_ms,
            frame=self.frame,
            probability=self.probability,
            box=self.box,
            image=self.image,
            seen=self.seen,
            category=self.category,
            recording=self.recording,
            keyframe_ms=self.keyframe_ms,
            viewer=self.viewer,
        )

    def grown(self, ref: FrameRef, detection: Detection) -> Interval:
        """Return the interval with a later view of the thing."""
        is_first_picture = self.image is None and ref.image is not None
        if is_first_picture or detection.probability > self.probability:
            shown = (
                detection.probability, detection.category, ref.name, ref.time_ms, detection.box,
                ref.image, ref.viewer, ref.recording,
            )  # fmt: skip
        else:
            shown = (
                self.probability, self.category, self.frame, self.keyframe_ms, self.box,
                self.image, self.viewer, self.recording,
            )  # fmt: skip
        start_ms, end_ms = min(self.start_ms, ref.time_ms), max(self.end_ms, ref.time_ms)
        return _interval(start_ms, end_ms, self.seen + 1, *shown)

    def union(self, other: Interval) -> Interval:
        """Return both as one, with the better keyframe: one with a picture before one without."""
        best = min(self, other, key=lambda each: each.worth)
        return _interval(
            min(self.start_ms, other.start_ms),
            max(self.end_ms, other.end_ms),
            self.seen + other.seen,
            best.probability,
            best.category,
            best.frame,
            best.keyframe_ms,
            best.box,
            best.image,
            best.viewer,
            best.recording,
        )

    @property
    def worth(self) -> tuple[bool, float, int]:
        """The order of keyframes, the best first."""
        return self.image is None, -self.probability, self.keyframe_ms

    def follows_on(self, later: Interval, parameters: Parameters) -> bool:
        """Say whether `later` goes on with this interval: no pause between them."""
        return later.start_ms - self.end_ms <= parameters.interval_gap_s * 1000

    def fits(self, other: Interval, parameters: Parameters) -> bool:
        """Say whether both together are short enough to be one."""
        start, end = min(self.start_ms, other.start_ms), max(self.end_ms, other.end_ms)
        return end - start <= parameters.max_interval_s * 1000

    def to_json(self) -> Json:
        """Return the fields as JSON."""
        return {name: getattr(self, name) for name in INTERVAL_FIELDS}

    @classmethod
    def from_json(cls, record: Json) -> Interval:
        """Return what `to_json` wrote."""
        x1, y1, x2, y2 = record["box"]
        viewer = record["viewer"]
        parts = {"box": (x1, y1, x2, y2), "viewer": None if viewer is None else tuple(viewer)}
        return cls(**(record | parts))


_interval = maker(Interval)
"""Each view of a thing makes one."""
INTERVAL_FIELDS = tuple(f.name for f in fields(Interval))


def joined(
    intervals: Iterable[Interval], parameters: Parameters, bridged_s: float = 0.0
) -> list[Interval]:
    """Return the intervals by time, those without a pause between them made one.

    bridged_s: longer pauses that they go on over. Where one without any would get too long it is
    split: the next part starts a millisecond after the end, so that a reader can join them again.
    """
    bridged_ms = round(max(bridged_s, parameters.interval_gap_s) * 1000)
    result: list[Interval] = []
    for each in sorted(intervals, key=lambda i: (i.start_ms, i.end_ms, i.frame)):
        last = result[-1] if result else None
        if last is None or each.start_ms - last.end_ms > bridged_ms:
            result.append(each)
        elif last.fits(each, parameters):
            result[-1] = last.union(each)
        elif not last.follows_on(each, parameters):
            result.append(each)
        else:
            longest_ms = round(parameters.max_interval_s * 1000)
            start_ms = max(last.end_ms + 1, each.end_ms - longest_ms)
            result.append(replace(each, start_ms=min(start_ms, each.end_ms)))
    return result


@dataclass(frozen=True, slots=True)
class Seen:
    """A detection went into `entry`, a name that the pipeline gives out itself."""

    row: int | None
    frame: str
    box: Box
    entry: str

    def to_json(self) -> Json:
        """Return the event as JSON."""
        return {"row": self.row, "frame": self.frame, "box": list(self.box), "entry": self.entry}


@dataclass(frozen=True, slots=True)
class Became:
    """An entry is from now on (part of) `into`; None: it was left out, `why` says the reason."""

    entry: str
    into: str | None
    why: str | None = None

    def to_json(self) -> Json:
        """Return the event as JSON."""
        return {"became": self.entry, "into": self.into, "why": self.why}


Event = Seen | Became
seen_as = maker(Seen)
"""Makes a `Seen`: there is one for each detection."""


def entry_name(stay: StayKey) -> str:
    """Return the name that events use for a stored stay."""
    return f"{stay[0]}/{stay[1]}"
