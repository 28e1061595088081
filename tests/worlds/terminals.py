"""A program in a pseudo-terminal: what it shows is read at the other end, what is typed goes in."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Opened:
    """A running program, and the end of the terminal at which a person would sit."""

    process: subprocess.Popen[bytes]
    master: int
    behind: bytearray = field(default_factory=bytearray)
    """What came with the words that were last waited for, behind them."""

    def type(self, said: str | bytes) -> None:
        """Send keys."""
        os.write(self.master, said.encode() if isinstance(said, str) else said)

    def hang_up(self) -> None:
        """Take the terminal away: nothing is read from the program any more, or typed into it."""
        other = os.open(os.devnull, os.O_RDWR)
        os.dup2(other, self.master)
        os.close(other)

    def read(self, *, seconds: float) -> bytes:
        """Return the bytes that come within so many seconds."""
        self.behind.clear()
        seen = b""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            if not select.select([self.master], [], [], left)[0]:
                break
            try:
                seen += os.read(self.master, 1 << 16)
            except OSError:  # the other end was closed
                break
        return seen

    def read_until(self, words: bytes, limit_s: float = 180.0) -> None:
        """Read until `words` have come, or the program has ended without them."""
        seen = bytes(self.behind)
        deadline = time.monotonic() + limit_s
        while words not in seen:
            has_ended = self.process.poll() is not None  # what it wrote before is read all the same
            seen += self.read(seconds=0.1)
            assert words in seen or not has_ended, seen[-1000:]
            assert time.monotonic() < deadline, seen[-1000:]
        self.behind[:] = seen.partition(words)[2]

    def read_all(self) -> bytes:
        """Return what comes until the program has closed the terminal."""
        seen = bytes(self.behind)
        while True:
            try:
                seen += os.read(self.master, 1 << 16)
            except OSError:  # the program has ended
                return seen


def _hear_signals() -> None:
    """Undo what is inherited of tests that run in the background: no Ctrl+C is heard there."""
    for each in (signal.SIGINT, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)


@contextmanager
def opened(
    command: Sequence[str],
    environment: Mapping[str, str],
    *,
    cwd: Path | None = None,
    size: tuple[int, int] | None = None,
) -> Iterator[Opened]:
    """Run a command in a pseudo-terminal of its own; it is killed at the end, if it still runs.

    size: rows and columns; None leaves them to the environment.
    """
    import pty  # not on every system

    master, slave = pty.openpty()
    if size is not None:
        import termios

        termios.tcsetwinsize(slave, size)
    try:
        with subprocess.Popen(
            command,
            cwd=cwd,
            env=environment,
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
            preexec_fn=_hear_signals,
        ) as process:
            os.close(slave)
            try:
                yield Opened(process, master)
            finally:
                process.kill()
    finally:
        os.close(master)
