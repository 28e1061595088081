"""`d3a undo`: take back the last thing that was said, or list all of it."""

from __future__ import annotations

import click

from assistant.exits import ExitCode
from assistant.options import opened, settings_of, settings_options, zone_for
from assistant.terminal import emit, table
from assistant.told import carry_out, record_of, when


@click.command("undo")
@click.option("--list", "listing", is_flag=True, help="Show what was said, and undo nothing.")
@click.option("--json", "as_json", is_flag=True, help="As JSON; a list as an object a line.")
@settings_options
@click.pass_context
def command(context: click.Context, listing: bool, as_json: bool) -> None:
    """Take back the last merge, split, taught name, place or map that was said of the store."""
    from d3a.constraints import Correction
    from d3a.store.base import Store
    from d3a.teaching import undo

    if listing:
        _list(context, as_json=as_json)
        return

    def act(store: Store, _at_ms: int) -> Correction:
        from dataclasses import replace

        undone = undo(store)
        return replace(undone, said=f"undone: {undone.said}", before=None, after=None)

    carry_out(context, act, as_json=as_json)


def _list(context: click.Context, *, as_json: bool) -> None:
    from d3a.teaching import history

    settings = settings_of(context)
    with opened(settings) as store:
        past = history(store)
        zone = zone_for(settings, store)
    if as_json:
        for each in past:
            emit(record_of(each, zone))
    elif past:
        rows = [["#", "when", "kind", "said"]]
        for each in past:
            time = "-" if each.at_ms is None else when(each.at_ms, zone)[:16].replace("T", " ")
            kept = " (cannot be undone)" if each.is_sealed else ""
            rows.append([str(each.number), time, each.kind, each.said + kept])
        click.echo("\n".join(table(rows, limits={3: 100})))
    elif not settings.quiet:
        click.echo("nothing was said of this store", err=True)
    if not past:
        context.exit(ExitCode.NOTHING)
