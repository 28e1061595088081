"""Hold a long chat in a pseudo-terminal: its memory, what it sends, and how long an answer takes.

    python -m tests.bench.bench_chat [--store URI] [--questions 200] [--idle 5]

Prints resident memory when the first screen stands there and after the questions, the bytes of an
answer with its picture, and the bytes sent in so many idle seconds. Without --store it asks the
demo home.
"""

from __future__ import annotations

import argparse
import os
import re
import select
import statistics
import sys
import time
from pathlib import Path

import click

from tests.bench.bench_start import demo
from tests.worlds.terminals import Opened, opened

QUESTIONS = (
    "where are my keys?",
    "where is the blue cup?",
    "did you see an umbrella?",
    "what moved today?",
    "when were the cup and the bowl seen together?",
    "where was my handbag yesterday evening?",
    "how many chairs are there?",
    "and the bowl?",
)
QUIET_S = 0.25


def read(terminal: Opened, quiet_s: float, limit_s: float = 30.0) -> bytes:
    """Return what comes until it has been quiet for so long."""
    seen = b""
    given_up = time.monotonic() + limit_s
    while time.monotonic() < given_up:
        if not select.select([terminal.master], [], [], quiet_s)[0]:
            break
        seen += os.read(terminal.master, 1 << 16)
    return seen


def memory_mb(terminal: Opened) -> float:
    """Return the resident memory of the chat, in MB of 10^6 bytes."""
    status = Path(f"/proc/{terminal.process.pid}/status").read_text()
    found = re.search(r"VmRSS:\s+(\d+) kB", status)
    assert found is not None
    return int(found[1]) * 1024 / 1e6


def main() -> None:
    """Ask and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--store")
    parser.add_argument("--questions", type=int, default=200)
    parser.add_argument("--idle", type=float, default=5.0)
    given = parser.parse_args()
    command = [sys.executable, "-m", "assistant.cli", "chat", "--store", given.store or demo()]
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "160", "LINES": "50"}
    with opened(command, environment | {"D3A_IMAGES": "cells"}) as terminal:
        read(terminal, 2.0)
        click.echo(f"memory at the start        {memory_mb(terminal):6.0f} MB")
        sizes = []
        for number in range(given.questions):
            terminal.type(QUESTIONS[number % len(QUESTIONS)] + "\r")
            sizes.append(len(read(terminal, QUIET_S)))
        click.echo(f"after {given.questions} questions        {memory_mb(terminal):6.0f} MB")
        click.echo(f"bytes of an answer, median {statistics.median(sizes):6.0f}")
        idle = len(read(terminal, given.idle, given.idle))
        click.echo(f"bytes in {given.idle:g} idle seconds    {idle:6d}")
        terminal.type("\x11")
        terminal.process.wait(20)


if __name__ == "__main__":
    main()
