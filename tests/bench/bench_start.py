"""Measure what a person waits for: `d3a` as a whole process, and the chat until it stands there.

    python -m tests.bench.bench_start [--store URI] [--question TEXT] [--runs 10]

Prints the median and the best of the runs in ms, the processor time of one (which other work on
the machine moves less), the number of modules that were loaded, and which of the heavy ones
were. Bytecode is kept, as pip does when it installs; `ask` is also measured where it is not.
Without --store the demo home is filled first.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import select
import statistics
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass

import click

from tests.bench import processes
from tests.worlds import terminals

HEAVY = ("numpy", "lark", "rich", "sqlite3", "pymongo", "PIL", "scipy", "sklearn", "cv2", "textual")
PROGRAM = (
    "import sys\n"
    "from assistant.cli import main\n"
    "try:\n    main(sys.argv[1:], prog_name='d3a')\n"
    "finally:\n    print('LOADED', *sys.modules, file=sys.stderr)\n"
)


@dataclass(frozen=True)
class Measured:
    """Milliseconds of each run, the modules that were loaded, processor time of the median run."""

    runs_ms: list[float]
    modules: frozenset[str] = frozenset()
    processor_ms: float | None = None

    def line(self, name: str) -> str:
        """Return one line of the report."""
        heavy = [module for module in HEAVY if module in self.modules]
        median, least = statistics.median(self.runs_ms), min(self.runs_ms)
        count = f"{len(self.modules)} modules" if self.modules else ""
        processor = "" if self.processor_ms is None else f"{self.processor_ms:.0f}"
        numbers = f"{median:7.0f} {least:7.0f} {processor:>7}"
        return f"{name:<28} {numbers}  {count:<13} {' '.join(heavy)}"


def measure(arguments: list[str], runs: int, environment: Mapping[str, str]) -> Measured:
    """Run `d3a` with the arguments so many times, each in a process of its own."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    processes.run(command, environment)  # fills what is kept: bytecode, the files' cache
    ended = [processes.run(command, environment) for _ in range(runs)]
    for done in ended:
        if done.status not in (0, 1):
            raise SystemExit(f"d3a {' '.join(arguments)} ended with {done.status}: {done.stderr}")
    modules = frozenset(ended[-1].stderr.rpartition("LOADED ")[2].split())
    processor_ms = statistics.median(done.processor_ms for done in ended)
    return Measured([done.wall_ms for done in ended], modules, processor_ms)


def bare(runs: int, environment: Mapping[str, str]) -> Measured:
    """Run an empty program: what no command can be quicker than."""
    ended = [processes.run([sys.executable, "-c", "pass"], environment) for _ in range(runs)]
    processor_ms = statistics.median(done.processor_ms for done in ended)
    return Measured([done.wall_ms for done in ended], processor_ms=processor_ms)


ANSWERS = ((b"\x1b[6n", b"\x1b[1;1R"), (b"\x1b[c", b"\x1b[?62;22c"))
"""What a plain terminal says when it is asked where its cursor is, and what it can do."""


def first_paint(store: str, runs: int, kept: Mapping[str, str]) -> Measured:
    """Open the chat on a pseudo-terminal, until its first bytes that draw the question line.

    The pseudo-terminal answers as a plain one does: a silent one is waited for 0.3 s.
    """
    spent = []
    environment = {**kept, "TERM": "xterm-256color", "COLUMNS": "80", "LINES": "24"}
    command = [sys.executable, "-c", PROGRAM, "chat", "--store", store]
    for _ in range(runs):
        started = time.perf_counter()
        with terminals.opened(command, environment) as terminal:
            seen = b""
            while b"Ask:" not in seen and time.perf_counter() - started < 30:
                if select.select([terminal.master], [], [], 1.0)[0]:
                    seen += (said := os.read(terminal.master, 1 << 16))
                    terminal.type(b"".join(reply for ask, reply in ANSWERS if ask in said))
            spent.append((time.perf_counter() - started) * 1000)
    return Measured(spent)


async def answers(store: str, question: str, runs: int) -> Measured:
    """Type a question in the open chat, and wait until its answer and its picture stand there."""
    from assistant.cli import clock
    from assistant.commands.chat import session_of
    from assistant.config import Settings
    from assistant.ui.app import ChatApp
    from assistant.ui.chat import ChatScreen
    from assistant.ui.prompt import Prompt
    from d3a.store import open_store

    opened = open_store(store)
    shown = asyncio.Event()

    class Watched(ChatScreen):
        """A screen that tells when it was given an answer."""

        def show_answer(self, *arguments: object) -> None:
            super().show_answer(*arguments)  # type: ignore[arg-type]  # passed on as they came
            self.call_after_refresh(shown.set)

    session = session_of(Settings(clock=clock, store=store), opened)
    app = ChatApp(session)
    app.chat = Watched(session, "cells")
    spent = []
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause(0.5)
        for _ in range(runs):
            shown.clear()
            app.chat.query_one(Prompt).value = question
            started = time.perf_counter()
            await pilot.press("enter")
            await asyncio.wait_for(shown.wait(), 30)
            spent.append((time.perf_counter() - started) * 1000)
    opened.close()
    return Measured(spent)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--store")
    parser.add_argument("--question", default="Where are my keys?")
    parser.add_argument("--runs", type=int, default=10)
    given = parser.parse_args()
    store = given.store or demo()
    question = given.question
    click.echo(f"{'':<28} {'median':>7} {'best':>7} {'cpu':>7}  ms, of {given.runs} runs")
    asked = ["ask", question, "--store", store]
    with processes.with_bytecode() as kept:
        click.echo(bare(given.runs, kept).line("python, nothing else"))
        for name, arguments in (
            ("d3a --help", ["--help"]),
            ("d3a parse", ["parse", "--json", question]),
            ("d3a ask", asked),
            ("d3a objects", ["objects", "--store", store]),
        ):
            click.echo(measure(arguments, given.runs, kept).line(name))
        first_paint(store, 1, kept)
        click.echo(first_paint(store, given.runs, kept).line("d3a chat, first paint"))
    bytecode_less = measure(asked, given.runs, processes.without_bytecode())
    click.echo(bytecode_less.line("d3a ask, no bytecode kept"))
    click.echo(asyncio.run(answers(store, question, given.runs)).line("chat, Enter to answer"))


def demo() -> str:
    """Return the address of the filled demo store."""
    from assistant.cli import clock
    from assistant.config import Settings
    from assistant.demo import demo_store

    return demo_store(Settings(clock=clock), click.echo)


if __name__ == "__main__":
    main()
