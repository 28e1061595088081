"""A connection to the file of a SQLite store, and a query over it that is watched."""

from __future__ import annotations

import os
import sqlite3
import time
from pathlib import Path
from typing import Any

from d3a.store.base import NativeQuery
from d3a.store.rows import Row
from d3a.store.sqlite_read import index_of

BUSY_TIMEOUT_S = 10.0


def can_be_written(path: Path) -> bool:
    """Whether a file and its log can be written: not on a read-only medium, nor another's."""
    return os.access(path, os.W_OK) and (os.access(path.parent, os.W_OK) or _log(path).exists())


def _log(path: Path) -> Path:
    return path.with_name(path.name + "-wal")


def connect(path: Path, *, read_only: bool) -> sqlite3.Connection:
    """Connect to an existing file, in autocommit, for any thread; raises sqlite3.Error."""
    mode = "mode=ro" if read_only else "mode=rw"
    if read_only and not os.access(path.parent, os.W_OK) and not _log(path).exists():
        mode += "&immutable=1"  # a reader of a log must be able to make the log's index
    return sqlite3.connect(
        f"{path.absolute().as_uri()}?{mode}",
        uri=True,
        timeout=BUSY_TIMEOUT_S,
        isolation_level=None,
        check_same_thread=False,
    )


def traced(
    connection: sqlite3.Connection, text: str, given: dict[str, Any]
) -> tuple[list[Row], NativeQuery]:
    """Return the rows of a query, and what it was, by which index and how long it took."""
    plan = connection.execute(f"EXPLAIN QUERY PLAN {text}", given).fetchall()
    begun = time.perf_counter()
    rows = connection.execute(text, given).fetchall()
    elapsed_ms = (time.perf_counter() - begun) * 1000
    said = text + "".join(f"\n  :{name} = {value}" for name, value in given.items())
    return rows, NativeQuery(said, index_of(plan), len(rows), elapsed_ms)
