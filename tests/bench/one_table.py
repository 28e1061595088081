"""Naive as one would write it by hand: one table of detections, its indexes, its SQL.

It does what retrieval of all keyframes at the rung Category does over a filled store: finds every
detection of the category (in the slice; of two, in one frame and within reach), orders them by the
same probability and makes the same keyframes of them. It has no planner and no facts to read, so
nothing that is the project's own is held against it.
"""

from __future__ import annotations

import math
import sqlite3
import struct
from datetime import datetime
from pathlib import Path
from typing import Any

from assistant.lexicon import VocabularyLexicon
from d3a.answer import RankedKeyframe
from d3a.answering.calibration import calibrated, kind_of
from d3a.answering.match import rungs
from d3a.answering.points import looked_at
from d3a.answering.run import milliseconds
from d3a.answering.steps import FindObjects
from d3a.frozen import maker
from d3a.parameters import Parameters
from d3a.rank import views_probability
from d3a.store.base import Store
from grammar.forms import FormalQuery, ObjectTerm

_TABLE = """
CREATE TABLE detection (id TEXT PRIMARY KEY, category TEXT NOT NULL, time_ms INTEGER NOT NULL,
  frame TEXT NOT NULL, probability REAL NOT NULL, box BLOB NOT NULL, x REAL, y REAL, z REAL);
CREATE INDEX by_time ON detection (category, time_ms);
CREATE INDEX by_frame ON detection (frame, category);
"""
_COLUMNS = ("id", "category", "time_ms", "frame", "probability", "box", "x", "y", "z")
_BOX = struct.Struct("<4d")
_keyframe = maker(RankedKeyframe)


def fill(path: Path, naive: Store) -> sqlite3.Connection:
    """Return a new file of the detections that a Naive store has, an object each."""
    category = {record.object_id: record.category for record in naive.objects(embeddings=False)}
    position = {stay.object_id: stay.position for stay in naive.stays()}
    connection = sqlite3.connect(path)
    connection.executescript(_TABLE)
    rows = []
    for s in naive.sightings():
        seen = (s.object_id, category[s.object_id], s.start_ms, s.frame, s.probability)
        rows.append((*seen, _BOX.pack(*s.box), *(position[s.object_id] or (None, None, None))))
    connection.executemany(f"INSERT INTO detection VALUES ({', '.join('?' * 9)})", rows)
    connection.commit()
    connection.execute("ANALYZE")
    return connection


def ask(
    table: sqlite3.Connection, query: FormalQuery, now: datetime, parameters: Parameters
) -> list[RankedKeyframe]:
    """Return all keyframes of a question, best first, or by time where the last is asked for."""
    things = len(query.objects)
    scored = []
    for row in _found(table, query, parameters):
        rows = [row[at * len(_COLUMNS) : (at + 1) * len(_COLUMNS)] for at in range(things)]
        product = math.prod(views_probability(each[4], 1) for each in rows)
        scored.append((calibrated(product, kind_of(things, by_looks=False)), rows))
    if query.select in ("last", "first"):
        sign = -1 if query.select == "last" else 1
        scored.sort(key=lambda one: (sign * one[1][0][2], -one[0], one[1][0][0]))
    else:
        scored.sort(key=lambda one: (-one[0], one[1][0][2], one[1][0][0]))
    told = [(score, row) for score, rows in scored for row in rows]
    return [_told(row, score, rank, now) for rank, (score, row) in enumerate(told, 1)]


def _found(table: sqlite3.Connection, query: FormalQuery, parameters: Parameters) -> list[Any]:
    time = looked_at(query.time)
    low, high = milliseconds(time.start) or 0, milliseconds(time.end) or 2**62
    columns = ", ".join(f"{of}.{name}" for of in "ab"[: len(query.objects)] for name in _COLUMNS)
    called = [_called(table, term) for term in query.objects]
    among = [f"IN ({', '.join('?' * len(names))})" for names in called]
    text = f"SELECT {columns} FROM detection a "
    if len(called) == 2:
        text += f"JOIN detection b ON b.frame = a.frame AND b.category {among[1]} AND b.id <> a.id "
    text += f"WHERE a.category {among[0]} AND a.time_ms >= ? AND a.time_ms < ?"
    given: list[str | float] = [name for names in reversed(called) for name in names]
    given += [low, high]
    if len(called) == 2:
        apart = " + ".join(f"(a.{axis} - b.{axis}) * (a.{axis} - b.{axis})" for axis in "xyz")
        text += f" AND {apart} <= ?"
        given.append(parameters.together_m**2)
    return table.execute(text, given).fetchall()


def _called(table: sqlite3.Connection, term: ObjectTerm) -> list[str]:
    known = [name for (name,) in table.execute("SELECT DISTINCT category FROM detection")]
    step = FindObjects("x", term.category, term.word, precision="category")
    return list(rungs(step, known, VocabularyLexicon()))


def _told(row: tuple[Any, ...], score: float, rank: int, now: datetime) -> RankedKeyframe:
    at = datetime.fromtimestamp(row[2] / 1000, tz=now.tzinfo)
    return _keyframe(
        rank=rank,
        score=score,
        object_id=row[0],
        category=row[1],
        frame=row[3],
        probability=row[4],
        box=_BOX.unpack(row[5]),
        start=at,
        end=at,
        position=None if row[6] is None else row[6:9],
        place=None,
        near=None,
        seen=1,
        last_absent=None,
        image=None,
        why={"match": 1.0, "detection": round(row[4], 4), "views": 1},
        group=None,
        beyond=None,
        vague=None,
        within=None,
        first_missed=None,
    )
