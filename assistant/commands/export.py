"""`d3a export`: a store as COCO, CSV, or a recording that can be ingested again."""

from __future__ import annotations

from pathlib import Path

import click

from assistant import completing
from assistant.exits import ExitCode
from assistant.options import Failure, now_of, opened, settings_of, settings_options, zone_for
from assistant.terminal import clean, emit

SCHEMA = 1


@click.command("export")
@click.argument("out", type=click.Path(path_type=Path))
@click.option(
    "--format",
    "format_name",
    type=click.Choice(("coco", "csv", "recording")),
    required=True,
    help="coco: keyframes with boxes; csv: a row a place; recording: to ingest again.",
)
@click.option(
    "--what",
    multiple=True,
    metavar="THING",
    shell_complete=completing.things,
    help="Only this: an id, a name, cups.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object about what was written.")
@settings_options
@click.pass_context
def command(
    context: click.Context, out: Path, format_name: str, what: tuple[str, ...], as_json: bool
) -> None:
    """Write what the store holds into the new folder (or CSV file) OUT.

    Status: 0 written, 1 there is nothing of --what, 2 OUT is in the way, 3 no store.
    """
    from assistant.selecting import NothingMeant, things_meant
    from d3a.exporting import export

    settings = settings_of(context)
    with opened(settings) as store:
        ids = None
        if what:
            now = now_of(settings, store)
            try:
                meant = [things_meant(store, words, now=now).ids for words in what]
            except NothingMeant as error:
                raise Failure(str(error), ExitCode.NOTHING) from error
            ids = frozenset().union(*meant)
        try:
            written = export(store, out, format_name, ids=ids, zone=zone_for(settings, store))
        except OSError as error:
            raise Failure(f"{out} cannot be written: {error.strerror}", ExitCode.USAGE) from error
    record = {"schema": SCHEMA, "format": format_name, **written.to_json()}
    if as_json:
        emit(record)
        return
    names = ("objects", "places", "intervals", "pictures")
    counted = ", ".join(f"{record[name]} {name}" for name in names)
    click.echo(f"{clean(str(out))}: {counted}")
