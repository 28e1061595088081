"""What SQLite's errors mean to whoever asks a store: a damaged file is told from a failing one."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from d3a.store.base import StoreDamaged, StoreError
from d3a.store.schema import APPLICATION_ID

_HEADER = b"SQLite format 3\0"
_ID_AT = 68  # the application id stands there, big-endian, in the 100 bytes that begin the file
_DAMAGE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
_WOULD_DO = {
    sqlite3.SQLITE_FULL: "make room and say the same again; what was stored before stays",
    sqlite3.SQLITE_IOERR: (
        "the disk fails, or a file may not get longer (ulimit -f); what was stored before stays"
    ),
    sqlite3.SQLITE_READONLY: (
        "it can be read here and not changed (a read-only medium, or another user's file); "
        "d3a store copy makes one that can"
    ),
}
"""What a person can do about an error, by its code."""


def is_damage(error: sqlite3.Error) -> bool:
    """Whether SQLite says that the bytes of the file are wrong."""
    code: int | None = getattr(error, "sqlite_errorcode", None)  # the module's own errors have none
    return code is not None and code & 0xFF in _DAMAGE


def told(uri: str, error: sqlite3.Error) -> StoreError:
    """Return the error of a store: StoreDamaged where the file is, with what would do."""
    if is_damage(error):
        return StoreDamaged(f"{uri}: the file is damaged ({error}); d3a store check lists where")
    code: int = getattr(error, "sqlite_errorcode", None) or sqlite3.SQLITE_ERROR
    would = _WOULD_DO.get(code & 0xFF)
    return StoreError(f"{uri}: {error}" + (f": {would}" if would else ""))


def begins_as_store(path: Path) -> bool:
    """Whether a file has the first bytes of a store of d3a, whatever became of the rest."""
    with path.open("rb") as file:
        head = file.read(_ID_AT + 4)
    return head.startswith(_HEADER) and head[_ID_AT:] == APPLICATION_ID.to_bytes(4, "big")
