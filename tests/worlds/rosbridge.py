"""A robot's rosbridge, as far as a subscriber sees it: v2 JSON over a websocket.

`python rosbridge.py PORT RATE_HZ DROP_AT GONE` says when it listens, and plays the small recording
of `folders` from the first subscription on, once; before frame DROP_AT the connection is cut, and
GONE frames pass before one can connect again (0: it is not cut).
"""

from __future__ import annotations

import base64
import importlib
import json
import sys
from typing import Any

from tests.worlds.folders import Moment, depth_of, found, moments
from tests.worlds.rounds import CAMERA, jpeg

Message = tuple[str, dict[str, Any]]
websocket: Any = importlib.import_module("autobahn.twisted.websocket")  # without types
reactor: Any = importlib.import_module("twisted.internet.reactor")
tasks: Any = importlib.import_module("twisted.internet.task")


def header(moment: Moment, frame: str) -> dict[str, Any]:
    stamp = {"sec": moment.time_ms // 1000, "nanosec": moment.time_ms % 1000 * 10**6}
    return {"stamp": stamp, "frame_id": frame}


def packed(content: bytes) -> str:
    return base64.b64encode(content).decode()


def box(row: dict[str, Any]) -> dict[str, Any]:
    x1, y1, x2, y2 = row["box"]
    zero = {"position": dict.fromkeys("xyz", 0.0), "orientation": dict.fromkeys("xyzw", 0.0)}
    hypothesis = {"class_id": row["category"], "score": row["probability"]}
    return {
        "results": [{"hypothesis": hypothesis, "pose": {"pose": zero, "covariance": [0.0] * 36}}],
        "bbox": {
            "center": {"position": {"x": (x1 + x2) / 2, "y": (y1 + y2) / 2}, "theta": 0.0},
            "size_x": x2 - x1,
            "size_y": y2 - y1,
        },
        "id": "",
    }


def link(moment: Moment, parent: str, child: str, pose: tuple[float, ...]) -> dict[str, Any]:
    x, y, z, *turn = pose
    return {
        "header": header(moment, parent),
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x, "y": y, "z": z},
            "rotation": dict(zip("xyzw", turn, strict=True)),
        },
    }


def calibration(moment: Moment) -> dict[str, Any]:
    k = [CAMERA.fx, 0, CAMERA.cx, 0, CAMERA.fy, CAMERA.cy, 0, 0, 1]
    return {
        "header": header(moment, "camera"),
        "height": CAMERA.height,
        "width": CAMERA.width,
        "k": k,
        "p": [*k[:3], 0, *k[3:6], 0, *k[6:], 0],
        "d": [],
        "binning_x": 0,
        "binning_y": 0,
        "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0},
    }


def messages(moment: Moment) -> list[Message]:
    """What the robot says of a moment; the boxes come last, as a detector takes its time."""
    still = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    depth = depth_of(moment, 1000.0)
    return [
        ("/tf_static", {"transforms": [link(moment, "base_link", "camera", still)]}),
        ("/tf", {"transforms": [link(moment, "map", "base_link", moment.pose)]}),
        ("/cam/camera_info", calibration(moment)),
        (
            "/cam/image/compressed",
            {
                "header": header(moment, "camera"),
                "format": "jpeg",
                "data": packed(jpeg(moment.shade)),
            },
        ),
        (
            "/cam/depth/compressed",
            {"header": header(moment, "camera"), "format": "16UC1; png", "data": packed(depth)},
        ),
        ("/boxes", {"header": header(moment, "camera"), "detections": [*map(box, found(moment))]}),
    ]


class Bridge(websocket.WebSocketServerProtocol):  # type: ignore[misc]  # of Any
    """One subscriber."""

    def onOpen(self) -> None:  # noqa: N802
        self.topics: set[str] = set()
        self.factory.robot.clients.append(self)

    def onMessage(self, payload: bytes, is_binary: bool) -> None:  # noqa: N802
        record = json.loads(payload)
        if record["op"] == "subscribe":
            self.topics.add(record["topic"])
            self.factory.robot.begin()

    def onClose(self, *_: object) -> None:  # noqa: N802
        if self in self.factory.robot.clients:
            self.factory.robot.clients.remove(self)


class Robot:
    """Plays the moments, whoever listens."""

    def __init__(self, port: int, rate_hz: float, drop_at: int, gone: int) -> None:
        self.clients: list[Bridge] = []
        self._port, self._rate_hz, self._drop_at, self._gone = port, rate_hz, drop_at, gone
        self._factory = websocket.WebSocketServerFactory()
        self._factory.protocol = Bridge
        self._factory.robot = self
        self._listening = reactor.listenTCP(port, self._factory, interface="127.0.0.1")
        self._moments = list(enumerate(moments()))
        self._loop = tasks.LoopingCall(self._step)

    def begin(self) -> None:
        if not self._loop.running and self._moments:
            reactor.callLater(0.5, self._start)  # until all is subscribed

    def _start(self) -> None:
        if not self._loop.running and self._moments:
            self._loop.start(1 / self._rate_hz)

    def _step(self) -> None:
        if not self._moments:
            self._loop.stop()
            return
        number, moment = self._moments.pop(0)
        if self._gone and number == self._drop_at:
            self._listening.stopListening()
            for client in list(self.clients):
                client.transport.abortConnection()
        if self._gone and number == self._drop_at + self._gone:
            self._listening = reactor.listenTCP(self._port, self._factory, interface="127.0.0.1")
        for topic, message in messages(moment):
            text = json.dumps({"op": "publish", "topic": topic, "msg": message}).encode()
            for client in self.clients:
                if topic in client.topics:
                    client.sendMessage(text)


if __name__ == "__main__":
    port, rate, drop_at, gone = sys.argv[1:]
    Robot(int(port), float(rate), int(drop_at), int(gone))
    sys.stdout.write("listening\n")
    sys.stdout.flush()
    reactor.run()
