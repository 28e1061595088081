"""Measure how colours are told: of the demo home's rendered pictures, and of simulated worlds.

    python -m tests.bench.bench_colours [--seeds 0-4] [--world FOLDER ...]

FOLDER: a recording with truth.jsonl. For each world the things that are called by a basic colour:
how many are called so first, the mean log probability of the true colour, and what is said when
each category is asked for in each of the eleven colours: a yes, a doubt, or a flat no.
"""

from __future__ import annotations

import json
import tempfile
from collections import Counter, defaultdict
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from assistant.evaluation.commands import parse_seeds
from assistant.evaluation.tables import Table, as_text
from assistant.evaluation.worlds import World, recorded
from assistant.home import recording_folder
from d3a.answering.attributes import LEAST_DOUBTFUL
from d3a.answering.facts import Facts
from d3a.colours import BASIC, LEAST_ODDS
from d3a.ingest import ingest
from d3a.parameters import DEFAULT
from d3a.readers.opening import open_source
from d3a.store.opening import open_store
from d3a.truth import Truth, read_truth

PURE = 0.7
"""An object that is less of one thing has no one true colour."""
LIKELY = LEAST_ODDS / (1 + LEAST_ODDS)
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Called:
    """The confirmed objects of a store: categories (n), true colours (n), chances (n, 11)."""

    categories: list[str]
    true: NDArray[np.intp]
    chances: Floats


def called(folder: Path) -> Called:
    """Ingest a recording and judge the colours of what came of it."""
    truth = read_truth(folder)
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "assignments.jsonl"
        with closing(open_store(str(Path(scratch) / "store.db"))) as store:
            ingest(open_source(folder), store, DEFAULT, assignments=path)
            records = [record for record in store.objects() if not record.tentative]
            looks = Facts(store).looks(records)
        colours = true_colours(path, truth)
    assert looks is not None, "the recording has neither pictures nor histograms"
    chosen = [records[row] for row in looks.rows.tolist()]
    kept = [i for i, record in enumerate(chosen) if colours.get(record.object_id) in BASIC]
    return Called(
        [chosen[i].category for i in kept],
        np.array([BASIC.index(colours[chosen[i].object_id]) for i in kept], dtype=np.intp),
        np.stack([looks.of_rows.judge([term]).probability for term in BASIC], axis=1)[kept],
    )


def true_colours(assignments: Path, truth: Truth) -> dict[str, str]:
    """Return the colour of the thing that most of an object's detections show, by object id."""
    owners: dict[str, Counter[int]] = defaultdict(Counter)
    lines = assignments.read_text(encoding="utf-8").splitlines()
    for owner, line in zip(truth.owner.tolist(), lines, strict=True):
        if (name := json.loads(line)["object_id"]) is not None:
            owners[name][owner] += 1
    found = {name: counted.most_common(1)[0] for name, counted in owners.items()}
    return {
        name: truth.objects[owner].colour.replace("gray", "grey")
        for name, (owner, number) in found.items()
        if owner >= 0 and number >= PURE * owners[name].total()
    }


def row_of(title: str, seen: Called) -> tuple[str, ...]:
    own = seen.chances[np.arange(len(seen.true)), seen.true]
    said: dict[tuple[bool, str], int] = Counter()
    for category in set(seen.categories):
        rows = np.flatnonzero(np.array(seen.categories) == category)
        for term in range(len(BASIC)):
            best = seen.chances[rows, term].max()
            is_there = bool((seen.true[rows] == term).any())
            word = "yes" if best >= LIKELY else "doubt" if best >= LEAST_DOUBTFUL else "no"
            said[is_there, word] += 1
    first = (seen.chances.argmax(axis=1) == seen.true).mean()
    counts = [f"{said[there, word]:,}" for there in (True, False) for word in WORDS]
    return (title, f"{len(own)}", f"{first:.3f}", f"{np.log(own).mean():.3f}", *counts)


WORDS = ("yes", "doubt", "no")
HEAD = ("world", "objects", "called so first", "mean log p", *(f"there: {w}" for w in WORDS))


@click.command()
@click.option("--seeds", default="0-4", show_default=True)
@click.option("--world", "worlds", multiple=True, type=click.Path(exists=True, path_type=Path))
def main(seeds: str, worlds: tuple[Path, ...]) -> None:
    """Print how colours are told."""
    rows = [row_of("demo home", called(recording_folder()))]
    rows += [row_of(folder.name, called(folder)) for folder in worlds]
    with tempfile.TemporaryDirectory(prefix="d3a-bench-") as scratch:
        for seed in parse_seeds(seeds):
            source = recorded(World(seed), "nominal", Path(scratch))
            rows.append(row_of(f"seed {seed}", called(source.folder)))
    head = (*HEAD, *(f"not there: {word}" for word in WORDS))
    click.echo(as_text(Table("Colours", head, tuple(rows))))


if __name__ == "__main__":
    main()
