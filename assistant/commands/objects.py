"""`d3a objects`: what is in OIc."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import tzinfo
from typing import TYPE_CHECKING

import click

from assistant import completing
from assistant.exits import ExitCode
from assistant.options import opened, settings_of, settings_options, store_name, zone_for
from assistant.terminal import emit, table
from assistant.told import when

if TYPE_CHECKING:
    from d3a.model import Json
    from d3a.store.base import ObjectRecord, StayRecord, Store

SCHEMA = 1


@click.command("objects")
@click.option("--json", "as_json", is_flag=True, help="A JSON object a line.")
@click.option(
    "--category",
    "categories",
    multiple=True,
    shell_complete=completing.categories,
    help="Only this one; may be repeated.",
)
@settings_options
@click.pass_context
def command(context: click.Context, as_json: bool, categories: tuple[str, ...]) -> None:
    """List the objects of the store: id, category, names, colours, weight, places, times."""
    settings = settings_of(context)
    with opened(settings) as store:
        zone = zone_for(settings, store)
        records = list(object_records(store, categories, zone))
    if not records:
        if not settings.quiet:
            click.echo(f"no objects; store: {store_name(settings)}", err=True)
        context.exit(ExitCode.NOTHING)
    if as_json:
        for record in records:
            emit(record)
        return
    rows = [["id", "category", "names", "colours", "weight", "places", "first seen", "last seen"]]
    rows += [_row(record) for record in records]
    click.echo("\n".join(table(rows, limits={1: 24, 2: 24, 3: 24})))


def object_records(store: Store, categories: tuple[str, ...], zone: tzinfo) -> Iterator[Json]:
    """Yield the record of each object, by category, heaviest first."""
    stays: dict[str, list[StayRecord]] = {}
    for stay in store.stays():
        stays.setdefault(stay.object_id, []).append(stay)
    chosen = store.objects(categories=categories or None)
    chosen.sort(key=lambda o: (o.category, -o.weight, o.object_id))
    colours = colour_words(store, chosen)
    for thing in chosen:
        words = colours.get(thing.object_id, [])
        yield _record(thing, stays.get(thing.object_id, []), words, zone)


def colour_words(store: Store, things: Sequence[ObjectRecord]) -> dict[str, list[str]]:
    """Return, by object id, the basic colour terms that its histogram bears out, likeliest first.

    At most two; none for an object without a histogram. As in answers, each term is weighed
    against the other ten and the surroundings of all objects of the store.
    """
    import numpy as np

    from d3a.answering.facts import Facts
    from d3a.colours import BASIC

    looks = Facts(store).looks(things)
    if looks is None:
        return {}
    verdicts = [looks.of_rows.judge([term]) for term in BASIC]
    probability = np.stack([verdict.probability for verdict in verdicts], axis=1)
    tenable = np.stack([verdict.tenable for verdict in verdicts], axis=1)
    order = np.argsort(-probability, axis=1, kind="stable")[:, :2]
    return {
        things[at].object_id: [BASIC[i] for i in order[row] if tenable[row, i]]
        for row, at in enumerate(looks.rows.tolist())
    }


def _record(thing: ObjectRecord, stays: list[StayRecord], colours: list[str], zone: tzinfo) -> Json:
    return {
        "schema": SCHEMA,
        "object_id": thing.object_id,
        "category": thing.category,
        "categories": {name: round(weight, 3) for name, weight in thing.categories},
        "names": [{"word": name.word, "owner": name.owner} for name in thing.names],
        "colours": colours,
        "weight": round(thing.weight, 3),
        "tentative": thing.tentative,
        "places": [
            {
                "place": stay.place,
                "position": None if stay.position is None else [round(v, 3) for v in stay.position],
                "seen": stay.seen,
                "first": when(stay.first_ms, zone),
                "last": when(stay.last_ms, zone),
            }
            for stay in stays
        ],
        "first": when(thing.first_ms, zone),
        "last": when(thing.last_ms, zone),
    }


def _row(record: Json) -> list[str]:
    names = ", ".join(
        f"{name['word']} of {name['owner']}" if name["owner"] else name["word"]
        for name in record["names"]
    )
    return [
        record["object_id"],
        record["category"] + ("?" if record["tentative"] else ""),
        names,
        ", ".join(record["colours"]),
        f"{record['weight']:.2f}",
        str(len(record["places"])),
        record["first"][:16].replace("T", " "),
        record["last"][:16].replace("T", " "),
    ]
