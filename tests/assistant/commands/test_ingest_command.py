"""`d3a ingest` as a person runs it: options, many recordings, what it prints and its status."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from assistant.cli import main
from assistant.intake_report import Pace, duration
from d3a.correcting.forgetting import forget, plan_forgetting
from d3a.correcting.forgotten import Selection
from d3a.ingest import IngestSummary, ingest
from d3a.store import open_store
from tests.worlds import terminals
from tests.worlds.folders import as_recording, as_tum, boxes_file, moments, pictures, write_csv

Run = Callable[..., Result]


@pytest.fixture
def run(own_settings: Path) -> Run:
    return lambda *args: CliRunner().invoke(main, ["ingest", *args, "--store", "s.db"])


def summary_of(result: Result) -> dict[str, Any]:
    assert result.exit_code in (0, 2), result.output
    record: dict[str, Any] = json.loads(result.stdout)
    assert record["schema"] == 1
    return record


def later(folder: Path, year: str) -> Path:
    """The small recording, made in another year and under another name."""
    as_recording(folder)
    text = (folder / "frames.jsonl").read_text().replace('"time": "2020-', f'"time": "{year}-')
    (folder / "frames.jsonl").write_text(text)
    facts = json.loads((folder / "recording.json").read_text()) | {"recording": folder.name}
    (folder / "recording.json").write_text(json.dumps(facts))
    return folder


def test_the_summary_is_json_too(run: Run, tmp_path: Path) -> None:
    as_recording(tmp_path / "r")
    record = summary_of(run("r", "--json", "--every", "2", "--ignore", "bowl", "-q"))
    (one,) = record["recordings"]
    assert record["store"] == "s.db"
    assert (one["source"], one["recording"], one["site"]) == ("r", "same", "lab")
    assert (one["frames"], one["detections"], one["objects"]) == (4, 4, 1)
    assert [(s["reason"], s["count"]) for s in one["skipped"]] == [
        ("frame between those to take (--every)", 4)
    ]
    assert summary_of(run("r", "--json", "--every", "2", "--ignore", "bowl"))["recordings"][0][
        "already"
    ]
    refused = run("r", "--every", "3")
    assert refused.exit_code == 2
    assert "every 2, not 3" in refused.stderr


def test_since_takes_a_date_in_the_recordings_zone(run: Run, tmp_path: Path) -> None:
    as_recording(tmp_path / "r")
    result = run("r", "--since", moments()[5].iso, "--json", "-q")
    assert summary_of(result)["recordings"][0]["frames"] == 3
    assert run("r", "--since", "soon").exit_code == 2
    (tmp_path / "s.db").unlink()
    assert summary_of(run("r", "--since", "2020-09-14", "--json"))["recordings"][0]["frames"] == 0


def test_an_ignored_word_that_nothing_was_called_is_said(run: Run, tmp_path: Path) -> None:
    as_recording(tmp_path / "r")
    result = run("r", "--ignore", "persn", "--ignore", "Cup")
    assert result.exit_code == 0
    assert "nothing was called 'persn'" in result.stderr
    assert "'cup'" not in result.stderr
    assert "8 x ignored: cup" in result.stdout


def test_off_limits_is_a_region_or_a_polygon(run: Run, tmp_path: Path) -> None:
    as_recording(tmp_path / "r")
    result = run("r", "--off-limits", "bathroom")
    assert result.exit_code == 2
    assert "no region 'bathroom'" in result.stderr
    result = run("r", "--off-limits", "-1,-1 0.35,-1 0.35,1 -1,1")
    assert result.exit_code == 0
    assert "4 x frame taken in an off-limits place" in result.stdout
    assert run("r", "--off-limits", "0,0 1,1").exit_code == 2


def test_reader_options_reach_the_reader(run: Run, tmp_path: Path) -> None:
    as_tum(tmp_path / "t", 1000.0)
    result = run("t", "--reader", "depth-scale=1000", "--reader", "site=flat", "--zone", "UTC")
    assert result.exit_code == 0, result.output
    with closing(open_store("s.db")) as store:
        (recording,) = store.recordings()
        assert (recording.name, recording.site, recording.zone) == ("t", "flat", "UTC")
        assert all(2.0 < (s.position or (0, 0, 0))[2] < 3.2 for s in store.stays())
    for wrong, said in (
        ("depth_skale=1", "Did you mean depth-scale"),
        ("depth-scale", "KEY=VALUE"),
        ("site=", "KEY=VALUE"),
    ):
        result = run("t", "--reader", wrong)
        assert result.exit_code == 2
        assert said in result.stderr
    twice = run("t", "--reader", "site=a", "--reader", "site=b")
    assert "given twice" in twice.stderr
    topic = run("t", "--topic", "image=/camera/rgb")
    assert "no option 'topic.image'" in topic.stderr


def test_several_recordings_go_in_by_time(run: Run, tmp_path: Path) -> None:
    names = ["c", "a", "b"]
    for name, year in zip(names, ("2022", "2020", "2021"), strict=True):
        later(tmp_path / name, year)
    record = summary_of(run(*names, "--json"))
    assert [r["source"] for r in record["recordings"]] == ["a", "b", "c"]
    assert [r["frames"] for r in record["recordings"]] == [8, 8, 8]
    one_by_one = CliRunner()
    for name in ("a", "b", "c"):
        result = one_by_one.invoke(main, ["ingest", name, "--store", "one.db", "-q"])
        assert result.exit_code == 0
    with closing(open_store("s.db")) as together, closing(open_store("one.db")) as apart:
        assert list(together.dump()) == list(apart.dump())
    again = run(*names)
    assert again.stdout.count("Nothing new") == 3
    assert again.exit_code == 0


def test_a_recording_that_cannot_be_read_does_not_stop_the_others(run: Run, tmp_path: Path) -> None:
    later(tmp_path / "a", "2020")
    later(tmp_path / "empty", "2021")
    (tmp_path / "empty" / "frames.jsonl").write_text("")
    result = run("none", "a", "empty", "--json")
    record = summary_of(result)
    assert result.exit_code == 2
    assert [r["source"] for r in record["recordings"]] == ["a"]
    assert [f["source"] for f in record["failed"]] == ["none", "empty"]
    assert "none does not exist" in result.stderr
    assert "no frame to read" in result.stderr
    (tmp_path / "s.db").unlink()
    assert run("none", "nowhere").exit_code == 2
    assert not (tmp_path / "s.db").exists()
    assert run("a", "b", "--assignments", "x.jsonl").exit_code == 2


def test_a_recording_of_broken_frames_alone_says_why(run: Run, tmp_path: Path) -> None:
    folder = later(tmp_path / "r", "2020")
    lines = [json.loads(line) for line in (folder / "frames.jsonl").read_text().splitlines()]
    broken = [json.dumps(line | {"time": line["time"][:19]}) + "\n" for line in lines]
    (folder / "frames.jsonl").write_text("".join(broken))
    result = run("r")
    assert result.exit_code == 2
    assert f"no frame to read; {len(lines)} x broken frame: frames.jsonl:1 (" in result.stderr
    assert "offset" in result.stderr


def test_assignments_are_written_once_and_refused_where_they_cannot_be(
    run: Run, tmp_path: Path
) -> None:
    as_recording(tmp_path / "r")
    refused = run("r", "--assignments", "nowhere/x.jsonl")
    assert refused.exit_code == 2
    assert "nowhere is no folder" in refused.stderr
    assert not (tmp_path / "s.db").exists()
    assert run("r", "--assignments", "x.jsonl").exit_code == 0
    wanted = (tmp_path / "x.jsonl").read_bytes()
    again = run("r", "--assignments", "x.jsonl")
    assert again.exit_code == 0
    assert "Nothing new" in again.stdout
    assert (tmp_path / "x.jsonl").read_bytes() == wanted


def test_pictures_alone_need_a_detector(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "p"
    pictures(folder)
    write_csv(folder / "times.csv", ("file", "time"), [(m.name, m.iso) for m in moments()])
    result = run("p")
    assert result.exit_code == 2
    assert "--detector model.onnx" in result.stderr
    assert "detections.jsonl" in result.stderr
    boxes_file(folder)
    assert run("p").exit_code == 0


def test_the_pace_is_that_of_this_run() -> None:
    now = iter([10.0, 12.0, 14.0, 14.0])
    pace = Pace(lambda: next(now))
    assert pace.said(100, 1000) == ""
    assert pace.said(120, 1000) == "10.0 frames/s, 88 s left"
    assert pace.said(1000, 1000) == "225.0 frames/s"
    assert pace.said(1000, None) == "225.0 frames/s"


@pytest.mark.parametrize(
    ("seconds", "said"), [(0.4, "0 s"), (89, "89 s"), (100, "2 min"), (7500, "2 h 5 min")]
)
def test_a_duration_is_said(seconds: float, said: str) -> None:
    assert duration(seconds) == said


def test_many_recordings_in_jobs_fill_the_store_of_one_process(run: Run, tmp_path: Path) -> None:
    names = [str(later(tmp_path / f"r{n}", str(2022 - n))) for n in range(3)]
    dumps = []
    for args in ((), ("--jobs", "2")):
        assert run(*names, *args, "-q").exit_code == 0
        with closing(open_store("s.db", create=False)) as store:
            dumps.append(list(store.dump()))
        (tmp_path / "s.db").unlink()
    assert dumps[0] == dumps[1]
    recordings = [each for each in dumps[0] if each["kind"] == "recording"]
    assert len(recordings) == 3


def test_what_is_forgotten_meanwhile_ends_no_ingest(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    later(tmp_path / "old", "2019")
    assert run("old").exit_code == 0
    as_recording(tmp_path / "new")
    told: list[int] = []

    def meddled(*args: Any, **how: Any) -> IngestSummary:
        def speak(done: int, _total: int | None) -> None:
            told.append(done)
            if told == [1, 2, 3]:
                with closing(open_store("s.db")) as store:
                    bowls = frozenset(r.object_id for r in store.objects(categories=["bowl"]))
                    forget(store, plan_forgetting(store, Selection(object_ids=bowls)))

        return ingest(*args, **(how | {"on_progress": speak}))

    monkeypatch.setattr("d3a.ingest.ingest", meddled)
    result = run("new")
    assert result.exit_code == 0, result.output
    assert "note: sqlite:///s.db: something was forgotten while this ingest ran" in result.stderr
    assert "frames      8\n" in result.stdout
    with closing(open_store("s.db")) as store:
        assert store.check() == []
        assert [record.done for record in store.recordings()] == [True, True]
        (bowl,) = store.objects(categories=["bowl"])
        assert datetime.fromtimestamp(bowl.first_ms / 1000, UTC).year == 2020
    assert told[:4] == [1, 2, 3, 1], "it began again, as there was no checkpoint"


def test_a_person_is_told_where_nothing_has_a_pose(run: Run, tmp_path: Path) -> None:
    for name, poses in (("r", True), ("p", False)):
        as_recording(tmp_path / name, depth=poses, poses=poses)
    told = "note: no frame has a pose, so nothing is placed on the map"
    assert told not in run("r").stderr
    facts = json.loads(Path("p/recording.json").read_text()) | {"recording": "unposed"}
    Path("p/recording.json").write_text(json.dumps(facts))
    result = run("p", "--every", "2")
    assert result.exit_code == 0, result.output
    assert told in result.stderr


def test_a_note_stands_above_the_bar(tmp_path: Path) -> None:
    program = tmp_path / "noting.py"
    program.write_text(
        "from assistant.intake_report import progress\n"
        "from assistant.terminal import tell\n"
        "with progress(False) as on_progress:\n"
        "    on_progress(1, 30)\n"
        "    tell('note: no frame has a pose')\n"
        "    on_progress(30, 30)\n"
    )
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[3]), "TERM": "xterm"}
    with terminals.opened([sys.executable, str(program)], environment, size=(24, 80)) as terminal:
        seen = terminal.read_all().decode()
    before = seen.partition("note: no frame has a pose")[0]
    assert before != seen
    assert before.endswith(("\n", "\x1b[2K"))  # a line of its own, or one that was wiped
