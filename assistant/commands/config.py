"""`d3a config`: which settings hold, from where, and a file to start from."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import click

from assistant.config import FILE, HIDDEN, Settings, user_file
from assistant.exits import ExitCode
from assistant.options import Failure, settings_of, settings_options, store_name
from assistant.terminal import clean, emit

SAMPLE = """\
# Settings of d3a. Stronger, in this order: ./d3a.toml, the environment (D3A_STORE ...), flags.
# store = "mongodb://robot.local/home"   # or a file: "sqlite:////home/me/robot.db"
# zone = "Europe/Berlin"                 # times are said in this zone; else in the home's own
# color = "auto"                         # auto, always, never
# images = "auto"                        # auto, kitty, sixel, cells, ascii, off
# history = true                         # keep questions for the next chat
# speak = "espeak-ng -s 150"             # says an answer aloud; else spd-say, say or espeak-ng
# theme = "high-contrast"                # of the chat: textual-light, ansi-dark ...; see /theme
# [keys]                                 # of the chat, by what they do: help, picture, map, speak,
# why = "ctrl+y"                         # large, save, why, copy, palette, quit, earlier, later
"""


@click.group("config")
def command() -> None:
    """Show the settings, the files they come from, and start one."""


@command.command("show")
@click.option("--json", "as_json", is_flag=True, help="One JSON object.")
@settings_options
@click.pass_context
def show(context: click.Context, as_json: bool) -> None:
    """Print the settings that hold here; passwords are masked."""
    settings = settings_of(context)
    record = {name: getattr(settings, name) for name in names()}
    record["store"] = store_name(settings)
    if as_json:
        record = {"schema": 1, **record}
        emit(record)
        return
    record["keys"] = ", ".join(f"{k}: {v}" for k, v in settings.keys.items()) or None
    for name, value in record.items():
        click.echo(clean(f"{name:<9} {'not set' if value in (None, '') else value}"))


@command.command("path")
@click.option("--json", "as_json", is_flag=True, help="A JSON object a line.")
def path(as_json: bool) -> None:
    """Print the files that are read, the weaker first."""
    for file in (user_file(), Path(FILE).absolute()):
        if as_json:
            record = {"schema": 1, "path": str(file), "exists": file.exists()}
            emit(record)
            continue
        click.echo(f"{file}{'' if file.exists() else ' (does not exist)'}")


@command.command("init")
def init() -> None:
    """Write a settings file to start from; one that is there is left alone."""
    file = user_file()
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with file.open("x", encoding="utf-8") as opened:
            opened.write(SAMPLE)
    except FileExistsError:
        raise Failure(f"{file} is there already; it was left alone", ExitCode.USAGE) from None
    except OSError as error:
        raise Failure(f"{file} cannot be written: {error.strerror}", ExitCode.USAGE) from error
    click.echo(str(file))


def names() -> list[str]:
    """Return the names that a settings file may hold."""
    return [field.name for field in fields(Settings) if field.name not in HIDDEN]
