"""The chat in a real terminal (tmux): typing, accepting, resizing, leaving; and what it sends."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.worlds import terminals
from tests.worlds.bare import bare

ROOT = Path(__file__).parents[2]
PROGRAM = """
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from assistant.ui.app import ChatApp
store = OracleStore()
small_home.fill(store)
ChatApp(small_home.session(store)).run()
print("left the chat")
"""


class Terminal:
    """A tmux session of its own server, running the chat over the fixed home."""

    def __init__(self, columns: int, rows: int) -> None:
        self._socket = f"d3a-{uuid.uuid4().hex[:8]}"
        size = ("-x", str(columns), "-y", str(rows))
        environment = {**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8"}
        self._call("-f", os.devnull, "new-session", "-d", *size, "sh", environment=environment)

    def _call(self, *args: str, environment: dict[str, str] | None = None) -> str:
        command = ["tmux", "-L", self._socket, *args]
        done = subprocess.run(
            command, capture_output=True, text=True, check=True, env=environment, timeout=20
        )
        return done.stdout

    def send(self, *keys: str, literal: bool = False) -> None:
        self._call("send-keys", *(["-l"] if literal else []), *keys)

    def resize(self, columns: int, rows: int) -> None:
        size = f"{columns}x{rows}\n"
        deadline = time.monotonic() + 60.0
        while self._call("display-message", "-p", "#{pane_width}x#{pane_height}") != size:
            assert time.monotonic() < deadline
            self._call("resize-window", "-x", str(columns), "-y", str(rows))
            time.sleep(0.1)

    def screen(self) -> str:
        return self._call("capture-pane", "-p")

    def until(self, condition: Callable[[str], bool], seconds: float = 60.0) -> str:
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            screen = self.screen()
            if condition(screen):
                return screen
            time.sleep(0.1)
        raise AssertionError(f"never came true; the screen says:\n{self.screen()}")

    def close(self) -> None:
        subprocess.run(["tmux", "-L", self._socket, "kill-server"], check=False, timeout=20)


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    if shutil.which("tmux") is None:
        pytest.skip("tmux is not installed")
    opened = Terminal(80, 24)
    yield opened
    opened.close()


def test_a_conversation_in_tmux(terminal: Terminal, tmp_path: Path) -> None:
    program = tmp_path / "chat.py"
    program.write_text(PROGRAM)
    start = f"cd '{ROOT}' && PYTHONPATH=. '{sys.executable}' '{program}'"
    terminal.send(start, literal=True)
    terminal.send("Enter")
    terminal.until(lambda screen: "Where are the keys?" in screen)

    terminal.send("did you see the bo", literal=True)
    terminal.until(lambda screen: "did you see the bowl" in screen)  # the grey suggestion
    terminal.send("Right")
    terminal.send("Enter")
    screen = terminal.until(lambda screen: "You: did you see the bowl" in screen)
    screen = terminal.until(lambda screen: "┏" in screen)  # the box in the picture
    assert "On the kitchen table." in screen
    assert ">  1  9:42 today" in screen
    assert "kitchen" in screen
    assert "1 best" in screen
    lines = screen.splitlines()
    assert len(lines) == 24
    assert lines[22].strip().startswith("Ask:")
    assert "f1 Help" in lines[23]
    assert "^q Quit" in lines[23]

    terminal.resize(160, 50)
    wide = ("Around the box", "whole picture", "now 19:00")  # crop, picture, timeline
    terminal.until(lambda screen: all(words in screen for words in wide))
    terminal.resize(50, 12)

    def is_drawn_anew(screen: str) -> bool:  # tmux cuts the old screen by itself, at either end
        has_ends = "9:42 today" in screen and screen.splitlines()[-1].startswith("f1 Help")
        return has_ends and "Around the box" not in screen and "┏" not in screen

    terminal.until(is_drawn_anew)
    terminal.resize(30, 8)
    terminal.until(lambda screen: "make the window larger" in screen)
    terminal.resize(80, 24)
    terminal.until(lambda screen: "┏" in screen)

    terminal.send("C-q")
    terminal.until(lambda screen: "left the chat" in screen)


def test_an_idle_chat_sends_nothing(tmp_path: Path) -> None:
    """Neither a blinking cursor nor a clock may cost bytes on a slow line.

    A loaded machine may take seconds to draw what was asked for, so each screen is waited for by
    what stands on it; then two seconds in a row have to be silent, which a blink or a clock, that
    comes each second, never leaves.
    """
    environment = {**os.environ, "TERM": "xterm-256color", "PYTHONPATH": str(ROOT)}
    environment |= {"COLUMNS": "80", "LINES": "24"}
    program = tmp_path / "chat.py"
    program.write_text(PROGRAM)
    with terminals.opened([sys.executable, str(program)], environment, cwd=ROOT) as terminal:
        terminal.read_until(b"Where are the keys?")
        terminal.type("where are my keys\r")
        terminal.read_until("┏".encode())  # the box in the picture
        assert any(terminal.read(seconds=2.0) == b"" for _ in range(10))
        terminal.type("\x11")
        terminal.read(seconds=2.0)
        assert terminal.process.wait(timeout=60) == 0


def test_bare_d3a_opens_the_chat_on_a_terminal(tmp_path: Path) -> None:
    command, environment = bare(tmp_path)
    with terminals.opened(command, environment, cwd=tmp_path, size=(24, 80)) as terminal:
        terminal.read_until(b"\x1b[?1049h")  # the alternate screen: not line by line
        terminal.read_until(b"Ask:")
        terminal.type("where are my keys?\r")
        terminal.read_until("┏".encode())
        terminal.type("\x11")
        terminal.read_until(b"\x1b[?1049l")
        assert terminal.process.wait(timeout=60) == 0


def test_a_chat_ends_with_its_terminal(tmp_path: Path) -> None:
    """Also where the terminal does not control it, and the system sends no signal."""
    command, environment = bare(tmp_path)
    with terminals.opened(command, environment, cwd=tmp_path, size=(24, 80)) as terminal:
        terminal.read_until(b"Ask:")
        terminal.hang_up()
        assert terminal.process.wait(timeout=60) == -signal.SIGHUP


@pytest.mark.parametrize("term", ["xterm-256color", "dumb"])
def test_bare_d3a_prints_its_help_off_a_terminal(tmp_path: Path, term: str) -> None:
    command, environment = bare(tmp_path)
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env=environment | {"TERM": term},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("Usage: ")
    assert "Without a command the chat" in done.stderr
    assert "\x1b" not in done.stderr
