"""Measure readers beside a writer: the same questions with and without an ingest that writes.

    python -m tests.bench.bench_load [--places 200000] [--cache DIR] [--readers 8]
        [--rate 5] [--writes 1000] [--group 50] [--seconds 20]

Each reader is a process with the store opened for reading, which asks so many questions a second
at times of its own. The writer is a process of its own; one operation extends or adds a sighting
with its stay and its object, so many a commit, as many a second as asked for. Prints p50, p95 and
the slowest of the readers in ms, waiting for a processor included, errors, and what the writer
reached. The home is copied first: it is not the cached one that is written to.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from multiprocessing.synchronize import Barrier
from pathlib import Path
from typing import TypedDict

import numpy as np

from assistant.asking import ask
from d3a.store import open_store
from d3a.store.base import Batch, ObjectRecord, Sighting, StayRecord
from tests.bench.bench_scale import FORMS, filled, folder_of, load, now_of, say
from tests.worlds import scaled

CONTEXT = multiprocessing.get_context("spawn")
ASKED = tuple(name for name in FORMS if name != "Q2 all time")


class Report(TypedDict):
    """What a reader writes at its end: ms of each question, of its processor; what went wrong."""

    ms: list[float]
    cpu: list[float]
    errors: list[str]


def main() -> None:
    """Run the readers alone, then beside the writer, and print both."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--places", type=int, default=200_000)
    options.add_argument("--cache", type=Path, help="a folder that keeps the store")
    options.add_argument("--readers", type=int, default=8)
    options.add_argument("--rate", type=float, default=5.0, help="questions a second of each")
    options.add_argument("--writes", type=int, default=1_000, help="operations a second")
    options.add_argument("--group", type=int, default=50, help="operations a commit")
    options.add_argument("--seconds", type=float, default=20.0)
    given = options.parse_args()
    with folder_of(given.cache) as kept, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "home.db"
        shutil.copy(filled(kept, given.places), path)
        say(
            f"{given.places} stays; {given.readers} readers, {given.rate:g} questions a second "
            f"each, {given.seconds:g} s; writer {given.writes} operations/s, {given.group} a commit"
        )
        alone = measured("without a writer", path, given)
        beside = measured("beside the writer", path, given, writes=True)
        say(f"p95 beside the writer / without: {beside / alone:.2f}  (goal 3)")
        with closing(open_store(str(path))) as store:
            say(f"check: {store.check() or 'sound'}")


def measured(name: str, path: Path, given: argparse.Namespace, *, writes: bool = False) -> float:
    """Run the readers, and the writer where `writes` says so; print, return p95 in ms."""
    ready = CONTEXT.Barrier(given.readers + (2 if writes else 1))
    reports = [path.with_name(f"reader-{k}.json") for k in range(given.readers)]
    processes = [
        CONTEXT.Process(target=read, args=(path, k, given.rate, given.seconds, ready, report))
        for k, report in enumerate(reports)
    ]
    told = path.with_name("writer.json")
    if writes:
        wanted = (path, given.writes, given.group, given.seconds, ready, told)
        processes.append(CONTEXT.Process(target=write, args=wanted))
    for process in processes:
        process.start()
    ready.wait()
    busy = load()
    for process in processes:
        process.join()
    if any(process.exitcode for process in processes):
        raise SystemExit(f"{name}: a process ended with an error")
    found: list[Report] = [json.loads(report.read_text()) for report in reports]
    spent = np.array([ms for report in found for ms in report["ms"]])
    errors = [error for report in found for error in report["errors"]]
    median, p95 = np.percentile(spent, [50, 95])
    worked, worked_95 = np.percentile([ms for report in found for ms in report["cpu"]], [50, 95])
    say(
        f"  {name:18} {len(spent)} questions, {median:.1f} / {p95:.1f} / {spent.max():.1f} ms, "
        f"processor {worked:.1f} / {worked_95:.1f} ms, "
        f"{len(errors)} errors; {busy} at the start, {load()} at the end"
    )
    for error in sorted(set(errors)):
        say(f"    {error}")
    if writes:
        wrote = json.loads(told.read_text())
        say(f"  writer             {wrote['rate']:.0f} operations/s, commit {wrote['commit']}")
    return float(p95)


def texts(reader: int) -> Iterator[str]:
    """Yield questions without end, every reader others: all forms but Q2 of all time."""
    draw = np.random.default_rng(reader)
    while True:
        a, b = draw.choice(scaled.MOVABLE, 2, replace=False).tolist()
        yield FORMS[ASKED[int(draw.integers(len(ASKED)))]](a, b)


def read(
    path: Path, reader: int, rate: float, seconds: float, ready: Barrier, report: Path
) -> None:
    """Ask at a steady rate for so long; a question that is late is asked at once."""
    said, done = texts(reader), Report(ms=[], cpu=[], errors=[])
    with closing(open_store(str(path), read_only=True)) as store:
        now = now_of(store)
        for text, _ in zip(said, range(10), strict=False):
            ask(store, text, now=now)
        ready.wait()
        begun = time.perf_counter()
        number = 0
        while (due := (number + reader / 8) / rate) < seconds:
            time.sleep(max(0.0, begun + due - time.perf_counter()))
            asked, worked = time.perf_counter(), time.process_time()
            answer = ask(store, next(said), now=now)
            done["cpu"].append((time.process_time() - worked) * 1000)
            done["ms"].append((time.perf_counter() - asked) * 1000)
            if answer.status == "error":
                done["errors"].append(str(answer.message))
            number += 1
    report.write_text(json.dumps(done))


def write(
    path: Path, writes: int, group: int, seconds: float, ready: Barrier, report: Path
) -> None:
    """Commit groups of operations at a steady rate for so long."""
    draw = np.random.default_rng(99)
    with closing(open_store(str(path))) as store:
        ids = [scaled.name_of(n) for n in range(100, 600)]
        known = {record.object_id: record for record in store.objects(ids=ids)}
        stays = store.stays(object_ids=ids)
        now = round(now_of(store).timestamp() * 1000)
        ready.wait()
        begun, commits = time.perf_counter(), list[float]()
        while (due := len(commits) * group / writes) < seconds:
            time.sleep(max(0.0, begun + due - time.perf_counter()))
            if time.perf_counter() - begun > seconds:
                break
            batch = _batch(known, stays, draw, group, now + len(commits) * group * 1000 // writes)
            asked = time.perf_counter()
            store.apply(batch)
            commits.append((time.perf_counter() - asked) * 1000)
        rate = len(commits) * group / (time.perf_counter() - begun)
    median, p95 = np.percentile(commits, [50, 95])
    report.write_text(json.dumps({"rate": rate, "commit": f"{median:.1f} / {p95:.1f} ms"}))


def _batch(
    known: dict[str, ObjectRecord],
    stays: list[StayRecord],
    draw: np.random.Generator,
    group: int,
    now: int,
) -> Batch:
    """Return sightings that are new or go on, each with its stay and its object as it is then."""
    chosen = [stays[int(k)] for k in draw.integers(0, len(stays), group)]
    box = (40.0, 200.0, 100.0, 290.0)
    start, frame = now - now % 300_000, f"f{now - scaled.T0}"
    sightings = [
        Sighting(s.object_id, s.place, start, now, frame, 0.9, box, None, 6, "", "made")
        for s in chosen
    ]
    records = {s.object_id: replace(known[s.object_id], last_ms=now) for s in chosen}
    return Batch(list(records.values()), [replace(s, last_ms=now) for s in chosen], sightings)


if __name__ == "__main__":
    main()
