"""The tables of the SQLite store, and how a file of an older schema becomes one of today's.

Measured (20 k to 1 M places): `(object_id, start)` and `(object_id, end)` turn a sighting's history
into a range, the R*Trees a box; a place's box in them is wider than the place by `SLACK_M`, so that
a static object whose mean moves by centimetres does not rewrite them with every view.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable

from d3a.store.base import StoreError

APPLICATION_ID = 0x44334131  # "D3A1"
SLACK_M = 0.1
TREE_STEP_MS = 60_000
"""Intervals end on the next multiple of this in the R*Tree: extending one seldom rewrites it."""

_TABLES = """
CREATE TABLE internal (key TEXT PRIMARY KEY, value) WITHOUT ROWID;
INSERT INTO internal VALUES ('max_sighting_ms', 0), ('max_encounter_ms', 0), ('max_view_ms', 0);
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE state (id INTEGER PRIMARY KEY CHECK (id = 0), value BLOB NOT NULL);
CREATE TABLE recording (
  key TEXT PRIMARY KEY, name TEXT NOT NULL, site TEXT NOT NULL, zone TEXT,
  frames INTEGER NOT NULL, detections INTEGER NOT NULL, first_ms INTEGER, last_ms INTEGER,
  last_frame TEXT, done INTEGER NOT NULL, skipped TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE region (
  name TEXT PRIMARY KEY, polygon TEXT NOT NULL, site TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE oic (
  object_id TEXT PRIMARY KEY, category TEXT NOT NULL, weight REAL NOT NULL,
  first_ms INTEGER NOT NULL, last_ms INTEGER NOT NULL, site TEXT NOT NULL,
  categories TEXT NOT NULL, names TEXT NOT NULL, embedding BLOB, embedding_model TEXT,
  extent BLOB, tentative INTEGER NOT NULL, volatile INTEGER NOT NULL
);
CREATE INDEX oic_category ON oic (category, object_id);
CREATE TABLE oic_name (word TEXT NOT NULL, owner TEXT, object_id TEXT NOT NULL);
CREATE INDEX oic_name_word ON oic_name (word, owner, object_id);
CREATE INDEX oic_name_object ON oic_name (object_id);
CREATE TABLE stc (
  stay_id INTEGER PRIMARY KEY, object_id TEXT NOT NULL, place INTEGER NOT NULL,
  x REAL, y REAL, z REAL, first_ms INTEGER NOT NULL, last_ms INTEGER NOT NULL,
  weight REAL NOT NULL, site TEXT NOT NULL, covariance BLOB, seen INTEGER NOT NULL,
  moved_place INTEGER, moved_score REAL, last_absent_ms INTEGER,
  tentative INTEGER NOT NULL, volatile INTEGER NOT NULL, tree_x REAL, tree_y REAL,
  UNIQUE (object_id, place)
);
CREATE INDEX stc_object_last ON stc (object_id, last_ms);
CREATE INDEX stc_last ON stc (last_ms);
CREATE TABLE sighting (
  id INTEGER PRIMARY KEY, stay_id INTEGER NOT NULL, object_id TEXT NOT NULL,
  place INTEGER NOT NULL, start_ms INTEGER NOT NULL, end_ms INTEGER NOT NULL,
  frame TEXT NOT NULL, probability REAL NOT NULL, box BLOB NOT NULL, image TEXT,
  seen INTEGER NOT NULL, category TEXT NOT NULL, recording TEXT NOT NULL,
  keyframe_ms INTEGER, viewer BLOB, UNIQUE (stay_id, start_ms)
);
CREATE INDEX sighting_object_start ON sighting (object_id, start_ms, end_ms, place);
CREATE INDEX sighting_object_end ON sighting (object_id, end_ms, start_ms, place);
CREATE INDEX sighting_start ON sighting (start_ms, object_id, place);
CREATE INDEX sighting_image ON sighting (image) WHERE image IS NOT NULL;
CREATE TABLE encounter (
  id INTEGER PRIMARY KEY, object_a TEXT NOT NULL, object_b TEXT NOT NULL,
  place_a INTEGER NOT NULL, place_b INTEGER NOT NULL,
  start_ms INTEGER NOT NULL, end_ms INTEGER NOT NULL, frame TEXT NOT NULL,
  box_a BLOB NOT NULL, box_b BLOB NOT NULL, probability REAL NOT NULL, image TEXT,
  seen INTEGER NOT NULL, recording TEXT NOT NULL, viewer BLOB,
  UNIQUE (object_a, object_b, place_a, place_b, start_ms)
);
CREATE INDEX encounter_a ON encounter (object_a, start_ms);
CREATE INDEX encounter_b ON encounter (object_b, start_ms);
CREATE INDEX encounter_start ON encounter (start_ms);
CREATE INDEX encounter_image ON encounter (image) WHERE image IS NOT NULL;
CREATE TABLE seen_area (
  start_ms INTEGER NOT NULL, end_ms INTEGER NOT NULL, frames INTEGER NOT NULL,
  site TEXT NOT NULL, recording TEXT NOT NULL, x REAL, y REAL, yaw REAL, half_angle REAL,
  range_m REAL, PRIMARY KEY (start_ms, site, recording)
) WITHOUT ROWID;
CREATE INDEX seen_area_end ON seen_area (end_ms);
CREATE TABLE keyframe (
  key TEXT PRIMARY KEY, jpeg BLOB NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL,
  time_ms INTEGER NOT NULL
);
"""
_TREES = """
CREATE VIRTUAL TABLE stc_tree USING rtree (id, x0, x1, y0, y1);
CREATE VIRTUAL TABLE sighting_tree USING rtree (id, x0, x1, y0, y1, t0, t1);
"""
_WITHOUT_TREES = """
CREATE INDEX stc_x ON stc (tree_x, tree_y);
"""


def has_rtree(connection: sqlite3.Connection) -> bool:
    """Whether this build of SQLite has the R*Tree module."""
    row = connection.execute("SELECT sqlite_compileoption_used('ENABLE_RTREE')").fetchone()
    return bool(row[0])


def has_trees(connection: sqlite3.Connection) -> bool:
    """Whether the store's file was made with R*Trees."""
    found = connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'stc_tree'").fetchone()
    return found is not None


def create_tables(connection: sqlite3.Connection, *, trees: bool) -> None:
    """Create the tables of schema 1 inside the caller's transaction."""
    for statement in (_TABLES + (_TREES if trees else _WITHOUT_TREES)).split(";\n"):
        if statement.strip():
            connection.execute(statement)


Migration = Callable[[sqlite3.Connection], None]


def index_votes(connection: sqlite3.Connection) -> None:
    """Turn schema 1 into 2: the categories that some detections of an object had, as an index."""
    connection.execute(
        "CREATE TABLE oic_vote (category TEXT NOT NULL, object_id TEXT NOT NULL, "
        "PRIMARY KEY (category, object_id)) WITHOUT ROWID"
    )
    connection.execute("CREATE INDEX oic_vote_object ON oic_vote (object_id)")
    connection.execute(
        "INSERT OR IGNORE INTO oic_vote SELECT json_extract(vote.value, '$[0]'), object_id "
        "FROM oic, json_each(oic.categories) AS vote "
        "WHERE json_extract(vote.value, '$[0]') <> oic.category"
    )


def add_apart(connection: sqlite3.Connection) -> None:
    """Turn schema 2 into 3: how far two things are from each other as a shared frame measured."""
    connection.execute("ALTER TABLE encounter ADD COLUMN apart BLOB")


def refuse_future(version: int, newest: int) -> None:
    """Raise StoreError for a schema that a later version of the product has written."""
    if version > newest:
        raise StoreError(
            f"it has schema {version}, this version reads up to {newest}: update d3a to open it"
        )


def migrate(
    connection: sqlite3.Connection, version: int, migrations: tuple[Migration, ...]
) -> None:
    """Bring a file of schema `version` to schema `len(migrations) + 1`.

    Runs in the caller's transaction. migrations[n] turns schema n + 1 into n + 2. Raises
    StoreError for a schema of the future.
    """
    newest = len(migrations) + 1
    refuse_future(version, newest)
    for step in migrations[version - 1 :]:
        step(connection)
    connection.execute(f"PRAGMA user_version = {newest:d}")
