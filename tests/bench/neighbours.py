"""The same questions on what one would use instead: SQL over detections, a vector store.

A drawn home's detections, six of each sighting with times and places as a recording has them, go
into SQLite and DuckDB with the indexes that hand-written SQL wants, and with their embeddings into
LanceDB (extra `bench`: DuckDB is MIT, LanceDB Apache-2.0). All give fifty keyframes a question;
what they cannot say (which detections are one thing, whether it is still there, what has moved) is
counted as how many different places the fifty show. The colour is what the histogram's nearest
paint says, computed beforehand for SQL.
"""

from __future__ import annotations

import importlib.util
import sqlite3
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assistant.asking import ask
from d3a.store import open_store
from d3a.store.base import Store
from tests.bench.bench_scale import now_of, say
from tests.worlds import scaled
from tests.worlds.made import PAINTS, painted

VIEWS = 6
DAY_MS = scaled.DAY_MS
LIMIT = 50
TOP_UP = 2_000
"""Rows of each thing that a vector store is asked for, to be joined by frame outside of it."""
Keyframes = list[tuple[str, int]]
Ask = Callable[[str, str], Keyframes]
_TABLE = """
CREATE TABLE detection (frame TEXT, time_ms BIGINT, category TEXT, colour TEXT,
  probability DOUBLE, object_id TEXT, place INTEGER, x DOUBLE, y DOUBLE, z DOUBLE)
"""
_INDEXES = (
    "CREATE INDEX by_look ON detection (category, colour, probability)",
    "CREATE INDEX by_time ON detection (category, time_ms)",
    "CREATE INDEX by_frame ON detection (frame, category)",
)
_COLUMNS = "object_id, place"


@dataclass(frozen=True)
class Detections:
    """The rows of _TABLE, and the object's number of each, for its embedding."""

    rows: list[tuple[Any, ...]]
    looks: dict[str, NDArray[np.float32]]


def compare(folder: Path, home: Path, places: int, questions: int = 20) -> None:
    """Print what each takes for Q1, Q3 and Q2, against d3a in the same run."""
    with closing(open_store(str(home), read_only=True)) as store:
        yesterday = _yesterday(store)
        found = _detections(store)
        say(
            f"\nneighbours on {len(found.rows)} detections of {places} stays, {questions} questions"
        )
        _print("d3a", _ours(store), questions)
    with closing(sqlite3.connect(":memory:")) as lite:
        lite.execute(_TABLE)
        marks = ", ".join("?" * 10)
        lite.executemany(f"INSERT INTO detection VALUES ({marks})", found.rows)
        _print("SQLite, SQL", _by_sql(lite, yesterday), questions)
    if importlib.util.find_spec("duckdb") is not None:
        _print("DuckDB, SQL", _duckdb(found, yesterday), questions)
    else:
        say("  DuckDB is not installed (extra bench)")
    if importlib.util.find_spec("lancedb") is not None:
        _print("LanceDB", _lancedb(folder / "lance", found, yesterday), questions)
    else:
        say("  LanceDB is not installed (extra bench)")


def _yesterday(store: Store) -> tuple[int, int]:
    midnight = now_of(store).replace(hour=0, minute=0, second=0, microsecond=0)
    begin = midnight - timedelta(days=1)
    return round(begin.timestamp() * 1000), round(midnight.timestamp() * 1000)


def _detections(store: Store) -> Detections:
    draw = np.random.default_rng(2)
    names = list(PAINTS)
    paints = np.stack([painted(rgb, draw) for rgb in PAINTS.values()])
    looks, colour, category = {}, {}, {}
    for record in store.objects():
        if record.embedding is not None:
            looks[record.object_id] = record.embedding
            colour[record.object_id] = names[int(np.argmax(paints @ record.embedding))]
            category[record.object_id] = record.category
    spot = {stay.key: stay.position for stay in store.stays()}
    rows = []
    for s in store.sightings():
        x, y, z = spot[s.stay] or (0.0, 0.0, 0.0)
        for k in range(VIEWS):
            at = s.start_ms + (s.end_ms - s.start_ms) * k // VIEWS
            frame = f"{s.viewer and s.viewer[:3]}-{s.start_ms // DAY_MS}-{k}"  # one look at a spot
            known = (category[s.object_id], colour[s.object_id], s.probability)
            rows.append((frame, at, *known, s.object_id, s.place, x, y, z))
    return Detections(rows, looks)


def _ours(store: Store) -> dict[str, Ask]:
    now = now_of(store)

    def told(text: str) -> Keyframes:
        found = ask(store, text, now=now).keyframes
        return [(k.object_id, hash(k.position)) for k in found]

    return {
        "Q1": lambda a, _: told(f"Did you ever see a red {a}?"),
        "Q3": lambda a, _: told(f"Did you see a {a} yesterday?"),
        "Q2": lambda a, b: told(f"Did you see a {a} with a {b} yesterday?"),
    }


def _by_sql(connection: Any, yesterday: tuple[int, int]) -> dict[str, Ask]:
    """Return the questions as one would write them in SQL; makes the indexes first."""
    for index in _INDEXES:
        connection.execute(index)
    begin, end = yesterday

    def asked(text: str, *values: object) -> Keyframes:
        return list(connection.execute(text, values).fetchall())

    red = (
        f"SELECT {_COLUMNS} FROM detection WHERE category = ? AND colour = 'red' "
        f"ORDER BY probability DESC LIMIT {LIMIT}"
    )
    then = (
        f"SELECT {_COLUMNS} FROM detection WHERE category = ? AND time_ms >= ? AND time_ms < ? "
        f"ORDER BY probability DESC LIMIT {LIMIT}"
    )
    both = (
        "SELECT a.object_id, a.place FROM detection a JOIN detection b ON b.frame = a.frame "
        "WHERE a.category = ? AND b.category = ? AND a.time_ms >= ? AND a.time_ms < ? "
        "AND (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) "
        "+ (a.z - b.z) * (a.z - b.z) <= 1 "
        f"ORDER BY a.probability * b.probability DESC LIMIT {LIMIT}"
    )
    return {
        "Q1": lambda a, _: asked(red, a),
        "Q3": lambda a, _: asked(then, a, begin, end),
        "Q2": lambda a, b: asked(both, a, b, begin, end),
    }


def _duckdb(found: Detections, yesterday: tuple[int, int]) -> dict[str, Ask]:
    import duckdb
    import pyarrow as pa

    names = ("frame", "time_ms", "category", "colour", "probability", "object_id", "place", *"xyz")
    columns = zip(*found.rows, strict=True)
    table = pa.table(dict(zip(names, map(list, columns), strict=True)))
    connection = duckdb.connect()
    connection.execute(_TABLE)
    connection.register("arrived", table)
    connection.execute("INSERT INTO detection SELECT * FROM arrived")
    return _by_sql(_WithTuples(connection), yesterday)


@dataclass(frozen=True)
class _WithTuples:
    """DuckDB takes a list of parameters, or none."""

    connection: Any

    def execute(self, text: str, values: tuple[object, ...] = ()) -> Any:
        return self.connection.execute(text, list(values))


def _lancedb(folder: Path, found: Detections, yesterday: tuple[int, int]) -> dict[str, Ask]:
    """Return the questions to vectors with filters; together is joined by frame here."""
    import lancedb

    table = lancedb.connect(folder).create_table("detection", data=_arrow(found), mode="overwrite")
    table.create_scalar_index("category", index_type="BITMAP")
    table.create_scalar_index("time_ms")
    red = painted(PAINTS["red"], np.random.default_rng(3))
    begin, end = yesterday
    then = f"time_ms >= {begin} AND time_ms < {end}"

    def near(where: str, limit: int = LIMIT) -> list[dict[str, Any]]:
        columns = ["object_id", "place", "frame", "x", "y", "z", "_distance"]
        return list(
            table.search(red).where(where, prefilter=True).select(columns).limit(limit).to_list()
        )

    def kept(where: str) -> Keyframes:
        return [(row["object_id"], row["place"]) for row in near(where)]

    def together(a: str, b: str) -> Keyframes:
        others: dict[str, list[Any]] = {}
        for row in near(f"category = '{b}' AND {then}", TOP_UP):
            others.setdefault(row["frame"], []).append(row)
        pairs = [
            (one["object_id"], one["place"])
            for one in near(f"category = '{a}' AND {then}", TOP_UP)
            for other in others.get(one["frame"], ())
            if sum((one[axis] - other[axis]) ** 2 for axis in "xyz") <= 1
        ]
        return pairs[:LIMIT]

    return {
        "Q1": lambda a, _: kept(f"category = '{a}'"),
        "Q3": lambda a, _: kept(f"category = '{a}' AND {then}"),
        "Q2": together,
    }


def _arrow(found: Detections, part: int = 20_000) -> Any:
    """Return the rows as record batches with the embedding of their object."""
    import pyarrow as pa

    def batches() -> Iterator[Any]:
        for at in range(0, len(found.rows), part):
            rows = found.rows[at : at + part]
            vectors = np.stack([found.looks[row[5]] for row in rows])
            values = pa.array(vectors.ravel(), type=pa.float32())
            arrays = [pa.FixedSizeListArray.from_arrays(values, vectors.shape[1])]
            arrays += [pa.array([row[k] for row in rows]) for k in (0, 1, 2, 5, 6, 7, 8, 9)]
            names = ["vector", "frame", "time_ms", "category", "object_id", "place", *"xyz"]
            yield pa.RecordBatch.from_arrays(arrays, names=names)

    return pa.Table.from_batches(list(batches()))


def _print(name: str, asks: dict[str, Ask], questions: int) -> None:
    """Print median and p95 of each form, and how many different places fifty keyframes show."""
    step = len(scaled.MOVABLE) / questions
    told = []
    for form, one in asks.items():
        spent, different = [], []
        for number in range(questions):
            a = scaled.MOVABLE[int(number * step)]
            b = scaled.MOVABLE[(number * 7 + 3) % len(scaled.MOVABLE)]
            one(a, b)
            begun = time.perf_counter()
            found = one(a, b)
            spent.append((time.perf_counter() - begun) * 1000)
            if found:
                different.append(len(set(found)))
        p95 = float(np.percentile(spent, 95))
        places = statistics.median(different) if different else 0
        told.append(f"{form} {statistics.median(spent):7.3f} / {p95:7.3f} ms, {places:3.0f} places")
    say(f"  {name:12} " + " | ".join(told))
