"""From a frame of a recording to a scene for the tiers: pictures, boxes, embeddings, places.

Paper: "Pre-processing each frame". What is broken is counted and left out, the rest goes on.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from time import perf_counter

from d3a import images
from d3a.detectors.base import Detector
from d3a.geometry import Metres, clip_box, locate
from d3a.images import Pixels
from d3a.intake import EVERYTHING, THING_OFF_LIMITS, Intake
from d3a.model import BadInput, Detection, Frame, Image, Position
from d3a.parameters import Parameters
from d3a.readers.base import Skipped
from d3a.sightings import FrameRef, Scene
from d3a.store.limits import MAX_XY_M, MAX_Z_M

STAGES = ("decode", "embed", "tiers", "store")
BROKEN_PICTURE = "broken picture"
BROKEN_DEPTH = "broken depth picture"
TOO_FAR = "position outside of the map's limits, which is then not used"
OTHER_CAMERA = "picture of another size than the camera's, which is then not used"
WEAK = "detection below the least probability"
OUTSIDE = "box outside of the picture"


def ignored(category: str) -> str:
    """Return the reason for which a thing of an ignored category is left out."""
    return f"ignored: {category}"


@dataclass(slots=True)
class Stopwatch:
    """Seconds spent by stage."""

    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(STAGES, 0.0))

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count the time inside of the `with` for a stage."""
        start = perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += perf_counter() - start


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A detection that never reached the tiers, and why."""

    detection: Detection
    why: str


@dataclass(frozen=True, slots=True)
class Prepared:
    """A scene, its picture as it may be kept (None without), and what was left out of it."""

    scene: Scene
    picture: Image | None
    left_out: tuple[LeftOut, ...]


class Preparation:
    """Makes scenes of frames."""

    def __init__(
        self,
        detector: Detector,
        parameters: Parameters,
        *,
        recording: str,
        min_probability: float,
        computes_embeddings: bool,
        stopwatch: Stopwatch,
        intake: Intake = EVERYTHING,
    ) -> None:
        self._detector = detector
        self._parameters = parameters
        self._recording = recording
        self._min_probability = min_probability
        self._computes_embeddings = computes_embeddings
        self._stopwatch = stopwatch
        self._intake = intake

    def prepare(self, frame: Frame, skipped: Skipped) -> Prepared:
        """Return the frame's scene; what is broken in it is added to `skipped`."""
        frame = _within_the_map(frame, skipped)
        with self._stopwatch.stage("decode"):
            pixels, has_picture = self._picture(frame, skipped)
            frame = _with_its_camera(frame, pixels, skipped)
            depth = self._depth(frame, pixels, skipped)
        with self._stopwatch.stage("embed"):
            detections = self._detector.detect(frame, pixels)
            detections = tuple(_near(d, frame.name, skipped) for d in detections)
            kept, left_out = self._usable(frame, detections, pixels, skipped)
            if self._computes_embeddings and pixels is not None:
                kept = [_embedded(d, pixels) for d in kept]
            kept = [locate(d, frame.pose, frame.camera, depth, self._parameters) for d in kept]
            kept, off_limits = self._allowed(frame, kept, skipped)
            left_out += off_limits
        picture = frame.image if has_picture else None
        if picture is not None:
            picture = self._keepable(frame, picture, pixels, depth, left_out)
        viewer = None
        if frame.pose is not None:
            viewer = (*frame.pose.position, *frame.pose.quaternion)
        image = None if picture is None else f"{self._recording}/{frame.name}"
        ref = FrameRef(frame.name, frame.time_ms, image, viewer, self._recording)
        scene = Scene(ref, tuple(kept), frame.pose, frame.camera, depth)
        return Prepared(scene, picture, tuple(left_out))

    def _picture(self, frame: Frame, skipped: Skipped) -> tuple[Pixels | None, bool]:
        """Return the pixels where anything needs them, and whether there is a sound picture."""
        if frame.image is None:
            return None, False
        try:
            if self._needs_pixels(frame):
                return images.decode(frame.image), True
            images.check(frame.image)
        except BadInput as error:
            skipped.add(BROKEN_PICTURE, f"{frame.name} ({error})")
            return None, False
        return None, True

    def _needs_pixels(self, frame: Frame) -> bool:
        if frame.detections is None or frame.camera is None:
            return True  # a detector has to look; or only the picture knows its size
        return self._computes_embeddings and any(d.embedding is None for d in frame.detections)

    def _depth(self, frame: Frame, pixels: Pixels | None, skipped: Skipped) -> Metres | None:
        if frame.depth is None:
            return None
        try:
            depth = images.decode_depth(frame.depth, frame.depth_scale)
        except BadInput as error:
            skipped.add(BROKEN_DEPTH, f"{frame.name} ({error})")
            return None
        size = _size(frame, pixels)
        if size is not None and depth.shape != (size[1], size[0]):
            skipped.add(BROKEN_DEPTH, f"{frame.name} (not of the picture's size)")
            return None
        return depth

    def _usable(
        self,
        frame: Frame,
        detections: tuple[Detection, ...],
        pixels: Pixels | None,
        skipped: Skipped,
    ) -> tuple[list[Detection], list[LeftOut]]:
        """Return detections that are strong enough and in the picture, boxes cut to it."""
        kept, left_out = [], []
        size = _size(frame, pixels)
        for detection in detections:
            box = detection.box if size is None else clip_box(detection.box, *size)
            if box is None:
                why = OUTSIDE
            elif self._intake.ignores(detection.category):
                why = ignored(detection.category)
            elif detection.probability < self._min_probability:
                why = WEAK
            else:
                kept.append(detection if box == detection.box else replace(detection, box=box))
                continue
            skipped.add(why, f"{frame.name}: {detection.category}")
            left_out.append(LeftOut(detection, why))
        return kept, left_out

    def _allowed(
        self, frame: Frame, located: list[Detection], skipped: Skipped
    ) -> tuple[list[Detection], list[LeftOut]]:
        """Return the detections that are not in an off-limits place, and those that are."""
        kept, left_out = [], []
        for detection in located:
            if self._intake.holds(detection.position):
                skipped.add(THING_OFF_LIMITS, frame.name)
                left_out.append(LeftOut(detection, THING_OFF_LIMITS))
            else:
                kept.append(detection)
        return kept, left_out

    def _keepable(
        self,
        frame: Frame,
        picture: Image,
        pixels: Pixels | None,
        depth: Metres | None,
        left_out: list[LeftOut],
    ) -> Image | None:
        """Return the picture without what must not be stored; None where it cannot be decoded."""
        hidden = [
            each.detection.box
            for each in left_out
            if each.why == THING_OFF_LIMITS or self._intake.ignores(each.detection.category)
        ]
        if not hidden and (depth is None or not self._intake.off_limits):
            return picture
        if pixels is None:
            try:
                pixels = images.decode(picture)
            except BadInput:
                return None  # it was found whole, so its bytes are no picture's: nothing to keep
        return self._intake.painted(pixels, hidden, depth, frame.pose, frame.camera)


def _size(frame: Frame, pixels: Pixels | None) -> tuple[int, int] | None:
    if pixels is not None:
        return pixels.shape[1], pixels.shape[0]
    return None if frame.camera is None else (frame.camera.width, frame.camera.height)


def _is_far(position: Position) -> bool:
    x, y, z = position
    return max(abs(x), abs(y)) >= MAX_XY_M or abs(z) >= MAX_Z_M


def _within_the_map(frame: Frame, skipped: Skipped) -> Frame:
    """Return the frame without a pose that no map has: one slip must not end an ingest."""
    if frame.pose is None or not _is_far(frame.pose.position):
        return frame
    skipped.add(TOO_FAR, f"{frame.name}: the pose")
    return replace(frame, pose=None)


def _near(detection: Detection, frame: str, skipped: Skipped) -> Detection:
    if detection.position is None or not _is_far(detection.position):
        return detection
    skipped.add(TOO_FAR, f"{frame}: {detection.category}")
    return replace(detection, position=None, covariance=None)


def _with_its_camera(frame: Frame, pixels: Pixels | None, skipped: Skipped) -> Frame:
    """Return the frame without a camera that its picture was not taken with."""
    camera = frame.camera
    if pixels is None or camera is None:
        return frame
    height, width = pixels.shape[:2]
    if (camera.width, camera.height) == (width, height):
        return frame
    skipped.add(OTHER_CAMERA, f"{frame.name} ({width} x {height})")
    return replace(frame, camera=None)


def _embedded(detection: Detection, pixels: Pixels) -> Detection:
    if detection.embedding is not None:
        return detection
    return replace(detection, embedding=images.histogram(images.crop(pixels, detection.box)))
