"""Scenes made in other processes: the store is the same, whoever made them."""

from __future__ import annotations

import importlib
import importlib.util
import json
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from d3a.images import Pixels
from d3a.ingest import IngestSummary, ingest
from d3a.ingesting import jobs as jobs_module
from d3a.ingesting.intake import Intake
from d3a.ingesting.jobs import NEEDS, Jobs
from d3a.model import BadInput, Detection, Frame, Json
from d3a.parameters import DEFAULT, PROFILES
from d3a.readers.base import Reader, RecordingFacts, Skipped
from d3a.readers.opening import open_source
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import depth_png, detection_line, frame_line, jpeg, write_recording

COUNT = 61
TWO = Jobs(2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pictures, depth, and something broken of each kind."""
    path = tmp_path_factory.mktemp("jobs") / "r"
    frames = []
    for n in range(COUNT):
        shown = {"image": f"images/{n}.jpg", "depth": f"depth/{n}.png"}
        frames.append(frame_line(n) | shown)
    frames[9]["time"] = frames[4]["time"]
    frames[30]["frame"] = frames[29]["frame"]
    rows = [detection_line(n, box=[10 + n % 7, 10, 30 + n % 7, 30]) for n in range(COUNT)]
    write_recording(path, frames, rows)
    for name, content in (("images", None), ("depth", depth_png(2.0))):
        (path / name).mkdir()
        for n in range(COUNT):
            suffix = "jpg" if content is None else "png"
            (path / f"{name}/{n}.{suffix}").write_bytes(content or jpeg(n % 150))
    (path / "images/7.jpg").write_bytes(b"")
    (path / "depth/11.png").write_bytes(b"no picture")
    with (path / "frames.jsonl").open("a") as file:
        file.write("{broken\n")
    return path


def taken(reader: Reader, jobs: Jobs, **options: object) -> tuple[IngestSummary, list[Json]]:
    store = OracleStore()
    summary = ingest(reader, store, DEFAULT, jobs=jobs, **options)  # type: ignore[arg-type]
    return summary, list(store.dump())


def without_seconds(summary: IngestSummary) -> IngestSummary:
    return replace(summary, seconds={}, processor={}, elapsed_s=0)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_two_processes_fill_the_store_of_one(folder: Path, profile: str) -> None:
    found = []
    for jobs in (Jobs(), TWO):
        store = OracleStore()
        intake = Intake(every=2) if profile == "paper" else Intake()
        summary = ingest(open_source(folder), store, PROFILES[profile], jobs=jobs, intake=intake)
        assert summary.seconds["decode"] > 0
        found.append((without_seconds(summary), list(store.dump())))
    assert found[0] == found[1]


def test_parts_by_processes_and_by_one_are_the_whole(folder: Path) -> None:
    _, wanted = taken(open_source(folder), Jobs())
    store = OracleStore()
    for jobs, most in ((TWO, 13), (Jobs(), 9), (TWO, 1), (TWO, None)):
        ingest(open_source(folder), store, DEFAULT, jobs=jobs, max_frames=most)
    assert list(store.dump()) == wanted


@dataclass
class Counting:
    """A detector with a large model, which says how often it was loaded into a process."""

    log: Path
    classes: tuple[str, ...] = ("cup",)
    identity: str = "counting"

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        return (Detection("cup", 0.9, (5, 5, 20 + len(frame.name), 25)),)

    def __setstate__(self, state: Json) -> None:
        self.__dict__.update(state)
        with self.log.open("a") as file:
            file.write("loaded\n")


def test_a_detector_is_loaded_once_a_process(folder: Path, tmp_path: Path) -> None:
    detector = Counting(tmp_path / "log")
    one = taken(open_source(folder), Jobs(), detector=detector)
    two = taken(open_source(folder), TWO, detector=detector)
    assert two[1] == one[1]
    assert 1 <= len((tmp_path / "log").read_text().splitlines()) <= 2


class Failing(Counting):
    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        if frame.name == "000020":
            raise BadInput("the detector cannot look at this")
        return super().detect(frame, pixels)


def test_what_a_worker_raises_is_raised(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="cannot look at this"):
        taken(open_source(folder), TWO, detector=Failing(tmp_path / "log"))


@dataclass
class Endless:
    """A reader that is never done, and counts what was read of it."""

    facts: RecordingFacts = field(default_factory=lambda: RecordingFacts("endless", zone="UTC"))
    skipped: Skipped = field(default_factory=Skipped)
    read: int = 0

    def __iter__(self) -> Iterator[Frame]:
        while True:
            self.read += 1
            yield Frame(f"f{self.read}", 1_700_000_000_000 + self.read * 100, detections=())


def test_no_more_is_read_than_two_waves_ahead() -> None:
    reader = Endless()
    ingest(reader, OracleStore(), DEFAULT, jobs=TWO, max_frames=100)
    wave = 2 * jobs_module.AHEAD * jobs_module.CHUNK
    assert reader.read <= 100 + 4 * wave


def test_dask_fills_the_same_store(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if importlib.util.find_spec("distributed") is None:
        pytest.skip("distributed is not installed (the extra dask)")
    dask: Any = importlib.import_module("dask")
    distributed: Any = importlib.import_module("distributed")

    _, wanted = taken(open_source(folder), Jobs())
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        dask.config.set({"scheduler-address": cluster.scheduler_address}),
    ):
        _, found = taken(open_source(folder), Jobs(2, "dask"))
    assert found == wanted


def test_a_backend_that_is_not_installed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(NEEDS, "ray", ("no_such_library", "pip install ray"))
    with pytest.raises(BadInput, match=r"'ray' needs no_such_library: pip install ray"):
        Jobs(2, "ray")
    with pytest.raises(BadInput, match="must be 1 or more"):
        Jobs(0)


def test_facts_and_lines_are_as_in_one_process(folder: Path) -> None:
    one, two = (taken(open_source(folder), jobs)[0] for jobs in (Jobs(), TWO))
    assert json.dumps(one.skipped.counts, sort_keys=True) == json.dumps(
        two.skipped.counts, sort_keys=True
    )
    assert len(one.skipped.counts) == 6
