"""The command line: `d3a` opens the chat, `d3a COMMAND` is headless. Commands load when called."""

from __future__ import annotations

import importlib
import io
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any, cast

import click

from assistant import config
from assistant.exits import ExitCode
from assistant.options import settings_options
from assistant.terminal import clean, clean_lines, why_not_full_screen

COMMANDS = {
    "ask": "Answer a question with ranked keyframes.",
    "batch": "Answer questions, a line each, from a file or -.",
    "chat": "Open the chat over a store.",
    "completion": "Let the shell complete commands and the store's words.",
    "config": "Show the settings, and the files they come from.",
    "demo": "Open the chat on a small home that ships with d3a.",
    "doctor": "Check the terminal, the store and the versions; or a recording.",
    "evaluate": "Run the paper's four experiments and write a report.",
    "explain": "Print the formal query, the plan and the store's native queries.",
    "export": "Write a store as COCO, CSV or a recording.",
    "forget": "Take things, places, times or people out of the memory.",
    "ingest": "Fill a store from recordings.",
    "merge": "Say that two objects are the same thing.",
    "objects": "List the objects of a store.",
    "parse": "Print the formal query of each question.",
    "place": "Name the rooms of the home, and keep its floor plan.",
    "simulate": "Write a simulated recording with its truth.",
    "split": "Say that one place of an object is another thing.",
    "store": "Copy a store, check and mend it, tell what it is.",
    "teach": "Say what a thing is called, and whose it is.",
    "undo": "Take back the last thing that was said of the store.",
    "watch": "Fill a store from a recording as it grows, or a live robot.",
}
"""Name to summary: enough for --help, so that it loads no command."""
EVALUATION = ("evaluate", "simulate")
"""Commands of `assistant.evaluation`; the others live in `assistant.commands`."""


def clock() -> datetime:
    """Return the time. Nothing else in the product reads the clock to answer a question."""
    return datetime.now(UTC)


class LazyGroup(click.Group):
    """A group whose commands load when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, for help and completion."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the module of a command and return its `command`."""
        if cmd_name not in COMMANDS:
            return None
        if cmd_name in EVALUATION:
            module = importlib.import_module("assistant.evaluation.commands")
            return cast("click.Command", getattr(module, f"{cmd_name}_command"))
        module = importlib.import_module(f"assistant.commands.{cmd_name}")
        return cast("click.Command", module.command)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Name the nearest command for one that does not exist."""
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            import difflib

            near = difflib.get_close_matches(args[0], COMMANDS, n=1, cutoff=0.6)
            hint = f" Did you mean {near[0]}?" if near else f" There are: {', '.join(COMMANDS)}."
            ctx.fail(f"There is no command {args[0]!r}.{hint}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the summaries without loading a command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run, and leave with the contract's exit status; nobody is shown a traceback."""
        if not standalone_mode:
            return super().main(args, prog_name, complete_var, False, **extra)
        for stream in (sys.stdout, sys.stderr):
            reconfigure = getattr(stream, "reconfigure", None)
            if reconfigure is not None:  # a terminal that lacks a letter must not end the run
                reconfigure(errors="replace")
        sys.exit(int(self._status(args, prog_name, complete_var, extra)))

    def _status(
        self,
        args: Sequence[str] | None,
        prog_name: str | None,
        complete_var: str | None,
        extra: dict[str, Any],
    ) -> int:
        try:
            status = super().main(args, prog_name, complete_var, False, **extra)
        except click.ClickException as error:
            shown = io.StringIO()  # arguments are quoted in it, escapes and all
            error.show(file=shown)
            click.echo(clean_lines(shown.getvalue().rstrip("\n")), err=True)
            return error.exit_code
        except (click.Abort, KeyboardInterrupt):
            return ExitCode.INTERRUPTED
        except config.SettingsError as error:
            click.echo(f"d3a: {clean_lines(str(error))}", err=True)
            return ExitCode.USAGE
        except OSError as error:  # a disk that is full or fails; click has seen to a closed pipe
            name = "" if error.filename is None else f"{error.filename}: "
            click.echo(clean(f"d3a: {name}{error.strerror or error}"), err=True)
            return ExitCode.USAGE
        return status if isinstance(status, int) else ExitCode.OK


def _say_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    """Print the version, as `doctor` names it: a source tree that is not installed has none."""
    if not wanted or context.resilient_parsing:
        return
    from assistant.commands.doctor import versions

    name, version = next(versions())
    click.echo(f"{name} {version}" if version == "not installed" else f"{name}, version {version}")
    context.exit()


@click.group(
    cls=LazyGroup,
    name="d3a",
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Options may stand before or after the command. Without a command the chat opens.",
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_say_version,
    help="Show the version and exit.",
)
@settings_options
@click.pass_context
def main(context: click.Context) -> None:
    """Ask a robot's long memory where a thing was, and get the pictures that prove it."""
    if context.obj is None:
        context.obj = config.load(clock)
    if context.invoked_subcommand is not None:
        return
    if why_not_full_screen() is not None:
        click.echo(context.get_help(), err=True)
        context.exit(ExitCode.USAGE)
    context.invoke(cast("click.Command", main.get_command(context, "chat")))


if __name__ == "__main__":
    main()
