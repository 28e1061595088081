"""`d3a split`: what was seen at one place of an object is another thing."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

import click

from assistant import completing
from assistant.options import now_of, settings_of, settings_options
from assistant.told import carry_out

if TYPE_CHECKING:
    from d3a.constraints import Correction
    from d3a.store.base import Store


@click.command("split")
@click.argument("object_id", metavar="ID", shell_complete=completing.object_ids)
@click.argument("place", type=int)
@click.option(
    "--from",
    "since",
    metavar="TIME",
    help="Only what was seen there from then on: ISO, or as one says it.",
)
@click.option("--json", "as_json", is_flag=True, help="The record of it, as JSON.")
@settings_options
@click.pass_context
def command(
    context: click.Context, object_id: str, place: int, since: str | None, as_json: bool
) -> None:
    """Say that ID at PLACE (a number that `d3a objects --json` shows) is another thing.

    It gets an id of its own; later ingests do not make the two one again. Where two things alike
    changed places, each is the other --from a TIME on; `d3a merge` puts the parts together.
    """
    from d3a.teaching import split

    def act(store: Store, at_ms: int) -> Correction:
        moment = None if since is None else _moment(context, store, since)
        return split(store, object_id, place, since=moment, at_ms=at_ms)

    carry_out(context, act, as_json=as_json)


def _moment(context: click.Context, store: Store, said: str) -> datetime:
    from assistant.selecting import start_meant

    now = now_of(settings_of(context), store)
    return datetime.fromtimestamp(start_meant(said, now) / 1000, now.tzinfo)
