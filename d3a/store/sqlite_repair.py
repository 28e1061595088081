"""Mending a store's file: what dangles goes, indexes, trees and bounds are made anew.

The counterpart of `sqlite_check`. What SQLite itself calls damaged pages cannot be mended here.
"""

from __future__ import annotations

import sqlite3

from d3a.store.base import StoreDamaged
from d3a.store.schema import SLACK_M, TREE_STEP_MS
from d3a.store.sqlite_check import check, page_damage

_MENDED = {
    "removed {} stays of objects that are not stored": """
        DELETE FROM stc WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "removed {} sightings of stays that are not stored": """
        DELETE FROM sighting WHERE id IN (SELECT s.id FROM sighting s
        LEFT JOIN stc p ON p.stay_id = s.stay_id AND p.object_id = s.object_id
        AND p.place = s.place WHERE p.stay_id IS NULL)""",
    "removed {} encounters of stays that are not stored": """
        DELETE FROM encounter WHERE id IN (SELECT e.id FROM encounter e
        LEFT JOIN stc a ON a.object_id = e.object_a AND a.place = e.place_a
        LEFT JOIN stc b ON b.object_id = e.object_b AND b.place = e.place_b
        WHERE a.stay_id IS NULL OR b.stay_id IS NULL)""",
    "removed {} taught names of objects that are not stored": """
        DELETE FROM oic_name WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "removed {} votes for objects that are not stored": """
        DELETE FROM oic_vote WHERE object_id NOT IN (SELECT object_id FROM oic)""",
    "{} sightings no longer name a picture that is not stored": """
        UPDATE sighting SET image = NULL
        WHERE image IS NOT NULL AND image NOT IN (SELECT key FROM keyframe)""",
    "{} encounters no longer name a picture that is not stored": """
        UPDATE encounter SET image = NULL
        WHERE image IS NOT NULL AND image NOT IN (SELECT key FROM keyframe)""",
}
_BOUNDS = {
    "max_sighting_ms": "sighting",
    "max_encounter_ms": "encounter",
    "max_view_ms": "seen_area",
}
_FILL_PLACES = f"""
    INSERT INTO stc_tree SELECT stay_id, tree_x - {SLACK_M}, tree_x + {SLACK_M},
    tree_y - {SLACK_M}, tree_y + {SLACK_M} FROM stc WHERE tree_x IS NOT NULL"""
_FILL_SIGHTINGS = f"""
    INSERT INTO sighting_tree SELECT s.id, tree_x - {SLACK_M}, tree_x + {SLACK_M},
    tree_y - {SLACK_M}, tree_y + {SLACK_M}, (s.start_ms - :base) / 1000.0,
    ((s.end_ms + {TREE_STEP_MS - 1}) / {TREE_STEP_MS} * {TREE_STEP_MS} - :base) / 1000.0
    FROM sighting s JOIN stc p ON p.stay_id = s.stay_id WHERE p.tree_x IS NOT NULL"""


def repair(connection: sqlite3.Connection, *, trees: bool) -> list[str]:
    """Mend the file inside the caller's transaction; return a sentence for each change.

    Raises StoreDamaged where pages are, beyond what an index built anew would mend.
    """
    if not check(connection, trees=trees):
        return []
    _build_indexes(connection)
    said = []
    for sentence, statement in _MENDED.items():
        count = connection.execute(statement).rowcount
        if count:
            said.append(sentence.format(count))
    for key, table in _BOUNDS.items():
        raised = connection.execute(
            f"UPDATE internal SET value = (SELECT max(end_ms - start_ms) FROM {table}) "
            f"WHERE key = ? AND value < (SELECT max(end_ms - start_ms) FROM {table})",
            (key,),
        ).rowcount
        if raised:
            said.append(f"raised the bound {key} of the time filters")
    connection.execute("UPDATE stc SET tree_x = x, tree_y = y")
    if trees:
        _rebuild_trees(connection)
    return [*said, f"built the indexes{' and the R*Trees' if trees else ''} anew"]


def _build_indexes(connection: sqlite3.Connection) -> None:
    """Make the indexes anew; raise StoreDamaged where that does not mend the pages.

    What a damaged table no longer tells is not known, so nothing dangles for certain.
    """
    try:
        connection.execute("REINDEX")
        broken = page_damage(connection)
    except sqlite3.IntegrityError as error:  # a row stands twice
        broken = [str(error)]
    if broken:
        raise StoreDamaged(f"damaged pages cannot be mended, and nothing was changed: {broken[0]}")


def _rebuild_trees(connection: sqlite3.Connection) -> None:
    """Make both trees from the tables, by the definitions that they have."""
    for tree in ("stc_tree", "sighting_tree"):
        (definition,) = connection.execute(
            "SELECT sql FROM sqlite_master WHERE name = ?", (tree,)
        ).fetchone()
        connection.execute(f"DROP TABLE {tree}")
        connection.execute(definition)
    connection.execute(
        "INSERT OR IGNORE INTO internal SELECT 'tree_base_ms', min(start_ms) FROM sighting "
        "HAVING min(start_ms) IS NOT NULL"
    )
    base = connection.execute("SELECT value FROM internal WHERE key = 'tree_base_ms'").fetchone()
    connection.execute(_FILL_PLACES)
    if base is not None:
        connection.execute(_FILL_SIGHTINGS, {"base": base[0]})
