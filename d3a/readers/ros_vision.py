"""Boxes of detectors in bags: vision_msgs, whose layout has changed, and the names of classes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from d3a.model import BadInput, Box, Detection, Pose, Position
from d3a.readers import parsing
from d3a.readers.base import Skipped
from d3a.readers.ros_tf import IDENTITY, composed

PACKAGE = "vision_msgs/"
DETECTIONS = "vision_msgs/msg/Detection2DArray"
INFO, LABELS = "vision_msgs/msg/VisionInfo", "vision_msgs/msg/LabelInfo"
_COMMON = {
    "vision_msgs/msg/Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
    "vision_msgs/msg/VisionClass": "uint16 class_id\nstring class_name",
    "vision_msgs/msg/LabelInfo": (
        "std_msgs/Header header\nvision_msgs/VisionClass[] class_map\nfloat32 threshold"
    ),
    "vision_msgs/msg/VisionInfo": (
        "std_msgs/Header header\nstring method\nstring database_location\nint32 database_version"
    ),
}
_NEW = {
    "vision_msgs/msg/Point2D": "float64 x\nfloat64 y",
    "vision_msgs/msg/Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
    "vision_msgs/msg/BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score",
    "vision_msgs/msg/ObjectHypothesisWithPose": (
        "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "vision_msgs/msg/Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nstring id"
    ),
}
_OLD = {
    "vision_msgs/msg/BoundingBox2D": "geometry_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/ObjectHypothesisWithPose": (
        "string id\nfloat64 score\ngeometry_msgs/PoseWithCovariance pose"
    ),
}
_OLD_DETECTION = (
    "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
    "vision_msgs/BoundingBox2D bbox\nsensor_msgs/Image source_img"
)
LAYOUTS: tuple[Mapping[str, str], ...] = (
    _COMMON | _NEW,
    _COMMON
    | _OLD
    | {DETECTIONS.removesuffix("Array"): _OLD_DETECTION + "\nbool is_tracking\nstring tracking_id"},
    _COMMON | _OLD | {DETECTIONS.removesuffix("Array"): _OLD_DETECTION},
)
"""Definitions for ROS 2 bags that bring none, the newest first. A message fits one of them only:
its length is another in each."""


def class_names(message: Any) -> dict[str, str]:
    """Return names by class number, of a LabelInfo or a VisionInfo; {} where it has none.

    A VisionInfo names where a database is, which a recording does not hold; some publishers put the
    names themselves there, as a JSON list or object.
    """
    if hasattr(message, "class_map"):
        return {str(each.class_id): each.class_name for each in message.class_map}
    try:
        said = json.loads(message.database_location)
    except ValueError:
        return {}
    if isinstance(said, list):
        said = dict(enumerate(said))
    if not isinstance(said, dict):
        return {}
    return {str(key): name for key, name in said.items() if isinstance(name, str)}


def names_in_file(path: Path) -> dict[str, str]:
    """Return names by class number of a text file with a name a line, the first for 0."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path.name} is no text file of class names") from error
    return {str(n): parsing.clean_text(line) for n, line in enumerate(lines) if line.strip()}


def box_of(bbox: Any) -> Box:
    """Return x1, y1, x2, y2 around a box that is given by its centre, size and turn."""
    centre = bbox.center
    at = getattr(centre, "position", centre)
    cosine, sine = abs(math.cos(centre.theta)), abs(math.sin(centre.theta))
    half_x = (bbox.size_x * cosine + bbox.size_y * sine) / 2
    half_y = (bbox.size_x * sine + bbox.size_y * cosine) / 2
    return at.x - half_x, at.y - half_y, at.x + half_x, at.y + half_y


def detection_of(
    record: Any, names: Mapping[str, str], seen_from: Pose | None, skipped: Skipped, where: str
) -> Detection:
    """Return the detection of a Detection2D by its most probable name; BadInput for a broken one.

    seen_from: the frame of the message in the map, by which the thing's own position is told.
    """
    best: tuple[float, str, Any] | None = None
    for result in record.results:
        said = getattr(result, "hypothesis", result)
        name = str(said.class_id if hasattr(said, "class_id") else said.id)
        if math.isfinite(said.score) and (best is None or said.score > best[0]):
            best = (float(said.score), name, result.pose.pose.position)
    if best is None:
        raise BadInput("it has no class with a finite score")
    score, name, place = best
    return Detection(
        category=parsing.category_of(names.get(name, name), skipped, where),
        probability=score,
        box=box_of(record.bbox),
        position=_position(place, seen_from),
    )


def _position(place: Any, seen_from: Pose | None) -> Position | None:
    """Return where the thing is in the map; detectors that cannot tell leave zeros.

    Some put pixels there: what a camera sees has a depth.
    """
    at = (float(place.x), float(place.y), float(place.z))
    if seen_from is None or not any(at) or not all(map(math.isfinite, at)):
        return None
    if at[2] <= 0 and seen_from is not IDENTITY:
        return None
    return composed(seen_from, Pose(at, (0.0, 0.0, 0.0, 1.0))).position
