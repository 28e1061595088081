"""Measure whole questions in process: parse, plan, execute, rank and reply.

    python -m tests.bench.bench_query [STORE] [--hours 3] [--rounds 5] [--seed 0]

Without a store, a simulated world of so many hours is written and ingested first. Prints median
and 95th percentile in ms over all questions and rounds, the slowest questions, and how many
questions a second a batch answers.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from datetime import datetime
from pathlib import Path

import numpy as np

from assistant.asking import ask, store_now
from assistant.batch import run
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.simulate import simulate
from d3a.store import open_store
from d3a.store.base import Store

QUESTIONS = (
    "Where is the cup?",
    "Did you see a red cup?",
    "Did you ever see a dark blue bottle?",
    "Where did you last see the laptop?",
    "When did you first see the couch?",
    "How many chairs did you see?",
    "How often did you see the tv?",
    "Did you see an elephant?",
    "Did you see a bowl between 9:30 and 10:30 this morning?",
    "Where was the cup an hour ago?",
    "Where is the mug that is not white?",
    "Where is the cup next to the microwave?",
    "Did you see a cup with a bowl?",
    "When were the bottle and the cup seen together?",
    "Is there a cup on the table?",
    "What is on the dining table?",
    "What did you see today?",
    "What moved today?",
    "Is anything missing?",
    "Where does the laptop usually lie?",
)


def main() -> None:
    """Print the latencies."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("store", nargs="?")
    options.add_argument("--hours", type=float, default=3.0)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args()
    with _store(given.store, given.hours, given.seed) as store:
        measure(store, given.rounds)


@contextmanager
def _store(uri: str | None, hours: float, seed: int) -> Iterator[Store]:
    if uri is not None:
        with closing(open_store(uri, create=False)) as store:
            yield store
        return
    with tempfile.TemporaryDirectory() as folder:
        world = Path(folder) / "world"
        simulate(world, hours=hours, seed=seed, depth=False)
        with closing(open_store(str(Path(folder) / "world.db"))) as store:
            ingest(open_source(world), store, DEFAULT)
            yield store


def measure(store: Store, rounds: int) -> None:
    """Ask every question so many times and print what it took."""
    counts = store.counts()
    say(
        f"store: {counts['objects']} objects, {counts['stays']} stays, "
        f"{counts['sightings']} sightings, {counts['encounters']} encounters"
    )
    now = store_now(store, "last", _no_clock)
    cold = ask(store, QUESTIONS[1], now=now).elapsed_ms["total"]
    say(f"first question of the process: {cold:.1f} ms")
    spent: dict[str, list[float]] = {question: [] for question in QUESTIONS}
    cpu: list[float] = []
    for question in QUESTIONS:  # once unmeasured: lexer tables, colour terms
        ask(store, question, now=now)
    for _ in range(rounds):
        for question in QUESTIONS:
            started, worked = time.perf_counter(), time.process_time()
            answer = ask(store, question, now=now)
            cpu.append((time.process_time() - worked) * 1000)
            spent[question].append((time.perf_counter() - started) * 1000)
            if answer.status == "error":
                raise SystemExit(f"{question}: {answer.message}")
    every = np.concatenate([np.array(times) for times in spent.values()])
    median, p95 = np.percentile(every, [50, 95])
    say(f"whole question: median {median:.2f} ms, p95 {p95:.2f} ms  (goal 2 / 5)")
    median, p95 = np.percentile(cpu, [50, 95])
    say(f"of the processor alone: median {median:.2f} ms, p95 {p95:.2f} ms")
    for question, times in sorted(spent.items(), key=lambda item: -float(np.median(item[1]))):
        say(f"  {np.median(times):7.2f} ms  {question}")
    started = time.perf_counter()
    answered = sum(1 for _ in run(store, list(QUESTIONS) * 10, now=now))
    say(f"batch: {answered / (time.perf_counter() - started):.0f} questions/s  (goal 500)")


def _no_clock() -> datetime:
    raise SystemExit("the store is empty: there is nothing to measure")


def say(line: str) -> None:
    """Write a line of the report."""
    sys.stdout.write(line + "\n")


if __name__ == "__main__":
    main()
