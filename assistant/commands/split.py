"""`d3a split`: what was seen at one place of an object is another thing."""

from __future__ import annotations

import click

from assistant import completing
from assistant.options import settings_options
from assistant.told import carry_out


@click.command("split")
@click.argument("object_id", metavar="ID", shell_complete=completing.object_ids)
@click.argument("place", type=int)
@click.option("--json", "as_json", is_flag=True, help="The record of it, as JSON.")
@settings_options
@click.pass_context
def command(context: click.Context, object_id: str, place: int, as_json: bool) -> None:
    """Say that ID at PLACE (a number that `d3a objects --json` shows) is another thing.

    It gets an id of its own; later ingests do not make the two one again.
    """
    from d3a.teaching import split

    carry_out(
        context, lambda store, at_ms: split(store, object_id, place, at_ms=at_ms), as_json=as_json
    )
