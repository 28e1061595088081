"""Which way pictures are shown: a terminal is asked once, quickly, and nothing of it leaks."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from assistant.protocols import EXTRA, Told, asked, choose, told_by

ROOT = Path(__file__).parents[2]
CURSOR, KITTY, CELL, ATTRIBUTES = b"\x1b[6n", b"\x1b_Gi=31", b"\x1b[16t", b"\x1b[c"


class Emulator:
    """The far end of a pseudo-terminal: answers what it is asked, after a while; keeps the rest."""

    def __init__(
        self,
        *,
        kitty: bool = False,
        sixel: bool = False,
        late_s: float = 0.0,
        typing: bytes = b"",
        silent: tuple[bytes, ...] = (),
    ) -> None:
        self.master, self.slave = pty.openpty()
        self.seen = b""
        self._answers = {
            CURSOR: typing + b"\x1b[1;1R",
            KITTY: b"\x1b_Gi=31;OK\x1b\\" if kitty else b"",
            CELL: b"\x1b[6;20;9t",
            ATTRIBUTES: b"\x1b[?62;4;22c" if sixel else b"\x1b[?62;22c",
        }
        for question in silent:
            del self._answers[question]
        self._late_s = late_s
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        due: list[tuple[float, bytes]] = []
        answered: dict[bytes, int] = {}
        while not self._ending.is_set():
            if select.select([self.master], [], [], 0.01)[0]:
                try:
                    self.seen += os.read(self.master, 1 << 16)
                except OSError:
                    return
            for question, answer in self._answers.items():
                while self.seen.count(question) > answered.get(question, 0):
                    answered[question] = answered.get(question, 0) + 1
                    due.append((time.monotonic() + self._late_s, answer))
            while due and due[0][0] <= time.monotonic():
                os.write(self.master, due.pop(0)[1])

    def close(self) -> None:
        self._ending.set()
        self._thread.join()
        os.close(self.master)


@pytest.fixture
def emulators() -> Iterator[list[Emulator]]:
    opened: list[Emulator] = []
    yield opened
    for each in opened:
        each.close()


def left_over(descriptor: int, seconds: float = 0.2) -> bytes:
    if select.select([descriptor], [], [], seconds)[0]:
        return os.read(descriptor, 1024)
    return b""


@pytest.mark.parametrize(("kitty", "sixel"), [(True, False), (False, True), (False, False)])
@pytest.mark.parametrize("late_s", [0.0, 0.1])
def test_a_terminal_is_asked_and_leaves_nothing_behind(
    emulators: list[Emulator], kitty: bool, sixel: bool, late_s: float
) -> None:
    terminal = Emulator(kitty=kitty, sixel=sixel, late_s=late_s)
    emulators.append(terminal)
    told = asked(terminal.slave, terminal.slave)
    assert told == Told(kitty=kitty, sixel=sixel, cell=(9, 20))
    assert left_over(terminal.slave) == b""


def test_what_is_typed_meanwhile_is_kept(emulators: list[Emulator]) -> None:
    terminal = Emulator(typing="wo ist die Tür\x1b[A\x7f".encode())
    emulators.append(terminal)
    assert asked(terminal.slave, terminal.slave).typed == "wo ist die Tür"


def test_a_far_terminal_is_never_asked_what_the_chat_would_read_as_typing(
    emulators: list[Emulator],
) -> None:
    terminal = Emulator(sixel=True, late_s=0.6)
    emulators.append(terminal)
    assert asked(terminal.slave, terminal.slave) == Told(silent=True)
    time.sleep(0.6)
    assert terminal.seen.startswith(CURSOR)  # its late answer is one that Textual knows
    assert not any(question in terminal.seen for question in (KITTY, CELL, ATTRIBUTES))


def test_a_terminal_that_says_nothing_is_silent(emulators: list[Emulator]) -> None:
    terminal = Emulator(silent=(CURSOR, ATTRIBUTES))
    emulators.append(terminal)
    assert asked(terminal.slave, terminal.slave) == Told(silent=True)


def test_no_terminal_cannot_be_asked(tmp_path: Path) -> None:
    with (tmp_path / "file").open("w+") as file, pytest.raises(OSError, match=r"ioctl|terminal"):
        asked(file.fileno(), file.fileno())


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        (b"\x1b[?64;1;4c", Told(sixel=True)),
        (b"\x1b[?4c", Told()),  # its class is 4: that is no feature
        (b"\x1b[?c", Told()),
        (b"\x1b_Gi=31;ENOTSUPPORTED\x1b\\\x1b[?1;2c", Told()),
        (b"\x1b[6;0;0t\x1b[?1;2c", Told()),
        (b"a\x1b[?1;2cb\x1bOPc\x1b", Told(typed="abc")),
    ],
)
def test_answers_are_read(answers: bytes, told: Told) -> None:
    assert told_by(answers) == told


def never() -> Told:
    raise AssertionError("the terminal was asked")


@pytest.mark.parametrize(
    ("said", "environ", "has_extra", "kind", "why"),
    [
        ("cells", {}, True, "cells", "settings"),
        ("ascii", {}, True, "ascii", "settings"),
        ("off", {}, False, "off", "settings"),
        ("kitty", {"TMUX": "x"}, True, "kitty", "settings"),
        ("sixel", {}, True, "sixel", "settings"),
        ("kitty", {}, False, "cells", EXTRA),
        ("auto", {}, False, "cells", EXTRA),
        ("auto", {"SSH_CONNECTION": "x"}, True, "cells", "SSH_CONNECTION set"),
        ("auto", {"TMUX": "x", "STY": "y"}, True, "cells", "TMUX and STY set"),
        ("kitty", {"TEXTUAL_DRIVER": "web"}, True, "cells", "browser"),
    ],
)
def test_where_nobody_is_asked(
    said: str, environ: dict[str, str], has_extra: bool, kind: str, why: str
) -> None:
    chosen = choose(said, environ, ask=never, has_extra=has_extra)
    assert chosen.kind == kind
    assert why in chosen.why


@pytest.mark.parametrize(
    ("told", "kind"),
    [
        (Told(kitty=True), "kitty"),
        (Told(sixel=True), "sixel"),
        (Told(kitty=True, sixel=True), "sixel"),  # as Konsole and WezTerm: no placeholders
        (Told(), "cells"),
        (Told(silent=True), "cells"),
    ],
)
def test_auto_takes_what_the_terminal_says(told: Told, kind: str) -> None:
    assert choose("auto", {}, ask=lambda: told, has_extra=True).kind == kind


PROGRAM = """
from assistant.cli import clock
from assistant.commands.chat import hold
from assistant.config import Settings
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
store = OracleStore()
small_home.fill(store)
hold(small_home.session(store), Settings(clock=clock, history=False))
"""


@pytest.mark.parametrize(
    ("kitty", "sixel", "late_s", "drawn_by"),
    [
        (True, False, 0.0, b"\x1b_Gi="),
        (False, True, 0.0, b"\x1bP0;0;0q"),
        (False, True, 0.6, "▀".encode()),  # too far away: cells
        (False, False, 0.0, "▀".encode()),
    ],
)
def test_the_chat_in_such_a_terminal_shows_pictures_and_a_clean_question_line(
    emulators: list[Emulator],
    tmp_path: Path,
    kitty: bool,
    sixel: bool,
    late_s: float,
    drawn_by: bytes,
) -> None:
    pytest.importorskip("textual_image")
    terminal = Emulator(kitty=kitty, sixel=sixel, late_s=late_s)
    emulators.append(terminal)
    kept = {k: v for k, v in os.environ.items() if k not in ("SSH_CONNECTION", "TMUX", "STY")}
    environment = {**kept, "TERM": "xterm-256color", "PYTHONPATH": str(ROOT)}
    environment |= {"COLUMNS": "80", "LINES": "24", "HOME": str(tmp_path)}
    program = tmp_path / "chat.py"
    program.write_text(PROGRAM)
    with subprocess.Popen(
        [sys.executable, str(program)],
        cwd=ROOT,
        env=environment,
        stdin=terminal.slave,
        stdout=terminal.slave,
        stderr=terminal.slave,
        start_new_session=True,
    ) as process:
        try:
            wait_for(terminal, b"Where are the keys?")
            time.sleep(late_s + 0.3)
            before = terminal.seen
            os.write(terminal.master, b"where are my keys\r")
            wait_for(terminal, drawn_by, after=len(before))
            os.write(terminal.master, b"\x11")
            assert process.wait(timeout=20) == 0
        finally:
            process.send_signal(signal.SIGKILL)
    for answer in (b"20;9t", b"?62;", b";22c", b"31;OK", b"1;1R"):
        assert answer not in terminal.seen  # whatever lands in the question line is drawn


def wait_for(terminal: Emulator, words: bytes, after: int = 0, seconds: float = 20.0) -> None:
    given_up = time.monotonic() + seconds
    while words not in terminal.seen[after:]:
        assert time.monotonic() < given_up, terminal.seen[after:][-2000:]
        time.sleep(0.05)
