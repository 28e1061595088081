"""Hold a long chat in a pseudo-terminal: its memory, what it sends, and how long an answer takes.

    python -m tests.bench.bench_chat [--store URI] [--questions 200] [--idle 5]

Prints resident memory when the first screen stands there and after the questions, the bytes of an
answer with its picture, and the bytes sent in so many idle seconds. Without --store it asks the
demo home.
"""

from __future__ import annotations

import argparse
import os
import pty
import re
import select
import statistics
import subprocess
import sys
import time
from pathlib import Path

import click

from tests.bench.bench_start import demo

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


class Terminal:
    """A chat in a pseudo-terminal of 160x50."""

    def __init__(self, store: str) -> None:
        self.master, slave = pty.openpty()
        environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "160", "LINES": "50"}
        environment |= {"D3A_IMAGES": "cells"}
        command = [sys.executable, "-m", "assistant.cli", "chat", "--store", store]
        self.process = subprocess.Popen(
            command,
            env=environment,
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
        )
        os.close(slave)

    def read(self, quiet_s: float, limit_s: float = 30.0) -> bytes:
        """Return what comes until it has been quiet for so long."""
        seen = b""
        given_up = time.monotonic() + limit_s
        while time.monotonic() < given_up:
            if not select.select([self.master], [], [], quiet_s)[0]:
                break
            seen += os.read(self.master, 1 << 16)
        return seen

    def memory_mb(self) -> float:
        """Return the resident memory of the chat, in MB of 10^6 bytes."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        found = re.search(r"VmRSS:\s+(\d+) kB", status)
        assert found is not None
        return int(found[1]) * 1024 / 1e6

    def close(self) -> None:
        os.write(self.master, b"\x11")
        self.process.wait(20)
        os.close(self.master)


def main() -> None:
    """Ask and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--store")
    parser.add_argument("--questions", type=int, default=200)
    parser.add_argument("--idle", type=float, default=5.0)
    given = parser.parse_args()
    terminal = Terminal(given.store or demo())
    try:
        terminal.read(2.0)
        click.echo(f"memory at the start        {terminal.memory_mb():6.0f} MB")
        sizes = []
        for number in range(given.questions):
            os.write(terminal.master, QUESTIONS[number % len(QUESTIONS)].encode() + b"\r")
            sizes.append(len(terminal.read(QUIET_S)))
        click.echo(f"after {given.questions} questions        {terminal.memory_mb():6.0f} MB")
        click.echo(f"bytes of an answer, median {statistics.median(sizes):6.0f}")
        idle = len(terminal.read(given.idle, given.idle))
        click.echo(f"bytes in {given.idle:g} idle seconds    {idle:6d}")
    finally:
        terminal.close()


if __name__ == "__main__":
    main()
