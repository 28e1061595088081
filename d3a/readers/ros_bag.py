"""Opening ROS bags: what topics there are, and their messages. The only user of rosbags.

ROS 1 (`.bag`, one file or a folder of several) and ROS 2 (a folder with `metadata.yaml`, or a
single `.mcap` or `.db3`). A bag that was cut off is read as far as it goes.
"""

from __future__ import annotations

import heapq
import struct
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from d3a.model import BadInput
from d3a.readers import ros_salvage
from d3a.readers.base import Skipped
from d3a.readers.parsing import clean_text
from d3a.readers.ros_vision import LAYOUTS, PACKAGE

SUFFIXES = (".bag", ".active", ".mcap", ".db3")
METADATA = "metadata.yaml"
MISSING = "reading ROS bags needs the extra `ros`: pip install 'd3a[ros]'"
CUT = "bag that is cut off or damaged, read as far as it goes"
NO_DEFINITION = "message of a type that the bag does not define"
_STAMP_AT = 4
"""A header comes first in a message: after the encapsulation (ROS 2), or the sequence (ROS 1)."""


class Message(NamedTuple):
    """A message as it lies in the bag; receive_ns: when it was recorded."""

    topic: str
    receive_ns: int
    raw: bytes


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of the bag; type: as ROS 2 writes it, for ROS 1 too; count: None where unknown."""

    name: str
    type: str
    count: int | None


def bag_files(source: Path) -> list[Path]:
    """Return the files of a bag, by name: the source itself, or those in a folder."""
    if source.is_file():
        return [source] if source.suffix in SUFFIXES else []
    if not source.is_dir():
        return []
    files = sorted(each for each in source.iterdir() if each.is_file())
    found = [each for each in files if each.suffix in SUFFIXES]
    # a ROS 2 bag may be packed file by file; its metadata then tells how to read it
    return found or [each for each in files if each.suffixes[-2:-1] in ([".mcap"], [".db3"])]


def _libraries() -> Any:
    """Return the parts of rosbags that are used; BadInput where it is not installed."""
    try:
        from rosbags import highlevel, interfaces, serde, typesys
    except ImportError as error:
        raise BadInput(MISSING) from error

    @dataclass(frozen=True)
    class Libraries:
        reader: Any = highlevel.AnyReader
        stores: Any = typesys.Stores
        typestore: Any = typesys.get_typestore
        from_msg: Any = typesys.get_types_from_msg
        from_idl: Any = typesys.get_types_from_idl
        broken: tuple[type[Exception], ...] = (
            highlevel.AnyReaderError,
            serde.SerdeError,
            typesys.TypesysError,
        )
        header: Any = ("header", (interfaces.Nodetype.NAME, "std_msgs/msg/Header"))

    return Libraries()


def _damage() -> tuple[type[Exception], ...]:
    """Return what rosbags and its decompressors raise on files that are broken."""
    import apsw
    from rosbags.highlevel import anyreader

    return (
        *ros_salvage.broken_record(),
        AssertionError,
        TypeError,
        anyreader.AnyReaderError,
        *anyreader.ReaderErrors,
        apsw.Error,
    )


class Bag:
    """A bag that can be read, any number of times and at several places at once.

    skipped: what was wrong with the files themselves.
    """

    def __init__(self, source: Path) -> None:
        self.skipped = Skipped()
        self._lib = _libraries()
        self._damage = _damage()
        self._files = bag_files(source)
        if not self._files:
            raise BadInput(f"{source} holds no bag ({', '.join(SUFFIXES)})")
        self.is_ros2 = self._files[0].suffix not in (".bag", ".active")
        has_metadata = source.is_dir() and (source / METADATA).is_file()
        self._parts: list[_Whole | ros_salvage.Cut] = []
        paths = [source] if has_metadata and self.is_ros2 else self._files
        self._open(paths, is_alone=paths == self._files[:1])
        self.topics = self._topics()
        if not self.topics:
            raise BadInput(f"{source} holds no message that can be read")
        self._stores = self._typestores()
        self._chosen: dict[str, int] = {}

    def _open(self, paths: list[Path], *, is_alone: bool) -> None:
        """Open files together; where that fails each alone, and of what is cut what there is."""
        whole = _Whole(self._lib, paths)
        try:
            whole.look()
        except self._damage as error:
            if not is_alone:
                for path in self._files:
                    self._open([path], is_alone=True)
                return
            self.skipped.add(CUT, f"{paths[0].name} ({clean_text(str(error))[:120]})")
            cut = ros_salvage.open_cut(paths[0])
            if cut is not None:
                self._parts.append(cut)
        else:
            self._parts.append(whole)

    def _topics(self) -> dict[str, Topic]:
        found: dict[str, Topic] = {}
        for part in self._parts:
            for name, kind, count in part.topics():
                known = found.get(name)
                if known is None:
                    found[name] = Topic(name, kind, count)
                elif known.type == kind:
                    both = None if None in (known.count, count) else known.count + count  # type: ignore[operator]
                    found[name] = Topic(name, kind, both)
        return dict(sorted(found.items()))

    def _typestores(self) -> list[Any]:
        """Return a store for each layout that vision_msgs may have; one where the bag says it."""
        lib = self._lib
        usual = lib.stores.ROS2_HUMBLE if self.is_ros2 else lib.stores.ROS1_NOETIC
        usual_types = dict(lib.typestore(usual).fielddefs)
        embedded: dict[str, Any] = {}
        for part in self._parts:
            embedded |= self._embedded(part)
        stores = []
        says_it = any(name.startswith(PACKAGE) for name in embedded)
        for layout in LAYOUTS[:1] if says_it else LAYOUTS:
            vision: dict[str, Any] = {}
            for name, text in layout.items():
                vision |= lib.from_msg(text, name)
            store = lib.typestore(lib.stores.EMPTY)
            store.register(usual_types | ({} if says_it else vision) | embedded)
            stores.append(store)
        return stores

    def _embedded(self, part: _Whole | ros_salvage.Cut) -> Mapping[str, Any]:
        if isinstance(part, _Whole):
            return part.types
        types: dict[str, Any] = {}
        for kind, encoding, text in part.definitions():
            try:
                reads = self._lib.from_idl if encoding.endswith("idl") else self._lib.from_msg
                types |= reads(text) if encoding.endswith("idl") else reads(text, kind)
            except self._lib.broken as error:
                self.skipped.add(NO_DEFINITION, f"{kind} ({clean_text(str(error))[:80]})")
        return types

    def messages(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of these topics in the order they were recorded.

        Where a file breaks off, that is counted in `skipped` and the rest of it left out.
        """
        if not topics:
            return iter(())
        return heapq.merge(
            *(self._guarded(part, topics) for part in self._parts), key=lambda m: m.receive_ns
        )

    def _guarded(
        self, part: _Whole | ros_salvage.Cut, topics: Collection[str]
    ) -> Iterator[Message]:
        try:
            yield from (Message(*each) for each in part.messages(topics))
        except self._damage as error:
            where = f"{part.name} ({clean_text(str(error))[:120]})"
            if where not in self.skipped.examples.get(CUT, ()):  # it is read several times
                self.skipped.add(CUT, where)

    def first(self, topic: str) -> Message | None:
        """Return a topic's first message, None where there is none."""
        return next(self.messages([topic]), None)

    def last(self, topic: str) -> Message | None:
        """Return a topic's last message, None where there is none."""
        found = None
        for found in self.messages([topic]):  # noqa: B007  only the last is wanted
            pass
        return found

    def read(self, message: Message) -> Any:
        """Return a message with its fields as ROS names them; BadInput for a broken one."""
        kind = self.topics[message.topic].type
        numbers = range(len(self._stores))
        problem = ""
        for number in (self._chosen[kind],) if kind in self._chosen else numbers:
            store = self._stores[number]
            reads = store.deserialize_cdr if self.is_ros2 else store.deserialize_ros1
            try:
                found = reads(message.raw, kind)
            except (*self._damage, *self._lib.broken) as error:
                problem = problem or clean_text(str(error))[:120] or type(error).__name__
                continue
            if getattr(found, "detections", True):  # an empty list looks alike in all layouts
                self._chosen[kind] = number
            return found
        raise BadInput(f"the message cannot be read: {problem}")

    def has_header(self, topic: str) -> bool:
        """Say whether the topic's messages begin with a header, and so with a time stamp."""
        fields = self._stores[0].fielddefs.get(self.topics[topic].type)
        return bool(fields and fields[1] and tuple(fields[1][0]) == self._lib.header)

    def stamp_ns(self, message: Message) -> int | None:
        """Return the time in the header of a message that begins with one, without reading it all.

        None where it is zero (not set) or cut off.
        """
        raw = message.raw
        if len(raw) < _STAMP_AT + 8:
            return None
        order = "<" if not self.is_ros2 or raw[1] & 1 else ">"
        seconds, nanoseconds = struct.unpack_from(order + "iI", raw, _STAMP_AT)
        return (seconds * 10**9 + nanoseconds) or None


class _Whole:
    """Files that rosbags can read."""

    def __init__(self, lib: Any, paths: list[Path]) -> None:
        self._lib = lib
        self._paths = paths
        stores = lib.stores
        is_ros2 = paths[0].suffix != ".bag"
        self._usual = lib.typestore(stores.ROS2_HUMBLE if is_ros2 else stores.ROS1_NOETIC)
        self._found: list[tuple[str, str, int]] = []
        self.name = paths[0].name
        self.types: Mapping[str, Any] = {}

    def _reader(self) -> Any:
        return self._lib.reader(self._paths, default_typestore=self._usual)

    def look(self) -> None:
        """Read what topics there are; EOFError for a database that has lost its end."""
        for path in self._paths:
            for file in bag_files(path):
                ros_salvage.check_whole(file)
        with self._reader() as reader:
            self._found = [(c.topic, c.msgtype, c.msgcount) for c in reader.connections]
            defined = any(c.msgdef.data for c in reader.connections)
            self.types = dict(reader.typestore.fielddefs) if defined else {}

    def topics(self) -> list[tuple[str, str, int]]:
        """Return (name, type, count) of each connection."""
        return self._found

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, bytes]]:
        """Yield (topic, receive time, content), by a reader of its own."""
        with self._reader() as reader:
            wanted = [c for c in reader.connections if c.topic in topics]
            if wanted:
                for connection, time_ns, raw in reader.messages(connections=wanted):
                    yield connection.topic, time_ns, raw
