"""Bags that were cut off: their records one after the other, without the index at the end.

A recorder that is killed leaves no index; a copy that breaks off has lost it. ROS 1 and MCAP files
are chains of records that each tell their length; SQLite files are asked row by row.
"""

from __future__ import annotations

import bz2
import sqlite3
import struct
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import closing
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, Protocol
from urllib.parse import quote

ROS1_MAGIC, MCAP_MAGIC = b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n"
SQLITE_MAGIC = b"SQLite format 3\0"
MOST_BYTES = 1 << 30
"""A record that claims more is no record."""
_MESSAGE, _CHUNK, _CONNECTION = b"\2", b"\5", b"\7"
_SCHEMA, _CHANNEL, _MCAP_MESSAGE, _MCAP_CHUNK = 3, 4, 5, 6
Found = tuple[str, int, bytes]
"""Topic, receive time in nanoseconds, content."""


class Cut(Protocol):
    """A damaged file."""

    name: str

    def topics(self) -> list[tuple[str, str, int | None]]:
        """Return (name, type, count) of each topic, the count None where unknown."""
        ...

    def definitions(self) -> list[tuple[str, str, str]]:
        """Return (type, encoding, text) of the message definitions."""
        ...

    def messages(self, topics: Collection[str]) -> Iterator[Found]:
        """Yield messages up to where the file breaks off."""
        ...


def open_cut(path: Path) -> Cut | None:
    """Return what reads the file's beginning, None where it has none of the known ones."""
    try:
        with path.open("rb") as file:
            begin = file.read(16)
    except OSError:
        return None
    if begin.startswith(ROS1_MAGIC):
        return CutRos1(path)
    if begin.startswith(MCAP_MAGIC):
        return CutMcap(path)
    return CutSqlite(path) if begin == SQLITE_MAGIC else None


def check_whole(path: Path) -> None:
    """Raise EOFError for a SQLite file that is shorter than its header says.

    It can be opened, and then breaks somewhere in the middle of a query.
    """
    with path.open("rb") as file:
        header = file.read(100)
        size = file.seek(0, 2)
    if not header.startswith(SQLITE_MAGIC) or len(header) < 100:
        return
    (page,) = struct.unpack(">H", header[16:18])
    (pages,) = struct.unpack(">I", header[28:32])
    whole = (65536 if page == 1 else page) * pages
    if size < whole:
        raise EOFError(f"it has {size} bytes of {whole}")


def _exactly(file: BinaryIO, size: int) -> bytes:
    """Return so many bytes; EOFError where the file ends before."""
    content = file.read(size) if size <= MOST_BYTES else b""
    if len(content) != size:
        raise EOFError(f"it ends within a record of {size} bytes")
    return content


def zstd() -> Any:
    """Return the module that unpacks zstd: Python's own from 3.14 on, else rosbags' choice."""
    try:
        from compression import zstd as module
    except ImportError:
        from backports import zstd as module
    return module


def broken_record() -> tuple[type[Exception], ...]:
    """Return what a record raises that is not what it says it is."""
    usual = (EOFError, LookupError, OSError, RuntimeError, ValueError, struct.error)
    return (*usual, zstd().ZstdError)


def _unpacked(content: bytes, how: str) -> bytes:
    """Return a chunk's plain bytes; ValueError for a way of packing that is not known."""
    if how in ("", "none"):
        return content
    if how == "bz2":
        return bz2.decompress(content)
    if how == "lz4":
        from lz4 import frame

        return bytes(frame.decompress(content))
    if how == "zstd":
        return bytes(zstd().decompress(content))
    raise ValueError(f"chunks packed with {how!r} cannot be read")


class CutRos1:
    """A ROS 1 bag without an index."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.name = path.name
        self._known: dict[int, tuple[str, str, str]] = {}
        self._counts = Counter(self._known[number][0] for number, _, _ in self._records())

    def _records(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield (connection, receive time, content) of each message up to the break."""
        with self._path.open("rb") as file:
            file.seek(len(ROS1_MAGIC))
            yield from self._within(file)

    def _within(self, file: BinaryIO) -> Iterator[tuple[int, int, bytes]]:
        while True:
            try:
                header = _fields(_sized(file))
                content = _sized(file)
            except (EOFError, struct.error):
                return  # here it breaks off, which is known
            kind = header.get(b"op", b"\0")[:1]
            try:
                if kind == _CHUNK:
                    plain = _unpacked(content, header.get(b"compression", b"none").decode())
                elif kind == _CONNECTION:
                    self._connect(header, content)
                elif kind == _MESSAGE:
                    (number,) = struct.unpack("<I", header[b"conn"])
                    seconds, nanoseconds = struct.unpack("<II", header[b"time"])
            except broken_record():
                continue  # the file is known to be damaged; its next record may be sound
            if kind == _CHUNK:
                yield from self._within(BytesIO(plain))
            elif kind == _MESSAGE and number in self._known:
                yield number, seconds * 10**9 + nanoseconds, content

    def _connect(self, header: dict[bytes, bytes], content: bytes) -> None:
        (number,) = struct.unpack("<I", header[b"conn"])
        fields = _fields(content)
        package, _, name = fields[b"type"].decode().partition("/")
        topic = header[b"topic"].decode()
        text = fields[b"message_definition"].decode(errors="replace")
        self._known[number] = (topic, f"{package}/msg/{name}", text)

    def topics(self) -> list[tuple[str, str, int | None]]:
        """Return what was found before the break."""
        kinds = {topic: kind for topic, kind, _ in self._known.values()}
        return [(topic, kind, self._counts[topic]) for topic, kind in kinds.items()]

    def definitions(self) -> list[tuple[str, str, str]]:
        """Return the definitions that each connection brings."""
        return [(kind, "ros1msg", text) for _, kind, text in self._known.values()]

    def messages(self, topics: Collection[str]) -> Iterator[Found]:
        """Yield messages up to the break."""
        for number, time_ns, content in self._records():
            if self._known[number][0] in topics:
                yield self._known[number][0], time_ns, content


def _sized(file: BinaryIO) -> bytes:
    (size,) = struct.unpack("<I", _exactly(file, 4))
    return _exactly(file, size)


def _fields(content: bytes) -> dict[bytes, bytes]:
    fields, file = {}, BytesIO(content)
    while file.tell() < len(content):
        name, _, value = _sized(file).partition(b"=")
        fields[name] = value
    return fields


def _chunk(record: BinaryIO) -> bytes:
    """Return the records of an MCAP chunk."""
    _exactly(record, 28)
    how = _sized(record).decode()
    (length,) = struct.unpack("<Q", _exactly(record, 8))
    return _unpacked(_exactly(record, length), how)


class CutMcap:
    """An MCAP file without a summary."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.name = path.name
        self._schemas: dict[int, tuple[str, str, str]] = {}
        self._channels: dict[int, tuple[str, int]] = {}
        self._counts = Counter(self._channels[number][0] for number, _, _ in self._records())

    def _records(self) -> Iterator[tuple[int, int, bytes]]:
        with self._path.open("rb") as file:
            file.seek(len(MCAP_MAGIC))
            yield from self._within(file)

    def _within(self, file: BinaryIO) -> Iterator[tuple[int, int, bytes]]:
        while True:
            try:
                kind, size = struct.unpack("<BQ", _exactly(file, 9))
                content = _exactly(file, size)
            except EOFError:
                return  # here it breaks off, which is known
            record, plain = BytesIO(content), b""
            try:
                if kind in (_SCHEMA, _CHANNEL):
                    self._define(kind, record)
                elif kind == _MCAP_MESSAGE:
                    number, _, time_ns, _ = struct.unpack("<HIQQ", _exactly(record, 22))
                elif kind == _MCAP_CHUNK:
                    plain = _chunk(record)
            except broken_record():
                continue  # the file is known to be damaged; its next record may be sound
            if kind == _MCAP_CHUNK:
                yield from self._within(BytesIO(plain))
            elif kind == _MCAP_MESSAGE and number in self._channels:
                yield number, time_ns, record.read()

    def _define(self, kind: int, record: BinaryIO) -> None:
        (number,) = struct.unpack("<H", _exactly(record, 2))
        if kind == _SCHEMA:
            name, encoding, text = (_sized(record).decode(errors="replace") for _ in range(3))
            self._schemas[number] = (name, encoding, text)
        else:
            (schema,) = struct.unpack("<H", _exactly(record, 2))
            self._channels[number] = (_sized(record).decode(errors="replace"), schema)

    def topics(self) -> list[tuple[str, str, int | None]]:
        """Return what was found before the break."""
        return [
            (topic, self._schemas[schema][0], self._counts[topic])
            for topic, schema in self._channels.values()
            if schema in self._schemas
        ]

    def definitions(self) -> list[tuple[str, str, str]]:
        """Return the schemas."""
        return list(self._schemas.values())

    def messages(self, topics: Collection[str]) -> Iterator[Found]:
        """Yield messages up to the break."""
        for number, time_ns, content in self._records():
            if self._channels[number][0] in topics:
                yield self._channels[number][0], time_ns, content


class CutSqlite:
    """A SQLite bag that rosbags refuses: rows by their number, until one cannot be read."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.name = path.name
        self._topics: dict[int, tuple[str, str]] = {}
        try:
            with closing(self._connected()) as database:
                rows = database.execute("SELECT id, name, type FROM topics")
                self._topics = {number: (str(name), str(kind)) for number, name, kind in rows}
        except sqlite3.Error:
            self._topics = {}  # then there is nothing to read, which is said

    def _connected(self) -> sqlite3.Connection:
        address = f"file:{quote(str(self._path.resolve()))}?immutable=1"
        connection = sqlite3.connect(address, uri=True)
        # without this SQLite refuses a file that lacks its last pages, whatever is asked of it
        connection.execute("PRAGMA writable_schema = ON")
        return connection

    def topics(self) -> list[tuple[str, str, int | None]]:
        """Return the topics, without counts."""
        return [(name, kind, None) for name, kind in self._topics.values()]

    def definitions(self) -> list[tuple[str, str, str]]:
        """Return the definitions that newer recorders write."""
        try:
            with closing(self._connected()) as database:
                rows = database.execute(
                    "SELECT topic_type, encoding, encoded_message_definition "
                    "FROM message_definitions WHERE encoded_message_definition != ''"
                )
                return [(str(kind), str(how), str(text)) for kind, how, text in rows]
        except sqlite3.Error:
            return []  # older recorders have no such table: the usual definitions are taken

    def messages(self, topics: Collection[str]) -> Iterator[Found]:
        """Yield rows in the order they were written, up to the first that cannot be read."""
        connection = self._connected()
        try:
            rows = connection.execute(
                "SELECT topic_id, timestamp, data FROM messages NOT INDEXED ORDER BY id"
            )
            for number, time_ns, content in rows:
                name, _ = self._topics.get(number, ("", ""))
                if name in topics:
                    yield name, time_ns, bytes(content)
        except sqlite3.Error as error:
            raise EOFError(f"the database cannot be read on: {error}") from error
        finally:
            connection.close()
