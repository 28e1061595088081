"""What a recording holds and lacks, before it is taken in: `d3a doctor SOURCE`.

Everything is counted from the reader's own frames, so that what is told is what an ingest would
see; readers that know more (their files, topics, a tf tree) tell it themselves (`Described`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, pairwise
from statistics import median
from typing import Any

import numpy as np

from d3a import images
from d3a.ingesting.intake import EVERYTHING
from d3a.ingesting.sieve import Sieve, Sifted
from d3a.model import BadInput, Frame
from d3a.readers.base import (
    Described,
    Link,
    Outlined,
    Reader,
    RecordingFacts,
    Skipped,
    Stream,
)

SAMPLES = 16
"""So many frames, spread over the recording, have their pictures decoded."""
GAP_STEPS = 10
"""A pause is a gap from so many usual (median) steps on."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A pause between two frames: from when, and how long."""

    start_ms: int
    seconds: float


@dataclass(slots=True)
class Sampled:
    """What the decoded frames showed.

    sizes: (width, height) of pictures. depth_m: the median depth of each depth picture. covered:
    the share of its pixels that have depth. problems: a sentence each.
    """

    pictures: int = 0
    sizes: Counter[tuple[int, int]] = field(default_factory=Counter)
    depth_m: list[float] = field(default_factory=list)
    covered: list[float] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Survey:
    """What there is.

    having: how many frames have each of picture, depth, pose, camera, boxes; and "located": depth,
    pose and camera at once. categories: detections by name. step_s: the median between two frames,
    None below two. coverage: stream name -> share of the frames' time span that it spans.
    """

    facts: RecordingFacts
    frames: Stream
    step_s: float | None
    gaps: tuple[Gap, ...]
    having: dict[str, int]
    detections: int
    positions: int
    embeddings: int
    categories: Counter[str]
    sampled: Sampled
    streams: tuple[Stream, ...]
    coverage: dict[str, float]
    links: tuple[Link, ...]
    skipped: Skipped


def survey(reader: Reader) -> Survey:
    """Look through a recording once, decoding a few pictures of it."""
    counted = _Counted()
    facts = reader.facts
    frames = reader.outline() if isinstance(reader, Outlined) else iter(reader)
    stride = max((facts.frames or 0) // SAMPLES, 1)
    sieve = Sieve(EVERYTHING, was_done=False)
    for sifted in chain(sieve.sift(frames), sieve.rest()):
        if sifted is None:
            continue
        counted.add(sifted)
        if sifted.number % stride == 0 and counted.samples < SAMPLES:
            counted.sample(sifted.frame)
    times = counted.times
    steps = [(b - a) / 1000 for a, b in pairwise(times)]
    step_s = median(steps) if steps else None
    streams = tuple(reader.streams()) if isinstance(reader, Described) else ()
    stream = Stream.of("frames", "frames", times)
    return Survey(
        facts=reader.facts,
        frames=stream,
        step_s=step_s,
        gaps=_gaps(times, step_s),
        having=dict(counted.having),
        detections=counted.detections,
        positions=counted.positions,
        embeddings=counted.embeddings,
        categories=counted.categories,
        sampled=counted.sampled,
        streams=streams,
        coverage={s.name: share for s in streams if (share := _share(s, stream)) is not None},
        links=tuple(reader.links()) if isinstance(reader, Described) else (),
        skipped=_together(reader.skipped, counted.skipped),
    )


class _Counted:
    """Counts of the frames so far."""

    def __init__(self) -> None:
        self.times: list[int] = []
        self.having: Counter[str] = Counter(dict.fromkeys(PARTS, 0))
        self.detections = self.positions = self.embeddings = self.samples = 0
        self.categories: Counter[str] = Counter()
        self.sampled = Sampled()
        self.skipped = Skipped()

    def add(self, sifted: Sifted) -> None:
        """Count a frame; what an ingest would leave out is counted as left out."""
        frame = sifted.frame
        if sifted.why is not None:
            self.skipped.add(sifted.why, frame.name)
            return
        self.times.append(frame.time_ms)
        has = {name: getattr(frame, name) is not None for name in PARTS if name != "located"}
        has["located"] = has["depth"] and has["pose"] and has["camera"]
        self.having.update(name for name, is_there in has.items() if is_there)
        for detection in frame.detections or ():
            self.detections += 1
            self.positions += detection.position is not None
            self.embeddings += detection.embedding is not None
            self.categories[detection.category] += 1

    def sample(self, frame: Frame) -> None:
        """Decode a frame's pictures and say what is wrong with them."""
        self.samples += 1
        size = self._picture(frame)
        if frame.depth is None:
            return
        try:
            depth = images.decode_depth(frame.depth, frame.depth_scale)
        except BadInput as error:
            self.sampled.problems.append(f"depth of {frame.name}: {error}")
            return
        if size is not None and depth.shape != (size[1], size[0]):
            wrong = f"{depth.shape[1]} x {depth.shape[0]}"
            self.sampled.problems.append(
                f"depth of {frame.name}: {wrong}, and the picture is {size[0]} x {size[1]}"
            )
        measured = depth[depth > 0]
        self.sampled.covered.append(float(np.mean(depth > 0)))
        if len(measured):
            self.sampled.depth_m.append(float(np.median(measured)))

    def _picture(self, frame: Frame) -> tuple[int, int] | None:
        if frame.image is None:
            return None
        try:
            pixels = images.decode(frame.image)
        except BadInput as error:
            self.sampled.problems.append(f"picture of {frame.name}: {error}")
            return None
        size = (pixels.shape[1], pixels.shape[0])
        self.sampled.pictures += 1
        self.sampled.sizes[size] += 1
        camera = frame.camera
        if camera is not None and (camera.width, camera.height) != size:
            self.sampled.problems.append(
                f"picture of {frame.name}: {size[0]} x {size[1]}, and the camera's are "
                f"{camera.width} x {camera.height}"
            )
        return size


PARTS = ("image", "depth", "pose", "camera", "detections", "located")


def _gaps(times: Sequence[int], step_s: float | None) -> tuple[Gap, ...]:
    """Return the pauses that are far longer than the usual step, the longest first."""
    if step_s is None:
        return ()
    found = (Gap(a, (b - a) / 1000) for a, b in pairwise(times))
    longer = [gap for gap in found if gap.seconds >= GAP_STEPS * step_s]
    return tuple(sorted(longer, key=lambda gap: (-gap.seconds, gap.start_ms)))


def _share(stream: Stream, frames: Stream) -> float | None:
    """Return how much of the frames' time a stream spans, None where one has no span."""
    ends = (stream.first_ms, stream.last_ms, frames.first_ms, frames.last_ms)
    first, last, start, end = ends
    if first is None or last is None or start is None or end is None or end <= start:
        return None
    return max(min(last, end) - max(first, start), 0) / (end - start)


def _together(*parts: Skipped) -> Skipped:
    whole = Skipped()
    for part in parts:
        whole.join(part)
    return whole


@dataclass(frozen=True, slots=True)
class Lack:
    """Something that is not there: what that costs, and what would do. needed: to ingest at all."""

    what: str
    cost: str
    remedy: str
    needed: bool = False


_COSTS = {
    "image": (
        "pictures",
        "no keyframe to show, no colours, and look-alikes are told apart by place and name alone",
        "record the camera's pictures",
    ),
    "pose": (
        "poses",
        "where things were cannot be told; they are told apart by look and name alone",
        "add a table of camera poses (poses=FILE: time x y z qx qy qz qw)",
    ),
    "depth": (
        "depth",
        "positions come from the pose alone: half way to 2.5 m before the camera, and no sizes",
        "record aligned depth, or give positions with the boxes",
    ),
    "camera": (
        "the camera's intrinsics",
        "positions are the robot's own place, however far the thing is",
        "add camera.json (fx, fy, cx, cy), or camera=fx,fy,cx,cy",
    ),
}
PLAUSIBLE_M = (0.4, 20.0)
"""Median depth of a picture indoors: depth cameras measure from about 0.4 m on, and rooms end.
Another one tells of a wrong scale."""


def lacks(found: Survey) -> Iterator[Lack]:
    """Yield what is missing, the worst first."""
    total = found.frames.count
    if total == 0:
        yield Lack("frames with a time", "nothing can be taken in", "see what was left out", True)
        return
    if not found.having["detections"]:
        yield Lack(
            "boxes of a detector",
            "nothing to remember before a detector has looked",
            "ingest with --detector model.onnx, or put detections.jsonl beside",
            needed=True,
        )
    told = found.detections > 0 and found.positions == found.detections
    for part, (what, cost, remedy) in _COSTS.items():
        has = found.having[part]
        if told and part == "pose":
            cost = "where the robot looked is not known, so it cannot say that a thing was gone"
        if has < total and not (told and part in ("depth", "camera")):
            share = "" if has == 0 else f" in {total - has} of {total} frames"
            yield Lack(f"{what}{share}", cost, remedy)
    if found.facts.zone is None:
        yield Lack("a time zone", "times are said in this machine's", "--zone Europe/Berlin")
    if not found.facts.classes:
        yield Lack(
            "the detector's list of classes",
            "a word it cannot know is not told from a thing that was never seen",
            "ingest with --detector, or `classes` in recording.json",
        )
    yield from _doubts(found)


def _doubts(found: Survey) -> Iterator[Lack]:
    """Yield what is there and cannot be right."""
    middle = median(found.sampled.depth_m) if found.sampled.depth_m else None
    if middle is not None and not PLAUSIBLE_M[0] <= middle <= PLAUSIBLE_M[1]:
        yield Lack(
            f"a plausible depth: {middle:.2g} m in the middle",
            "positions are as far off as the scale is",
            "tell the counts a metre (depth-scale=1000 for millimetres)",
        )
    for stream in found.streams:
        share = found.coverage.get(stream.name, 1.0)
        if stream.spans and share < 0.9:
            yield Lack(
                f"{stream.kind} for {1 - share:.0%} of the time ({stream.name})",
                f"frames of that time go without {stream.kind}",
                "check that both clocks are the same",
            )


def to_json(found: Survey) -> dict[str, Any]:
    """Return the survey as JSON; times are UTC milliseconds."""
    facts, sampled = found.facts, found.sampled
    return {
        "recording": facts.name,
        "site": facts.site,
        "zone": facts.zone,
        "notes": list(facts.notes),
        "frames": _stream_json(found.frames) | {"having": found.having},
        "step_s": found.step_s,
        "gaps": [{"start_ms": g.start_ms, "seconds": g.seconds} for g in found.gaps],
        "detections": {
            "count": found.detections,
            "with_position": found.positions,
            "with_embedding": found.embeddings,
            "categories": dict(found.categories.most_common()),
        },
        "sampled": {
            "pictures": sampled.pictures,
            "sizes": [[*size, count] for size, count in sampled.sizes.most_common()],
            "depth_m": median(sampled.depth_m) if sampled.depth_m else None,
            "depth_covered": median(sampled.covered) if sampled.covered else None,
            "problems": sampled.problems,
        },
        "streams": [
            _stream_json(s) | {"covers": found.coverage.get(s.name)} for s in found.streams
        ],
        "tf": [
            {"parent": k.parent, "child": k.child, "is_fixed": k.is_fixed, "count": k.count}
            for k in found.links
        ],
        "skipped": [
            {"reason": reason, "count": count, "examples": found.skipped.examples.get(reason, [])}
            for reason, count in sorted(found.skipped.counts.items())
        ],
        "lacks": [
            {"what": k.what, "cost": k.cost, "remedy": k.remedy, "needed": k.needed}
            for k in lacks(found)
        ],
    }


def _stream_json(stream: Stream) -> dict[str, Any]:
    return {
        "name": stream.name,
        "kind": stream.kind,
        "count": stream.count,
        "first_ms": stream.first_ms,
        "last_ms": stream.last_ms,
        "rate_hz": stream.rate_hz,
        "longest_gap_s": stream.longest_gap_s,
    }
