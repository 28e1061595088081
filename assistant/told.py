"""What the commands for people's corrections share: names as said, one record, one error."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime, timedelta, tzinfo
from typing import TYPE_CHECKING

import click

from assistant.exits import ExitCode
from assistant.options import Failure, now_of, opened, settings_of, zone_for
from assistant.terminal import clean, emit

if TYPE_CHECKING:
    from d3a.constraints import Correction
    from d3a.model import Json
    from d3a.store.base import Store

SCHEMA = 1
Act = Callable[["Store", int], "Correction"]


def told_name(said: str, now: datetime) -> tuple[str, str | None]:
    """Return the name and the owner in "Anna's keys": ("key", "anna"), as questions have them.

    The grammar reads it as it will read the question, so that both are the same words; what it
    cannot read is a name as it is.
    """
    from grammar import parse_report
    from grammar.errors import QuestionError

    words = " ".join(said.split())
    try:
        read = parse_report(f"where is {words}?", now=now)
    except QuestionError:
        return words, None
    query = read.query
    plain = len(query.objects) == 1 and query.relation is None and query.place is None
    if not plain or read.corrections or query.objects[0].where is not None or query.negated:
        return words, None
    thing = query.objects[0]
    return " ".join([*thing.attributes, thing.word]), thing.owner


def said_name(said: str, kind: str, now: datetime) -> tuple[str, str | None]:
    """Return word and owner of a name as questions have them; of "mine", "Tom's" the kind alone."""
    if said in ("mine", "ours"):
        return kind, "me"
    alone = said.removesuffix("'s").removesuffix("'")
    if alone != said and " " not in alone:
        return kind, told_owner(alone)
    return told_name(said, now)


def told_owner(said: str | None) -> str | None:
    """Return an owner as questions have it: "me" for me, my and mine."""
    if said is None:
        return None
    owner = " ".join(said.lower().split())
    return "me" if owner in ("me", "my", "mine", "i", "our", "us") else owner


def carry_out(context: click.Context, act: Act, *, as_json: bool, create: bool = False) -> None:
    """Do what was said, and print the record of it; a failure is a record and a status too."""
    from d3a.correcting.corrections import UnknownThing
    from d3a.model import BadInput

    settings = settings_of(context)
    with opened(settings, create=create) as store:
        now = now_of(settings, store)
        zone = zone_for(settings, store)
        try:
            done = act(store, round(now.timestamp() * 1000))
        except UnknownThing as error:
            raise refusal(str(error), ExitCode.NOTHING, error.suggestions, as_json) from error
        except BadInput as error:
            raise refusal(str(error), ExitCode.USAGE, (), as_json) from error
    if as_json:
        emit(record_of(done, zone))
    else:
        click.echo(sentence_of(done))
        doubts = done.arguments.get("doubts") if context.command.name == "merge" else None
        if doubts and not settings.quiet:
            click.echo(clean(f"note: {'; '.join(doubts)}"), err=True)
        if not settings.quiet and done.number > 0 and context.command.name != "undo":
            click.echo("d3a undo takes it back.", err=True)


def refusal(message: str, status: ExitCode, suggestions: tuple[str, ...], as_json: bool) -> Failure:
    """Return the failure, its record printed where JSON was asked for."""
    if as_json:
        name = "unknown" if status == ExitCode.NOTHING else "refused"
        emit({"schema": SCHEMA, "error": name, "message": message, "suggestions": [*suggestions]})
    return Failure(message, status)


def sentence_of(correction: Correction) -> str:
    """Return what was said as a line; it may begin with an id, which keeps its case."""
    already = "" if correction.number > 0 else " already"
    return f"{clean(correction.said)}{already}"


def record_of(correction: Correction, zone: tzinfo) -> Json:
    """Return a correction as JSON: what was said, when, of which objects or places."""
    said = correction.arguments
    record: Json = {
        "schema": SCHEMA,
        "number": correction.number or None,
        "kind": correction.kind,
        "said": correction.said,
        "at": None if correction.at_ms is None else when(correction.at_ms, zone),
        "changed": correction.number > 0,
        "can_be_undone": correction.number > 0 and not correction.is_sealed,
        "object_ids": sorted(correction.ids()),
    }
    if correction.kind == "merge":
        record |= {"object_id": said["kept"], "was": said["gone"]}
        record["doubts"] = said.get("doubts", [])  # older stores have none
    elif correction.kind == "split":
        record |= {"object_id": said["object"], "place": said["place"], "new_id": said["new"]}
        from_ms = said.get("from_ms")
        record["since"] = None if from_ms is None else when(from_ms, zone)
    elif correction.kind == "teach":
        names = [{"word": word, "owner": owner} for word, owner in said["after"]]
        record |= {"object_id": said["ids"][0], "names": names}
    elif correction.kind == "place":
        record |= {"before": said["before"], "after": said["after"]}
    return record


def when(milliseconds: int, zone: tzinfo) -> str:
    """Return UTC milliseconds as ISO time in a zone."""
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=milliseconds)
    return moment.astimezone(zone).isoformat(timespec="seconds")
