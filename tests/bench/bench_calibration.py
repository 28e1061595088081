"""Measure how reliable scores are: how often is right what is told with a probability?

    python -m tests.bench.bench_calibration [--seeds dev|validation|0,3-5] [--refit]

Prints, per kind of question, the answers by score with the share that was right, and the expected
calibration error. --refit writes d3a/answering/calibration.json anew from these worlds: development
seeds alone may be named with it.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

import click
import numpy as np

from assistant.evaluation.calibrating import Teller, Told
from assistant.evaluation.commands import parse_seeds
from assistant.evaluation.methods import OURS, filled
from assistant.evaluation.questions import draw
from assistant.evaluation.tables import Table, as_text
from assistant.evaluation.worlds import VALIDATION, World, recorded
from d3a.answering.calibration import KINDS, Kind, expected_error, fitted

CONDITIONS = ("nominal", "colour-x2", "confusion-20", "false-positives-15")
FITTING = tuple(range(10))


def told(seeds: Sequence[int], conditions: Sequence[str], work: Path) -> list[Told]:
    """Ask the questions of Exp 2 of each world under each condition, and judge every answer."""
    found: list[Told] = []
    for seed in seeds:
        for condition in conditions:
            source = recorded(World(seed), condition, work)
            rng = np.random.default_rng([seed, 2])
            questions = draw(source.truth, source.zone, rng)
            with filled(OURS, source, work / "stores") as run:
                found += Teller(run, source.truth, source.zone).tell_all(questions)
            click.echo(f"seed {seed}, {condition}: {len(found)} answers", err=True)
    return found


def reliability(found: Sequence[Told], kind: Kind | None) -> Table:
    chosen = [one for one in found if kind in (None, one.kind)]
    scores, right = [one.score for one in chosen], [one.right for one in chosen]
    error, rows = expected_error(scores, right)
    shown = [
        (f"{n / 10:.1f} to {(n + 1) / 10:.1f}", f"{count:,}", f"{score:.3f}", f"{share:.3f}")
        for n, (count, score, share) in enumerate(rows)
        if count
    ]
    title = f"{kind or 'all'}: expected calibration error {error:.3f}"
    return Table(title, ("score", "answers", "mean score", "right"), tuple(shown))


@click.command()
@click.option("--seeds", default="dev", show_default=True, help="dev, validation, or 0,3-5.")
@click.option("--condition", "conditions", multiple=True, help="All four by default.")
@click.option("--refit", is_flag=True, help="Write the maps anew; development seeds only.")
@click.option("--keep", type=click.Path(file_okay=False, path_type=Path))
def main(seeds: str, conditions: tuple[str, ...], refit: bool, keep: Path | None) -> None:
    """Print how often scores are right, or fit the map that makes them so."""
    named = {"dev": FITTING, "validation": VALIDATION}
    chosen = named[seeds] if seeds in named else parse_seeds(seeds)
    if refit and not set(FITTING).issuperset(chosen):
        raise click.BadParameter("only development seeds (0-9) may be fitted on")
    with tempfile.TemporaryDirectory(prefix="d3a-bench-") as scratch:
        found = told(chosen, conditions or CONDITIONS, keep or Path(scratch))
    for kind in (None, *KINDS):
        click.echo(as_text(reliability(found, kind)) + "\n")
    if refit:
        maps = {}
        for kind in KINDS:
            own = [one for one in found if one.kind == kind]
            products, shares = fitted([one.product for one in own], [one.right for one in own])
            maps[kind] = {"product": products, "probability": shares}
        path = Path(str(files("d3a.answering").joinpath("calibration.json")))
        path.write_text(json.dumps(maps, indent=1) + "\n", encoding="utf-8")
        click.echo(f"written: {path.name}; run again without --refit to see what it gives")


if __name__ == "__main__":
    main()
