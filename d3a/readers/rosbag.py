"""ROS bags: pictures, depth, poses, boxes and a map, by what the topics hold.

ROS 1 (`.bag`) and ROS 2 (SQLite and MCAP), through rosbags (extra `ros`). Times are those of the
headers. A frame is a picture of the chosen topic; where a topic of boxes is read, one that the
detector has looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from d3a import images
from d3a.model import BadInput, Camera, Depth, Detection, Frame, Image, Json, Pose
from d3a.readers import beside, parsing, ros_pictures, ros_vision
from d3a.readers.base import Link, RecordingFacts, Skipped, Stream
from d3a.readers.cameras import Lens
from d3a.readers.options import CAMERA, Options
from d3a.readers.ros_bag import METADATA, Bag, Message, bag_files
from d3a.readers.ros_described import name_of, notes_of, streams_of, time_ms_of
from d3a.readers.ros_index import (
    BROKEN_MESSAGE,
    NEVER,
    NO_STAMP,
    Follower,
    Index,
    Scan,
    Stamps,
    each_its_own,
    nearest,
)
from d3a.readers.ros_map import floor_of
from d3a.readers.ros_poses import MAP, PoseTopic, Way, find_way, links_of, mount_of
from d3a.readers.ros_tf import IDENTITY, Reach
from d3a.readers.ros_topics import Choice, Looked, frame_id_of, is_rectified
from d3a.readers.tracks import Track, read_track

POSE_GAP_S, POSE_HOLD_S = 1.5, 0.1
"""Robots tell their pose ten times a second and more, and corrections of the map each second."""
PAIR_GAP_S = 0.02
"""Of depth and boxes to their picture; drivers and detectors give them the picture's own time."""
UNIX_FROM_NS = 10**17
"""Stamps below count from the start of a simulation, or of the robot."""
OPTIONS = {
    **CAMERA,
    "topic.": "NAME=TOPIC by --topic: image, depth, camera-info, pose, detections, map, classes",
    "stamps": "header (the usual), or receive: the times when the recorder got the messages",
    "start": "ISO time that stamps from an unknown start count from",
    "poses": "FILE of the camera's poses instead of tf: time x y z qx qy qz qw",
    "pose-gap": "SECONDS between two transforms that may be interpolated (1.5)",
    "pose-hold": "SECONDS that a transform holds where no other is near (0.1)",
    "pair-gap": "SECONDS from a picture to its depth and its boxes (0.02)",
    "map-frame": "coordinate frame that places are told in (map)",
    "pose-of": "coordinate frame whose pose the pose topic tells",
    "mount": "x,y,z,qx,qy,qz,qw of the camera's optical frame on what the poses are of",
    "classes": "FILE with a class name a line, for boxes that bear numbers",
}
BROKEN_PICTURE, BROKEN_DEPTH = "broken picture", "broken depth picture"
NOT_LOOKED = "picture that no detector has looked at (detections=none reads all)"
NO_PICTURE = "boxes of a time without a picture"
NO_DEPTH = "no depth picture near in time"
NO_WAY = "transforms that do not reach the camera at the time"


def looks_like(path: Path) -> bool:
    """Say whether it is a bag, or a folder of one."""
    if path.is_dir() and (path / METADATA).is_file():
        try:
            return b"rosbag2_bagfile_information" in (path / METADATA).read_bytes()[:200]
        except OSError:
            return False
    return bool(bag_files(path))


class RosbagReader:
    """Frames of a bag, in the order of its pictures."""

    looked_for = "a .bag, .mcap or .db3 file, or a folder with metadata.yaml or .bag files"

    def __init__(self, source: Path, options: Options) -> None:
        self._bag = Bag(source)
        self._choice = Choice(self._bag, options.below("topic"))
        main = self._choice.image or self._choice.detections
        if main is None:
            raise BadInput(
                f"{source} has no topic with pictures (sensor_msgs Image, CompressedImage) nor "
                f"boxes (vision_msgs Detection2DArray); it has {_listed(self._bag)}"
            )
        self._main = main
        self._reach = Reach(
            options.positive("pose-gap", POSE_GAP_S) * 1e9,
            options.positive("pose-hold", POSE_HOLD_S) * 1e9,
        )
        self._poses_file = options.file("poses")
        self._clock = options.clock()
        self._track: Track | None = None
        self._pair_ns = options.positive("pair-gap", PAIR_GAP_S) * 1e9
        self._lens = Lens.of(options) if options.text("camera") else None
        self._stamps, undated = self._stamps_of(options)
        self._names = self._class_names(options)
        self._index = self._scanned(options)
        self._way = self._found_way(options)
        self._pair()
        map_record = self._floor()
        self.skipped = self._fresh()
        self.facts = RecordingFacts(
            name=options.usual_name,
            zone=options.zone,
            frames=len(self._wanted),
            classes=tuple(dict.fromkeys(self._names.values())),
            notes=beside.undated(
                notes_of(self._choice, self._way, self._index), is_undated=undated
            ),
            map=map_record,
        )

    def _stamps_of(self, options: Options) -> tuple[Stamps, bool]:
        """Return the clock of the messages, and whether their date is not known."""
        by_receive = options.choice("stamps", ("header", "receive")) == "receive"
        stamps = Stamps(self._bag, by_receive)
        first = self._bag.first(self._main.topic.name)
        stamp = None if first is None else stamps.of(first)
        if stamp is None or stamp >= UNIX_FROM_NS:
            return stamps, False
        clock = self._clock
        return replace(stamps, offset_ns=clock.origin_ms * 10**6), clock.start_ms is None

    def _class_names(self, options: Options) -> dict[str, str]:
        path = options.file("classes")
        if path is not None:
            return ros_vision.names_in_file(path)
        names: dict[str, str] = {}
        for topic in self._choice.classes():
            message = self._bag.first(topic)
            try:
                said = {} if message is None else ros_vision.class_names(self._bag.read(message))
            except BadInput:
                said = {}  # boxes then keep their numbers, which is noted
            names |= {number: parsing.clean_text(name) for number, name in said.items()}
        return names

    def _scanned(self, options: Options) -> Index:
        choice = self._choice
        moving, fixed = choice.tf()
        child = options.text("pose-of")
        poses = {each.topic.name: PoseTopic.of(each, child) for each in choice.poses()}
        info = None if choice.camera_info is None else choice.camera_info.topic.name
        timed = (choice.image, choice.depth, choice.detections)
        return Scan(
            self._bag,
            self._stamps,
            moving,
            fixed,
            poses,
            info,
            [each.topic.name for each in timed if each is not None],
            self._frame_ids(),
            _size_of(choice.image),
            choice.image is not None and is_rectified(choice.image.topic.name),
        ).run()

    def _frame_ids(self) -> list[str]:
        """Return the names that the camera's coordinate frame may have, the likeliest first."""
        choice = self._choice
        told = [choice.image, choice.camera_info, choice.detections]
        if choice.image is None:
            told.append(choice.depth)
        return list(dict.fromkeys(e.frame_id for e in told if e is not None and e.frame_id))

    def _found_way(self, options: Options) -> Way | str:
        if self._poses_file is not None:
            return f"poses are those of {self._poses_file.name}"
        way = find_way(
            self._index.tree,
            self._index.poses,
            self._frame_ids(),
            options.text("map-frame"),
            "pose" in self._choice.told and bool(self._index.poses),
        )
        mount = options.text("mount")
        if mount is not None and not isinstance(way, str):
            return replace(way, mount=mount_of(mount), notes=())
        return way

    def _pair(self) -> None:
        """Find which depth and boxes belong to which picture."""
        choice, times = self._choice, self._index.times
        frames = times[self._main.topic.name]
        self._depths: dict[int, int] = {}
        if choice.depth is not None:
            self._depths = nearest(frames, times[choice.depth.topic.name], self._pair_ns)
        self._boxes: dict[int, int] = {}
        self._homeless: list[int] = []
        if choice.detections is not None and self._main is not choice.detections:
            others = times[choice.detections.topic.name]
            self._boxes, self._homeless = each_its_own(frames, others, self._pair_ns)
            self._wanted = sorted(self._boxes)
        else:
            self._wanted = [n for n, time_ns in enumerate(frames) if time_ns != NEVER]

    def _fresh(self) -> Skipped:
        """Return what was left out before any frame is made."""
        skipped = Skipped()
        skipped.join(self._bag.skipped)
        skipped.join(self._index.skipped)
        if self._choice.detections is not None:
            times = self._index.times[self._choice.detections.topic.name]
            for number in self._homeless:
                where = "no time" if times[number] == NEVER else name_of(time_ms_of(times[number]))
                skipped.add(NO_PICTURE, where)
        return skipped

    def _floor(self) -> Json | None:
        """Return the map as a store keeps it; one in another frame than the poses' is left out."""
        if self._choice.map is None:
            return None
        topic = self._choice.map.topic.name
        message = self._bag.last(topic)
        if message is None:
            return None
        try:
            grid = self._bag.read(message)
            return floor_of(grid, MAP if isinstance(self._way, str) else self._way.top).to_json()
        except BadInput as error:
            self._index.skipped.add(BROKEN_MESSAGE, f"{topic} ({error})")
            return None

    def __iter__(self) -> Iterator[Frame]:
        """Yield a frame for each picture; the ingest counts those that go back in time."""
        self.skipped = self._fresh()
        if self._poses_file is not None:
            self._track = read_track(self._poses_file, self._clock, self.skipped)
        times = self._index.times[self._main.topic.name]
        depths, boxes = self._followers()
        has_boxes = self._choice.detections is not None
        row = 0
        for number, message in enumerate(self._bag.messages([self._main.topic.name])):
            if number >= len(times) or times[number] == NEVER:
                self.skipped.add(NO_STAMP, f"{message.topic}: message {number + 1}")
                continue
            time_ms = time_ms_of(times[number])
            name = name_of(time_ms)
            if boxes is not None and number not in self._boxes:
                self.skipped.add(NOT_LOOKED, name)
                continue
            pose = self._pose(times[number], name)
            found: tuple[Detection, ...] | None = None
            if has_boxes:
                looked = message if boxes is None else boxes.take(self._boxes[number])
                found = self._detections(looked, pose, row, name)
                if found is None:
                    continue
                row += len(found)
            image, size = (
                (None, None) if boxes is None and has_boxes else self._image(message, name)
            )
            yield Frame(
                name=name,
                time_ms=time_ms,
                pose=pose,
                camera=self._camera(times[number], image, size),
                image=image,
                depth=self._depth(depths, number, name),
                detections=found,
            )

    def _followers(self) -> tuple[Follower | None, Follower | None]:
        choice, bag = self._choice, self._bag
        depths = boxes = None
        if choice.depth is not None:
            depths = Follower(bag.messages([choice.depth.topic.name]), self._depths)
        if choice.detections is not None and choice.detections is not self._main:
            boxes = Follower(bag.messages([choice.detections.topic.name]), self._boxes)
        return depths, boxes

    def _pose(self, time_ns: int, name: str) -> Pose | None:
        """Return the camera's pose; a frame that has none, where there are any, is counted."""
        if self._track is not None:
            held = self._track.at(time_ms_of(time_ns), self._reach.between_ns / 2e6)
            if held is None:
                self.skipped.add(beside.NO_POSE, name)
            return held
        if isinstance(self._way, str):
            return None
        try:
            pose = self._way.at(time_ns, self._reach)
        except BadInput as error:
            self.skipped.add(NO_WAY, f"{name} ({error})")
            return None
        if pose is None:
            self.skipped.add(NO_WAY, f"{name} ({self._way.missing(time_ns, self._reach)})")
        return pose

    def _image(self, message: Message, name: str) -> tuple[Image | None, tuple[int, int] | None]:
        """Return the picture and its size; a broken one is counted, and the frame goes on."""
        try:
            record = self._bag.read(message)
            image = ros_pictures.picture_of(record)
        except BadInput as error:
            self.skipped.add(BROKEN_PICTURE, f"{name} ({error})")
            return None, None
        try:
            return image, images.size(image)
        except BadInput:
            return image, None  # the ingest counts and names it

    def _camera(
        self, time_ns: int, image: Image | None, size: tuple[int, int] | None
    ) -> Camera | None:
        if self._lens is not None:
            return self._lens.camera(image)
        return self._index.camera_at(time_ns, size)

    def _depth(self, depths: Follower | None, number: int, name: str) -> Depth | None:
        if depths is None:
            return None
        message = depths.take(self._depths[number]) if number in self._depths else None
        if message is None:
            self.skipped.add(NO_DEPTH, name)
            return None
        try:
            return ros_pictures.depth_of(self._bag.read(message))
        except BadInput as error:
            self.skipped.add(BROKEN_DEPTH, f"{name} ({error})")
            return None

    def _detections(
        self, message: Message | None, pose: Pose | None, row: int, name: str
    ) -> tuple[Detection, ...] | None:
        """Return the boxes of a message; None where it cannot be read: then nobody has looked."""
        if message is None:
            self.skipped.add(NOT_LOOKED, name)
            return None
        try:
            record = self._bag.read(message)
        except BadInput as error:
            self.skipped.add(BROKEN_MESSAGE, f"{message.topic} ({error})")
            return None
        seen_from = self._seen_from(frame_id_of(record), pose)
        found: list[Detection] = []
        for each in record.detections:
            try:
                detection = ros_vision.detection_of(
                    each, self._names, seen_from, self.skipped, name
                )
            except BadInput as error:
                self.skipped.add(parsing.BROKEN_DETECTION, f"{name} ({error})")
                continue
            found.append(replace(detection, row=row + len(found)))
        return tuple(found)

    def _seen_from(self, frame_id: str, pose: Pose | None) -> Pose | None:
        """Return where boxes are seen from, if their frame is the camera's, or the map."""
        if not isinstance(self._way, str) and frame_id == self._way.top:
            return IDENTITY
        return pose if frame_id in self._frame_ids() else None

    def streams(self) -> Sequence[Stream]:
        """Return every topic with its times; those that are read say as what."""
        sure = None if isinstance(self._way, str) else self._way.sure
        return streams_of(self._bag, self._choice, self._stamps, sure)

    def links(self) -> Sequence[Link]:
        """Return the tf tree, and the links that topics of poses add."""
        return links_of(self._index.tree, self._index.poses)


def _size_of(looked: Looked | None) -> tuple[int, int] | None:
    if looked is None or looked.message is None:
        return None
    if hasattr(looked.message, "encoding"):
        return int(looked.message.width), int(looked.message.height)
    try:
        return images.size(bytes(looked.message.data))
    except BadInput:
        return None


def _listed(bag: Bag) -> str:
    return ", ".join(f"{topic.name} ({topic.type})" for topic in list(bag.topics.values())[:8])
