"""A bag looked through once: when each message was made, which belong together, and the tf tree.

Everything small is kept (transforms, poses, camera parameters, times); pictures, depth and boxes
are only counted, and read again one by one where they are needed.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from d3a.model import BadInput, Camera
from d3a.readers.base import Skipped
from d3a.readers.ros_bag import Bag, Message
from d3a.readers.ros_pictures import Calibration, calibration_of, distortion_of
from d3a.readers.ros_poses import PoseTopic, pose_of
from d3a.readers.ros_tf import Tree
from d3a.readers.tracks import nearest_at

NO_STAMP = "message without a time in its header (stamps=receive takes the recorder's)"
BROKEN_MESSAGE = "broken message"
BROKEN_TRANSFORM = "broken transform"
NO_CALIBRATION = "camera info that is no calibration"
MOST_KEPT = 64
"""Messages held because they lie before the picture that they belong to; the oldest goes."""
NEVER = -(2**62)
"""Stands for the time of a message that has none: nothing is near it."""


@dataclass(frozen=True, slots=True)
class Stamps:
    """Tells when a message was made, in nanoseconds since 1970.

    by_receive: by the recorder's clock instead of the header's. offset_ns: added, for headers that
    count from an unknown start.
    """

    bag: Bag
    by_receive: bool = False
    offset_ns: int = 0

    def of(self, message: Message) -> int | None:
        """Return a message's time, None where its header has none."""
        if self.by_receive:
            return message.receive_ns
        stamp = self.bag.stamp_ns(message)
        return None if stamp is None else stamp + self.offset_ns

    def within(self, message: Message, header: Any) -> int | None:
        """Return the time of a header inside of a message."""
        if self.by_receive:
            return message.receive_ns
        stamp = int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)
        return stamp + self.offset_ns if stamp else None


@dataclass(slots=True)
class Index:
    """What a look through the bag found.

    times: topic -> when its messages were made, in the bag's order. cameras: (time, calibration),
    a new one where it changes. distortion: the largest coefficient of the lens.
    """

    tree: Tree = field(default_factory=Tree)
    poses: list[PoseTopic] = field(default_factory=list)
    times: dict[str, array[int]] = field(default_factory=dict)
    cameras: list[tuple[int, Calibration]] = field(default_factory=list)
    distortion: float = 0.0
    skipped: Skipped = field(default_factory=Skipped)

    def camera_at(self, time_ns: int, size: tuple[int, int] | None) -> Camera | None:
        """Return the camera of a picture: as it was told last, else first."""
        if not self.cameras:
            return None
        at = bisect_right(self.cameras, time_ns, key=lambda each: each[0])
        return self.cameras[max(at - 1, 0)][1].of_size(size)


@dataclass(slots=True)
class Scan:
    """What to look for, by topic. frames: names that the camera's frame may have."""

    bag: Bag
    stamps: Stamps
    moving: Sequence[str]
    fixed: Sequence[str]
    poses: Mapping[str, PoseTopic]
    camera_info: str | None
    timed: Sequence[str]
    frames: Sequence[str]
    size: tuple[int, int] | None
    is_rectified: bool
    _index: Index = field(default_factory=Index)
    _last_info: bytes = b""

    def run(self) -> Index:
        """Look through the bag."""
        index = self._index
        index.poses = list(self.poses.values())
        handlers: dict[str, Callable[[Message], None]] = {}
        for topic in self.timed:
            index.times[topic] = array("q")
            handlers[topic] = self._timed
        for topic in self.poses:
            handlers[topic] = self._pose
        if self.camera_info is not None:
            handlers[self.camera_info] = self._camera_info
        for topic in self.fixed:  # first of all, as they hold at all times
            for message in self.bag.messages([topic]):
                self._transforms(message)
        handlers |= dict.fromkeys(self.moving, self._transforms)
        for number, message in enumerate(self.bag.messages(list(handlers))):
            handlers[message.topic](message)
            if number % 1024 == 0:
                index.tree.prune(self.frames, {t.child: t.parent for t in self.poses.values()})
        return index

    def _timed(self, message: Message) -> None:
        stamp = self.stamps.of(message)
        self._index.times[message.topic].append(NEVER if stamp is None else stamp)

    def _read(self, message: Message) -> Any:
        try:
            return self.bag.read(message)
        except BadInput as error:
            self._index.skipped.add(BROKEN_MESSAGE, f"{message.topic} ({error})")
            return None

    def _transforms(self, message: Message) -> None:
        record = self._read(message)
        for each in () if record is None else record.transforms:
            parent = str(each.header.frame_id).lstrip("/")
            child = str(each.child_frame_id).lstrip("/")
            is_fixed = message.topic in self.fixed
            time_ns = None if is_fixed else self.stamps.within(message, each.header)
            try:
                pose = pose_of(each.transform)
            except BadInput as error:
                self._index.skipped.add(BROKEN_TRANSFORM, f"{parent} -> {child} ({error})")
                continue
            if time_ns is None and not is_fixed:
                self._index.skipped.add(NO_STAMP, f"{message.topic}: {parent} -> {child}")
                continue
            self._index.tree.add(parent, child, time_ns, pose)

    def _pose(self, message: Message) -> None:
        record, stamp = self._read(message), self.stamps.of(message)
        if stamp is None:
            self._index.skipped.add(NO_STAMP, message.topic)
        elif record is not None:
            self.poses[message.topic].add(stamp, record, self._index.skipped, message.topic)

    def _camera_info(self, message: Message) -> None:
        if message.raw[12:] == self._last_info:  # all but the time is as before
            return
        self._last_info = message.raw[12:]
        record = self._read(message)
        if record is None:
            return
        try:
            found = calibration_of(record, self.size, is_rectified=self.is_rectified)
        except BadInput as error:
            self._index.skipped.add(NO_CALIBRATION, f"{message.topic} ({error})")
            return
        stamp = self.stamps.of(message) or NEVER
        if not self._index.cameras or stamp >= self._index.cameras[-1][0]:
            self._index.cameras.append((stamp, found))
        if not self.is_rectified:
            self._index.distortion = max(self._index.distortion, distortion_of(record))


def nearest(times: Sequence[int], others: Sequence[int], gap_ns: float) -> dict[int, int]:
    """Return for each number of `times` that of the nearest of `others`, where it is near enough.

    Both in any order; of two as near the earlier.
    """
    order = sorted(range(len(others)), key=others.__getitem__)
    ordered = [others[number] for number in order]
    found = {}
    for number, time_ns in enumerate(times):
        at = nearest_at(ordered, time_ns, gap_ns)
        if at is not None and time_ns != NEVER:
            found[number] = order[at]
    return found


def each_its_own(
    frames: Sequence[int], others: Sequence[int], gap_ns: float
) -> tuple[dict[int, int], list[int]]:
    """Return for each frame the one message that belongs to it, and the messages of no frame.

    A message belongs to one frame only, the nearest; of several for one frame the nearest counts.
    """
    taken: dict[int, int] = {}
    homeless = []
    belongs = nearest(others, frames, gap_ns)
    for number, time_ns in enumerate(others):
        frame = belongs.get(number)
        if frame is None:
            homeless.append(number)
            continue
        held = taken.get(frame)
        if held is None or abs(others[held] - frames[frame]) > abs(time_ns - frames[frame]):
            taken[frame] = number
        if held is not None:
            homeless.append(held if taken[frame] == number else number)
    return taken, homeless


class Follower:
    """Reads a topic alongside another: gives the message of a number, whose order is nearly theirs.

    Holds few messages: those that come before they are wanted.
    """

    def __init__(self, messages: Iterator[Message], wanted: Mapping[int, int]) -> None:
        """wanted: frame's number -> this topic's; those of no frame are passed over."""
        self._messages = enumerate(messages)
        self._uses = Counter(wanted.values())
        self._kept: dict[int, Message] = {}
        self._passed = -1

    def take(self, number: int) -> Message | None:
        """Return the message, None where it is gone already or the bag ends before."""
        while self._passed < number:
            found = next(self._messages, None)
            if found is None:
                break
            self._passed = found[0]
            if self._uses[self._passed]:
                self._kept[self._passed] = found[1]
                if len(self._kept) > MOST_KEPT:
                    del self._kept[min(self._kept)]
        self._uses[number] -= 1
        if self._uses[number] > 0:
            return self._kept.get(number)
        return self._kept.pop(number, None)
