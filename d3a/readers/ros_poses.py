"""Where the camera was: by the tf tree, and by topics of poses where that does not reach.

The way goes from the camera's optical frame up to the map (REP 105: map, odom, base_link). A pose
topic is one more link of it, from its header's frame to the robot's.
"""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from d3a.model import BadInput, Pose
from d3a.readers.base import Link, Skipped
from d3a.readers.parsing import is_covariance, of_known_axes
from d3a.readers.ros_tf import OPTICAL, Edge, Reach, Samples, Tree, composed
from d3a.readers.ros_topics import Looked, frame_id_of
from d3a.readers.tracks import BROKEN_POSE

MAP = "map"
BODY_FRAMES = ("base_link", "base_footprint", "base")
Covariance = tuple[float, ...]


@dataclass(slots=True)
class PoseTopic:
    """A topic of poses, read: a link from its frame to the robot's, and how sure it is."""

    name: str
    type: str
    parent: str
    child: str
    samples: Samples = field(default_factory=Samples)
    times: array[int] = field(default_factory=lambda: array("q"))
    covariances: list[Covariance | None] = field(default_factory=list)

    @classmethod
    def of(cls, looked: Looked, child: str | None) -> PoseTopic:
        """Return the empty topic; child: the frame whose pose it is, where the person said it."""
        said = getattr(looked.message, "child_frame_id", "") if looked.message is not None else ""
        known = child or str(said).lstrip("/")
        return cls(looked.topic.name, looked.topic.type, looked.frame_id, known)

    def add(self, time_ns: int, message: Any, skipped: Skipped, where: str) -> None:
        """Keep a message's pose; a broken one is counted."""
        inner = message.pose
        has_covariance = hasattr(inner, "covariance")
        try:
            pose = pose_of(inner.pose if has_covariance else inner)
        except BadInput as error:
            skipped.add(BROKEN_POSE, f"{where} ({error})")
            return
        self.parent = self.parent or frame_id_of(message)
        self.samples.add(time_ns, (*pose.position, *pose.quaternion))
        covariance = covariance_of(inner.covariance) if has_covariance else None
        is_later = not self.times or time_ns > self.times[-1]
        if is_later and (not self.covariances or self.covariances[-1] != covariance):
            self.times.append(time_ns)
            self.covariances.append(covariance)

    def covariance_at(self, time_ns: int) -> Covariance | None:
        """Return the covariance that was told last, else the first one."""
        if not self.times:
            return None
        return self.covariances[max(bisect_right(self.times, time_ns) - 1, 0)]


def pose_of(record: Any) -> Pose:
    """Return a geometry_msgs Pose or Transform; BadInput for NaN, or a rotation that is none."""
    at = getattr(record, "position", None)
    at = record.translation if at is None else at
    turn = getattr(record, "orientation", None)
    turn = record.rotation if turn is None else turn
    place = (float(at.x), float(at.y), float(at.z))
    return Pose(place, (float(turn.x), float(turn.y), float(turn.z), float(turn.w)))


def covariance_of(values: Any) -> Covariance | None:
    """Return a 6 x 6 covariance; None where it was left at zero, says unknown, or cannot be.

    An axis that a planar driver says nothing of counts as fixed.
    """
    matrix = np.array(values, dtype=np.float64).reshape(6, 6)
    if not np.isfinite(matrix).all() or not matrix.any() or matrix.diagonal().min() < 0:
        return None
    told = of_known_axes(matrix)
    if told is None or not is_covariance(told):
        return None
    return tuple(float(v) for v in told.ravel())


@dataclass(frozen=True, slots=True)
class Way:
    """How to go from the map to the camera: links from above to below, then a fixed mount.

    body: how many of the links lead to the frame that the covariance is of.
    """

    top: str
    edges: tuple[Edge, ...]
    mount: Pose | None = None
    sure: PoseTopic | None = None
    body: int = 0
    notes: tuple[str, ...] = ()

    def at(self, time_ns: int, reach: Reach) -> Pose | None:
        """Return the camera's pose at a time, None where a link has nothing near."""
        pose, body = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)), None
        for number, edge in enumerate(self.edges):
            if number == self.body:
                body = pose
            step = edge.at(time_ns, reach)
            if step is None:
                return None
            pose = composed(pose, step)
        body = pose if body is None else body
        if self.mount is not None:
            pose = composed(pose, self.mount)
        covariance = None if self.sure is None else self.sure.covariance_at(time_ns)
        if covariance is None:
            return pose
        return Pose(pose.position, pose.quaternion, moved(covariance, body, pose))

    def missing(self, time_ns: int, reach: Reach) -> str:
        """Return the link that has nothing near a time."""
        for edge in self.edges:
            if edge.at(time_ns, reach) is None:
                return f"{edge.parent} -> {edge.child}"
        return ""


def moved(covariance: Covariance, body: Pose, camera: Pose) -> Covariance:
    """Return a body's covariance as the camera's, which is fixed to it: turning also moves it."""
    x, y, z = np.array(camera.position) - np.array(body.position)
    change = np.eye(6)
    change[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    matrix = change @ np.reshape(covariance, (6, 6)) @ change.T
    return tuple(float(v) for v in matrix.ravel())


def find_way(
    tree: Tree, topics: Sequence[PoseTopic], cameras: Sequence[str], wanted: str | None, told: bool
) -> Way | str:
    """Return the way from the map to the camera, or a sentence that says why there is none.

    cameras: names the camera's frame may have, the likeliest first. wanted: the map's frame where
    the person said it. told: the person chose the one topic of poses. Raises BadInput where the
    topics must be chosen from, or the wanted frame is not above the camera.
    """
    camera = next(
        (name for name in cameras if name in tree.frames()), cameras[0] if cameras else ""
    )
    up = list(tree.way_up(camera))
    names = [camera, *(edge.parent for edge in up)]
    goal = wanted or MAP
    if goal in names and not told:
        return _by_tf(names, up, goal, topics)
    usable = [topic for topic in topics if len(topic.samples)]
    best = [topic for topic in usable if goal in _above(tree, topic.parent)]
    if best or told or not any(edge.fixed is None for edge in up):
        if best or usable:
            return _by_topic(tree, _one(best or usable), names, up, goal)
        return f"no transform leads from {goal} to the camera ({camera or 'no frame'})"
    if wanted is not None:
        raise BadInput(f"the frame {wanted!r} is not above the camera's: {' <- '.join(names)}")
    return _by_tf(names, up, names[-1], topics)


def _above(tree: Tree, frame: str) -> list[str]:
    return [frame, *(edge.parent for edge in tree.way_up(frame))]


def _one(topics: Sequence[PoseTopic]) -> PoseTopic:
    if len(topics) > 1:
        listed = ", ".join(f"{topic.name} ({topic.type}, in {topic.parent})" for topic in topics)
        raise BadInput(
            f"the bag has {len(topics)} topics that may be the robot's pose: {listed}; say which "
            f"one: --topic pose={topics[0].name}"
        )
    return topics[0]


def _by_tf(names: list[str], up: list[Edge], goal: str, topics: Sequence[PoseTopic]) -> Way:
    """Return the way along tf; poses in the same frame tell how sure it is."""
    count = names.index(goal)
    edges = tuple(reversed(up[:count]))
    same = [t for t in topics if t.parent == goal and any(c is not None for c in t.covariances)]
    sure = same[0] if len(same) == 1 else None
    body = 0
    if sure is not None:
        below = [edge.child for edge in edges]
        body = below.index(sure.child) + 1 if sure.child in below else _body(edges)
    return Way(goal, edges, sure=sure, body=body, notes=_drifts(goal))


def _body(edges: Sequence[Edge]) -> int:
    """Return how many links lead to the robot's body: all but the fixed ones at the end."""
    return len(edges) - _fixed_from_below(edges[::-1])


def _by_topic(tree: Tree, topic: PoseTopic, names: list[str], up: list[Edge], goal: str) -> Way:
    link = Edge(topic.parent, topic.child, topic.samples)
    above = list(tree.way_up(topic.parent))
    over = _above(tree, topic.parent)
    top = goal if goal in over else over[-1]
    head = (*reversed(above[: over.index(top)]), link)
    notes = _drifts(top)
    child, mount = topic.child, None
    if not child:  # a pose without a name: the robot's, which is where the fixed links begin
        bodies = [name for name in BODY_FRAMES if name in names]
        child = bodies[0] if bodies else names[_fixed_from_below(up)]
    if child in names:
        tail = tuple(reversed(up[: names.index(child)]))
    else:
        tail = ()
        if "optical" not in child:
            mount = OPTICAL
            notes += (
                f"no transform leads from {child} to the camera {names[0] or '(no frame)'}: it is "
                "taken to be there, looking ahead; mount=x,y,z,qx,qy,qz,qw would tell",
            )
    if not tail and not topic.child and mount is None:
        mount = OPTICAL
        notes += (f"{topic.name} is taken as a robot's pose; pose-of=FRAME would tell whose",)
    sure = topic if any(c is not None for c in topic.covariances) and top == topic.parent else None
    return Way(top, (*head, *tail), mount, sure, len(head), notes)


def _fixed_from_below(up: Sequence[Edge]) -> int:
    count = 0
    while count < len(up) and up[count].fixed is not None:
        count += 1
    return count


def _drifts(top: str) -> tuple[str, ...]:
    if top == "odom" or top.endswith("/odom"):
        return (
            f"poses are in {top}, which drifts: places of long ago may be off by metres; record "
            "the transform from map to odom",
        )
    return ()


def mount_of(text: str) -> Pose:
    """Return x,y,z,qx,qy,qz,qw: the camera's optical frame in the frame whose pose is known."""
    try:
        x, y, z, qx, qy, qz, qw = (float(part) for part in text.split(","))
    except ValueError as error:
        raise BadInput(f"the option mount is {text!r}; it takes x,y,z,qx,qy,qz,qw") from error
    if not all(map(math.isfinite, (x, y, z, qx, qy, qz, qw))):
        raise BadInput(f"the option mount is {text!r}, which is not finite")
    return Pose((x, y, z), (qx, qy, qz, qw))


def links_of(tree: Tree, topics: Sequence[PoseTopic]) -> list[Link]:
    """Return the tf tree's links, then those that topics of poses add."""
    own = [
        Link(topic.parent, f"{topic.child or '?'} (by {topic.name})", False, len(topic.samples))
        for topic in topics
        if len(topic.samples)
    ]
    return [*tree.links(), *own]
