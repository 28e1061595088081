"""Addresses, files and servers that cannot be a store, and what is said of them."""

from __future__ import annotations

import os
import socket
import sqlite3
import stat
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path

import pytest

from d3a.store import mask, open_store
from d3a.store.base import (
    Batch,
    Encounter,
    ObjectRecord,
    StayRecord,
    StoreError,
    StoreUnreachable,
)
from d3a.store.mongo_server import check_version, open_mongo
from d3a.store.schema import APPLICATION_ID
from d3a.store.sqlite_file import MIGRATIONS, open_sqlite


@pytest.mark.parametrize("form", ["{}", "sqlite:///{}"])
def test_a_file_is_named_by_its_path_or_address(tmp_path: Path, form: str) -> None:
    path = tmp_path / "new folder" / "home #1 50%.db"
    with closing(open_store(form.format(path))) as store:
        store.apply(Batch(meta={"zone": "UTC"}))
        assert store.uri == f"sqlite:///{path}"
    with closing(open_store(str(path), create=False)) as store:
        assert store.meta("zone") == "UTC"
    assert path.is_file()


def test_a_relative_address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    open_store("sqlite:///home.db").close()
    assert (tmp_path / "home.db").is_file()


def test_the_file_is_its_owners_alone(tmp_path: Path) -> None:
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        store.apply(Batch(meta={"zone": "UTC"}))
        modes = {f.name: stat.S_IMODE(f.stat().st_mode) for f in tmp_path.iterdir()}
    assert modes == dict.fromkeys(["home.db", "home.db-wal", "home.db-shm"], 0o600)


@pytest.mark.parametrize(
    ("uri", "said"),
    [
        ("", "names no file"),
        ("sqlite:///:memory:", "names no file"),
        ("sqlite://home.db", "sqlite:///relative.db"),
        ("postgres://u:secret@h/db", "no store is known by postgres://"),
        ("a\0b", "NUL"),
    ],
)
def test_an_address_that_is_none(uri: str, said: str) -> None:
    with pytest.raises(StoreError, match=said) as refused:
        open_store(uri)
    assert "secret" not in str(refused.value)


def test_a_missing_file_is_not_made_when_it_must_exist(tmp_path: Path) -> None:
    for options in ({"create": False}, {"read_only": True}):
        with pytest.raises(StoreUnreachable, match="does not exist"):
            open_store(str(tmp_path / "none.db"), **options)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_and_a_file_in_a_file_are_no_stores(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("text")
    with pytest.raises(StoreUnreachable, match="is a folder"):
        open_store(str(tmp_path))
    with pytest.raises(StoreUnreachable, match="cannot be made"):
        open_store(str(tmp_path / "file" / "home.db"))
    with pytest.raises(StoreUnreachable, match="cannot be made"):
        open_store("/proc/self/home.db")


def test_a_file_of_another_program_is_left_as_it_is(tmp_path: Path) -> None:
    text, other = tmp_path / "notes.db", tmp_path / "other.db"
    text.write_text("these are my notes\n" * 100)
    with closing(sqlite3.connect(other)) as connection:
        connection.execute("CREATE TABLE theirs (x)")
    for path, said in ((text, "not a store of d3a"), (other, "another program")):
        before = path.read_bytes()
        for read_only in (False, True):
            with pytest.raises(StoreError, match=said):
                open_store(str(path), read_only=read_only)
        assert path.read_bytes() == before


def test_a_newer_schema_is_refused_and_an_older_one_migrated(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        store.apply(Batch([ObjectRecord("a", "cup", 1.0, 0, 0)]))

    def add_table(connection: sqlite3.Connection) -> None:
        connection.execute("CREATE TABLE added (x)")

    def fail(connection: sqlite3.Connection) -> None:
        connection.execute("CREATE TABLE half (x)")
        raise sqlite3.OperationalError("the disk is full")

    with pytest.raises(StoreUnreachable, match="disk is full"):
        open_sqlite(path, migrations=(*MIGRATIONS, add_table, fail))
    with pytest.raises(StoreError, match="old schema 3"):
        open_sqlite(path, read_only=True, migrations=(*MIGRATIONS, add_table))
    with closing(open_sqlite(path, migrations=(*MIGRATIONS, add_table))) as store:
        assert [record.object_id for record in store.objects()] == ["a"]
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (4,)
        assert connection.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)
        names = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
    assert "added" in names
    assert "half" not in names
    for read_only in (False, True):
        with pytest.raises(StoreError, match=r"schema 4.*update d3a"):
            open_store(str(path), read_only=read_only)


def test_a_file_of_schema_1_gets_the_index_of_votes(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    votes = (("cup", 7.0), ("bowl", 3.0))
    with closing(open_store(str(path))) as store:
        store.apply(Batch([ObjectRecord("a", "cup", 1.0, 0, 0, categories=votes)]))
    with closing(sqlite3.connect(path)) as connection:  # as the first release made it
        connection.execute("DROP TABLE oic_vote")
        connection.execute("ALTER TABLE encounter DROP COLUMN apart")
        connection.execute("PRAGMA user_version = 1")
        connection.commit()
    with closing(open_store(str(path))) as store:
        assert [o.object_id for o in store.objects(categories=["bowl"], votes=True)] == ["a"]
        store.apply(Batch(removed_objects=["a"]))
        assert store.check() == []


def test_encounters_of_schema_2_are_read_without_what_they_did_not_measure(tmp_path: Path) -> None:
    path, box = tmp_path / "home.db", (0.0, 0.0, 1.0, 1.0)
    old, new = (
        Encounter("a", "b", 0, 0, start, start, "f", box, box, 0.5, apart=apart)
        for start, apart in ((1, None), (2, (0.1, 0.2, 0.3, 0.05)))
    )
    with closing(open_store(str(path))) as store:
        store.apply(
            Batch(
                [ObjectRecord(name, "cup", 1.0, 0, 9) for name in "ab"],
                [StayRecord(name, 0, None, 0, 9, 1.0) for name in "ab"],
                encounters=[old],
            )
        )
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("ALTER TABLE encounter DROP COLUMN apart")
        connection.execute("PRAGMA user_version = 2")
        connection.commit()
    with closing(open_store(str(path))) as store:
        store.apply(Batch(encounters=[new]))
        assert store.encounters() == [old, new]


def test_two_processes_may_make_one_store(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    failures: list[BaseException] = []

    def make(name: str) -> None:
        try:
            with closing(open_store(str(path))) as store:
                store.apply(Batch([ObjectRecord(name, "cup", 1.0, 0, 0)]))
        except StoreError as error:
            failures.append(error)

    threads = [threading.Thread(target=make, args=(f"o{n}",)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    with closing(open_store(str(path))) as store:
        assert len(store.objects()) == 4


@pytest.mark.parametrize("options", [{"read_only": True}, {"create": False}, {}])
def test_a_store_on_a_read_only_medium_can_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: dict[str, bool]
) -> None:
    """Its folder takes no log: then the file cannot be changing either. Whoever writes is told."""
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        store.apply(Batch([ObjectRecord("a", "cup", 1.0, 0, 0)]))
    monkeypatch.setattr(os, "access", lambda *_: False)
    with closing(open_store(str(path), **options)) as store:
        assert [record.object_id for record in store.objects()] == ["a"]
        assert len(list(store.dump())) == 1
        with pytest.raises(StoreError, match=r"can be read here and not changed .* d3a store copy"):
            store.apply(Batch(meta={"zone": "UTC"}))
        assert [file.name for file in tmp_path.iterdir()] == ["home.db"]


def test_a_full_disk_is_told_with_what_would_do(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_sqlite(path)) as store:
        store.apply(Batch([ObjectRecord("a", "cup", 1.0, 0, 0)]))
        store._db.execute("PRAGMA max_page_count = 1")  # as few as it has: no more fit
        many = [ObjectRecord(f"b{n}", "cup", 1.0, 0, 0) for n in range(2000)]
        with pytest.raises(StoreError, match="is full: make room and say the same again"):
            store.apply(Batch(many))
        assert [record.object_id for record in store.objects()] == ["a"]


def test_threads_share_a_store(tmp_path: Path) -> None:
    failures: list[BaseException] = []
    with closing(open_store(str(tmp_path / "home.db"))) as store:

        def work(name: str) -> None:
            try:
                for number in range(10):
                    store.apply(Batch([ObjectRecord(f"{name}{number}", "cup", 1.0, 0, 0)]))
                    assert store.objects(ids=[f"{name}{number}"])
            except (StoreError, AssertionError) as error:
                failures.append(error)

        threads = [threading.Thread(target=work, args=(name,)) for name in "abcd"]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert failures == []
        assert store.categories() == [("cup", 40)]


def test_a_damaged_file_is_told(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        store.apply(Batch([ObjectRecord(f"o{n}", "cup", 1.0, 0, 0) for n in range(500)]))
    damaged = bytearray(path.read_bytes())
    damaged[8192:] = b"\xff" * (len(damaged) - 8192)
    path.write_bytes(damaged)
    with pytest.raises(StoreError, match=r"home\.db"):
        open_store(str(path)).objects()


def test_what_other_hands_did_to_a_file_is_found(tmp_path: Path) -> None:
    path = tmp_path / "home.db"
    with closing(open_store(str(path))) as store:
        store.apply(Batch([ObjectRecord("a", "cup", 1.0, 0, 0)]))
        assert store.check() == []
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(
            "INSERT INTO stc_tree VALUES (7, 0, 1, 0, 1); INSERT INTO stc (object_id, place, x, y, "
            "first_ms, last_ms, weight, site, seen, tentative, volatile) "
            "VALUES ('gone', 0, 1.0, 1.0, 0, 0, 1.0, '', 1, 0, 0)"
        )
    with closing(open_store(str(path))) as store:
        said = " ".join(store.check())
    assert "gone at 0 of an object that is not stored" in said
    assert "the R*Tree holds stay 7" in said
    assert "stay gone at 0 is not where the R*Tree has it" in said


@pytest.mark.parametrize(
    ("uri", "shown"),
    [
        ("mongodb://anna:p%40ss@host:27017/d3a", "mongodb://anna:***@host:27017/d3a"),
        ("mongodb://anna:p@ss@host/d3a", "mongodb://anna:***@host/d3a"),
        ("mongodb://anna:p/ss@host/d3a", "mongodb://anna:***@host/d3a"),
        ("mongodb+srv://anna:secret@host", "mongodb+srv://anna:***@host"),
        ("mongodb://host/d3a?w=1", "mongodb://host/d3a?w=1"),
        ("mongodb://anna:secret", "mongodb://anna:***"),  # the host was forgotten
        ("mongodb://anna:se:cret/d3a", "mongodb://anna:***/d3a"),
        ("mongodb://a:27017,b:27018/d3a", "mongodb://a:27017,b:27018/d3a"),
        ("mongodb://[fe80::1]:27017/d3a", "mongodb://[fe80::1]:27017/d3a"),
        (
            "mongodb://h/?tlsCertificateKeyFilePassword=x&authMechanismProperties=AWS_SESSION_TOKEN:y",
            "mongodb://h/?tlsCertificateKeyFilePassword=***&authMechanismProperties=***",
        ),
        ("home.db", "home.db"),
        ("sqlite:///a@b.db", "sqlite:///a@b.db"),
    ],
)
def test_passwords_are_never_shown(uri: str, shown: str) -> None:
    assert mask(uri) == shown


def test_an_unreachable_server_is_told_without_its_password() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    uri = f"mongodb://anna:hunter2@127.0.0.1:{port}/d3a?serverSelectionTimeoutMS=300"
    with pytest.raises(StoreUnreachable, match="no MongoDB server answers") as refused:
        open_store(uri)
    text = f"{refused.value}"
    assert "hunter2" not in text
    assert "anna:***@127.0.0.1" in text
    assert len(text) < 300


@pytest.mark.parametrize("uri", ["mongodb://", "mongodb://host:port/", "mongodb://a:b:c@h/d"])
def test_an_address_pymongo_cannot_read(uri: str) -> None:
    with pytest.raises(StoreUnreachable, match="cannot be used"):
        open_store(uri)


def test_a_server_without_the_stable_api_is_refused() -> None:
    check_version({"maxWireVersion": 13})
    with pytest.raises(StoreError, match=r"older than MongoDB 5\.0"):
        check_version({"maxWireVersion": 9})
    with pytest.raises(StoreError, match=r"older than MongoDB 5\.0"):
        check_version({})


def test_a_database_of_another_program_or_a_newer_schema_is_refused(mongo_uri: str) -> None:
    with pytest.raises(StoreUnreachable, match="holds no store"):
        open_store(mongo_uri, create=False)
    with closing(open_mongo(mongo_uri, "shown")) as store:
        store._db["meta"].update_one({"_id": "d3a:schema"}, {"$set": {"value": 99}})
        with pytest.raises(StoreError, match="shown: it has schema 99"):
            open_mongo(mongo_uri, "shown")
        store._db["meta"].delete_many({})
        store._db["oic"].insert_one({"theirs": 1})
        with pytest.raises(StoreError, match=r"collections .*oic.* of another program"):
            open_mongo(mongo_uri, "shown")
        assert store._db["meta"].count_documents({}) == 0


def test_a_file_store_loads_no_driver(tmp_path: Path) -> None:
    code = (
        "import sys; from d3a.store import open_store; open_store(sys.argv[1]).objects(); "
        "print(sorted({'pymongo', 'cv2', 'sklearn', 'textual', 'scipy', 'PIL'} & set(sys.modules)))"
    )
    run = [sys.executable, "-c", code, str(tmp_path / "home.db")]
    done = subprocess.run(run, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
