"""A live robot through rosbridge: a fake one that speaks the protocol, in a process of its own."""

from __future__ import annotations

import base64
import importlib
import importlib.util
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from d3a.ingest import ingest
from d3a.model import BadInput, Frame, Json
from d3a.parameters import DEFAULT
from d3a.readers.base import Skipped
from d3a.readers.opening import open_source
from d3a.watch import Patience, Watching, follow, watch
from d3a.watch.messages import message_of
from d3a.watch.robot import BROKEN, BROKEN_PICTURE, NO_POSE, NOT_LOOKED, Robot
from d3a.watch.rosbridge import LOST
from tests.worlds.folders import as_recording, moments
from tests.worlds.oracle import OracleStore

ROOT = Path(__file__).resolve().parents[3]
TOPICS = {
    "topic.image": "/cam/image/compressed",
    "topic.depth": "/cam/depth/compressed",
    "topic.camera-info": "/cam/camera_info",
    "topic.detections": "/boxes",
    "name": "same",
    "site": "lab",
}
needs_roslibpy = pytest.mark.skipif(
    importlib.util.find_spec("roslibpy") is None, reason="roslibpy is not installed (extra ros)"
)


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


def no_call_is_left(within_s: float) -> bool:
    """Wait until nothing is planned in the event loop that roslibpy runs."""
    reactor: Any = importlib.import_module("twisted.internet.reactor")
    end = time.monotonic() + within_s
    while reactor.getDelayedCalls() and time.monotonic() < end:
        time.sleep(0.05)
    return not reactor.getDelayedCalls()


@contextmanager
def robot(port: int, rate_hz: float, drop_at: int = 0, gone: int = 0) -> Iterator[str]:
    command = [sys.executable, str(ROOT / "tests/worlds/rosbridge.py")]
    command += [str(port), str(rate_hz), str(drop_at), str(gone)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == "listening\n"
        yield f"ws://127.0.0.1:{port}"
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def heard(address: str, idle_s: float, notes: list[str]) -> tuple[Json, OracleStore]:
    store, patience = OracleStore(), Patience(idle_s, 1.0, 0.02)
    summary = watch(
        lambda: follow(address, patience, zone="UTC", options=TOPICS, on_note=notes.append),
        store,
        Watching(DEFAULT, patience.should_stop, is_resumable=False),
    )
    assert summary is not None
    return summary.skipped.counts, store


@needs_roslibpy
def test_a_live_robot_fills_the_store_of_its_recording(tmp_path: Path) -> None:
    notes: list[str] = []
    with robot(free_port(), 10.0) as address:
        counts, store = heard(address, 6.0, notes)
    plain = OracleStore()
    ingest(open_source(as_recording(tmp_path / "r")), plain, DEFAULT)
    assert counts == {}
    assert list(store.dump()) == list(plain.dump())
    assert not [note for note in notes if "lost" in note]


@needs_roslibpy
def test_a_lost_connection_is_said_and_taken_up_again() -> None:
    notes: list[str] = []
    with robot(free_port(), 1.0, drop_at=3, gone=1) as address:
        counts, store = heard(address, 8.0, notes)
    (record,) = store.recordings()
    assert 4 <= record.frames < len(moments())
    assert record.last_frame == moments()[-1].name
    assert counts[LOST] == 1
    assert any("is lost; trying again" in note for note in notes)
    assert any("connected again" in note for note in notes)


@needs_roslibpy
def test_a_robot_that_is_not_there_is_said_and_waited_for() -> None:
    notes: list[str] = []
    patience = Patience(3.0, 1.0, 0.02)
    address = f"ws://127.0.0.1:{free_port()}"
    started = time.monotonic()
    with pytest.raises(BadInput, match="no frame"):
        watch(
            lambda: follow(address, patience, options=TOPICS, on_note=notes.append),
            OracleStore(),
            Watching(DEFAULT, patience.should_stop, is_resumable=False),
        )
    assert time.monotonic() - started < 20
    assert notes == [f"{address} does not answer; trying again until it does"]
    assert no_call_is_left(within_s=20), "it still tries to connect"


@pytest.mark.parametrize(
    ("options", "said"),
    [({}, "needs --topic image"), ({"topic.imge": "/x"}, "no topic 'imge' to choose")],
)
def test_topics_have_to_be_named(options: dict[str, str], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        follow("ws://127.0.0.1:1", Patience(1.0), options=options)


def stamped(time_s: float, frame: str = "camera") -> Json:
    nanoseconds = round(time_s * 1e9)
    stamp = {"secs": nanoseconds // 10**9, "nsecs": nanoseconds % 10**9}  # as ROS 1 has them
    return {"stamp": stamp, "frame_id": frame}


def image(time_s: float, **fields: Any) -> Json:
    pixels = np.full((4, 6, 3), 90, np.uint8)
    form = {"height": 4, "width": 6, "encoding": "rgb8", "is_bigendian": 0, "step": 18}
    data = base64.b64encode(pixels.tobytes()).decode()
    return {"header": stamped(time_s)} | form | {"data": data} | fields


def frames_of(said: list[tuple[str, Json]], *roles: str) -> tuple[list[Frame], Json]:
    skipped = Skipped()
    made = Robot(roles, None, Patience(settle_s=0.0), skipped)
    for role, record in said:
        made.take(role, message_of(record))
    return [*made.frames(), *made.rest()], skipped.counts


def test_raw_pictures_without_anything_else() -> None:
    (frame,), counts = frames_of([("image", image(1.5))], "image")
    assert (frame.name, frame.time_ms) == ("1.500", 1500)
    assert isinstance(frame.image, np.ndarray)
    assert frame.image.shape == (4, 6, 3)
    assert (frame.detections, frame.depth, frame.camera) == (None, None, None)
    assert counts == {NO_POSE: 1}


@pytest.mark.parametrize("data", ["", "no base64!", [1, 2], None])
def test_a_broken_picture_is_counted_and_the_frame_goes_on(data: object) -> None:
    (frame,), counts = frames_of([("image", image(1.0, data=data))], "image")
    assert frame.image is None
    assert counts == {BROKEN_PICTURE: 1, NO_POSE: 1}


def test_messages_that_lack_fields_are_counted() -> None:
    said: list[tuple[str, Json]] = [
        ("tf", {}),
        ("tf", {"transforms": [{"header": stamped(1.0)}]}),
        ("image", {"data": ""}),
        ("detections", {"header": {}}),
        ("pose", {"header": stamped(1.0)}),
    ]
    frames, counts = frames_of(said, "image", "detections")
    assert frames == []
    assert counts == {BROKEN: 5}


def test_a_picture_without_its_boxes_was_not_looked_at() -> None:
    boxes = {"header": stamped(2.0), "detections": []}
    said = [("image", image(1.0)), ("image", image(2.0)), ("detections", boxes)]
    (frame,), counts = frames_of(said, "image", "detections")
    assert frame.detections == ()
    assert counts == {NOT_LOOKED: 1, NO_POSE: 1}


def test_a_day_of_transforms_does_not_fill_the_memory() -> None:
    made = Robot(["image"], None, Patience(settle_s=0.0), Skipped())
    turn = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    for n in range(20_000):  # ten a second
        link = {"header": stamped(n / 10, "map"), "child_frame_id": "camera"}
        link["transform"] = {"translation": {"x": n / 1e4, "y": 0.0, "z": 0.0}, "rotation": turn}
        made.take("tf", message_of({"transforms": [link]}))
    assert sum(edge.count for edge in made._transforms.tree.links()) < 1000
    made.take("image", message_of(image(1999.85)))
    (frame,) = made.frames()
    assert frame.pose is not None
    assert frame.pose.position[0] == pytest.approx(1.99985)
