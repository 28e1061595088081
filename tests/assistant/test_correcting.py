"""Corrections from the command line, and the next question that uses them."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from assistant import config
from assistant.asking import ask
from assistant.cli import main
from assistant.exits import ExitCode
from assistant.told import told_name
from d3a import teaching
from d3a.store import open_store
from d3a.store.base import Batch, Sighting, StayRecord, Store
from tests.worlds.small_home import NOW, fill

Run = Callable[..., Result]


@pytest.fixture
def uri(tmp_path: Path) -> str:
    store = open_store(str(tmp_path / "home.db"))
    fill(store)
    store.close()
    return str(tmp_path / "home.db")


@pytest.fixture
def run(uri: str) -> Run:
    def call(*args: str, status: int = ExitCode.OK) -> Result:
        settings = config.load(lambda: NOW, {}, ())
        result = CliRunner().invoke(main, [*args, "--store", uri], obj=settings)
        assert result.exit_code == status, (result.output, result.stderr)
        return result

    return call


def record(result: Result) -> dict[str, Any]:
    (line,) = result.stdout.splitlines()
    found: dict[str, Any] = json.loads(line)
    assert found["schema"] == 1
    return found


def dumped(uri: str) -> list[dict[str, Any]]:
    store = open_store(uri)
    found = [r for r in store.dump() if r.get("key") not in ("corrections", "said")]
    store.close()
    return found


def test_each_command_says_what_it_did_and_undo_takes_all_of_it_back(
    run: Run, uri: str, tmp_path: Path
) -> None:
    before = dumped(uri)
    merged = record(run("merge", "cup-1", "bowl-1", "--force", "--json"))
    assert (merged["kind"], merged["object_id"], merged["was"]) == ("merge", "cup-1", "bowl-1")
    assert merged["at"] == "2026-03-01T19:00:00-05:00"
    split = record(run("split", "keys-1", "2", "--json"))
    assert (split["place"], split["new_id"], split["changed"]) == (2, "s2", True)
    taught = record(run("teach", "keys-1", "Anna's keys", "--json"))
    assert taught["names"] == [{"word": "key", "owner": "anna"}]
    alone = record(run("teach", "keys-1", "Tom's", "--json"))
    assert alone["said"] == "keys-1 is Tom's key"
    run("undo")
    again = record(run("teach", "keys-1", "keys", "--owner", "Anna", "--json"))
    assert (again["changed"], again["number"]) == (False, None)
    placed = record(run("place", "add", "Study", "--around", "1,3.5", "--radius", "0.5", "--json"))
    assert placed["after"][0]["name"] == "study"
    assert run("place", "rename", "study", "den").stdout == "study is called den\n"
    run("place", "remove", "den")
    (tmp_path / "m.pgm").write_text("P2 2 2 255 0 254 254 254")
    (tmp_path / "m.yaml").write_text(
        "image: m.pgm\nresolution: 4\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    said = run("place", "import", str(tmp_path / "m.yaml")).stdout
    assert said == "m.yaml is the floor plan, 8.0 x 8.0 m in cells of 4 m\n"
    run("place", "add", "corner", "--pixels", "0,2 1,2 1,1")
    corner = json.loads(run("place", "list", "--json").stdout.splitlines()[0])
    assert corner["polygon"] == [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]
    listed = [json.loads(line) for line in run("undo", "--list", "--json").stdout.splitlines()]
    kinds = [each["kind"] for each in listed]
    assert kinds == ["merge", "split", "teach", "place", "place", "place", "map", "place"]
    assert "Anna's key" in run("undo", "--list").stdout
    for kind in reversed(kinds):
        assert record(run("undo", "--json"))["kind"] == kind
    assert dumped(uri) == before
    assert record(run("undo", "--json", status=ExitCode.NOTHING))["error"] == "unknown"
    assert run("undo", "--list", status=ExitCode.NOTHING).stdout == ""


def test_what_speaks_against_a_merge_is_told_and_does_not_stop_it(run: Run, uri: str) -> None:
    against = "cup-1 was never called bowl, nor bowl-1 cup"
    assert record(run("merge", "cup-1", "bowl-1", "--force", "--json"))["doubts"] == [against]
    run("undo")
    said = run("merge", "cup-1", "bowl-1", "--force")
    assert said.stdout == "bowl-1 is the same thing as cup-1\n"
    assert said.stderr == f"note: {against}\nd3a undo takes it back.\n"
    assert "note" not in run("undo").stderr
    for after_ms, doubts in ((0, ["both were seen at one time, 5.1 m apart"]), (60_000, [])):
        with contextlib.closing(open_store(uri)) as store:
            store.apply(far_off(store, "cup-1", "cup-9", after_ms))
        assert record(run("merge", "cup-1", "cup-9", "--json"))["doubts"] == doubts
        run("undo")


def far_off(store: Store, like: str, name: str, after_ms: int) -> Batch:
    """Another thing like one, seen so long after that one, in another corner."""
    (twin,) = store.objects(ids=[like])
    (stay,) = store.stays(object_ids=[like])
    at = stay.last_ms + after_ms
    other = replace(twin, object_id=name, names=(), first_ms=at, last_ms=at)
    place = StayRecord(name, 0, (1.0, 1.0, 0.7), at, at, 1.0, stay.site, seen=1)
    seen = Sighting(name, 0, at, at, "far", 0.9, (0.0, 0.0, 1.0, 1.0), None)
    return Batch(
        objects=[other], stays=[place], sightings=[seen],
        removed_objects=[name] if store.objects(ids=[name]) else [],
    )  # fmt: skip


def test_a_place_is_another_thing_from_a_time_on(run: Run, uri: str) -> None:
    hours_ms = 3 * 3_600_000
    with contextlib.closing(open_store(uri)) as store:
        (stay,) = store.stays(object_ids=["cup-1"])
        (seen,) = store.sightings(object_ids=["cup-1"])
        again = seen.start_ms + hours_ms
        later = replace(seen, start_ms=again, end_ms=again, frame="later")
        grown = replace(stay, last_ms=again, seen=stay.seen + later.seen)
        store.apply(Batch(stays=[grown], sightings=[later]))
    before = dumped(uri)
    split = record(run("split", "cup-1", "3", "--from", "noon today", "--json"))
    assert (split["new_id"], split["since"]) == ("s1", "2026-03-01T12:00:00-05:00")
    assert split["said"] == "cup-1 at place 3 is another thing since 2026-03-01 12:00-05:00, s1"
    with contextlib.closing(open_store(uri)) as store:
        spans = {s.key: (s.first_ms, s.last_ms, s.last_absent_ms) for s in store.stays()}
        assert store.check() == []
    assert spans["cup-1", 3] == (seen.start_ms, seen.end_ms, again)
    assert spans["s1", 0] == (again, again, None)
    run("undo")
    assert dumped(uri) == before


@pytest.mark.parametrize(
    ("args", "status", "said"),
    [
        (("merge", "cup-1", "cup-2"), ExitCode.NOTHING, "The nearest are cup-1"),
        (("merge", "cup", "keys-1"), ExitCode.NOTHING, "The nearest are cup-1"),
        (("split", "keys-1", "9"), ExitCode.NOTHING, "it has 0, 1, 2"),
        (("split", "cup-1", "3"), ExitCode.USAGE, "one place only"),
        (
            ("split", "cup-1", "3", "--from", "noon"),
            ExitCode.USAGE,
            "there is nothing to split",
        ),
        (("split", "cup-1", "3", "--from", "once"), ExitCode.USAGE, "is not a time"),
        (("merge", "bowl-1", "cup-1"), ExitCode.USAGE, "frame 000003 shows both"),
        (("teach", "nobody", "Bob"), ExitCode.NOTHING, "no object 'nobody'"),
        (("teach", "cup-1", "mug", "--remove"), ExitCode.NOTHING, "it has no name"),
        (("place", "remove", "kitchn"), ExitCode.NOTHING, "There are kitchen"),
        (("place", "add", "x", "--polygon", "0,0 1"), ExitCode.USAGE, "is no corner"),
        (("place", "add", "x"), ExitCode.USAGE, "say one of --polygon"),
        (("place", "add", "kitchen", "--here"), ExitCode.USAGE, "already"),
        (("place", "add", "x", "--pixels", "0,0 1,0 1,1"), ExitCode.USAGE, "import"),
        (("place", "import", "none.yaml"), ExitCode.USAGE, "cannot be read"),
    ],
)
def test_what_cannot_be_done_says_why_and_changes_nothing(
    run: Run, uri: str, args: tuple[str, ...], status: ExitCode, said: str
) -> None:
    before = dumped(uri)
    result = run(*args, status=status)
    assert said in result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert dumped(uri) == before


def test_a_failure_is_a_record_where_json_is_asked_for(run: Run) -> None:
    failed = record(run("merge", "cup-1", "cap-1", "--json", status=ExitCode.NOTHING))
    assert failed["error"] == "unknown"
    assert failed["suggestions"][0] == "cup-1"
    refused = record(run("split", "cup-1", "3", "--json", status=ExitCode.USAGE))
    assert refused["error"] == "refused"


def test_a_store_that_is_not_there_is_not_made(tmp_path: Path) -> None:
    settings = config.load(lambda: NOW, {}, ())
    args = ["merge", "a", "b", "--store", str(tmp_path / "none.db")]
    result = CliRunner().invoke(main, args, obj=settings)
    assert result.exit_code == ExitCode.STORE
    assert not (tmp_path / "none.db").exists()


@pytest.mark.parametrize(
    ("said", "name"),
    [
        ("my keys", ("key", "me")),
        ("Anna's car keys", ("car key", "anna")),
        ("the lucky mug", ("lucky mug", None)),
        ("Excalibur", ("excalibur", None)),
        ("dad's blue bowl", ("blue bowl", "dad")),
        ("what?", ("what?", None)),
    ],
)
def test_a_name_is_read_as_the_question_will_be(said: str, name: tuple[str, str | None]) -> None:
    assert told_name(said, datetime(2026, 1, 1, tzinfo=UTC)) == name


def test_the_next_question_uses_what_was_said_in_every_store(
    make_store: Callable[[], Store],
) -> None:
    store = make_store()
    fill(store)

    def found(text: str) -> set[str]:
        return {each.object_id for each in ask(store, text, now=NOW).keyframes}

    assert ask(store, "Where is Excalibur?", now=NOW).status == "unknown_object"
    teaching.teach_name(store, "bowl-1", "excalibur")
    assert found("Where is Excalibur?") == {"bowl-1"}
    teaching.teach_name(store, "cup-1", *told_name("my mug", NOW))
    assert found("Where is my mug?") == {"cup-1"}
    assert found("Did you see a cup in the study?") == {"cup-1"}  # no such place: not judged
    teaching.name_place(store, "study", around=(2.0, 1.0), radius_m=1.0)
    assert ask(store, "Did you see a cup in the study?", now=NOW).reason == "not_there"
    assert found("Did you see the couch in the study?") == {"couch-1"}
    teaching.rename_place(store, "study", "snug")
    assert found("Did you see the couch in the snug?") == {"couch-1"}
    teaching.split(store, "keys-1", 1)
    assert ask(store, "How many keys did you see?", now=NOW).count == 2
    assert found("Did you see keys in the hall?") == {"s5"}
    teaching.merge(store, "keys-1", "s5")
    assert ask(store, "How many keys did you see?", now=NOW).count == 1
    for _ in teaching.history(store):
        teaching.undo(store)
    assert ask(store, "Where is Excalibur?", now=NOW).status == "unknown_object"
    assert ask(store, "Did you see the couch in the snug?", now=NOW).unjudged
    store.close()
