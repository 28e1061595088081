"""`d3a merge`: two objects are the same thing."""

from __future__ import annotations

import click

from assistant import completing
from assistant.options import settings_options
from assistant.told import carry_out


@click.command("merge")
@click.argument("kept", metavar="ID", shell_complete=completing.object_ids)
@click.argument("gone", metavar="SAME", shell_complete=completing.object_ids)
@click.option("--force", is_flag=True, help="Also where one frame shows both.")
@click.option("--json", "as_json", is_flag=True, help="The record of it, as JSON.")
@settings_options
@click.pass_context
def command(context: click.Context, kept: str, gone: str, force: bool, as_json: bool) -> None:
    """Say that SAME is the same thing as ID, which keeps its id; later ingests keep it so."""
    from d3a.teaching import merge

    carry_out(
        context,
        lambda store, at_ms: merge(store, kept, gone, force=force, at_ms=at_ms),
        as_json=as_json,
    )
