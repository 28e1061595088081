"""Measure an ingest: frames and detections per second, split by stage.

    python -m tests.bench.bench_ingest RECORDING... [--profile default] [--runs 3]

The store is SQLite in a scratch folder. Rates are of the fastest run, as other work on the
machine only ever makes a run slower.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from d3a.ingest import IngestSummary, ingest
from d3a.parameters import PROFILES
from d3a.readers.opening import open_source
from d3a.store.opening import open_store


def measured(folder: Path, profile: str, runs: int) -> IngestSummary:
    """Ingest so many times into new stores; return the fastest."""
    summaries = []
    with tempfile.TemporaryDirectory() as scratch:
        for run in range(runs):
            store = open_store(f"sqlite:///{scratch}/{run}.db")
            summaries.append(ingest(open_source(folder), store, PROFILES[profile]))
            store.close()
    return min(summaries, key=lambda summary: sum(summary.seconds.values()))


@click.command()
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--profile", type=click.Choice(list(PROFILES)), default=None)
@click.option("--runs", default=3, show_default=True)
def main(recordings: tuple[Path, ...], profile: str | None, runs: int) -> None:
    """Print the rates of each recording and profile."""
    for folder in recordings:
        for name in [profile] if profile else list(PROFILES):
            best = measured(folder, name, runs)
            seconds = sum(best.seconds.values())
            click.echo(
                f"{folder.name} {name}: {best.frames} frames, {best.detections} detections, "
                f"{best.frames / seconds:.0f} frames/s, {best.detections / seconds:.0f} "
                "detections/s"
            )
            for stage, spent in best.seconds.items():
                rate = best.detections / spent if spent else float("inf")
                click.echo(f"  {stage:<7} {spent:7.3f} s {rate:9.0f} detections/s")


if __name__ == "__main__":
    main()
