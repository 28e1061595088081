"""`d3a doctor SOURCE`: what it prints of a recording, and its status."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from assistant.cli import main
from tests.worlds.folders import as_recording, as_tum, moments, pictures, write_csv

Run = Callable[..., Result]


@pytest.fixture
def run(own_settings: Path) -> Run:
    return lambda *args: CliRunner().invoke(main, ["doctor", *args])


def test_it_says_what_is_there_and_what_is_missing(run: Run, tmp_path: Path) -> None:
    folder = as_tum(tmp_path / "t")
    (folder / "depth.txt").unlink()
    result = run("t", "--zone", "Europe/Berlin")
    assert result.exit_code == 0, result.output
    for part in (
        "t (format tum)",
        "rgb.txt: pictures, 8, 2 a second, 2020-09-13 14:26:40.000+02:00",
        "  8 with a pose",
        "  0 with depth\n",
        "12 of 2 kinds: cup 8, bowl 4",
        "depth: positions come from the pose alone",
        "it can be taken in: d3a ingest t",
    ):
        assert part in result.stdout, part
    assert list(tmp_path.glob("**/*.db")) == []


def test_it_is_json_too_and_says_when_it_is_not_ready(run: Run, tmp_path: Path) -> None:
    pictures(tmp_path / "p")
    rows = [(m.name, m.time_ms + 60_000 * (n > 5)) for n, m in enumerate(moments())]
    write_csv(tmp_path / "p" / "times.csv", ("file", "time"), rows)
    result = run("p", "--json")
    assert result.exit_code == 1
    record = json.loads(result.stdout)
    assert (record["schema"], record["format"], record["ready"]) == (1, "pictures", False)
    assert record["frames"]["having"]["image"] == 8
    assert record["gaps"][0]["seconds"] == 60.5
    assert record["lacks"][0]["needed"] is True
    text = run("p")
    assert "1, ten usual steps or longer: 60 s after" in text.stdout
    assert "not yet: it needs boxes of a detector" in text.stdout


def test_what_cannot_be_read_has_status_2(run: Run, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert run("empty").exit_code == 2
    assert run("none").exit_code == 2
    as_recording(tmp_path / "r")
    assert run("r", "--format", "tum").exit_code == 2
    wrong = run("r", "--format", "recrding")
    assert "Did you mean recording" in wrong.stderr
    assert run("r", "--reader", "sight=x").exit_code == 2
    alone = run("--format", "tum")
    assert alone.exit_code == 2
    assert "name one" in alone.stderr
    assert run("r", "--reader", "site=x").exit_code == 0


def test_escapes_in_a_recording_do_not_reach_the_terminal(run: Run, tmp_path: Path) -> None:
    folder = as_recording(tmp_path / "r")
    with (folder / "frames.jsonl").open("a") as lines:
        lines.write(json.dumps({"frame": "1", "time": "\x1b[31mnoon"}) + "\n")
    result = run("r")
    assert result.exit_code == 0
    assert "\x1b" not in result.stdout
    assert "noon" in result.stdout
