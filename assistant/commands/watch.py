"""`d3a watch`: fill a store from a recording as it grows."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from assistant.config import Settings
from assistant.detecting import Looking, detector_options
from assistant.exits import ExitCode
from assistant.intake_report import SCHEMA, Pace, summary_json, summary_lines
from assistant.options import Failure, opened, settings_of, settings_options, store_name
from assistant.taking_in import Wanted, intake_options
from assistant.terminal import clean, emit

if TYPE_CHECKING:
    from types import FrameType

    from d3a.ingest import IngestSummary
    from d3a.readers.base import Follower
    from d3a.store.base import Store
    from d3a.watch import Patience

STOPPED_BY = {signal.SIGINT: ExitCode.INTERRUPTED, signal.SIGTERM: ExitCode.TERMINATED}
SAY_EACH_S = 10.0


@click.command("watch")
@click.argument("source")
@intake_options
@detector_options
@click.option(
    "--until-idle",
    type=click.FloatRange(min=0, min_open=True),
    metavar="SECONDS",
    help="End the recording when nothing came for so long; else it is watched until stopped.",
)
@click.option(
    "--settle",
    type=click.FloatRange(min=0),
    default=1.0,
    show_default=True,
    metavar="SECONDS",
    help="Wait so long for what belongs to a frame: its boxes, picture and pose.",
)
@click.option(
    "--fresh",
    type=click.FloatRange(min=0),
    default=2.0,
    show_default=True,
    metavar="SECONDS",
    help="Write to the store at least so often, for those who ask meanwhile.",
)
@click.option("--json", "as_json", is_flag=True, help="The summary as one JSON object.")
@settings_options
@click.pass_context
def command(
    context: click.Context,
    /,
    source: str,
    until_idle: float | None,
    settle: float,
    fresh: float,
    as_json: bool,
    **wished: Any,
) -> None:
    """Fill the store from SOURCE as it grows: a folder, or a robot's rosbridge (ws://host:9090).

    Others may ask the same store meanwhile. Stopped by Ctrl-C or SIGTERM (status 130, 143), or
    killed, it goes on where it was when it is started again.
    """
    from d3a.watch import Patience

    settings = settings_of(context)
    looking, wanted = Looking.taken_from(wished), Wanted.taken_from(wished)
    with stop_signals() as stopped_by:
        patience = Patience(until_idle, settle, should_stop=lambda: bool(stopped_by))
        run = _Run(settings, source, wanted, looking, fresh)
        with opened(settings, create=True) as store:
            summary = run.watch(store, patience)
        run.tell(summary, as_json=as_json, was_stopped=bool(stopped_by))
    context.exit(STOPPED_BY[stopped_by[0]] if stopped_by else ExitCode.OK)


@contextmanager
def stop_signals() -> Iterator[list[signal.Signals]]:
    """Note signals that ask to stop, in a list; a second one ends the process as usual."""
    noted: list[signal.Signals] = []

    def note(number: int, _: FrameType | None) -> None:
        noted.append(signal.Signals(number))
        for each, handler in before.items():
            signal.signal(each, handler)

    before = {each: signal.signal(each, note) for each in STOPPED_BY}
    try:
        yield noted
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


class _Run:
    """One call of the command."""

    def __init__(
        self, settings: Settings, source: str, wanted: Wanted, looking: Looking, fresh_s: float
    ) -> None:
        self._settings = settings
        self._source = source
        self._wanted = wanted
        self._looking = looking
        self._fresh_s = fresh_s
        self._noted: set[str] = set()

    def watch(self, store: Store, patience: Patience) -> IngestSummary | None:
        """Follow the source until it is over or stopped; None where nothing came."""
        from d3a.watch import Watching, is_address, watch

        detector, embedder = self._looking.open_detector(), self._looking.open_embedder()
        self._say(f"watching {self._source}")
        watching = Watching(
            parameters=self._wanted.parameters(),
            should_stop=patience.should_stop,
            fresh_s=self._fresh_s,
            is_resumable=not is_address(self._source),
            intake=lambda zone: self._wanted.intake(self._settings.zone or zone),
            detector=detector,
            embedder=embedder,
            on_progress=None if self._settings.quiet else _Ticker(self._say),
            on_note=lambda text: self._say(f"note: {text}"),
        )
        has_detector = detector is not None
        return watch(lambda: self._follow(patience, has_detector=has_detector), store, watching)

    def _follow(self, patience: Patience, *, has_detector: bool) -> Follower | None:
        from d3a.watch import follow

        follower = follow(
            self._source,
            patience,
            format=self._wanted.format_name,
            zone=self._settings.zone,
            options=self._wanted.options,
            has_detector=has_detector,
            on_note=self._say,
        )
        if follower is not None:
            for note in follower.facts.notes:
                if note not in self._noted:
                    self._noted.add(note)
                    self._say(f"note: {note}")
        return follower

    def _say(self, text: str) -> None:
        if not self._settings.quiet:
            click.echo(clean(text), err=True)

    def tell(self, summary: IngestSummary | None, *, as_json: bool, was_stopped: bool) -> None:
        """Print what came of it; a Failure where nothing came and nobody stopped it."""
        from d3a.store.opening import mask

        if summary is None and not was_stopped:
            raise Failure(f"nothing came of {self._source}", ExitCode.USAGE)
        if as_json:
            record: dict[str, Any] = {"schema": SCHEMA, "store": mask(self._settings.store_uri)}
            record |= {"source": self._source, "is_over": summary is not None and not was_stopped}
            record["summary"] = None if summary is None else summary_json(summary)
            emit(record)
            return
        if summary is None:
            self._say("stopped before anything came")
        else:
            click.echo("\n".join(summary_lines(summary)))
        if was_stopped:
            self._say("stopped; all that was seen is stored, and it goes on when started again")
        self._say(f"store: {store_name(self._settings)}")


class _Ticker:
    """Says every few seconds how many frames came, and how fast."""

    def __init__(self, say: Callable[[str], None], clock: Callable[[], float] = monotonic) -> None:
        self._say = say
        self._clock = clock
        self._said = clock()
        self._pace = Pace(clock)

    def __call__(self, done: int, total: int | None) -> None:
        pace = self._pace.said(done, total)
        if self._clock() - self._said >= SAY_EACH_S:
            self._said = self._clock()
            self._say(f"{done} frames{', ' + pace if pace else ''}")
            self._pace = Pace(self._clock)
