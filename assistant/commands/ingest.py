"""`d3a ingest`: fill a store from recordings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from assistant.config import Settings
from assistant.detecting import Looking, detector_options
from assistant.exits import ExitCode
from assistant.intake_report import SCHEMA, progress, summary_json, summary_lines
from assistant.options import (
    Failure,
    failures,
    opened,
    settings_of,
    settings_options,
    store_name,
)
from assistant.taking_in import Wanted, intake_options
from assistant.terminal import clean, emit, tell

if TYPE_CHECKING:
    from d3a.detectors.base import Detector
    from d3a.embedders.base import Embedder
    from d3a.ingest import IngestSummary
    from d3a.ingesting.intake import Intake
    from d3a.ingesting.jobs import Backend
    from d3a.readers.base import Reader
    from d3a.store.base import Store


@dataclass(frozen=True, slots=True)
class Wishes:
    """What the person wants of the recordings, as it stands on the command line."""

    wanted: Wanted = field(default_factory=Wanted)
    looking: Looking = field(default_factory=Looking)
    max_frames: int | None = None
    assignments: Path | None = None
    jobs: int = 1
    backend: Backend = "processes"


@click.command("ingest")
@click.argument("sources", nargs=-1, required=True, type=click.Path(path_type=Path))
@intake_options
@click.option("--max-frames", type=click.IntRange(min=1), help="Stop after so many frames.")
@detector_options
@click.option(
    "--assignments",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write which object each detection became, a JSON object a line.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=1, help="Make frames ready in so many processes."
)
@click.option(
    "--backend",
    type=click.Choice(["processes", "dask", "ray"]),
    default="processes",
    show_default=True,
    help="Whose processes these are; a dask cluster by DASK_SCHEDULER_ADDRESS, else a local one.",
)
@click.option("--json", "as_json", is_flag=True, help="The summary as one JSON object.")
@settings_options
@click.pass_context
def command(
    context: click.Context,
    /,
    sources: tuple[Path, ...],
    as_json: bool,
    **wished: Any,
) -> None:
    """Fill the store from the recordings SOURCES; doing it twice changes nothing.

    Several are taken in order of time, site by site. What is broken in a recording is counted,
    named and left out. Status 2 when a recording could not be read; the others are taken in.
    """
    settings = settings_of(context)
    looking, wanted = Looking.taken_from(wished), Wanted.taken_from(wished)
    wishes = Wishes(wanted, looking, **wished)
    if wishes.assignments is not None and len(sources) > 1:
        raise click.BadParameter("--assignments is of one recording; ingest them one by one")
    run = _Run(settings, wishes, as_json=as_json)
    with failures():
        run.check_places()
        run.open_lookers()
    run.open(sources)
    run.ingest()
    context.exit(ExitCode.USAGE if run.failed else ExitCode.OK)


class _Run:
    """One call of the command: opens all recordings, then takes them in one by one."""

    def __init__(self, settings: Settings, wishes: Wishes, *, as_json: bool) -> None:
        self._settings = settings
        self._parameters = wishes.wanted.parameters()
        self._wishes = wishes
        self._as_json = as_json
        self._readers: list[tuple[Path, Reader]] = []
        self._several = False
        self._detector: Detector | None = None
        self._embedder: Embedder | None = None
        self.failed: list[dict[str, str]] = []

    def check_places(self) -> None:
        """Refuse what could not be written, before a store is made."""
        from d3a.ingesting.assignments import check_place

        if self._wishes.assignments is not None:
            check_place(self._wishes.assignments)

    def open_lookers(self) -> None:
        """Open the detector and the embedder, and say what they are."""
        self._detector = self._wishes.looking.open_detector()
        self._embedder = self._wishes.looking.open_embedder()
        if not self._settings.quiet:
            for kind, found in (("detector", self._detector), ("embedder", self._embedder)):
                if found is not None:
                    click.echo(clean(f"{kind}: {found}"), err=True)

    def open(self, sources: Sequence[Path]) -> None:
        """Open what can be read, in order of site and time; a Failure where nothing can."""
        self._several = len(sources) > 1
        found: list[tuple[str, float, int, Path, Reader]] = []
        for number, source in enumerate(sources):
            with self._named(source):
                reader = self._reader_of(source)
                first = next(iter(reader), None) if self._several else None
                start_ms = float("inf") if first is None else first.time_ms
                found.append((reader.facts.site, start_ms, number, source, reader))
        self._readers = [(each[3], each[4]) for each in sorted(found, key=lambda each: each[:3])]
        if not self._readers:
            raise click.exceptions.Exit(ExitCode.USAGE)

    def _reader_of(self, source: Path) -> Reader:
        from d3a.readers.opening import open_source

        wanted = self._wishes.wanted
        return open_source(
            source, format=wanted.format_name, zone=self._settings.zone, options=wanted.options
        )

    @contextmanager
    def _named(self, source: Path) -> Iterator[None]:
        """Say why a recording failed, and go on where there are others."""
        from d3a.model import BadInput

        try:
            yield
        except BadInput as error:
            if not self._several:
                raise Failure(str(error), ExitCode.USAGE) from error
            self.failed.append({"source": str(source), "problem": str(error)})
            click.echo(clean(f"d3a: {source}: {error}"), err=True)

    def ingest(self) -> None:
        """Take the recordings in, and print what came of it."""
        from d3a.store.opening import mask

        records: list[dict[str, Any]] = []
        with opened(self._settings, create=True) as store:
            for source, reader in self._readers:
                with self._named(source):
                    summary = self._take(source, reader, store)
                    place = {"source": str(source), "recording": reader.facts.name}
                    place["site"] = reader.facts.site
                    records.append(place | summary_json(summary))
                    if not self._as_json:
                        self._print(source, summary)
        if self._as_json:
            record = {"schema": SCHEMA, "store": mask(self._settings.store_uri)}
            record |= {"recordings": records, "failed": self.failed}
            emit(record)
        elif not self._settings.quiet:
            click.echo(f"store: {store_name(self._settings)}", err=True)

    def _take(self, source: Path, reader: Reader, store: Store) -> IngestSummary:
        """Take a recording in; where something is forgotten meanwhile, go on from before that."""
        from d3a.associator import ForgottenMeanwhile

        for note in reader.facts.notes:
            self._note(note)
        intake = self._wishes.wanted.intake(self._settings.zone or reader.facts.zone)
        while True:
            try:
                summary = self._ingest(reader, store, intake)
            except ForgottenMeanwhile as error:
                self._note(str(error))
                reader = self._reader_of(source)
            else:
                break
        if not summary.already:
            self._name_unused(intake, summary)
        return summary

    def _ingest(self, reader: Reader, store: Store, intake: Intake) -> IngestSummary:
        from d3a.ingest import ingest
        from d3a.ingesting.jobs import Jobs

        wishes, quiet = self._wishes, bool(self._settings.quiet)
        label = reader.facts.name if self._several else ""
        with progress(quiet, label) as on_progress:
            return ingest(
                reader,
                store,
                self._parameters,
                detector=self._detector,
                embedder=self._embedder,
                on_progress=on_progress,
                on_note=self._note,
                max_frames=wishes.max_frames,
                assignments=wishes.assignments,
                intake=intake,
                jobs=Jobs(wishes.jobs, wishes.backend),
            )

    def _note(self, text: str) -> None:
        if not self._settings.quiet:
            tell(f"note: {text}")

    def _name_unused(self, intake: Intake, summary: IngestSummary) -> None:
        """Say which ignored categories nothing was called: a slip would store what should not."""
        from d3a.ingesting.preparation import ignored

        seen = {reason.casefold() for reason in summary.skipped.counts}
        for word in sorted(intake.ignore):
            if ignored(word).casefold() not in seen:
                self._note(f"nothing was called {word!r}, so none is ignored")

    def _print(self, source: Path, summary: IngestSummary) -> None:
        if self._several:
            click.echo(clean(f"{source}"))
        indent = "  " if self._several else ""
        click.echo("\n".join(indent + line for line in summary_lines(summary)))
