"""`d3a forget`: take things, places, times or people out of the memory, or keep it short."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from assistant import completing
from assistant.config import Settings
from assistant.exits import ExitCode
from assistant.options import Failure, now_of, opened, settings_of, settings_options, store_name
from assistant.terminal import emit, is_terminal

if TYPE_CHECKING:
    from datetime import datetime

    from d3a.correcting.forgetting import ForgetPlan
    from d3a.correcting.forgotten import Selection
    from d3a.store.base import Store

SCHEMA = 1
_SHOWN = 40
_ELSEWHERE = "where and when it was is said by --place, --before, --after and --between"


@click.command("forget")
@click.argument("words", nargs=-1, metavar="[THING]...", shell_complete=completing.things)
@click.option(
    "--place",
    metavar="NAME",
    shell_complete=completing.places,
    help="What lay in this place, and the views from in it.",
)
@click.option("--before", metavar="TIME", help="What was seen before: ISO, or as one says it.")
@click.option("--after", metavar="TIME", help="What was seen from then on.")
@click.option("--between", nargs=2, metavar="TIME TIME", help="What was seen in between.")
@click.option("--people", is_flag=True, help="Persons, by every word for them.")
@click.option("--retain", metavar="SPAN", help="Keep 30d, 12h, 8w, 1y from now on; off: all.")
@click.option("--dry-run", is_flag=True, help="Only print what would go.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def command(
    context: click.Context,
    words: tuple[str, ...],
    place: str | None,
    before: str | None,
    after: str | None,
    between: tuple[str, str] | None,
    people: bool,
    retain: str | None,
    dry_run: bool,
    yes: bool,
    as_json: bool,
) -> None:
    """Forget the THING (an id, a name, a description), a place, a time or people.

    Conditions are and-ed. Records, pictures and looks go together, and no byte of them is left in
    the store's file. Pictures that may show what is forgotten go even where they are the proof of
    something else. There is no undo: try --dry-run first.

    Status: 0 done, 1 there was nothing of it, 2 usage, 3 the store cannot be reached.
    """
    from d3a.correcting.retention import set_retention

    settings = settings_of(context)
    text = " ".join(words).strip()
    timed = (before, after, between)
    if retain is not None and (text or place or people or any(timed)):
        raise click.UsageError("--retain is for the whole memory; give it alone")
    if between and (before or after):
        raise click.UsageError("--between says both ends; give it without --before and --after")
    with opened(settings) as store:
        now = now_of(settings, store)
        seconds: int | None = None
        if retain is not None:
            seconds = _seconds(retain)
            plan = _old(store, seconds)
        else:
            start, end = between or (after, before)
            plan = _plan(store, _selection(store, text, place, start, end, people, now))
        _settle(context, settings, plan, sure=yes or dry_run or _is_harmless(plan))
        scrubbed = None
        if not dry_run:
            plan, scrubbed = _carry_out(settings, store, plan)
            if retain is not None:
                set_retention(store, seconds)
        _tell(settings, plan, scrubbed, dry_run=dry_run, as_json=as_json, retain=retain)
    nothing = _is_harmless(plan) and retain is None
    if nothing and not settings.quiet:
        click.echo(f"store: {store_name(settings)}", err=True)
    context.exit(ExitCode.NOTHING if nothing else ExitCode.OK)


def _seconds(retain: str) -> int | None:
    from d3a.correcting.retention import seconds_of

    return None if retain.lower() == "off" else seconds_of(retain)


def _old(store: Store, seconds: int | None) -> ForgetPlan | None:
    from d3a.correcting.retention import plan_retention

    return None if seconds is None else plan_retention(store, seconds)


def _selection(
    store: Store,
    text: str,
    place: str | None,
    start: str | None,
    end: str | None,
    people: bool,
    now: datetime,
) -> Selection | None:
    """Return what to forget; None where the words name nothing."""
    from assistant import selecting
    from assistant.lexicon import VocabularyLexicon
    from d3a.correcting.cutting import Slice
    from d3a.correcting.forgetting import people as people_of
    from d3a.correcting.forgotten import Selection

    slice_ = Slice(
        None if start is None else selecting.start_meant(start, now),
        None if end is None else selecting.end_meant(end, now),
    )
    try:
        meant = selecting.things_meant(store, text, now=now, elsewhere=_ELSEWHERE) if text else None
        if meant is not None and meant.doubtful:
            click.echo(
                f"note: {', '.join(meant.doubtful)} may look so too, and stays; "
                "give the id of what shall go too",
                err=True,
            )
        return Selection(
            object_ids=None if meant is None else meant.ids,
            categories=people_of(store, VocabularyLexicon()) if people else None,
            region=selecting.place_meant(store, place) if place else None,
            time=slice_,
        )
    except selecting.NothingMeant as error:
        raise Failure(str(error), ExitCode.NOTHING) from error


def _plan(store: Store, selection: Selection | None) -> ForgetPlan | None:
    from d3a.correcting.forgetting import plan_forgetting

    return None if selection is None else plan_forgetting(store, selection)


def _is_harmless(plan: ForgetPlan | None) -> bool:
    return plan is None or plan.is_empty


def _settle(
    context: click.Context, settings: Settings, plan: ForgetPlan | None, *, sure: bool
) -> None:
    """Ask a person who sits there; refuse to guess where nobody does."""
    if sure or plan is None:
        return
    if not is_terminal(sys.stdin):
        raise click.UsageError("this cannot be undone: look with --dry-run, then say --yes")
    click.echo("\n".join(lines(plan)), err=True)
    if not click.confirm(f"Forget this in {store_name(settings)}?", err=True):
        click.echo("Nothing was forgotten.", err=True)
        context.exit(ExitCode.INTERRUPTED)


def _carry_out(
    settings: Settings, store: Store, plan: ForgetPlan | None
) -> tuple[ForgetPlan | None, bool | None]:
    """Return what went, which may be more than was shown, and whether no byte of it is left."""
    from d3a.correcting.forgetting import forget

    if plan is None or plan.is_empty:
        return plan, None
    done = forget(store, plan)
    if done.is_anew and not settings.quiet:
        said = "somebody wrote to the store meanwhile; what that brought of it is forgotten too"
        click.echo(f"note: {said}", err=True)
    return done.plan, done.is_scrubbed


def _tell(
    settings: Settings,
    plan: ForgetPlan | None,
    scrubbed: bool | None,
    *,
    dry_run: bool,
    as_json: bool,
    retain: str | None,
) -> None:
    if as_json:
        record: dict[str, object] = {"schema": SCHEMA, "dry_run": dry_run, "scrubbed": scrubbed}
        record |= {"retain": retain} if retain is not None else {}
        record |= NOTHING if plan is None else plan.to_json()
        emit(record)
    else:
        if retain is not None:
            said = "everything" if retain.lower() == "off" else f"what is not older than {retain}"
            click.echo(f"{'It would keep' if dry_run else 'The store keeps'} {said}.")
        if plan is None or plan.is_empty:
            click.echo("There is nothing to forget.")
        else:
            click.echo("This would go:" if dry_run else "This is forgotten:")
            click.echo("\n".join(lines(plan)))
    if scrubbed is False and not settings.quiet:
        click.echo(
            "The records are gone; the server overwrites their space at its own pace "
            "(its command compact, and its backups, are yours to see to).",
            err=True,
        )


NOTHING: dict[str, object] = {
    **dict.fromkeys(("objects", "places", "intervals", "shortened", "encounters", "views"), 0),
    **dict.fromkeys(("keyframes", "also_shown", "bytes"), 0),
    "lost": [],
}
"""The counts of a plan that takes nothing."""


def lines(plan: ForgetPlan) -> list[str]:
    """Return what goes, for a person: a row per object, then the counts."""
    from assistant.terminal import table

    rows = [["id", "category", "names", "places", "intervals", "goes"]]
    for lost in plan.lost[:_SHOWN]:
        whole = "altogether" if lost.whole else "in part"
        counted = [str(lost.places), str(lost.intervals), whole]
        rows.append([lost.object_id, lost.category, ", ".join(lost.names), *counted])
    said = table(rows, limits={0: 24, 1: 24, 2: 24}) if plan.lost else []
    if len(plan.lost) > _SHOWN:
        said.append(f"… and {len(plan.lost) - _SHOWN} more objects")
    shortened = f", and a part of {plan.shortened} more" if plan.shortened else ""
    also = f" ({plan.also_shown} of them the proof of other things)" if plan.also_shown else ""
    return [
        *said,
        f"objects    {plan.objects}",
        f"places     {plan.places}",
        f"intervals  {plan.intervals}{shortened}",
        f"together   {plan.encounters}",
        f"views      {plan.views}",
        f"keyframes  {plan.keyframes}{also}",
        f"bytes      {plan.bytes} of pictures and looks",
    ]
