"""`d3a doctor`: what this terminal, this machine and this store can do."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version

import click

from assistant.config import Settings, machine_zone, user_file
from assistant.exits import ExitCode
from assistant.options import (
    Failure,
    opened,
    settings_of,
    settings_options,
    store_name,
    zone_if_said,
)
from assistant.terminal import clean, json_line, speaks_unicode, why_not_full_screen

SCHEMA = 1
LIBRARIES = ("numpy", "lark", "rapidfuzz", "textual", "rich", "pillow", "pymongo", "scikit-learn")


@click.command("doctor")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def command(context: click.Context, as_json: bool) -> None:
    """Check the terminal, the time zone, the store and the versions.

    Status 3 when the store cannot be opened or is damaged.
    """
    settings = settings_of(context)
    status, store = store_findings(settings)
    record: dict[str, object] = {
        "schema": SCHEMA,
        "terminal": dict(terminal_findings(settings, os.environ)),
        "settings": str(user_file()),
        "store": store,
        "versions": dict(versions()),
    }
    if as_json:
        click.echo(json_line(record, ascii_only=not speaks_unicode(sys.stdout)))
    else:
        for line in lines(record):
            click.echo(clean(line))
    context.exit(status)


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
    yield "pictures", settings.pictures
    yield "machine zone", str(machine_zone())


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
