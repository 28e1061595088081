"""`d3a watch` as it is run: a process that writes, one that watches, one that asks."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from d3a.model import Json
from d3a.store import open_store
from d3a.store.base import StoreError
from tests.worlds.folders import as_recording
from tests.worlds.rounds import Thing, circle, depth_png, jpeg, rounds, write_recording

ROOT = Path(__file__).resolve().parents[3]
PATIENCE_S = 60.0


@pytest.fixture(autouse=True)
def own_environment(own_settings: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


def d3a(folder: Path, *args: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "assistant.cli", *args, "--store", "s.db"]
    return subprocess.run(
        command,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )


@contextmanager
def running(folder: Path, *command: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, *command],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def watching(folder: Path, *args: str) -> tuple[str, ...]:
    return ("-m", "assistant.cli", "watch", "grows", "--store", "s.db", "--fresh", "1", *args)


def until(true: Callable[[], bool], what: str) -> None:
    given_up = time.monotonic() + PATIENCE_S
    while not true():
        if time.monotonic() > given_up:
            pytest.fail(f"waited in vain for {what}")
        time.sleep(0.05)


def frames_in(path: Path) -> int:
    try:
        with closing(open_store(str(path), create=False, read_only=True)) as store:
            return sum(record.frames for record in store.recordings())
    except StoreError:  # it is not there yet, or being made
        return 0


def dump(path: Path) -> list[Json]:
    with closing(open_store(str(path), create=False, read_only=True)) as store:
        return list(store.dump())


def patrol(folder: Path, count: int = 120) -> Path:
    """A recording with pictures and depth, at ten frames a second."""
    places = circle(1.5, 4)
    things = [Thing(name, places[n], n, 10 * n) for n, name in enumerate(("cup", "bowl", "book"))]
    frames, rows = [], []
    (folder / "images").mkdir(parents=True)
    (folder / "depth").mkdir()
    for n, frame in enumerate(rounds(things, count, step_s=0.1)):
        (folder / f"images/{n}.jpg").write_bytes(jpeg(n % 150))
        (folder / f"depth/{n}.png").write_bytes(depth_png(2.0))
        assert frame.pose is not None
        frames.append(
            {
                "frame": frame.name,
                "time": f"2024-05-01T10:00:{n // 10:02d}.{n % 10}00Z",
                "pose": [*frame.pose.position, *frame.pose.quaternion],
                "image": f"images/{n}.jpg",
                "depth": f"depth/{n}.png",
            }
        )
        for each in frame.detections or ():
            assert each.position is not None
            rows.append(
                {
                    "frame": frame.name,
                    "category": each.category,
                    "probability": round(each.probability, 3),
                    "box": [10, 10, 30, 30],
                    "position": [round(x, 4) for x in each.position],
                }
            )
    return write_recording(folder, frames, rows)


def test_one_writes_one_watches_one_asks_and_two_are_killed(tmp_path: Path) -> None:
    whole = patrol(tmp_path / "whole")
    writer = (str(ROOT / "tests/worlds/growing.py"), str(whole), str(tmp_path / "grows"), "10")
    store = tmp_path / "s.db"
    with running(tmp_path, *writer) as writing:
        with running(tmp_path, *watching(tmp_path)) as first:
            until(lambda: frames_in(store) >= 15, "the first frames")
            assert writing.poll() is None
            asked = d3a(tmp_path, "ask", "Where is the cup?", "--now", "last", "--json")
            assert asked.returncode == 0, asked.stderr
            assert json.loads(asked.stdout)["status"] == "found"
            first.kill()
            assert first.wait(PATIENCE_S) == -signal.SIGKILL
        had = frames_in(store)
        with running(tmp_path, *watching(tmp_path)) as second:
            until(lambda: frames_in(store) > had, "frames after SIGKILL")
            second.send_signal(signal.SIGTERM)
            _, said = second.communicate(timeout=PATIENCE_S)
            assert second.returncode == 143, said
            assert "goes on when started again" in said
        with closing(open_store(str(store), create=False, read_only=True)) as opened:
            assert [record.done for record in opened.recordings()] == [False]
        with running(tmp_path, *watching(tmp_path, "--until-idle", "2", "--json")) as third:
            out, said = third.communicate(timeout=PATIENCE_S)
            assert third.returncode == 0, said
        assert writing.wait(PATIENCE_S) == 0
    record = json.loads(out)
    assert record["is_over"]
    assert record["summary"]["skipped"] == []
    assert record["summary"]["frames"] + record["summary"]["already_frames"] == 120
    plain = tmp_path / "plain"
    plain.mkdir()
    assert d3a(plain, "ingest", str(whole), "-q").returncode == 0
    assert dump(store) == dump(plain / "s.db")


def test_ctrl_c_ends_with_130_and_keeps_what_was_seen(tmp_path: Path) -> None:
    as_recording(tmp_path / "grows")
    with running(tmp_path, *watching(tmp_path)) as watcher:
        until(lambda: frames_in(tmp_path / "s.db") > 0, "frames")
        watcher.send_signal(signal.SIGINT)
        out, said = watcher.communicate(timeout=PATIENCE_S)
    assert watcher.returncode == 130, said
    assert "frames      8" in out
    assert frames_in(tmp_path / "s.db") == 8


def test_what_is_forgotten_meanwhile_stays_forgotten_and_the_watch_goes_on(tmp_path: Path) -> None:
    whole = patrol(tmp_path / "whole", 150)
    writer = (str(ROOT / "tests/worlds/growing.py"), str(whole), str(tmp_path / "grows"), "6")
    store = tmp_path / "s.db"
    with (
        running(tmp_path, *writer),
        running(tmp_path, *watching(tmp_path, "--until-idle", "4", "--fresh", "3")) as watcher,
    ):
        until(lambda: frames_in(store) >= 10, "the first frames")
        # it says to run it again where a checkpoint came between its plan and its deed
        until(lambda: d3a(tmp_path, "forget", "cup", "--yes").returncode == 0, "it to forget")
        with closing(open_store(str(store), create=False, read_only=True)) as opened:
            (forgotten_ms,) = {r.last_ms for r in opened.recordings()}
        _, said = watcher.communicate(timeout=PATIENCE_S)
    assert watcher.returncode == 0, said
    assert "something was forgotten" in said
    assert forgotten_ms is not None
    with closing(open_store(str(store), create=False, read_only=True)) as opened:
        assert [record.frames for record in opened.recordings()] == [150]
        cups = [r.object_id for r in opened.objects(categories=["cup"])]
        assert all(s.end_ms > forgotten_ms - 2000 for s in opened.sightings(object_ids=cups))


def test_a_time_to_begin_at_is_of_the_recordings_zone_as_in_ingest(tmp_path: Path) -> None:
    patrol(tmp_path / "r", 12)
    since = ("r", "--since", "2024-05-01T12:00:00.500", "--json")  # 10:00 UTC, in Berlin
    watched = d3a(tmp_path, "watch", *since, "--until-idle", "0.5")
    assert watched.returncode == 0, watched.stderr
    assert json.loads(watched.stdout)["summary"]["frames"] == 7
    (tmp_path / "s.db").rename(tmp_path / "watched.db")
    assert d3a(tmp_path, "ingest", *since).returncode == 0
    assert dump(tmp_path / "watched.db") == dump(tmp_path / "s.db")


def test_nothing_to_watch_is_a_clear_no(tmp_path: Path) -> None:
    done = d3a(tmp_path, "watch", "nowhere", "--until-idle", "0.3")
    assert done.returncode == 2
    assert "nowhere does not exist" in done.stderr
