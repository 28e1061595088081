"""Measure the embedded store: latencies, group commit, kills.

    python -m tests.bench.bench_store [--places 20000] [--kills 20]

Prints p50 / p95 in ms. One operation of the write rate is an extended sighting with its stay and
its object; `--places 200000` takes about a minute to fill.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np

from d3a.store import open_store
from d3a.store.base import Area, Batch, ObjectRecord, Sighting, StayRecord, Store
from tests.bench.bench_scale import say
from tests.worlds.victims import kill_loop

T0 = 1_582_178_400_000
DAY_MS = 86_400_000
CATEGORIES = 60
PLACES_A_DAY = 5_000
BOX = (10.0, 20.0, 110.0, 220.0)
VIEWER = (1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def main() -> None:
    """Fill a store, ask it, write to it, kill its writers; print what was measured."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--places", type=int, default=20_000)
    options.add_argument("--kills", type=int, default=20)
    options.add_argument("--seconds", type=float, default=5.0, help="of each write rate")
    asked = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.db"
        say(f"places {asked.places}, sightings {2 * asked.places}, SQLite, synchronous=FULL")
        with closing(open_store(str(path))) as store:
            begun = time.perf_counter()
            for batch in world(asked.places):
                store.apply(batch)
            size_mb = store.counts()["bytes"] / 1e6
            say(f"  fill                {time.perf_counter() - begun:8.1f} s, {size_mb:.0f} MB")
            latencies(store, path, asked.places)
            for group in (1, 50, 100):
                write_rate(store, asked.places, group, asked.seconds)
            say(f"  check               {store.check() or 'sound'}")
        report = kill_loop(str(Path(folder) / "killed.db"), Path(folder), asked.kills)
        say(
            f"  kill -9             {report.kills} kills, {report.acknowledged} acknowledged "
            f"batches, {report.lost} lost, damage: {', '.join(report.damaged) or 'none'}"
        )


def span_ms(places: int) -> int:
    """Return how long the drawn world lasts: 4 days of 20 k places, 40 of 200 k."""
    return max(4, places // PLACES_A_DAY) * DAY_MS


def world(places: int, at_once: int = 1000) -> Iterator[Batch]:
    """Yield a drawn store: an object has 40 places, a place two sightings, categories are Zipf."""
    draw = np.random.default_rng(0)
    objects = max(1, places // 40)
    weights = 1 / np.arange(1, CATEGORIES + 1)
    categories = draw.choice(CATEGORIES, objects, p=weights / weights.sum())
    for begin in range(0, objects, at_once // 40):
        some = range(begin, min(objects, begin + at_once // 40))
        records, stays, sightings = [], [], []
        for number in some:
            name = f"o{number:06}"
            embedding = draw.random(512, dtype=np.float32)
            records.append(
                ObjectRecord(
                    name, f"c{categories[number]:02}", 1.0, T0, T0 + span_ms(places),
                    embedding=embedding / np.linalg.norm(embedding), embedding_model="bench",
                )
            )  # fmt: skip
            for place in range(40):
                starts = np.sort(draw.integers(0, span_ms(places), 2)) + T0
                ends = starts + draw.integers(0, 300_000, 2)
                x, y, z = draw.random(3) * (40, 20, 2)
                first, last = int(starts[0]), int(ends.max())
                stays.append(StayRecord(name, place, (x, y, z), first, last, 1.0))
                sightings += [
                    Sighting(name, place, int(s), int(e), f"frame{s}", 0.9, BOX, viewer=VIEWER)
                    for s, e in zip(starts, ends, strict=True)
                ]
        yield Batch(records, stays, sightings)


def timed(name: str, ask: Callable[[int], int], times: int = 200) -> None:
    """Print p50 and p95 of a question over drawn arguments, and its median rows."""
    taken, rows = [], []
    for number in range(times):
        begun = time.perf_counter()
        rows.append(ask(number))
        taken.append((time.perf_counter() - begun) * 1000)
    p95 = statistics.quantiles(taken, n=20)[-1]
    middle = statistics.median(taken)
    say(f"  {name:20}{middle:8.2f} / {p95:.2f} ms, {statistics.median(rows):.0f} rows")


def latencies(store: Store, path: Path, places: int) -> None:
    draw = np.random.default_rng(1)
    objects = max(1, places // 40)

    def names(count: int) -> list[str]:
        return [f"o{n:06}" for n in draw.integers(0, objects, count)]

    def within_a_day(
        object_ids: list[str] | None = None, area: Area | None = None
    ) -> list[Sighting]:
        start = T0 + int(draw.integers(0, span_ms(places) - DAY_MS))
        return store.sightings(
            object_ids=object_ids, area=area, start_ms=start, end_ms=start + DAY_MS
        )

    def box() -> Area:
        x, y = draw.random() * 38, draw.random() * 18
        return Area(x, y, x + 2, y + 2)

    def category() -> list[str]:
        return [f"c{draw.integers(0, CATEGORIES):02}"]

    def opened() -> int:
        open_store(str(path), read_only=True).close()
        return 0

    timed("open", lambda _: opened())
    timed("category", lambda _: len(store.objects(categories=category())))
    timed("1 id, 24 h", lambda _: len(within_a_day(names(1))))
    timed("20 ids, 24 h", lambda _: len(within_a_day(names(20))))
    timed("20 ids, all time", lambda _: len(store.sightings(object_ids=names(20))))
    timed("box, 24 h", lambda _: len(within_a_day(area=box())))
    timed("box, all time", lambda _: len(store.sightings(area=box())))
    timed("stays in a box", lambda _: len(store.stays(area=box())))
    timed("last seen, 1 id", lambda _: len(store.edges(names(1), "last")))
    day_1 = T0 + DAY_MS
    timed("last before, 20 ids", lambda _: len(store.edges(names(20), "last", before_ms=day_1)))
    timed("embeddings", lambda _: len(store.embeddings()[0]), times=20)


def write_rate(store: Store, places: int, group: int, seconds: float) -> None:
    """Print operations per second and p50 / p95 of a commit of `group` operations."""
    draw = np.random.default_rng(group)
    known = store.objects(ids=[f"o{n:06}" for n in range(min(500, max(1, places // 40)))])
    now = T0 + span_ms(places)
    taken, begun = [], time.perf_counter()
    while time.perf_counter() - begun < seconds:
        records, stays, sightings = [], [], []
        for place in draw.integers(0, 40, group):
            record = known[draw.integers(0, len(known))]
            now += 1000
            records.append(replace(record, last_ms=now))
            x, y = draw.random(2) * (40, 20)
            stays.append(StayRecord(record.object_id, int(place), (x, y, 0.0), T0, now, 1.0))
            start = now - now % 300_000
            sightings.append(
                Sighting(record.object_id, int(place), start, now, "frame", 0.9, BOX, viewer=VIEWER)
            )
        commit = time.perf_counter()
        store.apply(Batch(records, stays, sightings))
        taken.append((time.perf_counter() - commit) * 1000)
    rate = group * len(taken) / (time.perf_counter() - begun)
    p95 = statistics.quantiles(taken, n=20)[-1]
    middle = statistics.median(taken)
    say(f"  {group:4} a commit       {rate:8.0f}/s, commit {middle:.1f} / {p95:.1f} ms")


if __name__ == "__main__":
    main()
