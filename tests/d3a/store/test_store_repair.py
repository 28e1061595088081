"""Damage done behind a store's back is found, mended, and not found again."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from d3a.examination import examine, is_beyond
from d3a.store import open_store
from d3a.store.base import Batch, Store, StoreDamaged, StoreError
from tests.worlds import small_home

TAMPERED = {
    "DELETE FROM oic WHERE object_id = 'keys-1'": "removed 3 stays of objects",
    "DELETE FROM stc WHERE object_id = 'cup-1'": "removed 1 sightings of stays",
    "DELETE FROM keyframe WHERE key = 'p2'": "2 sightings no longer name a picture",
    "INSERT INTO oic_name VALUES ('mug', NULL, 'nobody')": "removed 1 taught names",
    "INSERT INTO oic_vote VALUES ('mug', 'nobody')": "removed 1 votes",
    "UPDATE sighting SET end_ms = end_ms + 60000": "raised the bound max_sighting_ms",
    "UPDATE stc SET x = x + 5": "built the indexes",
    "DELETE FROM sighting_tree": "built the indexes",
    "DELETE FROM stc_tree": "built the indexes",
}


@pytest.mark.parametrize("statement", TAMPERED)
def test_a_tampered_file_is_mended(tmp_path: Path, statement: str) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)
        assert store.repair() == []
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute(statement)
    with closing(open_store(str(path))) as store:
        assert store.check() != []
        said = store.repair()
        assert any(sentence.startswith(TAMPERED[statement]) for sentence in said)
        assert store.check() == []
        assert store.repair() == []


def test_a_tampered_server_is_mended(mongo_uri: str) -> None:
    from pymongo import MongoClient

    with closing(open_store(mongo_uri)) as store:
        small_home.fill(store)
        assert store.repair() == []
        with MongoClient[dict[str, object]](mongo_uri) as client:
            database = client.get_default_database()
            database["oic"].delete_one({"_id": "keys-1"})
            database["keyframes"].delete_one({"_id": "p3"})
            database["stc"].update_one({"object_id": "couch-1"}, {"$set": {"n": 7}})
            database["stc"].delete_one({"object_id": "cup-1"})
        assert len(store.check()) == 4
        said = store.repair()
        assert [sentence.split(" ")[0] for sentence in said] == [
            "removed",
            "brought",
            "removed",
            "1",
        ]
        assert store.check() == []
        assert store.repair() == []
        assert {record.object_id for record in store.stays()} == {"bowl-1", "couch-1"}


def test_scrubbed_files_hold_no_byte_of_what_was_removed(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)
        picture = store.keyframe("p1")
        assert picture is not None
        sample = picture.jpeg[-60:]  # what was photographed: tables come before it
        store.apply(Batch(removed_objects=["keys-1"], removed_keyframes=["p1"]))
        assert store.scrub()
        files = b"".join(file.read_bytes() for file in sorted(tmp_path.iterdir()))
        assert b"cup-1" in files
        assert b"keys-1" not in files
        assert sample not in files
        assert store.check() == []


def test_a_reader_that_keeps_the_log_open_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("d3a.store.sqlite.BUSY_TIMEOUT_S", 0.1)
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)
        with closing(sqlite3.connect(path)) as reader:
            reader.execute("BEGIN")
            reader.execute("SELECT count(*) FROM oic").fetchone()
            store.apply(Batch(removed_objects=["keys-1"]))
            with pytest.raises(StoreError, match="another process is reading"):
                store.scrub()
        assert store.scrub()


def test_a_picture_is_not_both_put_and_removed(make_store: Callable[[], Store]) -> None:
    with closing(make_store()) as store:
        small_home.fill(store)
        picture = store.keyframe("p1")
        assert picture is not None
        with pytest.raises(StoreError, match="both put and removed"):
            store.apply(Batch(keyframes=[picture], removed_keyframes=["p1"]))


def test_entries_that_an_index_lacks_are_made_anew(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)

    def edited(*statements: tuple[str, tuple[object, ...]]) -> list[tuple[object, ...]]:
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute("PRAGMA writable_schema = ON")
            return [row for each in statements for row in connection.execute(*each)]

    schema = "sqlite_master WHERE name = 'seen_area_end'"
    (index,) = edited((f"SELECT * FROM {schema}", ()), (f"DELETE FROM {schema}", ()))
    edited(("DELETE FROM seen_area WHERE start_ms = (SELECT min(start_ms) FROM seen_area)", ()))
    edited(("INSERT INTO sqlite_master VALUES (?, ?, ?, ?, ?)", index))
    with closing(open_store(str(path))) as store:
        damage = examine(store)
        assert damage[0].startswith("an index is damaged: ")
        assert not is_beyond(damage)
        assert store.repair() == ["built the indexes and the R*Trees anew"]
        assert examine(store) == []


def overwrite(path: Path, table: str, share: float = 0.5) -> None:
    """Write nonsense over pages of a table, as a dying disk does."""
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        (page,) = connection.execute(
            "SELECT rootpage FROM sqlite_master WHERE name = ?", (table,)
        ).fetchone()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
    content = bytearray(path.read_bytes())
    begin, length = (page - 1) * size, int(size * share)
    content[begin : begin + length] = b"\xa5" * length
    path.write_bytes(content)


@pytest.mark.parametrize("table", ["keyframe", "encounter", "sighting", "oic", "state"])
def test_damaged_pages_are_listed_and_left_alone(tmp_path: Path, table: str) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)
    overwrite(path, table)
    before = path.read_bytes()
    with closing(open_store(str(path))) as store:
        damage = examine(store)
        assert any(table in sentence for sentence in damage)
        assert is_beyond(damage)
        with pytest.raises(StoreDamaged, match="damaged"):
            store.repair()
        assert examine(store)
    assert path.read_bytes() == before


@pytest.mark.parametrize("length", [200, 5000, 20_000])
def test_a_store_cut_short_is_damaged_and_other_files_are_not(tmp_path: Path, length: int) -> None:
    path, notes = tmp_path / "home.db", tmp_path / "notes.db"
    with closing(open_store(str(path))) as store:
        small_home.fill(store)
        store.scrub()
    path.write_bytes(path.read_bytes()[:length])
    notes.write_text("these are my notes\n" * 100)
    with pytest.raises(StoreDamaged, match=r"begins as a store of d3a.*ingest"):
        open_store(str(path), create=False)
    with pytest.raises(StoreError, match="not a store of d3a") as refused:
        open_store(str(notes), create=False)
    assert not isinstance(refused.value, StoreDamaged)
