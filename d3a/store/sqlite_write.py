"""How a batch becomes rows: removals, absolute puts, and the two R*Trees kept in step."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Sequence

from d3a.store.base import Batch, ObjectRecord, Sighting, StayKey, StayRecord
from d3a.store.limits import EmbeddingKind, check_referred, embedding_kind, referred
from d3a.store.records import meta_json
from d3a.store.rows import (
    ENCOUNTER_COLUMNS,
    OBJECT_COLUMNS,
    RECORDING_COLUMNS,
    REGION_COLUMNS,
    SIGHTING_COLUMNS,
    STAY_COLUMNS,
    VIEW_COLUMNS,
    encounter_row,
    object_row,
    recording_row,
    region_row,
    sighting_row,
    stay_row,
    view_row,
)
from d3a.store.schema import SLACK_M, TREE_STEP_MS

_KEPT_M = SLACK_M * 0.9
"""A place that moved less stays in its old box of the trees; a tenth is left for rounding."""


def _upsert(table: str, columns: str, key: Sequence[str]) -> str:
    names = columns.split(", ")
    changes = ", ".join(f"{name} = excluded.{name}" for name in names if name not in key)
    return (
        f"INSERT INTO {table} ({columns}) VALUES ({', '.join('?' * len(names))}) "
        f"ON CONFLICT ({', '.join(key)}) DO UPDATE SET {changes}"
    )


_PUT_OBJECT = _upsert("oic", OBJECT_COLUMNS, ["object_id"])
_PUT_STAY = _upsert("stc", STAY_COLUMNS + ", tree_x, tree_y", ["object_id", "place"])
_PUT_SIGHTING = _upsert(
    "sighting", SIGHTING_COLUMNS + ", stay_id", ["stay_id", "start_ms", "object_id", "place"]
).replace("(stay_id, start_ms, object_id, place) DO", "(stay_id, start_ms) DO")
_PUT_ENCOUNTER = _upsert(
    "encounter", ENCOUNTER_COLUMNS, ["object_a", "object_b", "place_a", "place_b", "start_ms"]
)
_PUT_VIEW = _upsert("seen_area", VIEW_COLUMNS, ["start_ms", "site", "recording"])
_PUT_REGION = _upsert("region", REGION_COLUMNS, ["name"])
_PUT_RECORDING = _upsert("recording", RECORDING_COLUMNS, ["key"])
_PUT_KEYFRAME = _upsert("keyframe", "key, jpeg, width, height, time_ms", ["key"])
_PUT_META = _upsert("meta", "key, value", ["key"])
_PUT_STATE = _upsert("state", "id, value", ["id"])
_PUT_INTERNAL = _upsert("internal", "key, value", ["key"])


class Writer:
    """Writes one batch inside the caller's transaction; `trees`: the file has R*Trees."""

    def __init__(self, connection: sqlite3.Connection, *, trees: bool) -> None:
        self._db = connection
        self._trees = trees

    def write(self, batch: Batch) -> None:
        """Write a batch that `check_batch` took; raises StoreRefused for dangling records."""
        self._check(batch)
        self._remove(batch)
        self._put_objects(batch.objects)
        self._put_stays(batch.stays)
        self._put_sightings(batch.sightings)
        self._db.executemany(_PUT_ENCOUNTER, map(encounter_row, batch.encounters))
        self._db.executemany(_PUT_VIEW, map(view_row, batch.views))
        self._raise_bounds(batch)
        self._db.executemany(
            _PUT_KEYFRAME,
            ((k.key, k.jpeg, k.width, k.height, k.time_ms) for k in batch.keyframes),
        )
        self._db.executemany(_PUT_REGION, map(region_row, batch.regions))
        self._db.executemany(_PUT_RECORDING, map(recording_row, batch.recordings))
        for key, value in batch.meta.items():
            if value is None:
                self._db.execute("DELETE FROM meta WHERE key = ?", (key,))
            else:
                self._db.execute(_PUT_META, (key, meta_json(value)))
        if batch.state is not None:
            self._db.execute(_PUT_STATE, (0, batch.state))

    def _check(self, batch: Batch) -> None:
        objects, stays = referred(batch)
        known_objects = self._db.execute(
            "SELECT object_id FROM oic WHERE object_id IN (SELECT value FROM json_each(?))",
            (json.dumps(sorted(objects)),),
        )
        known_stays = (stay for stay in stays if self._stay_id(stay) is not None)
        check_referred(batch, (row[0] for row in known_objects), known_stays)
        kind = self._embedding_kind()
        brought = embedding_kind(batch, kind)
        if brought != kind and brought is not None:
            text = json.dumps([brought.model, brought.length])
            self._db.execute(_PUT_INTERNAL, ("embedding", text))

    def _embedding_kind(self) -> EmbeddingKind | None:
        row = self._db.execute("SELECT value FROM internal WHERE key = 'embedding'").fetchone()
        return EmbeddingKind(*json.loads(row[0])) if row else None

    def _stay_id(self, stay: StayKey) -> int | None:
        found = self._place(*stay)
        return found[0] if found else None

    def _remove(self, batch: Batch) -> None:
        for object_id in batch.removed_objects:
            places = self._db.execute("SELECT place FROM stc WHERE object_id = ?", (object_id,))
            for (place,) in places.fetchall():
                self._remove_stay((object_id, place))
            self._db.execute("DELETE FROM oic_name WHERE object_id = ?", (object_id,))
            self._db.execute("DELETE FROM oic_vote WHERE object_id = ?", (object_id,))
            self._db.execute("DELETE FROM oic WHERE object_id = ?", (object_id,))
        for object_id, place in batch.removed_stays:
            self._remove_stay((object_id, int(place)))
        for object_id, place, start_ms in batch.removed_sightings:
            stay_id = self._stay_id((object_id, int(place)))
            self._remove_sightings("stay_id = ? AND start_ms = ?", (stay_id, int(start_ms)))
        self._db.executemany(
            "DELETE FROM encounter WHERE object_a = ? AND object_b = ? AND place_a = ? "
            "AND place_b = ? AND start_ms = ?",
            ((a, b, *map(int, numbers)) for a, b, *numbers in batch.removed_encounters),
        )
        self._db.executemany(
            "DELETE FROM region WHERE name = ?", ((name,) for name in batch.removed_regions)
        )
        self._db.executemany(
            "DELETE FROM seen_area WHERE site = ? AND recording = ? AND start_ms = ?",
            ((site, recording, int(start)) for site, recording, start in batch.removed_views),
        )
        self._db.executemany(
            "DELETE FROM keyframe WHERE key = ?", ((key,) for key in batch.removed_keyframes)
        )

    def _remove_stay(self, stay: StayKey) -> None:
        stay_id = self._stay_id(stay)
        if stay_id is None:
            return
        self._remove_sightings("stay_id = ?", (stay_id,))
        self._db.execute("DELETE FROM encounter WHERE object_a = ? AND place_a = ?", stay)
        self._db.execute("DELETE FROM encounter WHERE object_b = ? AND place_b = ?", stay)
        if self._trees:
            self._db.execute("DELETE FROM stc_tree WHERE id = ?", (stay_id,))
        self._db.execute("DELETE FROM stc WHERE stay_id = ?", (stay_id,))

    def _remove_sightings(self, condition: str, values: Iterable[int | None]) -> None:
        values = tuple(values)
        if self._trees:
            self._db.execute(
                "DELETE FROM sighting_tree WHERE id IN "
                f"(SELECT id FROM sighting WHERE {condition})",
                values,
            )
        self._db.execute(f"DELETE FROM sighting WHERE {condition}", values)

    def _put_objects(self, records: Sequence[ObjectRecord]) -> None:
        self._db.executemany(_PUT_OBJECT, map(object_row, records))
        self._db.executemany(
            "DELETE FROM oic_name WHERE object_id = ?", ((r.object_id,) for r in records)
        )
        last = {record.object_id: record for record in records}  # of two puts the later counts
        self._db.executemany(
            "INSERT INTO oic_name (word, owner, object_id) VALUES (?, ?, ?)",
            ((n.word, n.owner, r.object_id) for r in last.values() for n in r.names),
        )
        self._db.executemany(
            "DELETE FROM oic_vote WHERE object_id = ?", ((r.object_id,) for r in records)
        )
        self._db.executemany(
            "INSERT OR IGNORE INTO oic_vote (category, object_id) VALUES (?, ?)",
            ((c, r.object_id) for r in last.values() for c, _ in r.categories if c != r.category),
        )

    def _put_stays(self, records: Sequence[StayRecord]) -> None:
        """Put stays; their boxes in the trees follow a real move."""
        for record in records:
            row = stay_row(record)
            old = self._place(row[0], row[1])
            kept = old[1:] if old else (None, None)
            tree = _tree_place(row[2], row[3], kept)
            cursor = self._db.execute(_PUT_STAY, (*row, *tree))
            if self._trees and tree != kept:
                self._move_in_trees(old[0] if old else _new_id(cursor), tree)

    def _place(self, object_id: str, place: int) -> tuple[int, float | None, float | None] | None:
        """Return row id and place in the trees of a stay."""
        found: tuple[int, float | None, float | None] | None = self._db.execute(
            "SELECT stay_id, tree_x, tree_y FROM stc WHERE object_id = ? AND place = ?",
            (object_id, place),
        ).fetchone()
        return found

    def _move_in_trees(self, stay_id: int, tree: tuple[float | None, float | None]) -> None:
        sightings = self._db.execute(
            "SELECT id, start_ms, end_ms FROM sighting WHERE stay_id = ?", (stay_id,)
        ).fetchall()
        x, y = tree
        if x is None or y is None:
            self._db.execute("DELETE FROM stc_tree WHERE id = ?", (stay_id,))
            ids = [(sighting_id,) for sighting_id, _, _ in sightings]
            self._db.executemany("DELETE FROM sighting_tree WHERE id = ?", ids)
            return
        self._db.execute(
            "INSERT OR REPLACE INTO stc_tree VALUES (?, ?, ?, ?, ?)",
            (stay_id, x - SLACK_M, x + SLACK_M, y - SLACK_M, y + SLACK_M),
        )
        for sighting_id, start_ms, end_ms in sightings:
            self._put_in_tree(sighting_id, x, y, start_ms, end_ms)

    def _put_in_tree(self, sighting_id: int, x: float, y: float, start: int, end: int) -> None:
        base = self._tree_base(start)
        self._db.execute(
            "INSERT OR REPLACE INTO sighting_tree VALUES (?, ?, ?, ?, ?, ?, ?)",
            (
                sighting_id,
                x - SLACK_M,
                x + SLACK_M,
                y - SLACK_M,
                y + SLACK_M,
                (start - base) / 1000,
                (_tree_end(end) - base) / 1000,
            ),
        )

    def _tree_base(self, start_ms: int) -> int:
        """Return the one time that the tree's seconds count from: its floats have 24 bits."""
        row = self._db.execute("SELECT value FROM internal WHERE key = 'tree_base_ms'").fetchone()
        if row is None:
            self._db.execute(_PUT_INTERNAL, ("tree_base_ms", start_ms))
            return start_ms
        return int(row[0])

    def _put_sightings(self, records: Sequence[Sighting]) -> None:
        for record in records:
            row = sighting_row(record)
            start_ms, end_ms = row[2], row[3]
            stay = self._place(row[0], row[1])
            assert stay is not None  # `check_referred` has refused the batch otherwise
            stay_id, x, y = stay
            old = self._db.execute(
                "SELECT id, end_ms FROM sighting WHERE stay_id = ? AND start_ms = ?",
                (stay_id, start_ms),
            ).fetchone()
            cursor = self._db.execute(_PUT_SIGHTING, (*row, stay_id))
            if not self._trees or x is None or y is None:
                continue
            if old is None:
                self._put_in_tree(_new_id(cursor), x, y, start_ms, end_ms)
            elif _tree_end(old[1]) != _tree_end(end_ms):
                self._put_in_tree(old[0], x, y, start_ms, end_ms)

    def _raise_bounds(self, batch: Batch) -> None:
        self._raise("max_sighting_ms", [(r.start_ms, r.end_ms) for r in batch.sightings])
        self._raise("max_encounter_ms", [(r.start_ms, r.end_ms) for r in batch.encounters])
        self._raise("max_view_ms", [(r.start_ms, r.end_ms) for r in batch.views])

    def _raise(self, key: str, spans: Sequence[tuple[int, int]]) -> None:
        """Raise the bound that every time filter of a reader uses to at least these spans."""
        if spans:
            longest = max(int(end) - int(start) for start, end in spans)
            self._db.execute(
                "UPDATE internal SET value = max(value, ?) WHERE key = ?", (longest, key)
            )


def _new_id(cursor: sqlite3.Cursor) -> int:
    assert cursor.lastrowid is not None  # an INSERT has just run
    return cursor.lastrowid


def _tree_place(
    x: float | None, y: float | None, kept: tuple[float | None, float | None]
) -> tuple[float | None, float | None]:
    if x is None or y is None:
        return None, None
    if kept[0] is None or kept[1] is None:
        return x, y
    near = abs(x - kept[0]) <= _KEPT_M and abs(y - kept[1]) <= _KEPT_M
    return kept if near else (x, y)


def _tree_end(end_ms: int) -> int:
    return -(-end_ms // TREE_STEP_MS) * TREE_STEP_MS


def collect_keyframes(connection: sqlite3.Connection, keep: Sequence[str]) -> int:
    """Remove pictures that nothing refers to, but for `keep`; count them."""
    return connection.execute(
        "DELETE FROM keyframe WHERE key NOT IN (SELECT value FROM json_each(?)) "
        "AND NOT EXISTS (SELECT 1 FROM sighting WHERE image = key) "
        "AND NOT EXISTS (SELECT 1 FROM encounter WHERE image = key)",
        (json.dumps(list(keep)),),
    ).rowcount
