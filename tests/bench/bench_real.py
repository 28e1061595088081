"""Measure identity and places on real recordings, and what a kill leaves behind.

    python -m tests.bench.bench_real [--shared FOLDER] [--kills 50]

FOLDER holds data/kuri-sample and data/red-kitchen; D3A_SHARED names it too.
"""

from __future__ import annotations

import csv
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from d3a.ingest import ingest
from d3a.metrics import b_cubed
from d3a.parameters import PROFILES, Parameters
from d3a.readers.opening import open_source
from d3a.store.base import StayRecord, Store
from d3a.store.opening import open_store
from tests.worlds.oracle import OracleStore

NEAR_M = 0.2
"""How far off a stay may be from a true object to count as that object."""


@dataclass(frozen=True)
class Identity:
    """Ids against a truth: B-cubed, ids per true object, and ids that hold two objects or more."""

    f: float
    precision: float
    recall: float
    ids_per_object: float
    split: Mapping[str, list[str]]
    mixed: Mapping[str, list[str]]
    left_out: int


def kuri_truth(folder: Path) -> list[str | None]:
    """The true object of each row, with the corrections applied."""
    with (folder / "detections.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    owners = [row["gt_object_id"] or None for row in rows]
    with (folder / "gt-corrections.csv").open(encoding="utf-8") as lines:
        for fix in csv.DictReader(lines):
            (number,) = [
                n
                for n, row in enumerate(rows)
                if (row["frame"], row["category"]) == (fix["frame"], fix["category"])
                and round(float(row["x1"])) == int(fix["x1_rounded"])
            ]
            owners[number] = fix["corrected_object_id"]
    return owners


def kuri_identity(folder: Path, parameters: Parameters) -> Identity:
    """Ingest the sample and judge its ids."""
    owners = kuri_truth(folder)
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "assignments.jsonl"
        ingest(open_source(folder), OracleStore(), parameters, assignments=path)
        rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    names = sorted({owner for owner in owners if owner})
    index = [names.index(owner) if owner else -1 for owner in owners]
    stays = [None if r["object_id"] is None else (r["object_id"], r["place"]) for r in rows]
    score = b_cubed(index, stays)
    ids, objects = defaultdict(set), defaultdict(set)
    for owner, stay in zip(owners, stays, strict=True):
        if owner and stay:
            ids[owner].add(stay[0])
            objects[stay[0]].add(owner)
    return Identity(
        score.f,
        score.precision,
        score.recall,
        sum(map(len, ids.values())) / max(1, len(ids)),
        {owner: sorted(each) for owner, each in sorted(ids.items()) if len(each) > 1},
        {each: sorted(owned) for each, owned in sorted(objects.items()) if len(owned) > 1},
        stays.count(None),
    )


@dataclass(frozen=True)
class Found:
    """A true object of the kitchen: how far off the nearest stay is, how many stand for it."""

    name: str
    distance_m: float
    stays: int


def kitchen_objects(folder: Path, parameters: Parameters) -> tuple[list[Found], OracleStore]:
    """Ingest the sequence and look for its true objects among the stays of their category."""
    store = OracleStore()
    ingest(open_source(folder), store, parameters)
    categories = {record.object_id: record.category for record in store.objects()}
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))["objects"]
    found = []
    for true in truth:
        away = [
            distance(stay, true["position"])
            for stay in store.stays()
            if categories[stay.object_id] == true["category"]
        ]
        near = sum(metres <= NEAR_M for metres in away)
        found.append(Found(true["id"], min(away, default=float("inf")), near))
    return found, store


@dataclass(frozen=True)
class Surplus:
    """A confirmed stay of a measured category that is none of the measured objects."""

    object_id: str
    category: str
    position: tuple[float, ...]
    seen: int
    distance_m: float
    nearest: str


def kitchen_surplus(folder: Path, store: Store) -> list[Surplus]:
    """Return confirmed stays that are no measured object, by category and id.

    A room may hold more of a kind than was measured: how far the next measured one of the kind
    is, and how often each was seen, tells a second id for one thing from a thing of its own.
    """
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))["objects"]
    categories = {record.object_id: record.category for record in store.objects()}
    places = {each["id"]: (each["category"], each["position"]) for each in truth}
    taken: set[tuple[str, int]] = set()
    for category, position in places.values():
        of_kind = [s for s in confirmed_stays(store) if categories[s.object_id] == category]
        near = [(distance(s, position), s.key) for s in of_kind if s.key not in taken]
        if near and min(near)[0] <= NEAR_M:
            taken.add(min(near)[1])
    found = []
    for stay in confirmed_stays(store):
        category = categories[stay.object_id]
        away = [
            (distance(stay, at), name) for name, (kind, at) in places.items() if kind == category
        ]
        if away and stay.key not in taken and stay.position is not None:
            found.append(Surplus(stay.object_id, category, stay.position, stay.seen, *min(away)))
    return sorted(found, key=lambda each: (each.category, each.object_id))


def confirmed_stays(store: Store) -> list[StayRecord]:
    """Return the stays with a position that were seen twice or more."""
    return [s for s in store.stays() if not s.tentative and s.position is not None]


def distance(stay: StayRecord, position: list[float]) -> float:
    """Metres between a stay and a place."""
    assert stay.position is not None
    return float(np.linalg.norm(np.array(stay.position) - position))


CHILD = (
    "import sys; from pathlib import Path\n"
    "from d3a.ingest import ingest; from d3a.readers.opening import open_source\n"
    "from d3a.parameters import PROFILES; from d3a.store.opening import open_store\n"
    "p = PROFILES[sys.argv[3]].with_changes(checkpoint_frames=5, stm_capacity=20)\n"
    "ingest(open_source(Path(sys.argv[1])), open_store(sys.argv[2]), p)\n"
)


def kills(folder: Path, profile: str, count: int, seed: int = 0) -> tuple[int, int]:
    """SIGKILL a real process so many times; return how many struck, and how many stores differ."""
    rng = random.Random(seed)
    parameters = PROFILES[profile].with_changes(checkpoint_frames=5, stm_capacity=20)
    whole = OracleStore()
    ingest(open_source(folder), whole, parameters)
    wanted = list(whole.dump())
    struck = differing = 0
    with tempfile.TemporaryDirectory() as scratch:
        usual_s = _timed(folder, f"sqlite:///{scratch}/first.db", profile)
        for number in range(count):
            uri = f"sqlite:///{scratch}/{number}.db"
            child = _started(folder, uri, profile)
            try:
                child.wait(timeout=rng.uniform(0.3, 1.0) * usual_s)
            except subprocess.TimeoutExpired:
                child.send_signal(signal.SIGKILL)
                child.wait()
                struck += 1
            store: Store = open_store(uri)
            ingest(open_source(folder), store, parameters)
            differing += list(store.dump()) != wanted or store.check() != []
            store.close()
    return struck, differing


def _started(folder: Path, uri: str, profile: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", CHILD, str(folder), uri, profile])


def _timed(folder: Path, uri: str, profile: str) -> float:
    start = time.perf_counter()
    _started(folder, uri, profile).wait()
    return time.perf_counter() - start


@click.command()
@click.option("--shared", envvar="D3A_SHARED", required=True, type=click.Path(path_type=Path))
@click.option("--kills", "kill_count", default=50, show_default=True)
def main(shared: Path, kill_count: int) -> None:
    """Print ids against the truth, objects against theirs, and what kills changed."""
    data = shared / "data"
    for name, parameters in PROFILES.items():
        judged = kuri_identity(data / "kuri-sample", parameters)
        click.echo(
            f"kuri {name}: B-cubed {judged.f:.3f} (precision {judged.precision:.2f}, recall "
            f"{judged.recall:.2f}), ids per object {judged.ids_per_object:.2f}, left out "
            f"{judged.left_out}\n  split {dict(judged.split)}\n  mixed {dict(judged.mixed)}"
        )
        found, store = kitchen_objects(data / "red-kitchen", parameters)
        counts = store.counts()
        click.echo(f"red-kitchen {name}: {counts['objects']} objects, {counts['stays']} places")
        for each in found:
            click.echo(f"  {each.name:<18} {each.distance_m:5.2f} m off, {each.stays} stay(s)")
        for extra in kitchen_surplus(data / "red-kitchen", store):
            at = ", ".join(f"{value:.2f}" for value in extra.position)
            click.echo(
                f"  surplus {extra.category} {extra.object_id} at ({at}), seen {extra.seen} x, "
                f"{extra.distance_m:.2f} m from {extra.nearest}"
            )
        if kill_count:
            struck, differing = kills(data / "red-kitchen", name, kill_count)
            click.echo(f"  {kill_count} runs, {struck} killed, {differing} stores differ")


if __name__ == "__main__":
    main()
