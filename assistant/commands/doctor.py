"""`d3a doctor`: what this terminal, this machine and this store can do; or what a recording has."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import click

from assistant.config import Settings, machine_zone, user_file
from assistant.exits import ExitCode
from assistant.options import (
    Failure,
    failures,
    opened,
    settings_of,
    settings_options,
    store_name,
    zone_if_said,
)
from assistant.protocols import choose
from assistant.terminal import clean, emit, why_not_full_screen

SCHEMA = 1
LIBRARIES = ("numpy", "lark", "rapidfuzz", "textual", "rich", "pillow", "pymongo", "scikit-learn")


@click.command("doctor")
@click.argument("source", required=False, type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@click.option(
    "--format", "format_name", metavar="NAME", help="Reader of SOURCE; by default by looking."
)
@click.option(
    "--reader",
    "reader_options",
    multiple=True,
    metavar="KEY=VALUE",
    help="Tell the reader of SOURCE something, as for ingest.",
)
@click.option(
    "--topic", "topics", multiple=True, metavar="NAME=TOPIC", help="Which topic of a bag to read."
)
@settings_options
@click.pass_context
def command(
    context: click.Context,
    /,
    source: Path | None,
    as_json: bool,
    format_name: str | None,
    reader_options: tuple[str, ...],
    topics: tuple[str, ...],
) -> None:
    """Check the terminal, the time zone, the store and the versions; or the recording SOURCE.

    Without SOURCE, status 3 when the store cannot be opened or is damaged. With SOURCE nothing is
    stored: it says what the recording holds, what is missing and what that costs. Status 1 when
    it needs something more before it can be ingested, 2 when it cannot be read.
    """
    settings = settings_of(context)
    if source is not None:
        told = (*reader_options, *(f"topic.{topic}" for topic in topics))
        context.exit(examine(settings, source, format_name, told, as_json=as_json))
    if format_name is not None or reader_options or topics:
        raise click.UsageError("--format, --reader and --topic are of a recording: name one.")
    status, store = store_findings(settings)
    record: dict[str, object] = {
        "schema": SCHEMA,
        "terminal": dict(terminal_findings(settings, os.environ)),
        "settings": str(user_file()),
        "store": store,
        "versions": dict(versions()),
    }
    if as_json:
        emit(record)
    else:
        for line in lines(record):
            click.echo(clean(line))
    context.exit(status)


def examine(
    settings: Settings,
    source: Path,
    format_name: str | None,
    told: tuple[str, ...],
    *,
    as_json: bool,
) -> ExitCode:
    """Print what a recording holds and lacks; return the status."""
    from assistant import survey_report
    from d3a.ingesting import survey
    from d3a.readers.opening import format_of, open_source
    from d3a.readers.options import key_values

    with failures():
        name = format_of(source, format_name)
        reader = open_source(source, format=name, zone=settings.zone, options=key_values(told))
        found = survey.survey(reader)
    is_ready = not any(lack.needed for lack in survey.lacks(found))
    if as_json:
        record = {"schema": SCHEMA, "source": str(source), "format": name, "ready": is_ready}
        record |= survey.to_json(found)
        emit(record)
    else:
        for line in survey_report.lines(found, str(source), name):
            click.echo(clean(line))
    return ExitCode.OK if is_ready else ExitCode.NOTHING


def lines(record: Mapping[str, object], indent: str = "") -> Iterator[str]:
    """Yield the findings as lines, what belongs together below its name."""
    for name, value in record.items():
        if name == "schema":
            continue
        if isinstance(value, Mapping):
            yield f"{indent}{name}"
            yield from lines(value, indent + "  ")
        elif isinstance(value, list):
            yield f"{indent}{name:<12} {'; '.join(map(str, value)) or 'none'}"
        else:
            yield f"{indent}{name:<12} {value}"


def terminal_findings(settings: Settings, environ: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield what the chat would find here."""
    reason = why_not_full_screen(environ)
    yield "chat", "full screen" if reason is None else f"line by line: {reason}"
    yield "TERM", environ.get("TERM", "not set")
    yield "encoding", getattr(sys.stdout, "encoding", None) or "unknown"
    far = [name for name in ("SSH_CONNECTION", "TMUX", "STY") if environ.get(name)]
    yield "through", ", ".join(far) or "nothing: a terminal of this machine"
    yield "colours", "off (NO_COLOR)" if environ.get("NO_COLOR") else "as the terminal has them"
    yield "images", images_finding(settings, environ, reason)
    yield "machine zone", str(machine_zone())


def images_finding(settings: Settings, environ: Mapping[str, str], reason: str | None) -> str:
    """Say how the chat would show pictures here, and why; a terminal is asked as the chat does."""
    if reason is not None:
        return f"{settings.images}; none in a chat that is held line by line"
    chosen = choose(settings.images, environ)
    said = f"{settings.images}: " if settings.images != chosen.kind else ""
    return f"{said}{chosen.kind} ({chosen.why})"


def store_findings(settings: Settings) -> tuple[ExitCode, dict[str, object]]:
    """Return the status, and what the store holds or why it cannot be had."""
    try:
        with opened(settings) as store:
            damage = store.check()
            zone = zone_if_said(settings, store)
            found: dict[str, object] = {
                "address": store_name(settings),
                "zone": str(zone) if zone else "not told; the machine's is used",
                "holds": store.counts(),
                "damage": damage,
            }
            return (ExitCode.STORE if damage else ExitCode.OK), found
    except Failure as error:
        return ExitCode.STORE, {"address": store_name(settings), "problem": error.message}


def versions() -> Iterator[tuple[str, str]]:
    """Yield the versions of the product, of Python, and of the libraries it stands on."""
    for name in ("d3a", *LIBRARIES):
        try:
            yield name, version(name)
        except PackageNotFoundError:
            yield name, "not installed"
    yield "python", f"{platform.python_version()} on {platform.system()}"
