"""Frames out of a robot's messages: a picture with its depth, boxes, camera and pose."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import Any

from d3a import images
from d3a.model import BadInput, Depth, Detection, Frame, Image, Pose
from d3a.readers import parsing, ros_pictures, ros_vision
from d3a.readers.base import Skipped
from d3a.readers.ros_described import name_of, time_ms_of
from d3a.readers.ros_poses import MAP, PoseTopic, Way, find_way, pose_of
from d3a.readers.ros_tf import IDENTITY, Reach, Tree
from d3a.readers.ros_topics import frame_id_of
from d3a.watch.messages import stamp_ns
from d3a.watch.patience import Patience

PAIR_NS = 20_000_000
"""From a picture to its depth and its boxes, at most; drivers give them the picture's own time."""
REACH = Reach(1.5e9, 0.1e9)
KEPT_NS = 30 * 10**9
"""Transforms are kept for so long at least, and twice so long at most."""
POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
BROKEN = "broken message"
BROKEN_PICTURE, BROKEN_DEPTH = "broken picture", "broken depth picture"
NO_POSE = "no transform that reaches the camera at the time"
NOT_LOOKED = "picture that no detector has looked at"
NO_PICTURE = "boxes of a time without a picture"


@dataclass(slots=True)
class _Waiting:
    time_ns: int
    message: Any
    since: float


class _Transforms:
    """The tf tree of late: of all day's transforms the memory would fill."""

    def __init__(self) -> None:
        self._fixed: dict[tuple[str, str], Pose] = {}
        self._trees = (Tree(), Tree())
        self._begun_ns = 0
        self._poses: list[PoseTopic] = []
        self._posed_ns = 0

    @property
    def tree(self) -> Tree:
        return self._trees[0]

    @property
    def poses(self) -> PoseTopic | None:
        return self._poses[0] if self._poses else None

    def add_pose(self, message: Any, skipped: Skipped) -> None:
        time_ns, parent = stamp_ns(message.header), frame_id_of(message)
        child = str(getattr(message, "child_frame_id", "")).lstrip("/")  # an Odometry has it
        if not self._poses or self._poses[0].parent != parent:
            self._poses = [PoseTopic("pose", POSE, parent, child) for _ in range(2)]
            self._posed_ns = time_ns
        elif time_ns - self._posed_ns > KEPT_NS:
            self._poses = [self._poses[1], PoseTopic("pose", POSE, parent, child)]
            self._posed_ns = time_ns
        self._poses[0].add(time_ns, message, skipped, "pose")
        self._poses[1].add(time_ns, message, Skipped(), "pose")

    def add(self, parent: str, child: str, time_ns: int | None, pose: Pose) -> None:
        if time_ns is None:
            self._fixed[parent, child] = pose
        elif time_ns - self._begun_ns > KEPT_NS:
            self._trees, self._begun_ns = (self._trees[1], Tree()), time_ns
            for names, fixed in self._fixed.items():
                self._trees[1].add(*names, None, fixed)
        for tree in self._trees:
            tree.add(parent, child, time_ns, pose)


class Robot:
    """Takes messages in by their role, gives frames when all that belongs to them is there."""

    def __init__(
        self, roles: Collection[str], map_frame: str | None, patience: Patience, skipped: Skipped
    ) -> None:
        self._main = "image" if "image" in roles else "detections"
        self._beside = [r for r in ("depth", "detections") if r in roles and r != self._main]
        self._waiting: list[_Waiting] = []
        self._found: dict[str, dict[int, Any]] = {role: {} for role in self._beside}
        self._transforms = _Transforms()
        self._map_frame = map_frame
        self._info: Any = None
        self._names: dict[str, str] = {}
        self._patience = patience
        self._skipped = skipped
        self._row = 0

    def take(self, role: str, message: Any) -> None:
        """Take a message in; one that is broken is counted."""
        try:
            self._take(role, message)
        except (AttributeError, TypeError, ValueError, BadInput) as error:
            self._skipped.add(BROKEN, f"{role} ({error})")  # a field is missing, or is no number

    def _take(self, role: str, message: Any) -> None:
        if role in ("tf", "tf-static"):
            for each in message.transforms:
                time_ns = None if role == "tf-static" else stamp_ns(each.header)
                parent, child = frame_id_of(each), str(each.child_frame_id).lstrip("/")
                self._transforms.add(parent, child, time_ns, pose_of(each.transform))
        elif role == "pose":
            self._transforms.add_pose(message, self._skipped)
        elif role == "camera-info":
            self._info = message
        elif role == "classes":
            self._names |= ros_vision.class_names(message)
        elif role == self._main:
            time_ns = stamp_ns(message.header)
            self._waiting.append(_Waiting(time_ns, message, self._patience.clock()))
        else:
            self._found[role][stamp_ns(message.header)] = message

    def frames(self) -> Iterator[Frame]:
        """Yield the frames that are complete, or were waited for long enough."""
        while self._waiting:
            waiting = self._waiting[0]
            if not self._is_ready(waiting) and not self._patience.has_settled(waiting.since):
                return
            self._waiting.pop(0)
            frame = self._frame(waiting)
            if frame is not None:
                yield frame

    def rest(self) -> Iterator[Frame]:
        """Yield what waits, as nothing more will come."""
        waiting, self._waiting = self._waiting, []
        yield from (frame for each in waiting if (frame := self._frame(each)) is not None)

    def _is_ready(self, waiting: _Waiting) -> bool:
        if any(self._near(role, waiting.time_ns) is None for role in self._beside):
            return False
        later = waiting.time_ns + int(REACH.beyond_ns)
        way = self._way(waiting.message)
        # between two transforms is surer than after the last: wait for one past the picture
        return isinstance(way, Way) and all(
            edge.fixed is not None or edge.samples.at(later, Reach(0, 1e8)) is not None
            for edge in way.edges
        )

    def _near(self, role: str, time_ns: int) -> int | None:
        times = self._found[role]
        nearest = min(times, key=lambda each: (abs(each - time_ns), each), default=None)
        return nearest if nearest is not None and abs(nearest - time_ns) <= PAIR_NS else None

    def _taken(self, role: str, time_ns: int) -> Any:
        """Return the message that belongs to a time, None without; older ones are let go."""
        at = self._near(role, time_ns)
        found = None if at is None else self._found[role].pop(at)
        for old in [each for each in self._found[role] if each < time_ns - PAIR_NS]:
            del self._found[role][old]
            if role == "detections":
                self._skipped.add(NO_PICTURE, str(old // 10**6))
        return found

    def _frame(self, waiting: _Waiting) -> Frame | None:
        time_ms = time_ms_of(waiting.time_ns)
        name = name_of(time_ms)
        depth = self._taken("depth", waiting.time_ns) if "depth" in self._beside else None
        boxes: Any = waiting.message if self._main == "detections" else None
        if "detections" in self._beside:
            boxes = self._taken("detections", waiting.time_ns)
            if boxes is None:
                self._skipped.add(NOT_LOOKED, name)
                return None
        pose = self._pose(waiting, name)
        image, size = self._image(waiting.message, name)
        return Frame(
            name=name,
            time_ms=time_ms,
            pose=pose,
            camera=self._camera(size, name),
            image=image,
            depth=self._depth(depth, name),
            detections=None if boxes is None else self._detections(boxes, pose, name),
        )

    def _way(self, message: Any) -> Way | str:
        cameras = [frame_id_of(message)]
        if self._info is not None:
            cameras.append(frame_id_of(self._info))
        poses = [] if self._transforms.poses is None else [self._transforms.poses]
        try:
            return find_way(self._transforms.tree, poses, cameras, self._map_frame, bool(poses))
        except BadInput as error:
            return str(error)

    def _pose(self, waiting: _Waiting, name: str) -> Pose | None:
        way = self._way(waiting.message)
        pose = None if isinstance(way, str) else way.at(waiting.time_ns, REACH)
        if pose is None:
            why = way if isinstance(way, str) else way.missing(waiting.time_ns, REACH)
            self._skipped.add(NO_POSE, f"{name} ({why})")
        return pose

    def _image(self, message: Any, name: str) -> tuple[Image | None, tuple[int, int] | None]:
        if self._main == "detections":
            return None, None
        try:
            image = ros_pictures.picture_of(message)
            return image, images.size(image)
        except (BadInput, AttributeError) as error:
            self._skipped.add(BROKEN_PICTURE, f"{name} ({error})")
            return None, None

    def _camera(self, size: tuple[int, int] | None, name: str) -> Any:
        if self._info is None:
            return None
        try:
            calibration = ros_pictures.calibration_of(self._info, size, is_rectified=False)
        except (BadInput, AttributeError, TypeError, IndexError) as error:
            self._skipped.add(BROKEN, f"camera-info at {name} ({error})")
            return None
        return calibration.of_size(size)

    def _depth(self, message: Any, name: str) -> Depth | None:
        if message is None:
            return None
        try:
            return ros_pictures.depth_of(message)
        except (BadInput, AttributeError) as error:
            self._skipped.add(BROKEN_DEPTH, f"{name} ({error})")
            return None

    def _detections(self, message: Any, pose: Pose | None, name: str) -> tuple[Detection, ...]:
        seen_from = IDENTITY if frame_id_of(message) == (self._map_frame or MAP) else pose
        found = []
        for each in message.detections:
            try:
                detection = ros_vision.detection_of(
                    each, self._names, seen_from, self._skipped, name
                )
            except (BadInput, AttributeError, TypeError) as error:
                self._skipped.add(parsing.BROKEN_DETECTION, f"{name} ({error})")
                continue
            found.append(replace(detection, row=self._row))
            self._row += 1
        return tuple(found)
