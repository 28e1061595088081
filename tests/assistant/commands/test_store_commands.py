"""`d3a forget`, `d3a store` and `d3a export`: what they print where, and with which status."""

from __future__ import annotations

import csv
import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from assistant.cli import main
from assistant.commands import forget
from d3a.store import open_store
from d3a.store.base import Batch, Store, StoreBusy, StoreError
from tests.worlds import small_home

Run = Callable[..., Result]
NOW = small_home.NOW.isoformat()
HOME = ("--store", "home.db", "--now", NOW)


@pytest.fixture
def run(own_settings: Path) -> Run:
    """Run `d3a` in a folder with the small home as `home.db`, with settings of its own."""
    with closing(open_store("home.db")) as store:
        small_home.fill(store)
    return lambda *args, **options: CliRunner().invoke(main, list(args), **options)


def told(result: Result) -> Any:
    (line,) = result.stdout.splitlines()
    record = json.loads(line)
    assert record["schema"] == 1
    return record


def ids(path: str = "home.db") -> list[str]:
    with closing(open_store(path)) as store:
        return [record.object_id for record in store.objects()]


def test_a_dry_run_tells_exactly_what_then_goes(run: Run) -> None:
    dry = told(run("forget", "the", "cup", *HOME, "--dry-run", "--json"))
    assert (dry["dry_run"], dry["objects"], dry["keyframes"]) == (True, 1, 1)
    assert len(ids()) == 4
    done = told(run("forget", "the", "cup", *HOME, "--yes", "--json"))
    assert done == {**dry, "dry_run": False, "scrubbed": True}
    assert "cup-1" not in ids()
    assert b"cup-1" not in Path("home.db").read_bytes()
    again = run("forget", "cup-1", *HOME, "--yes")
    assert again.exit_code == 1
    assert "nothing in the store is 'cup-1'" in again.stderr


@pytest.mark.parametrize(
    ("asked", "gone"),
    [
        (("keys",), ["keys-1"]),
        (("keys-1",), ["keys-1"]),
        (("--place", "kitchen"), ["bowl-1", "cup-1"]),
        (("--place", "Lab"), ["couch-1"]),
        (("--before", "today"), ["couch-1"]),
        (("--after", "2026-03-01T09:30-05:00"), ["bowl-1", "cup-1"]),
        (("--between", "2026-02-28T22:00", "2026-02-28T23:30"), ["couch-1"]),
        (("bowl", "--before", "2026-03-01T10:00"), ["bowl-1"]),
    ],
)
def test_things_places_and_times_are_meant_as_said(
    run: Run, asked: tuple[str, ...], gone: list[str]
) -> None:
    result = run("forget", *asked, *HOME, "--yes")
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("This is forgotten:\n")
    assert sorted({"bowl-1", "couch-1", "cup-1", "keys-1"} - set(ids())) == gone


@pytest.mark.parametrize(
    ("asked", "status", "said"),
    [
        ((), 2, "nothing says what to forget"),
        (("--place", "attic"), 1, "there are: hall, kitchen, lab"),
        (("umbrella",), 1, "nothing in the store is 'umbrella'"),
        (("why is it so",), 1, "is no id and no description"),
        (("--before", "soonish"), 2, "'soonish' is not a time"),
        (("cup", "--retain", "3d"), 2, "--retain is for the whole memory"),
        (("--between", "a", "b", "--after", "c"), 2, "--between says both ends"),
        (("--retain", "long"), 2, "12h, 30d, 8w or 1y would do"),
        (("cup",), 2, "look with --dry-run, then say --yes"),
        (("--people", "--yes"), 1, "home.db (from --store)"),
    ],
)
def test_what_cannot_be_done_says_what_would(
    run: Run, asked: tuple[str, ...], status: int, said: str
) -> None:
    result = run("forget", *asked, *HOME)
    assert (result.exit_code, said in result.stderr) == (status, True), result.output
    assert len(ids()) == 4


def test_a_person_at_a_terminal_is_asked(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forget, "is_terminal", lambda _: True)
    refused = run("forget", "cup", *HOME, input="n\n")
    assert refused.exit_code == 130
    assert "Forget this in home.db (from --store)?" in refused.stderr
    assert "Nothing was forgotten." in refused.stderr
    assert len(ids()) == 4
    assert run("forget", "cup", *HOME, input="y\n").exit_code == 0
    assert len(ids()) == 3


def test_a_no_after_forgetting_does_not_say_never_without_a_word(run: Run) -> None:
    before = run("ask", "Did you see the cup?", *HOME)
    assert before.exit_code == 0
    assert run("forget", "cup", *HOME, "--yes").exit_code == 0
    after = run("ask", "Did you see the cup?", *HOME)
    assert after.exit_code == 1
    assert after.stdout.startswith("As far as I still remember, I never saw")
    assert "I was asked to forget some things" in after.stdout
    assert "forget" not in run("ask", "Where are the keys?", *HOME).stdout
    assert run("forget", "--before", "2030-01-01", *HOME, "--yes").exit_code == 0
    empty = run("ask", "Did you see the cup?", *HOME)
    assert empty.stdout.startswith("My memory is empty: I was asked to forget what was in it.")


def test_retention_is_set_told_and_ended(run: Run) -> None:
    result = run("forget", "--retain", "1d", *HOME, "--yes")
    assert result.exit_code == 0
    assert result.stdout.startswith("The store keeps what is not older than 1d.\n")
    assert told(run("store", "info", *HOME, "--json"))["retain_seconds"] == 86_400
    with closing(open_store("home.db")) as store:
        oldest = small_home.ms(small_home.NOW - timedelta(days=1, minutes=8))
        assert not store.sightings(end_ms=oldest - 1)
    assert "keeps       the last 1 days" in run("store", "info", *HOME).stdout
    assert run("forget", "--retain", "off", *HOME).exit_code == 0
    assert told(run("store", "info", *HOME, "--json"))["retain_seconds"] is None


def test_a_store_is_copied_to_a_server_and_back(
    run: Run, new_database: Callable[[str], str]
) -> None:
    uri = new_database("double")
    there = run("store", "copy", "home.db", uri)
    assert there.exit_code == 0, there.output
    assert there.stdout.splitlines()[0] == f"{uri} is equal to home.db:"
    back = told(run("store", "copy", uri, "again.db", "--json"))
    assert (back["equal"], back["holds"]["sightings"]) == (True, 6)
    with closing(open_store("home.db")) as one, closing(open_store("again.db")) as other:
        assert list(one.dump()) == list(other.dump())
    assert run("forget", "keys", "--store", uri, "--now", NOW, "--yes").exit_code == 0
    info = told(run("store", "info", "--store", uri, "--json"))
    assert info["forgotten"]
    assert "keys" not in info["categories"]


def test_a_copy_is_never_laid_over_something_or_made_of_nothing(run: Run) -> None:
    assert run("store", "copy", "home.db", "new.db").exit_code == 0
    full = run("store", "copy", "home.db", "new.db")
    assert full.exit_code == 3
    assert "is not empty; copy into a new store" in full.stderr
    missing = run("store", "copy", "none.db", "other.db")
    assert (missing.exit_code, missing.stdout) == (3, "")
    assert "none.db does not exist" in missing.stderr
    assert not Path("other.db").exists()


def test_damage_is_told_and_mended(run: Run) -> None:
    sound = run("store", "check", *HOME)
    assert (sound.exit_code, sound.stdout) == (0, "The store is sound.\n")
    with closing(sqlite3.connect("home.db")) as connection, connection:
        connection.execute("DELETE FROM oic WHERE object_id = 'keys-1'")
    damaged = run("store", "check", *HOME)
    assert damaged.exit_code == 1
    assert damaged.stdout.startswith("damage: stay keys-1 at 0")
    assert "--repair mends what it can" in damaged.stderr
    mended = told(run("store", "check", "--repair", *HOME, "--json"))
    assert mended["sound"]
    assert mended["mended"][0].startswith("removed 3 stays")
    with closing(open_store("home.db")) as store:
        store.apply(Batch(meta={"zone": "Mars/Base"}))
    still = run("store", "check", "--repair", *HOME)
    assert still.exit_code == 1
    assert "d3a store copy" in still.stderr
    assert run("store", "check", "--store", "none.db").exit_code == 3


def test_a_damaged_file_is_listed_with_what_would_do(run: Run) -> None:
    assert run("store", "copy", "home.db", "cut.db").exit_code == 0
    with closing(sqlite3.connect("home.db")) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        query = "SELECT rootpage FROM sqlite_master WHERE name = 'keyframe'"
        (page,) = connection.execute(query).fetchone()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
    with Path("home.db").open("r+b") as file:
        file.seek((page - 1) * size)
        file.write(b"\xa5" * (size // 2))
    with closing(sqlite3.connect("cut.db")) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    cut = Path("cut.db").read_bytes()
    Path("cut.db").write_bytes(cut[: len(cut) // 3])
    for options in ((), ("--repair",)):
        damaged = run("store", "check", *HOME, *options)
        assert damaged.exit_code == 1
        assert "damage: the file is damaged: table keyframe" in damaged.stdout
        assert "pages cannot be mended; d3a store copy makes a sound one" in damaged.stderr
        assert "ingest anew" in damaged.stderr
        assert "--repair" not in damaged.stderr
    short = run("store", "check", "--store", "cut.db")
    assert short.exit_code == 1
    assert "begins as a store of d3a, and is damaged" in short.stdout
    copied = run("store", "copy", "home.db", "copied.db")
    assert copied.exit_code == 3
    assert "ingest anew" in copied.stderr


def test_info_tells_a_person(run: Run) -> None:
    lines = run("store", "info", *HOME).stdout.splitlines()
    assert lines[0].startswith("store       sqlite:///home.db, schema")
    assert "zone        America/New_York" in lines
    assert "sightings   6" in lines


def test_exports_are_written_once(run: Run) -> None:
    coco = told(run("export", "coco", "--format", "coco", *HOME, "--json"))
    assert (coco["format"], coco["pictures"]) == ("coco", 3)
    assert len(list(Path("coco/images").iterdir())) == 3
    again = run("export", "coco", "--format", "coco", *HOME)
    assert again.exit_code == 2
    assert "coco is there already; name a new one" in again.stderr
    rows = run("export", "home.csv", "--format", "csv", "--what", "keys", "--what", "cup-1", *HOME)
    assert rows.stdout == "home.csv: 2 objects, 4 places, 4 intervals, 0 pictures\n"
    with Path("home.csv").open(encoding="utf-8", newline="") as file:
        assert {row["category"] for row in csv.DictReader(file)} == {"cup", "keys"}
    assert run("export", "x", "--format", "csv", "--what", "umbrella", *HOME).exit_code == 1
    assert run("export", "coco/annotations.json/x", "--format", "csv", *HOME).exit_code == 2
    assert run("export", "back", "--format", "recording", *HOME).exit_code == 0
    filled = run("ingest", "back", "--store", "back.db")
    assert filled.exit_code == 0, filled.output
    assert "detections  5\n" in filled.stdout
    assert "1 x time runs backwards or stands still" in filled.stdout, "cup and bowl at one moment"


def test_what_fails_half_way_says_what_to_do(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def busy(store: Store, plan: object) -> None:
        raise StoreBusy(f"{store.uri}: another process has been writing for 10 s; try again")

    monkeypatch.setattr("d3a.correcting.forgetting.forget", busy)
    result = run("forget", "cup", *HOME, "--yes")
    assert result.exit_code == 3
    assert "another process has been writing for 10 s; try again" in result.stderr

    def torn(source: Store, target: Store) -> None:
        raise StoreError(f"{target.uri} is not equal to {source.uri}")

    monkeypatch.setattr("d3a.store.copy._verify", torn)
    result = run("store", "copy", "home.db", "torn.db")
    assert result.exit_code == 3
    assert "torn.db is not whole: delete it, and copy again" in result.stderr
