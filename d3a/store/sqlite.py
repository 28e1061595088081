"""The embedded store: one SQLite file with its write-ahead log, readers beside one writer."""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.model import Json
from d3a.store import schema, sqlite_errors, sqlite_read
from d3a.store.base import (
    Area,
    Batch,
    Encounter,
    Keyframe,
    NativeQuery,
    ObjectRecord,
    Positions,
    RecordingRecord,
    Region,
    Sighting,
    SightingKey,
    Spans,
    StayKey,
    StayRecord,
    StoreBusy,
    StoreError,
    TaughtName,
    View,
)
from d3a.store.lease import Lease
from d3a.store.rows import (
    READERS,
    Row,
    encounter_record,
    object_record,
    positions,
    sighting_record,
    stay_record,
    view_record,
)
from d3a.store.sqlite_connection import BUSY_TIMEOUT_S, traced
from d3a.store.sqlite_newest import Newest, StayRows, count_seen, last_view_ms
from d3a.store.sqlite_read import Select

_WHOLE = "BEGIN IMMEDIATE", "COMMIT", "ROLLBACK"
_PART = "SAVEPOINT part", "RELEASE part", "ROLLBACK TO part"


class SqliteStore:
    """`Store` in one file. One connection behind a lock: threads may share the store.

    connection: of `connect`, to a file that `sqlite_file` has prepared; the store closes it.
    What no question needs is imported where it is used: `d3a ask` loads the rest each time.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.uri = f"sqlite:///{path}"
        self._path = path.absolute()
        self._db = connection
        self._lock = threading.RLock()
        self._observer: Callable[[NativeQuery], None] | None = None
        self._stay_rows = StayRows()
        with self._translated():
            self._trees = schema.has_trees(connection)

    def close(self) -> None:
        """Release the file."""
        with self._translated(), self._lock:
            self._db.close()

    @contextmanager
    def _translated(self) -> Iterator[None]:
        """Let no error of sqlite3 out."""
        try:
            yield
        except sqlite3.Error as error:
            raise sqlite_errors.told(self.uri, error) from error

    # writing
    def apply(self, batch: Batch) -> None:
        """Apply a batch in one transaction; the log is on the disk when this returns."""
        from d3a.store.expected import check_expected
        from d3a.store.limits import check_batch
        from d3a.store.sqlite_write import Writer

        check_batch(batch)
        with self.turn():
            check_expected(self, batch)
            Writer(self._db, trees=self._trees).write(batch)

    @contextmanager
    def turn(self) -> Iterator[None]:
        """Be the one writer: a transaction, or a part of one that can be taken back alone."""
        with self._lock, self._translated():
            begin, end, undo = _PART if self._db.in_transaction else _WHOLE
            try:
                self._db.execute(begin)
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode & 0xFF != sqlite3.SQLITE_BUSY:
                    raise
                said = f"another process has been writing for {BUSY_TIMEOUT_S:g} s; try again"
                raise StoreBusy(f"{self.uri}: {said}") from error
            try:
                yield
                self._db.execute(end)
            except BaseException:
                if self._db.in_transaction:  # a full disk has already rolled back
                    self._db.execute(undo)
                raise

    def lease(self) -> Lease | None:
        """Return who ingests or did last."""
        rows = self._rows("SELECT value FROM internal WHERE key = 'lease'")
        return Lease(**json.loads(rows[0][0])) if rows else None

    def put_lease(self, lease: Lease) -> None:
        """Keep another lease."""
        with self.turn():
            text = json.dumps(lease.to_json())
            self._db.execute("INSERT OR REPLACE INTO internal VALUES ('lease', ?)", (text,))

    def clock_ms(self) -> int:
        """Return this machine's time: a file has no other."""
        return round(time.time() * 1000)

    def collect_keyframes(self, keep: Sequence[str] = ()) -> int:
        """Remove pictures that nothing refers to, but for `keep`; count them."""
        from d3a.store.sqlite_write import collect_keyframes

        with self.turn():
            return collect_keyframes(self._db, keep)

    def scrub(self) -> bool:
        """Write the file anew without what was removed, and empty the log.

        Needs as much free disk as the file is large.
        """
        with self._lock, self._translated():
            self._db.execute("VACUUM")
            (busy, _, _) = self._db.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
        if busy:
            raise StoreError(
                f"{self.uri}: another process is reading, so the log could not be emptied; "
                "what was removed may still be in it: end that process, then store check --repair"
            )
        return True

    # reading
    @contextmanager
    def moment(self) -> Iterator[None]:
        """Have all reads within see one moment; others may write meanwhile."""
        with self._lock, self._translated():
            if self._db.in_transaction:
                yield
                return
            self._db.execute("BEGIN")
            try:
                yield
            finally:
                self._db.execute("ROLLBACK")

    def _rows(self, text: str, parameters: dict[str, Any] | None = None) -> list[Row]:
        """Run one query; the observer is told of it."""
        given = parameters or {}
        with self._lock, self._translated():
            observer = self._observer
            if observer is None:
                return self._db.execute(text, given).fetchall()
            rows, query = traced(self._db, text, given)
        observer(query)
        return rows

    def _select(self, select: Select, limit: int | None = None) -> list[Row]:
        if limit is None:
            return self._rows(select.text(), select.parameters)
        return self._rows(select.text() + " LIMIT :limit", {**select.parameters, "limit": limit})

    def objects(
        self,
        *,
        ids: Sequence[str] | None = None,
        categories: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        votes: bool = False,
        embeddings: bool = True,
    ) -> list[ObjectRecord]:
        """Return objects by id; see `Store.objects`."""
        select = sqlite_read.objects(ids, categories, names, votes=votes, embeddings=embeddings)
        return [object_record(row) for row in self._select(select)]

    def categories(self) -> list[tuple[str, int]]:
        """Return (category, objects of it), by category."""
        text = "SELECT category, count(*) FROM oic GROUP BY category ORDER BY category"
        return [(category, count) for category, count in self._rows(text)]

    def names(self) -> list[TaughtName]:
        """Return what people call the objects, by (word, owner or ""), none twice."""
        text = "SELECT DISTINCT word, owner FROM oic_name ORDER BY word, ifnull(owner, ''), owner"
        return [TaughtName(word, owner) for word, owner in self._rows(text)]

    def embeddings(self, limit: int | None = None) -> tuple[list[str], NDArray[np.float32]]:
        """Return the ids, by id, of the objects with an embedding, and their matrix (n, d)."""
        rows = self._select(sqlite_read.embeddings(), limit)
        kind = self._rows("SELECT value FROM internal WHERE key = 'embedding'")
        length = json.loads(kind[0][0])[1] if kind else 0
        matrix = np.frombuffer(b"".join(blob for _, blob in rows), dtype="<f4")
        return [object_id for object_id, _ in rows], matrix.reshape(len(rows), length)

    def stays(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[StayRecord]:
        """Return stays by (object_id, place) whose [first, last] touches [start, end]."""
        select = sqlite_read.stays(object_ids, area, start_ms, end_ms, trees=self._trees)
        return [stay_record(row) for row in self._select(select)]

    def stays_at(self, keys: Sequence[StayKey]) -> list[StayRecord]:
        """Return these stays of those that there are, by (object_id, place)."""
        return [stay_record(row) for row in self._stay_rows.read(self._rows, keys)]

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> list[Sighting]:
        """Return sightings by (start, object_id, place) that touch the closed [start, end]."""
        select = sqlite_read.sightings(object_ids, area, start_ms, end_ms, trees=self._trees)
        return [sighting_record(row) for row in self._select(select, limit)]

    def sightings_at(self, keys: Sequence[SightingKey]) -> list[Sighting]:
        """Return these sightings of those that there are, by (start, object_id, place)."""
        return [sighting_record(row) for row in self._select(sqlite_read.sightings_at({*keys}))]

    def spans(
        self,
        object_ids: Sequence[str],
        *,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> Spans:
        """Return when objects were seen, see `Store.spans`."""
        select = sqlite_read.spans(object_ids, area, start_ms, end_ms, trees=self._trees)
        return Spans.of_texts(object_ids, self._select(sqlite_read.of_each(select, limit)))

    def positions(self, object_ids: Sequence[str]) -> Positions:
        """Return where the stays of objects are, by (object_id, place)."""
        return positions(object_ids, self._select(sqlite_read.positions(object_ids)))

    def newest(
        self,
        object_ids: Sequence[str],
        limit: int,
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
        oldest: bool = False,
    ) -> list[Sighting]:
        """Return at most `limit` sightings, the newest of each stay first; see `Store.newest`."""
        asked = Newest(object_ids, limit, start_ms, end_ms, oldest=oldest)
        return [sighting_record(row) for row in self._stay_rows.kept(asked.read(self._rows))]

    def reach(self, object_ids: Sequence[str], count: int, *, oldest: bool = False) -> int | None:
        """Return the start of the count-th newest (or oldest) sighting of any of the objects."""
        select = sqlite_read.starts(object_ids, count - 1, oldest=oldest)
        rows = self._rows(select.text(), select.parameters)
        return int(rows[0][0]) if rows else None

    def count_seen(
        self,
        object_ids: Sequence[str],
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> int:
        """Count the objects with a sighting that touches the closed [start, end]."""
        return count_seen(self._rows, object_ids, start_ms, end_ms)

    def edges(
        self,
        object_ids: Sequence[str],
        which: str,
        *,
        before_ms: int | None = None,
        after_ms: int | None = None,
    ) -> list[Sighting]:
        """Return each object's "first" or "last" sighting, by object_id."""
        select = sqlite_read.edges(object_ids, which, before_ms, after_ms)
        return [sighting_record(row) for row in self._select(select)]

    def encounters(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        with_ids: Sequence[str] | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Encounter]:
        """Return encounters by (start, a, b, places) between the two lists of objects."""
        select = sqlite_read.encounters(object_ids, with_ids, start_ms, end_ms)
        return [encounter_record(row) for row in self._select(select)]

    def keyframe(self, key: str) -> Keyframe | None:
        """Return a stored picture."""
        text = "SELECT key, jpeg, width, height, time_ms FROM keyframe WHERE key = :key"
        rows = self._rows(text, {"key": key})
        return Keyframe(*rows[0]) if rows else None

    def keyframe_keys(self) -> list[str]:
        """Return the keys of all stored pictures, sorted."""
        return [key for (key,) in self._rows("SELECT key FROM keyframe ORDER BY key")]

    def views(self, *, start_ms: int | None = None, end_ms: int | None = None) -> list[View]:
        """Return views by (start, end) that touch the closed [start, end]."""
        return [view_record(row) for row in self._select(sqlite_read.views(start_ms, end_ms))]

    def last_view_ms(self) -> int | None:
        """Return the time of the newest frame: of the views and of the recordings."""
        return last_view_ms(self._rows)

    def regions(self) -> list[Region]:
        """Return named rooms, by name."""
        text, record = READERS["region"]
        return [record(row) for row in self._rows(text)]  # type: ignore[misc]  # by its kind

    def recordings(self) -> list[RecordingRecord]:
        """Return recordings, by key."""
        text, record = READERS["recording"]
        return [record(row) for row in self._rows(text)]  # type: ignore[misc]  # by its kind

    def meta(self, key: str) -> Any | None:
        """Return a JSON value, None where it is not set."""
        rows = self._rows("SELECT value FROM meta WHERE key = :key", {"key": key})
        return json.loads(rows[0][0]) if rows else None

    def state(self) -> bytes | None:
        """Return the associator's checkpoint."""
        rows = self._rows("SELECT value FROM state")
        return rows[0][0] if rows else None

    def revision(self) -> tuple[int, int] | None:
        """Return the commits of others that this connection saw, and its own changes."""
        with self._lock, self._translated():
            (others,) = self._db.execute("PRAGMA data_version").fetchone()
            return int(others), self._db.total_changes

    def counts(self) -> Json:
        """Return how many records of each kind there are, and the size with the log in bytes."""
        from d3a.store.sqlite_check import counts, size

        with self._lock, self._translated():
            counted = counts(self._db)
        return {**counted, "bytes": size(self._path)}

    def check(self) -> list[str]:
        """Return what is damaged or dangling, a sentence each; [] for a sound store."""
        from d3a.store.sqlite_check import check

        with self._lock, self._translated():
            return check(self._db, trees=self._trees)

    def repair(self) -> list[str]:
        """Mend what `check` finds, where it can be, in one transaction; a sentence each."""
        from d3a.store.sqlite_repair import repair

        with self.turn():
            return repair(self._db, trees=self._trees)

    def tracing(self, observer: Callable[[NativeQuery], None] | None) -> None:
        """Call `observer` after every query of a question; None stops it."""
        self._observer = observer

    def dump(self) -> Iterator[Json]:
        """Yield every record in a fixed order, from one moment, whatever is written meanwhile."""
        from d3a.store.sqlite_dump import dump

        with self._translated():
            yield from dump(self._db, self._path)
