"""What can be wrong with a store's file, found by SQL: damage, dangling rows, trees out of step."""

from __future__ import annotations

import re
import sqlite3
from pathlib import Path

from d3a.store.errors import DAMAGED_PAGES
from d3a.store.schema import SLACK_M
from d3a.store.sqlite_errors import is_damage

_SHOWN = 5
_OF_INDEXES = re.compile(
    r"missing from index|wrong # of entries in index|non-unique entry in index"
)
"""What an index built anew mends; where pages are damaged, one cannot even be."""
_COUNTED = {
    "objects": "oic",
    "stays": "stc",
    "sightings": "sighting",
    "encounters": "encounter",
    "views": "seen_area",
    "keyframes": "keyframe",
    "regions": "region",
    "recordings": "recording",
}
_DANGLING = {
    "stay {} of an object that is not stored": """
        SELECT object_id || ' at ' || place FROM stc
        WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "sighting {} of a stay that is not stored": """
        SELECT s.object_id || ' at ' || s.place || ' from ' || s.start_ms FROM sighting s
        LEFT JOIN stc p ON p.stay_id = s.stay_id AND p.object_id = s.object_id
        AND p.place = s.place WHERE p.stay_id IS NULL""",
    "encounter {} of a stay that is not stored": """
        SELECT e.object_a || ' with ' || e.object_b || ' from ' || e.start_ms FROM encounter e
        LEFT JOIN stc a ON a.object_id = e.object_a AND a.place = e.place_a
        LEFT JOIN stc b ON b.object_id = e.object_b AND b.place = e.place_b
        WHERE a.stay_id IS NULL OR b.stay_id IS NULL""",
    "taught name {} of an object that is not stored": """
        SELECT word FROM oic_name WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "vote for {} of an object that is not stored": """
        SELECT category FROM oic_vote WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "picture {} is referred to and not stored": """
        SELECT image FROM sighting WHERE image IS NOT NULL
        AND image NOT IN (SELECT key FROM keyframe) UNION
        SELECT image FROM encounter WHERE image IS NOT NULL
        AND image NOT IN (SELECT key FROM keyframe)""",
    "{} lasts longer than the bound of the time filters": """
        SELECT 'sighting of ' || object_id || ' from ' || start_ms FROM sighting WHERE
        end_ms - start_ms > (SELECT value FROM internal WHERE key = 'max_sighting_ms') UNION ALL
        SELECT 'encounter of ' || object_a || ' from ' || start_ms FROM encounter WHERE
        end_ms - start_ms > (SELECT value FROM internal WHERE key = 'max_encounter_ms') UNION ALL
        SELECT 'view from ' || start_ms FROM seen_area WHERE
        end_ms - start_ms > (SELECT value FROM internal WHERE key = 'max_view_ms')""",
}
_TREES = {
    "stay {} is not where the R*Tree has it": """
        SELECT p.object_id || ' at ' || p.place FROM stc p LEFT JOIN stc_tree t ON t.id = p.stay_id
        WHERE p.x IS NOT NULL AND NOT ifnull(p.x BETWEEN t.x0 AND t.x1
        AND p.y BETWEEN t.y0 AND t.y1, 0)""",
    "sighting {} is not where the R*Tree has it": """
        SELECT s.object_id || ' at ' || s.place || ' from ' || s.start_ms
        FROM sighting s JOIN stc p ON p.stay_id = s.stay_id
        LEFT JOIN sighting_tree t ON t.id = s.id,
        (SELECT value AS base FROM internal WHERE key = 'tree_base_ms')
        WHERE p.x IS NOT NULL AND NOT ifnull(p.x BETWEEN t.x0 AND t.x1
        AND p.y BETWEEN t.y0 AND t.y1 AND (s.start_ms - base) / 1000.0 >= t.t0
        AND (s.end_ms - base) / 1000.0 <= t.t1, 0)""",
    "the R*Tree holds {}, which is not stored with a position": """
        SELECT 'stay ' || t.id FROM stc_tree t LEFT JOIN stc p ON p.stay_id = t.id
        WHERE p.x IS NULL UNION ALL
        SELECT 'sighting ' || t.id FROM sighting_tree t LEFT JOIN sighting s ON s.id = t.id
        LEFT JOIN stc p ON p.stay_id = s.stay_id WHERE p.x IS NULL""",
}
_FALLBACK = {
    "stay {} is not where its index has it": f"""
        SELECT object_id || ' at ' || place FROM stc WHERE x IS NOT NULL
        AND NOT ifnull(abs(x - tree_x) <= {SLACK_M} AND abs(y - tree_y) <= {SLACK_M}, 0)""",
}


def counts(connection: sqlite3.Connection) -> dict[str, int]:
    """Return how many records of each kind there are."""
    columns = ", ".join(f"(SELECT count(*) FROM {table})" for table in _COUNTED.values())
    row = connection.execute(f"SELECT {columns}").fetchone()
    return dict(zip(_COUNTED, row, strict=True))


def size(path: Path) -> int:
    """Return the bytes of a file and of its log."""
    log = path.with_name(path.name + "-wal")
    return sum(file.stat().st_size for file in (path, log) if file.exists())


def check(connection: sqlite3.Connection, *, trees: bool) -> list[str]:
    """Return a sentence for each kind of damage, with the first few records that show it."""
    found = [
        f"an index is damaged: {text}" if _OF_INDEXES.search(text) else f"{DAMAGED_PAGES}{text}"
        for text in page_damage(connection)
    ]
    try:
        found += _dangling(connection, trees=trees)
    except sqlite3.DatabaseError as error:
        if not is_damage(error):
            raise
        found.append(f"what else is wrong cannot be looked for: {error}")
    return found


def page_damage(connection: sqlite3.Connection) -> list[str]:
    """Return what SQLite finds wrong with the pages and the indexes of the file.

    Where the damage stops SQLite's own look at the whole, each table is looked at by itself.
    """
    found, stopped = _integrity(connection, "")
    if stopped is None:
        return found
    try:
        query = "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"
        tables = [name for (name,) in connection.execute(query)]
    except sqlite3.DatabaseError as error:
        if not is_damage(error):
            raise
        tables = []
    for table in tables:
        wrong, ended = _integrity(connection, f"('{table}')")
        found += [f"table {table}: {text}" for text in wrong]
        found += [] if ended is None else [f"table {table} cannot all be read: {ended}"]
    return found or [stopped]


def _integrity(connection: sqlite3.Connection, which: str) -> tuple[list[str], str | None]:
    """Return what is wrong with all or one table, and what ended the look before its time."""
    found: list[str] = []
    try:
        for (text,) in connection.execute(f"PRAGMA integrity_check{which}"):
            found += [] if text == "ok" else str(text).splitlines()
    except sqlite3.DatabaseError as error:
        if not is_damage(error):
            raise
        return found, str(error)
    return found, None


def _dangling(connection: sqlite3.Connection, *, trees: bool) -> list[str]:
    found = []
    if trees:
        for tree in ("stc_tree", "sighting_tree"):
            (text,) = connection.execute("SELECT rtreecheck(?)", (tree,)).fetchone()
            if text != "ok":
                found.append(f"the R*Tree {tree} is damaged: {text}")
    for sentence, query in {**_DANGLING, **(_TREES if trees else _FALLBACK)}.items():
        rows = [str(text) for (text,) in connection.execute(query)]
        if rows:
            more = f" and {len(rows) - _SHOWN} more" if len(rows) > _SHOWN else ""
            found.append(sentence.format(", ".join(rows[:_SHOWN]) + more))
    return found
