"""What a dump of a SQLite file reads: one moment of it, whatever is written meanwhile."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from d3a.model import Json
from d3a.store.records import Picture, Record, dump_records
from d3a.store.rows import READERS
from d3a.store.sqlite_connection import connect


class Moment:
    """What a dump reads, in a transaction that has begun: rows as they come."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._db = connection

    def meta_entries(self) -> Iterable[tuple[str, Any]]:
        """Yield (key, value) by key."""
        for key, text in self._db.execute("SELECT key, value FROM meta ORDER BY key"):
            yield key, json.loads(text)

    def records(self, kind: str) -> Iterable[Record]:
        """Yield all records of a kind."""
        text, record = READERS[kind]
        return map(record, self._db.execute(text))

    def pictures(self) -> Iterable[Picture]:
        """Yield the stored pictures by key; `length` does not read them."""
        text = "SELECT key, width, height, time_ms, length(jpeg) FROM keyframe ORDER BY key"
        return (Picture(*row) for row in self._db.execute(text))

    def state(self) -> bytes | None:
        """Return the checkpoint."""
        row = self._db.execute("SELECT value FROM state").fetchone()
        return row[0] if row else None


def dump(connection: sqlite3.Connection, path: Path) -> Iterator[Json]:
    """Yield every record in a fixed order: of the connection's transaction, or of the file now."""
    if connection.in_transaction:
        yield from dump_records(Moment(connection))
        return
    with closing(connect(path, read_only=True)) as other:
        other.execute("BEGIN")
        yield from dump_records(Moment(other))
