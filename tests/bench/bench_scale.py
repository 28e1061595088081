"""Measure questions on large memories: 20 k, 200 k and a million stays, against the goals.

    python -m tests.bench.bench_scale [--places 20000 200000 1000000] [--cache DIR]
        [--categories 60] [--related 60] [--neighbours 20000] [--no-process]

Fills the drawn homes of `tests.worlds.scaled` (a million stays take minutes and 1.5 GB; --cache
keeps them) and asks every form of question about every category, through the whole path: parse,
plan, execute, rank, reply. Prints median, p95 and slowest in ms of the wall clock, median and p95
of the processor, keyframes told, how many answers were cut, and the growth from the smallest to
the largest store. Before a question another one about the same things is asked, of another time or
colour: that is a person's first of them, reads what is known of the things, and is told in a
column of its own. --neighbours also asks what one would use instead, see `tests.bench.neighbours`;
0 leaves it out.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import numpy as np

from assistant.asking import ask, store_now
from d3a.answering.facts import forget
from d3a.store import open_store
from d3a.store.base import Store
from tests.bench import processes
from tests.worlds import scaled

Form = Callable[[str, str], str]
FORMS: dict[str, Form] = {
    "Q1 colour": lambda a, b: f"Did you ever see a red {a}?",
    "Q1 whether": lambda a, b: f"Did you see a {a}?",
    "Q1 last": lambda a, b: f"Where did you last see the {a}?",
    "Q3 a day": lambda a, b: f"Where was the {a} yesterday?",
    "Q3 hours": lambda a, b: f"Did you see a {a} between 9 and 11 am yesterday?",
    "Q2 a day": lambda a, b: f"Did you see a {a} with a {b} yesterday?",
    "Q2 all time": lambda a, b: f"Did you see a {a} with a {b}?",
}
BEFORE: dict[str, Form] = {
    "Q1 colour": lambda a, b: f"Did you ever see a green {a}?",
    "Q1 whether": lambda a, b: f"When did you first see the {a}?",
    "Q1 last": lambda a, b: f"When did you first see the {a}?",
    "Q3 a day": lambda a, b: f"Where was the {a} two days ago?",
    "Q3 hours": lambda a, b: f"Did you see a {a} between 7 and 9 am yesterday?",
    "Q2 a day": lambda a, b: f"Did you see a {a} with a {b} two days ago?",
    "Q2 all time": lambda a, b: f"Did you see a {a} with a {b} two days ago?",
}
"""What is asked before of the same things, so that they are known but not the answer."""
GOALS: dict[tuple[str, int], str] = {
    **{(q, 200_000): "5 / 10" for q in FORMS if q[:2] in ("Q1", "Q3")},
    **{(q, 1_000_000): "- / 25" for q in FORMS if q[:2] in ("Q1", "Q3")},
    ("Q2 a day", 200_000): "- / 30",
    ("Q2 a day", 1_000_000): "- / 60",
    ("Q2 all time", 200_000): "- / 300",
}


@dataclass(frozen=True)
class Timed:
    """What a form of question took on one store, in ms; the processor's share, keyframes told.

    first: what the question before it took of the processor, the first about its things.
    """

    wall: list[float]
    cpu: list[float]
    first: list[float]
    told: list[int]
    truncated: int

    @property
    def median(self) -> float:
        return statistics.median(self.wall)

    @property
    def p95(self) -> float:
        return float(np.percentile(self.wall, 95))


def main() -> None:
    """Measure what the options say, and print it beside the goals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--places", type=int, nargs="+", default=[20_000, 200_000, 1_000_000])
    options.add_argument("--cache", type=Path, help="a folder that keeps the stores")
    options.add_argument("--categories", type=int, default=len(scaled.MOVABLE))
    options.add_argument("--related", type=int, default=60, help="questions a form of Q2")
    options.add_argument("--neighbours", type=int, default=20_000, metavar="PLACES")
    options.add_argument("--no-process", action="store_true")
    given = options.parse_args()
    measured: dict[int, dict[str, Timed]] = {}
    with folder_of(given.cache) as folder:
        for places in sorted(given.places):
            path = filled(folder, places)
            say(f"\n{places} stays, {path.stat().st_size / 1e6:.0f} MB; {load()}")
            with closing(open_store(str(path), read_only=True)) as store:
                measured[places] = forms(store, places, given.categories, given.related)
            if not given.no_process:
                whole_process(path)
        growth(measured)
        if given.neighbours:
            from tests.bench import neighbours

            neighbours.compare(folder, filled(folder, given.neighbours), given.neighbours)


@contextmanager
def folder_of(cache: Path | None) -> Iterator[Path]:
    """Yield the folder of the stores: a temporary one, or one that stays."""
    if cache is not None:
        cache.mkdir(parents=True, exist_ok=True)
        yield cache
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


def filled(folder: Path, places: int) -> Path:
    """Return the file of a drawn home, made where it is not there."""
    path = folder / f"home-{places}.db"
    if not path.exists():
        unfinished = folder / f"home-{places}.part"
        begun = time.perf_counter()
        with closing(open_store(str(unfinished))) as store:
            scaled.fill(store, places)
        unfinished.rename(path)
        say(f"filled {places} stays in {time.perf_counter() - begun:.0f} s")
    return path


def load() -> str:
    """Return how busy the machine is: the timings are of a shared one."""
    one, five, _ = os.getloadavg()
    return f"load average {one:.1f}, {five:.1f} on {os.cpu_count()} cores"


def now_of(store: Store) -> datetime:
    """Return the time of the store's newest frame."""
    if store.last_view_ms() is None:
        raise SystemExit("the store is empty: there is nothing to measure")
    return store_now(store, "last", partial(datetime.now, UTC))


def forms(store: Store, places: int, categories: int, related: int) -> dict[str, Timed]:
    """Ask every form and print a line each."""
    now = now_of(store)
    head = f"  {'':14}{'median / p95 / slowest ms':>28}{'processor':>18}{'first':>17}"
    say(head + f"{'told':>6}{'cut':>5}   goal (median / p95)   {load()}")
    timed = {}
    for name, form in FORMS.items():
        number = min(categories, related) if name.startswith("Q2") else categories
        timed[name] = asked(store, now, form, BEFORE[name], number)
        one = timed[name]
        numbers = f"{one.median:8.2f} / {one.p95:7.2f} / {max(one.wall):7.2f}"
        told = statistics.median(one.told)
        cpu, first = (
            f"{statistics.median(ms):7.2f} / {float(np.percentile(ms, 95)):.2f}"
            for ms in (one.cpu, one.first)
        )
        goal = GOALS.get((name, places), "")
        say(f"  {name:14}{numbers:>28}{cpu:>18}{first:>17}{told:6.0f}{one.truncated:5}   {goal}")
    return timed


def asked(store: Store, now: datetime, form: Form, before: Form, categories: int) -> Timed:
    """Ask a form about so many categories, the frequent and the rare ones alike."""
    forget()
    step = len(scaled.MOVABLE) / categories
    chosen = [scaled.MOVABLE[int(k * step)] for k in range(categories)]
    wall, cpu, first, told, cut = [], [], [], [], 0
    ask(store, form("thing", "thing"), now=now)  # colour terms, rooms, landmarks: known by then
    for number, category in enumerate(chosen):
        other = scaled.MOVABLE[(number * 7 + 3) % len(scaled.MOVABLE)]
        text = form(category, other)
        worked = time.process_time()
        ask(store, before(category, other), now=now)
        first.append((time.process_time() - worked) * 1000)
        begun, worked = time.perf_counter(), time.process_time()
        answer = ask(store, text, now=now)
        cpu.append((time.process_time() - worked) * 1000)
        wall.append((time.perf_counter() - begun) * 1000)
        told.append(len(answer.keyframes))
        cut += answer.truncated
        if answer.status not in ("found", "not_found", "unknown_object"):
            raise SystemExit(f"{text}: {answer.status}: {answer.answer}")
    return Timed(wall, cpu, first, told, cut)


def growth(measured: dict[int, dict[str, Timed]]) -> None:
    """Print how the medians grow from the smallest to the largest store."""
    small, large = min(measured), max(measured)
    if small == large:
        return
    say(
        f"\nmedian of {large} against {small} stays (goal 3 for Q1 and Q3), wall and processor, "
        "of the questions that have an answer in both"
    )
    for name in FORMS:
        before, after = measured[small][name], measured[large][name]
        both = [k for k, told in enumerate(before.told) if told and after.told[k]]
        wall = _grown(before.wall, after.wall, both)
        say(f"  {name:14}{wall:6.1f} x{_grown(before.cpu, after.cpu, both):6.1f} x")


def _grown(before: list[float], after: list[float], both: list[int]) -> float:
    """Return the ratio of the medians over some of the questions."""
    return statistics.median(after[k] for k in both) / statistics.median(before[k] for k in both)


ASK = """
import sys
from assistant.cli import main
try:
    main()
finally:
    with open("/proc/self/status") as status:
        sys.stderr.write(next(line for line in status if line.startswith("VmHWM")))
"""
"""`d3a`, which says at its end how much memory it held: a parent's would count in `ru_maxrss`."""


def whole_process(path: Path, times: int = 5) -> None:
    """Print what `d3a ask` takes as a process: seconds and memory.

    With the bytecode that pip makes when it installs, and without: of a checkout nobody may write.
    """
    with processes.with_bytecode() as kept:
        _run(path, kept, times, "d3a ask, whole process")
    bare = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    _run(path, bare, times, "the same, compiled each time")


def _run(path: Path, environment: Mapping[str, str], times: int, name: str) -> None:
    command = [sys.executable, "-c", ASK, "ask", "--store", str(path), "--now", "last"]
    command.append("Where is the cup?")
    processes.run(command, environment)  # fills what is kept: bytecode, the files' cache
    ended = [processes.run(command, environment) for _ in range(times)]
    if any(one.status for one in ended):
        raise SystemExit(f"d3a ask ended with {ended[-1].status}: {ended[-1].stderr}")
    wall = [one.wall_ms / 1000 for one in ended]
    most = max(int(one.stderr.rsplit("VmHWM:", 1)[1].split()[0]) for one in ended)
    say(
        f"  {name}: {statistics.median(wall):.2f} s, best {min(wall):.2f} s, "
        f"processor {min(one.processor_ms for one in ended) / 1000:.2f} s, {most / 1024:.0f} MB   "
        "(goal 0.4 s, 150 MB at 200 k)"
    )


def say(line: str) -> None:
    """Write a line of the report."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
