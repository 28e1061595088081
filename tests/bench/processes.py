"""Time whole processes: wall clock and processor, with and without the bytecode that pip keeps.

An installed package has its bytecode beside it; a checkout under PYTHONDONTWRITEBYTECODE compiles
every module again in every process, which can cost as much as all the rest. Both are told apart.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import TemporaryDirectory


@dataclass(frozen=True)
class Ended:
    """A process that ended: its time in ms by the wall clock and of the processor, its output."""

    wall_ms: float
    processor_ms: float
    status: int
    stdout: str
    stderr: str


def run(command: Sequence[str], environment: Mapping[str, str]) -> Ended:
    """Run a command to its end."""
    before, began = _processor_s(), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    wall_s, processor_s = time.perf_counter() - began, _processor_s() - before
    return Ended(wall_s * 1000, processor_s * 1000, done.returncode, done.stdout, done.stderr)


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def without_bytecode() -> dict[str, str]:
    """Return an environment in which every module of the project is compiled anew."""
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}


@contextmanager
def with_bytecode() -> Iterator[dict[str, str]]:
    """Yield an environment that keeps bytecode in a folder of its own, empty at first.

    The first process fills it: leave it out of the measurement.
    """
    with TemporaryDirectory() as folder:
        environment = {**os.environ, "PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        yield environment


def summary(values_ms: Sequence[float]) -> str:
    """Return median and best for a report."""
    return f"median {statistics.median(values_ms):.0f} best {min(values_ms):.0f} ms"
