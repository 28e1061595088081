"""Opening the file of a SQLite store: made for its owner alone, known by its application id."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path
from time import monotonic, sleep

from d3a.store import schema
from d3a.store.base import StoreDamaged, StoreError, StoreMissing, StoreUnreachable
from d3a.store.schema import APPLICATION_ID, Migration
from d3a.store.sqlite import SqliteStore
from d3a.store.sqlite_connection import BUSY_TIMEOUT_S, can_be_written, connect
from d3a.store.sqlite_errors import begins_as_store

MIGRATIONS: tuple[Migration, ...] = (schema.index_votes, schema.add_apart)
_OLDEST = (3, 24, 0)  # the first with upserts
_MAPPED = 0x7FFF0000
"""Bytes of the file that are seen as memory, all that SQLite maps: a question reads some hundred
pages that lie apart, and a call of the system for each took a third of its time. What was touched
is counted as the process's (30 MB of `d3a ask` at 200,000 stays) and is the system's to take
back."""


def open_sqlite(
    path: Path,
    *,
    create: bool = True,
    read_only: bool = False,
    migrations: tuple[Migration, ...] = MIGRATIONS,
) -> SqliteStore:
    """Open the store in a file, and make it first where `create` says so and there is none.

    One that cannot be written is opened for reading; what would write to it is told so.
    Raises StoreMissing where there is none, StoreUnreachable where the file cannot be opened or
    made, StoreDamaged for what only begins as a store, StoreError for a file of another program or
    of a newer schema. migrations: see `schema.migrate`.
    """
    uri = f"sqlite:///{path}"
    if sqlite3.sqlite_version_info < _OLDEST:
        raise StoreError(f"{uri}: SQLite {sqlite3.sqlite_version} is too old, 3.24 would do")
    read_only = read_only or (path.is_file() and not can_be_written(path))
    create = create and not read_only
    try:
        if create:
            _make_file(path)
        elif not path.is_file():
            if path.exists():
                raise StoreUnreachable(f"{uri} is not a file")
            raise StoreMissing(f"{uri} does not exist; ingest a recording to make a store")
    except OSError as error:
        raise StoreUnreachable(f"{uri}: {path} cannot be made: {error.strerror}") from error
    try:
        connection = connect(path, read_only=read_only)
    except sqlite3.Error as error:
        raise StoreUnreachable(f"{uri}: {error}") from error
    try:
        _prepare(connection, create=create, read_only=read_only, migrations=migrations)
        return SqliteStore(path, connection)
    except sqlite3.OperationalError as error:
        connection.close()
        raise StoreUnreachable(f"{uri}: {error}") from error
    except sqlite3.DatabaseError as error:
        connection.close()
        if begins_as_store(path):
            raise StoreDamaged(
                f"{uri}: it begins as a store of d3a, and is damaged or cut short ({error}); "
                "take a copy of it that is whole, or ingest the recordings anew"
            ) from error
        raise StoreError(f"{uri}: it is not a store of d3a ({error}); name another file") from error
    except StoreError as error:
        connection.close()
        raise type(error)(f"{uri}: {error}") from error


def _make_file(path: Path) -> None:
    """Make an empty file that its owner alone may read: the log and the index take its mode."""
    if path.is_dir():
        raise StoreUnreachable(f"sqlite:///{path}: {path} is a folder; name a file in it")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o600))
    except FileExistsError:
        return  # the store, or what `_prepare` will refuse


def _prepare(
    connection: sqlite3.Connection,
    *,
    create: bool,
    read_only: bool,
    migrations: tuple[Migration, ...],
) -> None:
    connection.execute("PRAGMA cache_size = -16384")
    connection.execute(f"PRAGMA mmap_size = {_MAPPED}")
    if not read_only:
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA wal_autocheckpoint = 8000")
    newest = len(migrations) + 1
    version = _version(connection)
    if version is None:
        if not create:
            raise StoreError("the file is empty; ingest a recording to fill it")
        connection.execute("PRAGMA page_size = 8192")
        _use_log(connection)
        version = 0
    schema.refuse_future(version, newest)
    if version < newest and read_only:
        raise StoreError(
            f"it has the old schema {version}, and cannot be written here: open it, or a copy of "
            "the file, once where it can be"
        )
    if version < newest:
        _upgrade(connection, migrations)


def _use_log(connection: sqlite3.Connection) -> None:
    """Switch to the write-ahead log; SQLite itself does not wait for another that does so."""
    deadline = monotonic() + BUSY_TIMEOUT_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode != sqlite3.SQLITE_BUSY or monotonic() > deadline:
                raise
            sleep(0.01)
        else:
            return


def _upgrade(connection: sqlite3.Connection, migrations: tuple[Migration, ...]) -> None:
    """Make or migrate the tables, all or nothing; another process may have been quicker."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        version = _version(connection)
        if version is None:
            schema.create_tables(connection, trees=schema.has_rtree(connection))
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID:d}")
            version = 1
        schema.migrate(connection, version, migrations)
        connection.execute("COMMIT")
    except BaseException:
        connection.execute("ROLLBACK")
        raise


def _version(connection: sqlite3.Connection) -> int | None:
    """Return the schema's number, None for a file without anything in it."""
    (application_id,) = connection.execute("PRAGMA application_id").fetchone()
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    if application_id == APPLICATION_ID:
        return int(version)
    (tables,) = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    if application_id == 0 and version == 0 and tables == 0:
        return None
    raise StoreError("it is a database of another program; name another file")
