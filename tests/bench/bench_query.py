"""Measure whole questions in process: parse, plan, execute, rank and reply.

    python -m tests.bench.bench_query [STORE] [--hours 3] [--rounds 5] [--seed 0]
        [--batch 10000] [--naive]

Without a store, a simulated world of so many hours is written and ingested first. Prints median
and 95th percentile in ms over all questions and rounds, the slowest questions, and how many
questions a second a batch answers. --naive fills a second store of the same world, in which every
detection is an object (the paper's Naive, with every index that ours has), and prints how much
longer retrieval and ranking of all keyframes take on it at the rung Category, beside how many
keyframes either tells; and what the same takes over one table of the detections by hand-written
SQL (`tests.bench.one_table`).
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from assistant.asking import ask, read_question, store_parameters
from assistant.batch import run
from assistant.evaluation.asking_stores import EVERYTHING, RETRIEVING
from assistant.lexicon import VocabularyLexicon
from d3a.answering.facts import Facts, forget
from d3a.baselines import fill_naive
from d3a.execute import execute
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.plan import Plan, plan
from d3a.readers.opening import open_source
from d3a.simulate import simulate
from d3a.store import open_store
from d3a.store.base import Store
from tests.bench import one_table
from tests.bench.bench_scale import now_of, say

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


COMPARED = (
    "Where is the cup?",
    "Did you see a red cup?",
    "Where did you last see the laptop?",
    "When did you first see the couch?",
    "Did you see a bowl between 9:30 and 10:30 this morning?",
    "Where was the bottle this morning?",
    "Did you see a cup with a bowl?",
    "When were the bottle and the cup seen together?",
)


def main() -> None:
    """Print the latencies."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("store", nargs="?")
    options.add_argument("--hours", type=float, default=3.0)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--batch", type=int, default=10_000, help="questions of the batch")
    options.add_argument("--naive", action="store_true")
    given = options.parse_args()
    if given.store is not None:
        with closing(open_store(given.store, create=False)) as store:
            measure(store, given.rounds, given.batch)
        return
    with tempfile.TemporaryDirectory() as folder:
        world = Path(folder) / "world"
        simulate(world, hours=given.hours, seed=given.seed, depth=False)
        with closing(open_store(str(Path(folder) / "world.db"))) as store:
            ingest(open_source(world), store, DEFAULT)
            measure(store, given.rounds, given.batch)
            if given.naive:
                with closing(open_store(str(Path(folder) / "naive.db"))) as naive:
                    fill_naive(open_source(world), naive)
                    against_naive(store, naive, given.rounds)
                    table = Path(folder) / "detections.db"
                    against_sql(store, naive, table, given.rounds)


def measure(store: Store, rounds: int, batch: int) -> None:
    """Ask every question so many times and print what it took."""
    counts = store.counts()
    say(
        f"store: {counts['objects']} objects, {counts['stays']} stays, "
        f"{counts['sightings']} sightings, {counts['encounters']} encounters"
    )
    now = now_of(store)
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
    lines = (QUESTIONS[number % len(QUESTIONS)] for number in range(batch))
    started, worked = time.perf_counter(), time.process_time()
    answered = sum(1 for _ in run(store, lines, now=now))
    seconds, cpu_s = time.perf_counter() - started, time.process_time() - worked
    say(
        f"batch of {answered}: {answered / seconds:.0f} questions/s, {answered / cpu_s:.0f} a "
        f"second of the processor  (goal 500); load average {os.getloadavg()[0]:.1f}"
    )


@dataclass(frozen=True)
class Retrieved:
    """Retrieval and ranking of one question: processor time in ms, keyframes that it told."""

    ms: float
    told: int


def against_naive(store: Store, naive: Store, rounds: int) -> None:
    """Print retrieval and ranking of all keyframes at the rung Category, on both stores.

    Beside it how many keyframes either tells: where all are told, the ratio cannot be much above
    that of their numbers, whatever a question costs that finds none.
    """
    counts = naive.counts()
    say(f"naive: {counts['objects']} objects, {counts['sightings']} sightings")
    now = now_of(store)
    for name, anew in (("read anew", True), ("kept from the question before", False)):
        pairs = [
            (_retrieved(store, q, now, rounds, anew), _retrieved(naive, q, now, rounds, anew))
            for q in COMPARED
        ]
        say(f"naive / ours at Category, {name}:")
        for question, (ours, theirs) in zip(COMPARED, pairs, strict=True):
            told = f"{ours.told} against {theirs.told}, {_ratio(ours.told, theirs.told)}"
            say(
                f"  {theirs.ms / ours.ms:6.1f} x  {ours.ms:6.2f} against {theirs.ms:7.2f} ms  "
                f"keyframes {told:26}  {question}"
            )
        ours_ms, theirs_ms = (sum(pair[k].ms for pair in pairs) for k in (0, 1))
        median = float(np.median([theirs.ms / ours.ms for ours, theirs in pairs]))
        known = [theirs.told / ours.told for ours, theirs in pairs if ours.told]
        say(
            f"  {median:6.1f} x is the median, {theirs_ms / ours_ms:.1f} x of the sums  (goal 20); "
            f"keyframes: {float(np.median(known)):.1f} x is the median"
        )
        each = [_each([pair[k] for pair in pairs]) for k in (0, 1)]
        say(f"           processor: ours {each[0]}, theirs {each[1]}")


def against_sql(store: Store, naive: Store, file: Path, rounds: int) -> None:
    """Print what all keyframes of the same questions take over one table of detections."""
    now, parameters = now_of(store), store_parameters(store)
    with closing(one_table.fill(file, naive)) as table:
        ratios, asked = [], []
        for question in COMPARED:
            query = read_question(store, question, now=now)
            spent, told = [], 0
            for _ in range(rounds + 1):
                worked = time.process_time()
                told = len(one_table.ask(table, query, now, parameters))
                spent.append((time.process_time() - worked) * 1000)
            asked.append(Retrieved(float(np.median(spent[1:])), told))
            ours = _retrieved(store, question, now, rounds, anew=False)
            ratios.append(asked[-1].ms / ours.ms)
    times = " ".join(f"{one.ms:.2f} ({one.told})" for one in asked)
    say(f"one table of detections, SQL by hand, ms (keyframes): {times}")
    say(f"  {float(np.median(ratios)):.1f} x ours is the median; processor: {_each(asked)}")


def _ratio(ours: int, theirs: int) -> str:
    return f"{theirs / ours:.1f} x" if ours else "-"


def _each(questions: list[Retrieved]) -> str:
    """Return what a keyframe costs, and what a question does beside, by least squares."""
    told = np.array([[one.told, 1.0] for one in questions])
    each, fixed = np.linalg.lstsq(told, np.array([one.ms for one in questions]), rcond=None)[0]
    return f"{each * 1000:.0f} us a keyframe and {max(fixed, 0.0):.2f} ms a question"


def _retrieved(store: Store, question: str, now: datetime, rounds: int, anew: bool) -> Retrieved:
    """Return the median of the steps that find and rank."""
    query = read_question(store, question, now=now)
    parameters = store_parameters(store)
    steps = plan(query, parameters=parameters, precision="category").steps
    kept = Plan(query, tuple(step for step in steps if isinstance(step, RETRIEVING)))
    spent, told = [], 0
    for _ in range(rounds + 1):
        if anew:
            forget()
        facts = Facts(store)
        worked = time.process_time()
        answer = execute(
            kept, store, VocabularyLexicon(), now=now, limit=EVERYTHING, parameters=parameters,
            facts=facts,
        )  # fmt: skip
        spent.append((time.process_time() - worked) * 1000)
        told = len(answer.keyframes)
    return Retrieved(float(np.median(spent[1:])), told)


if __name__ == "__main__":
    main()
