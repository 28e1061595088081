"""A live robot through rosbridge: its messages as they come, as frames.

The topics are named by the person (`--topic image=/camera/image_raw`). What was missed while the
connection was lost, and what came faster than it could be taken in, is counted and said.
"""

from __future__ import annotations

import importlib.util
import queue
from collections import deque
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Any

from d3a.model import BadInput, Frame, Json
from d3a.readers.base import RecordingFacts, Skipped
from d3a.readers.options import Options
from d3a.watch.messages import message_of
from d3a.watch.patience import Patience
from d3a.watch.robot import Robot

LOST = "connection to the robot lost, with what it saw meanwhile"
TOO_FAST = "frame that came faster than frames could be taken in"
WAITING_MOST = 100
"""Frames that wait to be taken in; then the oldest give way, so that answers stay fresh."""
MESSAGES_MOST = 10_000
FIRST_DELAY_S, MOST_DELAY_S = 0.5, 15.0
"""Between attempts to connect, growing from one to the other."""
ANSWER_S = 2.0
TYPES = {
    "image": "sensor_msgs/Image",
    "depth": "sensor_msgs/Image",
    "camera-info": "sensor_msgs/CameraInfo",
    "detections": "vision_msgs/Detection2DArray",
    "pose": "geometry_msgs/PoseWithCovarianceStamped",
    "tf": "tf2_msgs/TFMessage",
    "tf-static": "tf2_msgs/TFMessage",
    "classes": "vision_msgs/LabelInfo",
}
"""What a topic of each role is, where the robot's rosapi does not tell."""
COMPRESSED = "sensor_msgs/CompressedImage"
USUAL = {"tf": "/tf", "tf-static": "/tf_static"}
OPTIONS = {
    "topic.": "NAME=TOPIC by --topic: " + ", ".join(TYPES),
    "map-frame": "coordinate frame that places are told in (map)",
}


def is_address(source: str) -> bool:
    """Say whether a source is the address of a rosbridge."""
    return source.startswith(("ws://", "wss://"))


class RosbridgeFollower:
    """Frames of a robot, from when it is first heard until it is stopped."""

    def __init__(
        self, address: str, patience: Patience, options: Options, on_note: Callable[[str], None]
    ) -> None:
        """Check what was asked for; nothing is connected yet. Raises BadInput without roslibpy."""
        self._address = address
        self._patience = patience
        self._note = on_note
        self._topics = _topics_of(options)
        if importlib.util.find_spec("roslibpy") is None:
            raise BadInput("a live robot needs roslibpy: pip install 'd3a[ros]'")
        self._map_frame = options.text("map-frame")
        self._inbox: queue.Queue[tuple[str, Json]] = queue.Queue(MESSAGES_MOST)
        self._lost_at: float | None = None
        self._is_heard = False
        self._is_closing = False
        self.skipped = Skipped()
        name = address.split("//", 1)[1].rstrip("/")
        self.facts = RecordingFacts(
            options.text("name") or name, site=options.text("site") or "", zone=options.zone
        )

    def __iter__(self) -> Iterator[Frame | None]:
        """Yield frames as they come, and None at each look that found none."""
        self.skipped = Skipped()
        robot = Robot(self._topics.keys(), self._map_frame, self._patience, self.skipped)
        ready: deque[Frame] = deque()
        client = self._connected()
        try:
            while not self._patience.should_stop() and not self._patience.is_over():
                self._hear(robot)
                ready.extend(robot.frames())
                while len(ready) > WAITING_MOST:
                    self.skipped.add(TOO_FAST, ready.popleft().name)
                if ready:
                    yield ready.popleft()
                else:
                    yield None
                    self._patience.pause()
            self._hear(robot)
            yield from (*ready, *robot.rest())
        finally:
            self._close(client)

    def _hear(self, robot: Robot) -> None:
        for _ in range(self._inbox.qsize()):
            role, record = self._inbox.get_nowait()
            self._patience.grew()
            if self._lost_at is not None and self._is_heard:
                gone_s = monotonic() - self._lost_at
                self._note(f"connected again; {gone_s:.1f} s of what the robot saw are missing")
                self.skipped.add(LOST, f"{gone_s:.1f} s")
                self._lost_at = None
            self._is_heard = True
            robot.take(role, message_of(record))

    def _connected(self) -> Any:
        """Begin to connect, and to subscribe whenever that succeeds; return the client."""
        import roslibpy

        client = roslibpy.Ros(self._address)
        client.factory.set_initial_delay(FIRST_DELAY_S)
        client.factory.set_max_delay(MOST_DELAY_S)
        client.on("close", self._on_close)
        for role, topic in self._topics.items():
            kind = COMPRESSED if _is_compressed(topic) else TYPES[role]
            listener = roslibpy.Topic(client, topic, kind, queue_length=1)
            listener.subscribe(self._listener(role))
        try:
            client.run(timeout=ANSWER_S)
        except roslibpy.core.RosTimeoutError:
            self._note(f"{self._address} does not answer; trying again until it does")
        return client

    def _close(self, client: Any) -> None:
        """End the connection; roslibpy would go on trying after a robot that is not there."""
        self._is_closing = True
        client.factory.maxRetries = 0  # of this client: `set_max_retries` is for all
        client.on_ready(client.close)  # an attempt that is under way may still succeed
        client.close()

    def _listener(self, role: str) -> Callable[[Json], None]:
        def heard(record: Json) -> None:
            try:
                self._inbox.put_nowait((role, record))
            except queue.Full:
                self.skipped.add(TOO_FAST, role)

        return heard

    def _on_close(self, _: object) -> None:
        if self._lost_at is None and not self._is_closing:
            self._lost_at = monotonic()
            self._note(f"the connection to {self._address} is lost; trying again")


def _topics_of(options: Options) -> dict[str, str]:
    """Return the topic of each role that is read; BadInput for what cannot be."""
    told = {key.replace("_", "-"): name for key, name in options.below("topic").items()}
    unknown = sorted(told.keys() - TYPES.keys())
    if unknown:
        raise BadInput(f"there is no topic {unknown[0]!r} to choose; there are {', '.join(TYPES)}")
    if not told.keys() & {"image", "detections"}:
        raise BadInput(
            "a live robot needs --topic image=/its/pictures, or --topic detections=/its/boxes, "
            "or both"
        )
    return USUAL | told


def _is_compressed(topic: str) -> bool:
    return "compressed" in topic.rsplit("/", 1)[-1].lower()
