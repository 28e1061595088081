"""Fixtures of every test: the shared data, the oracle store and a MongoDB server.

Stores are imported where a fixture needs one: the tests of the grammar load none.
"""

from __future__ import annotations

import importlib.util
import itertools
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from d3a.store.base import Store
    from tests.worlds.oracle import OracleStore


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of recordings and question sets that D3A_SHARED names."""
    named = os.environ.get("D3A_SHARED")
    if not named:
        pytest.skip("D3A_SHARED does not name the folder of shared recordings and questions")
    folder = Path(named)
    if not folder.is_dir():
        pytest.fail(f"D3A_SHARED names {folder}, which is not a folder")
    return folder


@pytest.fixture
def oracle_store() -> OracleStore:
    """An empty store that answers by brute force."""
    from tests.worlds.oracle import OracleStore

    return OracleStore()


START_S = 30.0


@pytest.fixture(scope="session")
def mongo_double(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a real wire-protocol server in a process of its own, without a database."""
    if importlib.util.find_spec("secantus") is None:
        pytest.skip("secantusdb is not installed; it has wheels for Python below 3.14")
    folder = tmp_path_factory.mktemp("mongo")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
    command = [sys.executable, "-m", "secantus", "--host", "127.0.0.1", "--port", str(port)]
    command += ["--storage-path", str(folder / "files"), "--log-level", "WARNING"]
    with (folder / "log.txt").open("wb") as log:
        server = subprocess.Popen(command, stdout=log, stderr=log, cwd=folder)
    try:
        wait_for_port(server, port, folder / "log.txt")
        yield f"mongodb://127.0.0.1:{port}"
    finally:
        server.send_signal(signal.SIGTERM)
        try:
            server.wait(10)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()


def wait_for_port(server: subprocess.Popen[bytes], port: int, log: Path) -> None:
    """Return when the server listens; fail with its log where it has ended instead."""
    given_up = time.monotonic() + START_S
    while time.monotonic() < given_up and server.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    pytest.fail(f"the MongoDB double did not start: {log.read_text(errors='replace')}")


@pytest.fixture
def new_database(request: pytest.FixtureRequest) -> Iterator[Callable[[str], str]]:
    """Call it with a server of MONGO_SERVERS for the address of a new, empty database."""
    made: list[tuple[str, str]] = []

    def address(server: str) -> str:
        if server == "double":
            uri: str = request.getfixturevalue("mongo_double")
        else:
            uri = os.environ.get(server, "")
            if not uri:
                pytest.skip(f"{server} does not name a MongoDB server")
        host, _, options = uri.partition("?")
        made.append((uri, f"d3a_test_{os.getpid()}_{time.monotonic_ns()}"))
        return f"{host.rstrip('/')}/{made[-1][1]}{'?' if options else ''}{options}"

    yield address
    if not made:
        return
    from pymongo import MongoClient

    for uri, name in made:
        with MongoClient[dict[str, object]](uri) as client:
            client.drop_database(name)


MONGO_SERVERS = ["double", "D3A_TEST_MONGO_URI"]


@pytest.fixture(params=MONGO_SERVERS)
def mongo_uri(request: pytest.FixtureRequest, new_database: Callable[[str], str]) -> str:
    """The address of a new, empty database on each server there is."""
    return new_database(request.param)


@pytest.fixture(
    params=["oracle", "sqlite", "sqlite without R*Tree", *(f"mongo {s}" for s in MONGO_SERVERS)]
)
def make_store(
    request: pytest.FixtureRequest,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    new_database: Callable[[str], str],
) -> Callable[[], Store]:
    """Make empty stores of each kind: call it, use the store, close it."""
    from d3a.store import open_store, schema
    from tests.worlds.oracle import OracleStore

    kind: str = request.param
    if kind == "oracle":
        return OracleStore
    if kind.startswith("mongo "):
        server = kind.removeprefix("mongo ")
        new_database(server)  # skips here, not in the middle of a test
        return lambda: open_store(new_database(server))
    if kind == "sqlite without R*Tree":
        monkeypatch.setattr(schema, "has_rtree", lambda _: False)
    numbers = itertools.count()
    return lambda: open_store(str(tmp_path / f"{next(numbers)}.db"))
