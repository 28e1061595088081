"""`d3a teach`: what a thing is called, and whose it is."""

from __future__ import annotations

import click

from assistant import completing
from assistant.options import now_of, settings_of, settings_options
from assistant.told import carry_out, said_name, told_owner


@click.command("teach")
@click.argument("object_id", metavar="ID", shell_complete=completing.object_ids)
@click.argument("name")
@click.option("--owner", metavar="NAME", help='Whose it is: me, or a name; "Anna\'s keys" says so.')
@click.option("--remove", is_flag=True, help="It is not called so.")
@click.option("--json", "as_json", is_flag=True, help="The record of it, as JSON.")
@settings_options
@click.pass_context
def command(
    context: click.Context,
    object_id: str,
    name: str,
    owner: str | None,
    remove: bool,
    as_json: bool,
) -> None:
    """Call the thing ID by NAME: "my keys", "Anna's blue mug", "Excalibur"."""
    from d3a.constraints import Correction
    from d3a.store.base import Store
    from d3a.teaching import forget_name, teach_name
    from grammar import vocabulary

    settings = settings_of(context)

    def act(store: Store, at_ms: int) -> Correction:
        known = store.objects(ids=[object_id], embeddings=False)
        kind = vocabulary.canonical(known[0].category) if known else "thing"
        word, said_owner = said_name(name, kind, now_of(settings, store))
        whose = told_owner(owner) or said_owner
        change = forget_name if remove else teach_name
        heard = name if owner is None else None
        return change(store, object_id, word, whose, at_ms=at_ms, heard=heard)

    carry_out(context, act, as_json=as_json)
