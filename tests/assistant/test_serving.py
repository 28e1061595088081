"""The chat in a browser: on loopback, behind a key, a process a page, nothing loaded from afar."""

from __future__ import annotations

import asyncio
import io
import math
import os
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from assistant import config
from assistant.cli import main
from assistant.serving import EXTRA
from assistant.ui.cells import BOX_INK
from d3a.store import open_store
from tests.worlds import small_home

aiohttp = pytest.importorskip("aiohttp")
pytest.importorskip("textual_serve")

from tests.worlds import chromium  # noqa: E402  needs aiohttp


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("served")
    store = open_store(str(folder / "memory.db"))
    small_home.fill(store)
    store.close()
    with chromium.served("chat", D3A_STORE=str(folder / "memory.db"), HOME=str(folder)) as shown:
        yield shown


def parts(address: str) -> tuple[str, str]:
    base, _, key = address.partition("/?key=")
    return base, key


async def status(address: str, **headers: str) -> int:
    async with (
        aiohttp.ClientSession(cookie_jar=aiohttp.DummyCookieJar()) as client,
        client.get(address, headers=headers) as response,
    ):
        await response.read()
        code: int = response.status
        return code


async def test_it_listens_on_loopback_and_wants_the_key(address: str) -> None:
    base, key = parts(address)
    assert base.startswith("http://127.0.0.1:")
    assert len(key) >= 20
    assert await status(address) == 200
    port = base.rpartition(":")[2]
    assert await status(address, Host=f"localhost:{port}") == 200
    assert await status(f"{base}/") == 403
    assert await status(f"{base}/?key=x{key[1:]}") == 403
    assert await status(f"{base}/?key=%C3%BC") == 403
    assert await status(f"{base}/static/js/textual.js") == 403
    assert await status(address, Host=f"robot.example:{port}") == 403  # a name turned to loopback
    assert await status(address, Origin="http://elsewhere.example") == 403
    with pytest.raises(OSError, match="refused"), socket.socket() as other:
        other.connect(("127.0.0.2", int(port)))


async def test_the_page_keeps_the_key_in_a_cookie_and_loads_nothing_from_afar(address: str) -> None:
    base, _ = parts(address)
    jar = aiohttp.CookieJar(unsafe=True)
    async with aiohttp.ClientSession(cookie_jar=jar) as client:
        async with client.get(address) as response:
            page = await response.text()
            cookie = response.headers["Set-Cookie"]
            policy = response.headers["Content-Security-Policy"]
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        assert "default-src 'self'" in policy
        assert "https://" not in page
        assert f'"ws://{base.removeprefix("http://")}/ws"' in page
        async with client.get(f"{base}/static/js/textual.js") as response:
            assert response.status == 200


async def test_a_question_is_answered_over_the_socket(address: str) -> None:
    base, key = parts(address)
    async with aiohttp.ClientSession() as client:
        with pytest.raises(aiohttp.WSServerHandshakeError):
            await client.ws_connect(f"{base}/ws?width=80&height=24")
        async with client.ws_connect(f"{base}/ws?width=80&height=24&key={key}") as connected:
            await read_until(connected, b"Where")
            await connected.send_json(["stdin", "where are my keys?\r"])
            await read_until(connected, b"You: where are my keys?")
            await read_until(connected, "┏".encode())  # the box in the picture
            await connected.send_json(["stdin", "\x11"])
            given_up = time.monotonic() + 20
            while not connected.closed and time.monotonic() < given_up:
                await connected.receive(timeout=20)
            assert connected.closed  # the chat has ended, and the page is told


async def read_until(connected: object, words: bytes) -> None:
    seen = b""
    while words not in seen:
        message = await connected.receive(timeout=30)  # type: ignore[attr-defined]
        assert message.type in (aiohttp.WSMsgType.BINARY, aiohttp.WSMsgType.TEXT), seen[-500:]
        seen += message.data if isinstance(message.data, bytes) else message.data.encode()


def yellow(png: bytes) -> int:
    """Count the pixels of a box's colour."""
    from PIL import Image

    with Image.open(io.BytesIO(png)) as shot:
        colours = shot.convert("RGB").getcolors(1 << 24) or ()
    return sum(count for count, colour in colours if colour == BOX_INK)


async def test_in_chromium(address: str) -> None:
    if chromium.program() is None:
        pytest.skip("Chromium is not installed")
    async with chromium.browser() as page:
        await page.open(address, 1000, 600)
        await page.until("document.body.classList.contains('-first-byte')")
        await page.until("document.activeElement.tagName == 'TEXTAREA'")  # nobody has to click
        given_up, asked = time.monotonic() + 30, -math.inf
        while yellow(await page.picture()) < 50:  # the box in the picture
            assert time.monotonic() < given_up
            if time.monotonic() > asked + 8:  # a busy machine's chat may not have listened yet
                await page.type("where are my keys?\r")
                asked = time.monotonic()
            await asyncio.sleep(0.2)
        base, _ = parts(address)
        assert any(request.startswith("ws://") for request in page.requests)
        for request in page.requests:
            assert request.startswith((base, base.replace("http:", "ws:"), "data:", "blob:"))


@pytest.fixture
def settings(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> config.Settings:
    for name in list(os.environ):
        if name.startswith("D3A_"):
            monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    store = open_store("memory.db")
    small_home.fill(store)
    store.close()
    return config.Settings(clock=lambda: small_home.NOW, store=str(tmp_path / "memory.db"))


def test_a_port_that_is_taken_is_said(settings: config.Settings) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        result = CliRunner().invoke(main, ["chat", "--serve", "--port", port], obj=settings)
    assert result.exit_code == 2
    assert f"port {port} cannot be had" in result.stderr


def test_without_the_extra_it_says_how_to_get_it(
    settings: config.Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    result = CliRunner().invoke(main, ["chat", "--serve"], obj=settings)
    assert result.exit_code == 2
    assert EXTRA in result.stderr


def test_a_password_is_not_among_the_arguments(
    settings: config.Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    from assistant import serving
    from assistant.ui import serving as server

    started: list[str] = []

    class Seen:
        def __init__(self, command: list[str], **_: object) -> None:
            started.extend(command)

        def serve(self) -> None:
            assert os.environ["D3A_STORE"] == "mongodb://robot:secret@host/home"

    monkeypatch.setattr(server, "ChatServer", Seen)
    for name in ("STORE", "IMAGES"):
        monkeypatch.setenv(f"D3A_{name}", "")  # put back afterwards
    store = "mongodb://robot:secret@host/home"
    serving.serve("chat", config.Settings(clock=settings.clock, store=store), 0)
    assert started[-2:] == ["chat", "--served"]
    assert not any("secret" in argument for argument in started)
