"""The command line on a small recording: what it prints where, and with which status."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from PIL import Image, ImageDraw

from assistant.cli import COMMANDS, main
from assistant.commands.config import SAMPLE
from assistant.config import Settings
from d3a.answer import Answer
from d3a.store import open_store
from d3a.store.base import Batch, ObjectRecord, Sighting, StayRecord
from tests.worlds import small_home

NOW = "2026-03-01T19:00:00-05:00"
Run = Callable[..., Result]


def picture(path: Path, hue: tuple[int, int, int]) -> None:
    image = Image.new("RGB", (320, 240), (90, 90, 90))
    ImageDraw.Draw(image).rectangle((100, 100, 160, 150), fill=hue)
    image.save(path, quality=92)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of ten frames: keys on the left, an orange bowl on the right, one broken line."""
    folder = tmp_path_factory.mktemp("recording")
    (folder / "images").mkdir()
    facts = {"schema": 1, "recording": "small", "site": "lab", "zone": "America/New_York"}
    facts |= {"camera": None, "embedding": None, "map": None}
    (folder / "recording.json").write_text(json.dumps(facts))
    frames, detections = [], []
    for i in range(10):
        name = f"{i:03d}"
        hue = (240, 130, 20) if i >= 5 else (30, 60, 200)
        picture(folder / "images" / f"{name}.jpg", hue)
        at = f"2026-03-01T09:00:{i:02d}-05:00"
        frames.append(
            {
                "frame": name,
                "time": at,
                "pose": [0, 0, 1, 0, 0, 0, 1],
                "image": f"images/{name}.jpg",
            }
        )
        detections.append(
            {
                "frame": name,
                "category": "bowl" if i >= 5 else "keys",
                "probability": 0.9,
                "box": [100, 100, 160, 150],
                "position": [3.0, 1.0, 0.5] if i >= 5 else [1.0, 1.0, 0.5],
            }
        )
    lines = [json.dumps(frame) for frame in frames]
    (folder / "frames.jsonl").write_text("\n".join(lines) + "\n")
    lines = [json.dumps(detection) for detection in detections]
    (folder / "detections.jsonl").write_text("\n".join([*lines, '{"frame": "00']) + "\n")
    return folder


@pytest.fixture(scope="module")
def filled(recording: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    """The store that `d3a ingest` made of it."""
    uri = f"sqlite:///{tmp_path_factory.mktemp('store') / 'small.db'}"
    result = CliRunner().invoke(main, ["ingest", str(recording), "--store", uri])
    assert result.exit_code == 0, result.output
    return uri


def records(result: Result) -> list[Any]:
    return [json.loads(line) for line in result.stdout.splitlines()]


def test_each_summary_is_the_first_line_of_its_help() -> None:
    context = main.make_context("d3a", ["parse"], resilient_parsing=True)
    for name, summary in COMMANDS.items():
        command = main.get_command(context, name)
        assert command is not None
        assert command.name == name
        assert (command.help or "").strip()
        assert len(summary) < 70


def test_ingest_says_what_went_in_and_what_was_left_out(run: Run, recording: Path) -> None:
    result = run("ingest", str(recording), "--store", "new.db")
    assert result.exit_code == 0
    assert "frames      10\n" in result.stdout
    assert "detections  10\n" in result.stdout
    assert "objects     2\n" in result.stdout
    assert "skipped     1\n" in result.stdout
    assert "detections.jsonl" in result.stdout  # the broken line is named
    assert "100 %, 10 frames" in result.stderr
    assert "new.db (from --store)" in result.stderr
    again = run("ingest", str(recording), "--store", "new.db", "-q")
    assert again.exit_code == 0
    assert again.stdout.startswith("Nothing new")
    assert again.stderr == ""


def test_ingest_refuses_what_it_cannot_read(run: Run, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    result = run("ingest", "empty", "--store", "new.db")
    assert result.exit_code == 2
    assert "empty" in result.stderr
    assert result.stdout == ""
    assert not (tmp_path / "new.db").exists()
    assert run("ingest", "nowhere", "--store", "new.db").exit_code == 2
    result = run("ingest", "empty", "--profile", "papre")
    assert result.exit_code == 2
    assert "default, paper" in result.stderr


def test_ask_prints_a_sentence_and_a_table(run: Run, filled: str) -> None:
    result = run("ask", "Where are the keys?", "--store", filled, "--now", NOW)
    assert result.exit_code == 0, result.output
    sentence, blank, header, row, *_ = result.stdout.splitlines()
    assert sentence
    assert blank == ""
    assert header.split()[:2] == ["#", "what"]
    assert row.split()[:4] == ["1", "keys", "9:00", "today"]
    assert result.stderr == ""


def test_ask_takes_the_question_without_quotes_and_options_before_it(run: Run, filled: str) -> None:
    quoted = run("ask", "where are the keys", "--store", filled, "--now", NOW, "--json")
    bare = run("--store", filled, "--now", NOW, "ask", "--json", "where", "are", "the", "keys")
    first, second = (records(result)[0] for result in (quoted, bare))
    assert first["keyframes"] == second["keyframes"]
    assert first["schema"] == 1
    assert first["status"] == "found"


def test_the_environment_names_the_store_and_a_flag_overrules_it(
    run: Run, filled: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("D3A_STORE", filled)
    assert run("ask", "where are the keys", "--now", NOW).exit_code == 0
    result = run("ask", "where are the keys", "--store", "missing.db")
    assert result.exit_code == 3
    assert "missing.db" in result.stderr


def test_ask_says_no_with_status_1_and_the_store_it_used(run: Run, filled: str) -> None:
    result = run("ask", "Did you see a cup?", "--store", filled, "--now", NOW)
    assert result.exit_code == 1
    assert f"store: {filled} (from --store)" in result.stderr
    quiet = run("ask", "Did you see a cup?", "--store", filled, "--now", NOW, "-q")
    assert quiet.stderr == ""
    assert quiet.stdout == result.stdout


@pytest.mark.parametrize("question", ["Why did I leave my keys?", "zzz qqq", "x" * 10_000, "", "?"])
def test_ask_refuses_with_status_5(run: Run, filled: str, question: str) -> None:
    result = run("ask", question, "--store", filled, "--now", NOW, "--json")
    assert result.exit_code == 5
    [record] = records(result)
    assert record["status"] in ("not_understood", "out_of_scope", "ambiguous")
    plain = run("ask", question, "--store", filled, "--now", NOW)
    assert plain.exit_code == 5
    assert "Traceback" not in plain.output


def test_ask_saves_pictures_with_their_box(run: Run, filled: str, tmp_path: Path) -> None:
    result = run("ask", "where are the keys", "--store", filled, "--now", NOW, "--save", "out")
    assert result.exit_code == 0
    [path] = (tmp_path / "out").iterdir()
    with Image.open(path) as image:
        assert image.size == (320, 240)
        assert image.getpixel((101, 125)) == (255, 215, 0)
    assert "1 pictures in out" in result.stderr


def test_a_fixed_now_gives_the_same_output(run: Run, filled: str) -> None:
    args = ("ask", "where are the keys", "--store", filled, "--now", NOW)
    assert run(*args).stdout == run(*args).stdout
    last = run("ask", "where are the keys", "--store", filled, "--now", "last")
    assert "9:00 today" in last.stdout


def test_zone_decides_how_times_are_said(run: Run, filled: str) -> None:
    args = ("ask", "where are the keys", "--store", filled, "--now", NOW)
    assert "15:00 today" not in run(*args).stdout
    assert "15:00 yesterday" in run(*args, "--zone", "Europe/Berlin").stdout


@pytest.mark.parametrize("command", ["ask", "parse", "objects", "chat", "batch"])
def test_an_unknown_zone_is_named_with_near_ones(run: Run, command: str) -> None:
    args = ["x"] if command in ("ask", "parse") else []
    result = run(command, *args, "--zone", "Europ/Berlin")
    assert result.exit_code == 2
    assert "'Europ/Berlin'" in result.stderr
    assert "Europe/Berlin" in result.stderr


def test_a_now_that_is_no_time(run: Run) -> None:
    result = run("parse", "where are my keys", "--now", "yesterday")
    assert result.exit_code == 2
    assert "'yesterday' is not a time" in result.stderr


def test_parse_answers_each_line_in_order(run: Run) -> None:
    lines = b"Where are my keys?\n\nWhy?\r\n\xff\xfe\nDid you see a red cup?"
    result = run("parse", "--json", "--now", NOW, input=lines)
    assert result.exit_code == 5
    first, *errors, last = records(result)
    assert first["objects"][0]["owner"] == "me"
    assert len(errors) == 3
    assert all(error["error"] in ("not_understood", "out_of_scope") for error in errors)
    assert last["objects"][0]["attributes"] == ["red"]
    assert run("parse", "--json", "--now", NOW, input="Where are my keys?\n").exit_code == 0


def test_parse_can_be_read(run: Run) -> None:
    text = "Where was the pink cup in the kitchen between 1 and 4 pm?"
    result = run("parse", text, "--now", NOW)
    assert result.exit_code == 0
    assert "x: pink cup" in result.stdout
    assert "Q3" in result.stdout
    assert "2026-03-01T13:00:00-05:00 to 2026-03-01T16:00:00-05:00" in result.stdout


def test_parse_tells_how_many_whose_not_and_where_not(run: Run) -> None:
    text = "Did you see at most two cups that are not Anna's and not in the kitchen?"
    result = run("parse", text, "--now", NOW)
    assert result.exit_code == 0
    for said in ("x: cup not of anna x at most 2", "place: not kitchen", "count(x, <= 2)"):
        assert said in result.stdout


def test_parse_takes_the_zone_or_the_offset_of_now(run: Run) -> None:
    def start(*options: str) -> str:
        [record] = records(run("parse", "--json", "where was the cup today", *options))
        return str(record["time"]["start"])

    assert start("--now", NOW) == "2026-03-01T00:00:00-05:00"
    assert start("--now", NOW, "--zone", "Asia/Tokyo") == "2026-03-02T00:00:00+09:00"
    assert start("--now", "2026-03-01T19:00", "--zone", "Asia/Tokyo").endswith(
        "03-01T00:00:00+09:00"
    )


def test_parse_asks_a_store_only_where_one_is_named(run: Run, filled: str) -> None:
    result = run("parse", "--json", "where was the bowl today", "--store", filled, "--now", NOW)
    assert result.exit_code == 0
    [record] = records(result)
    assert record["time"]["start"] == "2026-03-01T00:00:00-05:00"


def test_batch_keeps_order_and_ids(run: Run, filled: str, tmp_path: Path) -> None:
    lines = ["where are the keys", json.dumps({"id": "b", "text": "why?"}), "", "where is the bowl"]
    (tmp_path / "questions.txt").write_text("\n".join(lines))
    result = run("batch", "questions.txt", "--store", filled, "--now", NOW)
    assert result.exit_code == 0
    first, second, empty, fourth = records(result)
    assert (first["status"], second["id"], fourth["status"]) == ("found", "b", "found")
    assert (empty["status"], empty["answer"]) == ("not_understood", "This line is empty.")
    broken = run("batch", "-", "--store", filled, "--now", NOW, input='{"text": 1}\nwhere is it')
    assert broken.exit_code == 0
    assert [record["status"] for record in records(broken)] == ["not_understood"] * 2


def test_batch_ends_with_1_when_the_store_failed_on_a_line(
    run: Run, filled: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed = Answer(text="x", status="error", answer="I cannot reach my memory.")
    monkeypatch.setattr("assistant.batch.run", lambda *_, **__: iter([failed, Answer()]))
    result = run("batch", "-", "--store", filled, input="x")
    assert result.exit_code == 1
    assert len(records(result)) == 2


def test_objects_lists_oic(run: Run, filled: str) -> None:
    result = run("objects", "--json", "--store", filled)
    bowl, keys = records(result)
    assert (bowl["category"], keys["category"]) == ("bowl", "keys")
    assert bowl["colours"][0] == "orange"
    assert keys["colours"][0] == "blue"
    assert bowl["places"][0]["position"] == pytest.approx([3.0, 1.0, 0.5], abs=0.05)
    assert keys["first"] == "2026-03-01T09:00:00-05:00"
    table = run("objects", "--store", filled).stdout.splitlines()
    header = "id category names colours weight places first seen last seen"
    assert " ".join(table[0].split()) == header
    assert len(table) == 3
    none = run("objects", "--store", filled, "--category", "sofa")
    assert none.exit_code == 1
    assert "store: " in none.stderr


def test_explain_prints_query_plan_and_native_queries(run: Run, filled: str) -> None:
    result = run("explain", "where are the keys", "--store", filled, "--now", NOW)
    assert result.exit_code == 0
    for part in ("key(x)", "plan", "native queries", "SELECT"):
        assert part in result.stdout
    refused = run("explain", "why?", "--store", filled)
    assert refused.exit_code == 5
    assert refused.stdout == ""
    [record] = records(run("explain", "--json", "where are the keys", "--store", filled))
    assert record["native"]


def test_the_chat_understands_follow_ups_through_a_pipe(run: Run, filled: str) -> None:
    lines = "where are the keys\nand the bowl?\nwhy\nblah blah\nwhat about yesterday?\n"
    result = run("chat", "--plain", "--store", filled, "--now", NOW, input=lines)
    assert result.exit_code == 0
    assert "1 of 1: keys" in result.stdout
    assert "You: and the bowl?" in result.stdout
    assert "1 of 1: bowl" in result.stdout
    assert "Formal     bowl(x)" in result.stdout  # why: of the query it became
    assert "not looking" in result.stdout.partition("You: what about yesterday?")[2]


def test_a_missing_store_says_which_and_what_would_do(run: Run) -> None:
    result = run("ask", "where are the keys")
    assert result.exit_code == 3
    assert result.stderr.count("memory.db") == 1
    assert "no memory" in result.stderr
    assert "`d3a demo`" in result.stderr
    assert "`d3a ingest SOURCE`" in result.stderr
    assert result.stdout == ""
    assert run("chat").stderr == result.stderr


def test_a_file_of_another_program_is_left_alone(run: Run, tmp_path: Path) -> None:
    other = tmp_path / "other.db"
    with sqlite3.connect(other) as connection:
        connection.execute("CREATE TABLE music (title TEXT)")
    connection.close()
    (tmp_path / "text.db").write_text("Dear diary, today I lost my keys.\n" * 100)
    for name in ("other.db", "text.db"):
        before = (tmp_path / name).read_bytes()
        for command in (("ask", "where are my keys"), ("objects",)):
            result = run(*command, "--store", name)
            assert result.exit_code == 3
            assert name in result.stderr
            assert "Traceback" not in result.output
        assert (tmp_path / name).read_bytes() == before


def test_a_mongodb_that_does_not_answer_is_named_without_its_password(run: Run) -> None:
    uri = (
        "mongodb://robot:s3cret@127.0.0.1:9/home?serverSelectionTimeoutMS=200&connectTimeoutMS=200"
    )
    for command in (("ask", "where are my keys"), ("objects",), ("batch",), ("chat", "--plain")):
        result = run(*command, "--store", uri, input="where are my keys\n")
        assert result.exit_code == (1 if command == ("batch",) else 3)
        assert "robot:***@127.0.0.1:9" in result.stderr
        assert "s3cret" not in result.output
        assert "Traceback" not in result.output


def test_category_names_are_data(run: Run, tmp_path: Path) -> None:
    store = open_store(str(tmp_path / "nasty.db"))
    small_home.fill(store)
    at = small_home.ms(small_home.NOW)
    store.apply(
        Batch(
            objects=[ObjectRecord("n-1", small_home.NASTY, 1.0, at, at)],
            stays=[StayRecord("n-1", 1, (1.0, 1.0, 0.5), at, at, 1.0)],
            sightings=[Sighting("n-1", 1, at, at, "f\x1b[2J", 0.9, small_home.BOX)],
        )
    )
    store.close()
    ask = ("ask", "what did you see")
    for args in (("objects",), ("objects", "--json"), ask, (*ask, "--json")):
        result = run(*args, "--store", "nasty.db", "--now", NOW)
        assert "mug [red]" in result.output
        assert "\x1b" not in result.output
    assert "\u202e" not in run("objects", "--store", "nasty.db").output
    assert (
        records(run("objects", "--json", "--store", "nasty.db"))[-1]["category"] == small_home.NASTY
    )


def test_arguments_with_escapes_are_printed_harmless(run: Run) -> None:
    for args in (("\x1b[31mask",), ("ask", "x", "--store", "\x1b[31m.db"), ("ask", "--\x1b[31m")):
        result = run(*args)
        assert result.exit_code in (2, 3)
        assert "\x1b" not in result.output


def test_an_unknown_command_names_the_nearest(run: Run) -> None:
    result = run("objcts")
    assert result.exit_code == 2
    assert "Did you mean objects?" in result.stderr


def test_settings_come_from_flag_environment_and_files(
    run: Run, filled: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "d3a.toml").write_text(f'store = "{filled}"\nnow = "{NOW}"\nzone = "Asia/Tokyo"\n')
    assert "23:00 yesterday" in run("ask", "where are the keys").stdout
    monkeypatch.setenv("D3A_ZONE", "Europe/Berlin")
    assert "15:00 yesterday" in run("ask", "where are the keys").stdout
    assert "9:00 today" in run("ask", "where are the keys", "--zone", "America/New_York").stdout
    (tmp_path / "d3a.toml").write_text('stroe = "x.db"\n')
    result = run("objects")
    assert result.exit_code == 2
    assert "nearest: store" in result.stderr
    (tmp_path / "d3a.toml").write_text("store = \n")
    assert run("objects").exit_code == 2
    assert run("--help").exit_code == 0


def test_without_a_terminal_d3a_shows_its_help(run: Run) -> None:
    result = run()
    assert result.exit_code == 2
    assert "Commands:" in result.stderr
    assert result.stdout == ""


def test_the_clock_is_read_where_no_time_is_given(run: Run) -> None:
    settings = Settings(clock=lambda: datetime(2031, 5, 6, 12, tzinfo=UTC), zone="UTC")
    result = run("parse", "--json", "where was the cup today", obj=settings)
    assert records(result)[0]["time"]["start"] == "2031-05-06T00:00:00+00:00"


COMMAND = [sys.executable, "-c", "from assistant.cli import main; main(prog_name='d3a')"]


def test_a_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    process = subprocess.run(
        [*COMMAND, "parse", "--json", *["where are my keys"] * 50],
        stdout=writer,
        stderr=subprocess.PIPE,
        check=False,
        timeout=60,
    )
    os.close(writer)
    assert process.stderr == b""


def test_an_interrupt_is_status_130() -> None:
    with subprocess.Popen(
        [*COMMAND, "parse", "--json"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        # A test run that was started in the background ignores interrupts, and its children too.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(b"where are my keys\n" * 2000)
        process.stdin.flush()
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + 30
        while process.poll() is None and time.monotonic() < deadline:
            process.stdout.read1(1 << 16)  # type: ignore[attr-defined]  # a BufferedReader has it
        assert process.returncode == 130


def test_a_terminal_that_lacks_a_letter_gets_ascii_json() -> None:
    process = subprocess.run(
        [*COMMAND, "parse", "--json", "where is the café table"],
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=False,
        timeout=60,
    )
    assert json.loads(process.stdout)["text"] == "where is the café table"
    assert b"caf\\u00e9" in process.stdout


@pytest.mark.parametrize(
    ("args", "forbidden"),
    [
        (["--help"], {"numpy", "lark", "rich", "sqlite3", "pymongo"}),
        (["parse", "--help"], {"numpy"}),
        (["parse", "--json", "where are my keys"], {"numpy", "sqlite3", "pymongo", "rich"}),
        (["ask", "where are the keys", "--store", "{store}"], {"pymongo", "rich"}),
        (["batch", "/dev/null", "--store", "{store}"], {"pymongo", "rich"}),
        (["objects", "--store", "{store}"], {"pymongo", "rich"}),
    ],
)
def test_a_command_loads_only_what_it_needs(
    args: list[str], forbidden: set[str], filled: str
) -> None:
    heavy = forbidden | {"sklearn", "cv2", "textual", "PIL", "scipy"}
    program = (
        "import sys, atexit\n"
        "from assistant.cli import main\n"
        "try:\n    main(sys.argv[1:], prog_name='d3a')\n"
        "finally:\n    print('LOADED', *sys.modules, file=sys.stderr)\n"
    )
    process = subprocess.run(
        [sys.executable, "-c", program, *[arg.format(store=filled) for arg in args]],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert process.returncode == 0, process.stderr[-2000:]
    loaded = set(process.stderr.rpartition("LOADED ")[2].split())
    assert not heavy & loaded


def test_config_shows_where_settings_come_from(run: Run, tmp_path: Path) -> None:
    made = run("config", "init")
    assert made.exit_code == 0
    path = Path(made.stdout.strip())
    assert path.is_relative_to(tmp_path)
    assert path.read_text().count("\n") > 4
    again = run("config", "init")
    assert again.exit_code == 2
    assert "left alone" in again.stderr
    path.write_text('store = "mongodb://robot:s3cret@robot.local/home"\n')
    shown = run("config", "show", "--zone", "Asia/Tokyo").stdout
    assert "zone      Asia/Tokyo" in shown
    assert "robot:***@robot.local" in shown
    assert str(path) in shown
    [record] = records(run("config", "show", "--json"))
    assert record["images"] == "auto"
    paths = run("config", "path").stdout.splitlines()
    assert paths[0] == str(path)
    assert paths[1].endswith("d3a.toml (does not exist)")


def test_each_setting_of_the_sample_file_is_a_setting(run: Run, tmp_path: Path) -> None:
    lines = SAMPLE.splitlines()
    settings = [line.removeprefix("# ") for line in lines if " = " in line or "[keys]" in line]
    (tmp_path / "d3a.toml").write_text("\n".join(settings))
    result = run("config", "show", "--json")
    assert result.exit_code == 0, result.output
    [record] = records(result)
    assert record["zone"] == "Europe/Berlin"
    (tmp_path / "d3a.toml").write_text('images = "sexel"\n')
    assert "auto, kitty, sixel, cells, ascii, off" in run("config", "show").stderr


def test_doctor_tells_what_is_wrong(run: Run, filled: str, tmp_path: Path) -> None:
    result = run("doctor", "--store", filled)
    assert result.exit_code == 0
    for part in ("line by line: this is not a terminal", "objects      2", "America/New_York"):
        assert part in result.stdout
    (tmp_path / "text.db").write_text("Dear diary. " * 100)
    broken = run("doctor", "--json", "--store", "text.db")
    assert broken.exit_code == 3
    assert "text.db" in records(broken)[0]["store"]["problem"]


def test_a_failing_store_gives_a_record_a_question(run: Run, tmp_path: Path) -> None:
    store = ("--store", f"sqlite:///{tmp_path / 'none.db'}")
    asked = run("ask", "--json", "where is the cup", *store)
    record = json.loads(asked.stdout)
    assert (asked.exit_code, record["status"], record["text"]) == (3, "error", "where is the cup")
    assert "none.db" in record["message"]
    lines = 'where is the cup\n\n{"id": "b", "text": "where is the bowl"}\n'
    asked = run("batch", "-", *store, input=lines)
    answers = records(asked)
    assert asked.exit_code == 1
    assert [(r["id"], r["status"]) for r in answers] == [
        (None, "error"),
        (None, "error"),
        ("b", "error"),
    ]


def test_the_version_of_a_tree_that_is_not_installed(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("assistant.commands.doctor.version", missing)
    result = run("--version")
    assert (result.exit_code, result.output) == (0, "d3a not installed\n")
    monkeypatch.setattr("assistant.commands.doctor.version", lambda name: "7.1")
    assert run("--version").output == "d3a, version 7.1\n"
