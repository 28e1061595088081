"""Measure an ingest: frames and detections per second, split by stage.

    python -m tests.bench.bench_ingest RECORDING... [--profile default] [--runs 3]
    python -m tests.bench.bench_ingest [--hours 3 --hours 22 --hours 100] [--seed 0] [--keep DIR]

Without a recording, simulated worlds are taken, without depth images, as those are read and not
associated: how quick the tiers alone are as a home fills, what they cost by the shortest, and
whether things keep their identity. Rates of the tiers are by processor time.

The store is SQLite in a scratch folder. Of a recording's runs the fastest is told, as other work on
the machine only ever makes a run slower.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from assistant.evaluation.methods import D3A_D, OURS, Method, filled
from assistant.evaluation.worlds import World, recorded
from d3a.ingest import IngestSummary, ingest
from d3a.metrics import b_cubed, duplicates
from d3a.parameters import PROFILES
from d3a.readers.opening import open_source
from d3a.store.opening import open_store

METHODS: dict[str, Method] = {method.parameters.profile: method for method in (OURS, D3A_D)}
LENGTHS_H = (3.0, 22.0, 100.0)


def measured(folder: Path, profile: str, runs: int) -> IngestSummary:
    """Ingest so many times into new stores; return the fastest."""
    summaries = []
    with tempfile.TemporaryDirectory() as scratch:
        for run in range(runs):
            store = open_store(f"sqlite:///{scratch}/{run}.db")
            summaries.append(ingest(open_source(folder), store, PROFILES[profile]))
            store.close()
    return min(summaries, key=lambda summary: sum(summary.seconds.values()))


def tell_recording(folder: Path, profile: str, runs: int) -> None:
    """Print the rates of a recording under a profile."""
    best = measured(folder, profile, runs)
    seconds = sum(best.seconds.values())
    click.echo(
        f"{folder.name} {profile}: {best.frames} frames, {best.detections} detections, "
        f"{best.frames / seconds:.0f} frames/s, {best.detections / seconds:.0f} detections/s"
    )
    for stage, spent in best.seconds.items():
        rate = best.detections / spent if spent else float("inf")
        click.echo(f"  {stage:<7} {spent:7.3f} s {rate:9.0f} detections/s")


def cost(method: Method, world: World, work: Path, runs: int) -> float:
    """Print how quick the tiers are on a world, and how right; return seconds a detection."""
    source = recorded(world, "nominal", work / "flat", depth=False)
    owner = source.truth.owner.tolist()
    spent: list[float] = []
    told = ""
    for _ in range(runs):
        with filled(method, source, work / "stores") as run:
            spent.append(run.associate_s / run.detections)
            objects = run.store.objects()
            known = [each.object_id for each in objects if not each.tentative]
            same = b_cubed(owner, run.assignments)
            doubles = duplicates(source.truth, run.assignments, known).mean
            told = (
                f"B-cubed {same.f:.3f} (precision {same.precision:.2f}, recall {same.recall:.2f}), "
                f"{doubles:.2f} ids an object, {len(known)} of {len(objects)} objects confirmed"
            )
    click.echo(f"{world.hours:5g} h  {1 / min(spent):7,.0f} detections/s  {told}")
    return min(spent)


def tell_worlds(profile: str, hours: tuple[float, ...], seed: int, work: Path, runs: int) -> None:
    """Print the tiers' rates by the length of a simulated world."""
    click.echo(f"{profile} profile, seed {seed}, without depth images: the tiers alone")
    costs = [cost(METHODS[profile], World(seed, each), work, runs) for each in hours]
    for length, each in zip(hours[1:], costs[1:], strict=True):
        click.echo(f"a detection at {length:g} h over one at {hours[0]:g} h: {each / costs[0]:.2f}")


@click.command()
@click.argument("recordings", nargs=-1, type=click.Path(path_type=Path))
@click.option("--profile", type=click.Choice(list(PROFILES)), default=None)
@click.option("--runs", default=None, type=int, help="3 of a recording, 1 of a world by default.")
@click.option("--hours", multiple=True, type=float, default=LENGTHS_H, show_default=True)
@click.option("--seed", default=0, show_default=True)
@click.option("--keep", type=click.Path(file_okay=False, path_type=Path), help="For the worlds.")
def main(
    recordings: tuple[Path, ...],
    profile: str | None,
    runs: int | None,
    hours: tuple[float, ...],
    seed: int,
    keep: Path | None,
) -> None:
    """Print the rates of each recording and profile, or those of simulated worlds."""
    for name in [profile] if profile else list(PROFILES):
        for folder in recordings:
            tell_recording(folder, name, runs or 3)
        if not recordings:
            with tempfile.TemporaryDirectory(prefix="d3a-bench-") as scratch:
                tell_worlds(name, hours, seed, keep or Path(scratch), runs or 1)


if __name__ == "__main__":
    main()
