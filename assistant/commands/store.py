"""`d3a store`: copy a store, check and mend it, tell what it is."""

from __future__ import annotations

import sys
from collections.abc import Callable
from datetime import tzinfo
from typing import TYPE_CHECKING

import click

from assistant.config import Settings
from assistant.exits import ExitCode
from assistant.options import (
    Failure,
    failures,
    opened,
    settings_of,
    settings_options,
    store_name,
    zone_for,
)
from assistant.terminal import clean, emit, is_terminal
from assistant.told import when

if TYPE_CHECKING:
    from d3a.model import Json
    from d3a.store.base import Store

SCHEMA = 1
_BEYOND = "d3a store copy makes a sound one if all can still be read; else ingest anew"


@click.group("store")
def command() -> None:
    """Copy a store, check and mend it, tell what it is."""


@command.command("copy")
@click.argument("source", metavar="FROM")
@click.argument("target", metavar="TO")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def copy(context: click.Context, source: str, target: str, as_json: bool) -> None:
    """Copy the store FROM into the empty or new store TO, of either kind, and compare both.

    Everything is copied: pictures, checkpoint, history. Status: 0 copied and equal, 3 not.
    """
    from d3a.store import mask, open_store
    from d3a.store.copy import copy_store

    settings = settings_of(context)
    with failures():
        origin = open_store(source, create=False, read_only=True)
        try:
            copied = open_store(target)
            try:
                told = None if settings.quiet or not is_terminal(sys.stderr) else _say_copied
                counts = _copied(copy_store, origin, copied, told)
            finally:
                copied.close()
        finally:
            origin.close()
    record = {"schema": SCHEMA, "from": mask(source), "to": mask(target), "equal": True}
    if as_json:
        emit({**record, "holds": counts})
    else:
        click.echo(f"{clean(mask(target))} is equal to {clean(mask(source))}:")
        click.echo("\n".join(_count_lines(counts)))


def _copied(
    copy_store: Callable[..., Json],
    origin: Store,
    target: Store,
    told: Callable[[int], None] | None,
) -> Json:
    """Copy, and say that a target which was cut short is of no use."""
    from d3a.store.base import StoreDamaged, StoreError, StoreRefused

    try:
        return copy_store(origin, target, progress=told)
    except StoreRefused:
        raise  # nothing was written
    except StoreDamaged as error:
        raise StoreError(
            f"{error}; {target.uri} has only what could be read before: delete it, and take "
            "another copy or ingest anew"
        ) from error
    except StoreError as error:
        raise StoreError(
            f"{error}; {target.uri} is not whole: delete it, and copy again"
        ) from error
    finally:
        if told is not None:
            click.echo(err=True)


def _say_copied(records: int) -> None:
    click.echo(f"\r{records} records", err=True, nl=False)


@command.command("check")
@click.option("--repair", is_flag=True, help="Mend what can be mended, and check again.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def check(context: click.Context, repair: bool, as_json: bool) -> None:
    """Look for damage: pages, indexes, dangling ids, intervals, pictures, checkpoint.

    Status: 0 sound, 1 damaged (with --repair: still), 3 the store cannot be reached.
    """
    settings = settings_of(context)
    damage, mended, hint = _checked(settings, repair=repair)
    if as_json:
        record = {"schema": SCHEMA, "sound": not damage, "damage": damage, "mended": mended}
        emit(record)
    else:
        for sentence in mended:
            click.echo(clean(f"mended: {sentence}"))
        for sentence in damage:
            click.echo(clean(f"damage: {sentence}"))
        click.echo("The store is damaged." if damage else "The store is sound.")
    if damage and not settings.quiet:
        click.echo(f"{hint}; store: {store_name(settings)}", err=True)
    context.exit(ExitCode.NOTHING if damage else ExitCode.OK)


def _checked(settings: Settings, *, repair: bool) -> tuple[list[str], list[str], str]:
    """Return what is damaged, what was mended, and what would do."""
    from d3a.examination import examine, is_beyond, mend
    from d3a.store.base import StoreDamaged

    mended: list[str] = []
    hint = "copy what is sound with d3a store copy" if repair else "--repair mends what it can"
    try:
        with opened(settings) as store:
            damage = examine(store)
            if is_beyond(damage):
                hint = f"its pages cannot be mended; {_BEYOND}"
            elif repair and damage:
                try:
                    mended = mend(store)
                    damage = examine(store)
                except StoreDamaged as error:
                    hint = f"{error.__cause__ or error}; {_BEYOND}"
    except Failure as failure:
        if not isinstance(failure.__cause__, StoreDamaged):
            raise
        damage, hint = [str(failure)], _BEYOND
    return damage, mended, hint


@command.command("info")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def info(context: click.Context, as_json: bool) -> None:
    """Tell what a store is and holds."""
    from d3a.examination import facts_of

    settings = settings_of(context)
    with opened(settings) as store:
        record = {"schema": SCHEMA, **_facts(facts_of(store), settings, store)}
    if as_json:
        emit(record)
        return
    for line in _info_lines(record):
        click.echo(clean(line))


def _facts(facts: Json, settings: Settings, store: Store) -> Json:
    """Return the facts with their times in the home's zone, as text."""
    zone = zone_for(settings, store)
    first, last = facts.pop("first_ms"), facts.pop("last_ms")
    schema = facts.pop("schema")
    return {**facts, "store_schema": schema, "first": _iso(first, zone), "last": _iso(last, zone)}


def _iso(time_ms: int | None, zone: tzinfo) -> str | None:
    return None if time_ms is None else when(time_ms, zone)


def _info_lines(record: Json) -> list[str]:
    kept = record["retain_seconds"]
    lines = [
        f"store       {record['address']}, schema {record['store_schema']}",
        f"seen        {record['first'] or 'nothing yet'} to {record['last'] or '-'}",
        f"zone        {record['zone'] or 'not told'}",
        f"profile     {record['profile'] or '-'}, looks by {record['embedding'] or '-'}",
        f"keeps       {'everything' if kept is None else f'the last {kept / 86_400:g} days'}"
        f"{', and was asked to forget some' if record['forgotten'] else ''}",
        *_count_lines(record["holds"]),
    ]
    for each in record["recordings"]:
        state = "" if each["done"] else ", still open"
        lines.append(f"recording   {each['name']}: {each['frames']} frames{state}")
    return lines


def _count_lines(counts: Json) -> list[str]:
    return [f"{kind:<11} {number}" for kind, number in counts.items()]
