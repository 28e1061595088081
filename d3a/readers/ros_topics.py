"""Which topics of a bag to read: told by the person, else by what they hold and are called.

Where two would do alike the person is asked, with both named: nothing is guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from d3a.model import BadInput
from d3a.readers import parsing, ros_pictures, ros_vision
from d3a.readers.ros_bag import Bag, Topic
from d3a.readers.ros_pictures import CAMERA_INFO, COMPRESSED, COMPRESSED_DEPTH, IMAGE

TF = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
ODOMETRY = "nav_msgs/msg/Odometry"
POSES = (
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    ODOMETRY,
    "geometry_msgs/msg/PoseStamped",
)
GRID = "nav_msgs/msg/OccupancyGrid"
TYPES: Mapping[str, tuple[str, ...]] = {
    "image": (IMAGE, COMPRESSED),
    "depth": (IMAGE, COMPRESSED),
    "camera-info": (CAMERA_INFO,),
    "pose": POSES,
    "detections": (ros_vision.DETECTIONS,),
    "map": (GRID,),
    "classes": (ros_vision.INFO, ros_vision.LABELS),
}
"""What `--topic NAME=TOPIC` may name, and the types that will do."""
NONE = "none"
COLOUR_WORDS = frozenset({"color", "colour", "rgb"})
ASIDE_WORDS = frozenset({"infra", "infra1", "infra2", "ir", "debug", "annotated", "overlay"})
ALIGNED_WORDS = ("aligned", "registered")
NO_POSE_WORDS = ("goal", "initial", "target", "click", "cmd", "setpoint", "waypoint")


@dataclass(frozen=True, slots=True)
class Looked:
    """A topic with its first message, read; None where that is broken or there is none."""

    topic: Topic
    message: Any

    @property
    def frame_id(self) -> str:
        """The coordinate frame of the first message, "" where unknown."""
        return "" if self.message is None else frame_id_of(self.message)


def frame_id_of(message: Any) -> str:
    """Return the frame of a message's header; ROS 1 may begin it with a slash."""
    return str(message.header.frame_id).lstrip("/")


def told(given: Mapping[str, str], bag: Bag) -> dict[str, str]:
    """Return the topic by role of `--topic`; BadInput for what cannot be."""
    chosen = {}
    for key, name in given.items():
        role = key.replace("_", "-")
        if role not in TYPES:
            raise BadInput(f"there is no topic {key!r} to choose; there are {', '.join(TYPES)}")
        topic = bag.topics.get(name) or bag.topics.get("/" + name)
        if name != NONE and topic is None:
            raise BadInput(_absent(role, name, bag))
        if topic is not None and topic.type not in TYPES[role]:
            raise BadInput(
                f"the topic {topic.name} is {topic.type}; for {role} it takes "
                f"{' or '.join(TYPES[role])}{_fitting(role, bag)}"
            )
        chosen[role] = NONE if topic is None else topic.name
    return chosen


def _absent(role: str, name: str, bag: Bag) -> str:
    hint = parsing.did_you_mean(name, _names_for(role, bag), cutoff=0.5)
    return f"the bag has no topic {name!r}{_fitting(role, bag)}.{hint}"


def _fitting(role: str, bag: Bag) -> str:
    return f"; for {role} it has {', '.join(_names_for(role, bag)) or 'none'}"


def _names_for(role: str, bag: Bag) -> list[str]:
    return [topic.name for topic in bag.topics.values() if topic.type in TYPES[role]]


class Choice:
    """Chooses a topic for each role; those of poses wait for the tf tree."""

    def __init__(self, bag: Bag, given: Mapping[str, str]) -> None:
        self._bag = bag
        self.told = told(given, bag)
        self._pictures = self._looked_at(TYPES["image"])
        self.image = self._image()
        self.depth = self._depth()
        self.detections = self._only("detections")
        self.camera_info = self._camera_info()
        self.map = self._map()

    def _filled(self, types: Collection[str]) -> list[Topic]:
        """Return the topics of these types that have messages, as far as that is known."""
        return [t for t in self._bag.topics.values() if t.type in types and t.count != 0]

    def _looked_at(self, types: Collection[str]) -> list[Looked]:
        return [self._look(topic) for topic in self._filled(types)]

    def _look(self, topic: Topic) -> Looked:
        message = self._bag.first(topic.name)
        try:
            return Looked(topic, None if message is None else self._bag.read(message))
        except BadInput:
            return Looked(topic, None)  # it is counted where the frames are read

    def of(self, role: str) -> Looked | None:
        """Return what was told for a role, None where nothing was."""
        name = self.told.get(role, NONE)
        return None if name == NONE else self._look(self._bag.topics[name])

    def _image(self) -> Looked | None:
        if "image" in self.told:
            return self.of("image")
        found = [each for each in self._pictures if not _is_depth(each)]
        return _one_of("image", found, self._image_rank)

    def _image_rank(self, each: Looked) -> tuple[int, ...]:
        words = _words(each.topic.name)
        is_colour = each.message is not None and ros_pictures.is_colour(each.message)
        return (
            not words & ASIDE_WORDS,
            self._beside(each.topic.name) is not None,
            is_colour,
            bool(words & COLOUR_WORDS),
        )

    def _depth(self) -> Looked | None:
        if "depth" in self.told:
            return self.of("depth")
        return _one_of("depth", [e for e in self._pictures if _is_depth(e)], self._depth_rank)

    def _depth_rank(self, each: Looked) -> tuple[int, ...]:
        if self.image is None:
            return (0,)
        same_frame = bool(each.frame_id) and each.frame_id == self.image.frame_id
        is_aligned = any(word in each.topic.name for word in ALIGNED_WORDS)
        return (same_frame, is_aligned, _shared(each.topic.name, self.image.topic.name))

    def _only(self, role: str) -> Looked | None:
        if role in self.told:
            return self.of(role)
        return _one_of(role, self._looked_at(TYPES[role]), lambda _: (0,))

    def _beside(self, name: str) -> Topic | None:
        """Return the CameraInfo that belongs to a picture's topic by its name."""
        parts = _camera_of(name).split("/")
        info = self._bag.topics.get("/".join((*parts[:-1], "camera_info")))
        return info if info is not None and info.type == CAMERA_INFO else None

    def _camera_info(self) -> Looked | None:
        """Return the camera's own CameraInfo, else the only one of its coordinate frame."""
        if "camera-info" in self.told:
            return self.of("camera-info")
        if self.image is not None and (own := self._beside(self.image.topic.name)) is not None:
            return self._look(own)
        infos = self._looked_at(TYPES["camera-info"])
        seen_from = self.image or self.detections
        if seen_from is not None and seen_from.frame_id:
            infos = [each for each in infos if each.frame_id == seen_from.frame_id]
        return infos[0] if len(infos) == 1 else None

    def _map(self) -> Looked | None:
        if "map" in self.told:
            return self.of("map")
        # costmaps are the planner's
        plans = [t for t in self._filled(TYPES["map"]) if "costmap" not in t.name]
        return _one_of("map", [Looked(t, None) for t in plans], lambda e: (e.topic.name == "/map",))

    def tf(self) -> tuple[list[str], list[str]]:
        """Return the topics of moving and of fixed transforms."""
        names = [t.name for t in self._bag.topics.values() if t.type in TF]
        return (
            [name for name in names if not name.endswith("tf_static")],
            [name for name in names if name.endswith("tf_static")],
        )

    def poses(self) -> list[Looked]:
        """Return what may tell where the robot was: what was told, else all but goals."""
        if "pose" in self.told:
            chosen = self.of("pose")
            return [] if chosen is None else [chosen]
        return [
            self._look(t)
            for t in self._filled(POSES)
            if not any(word in t.name.lower() for word in NO_POSE_WORDS)
        ]

    def classes(self) -> list[str]:
        """Return the topics that may name classes."""
        if "classes" in self.told:
            return [name for name in [self.told["classes"]] if name != NONE]
        return [t.name for t in self._bag.topics.values() if t.type in TYPES["classes"]]

    def notes(self) -> tuple[str, ...]:
        """Return what was chosen where there was another, a sentence each."""
        notes = []
        for role, chosen in (("image", self.image), ("depth", self.depth)):
            if chosen is None or role in self.told:
                continue
            others = [
                each.topic.name
                for each in self._pictures
                if _is_depth(each) == (role == "depth") and each.topic.name != chosen.topic.name
            ]
            if others:
                notes.append(
                    f"{role}: {chosen.topic.name} is read, not {', '.join(others)} "
                    f"(--topic {role}=... reads another)"
                )
        return tuple(notes)


def _one_of(
    role: str, found: Sequence[Looked], rank: Callable[[Looked], tuple[int, ...]]
) -> Looked | None:
    """Return the best, of one camera's several forms the plain one; BadInput where two are alike.

    Forms of one camera are the same picture: raw, rectified or compressed.
    """
    if not found:
        return None
    best = max(map(rank, found))
    alike = [each for each in found if rank(each) == best]
    if role in ("image", "depth"):
        cameras = {_camera_of(each.topic.name).rpartition("/")[0] for each in alike}
        if len(cameras) == 1:
            return min(alike, key=lambda e: (_form(e.topic), e.topic.name))
    if len(alike) == 1:
        return alike[0]
    listed = ", ".join(
        f"{e.topic.name} ({e.topic.type}, {'?' if e.topic.count is None else e.topic.count})"
        for e in alike
    )
    raise BadInput(
        f"the bag has {len(alike)} topics that may be the {role}: {listed}; say which one: "
        f"--topic {role}={alike[0].topic.name}, or {role}={NONE}"
    )


def _form(topic: Topic) -> tuple[int, int]:
    """Rank the forms of one camera's picture: raw before rectified, whole before compressed."""
    return ("rect" in topic.name.rpartition("/")[2], topic.type == COMPRESSED)


def is_rectified(name: str) -> bool:
    """Say whether a picture's topic is one that lens distortion was taken out of."""
    return "rect" in _camera_of(name).rpartition("/")[2].split("_")


def _camera_of(name: str) -> str:
    """Return a picture's topic without what its transport adds."""
    base, _, last = name.rpartition("/")
    return base if last in ("compressed", COMPRESSED_DEPTH, "theora", "ffmpeg") else name


def _words(name: str) -> frozenset[str]:
    return frozenset(name.lower().replace("_", "/").split("/"))


def _is_depth(each: Looked) -> bool:
    if each.message is not None and ros_pictures.kind_of(each.message):
        return ros_pictures.is_depth(each.message)
    return "depth" in each.topic.name.lower() or COMPRESSED_DEPTH in each.topic.name


def _shared(first: str, second: str) -> int:
    """Return how many parts two names have in common from the left."""
    count = 0
    for a, b in zip(first.strip("/").split("/"), second.strip("/").split("/"), strict=False):
        if a != b:
            break
        count += 1
    return count
