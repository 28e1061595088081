"""From a frame of a recording to a scene for the tiers: pictures, boxes, embeddings, places.

Paper: "Pre-processing each frame". What is broken is counted and left out, the rest goes on.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from time import perf_counter, process_time

from d3a import images
from d3a.detectors.base import BatchDetector, Detector
from d3a.embedders.base import Embedder, looks_in
from d3a.geometry import Metres, clip_box, locate
from d3a.images import Pixels
from d3a.ingesting.intake import EVERYTHING, THING_OFF_LIMITS, Intake
from d3a.model import BadInput, Detection, Frame, Image, Position
from d3a.parameters import Parameters
from d3a.readers.base import Skipped
from d3a.sightings import FrameRef, Scene
from d3a.store.limits import MAX_XY_M, MAX_Z_M

STAGES = ("read", "decode", "detect", "embed", "tiers", "store")
BROKEN_PICTURE = "broken picture"
NO_PICTURE = "no picture for the detector to look at"
BROKEN_DEPTH = "broken depth picture"
TOO_FAR = "position outside of the map's limits, which is then not used"
OTHER_CAMERA = "picture of another size than the camera's, which is then not used"
NO_CAMERA = "depth without the camera's intrinsics, which is then not used"
WEAK = "detection below the least probability"
OUTSIDE = "box outside of the picture"


def ignored(category: str) -> str:
    """Return the reason for which a thing of an ignored category is left out."""
    return f"ignored: {category}"


@dataclass(slots=True)
class Stopwatch:
    """Seconds spent by stage: by the clock, and of this process's processor time."""

    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(STAGES, 0.0))
    processor: dict[str, float] = field(default_factory=lambda: dict.fromkeys(STAGES, 0.0))

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count the time inside of the `with` for a stage."""
        start, spent = perf_counter(), process_time()
        try:
            yield
        finally:
            self.seconds[name] += perf_counter() - start
            self.processor[name] += process_time() - spent


@dataclass(frozen=True, slots=True)
class Replaces:
    """What of a recording is not used: its boxes, or its embeddings."""

    boxes: bool = False
    embeddings: bool = False

    def without(self, frame: Frame) -> Frame:
        """Return the frame without what is not used."""
        if self.boxes:
            return replace(frame, detections=None)
        if self.embeddings and frame.detections is not None:
            plain = tuple(replace(each, embedding=None) for each in frame.detections)
            return replace(frame, detections=plain)
        return frame


NOTHING = Replaces()


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A detection that never reached the tiers, and why."""

    detection: Detection
    why: str


@dataclass(frozen=True, slots=True)
class _Seen:
    """A frame as the detector gets it, with its pixels, depth, and whether its picture is sound."""

    frame: Frame
    pixels: Pixels | None
    depth: Metres | None
    has_picture: bool


@dataclass(frozen=True, slots=True)
class Prepared:
    """A scene, its picture as it may be kept (None without), and what was left out of it."""

    scene: Scene
    picture: Image | None
    left_out: tuple[LeftOut, ...]


class Preparation:
    """Makes scenes of frames.

    embedder: of detections that have no embedding; None leaves them without. replaces: recorded
    boxes and embeddings that are not wanted, as a detector or an embedder was asked for.
    """

    def __init__(
        self,
        detector: Detector,
        parameters: Parameters,
        *,
        recording: str,
        min_probability: float,
        embedder: Embedder | None,
        stopwatch: Stopwatch,
        intake: Intake = EVERYTHING,
        replaces: Replaces = NOTHING,
    ) -> None:
        self._detector = detector
        self._parameters = parameters
        self._recording = recording
        self._min_probability = min_probability
        self._embedder = embedder
        self._replaces = replaces
        self._stopwatch = stopwatch
        self._intake = intake

    @property
    def batch(self) -> int:
        """How many frames the detector is best shown at once."""
        return self._detector.batch if isinstance(self._detector, BatchDetector) else 1

    def prepare_all(self, frames: Sequence[Frame], skipped: Sequence[Skipped]) -> list[Prepared]:
        """Return the scenes of frames that are looked at together.

        skipped: of each its own; what is broken in it is added there.
        """
        if not frames:
            return []
        with self._stopwatch.stage("decode"):
            each_seen = [self._seen(*pair) for pair in zip(frames, skipped, strict=True)]
        with self._stopwatch.stage("detect"):
            found = self._detected(each_seen)
        return [
            self._prepared(seen, detections, counted)
            for seen, detections, counted in zip(each_seen, found, skipped, strict=True)
        ]

    def _seen(self, frame: Frame, skipped: Skipped) -> _Seen:
        frame = self._replaces.without(_within_the_map(frame, skipped))
        pixels, has_picture = self._picture(frame, skipped)
        # a broken picture may be why its camera is not known, and is counted itself
        is_sound = has_picture or frame.image is None
        if frame.depth is not None and frame.camera is None and is_sound:
            skipped.add(NO_CAMERA, frame.name)
        frame = _with_its_camera(frame, pixels, skipped)
        return _Seen(frame, pixels, self._depth(frame, pixels, skipped), has_picture)

    def _detected(self, each_seen: Sequence[_Seen]) -> list[tuple[Detection, ...]]:
        detector = self._detector
        if isinstance(detector, BatchDetector):
            return detector.detect_all(
                [seen.frame for seen in each_seen], [seen.pixels for seen in each_seen]
            )
        return [detector.detect(seen.frame, seen.pixels) for seen in each_seen]

    def _prepared(
        self, seen: _Seen, detections: tuple[Detection, ...], skipped: Skipped
    ) -> Prepared:
        frame, pixels, depth = seen.frame, seen.pixels, seen.depth
        with self._stopwatch.stage("embed"):
            detections = tuple(_near(d, frame.name, skipped) for d in detections)
            kept, left_out = self._usable(frame, detections, pixels, skipped)
            if self._embedder is not None and pixels is not None:
                own = self._parameters.own_pixels
                kept = _embedded(self._embedder, kept, pixels, own_pixels=own)
            kept = [locate(d, frame.pose, frame.camera, depth, self._parameters) for d in kept]
            kept, off_limits = self._allowed(frame, kept, skipped)
            left_out += off_limits
        picture = frame.image if seen.has_picture else None
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
            if self._replaces.boxes:
                skipped.add(NO_PICTURE, frame.name)
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
        return self._embedder is not None and any(d.embedding is None for d in frame.detections)

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


def _embedded(
    embedder: Embedder, found: list[Detection], pixels: Pixels, *, own_pixels: bool
) -> list[Detection]:
    """Return the detections, each with an embedding of unit length; those that have one keep it."""
    bare = [number for number, each in enumerate(found) if each.embedding is None]
    if not bare:
        return found
    vectors = images.unit(
        looks_in(embedder, pixels, [found[n].box for n in bare], own_pixels=own_pixels)
    )
    whole = list(found)
    for number, vector in zip(bare, vectors, strict=True):
        whole[number] = replace(found[number], embedding=vector)
    return whole
