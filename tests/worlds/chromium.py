"""Chromium without a window, driven by its own protocol: open a page, type, take a picture.

    python -m tests.worlds.chromium FILE.png

serves the chat on the demo home, asks a question in the browser, and writes what stands there.
"""

from __future__ import annotations

import asyncio
import base64
import itertools
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

import aiohttp

NAMES = ("chromium", "chromium-browser", "google-chrome")
START_S = 60.0


def program() -> str | None:
    """Return where Chromium is, None where it is not."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Page:
    """The one page of a running Chromium. requests: every address that it asked for."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self._socket = socket
        self._numbers = itertools.count(1)
        self.requests: list[str] = []

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        number = next(self._numbers)
        await self._socket.send_json({"id": number, "method": method, "params": parameters})
        while True:
            message = await self._socket.receive_json(timeout=START_S)
            if message.get("method") == "Network.requestWillBeSent":
                self.requests.append(message["params"]["request"]["url"])
            if message.get("method") == "Network.webSocketCreated":
                self.requests.append(message["params"]["url"])
            if message.get("id") == number:
                assert "error" not in message, message
                result: dict[str, Any] = message["result"]
                return result

    async def open(self, address: str, width: int, height: int) -> None:
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        await self.call("Emulation.setDeviceMetricsOverride", **size)
        await self.call("Network.enable")
        await self.call("Page.enable")
        await self.call("Page.navigate", url=address)

    async def evaluate(self, expression: str) -> Any:
        done = await self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        return done["result"].get("value")

    async def until(self, expression: str, seconds: float = START_S) -> None:
        given_up = time.monotonic() + seconds
        while not await self.evaluate(expression):
            assert time.monotonic() < given_up, f"never came true: {expression}"
            await asyncio.sleep(0.1)

    async def type(self, text: str) -> None:
        for letter in text:
            key = {"text": "\r", "key": "Enter", "windowsVirtualKeyCode": 13}
            pressed = key if letter == "\r" else {"text": letter, "key": letter}
            await self.call("Input.dispatchKeyEvent", type="keyDown", **pressed)
            await self.call("Input.dispatchKeyEvent", type="keyUp", key=pressed["key"])

    async def picture(self) -> bytes:
        shot = await self.call("Page.captureScreenshot", format="png")
        return base64.b64decode(shot["data"])


@asynccontextmanager
async def browser() -> AsyncIterator[Page]:
    """Run Chromium until the block ends."""
    path = program()
    assert path is not None
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"]
        arguments += ["--remote-debugging-port=0", f"--user-data-dir={folder}", "about:blank"]
        with subprocess.Popen(
            [path, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        ) as process:
            try:
                assert process.stderr is not None
                port = next(
                    said[1]
                    for line in process.stderr
                    if (said := re.search(r"DevTools listening on ws://[^:]+:(\d+)/", line))
                )
                async with aiohttp.ClientSession() as client:
                    async with client.get(f"http://127.0.0.1:{port}/json") as listed:
                        pages = [each for each in await listed.json() if each["type"] == "page"]
                    address = pages[0]["webSocketDebuggerUrl"]
                    async with client.ws_connect(address, max_msg_size=0) as socket:
                        yield Page(socket)
            finally:
                process.terminate()
                process.wait(20)


@contextmanager
def served(*arguments: str, **environment: str) -> Iterator[str]:
    """Run `d3a ... --serve` on a free port; give its address."""
    import os

    command = [sys.executable, "-m", "assistant.cli", *arguments, "--serve", "--port", "0"]
    with subprocess.Popen(
        command,
        cwd=Path(__file__).parents[2],
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip()
        finally:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
    assert process.returncode == 0, process.returncode


async def main(path: Path) -> None:
    """Write a picture of the chat in a browser, on the demo home."""
    with served("demo") as address:
        async with browser() as page:
            await page.open(address, 1280, 800)
            await page.until("document.body.classList.contains('-first-byte')")
            await asyncio.sleep(4)
            await page.type("where is the blue cup?\r")
            await asyncio.sleep(4)
            path.write_bytes(await page.picture())


if __name__ == "__main__":
    asyncio.run(main(Path(sys.argv[1])))
