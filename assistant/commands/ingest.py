"""`d3a ingest`: fill a store from a recording."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from assistant.options import failures, opened, settings_of, settings_options, store_name
from assistant.terminal import clean, is_terminal

if TYPE_CHECKING:
    from d3a.ingest import IngestSummary

Progress = Callable[[int, int | None], None]


@click.command("ingest")
@click.argument("source", type=click.Path(path_type=Path))
@click.option(
    "--format", "format_name", metavar="NAME", help="Reader; by default found by looking."
)
@click.option("--profile", default="default", show_default=True, help="default or paper.")
@click.option("--max-frames", type=click.IntRange(min=1), help="Stop after so many frames.")
@click.option("--min-probability", type=click.FloatRange(0, 1), help="Leave weaker detections out.")
@click.option(
    "--assignments",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write which object each detection became, a JSON object a line.",
)
@settings_options
@click.pass_context
def command(
    context: click.Context,
    source: Path,
    format_name: str | None,
    profile: str,
    max_frames: int | None,
    min_probability: float | None,
    assignments: Path | None,
) -> None:
    """Fill the store from the recording SOURCE; doing it twice changes nothing.

    What is broken in the recording is counted, named and left out.
    """
    from d3a.ingest import ingest
    from d3a.parameters import PROFILES
    from d3a.readers.opening import open_source

    settings = settings_of(context)
    if profile not in PROFILES:
        raise click.BadParameter(f"{profile!r} is no profile; there are {', '.join(PROFILES)}")
    parameters = PROFILES[profile]
    if min_probability is not None:
        parameters = parameters.with_changes(min_probability=min_probability)
    with failures():
        reader = open_source(source, format=format_name, zone=settings.zone)
        with opened(settings, create=True) as store, progress(settings.quiet) as on_progress:
            summary = ingest(
                reader,
                store,
                parameters,
                on_progress=on_progress,
                max_frames=max_frames,
                assignments=assignments,
            )
    click.echo("\n".join(summary_lines(summary)))
    if not settings.quiet:
        click.echo(f"store: {store_name(settings)}", err=True)


@contextmanager
def progress(quiet: bool) -> Iterator[Progress | None]:
    """Give a callback for frames done and their number: a bar, or a line per 10 %."""
    if quiet:
        yield None
    elif is_terminal(sys.stderr):
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

        columns = (BarColumn(), MofNCompleteColumn(), "frames", TimeRemainingColumn())
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("", total=None)
            yield lambda done, total: bar.update(task, completed=done, total=total)
    else:
        yield _TenPercent()


class _TenPercent:
    """Prints a line when another tenth of the frames is done; each 1000 where it is unknown."""

    def __init__(self) -> None:
        self._said = 0

    def __call__(self, done: int, total: int | None) -> None:
        reached = done * 10 // total if total else done // 1000
        if reached > self._said:
            self._said = reached
            share = f"{reached * 10} %, " if total else ""
            click.echo(f"{share}{done} frames", err=True)


def summary_lines(summary: IngestSummary) -> list[str]:
    """Return what an ingest did, for a person: what went in, what was left out, how fast."""
    lines = ["Nothing new: the recording is in the store already."] if summary.already else []
    lines += [
        f"frames      {summary.frames}{_resumed(summary)}",
        f"detections  {summary.detections}",
        f"objects     {summary.objects}",
        f"places      {summary.places}",
        f"skipped     {sum(summary.skipped.counts.values())}",
    ]
    for reason, count in sorted(summary.skipped.counts.items()):
        named = summary.skipped.examples.get(reason, [])
        examples = ", ".join(named) + (", …" if count > len(named) else "")
        lines.append(clean(f"  {count} x {reason}" + (f": {examples}" if examples else "")))
    if summary.forgotten:
        lines.append(f"forgotten   {summary.forgotten} intervals, older than this store keeps them")
    seconds = sum(summary.seconds.values())
    if summary.frames and seconds > 0:
        stages = ", ".join(f"{stage} {value:.2f} s" for stage, value in summary.seconds.items())
        frames, detections = summary.frames / seconds, summary.detections / seconds
        lines.append(f"speed       {frames:.1f} frames/s, {detections:.1f} detections/s ({stages})")
    return lines


def _resumed(summary: IngestSummary) -> str:
    if summary.already or not summary.already_frames:
        return ""
    return f", after {summary.already_frames} that were there already"
