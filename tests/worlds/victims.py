"""Writers that are killed with SIGKILL, and what must be true of the store afterwards."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import random
import signal
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from pathlib import Path

from pymongo.monitoring import (
    CommandFailedEvent,
    CommandListener,
    CommandStartedEvent,
    CommandSucceededEvent,
)

from d3a.store import open_store
from d3a.store.base import Batch, Encounter, Keyframe, ObjectRecord, Sighting, StayRecord
from d3a.store.mongo_server import open_mongo

SIGHTINGS_A_BATCH = 3
T0 = 1_582_178_400_000
BOX = (0.0, 0.0, 1.0, 1.0)
_forkserver = multiprocessing.get_context("forkserver")
_forkserver.set_forkserver_preload(["tests.worlds.victims"])


def numbered_batch(number: int) -> Batch:
    """Batch `number` of an endless history: a new object, its stay, sightings, a number in meta."""
    name = f"o{number:06}"
    start = T0 + number * 1000
    return Batch(
        objects=[ObjectRecord(name, "cup", 1.0, start, start + 900)],
        stays=[StayRecord(name, 0, (number % 50 / 3, 1.0, 0.0), start, start + 900, 1.0)],
        sightings=[
            Sighting(name, 0, start + n, start + 900, f"f{n}", 0.5, BOX, f"p{number}")
            for n in range(SIGHTINGS_A_BATCH)
        ],
        keyframes=[Keyframe(f"p{number}", b"jpeg", 1, 1, start)],
        meta={"number": number},
        state=b"%d" % number,
    )


def write_until_killed(uri: str, acknowledged: str) -> None:
    """Apply one batch after the other, and note each in a file when `apply` has returned."""
    store = open_store(uri)
    first = store.meta("number")
    notes = os.open(acknowledged, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for number in range(0 if first is None else first + 1, 10**6):
        store.apply(numbered_batch(number))
        os.write(notes, b"%d\n" % number)


@contextlib.contextmanager
def writer_at_work(uri: str, acknowledged: Path) -> Iterator[BaseProcess]:
    """Run `write_until_killed` in another process, from its first batch on; kill it at the end."""
    acknowledged.unlink(missing_ok=True)
    process = _forkserver.Process(target=write_until_killed, args=(uri, str(acknowledged)))
    process.start()
    try:
        given_up = time.monotonic() + 30
        while not acknowledged.exists() or acknowledged.stat().st_size == 0:
            if process.exitcode is not None or time.monotonic() > given_up:
                raise RuntimeError(f"the writer wrote nothing, exit code {process.exitcode}")
            time.sleep(0.002)
        yield process
    finally:
        process.kill()
        process.join()
        process.close()


@dataclass(frozen=True, slots=True)
class KillReport:
    """What a loop of kills has seen; lost: acknowledged and not found again."""

    kills: int
    acknowledged: int
    lost: int
    damaged: tuple[str, ...]


def kill_loop(uri: str, folder: Path, kills: int, seed: int = 0) -> KillReport:
    """Kill a writer so many times at a drawn moment, and look at the store after each."""
    moments = random.Random(seed)
    notes = folder / "acknowledged.txt"
    total, lost, damaged = 0, 0, list[str]()
    for _ in range(kills):
        with writer_at_work(uri, notes):
            time.sleep(moments.uniform(0.0, 0.15))
        numbers = [int(line) for line in notes.read_text().splitlines()]
        total += len(numbers)
        with closing(open_store(uri)) as store:
            newest = store.meta("number")
            assert isinstance(newest, int)  # the writer has noted one batch at least
            lost += sum(number > newest for number in numbers)
            whole = newest + 1
            wanted = {"objects": whole, "stays": whole, "sightings": whole * SIGHTINGS_A_BATCH}
            counts = store.counts()
            damaged += [f"{k}: {counts[k]} not {n}" for k, n in wanted.items() if counts[k] != n]
            damaged += store.check()
            if store.state() != b"%d" % newest:
                damaged.append("the checkpoint is of another batch")
    return KillReport(kills, total, lost, tuple(damaged))


class Killer(CommandListener):
    """Ends this process just before its nth command that writes is sent."""

    def __init__(self, nth: int) -> None:
        self._left = nth

    def started(self, event: CommandStartedEvent) -> None:
        if event.command_name in {"insert", "update", "delete"}:
            self._left -= 1
            if self._left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    def succeeded(self, event: CommandSucceededEvent) -> None:
        pass

    def failed(self, event: CommandFailedEvent) -> None:
        pass


def before_batch() -> Batch:
    """What is in the store when the batch of `after_batch` is cut."""
    names = ["a", "b", "c"]
    return Batch(
        [ObjectRecord(name, "cup", 1.0, T0, T0 + 9) for name in names],
        [StayRecord(name, 0, (1.0, 1.0, 0.0), T0, T0 + 9, 1.0) for name in names],
        [Sighting(name, 0, T0 + n, T0 + 9, "f", 0.5, BOX) for name in names for n in range(3)],
        [Encounter("a", "b", 0, 0, T0, T0 + 9, "f", BOX, BOX, 0.5)],
        meta={"old": 1},
        state=b"old",
    )


def after_batch() -> Batch:
    """A batch with every kind of step: removals of each kind, puts, growth, pictures, state."""
    return Batch(
        [ObjectRecord("a", "bowl", 2.0, T0, T0 + 50), ObjectRecord("d", "cup", 1.0, T0, T0)],
        [
            StayRecord("a", 0, (5.0, 5.0, 0.0), T0, T0 + 50, 2.0),
            StayRecord("d", 1, None, T0, T0, 1),
        ],
        [
            Sighting("a", 0, T0, T0 + 50, "g", 0.9, BOX, "p"),
            Sighting("a", 0, T0 + 20, T0 + 50, "g", 0.9, BOX, "p"),
            Sighting("d", 1, T0, T0, "g", 0.9, BOX),
        ],
        [Encounter("a", "d", 0, 1, T0, T0, "g", BOX, BOX, 0.5)],
        keyframes=[Keyframe("p", b"jpeg", 1, 1, T0)],
        removed_objects=["b"],
        removed_stays=[("c", 0)],
        removed_sightings=[("a", 0, T0 + 2)],
        meta={"old": None, "new": [1]},
        state=b"new",
    )


def apply_and_die(uri: str, nth: int) -> None:
    """Open the store, apply `after_batch`, and die before the nth command that writes."""
    open_mongo(uri, uri, listeners=[Killer(nth)]).apply(after_batch())


def run_victim(uri: str, nth: int) -> int:
    """Run `apply_and_die` in another process and return its exit code, -9 when it was killed."""
    process = _forkserver.Process(target=apply_and_die, args=(uri, nth))
    process.start()
    process.join(30)
    code = process.exitcode
    process.close()
    return -1 if code is None else code
