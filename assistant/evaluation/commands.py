"""`d3a simulate` and `d3a evaluate`: the commands around the evaluation."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

if TYPE_CHECKING:
    from assistant.evaluation.running import Evaluation
    from assistant.evaluation.worlds import Progress, World


_CONDITIONS = """\b
Conditions:
  nominal             as the paper's robot: poses off by 0.35 m, 8 % of the
                      names wrong, 4 % of the boxes around nothing
  pose-0.2, pose-0.5  poses off by so many metres
  drift               poses off by 0.5 m, most of it slowly over an hour
  confusion-20        20 % of the names wrong
  false-positives-15  15 % of the boxes around nothing
  colour-x2           light, shadows and backgrounds change looks twice as much
  flat                every thing is detected as surely as any other
  even-patrol         each way point is passed as often as any other
  noiseless           poses, depth, names and colours are true
  perfect             names and boxes as annotated, looks a code of each thing:
                      the perfect detector of the paper's tables
  perfect-0.1         the same, and poses off by 0.1 m
"""


@click.command("simulate", epilog=_CONDITIONS)
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.option("--hours", type=click.FloatRange(0.05, 200), default=3.0, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--condition", default="nominal", show_default=True, metavar="NAME")
@click.option("--depth/--no-depth", default=True, help="Write a depth image per frame.")
@click.option("--statistics", is_flag=True, help="Print how much it looks like the paper's lab.")
def simulate_command(
    out: Path, hours: float, seed: int, condition: str, depth: bool, statistics: bool
) -> None:
    """Write a simulated recording with its truth to the folder OUT.

    Prints a JSON object of counts. The seed and the hours make the world, CONDITION how well the
    robot sees it.
    """
    from d3a.model import BadInput
    from d3a.simulate import simulate
    from d3a.simulation.statistics import statistics as measured

    try:
        record = simulate(out, hours=hours, seed=seed, condition=condition, depth=depth).to_json()
    except OSError as error:
        words = f"{out} cannot be written: {error.strerror}; a part of a world is no recording yet"
        raise click.ClickException(words) from error
    except BadInput as error:
        raise click.ClickException(str(error)) from error
    if statistics:
        record["statistics"] = measured(out)
    click.echo(json.dumps({"schema": 1, **record}, ensure_ascii=False))


@click.command("evaluate")
@click.argument("which", nargs=-1, type=click.Choice(("exp1", "exp2", "exp3", "exp4", "all")))
@click.option(
    "--world",
    "folders",
    multiple=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="A recording with truth.jsonl instead of simulated ones; may be repeated.",
)
@click.option("--seeds", default="0-4", show_default=True, help="Simulated worlds: 0-4, or 3,7.")
@click.option(
    "--hours",
    type=click.FloatRange(0.05, 200),
    default=3.0,
    show_default="3, and 22 for exp3",
    help="Length of a simulated world; one that is given holds for exp3 too.",
)
@click.option(
    "--reading",
    type=click.Choice(("strict", "paper")),
    default="strict",
    show_default=True,
    help="What counts as found; the paper's is the more generous.",
)
@click.option("--queries", type=click.IntRange(1, 1000), default=45, show_default=True)
@click.option(
    "--report",
    "report_dir",
    type=click.Path(file_okay=False, path_type=Path),
    help="Write report.html and results.json there.",
)
@click.option(
    "--keep",
    type=click.Path(file_okay=False, path_type=Path),
    help="Keep the simulated recordings there, for another run.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object, as in results.json.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.pass_context
def evaluate_command(
    context: click.Context,
    which: tuple[str, ...],
    folders: tuple[Path, ...],
    seeds: str,
    hours: float,
    reading: str,
    queries: int,
    report_dir: Path | None,
    keep: Path | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run the paper's experiments (all by default) and print their tables beside the paper's."""
    from assistant.evaluation import running
    from assistant.evaluation.worlds import lacks
    from assistant.exits import ExitCode
    from assistant.terminal import clean, emit
    from assistant.told import refusal
    from d3a.model import D3AError

    names = running.EXPERIMENTS if not which or "all" in which else which
    if folders:
        _refuse_of_seeds(context)
    worlds = _worlds(folders, seeds, hours)
    try:
        for folder in folders:
            for sentence in lacks(folder):
                click.echo(f"{folder.name}: {sentence}", err=True)
        with _progress(quiet) as progress:
            found = running.evaluate(
                [name for name in running.EXPERIMENTS if name in names],
                worlds,
                report_dir,
                progress or running.quiet,
                reading="frame" if reading == "paper" else "strict",
                count=queries,
                work=keep,
                long_hours=hours if _is_given(context, "hours") else running.LONG_HOURS,
            )
    except (D3AError, OSError) as error:
        raise refusal(str(error), ExitCode.USAGE, (), as_json) from error
    if "exp1" in names and not found.exp1:
        click.echo("exp1 needs a simulated world: its codes are drawn from a seed", err=True)
    for sentence in dict.fromkeys(text for outcome in found.exp2 for text in outcome.refused):
        click.echo(clean(f"refused, and so a miss: {sentence}"), err=True)
    if as_json:
        emit(found.to_json())
    else:
        _print(found)
    if report_dir is not None:
        click.echo(f"report: {report_dir / running.REPORT}", err=True)


def _refuse_of_seeds(context: click.Context) -> None:
    """Refuse what is said of simulated worlds where recordings are given: these are as they are."""
    for name in ("seeds", "hours", "keep"):
        if _is_given(context, name):
            raise click.UsageError(
                f"--{name} is of simulated worlds, and --world DIRECTORY is taken as it is: "
                "say one of them"
            )


def _is_given(context: click.Context, name: str) -> bool:
    return context.get_parameter_source(name) is ParameterSource.COMMANDLINE


def _print(found: Evaluation) -> None:
    from assistant.evaluation.paper import CONTRADICTIONS, contradictions
    from assistant.evaluation.tables import as_text

    for table in found.tables():
        click.echo(as_text(table))
        for note in table.notes:
            click.echo(f"  {note}")
        click.echo()
    if found.exp2:
        click.echo(CONTRADICTIONS)
        for line in contradictions():
            click.echo(f"  {line}")


def _worlds(folders: tuple[Path, ...], seeds: str, hours: float) -> tuple[World, ...]:
    from assistant.evaluation.worlds import World, worlds_of

    if folders:
        return tuple(World(folder=folder) for folder in folders)
    try:
        return worlds_of(parse_seeds(seeds), hours)
    except ValueError as error:
        raise click.BadParameter(f"{seeds!r}: {error}", param_hint="--seeds") from error


def parse_seeds(text: str) -> tuple[int, ...]:
    """Return the seeds of "0-4" or "3,7,100-104"; raises ValueError."""
    found: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not first.isdecimal() or (dash and not last.isdecimal()):
            raise ValueError("seeds are whole numbers and ranges, such as 0-4 or 3,7")
        found += range(int(first), int(last if dash else first) + 1)
    if not found:
        raise ValueError("a range runs from the lower to the higher seed")
    return tuple(dict.fromkeys(found))


@contextmanager
def _progress(quiet: bool) -> Iterator[Progress | None]:
    """Give a callback that draws a bar on a terminal, or prints a line a step elsewhere."""
    if quiet:
        yield None
    elif sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (BarColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("", total=1.0)
            yield lambda share, text: bar.update(task, completed=share, description=text)
    else:
        yield lambda share, text: click.echo(f"{100 * share:3.0f} %  {text}", err=True)
