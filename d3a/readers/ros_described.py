"""What a bag is made of, and what was taken for granted of it: for `d3a doctor`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from d3a.readers.base import Stream
from d3a.readers.ros_bag import Bag
from d3a.readers.ros_index import Index, Stamps
from d3a.readers.ros_poses import PoseTopic, Way
from d3a.readers.ros_topics import Choice

BENT = 0.1
"""A lens distortion coefficient from here on moves a picture's corner by several percent."""


def time_ms_of(time_ns: int) -> int:
    """Return milliseconds of nanoseconds, rounded to the nearest."""
    return (time_ns + 500_000) // 1_000_000


def name_of(time_ms: int) -> str:
    """Return a frame's name: its time, in seconds."""
    return f"{time_ms // 1000}.{time_ms % 1000:03d}"


def streams_of(bag: Bag, choice: Choice, stamps: Stamps, sure: PoseTopic | None) -> list[Stream]:
    """Return every topic with its times, by the headers where there are any.

    Only those that are read should last as long as the pictures do.
    """
    roles = {"pictures": choice.image, "depth": choice.depth, "boxes": choice.detections}
    used = {each.topic.name: kind for kind, each in roles.items() if each is not None}
    used |= dict.fromkeys(choice.tf()[0], "transforms")
    if sure is not None:
        used[sure.name] = "poses"
    stamped = {name for name in bag.topics if bag.has_header(name)}
    times: dict[str, list[int]] = {name: [] for name in bag.topics}
    for message in bag.messages(list(bag.topics)):
        is_stamped = message.topic in stamped
        stamp = stamps.of(message) if is_stamped else message.receive_ns
        if stamp is not None:
            times[message.topic].append(time_ms_of(stamp))
    found = []
    for name, topic in bag.topics.items():
        short = topic.type.replace("/msg/", "/")
        kind = f"{used[name]} ({short})" if name in used else short
        stream = Stream.of(name, kind, times[name])
        count = stream.count if topic.count is None else topic.count
        found.append(replace(stream, count=count, spans=name in used))
    return found


def notes_of(choice: Choice, way: Way | str, index: Index) -> Sequence[str]:
    """Return what the reader took for granted, and what that costs, a sentence each."""
    notes = list(choice.notes())
    notes += [way] if isinstance(way, str) else way.notes
    image, depth = choice.image, choice.depth
    if image is not None and depth is not None and image.frame_id != depth.frame_id:
        notes.append(
            f"depth is seen from {depth.frame_id or '?'} and pictures from "
            f"{image.frame_id or '?'}: places are off by as much; record aligned depth"
        )
    if index.distortion >= BENT:
        notes.append(
            f"the lens bends the picture (coefficients up to {index.distortion:.2g}), which is "
            "not undone: places near its edges are off; a rectified topic would do"
        )
    notes += [
        f"tf gives {frame} several parents; the one told most often counts"
        for frame in index.tree.disputed()
    ]
    return notes
