"""Killed writers, readers beside a writer, and batches that were cut between two steps."""

from __future__ import annotations

import signal
import sqlite3
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from d3a.store import open_store
from tests.worlds.oracle import OracleStore
from tests.worlds.victims import (
    SIGHTINGS_A_BATCH,
    after_batch,
    before_batch,
    kill_loop,
    run_victim,
    writer_at_work,
)

REWIND: dict[str, Any] = {"removed_objects": ["a", "d"], "meta": {"old": 1, "new": None}}


def test_what_was_acknowledged_outlives_a_killed_writer(tmp_path: Path) -> None:
    report = kill_loop(str(tmp_path / "home.db"), tmp_path, kills=4)
    assert report.acknowledged >= 4
    assert (report.lost, report.damaged) == (0, ())


def test_what_was_acknowledged_outlives_a_killed_client(mongo_uri: str, tmp_path: Path) -> None:
    report = kill_loop(mongo_uri, tmp_path, kills=3)
    assert report.acknowledged >= 3
    assert (report.lost, report.damaged) == (0, ())


def test_a_batch_cut_between_two_steps_is_finished_or_was_never_there(mongo_uri: str) -> None:
    before, after = OracleStore(), OracleStore()
    for oracle in (before, after):
        oracle.apply(before_batch())
    after.apply(after_batch())
    with closing(open_store(mongo_uri)) as store:
        store.apply(before_batch())
    seen: list[str] = []
    nth = 1
    while (code := run_victim(mongo_uri, nth)) != 0:
        assert code == -signal.SIGKILL
        with closing(open_store(mongo_uri)) as store:
            store.collect_keyframes()  # a picture comes first and may be left alone
            found = list(store.dump())
            assert found in (list(before.dump()), list(after.dump())), f"cut at command {nth}"
            seen.append("before" if found == list(before.dump()) else "after")
            assert store.check() == []
            store.apply(replace(before_batch(), **REWIND))
            store.collect_keyframes()
            assert list(store.dump()) == list(before.dump())
        nth += 1
    with closing(open_store(mongo_uri)) as store:
        assert list(store.dump()) == list(after.dump())
    assert seen == sorted(seen, reverse=True)  # once written down, always finished
    assert {"before", "after"} == set(seen)


def test_readers_see_whole_batches_while_another_process_writes(tmp_path: Path) -> None:
    uri = f"sqlite:///{tmp_path / 'home.db'}"
    with (
        writer_at_work(uri, tmp_path / "notes.txt"),
        closing(open_store(uri, create=False, read_only=True)) as store,
    ):
        sizes = []
        until = time.monotonic() + 1.0
        while time.monotonic() < until:
            kinds = [record["kind"] for record in store.dump()]
            assert kinds.count("sighting") == SIGHTINGS_A_BATCH * kinds.count("object")
            assert len(store.sightings()) % SIGHTINGS_A_BATCH == 0
            sizes.append(kinds.count("object"))
    assert sizes == sorted(sizes)
    assert sizes[-1] > sizes[0]


def test_a_commit_waits_for_the_disk(tmp_path: Path) -> None:
    """kill -9 keeps the page cache, so it cannot show this: the settings do."""
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        connection = store._db  # type: ignore[attr-defined]  # no public call tells the settings
        settings = {
            name: connection.execute(f"PRAGMA {name}").fetchone()[0]
            for name in ("synchronous", "journal_mode", "page_size")
        }
    assert settings == {"synchronous": 2, "journal_mode": "wal", "page_size": 8192}
    with closing(sqlite3.connect(path)) as plain:
        assert plain.execute("PRAGMA integrity_check").fetchone() == ("ok",)
