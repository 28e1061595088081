"""What an ingest tells while it runs and when it is done: a bar, a summary, or a JSON record."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from assistant.terminal import clean, is_terminal

if TYPE_CHECKING:
    from d3a.ingest import IngestSummary

Progress = Callable[[int, int | None], None]
SCHEMA = 1


@contextmanager
def progress(quiet: bool, label: str = "") -> Iterator[Progress | None]:
    """Give a callback for frames done and their number: a bar, or a line per 10 %.

    label: the recording's, where there are several.
    """
    if quiet:
        yield None
    elif is_terminal(sys.stderr):
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

        columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[pace]}"))
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            pace = Pace()
            task = bar.add_task("", total=None, pace="frames")
            yield lambda done, total: bar.update(
                task, completed=done, total=total, pace=f"frames {pace.said(done, total)}"
            )
    else:
        yield _TenPercent(label)


class Pace:
    """Frames per second since the first call, and the time that is left at that."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._started: tuple[int, float] | None = None

    def said(self, done: int, total: int | None) -> str:
        """Return the rate and the time left as words, "" before there is a rate."""
        now = self._clock()
        if self._started is None:
            self._started = (done, now)
        first, since = self._started
        if now <= since or done <= first:
            return ""
        rate = (done - first) / (now - since)
        left = f", {duration((total - done) / rate)} left" if total and total > done else ""
        return f"{rate:.1f} frames/s{left}"


def duration(seconds: float) -> str:
    """Return a time span as words: 40 s, 3 min, 2 h 5 min."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"


class _TenPercent:
    """Prints a line when another tenth of the frames is done; each 1000 where it is unknown."""

    def __init__(self, label: str) -> None:
        self._said = 0
        self._label = f"{clean(label)}: " if label else ""
        self._pace = Pace()

    def __call__(self, done: int, total: int | None) -> None:
        pace = self._pace.said(done, total)
        reached = done * 10 // total if total else done // 1000
        if reached > self._said:
            self._said = reached
            share = f"{reached * 10} %, " if total else ""
            pace = f", {pace}" if pace else ""
            click.echo(f"{self._label}{share}{done} frames{pace}", err=True)


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
    lines += [clean(f"  {told}") for told in summary.skipped.told()]
    if summary.forgotten:
        lines.append(f"forgotten   {summary.forgotten} intervals, older than this store keeps them")
    seconds = summary.elapsed_s
    if summary.frames and seconds > 0:
        stages = ", ".join(f"{stage} {value:.2f} s" for stage, value in summary.seconds.items())
        frames, detections = summary.frames / seconds, summary.detections / seconds
        lines.append(f"speed       {frames:.1f} frames/s, {detections:.1f} detections/s ({stages})")
    return lines


def _resumed(summary: IngestSummary) -> str:
    if summary.already or not summary.already_frames:
        return ""
    return f", after {summary.already_frames} that were there already"


def summary_json(summary: IngestSummary) -> dict[str, Any]:
    """Return what an ingest did, as JSON."""
    skipped = summary.skipped
    return {
        "frames": summary.frames,
        "detections": summary.detections,
        "objects": summary.objects,
        "places": summary.places,
        "skipped": [
            {"reason": reason, "count": count, "examples": skipped.examples.get(reason, [])}
            for reason, count in sorted(skipped.counts.items())
        ],
        "seconds": {stage: round(value, 3) for stage, value in summary.seconds.items()},
        "elapsed": round(summary.elapsed_s, 3),
        "already": summary.already,
        "already_frames": summary.already_frames,
        "forgotten": summary.forgotten,
    }
