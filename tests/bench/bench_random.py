"""Press keys at random in the chat, ask and resize, and see that it stands and answers.

    python -m tests.bench.bench_random [--presses 10000] [--seed 1] [--each 500]

A chat is opened anew after --each presses, with the next seed. The first failure is shown as it
is, with the seed that leads to it; else the number of presses is printed.
"""

from __future__ import annotations

import argparse
import asyncio
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from tests.worlds.random_presses import press_at_random


def main() -> None:
    """Press and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--presses", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--each", type=int, default=500)
    given = parser.parse_args()
    done: Counter[str] = Counter()
    began, seed = time.perf_counter(), given.seed
    while (left := given.presses - sum(done.values())) > 0:
        with TemporaryDirectory() as folder:
            try:
                done += asyncio.run(press_at_random(seed, min(left, given.each), Path(folder)))
            except BaseException:
                click.echo(f"seed {seed} of {given.each} presses broke the chat", err=True)
                raise
        seed += 1
    spent_s = time.perf_counter() - began
    said = ", ".join(f"{count} {kind}" for kind, count in sorted(done.items()))
    click.echo(f"{sum(done.values())} at random ({said}), none broke the chat, {spent_s:.0f} s")


if __name__ == "__main__":
    main()
