"""What `d3a chat --serve` and `d3a demo --serve` share: options, the child's settings, the talk."""

from __future__ import annotations

import importlib.util
import os
import socket
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import click

from assistant.exits import ExitCode
from assistant.options import Failure

if TYPE_CHECKING:
    from assistant.config import Settings

PORT = 8421
EXTRA = "pip install 'd3a[serve]'"
_Function = TypeVar("_Function", bound=Callable[..., Any])


def serving_options(function: _Function) -> _Function:
    """Add --serve and --port, and the flag that the served chat itself is started with."""
    options = (
        click.option("--serve", is_flag=True, help="In a browser of this machine, not here."),
        click.option(
            "--port",
            type=click.IntRange(0, 65535),
            default=PORT,
            show_default=True,
            help="With --serve; 0 for any that is free.",
        ),
        click.option("--served", is_flag=True, hidden=True),
    )
    for option in reversed(options):
        function = option(function)
    return function


def serve(name: str, settings: Settings, port: int) -> None:
    """Serve the chat that `d3a NAME` opens, until it is interrupted.

    Each page gets a process of its own. It is told its settings by the environment: a store's
    password has no place among the arguments, which every user of the machine can read.
    """
    if importlib.util.find_spec("textual_serve") is None:
        raise Failure(f"the chat in a browser needs the extra: {EXTRA}", ExitCode.USAGE)
    from assistant.ui.serving import ChatServer

    for setting in ("store", "zone", "now", "images"):
        value = getattr(settings, setting)
        if value is not None:
            os.environ[f"D3A_{setting.upper()}"] = value
    command = [sys.executable, "-m", "assistant.cli", name, "--served"]
    stdout = sys.stdout  # the server sends what it says itself to standard error
    try:
        server = ChatServer(
            command, port=port, started=lambda address: _say(address, settings, stdout)
        )
    except OSError as error:
        words = f"port {port} cannot be had: {error.strerror}; --port names another"
        raise Failure(words, ExitCode.USAGE) from error
    server.serve()


def _say(address: str, settings: Settings, stdout: TextIO) -> None:
    """Print the address as data, and how to come there from elsewhere as talk."""
    stdout.write(f"{address}\n")
    stdout.flush()
    if settings.quiet:
        return
    port = address.partition("/?")[0].rpartition(":")[2]
    click.echo(
        "d3a: open this address in a browser of this machine; Ctrl+C ends it. From another one:\n"
        f"     ssh -N -L {port}:127.0.0.1:{port} {socket.gethostname()}",
        err=True,
    )
