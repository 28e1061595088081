"""A MongoDB that goes away in the middle of a conversation, and comes back: a real server."""

from __future__ import annotations

import importlib.util
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from assistant.conversation import Conversation
from assistant.session import Session
from d3a.store import open_store
from tests.conftest import wait_for_port
from tests.worlds import small_home

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("secantus") is None, reason="secantusdb is not installed"
)


@contextmanager
def serving(folder: Path, port: int) -> Iterator[Callable[[], None]]:
    """Run a server on `port`; yield what ends it."""
    command = [sys.executable, "-m", "secantus", "--host", "127.0.0.1", "--port", str(port)]
    command += ["--storage-path", str(folder / "files"), "--log-level", "WARNING"]
    log = folder / "log.txt"
    with log.open("ab") as out:
        server = subprocess.Popen(command, stdout=out, stderr=out, cwd=folder)

    def end() -> None:
        if server.poll() is None:
            server.send_signal(signal.SIGTERM)
            server.wait(10)

    try:
        wait_for_port(server, port, log)
        yield end
    finally:
        end()


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
        return number


def test_a_lost_server_is_an_answer_and_asking_again_helps(tmp_path: Path) -> None:
    port = free_port()
    uri = f"mongodb://127.0.0.1:{port}/home?serverSelectionTimeoutMS=500"
    with serving(tmp_path, port) as end, closing(open_store(uri)) as store:
        small_home.fill(store)
        talk = Conversation(store, lambda: small_home.NOW)
        session = Session(store, talk.ask, talk.explain, lambda: small_home.NOW)
        assert session.safely("where is the bowl?").status == "found"
        end()
        lost = session.safely("where are my keys?")
        assert (lost.status, lost.suggestions) == ("error", ("where are my keys?",))
        assert "cannot reach" in lost.answer
        assert session.safely("these are my keys").status == "error"
        assert session.explained("where are my keys?")
        with serving(tmp_path, port):
            again = session.safely("where are my keys?")
            assert again.status == "found", again.message
            assert "I will remember" in session.safely("these are my keys").answer
