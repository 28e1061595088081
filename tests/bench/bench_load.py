"""Measure readers beside a writer: the same questions with and without an ingest that writes.

    python -m tests.bench.bench_load [--places 200000] [--cache DIR] [--readers 8]
        [--rate 5] [--writes 1000] [--group 50] [--rounds 5] [--seconds 10]

Each reader is a process with the store opened for reading, which asks so many questions a second
at times of its own, through all rounds. A round is so many seconds without and then with the
writer, a process of its own that is told to write and to rest: what else the machine does meets
both alike. One operation extends or adds a sighting with its stay and its object, so many a
commit, as many a second as asked for. Prints p50, p95 and the slowest of the readers in ms of the
wall clock, waiting for a processor included, p50 and p95 of the processor, errors, what the writer
reached, and how p95 beside the writer stands to p95 without: in each round, their median, and of
all rounds together. The home is copied first: it is not the cached one that is written to.
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
from dataclasses import dataclass, replace
from multiprocessing.synchronize import Barrier
from pathlib import Path
from typing import NamedTuple, TypedDict

import numpy as np

from assistant.asking import ask
from d3a.store import open_store
from d3a.store.base import Batch, ObjectRecord, Sighting, StayRecord
from tests.bench.bench_scale import FORMS, filled, folder_of, load, now_of, say
from tests.worlds import scaled

CONTEXT = multiprocessing.get_context("spawn")
ASKED = tuple(name for name in FORMS if name != "Q2 all time")


QUIET, WRITING = 0, 1


@dataclass(frozen=True)
class Schedule:
    """Rounds of two turns, the writer's second; a question belongs to the turn it is due in."""

    rounds: int
    seconds: float

    @property
    def whole(self) -> float:
        return 2 * self.rounds * self.seconds

    def turn(self, at: float) -> tuple[int, int]:
        """Return the round and whether the writer writes, so many seconds after the begin."""
        number = min(int(at / self.seconds), 2 * self.rounds - 1)
        return divmod(number, 2)

    def begins(self, number: int, kind: int) -> float:
        return (2 * number + kind) * self.seconds


class Asked(NamedTuple):
    """One question: its round, QUIET or WRITING, ms of the wall clock and of the processor."""

    number: int
    kind: int
    wall: float
    cpu: float


class Report(TypedDict):
    """What a reader writes at its end."""

    asked: list[Asked]
    errors: list[str]


def main() -> None:
    """Run the readers through all rounds and print what they took."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--places", type=int, default=200_000)
    options.add_argument("--cache", type=Path, help="a folder that keeps the store")
    options.add_argument("--readers", type=int, default=8)
    options.add_argument("--rate", type=float, default=5.0, help="questions a second of each")
    options.add_argument("--writes", type=int, default=1_000, help="operations a second")
    options.add_argument("--group", type=int, default=50, help="operations a commit")
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--seconds", type=float, default=10.0, help="of either half of a round")
    given = options.parse_args()
    with folder_of(given.cache) as kept, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "home.db"
        shutil.copy(filled(kept, given.places), path)
        say(
            f"{given.places} stays; {given.readers} readers, {given.rate:g} questions a second "
            f"each; writer {given.writes} operations/s, {given.group} a commit; {given.rounds} "
            f"rounds of twice {given.seconds:g} s; {load()}"
        )
        tell(run(path, given))
        with closing(open_store(str(path))) as store:
            say(f"check: {store.check() or 'sound'}; {load()}")


def run(path: Path, given: argparse.Namespace) -> list[Asked]:
    """Run readers and writer through all rounds; print errors and the writer, return the rest."""
    plan = Schedule(given.rounds, given.seconds)
    ready = CONTEXT.Barrier(given.readers + 1)
    reports = [path.with_name(f"reader-{k}.json") for k in range(given.readers)]
    processes = [
        CONTEXT.Process(target=read, args=(path, k, given.rate, plan, ready, report))
        for k, report in enumerate(reports)
    ]
    told = path.with_name("writer.json")
    wanted = (path, given.writes, given.group, plan, ready, told)
    processes.append(CONTEXT.Process(target=write, args=wanted))
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    if any(process.exitcode for process in processes):
        raise SystemExit("a process ended with an error")
    found: list[Report] = [json.loads(report.read_text()) for report in reports]
    errors = [error for report in found for error in report["errors"]]
    wrote = json.loads(told.read_text())
    say(f"  writer: {wrote['rate']:.0f} operations/s, commit {wrote['commit']}")
    say(f"  {len(errors)} errors")
    for error in sorted(set(errors)):
        say(f"    {error}")
    return [Asked(*one) for report in found for one in report["asked"]]


def tell(asked: list[Asked]) -> None:
    """Print a line a round, and the ratios."""
    head = f"{'without: p50 / p95 / slowest':>32}{'beside the writer':>28}"
    say(f"  round{head}   p95 ratio   processor")
    walls, cpus = list[float](), list[float]()
    for number in sorted({one.number for one in asked}):
        wall, cpu = _line(str(number + 1), [one for one in asked if one.number == number])
        walls.append(wall)
        cpus.append(cpu)
    _line("all", asked)
    say(
        f"p95 beside the writer / without, median of the rounds: {np.median(walls):.2f} by the "
        f"wall clock, {np.median(cpus):.2f} by the processor  (goal 3)"
    )


def _line(name: str, asked: list[Asked]) -> tuple[float, float]:
    """Print p50, p95 and slowest of both kinds; return the ratios of p95, wall and processor."""
    texts, p95s, cpus = list[str](), list[float](), list[float]()
    for kind in (QUIET, WRITING):
        wall = np.array([one.wall for one in asked if one.kind == kind])
        median, p95 = np.percentile(wall, [50, 95])
        texts.append(f"{median:.1f} / {p95:.1f} / {wall.max():.1f}")
        p95s.append(float(p95))
        cpus.append(float(np.percentile([one.cpu for one in asked if one.kind == kind], 95)))
    ratio, worked = p95s[1] / p95s[0], cpus[1] / cpus[0]
    say(
        f"  {name:5}{texts[0]:>32}{texts[1]:>28}{ratio:9.2f} x"
        f"{cpus[0]:8.1f} -> {cpus[1]:.1f}, {worked:.2f} x"
    )
    return ratio, worked


def texts(reader: int) -> Iterator[str]:
    """Yield questions without end, every reader others: all forms but Q2 of all time."""
    draw = np.random.default_rng(reader)
    while True:
        a, b = draw.choice(scaled.MOVABLE, 2, replace=False).tolist()
        yield FORMS[ASKED[int(draw.integers(len(ASKED)))]](a, b)


def read(
    path: Path, reader: int, rate: float, plan: Schedule, ready: Barrier, report: Path
) -> None:
    """Ask at a steady rate through all rounds; a question that is late is asked at once."""
    said, done = texts(reader), Report(asked=[], errors=[])
    with closing(open_store(str(path), read_only=True)) as store:
        now = now_of(store)
        for text, _ in zip(said, range(10), strict=False):
            ask(store, text, now=now)
        ready.wait()
        begun = time.perf_counter()
        number = 0
        while (due := (number + reader / 8) / rate) < plan.whole:
            time.sleep(max(0.0, begun + due - time.perf_counter()))
            asked, worked = time.perf_counter(), time.process_time()
            answer = ask(store, next(said), now=now)
            cpu = (time.process_time() - worked) * 1000
            wall = (time.perf_counter() - asked) * 1000
            done["asked"].append(Asked(*plan.turn(due), wall, cpu))
            if answer.status == "error":
                done["errors"].append(str(answer.message))
            number += 1
    report.write_text(json.dumps(done))


def write(
    path: Path, writes: int, group: int, plan: Schedule, ready: Barrier, report: Path
) -> None:
    """Commit groups of operations at a steady rate in the second half of every round."""
    draw = np.random.default_rng(99)
    with closing(open_store(str(path))) as store:
        ids = [scaled.name_of(n) for n in range(100, 600)]
        known = {record.object_id: record for record in store.objects(ids=ids)}
        stays = store.stays(object_ids=ids)
        now = round(now_of(store).timestamp() * 1000)
        ready.wait()
        begun, commits, written_s = time.perf_counter(), list[float](), 0.0
        for number in range(plan.rounds):
            turn = begun + plan.begins(number, WRITING)
            time.sleep(max(0.0, turn - time.perf_counter()))
            first, end = len(commits), turn + plan.seconds
            while (due := turn + (len(commits) - first) * group / writes) < end:
                time.sleep(max(0.0, due - time.perf_counter()))
                asked = time.perf_counter()
                if asked > end:
                    break
                at = now + len(commits) * group * 1000 // writes
                store.apply(_batch(known, stays, draw, group, at))
                commits.append((time.perf_counter() - asked) * 1000)
            written_s += max(end, time.perf_counter()) - turn
    median, p95 = np.percentile(commits, [50, 95])
    rate = len(commits) * group / written_s
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
