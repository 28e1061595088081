"""The small recording of `folders` as ROS bags: the same facts, as messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from d3a.model import Pose
from d3a.readers.ros_tf import OPTICAL, composed
from d3a.readers.ros_vision import LAYOUTS
from tests.worlds.folders import Moment, found, moments
from tests.worlds.rounds import CAMERA, jpeg

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'd3a[ros]'")

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

OPTICAL_FRAME = "camera_color_optical_frame"
COLOUR = "/camera/color/image_raw/compressed"
IMAGE, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
INFO, BOXES = "/camera/color/camera_info", "/detections"
TF = "tf2_msgs/msg/TFMessage"
KINDS = ("ros1", "sqlite", "mcap")
ROS1_VISION = {
    "vision_msgs/msg/BoundingBox2D": "geometry_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/ObjectHypothesisWithPose": (
        "int64 id\nfloat64 score\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "vision_msgs/msg/Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nsensor_msgs/Image source_img"
    ),
    "vision_msgs/msg/Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
    "vision_msgs/msg/VisionInfo": LAYOUTS[0]["vision_msgs/msg/VisionInfo"],
}
NUMBERS = {"cup": 41, "bowl": 45}


@dataclass(frozen=True)
class Said:
    """A message to write: topic, type, stamp in milliseconds (also when it is received), fields."""

    topic: str
    type: str
    time_ms: int
    fields: Mapping[str, Any]
    frame_id: str = ""
    late_ms: int = 0


Change = Callable[[Said], Said | None]


def without(*topics: str) -> Change:
    """Leave topics out."""
    return lambda said: None if said.topic in topics else said


def put(topic: str, number: int | None, **fields: Any) -> Change:
    """Give the message of a topic and a moment (None: all) other fields."""
    at_ms = None if number is None else moments()[number].time_ms
    return lambda said: (
        replace(said, fields=dict(said.fields) | fields)
        if said.topic == topic and at_ms in (None, said.time_ms)
        else said
    )


def moved(topic: str, number: int, time_ms: int) -> Change:
    """Give the message of a topic and a moment another stamp; it is received when it was."""
    at_ms = moments()[number].time_ms
    return lambda said: (
        replace(said, time_ms=time_ms, late_ms=at_ms + said.late_ms - time_ms)
        if (said.topic, said.time_ms) == (topic, at_ms)
        else said
    )


@dataclass
class World:
    """Makes messages of one ROS: types are short, as in `sensor_msgs/Image`.

    layout: which of LAYOUTS boxes have, None that of ROS 1.
    """

    kind: str
    layout: int | None = 0
    store: Any = field(init=False)

    def __post_init__(self) -> None:
        is_ros1 = self.kind == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.ROS2_HUMBLE)
        types: dict[str, Any] = {}
        layout = ROS1_VISION if self.layout is None else LAYOUTS[self.layout]
        for name, text in layout.items():
            types |= get_types_from_msg(text, name)
        tf = get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TF)
        self.store.register(tf | types)

    def make(self, kind: str, **fields: Any) -> Any:
        """A message; fields that are not given are zero."""
        name = kind.replace("/", "/msg/") if "/msg/" not in kind else kind
        made = {}
        for each, description in self.store.fielddefs[name][1]:
            made[each] = fields.pop(each) if each in fields else self._zero(description)
        assert not fields, f"{kind} has no {fields}"
        return self.store.types[name](**made)

    def _zero(self, description: Any) -> Any:
        number, (*inner,) = description
        if number == 1:
            return {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}.get(inner[0], 0)
        if number == 2:
            return self.make(description[1])
        element, length = description[1]
        if element[0] != 1:
            return [self._zero(element) for _ in range(length if number == 3 else 0)]
        return np.zeros(length if number == 3 else 0, np.dtype(element[1][0]))

    def header(self, time_ms: int, frame_id: str) -> Any:
        """A std_msgs Header."""
        return self.make("std_msgs/Header", stamp=self.stamp(time_ms), frame_id=frame_id)

    def stamp(self, time_ms: int) -> Any:
        """A Time; none is below a thousandth of a second."""
        seconds, rest = divmod(time_ms, 1000)
        return self.make("builtin_interfaces/Time", sec=seconds, nanosec=rest * 10**6)

    def pose(self, pose: Pose) -> Any:
        """A geometry_msgs Pose."""
        x, y, z, w = pose.quaternion
        return self.make(
            "geometry_msgs/Pose",
            position=self.make(
                "geometry_msgs/Point", **dict(zip("xyz", pose.position, strict=True))
            ),
            orientation=self.make("geometry_msgs/Quaternion", x=x, y=y, z=z, w=w),
        )

    def transform(self, time_ms: int, parent: str, child: str, pose: Pose) -> Any:
        """A geometry_msgs TransformStamped."""
        record = self.pose(pose)
        at = record.position
        return self.make(
            "geometry_msgs/TransformStamped",
            header=self.header(time_ms, parent),
            child_frame_id=child,
            transform=self.make(
                "geometry_msgs/Transform",
                translation=self.make("geometry_msgs/Vector3", x=at.x, y=at.y, z=at.z),
                rotation=record.orientation,
            ),
        )

    def tf(self, time_ms: int, parent: str, child: str, pose: Pose, topic: str = "/tf") -> Said:
        """A message of one transform."""
        transforms = [self.transform(time_ms, parent, child, pose)]
        return Said(topic, "tf2_msgs/TFMessage", time_ms, {"transforms": transforms})

    def detection(self, row: Mapping[str, Any]) -> Any:
        """A Detection2D of a row of boxes, in this world's layout."""
        x1, y1, x2, y2 = row["box"]
        middle = {"x": (x1 + x2) / 2, "y": (y1 + y2) / 2}
        best, other = (float(row["probability"]), row["category"]), (0.01, "bowl")
        results = []
        for score, name in (other, best):
            if self.layout == 0:
                said = self.make("vision_msgs/ObjectHypothesis", class_id=name, score=score)
                told = {"hypothesis": said}
            else:
                told = {"id": NUMBERS[name] if self.layout is None else name, "score": score}
            results.append(self.make("vision_msgs/ObjectHypothesisWithPose", **told))
        if self.layout == 0:
            centre = self.make(
                "vision_msgs/Pose2D", position=self.make("vision_msgs/Point2D", **middle)
            )
        else:
            centre = self.make("geometry_msgs/Pose2D", **middle)
        size = {"size_x": float(x2 - x1), "size_y": float(y2 - y1)}
        return self.make(
            "vision_msgs/Detection2D",
            results=results,
            bbox=self.make("vision_msgs/BoundingBox2D", center=centre, **size),
        )

    def boxes(self, time_ms: int, rows: Sequence[Mapping[str, Any]], late_ms: int = 0) -> Said:
        """A Detection2DArray."""
        fields = {"detections": [self.detection(row) for row in rows]}
        kind = "vision_msgs/Detection2DArray"
        return Said(BOXES, kind, time_ms, fields, OPTICAL_FRAME, late_ms)

    def raw(
        self,
        encoding: str,
        rows: np.ndarray[Any, Any],
        width: int | None = None,
        *,
        pad: int = 0,
        is_bigendian: bool = False,
    ) -> dict[str, Any]:
        """The fields of an Image; rows (h, ...) are its bytes or numbers."""
        height = rows.shape[0]
        content = np.frombuffer(rows.tobytes(), np.uint8).reshape(height, -1)
        content = np.pad(content, ((0, 0), (0, pad)), constant_values=255)
        return {
            "height": height,
            "width": width or rows.shape[1],
            "encoding": encoding,
            "is_bigendian": int(is_bigendian),
            "step": content.shape[1],
            "data": np.ascontiguousarray(content).ravel(),
        }

    def info(self, time_ms: int, **changes: Any) -> Said:
        """The camera's CameraInfo."""
        k = [CAMERA.fx, 0, CAMERA.cx, 0, CAMERA.fy, CAMERA.cy, 0, 0, 1]
        p = [CAMERA.fx, 0, CAMERA.cx, 0, 0, CAMERA.fy, CAMERA.cy, 0, 0, 0, 1, 0]
        fields: dict[str, Any] = {"width": CAMERA.width, "height": CAMERA.height, "k": k, "p": p}
        fields |= changes
        for name in ("k", "p"):
            fields[name] = np.array(fields[name], np.float64)
        if self.kind == "ros1":
            fields = {(n.upper() if len(n) == 1 else n): v for n, v in fields.items()}
        return Said(INFO, "sensor_msgs/CameraInfo", time_ms, fields, OPTICAL_FRAME)

    def jpeg(self, moment: Moment, topic: str = COLOUR) -> Said:
        """The moment's picture, as the bytes that the folder has."""
        data = np.frombuffer(jpeg(moment.shade), np.uint8)
        fields = {"format": "bgr8; jpeg compressed bgr8", "data": data}
        return Said(topic, "sensor_msgs/CompressedImage", moment.time_ms, fields, OPTICAL_FRAME)

    def depth(self, moment: Moment, **changes: Any) -> Said:
        """The moment's depth as 16UC1."""
        counts = np.full((CAMERA.height, CAMERA.width), round(moment.depth_m * 1000), "<u2")
        fields = self.raw("16UC1", counts) | changes
        return Said(DEPTH, "sensor_msgs/Image", moment.time_ms, fields, OPTICAL_FRAME)

    def of_moment(self, moment: Moment) -> list[Said]:
        """All messages of a moment: the boxes come late, as a detector's do."""
        base = base_of(moment)
        return [
            self.info(moment.time_ms),
            self.jpeg(moment),
            self.depth(moment),
            self.tf(moment.time_ms, "map", "odom", Pose((0, 1.0, 0), (0, 0, 0, 1.0))),
            self.tf(moment.time_ms, "odom", "base_link", composed(ODOM, base)),
            self.boxes(moment.time_ms, found(moment), late_ms=180),
        ]

    def fixed(self, time_ms: int) -> list[Said]:
        """The transforms that hold at all times: sent once."""
        return [
            self.tf(time_ms, "base_link", "camera_link", LINK, "/tf_static"),
            self.tf(time_ms, "camera_link", OPTICAL_FRAME, OPTICAL, "/tf_static"),
        ]

    def recording(self, earlier_ms: int = 0) -> list[Said]:
        """The small recording. Fixed transforms come after it: they hold before as well."""
        shifted = [replace(each, time_ms=each.time_ms - earlier_ms) for each in moments()]
        said = [each for moment in shifted for each in self.of_moment(moment)]
        if self.layout is None:
            fields = {"database_location": '{"41": "cup", "45": "bowl"}'}
            kind = "vision_msgs/VisionInfo"
            said.append(Said("/vision_info", kind, shifted[0].time_ms, fields))
        return [*said, *self.fixed(shifted[-1].time_ms + 500)]

    def write(self, path: Path, said: Sequence[Said], *, defined: bool = True) -> Path:
        """Write a bag by the time of receipt; defined False: without message definitions."""
        path.parent.mkdir(parents=True, exist_ok=True)
        if self.kind == "ros1":
            path = path.with_suffix(".bag")
            writer: Any = Writer1(path)
        else:
            plugin = StoragePlugin.MCAP if self.kind == "mcap" else StoragePlugin.SQLITE3
            writer = Writer2(path, version=9, storage_plugin=plugin)
        with writer:
            topics: dict[str, Any] = {}
            for each in sorted(said, key=lambda e: e.time_ms + e.late_ms):
                kind = each.type.replace("/", "/msg/")
                if each.topic not in topics:
                    topics[each.topic] = writer.add_connection(
                        each.topic, kind, typestore=self.store
                    )
                writer.write(topics[each.topic], *self._packed(each, kind))
        if not defined:
            undefine(path)
        return path

    def write_changed(self, path: Path, *changes: Change, more: Sequence[Said] = ()) -> Path:
        """Write the small recording with each message changed, or left out where one says None."""
        said: list[Said] = []
        for each in self.recording():
            changed: Said | None = each
            for change in changes:
                changed = None if changed is None else change(changed)
            said += [] if changed is None else [changed]
        return self.write(path, [*said, *more])

    def _packed(self, said: Said, kind: str) -> tuple[int, Any]:
        fields = dict(said.fields)
        names = [name for name, _ in self.store.fielddefs[kind][1]]
        if "header" in names and "header" not in fields:
            fields["header"] = self.header(said.time_ms, said.frame_id)
        message = self.make(said.type, **fields)
        pack: Callable[..., Any] = (
            self.store.serialize_ros1 if self.kind == "ros1" else self.store.serialize_cdr
        )
        # received somewhat later than made, which must tell nothing
        receive_ns = (said.time_ms + said.late_ms + 37) * 10**6
        return receive_ns, pack(message, kind)


LINK = Pose((0.25, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0))
ODOM = Pose((0.0, -1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
"""The map in the frame odom, which lies 1 m beside it. All offsets are such that adding them up
rounds nothing: stores are compared to the last bit."""


def base_of(moment: Moment) -> Pose:
    """The robot's pose in the map: the camera is at LINK on it, turned to its optical frame."""
    x, y, z, *_ = moment.pose
    unturned = Pose((0.0, 0.0, 0.0), (0.5, -0.5, 0.5, 0.5))  # the inverse of OPTICAL
    unmoved = Pose((-0.25, 0.0, -0.5), (0.0, 0.0, 0.0, 1.0))
    camera = Pose((x, y, z), (0.0, 0.0, 0.0, 1.0))
    return composed(composed(camera, unturned), unmoved)


def undefine(path: Path) -> None:
    """Take the message definitions out of a SQLite bag, as recorders before ROS 2 Iron write it."""
    import sqlite3

    (file,) = path.glob("*.db3")
    database = sqlite3.connect(file)
    database.execute("DELETE FROM message_definitions")
    database.commit()
    database.close()


def as_bag(path: Path, kind: str) -> Path:
    """The small recording as a bag of one of KINDS."""
    world = World(kind, None if kind == "ros1" else 0)
    return world.write(path, world.recording())
