"""The chat in a browser, on this machine alone: textual-serve behind a key (the extra `serve`).

The pictures are of somebody's home, and textual-serve has no login: any other user of the machine,
and any page open in the same browser, could reach a port of it. So it listens on the loopback
address only, its address bears a key that changes with each start, and other origins are refused.
Its own page loads a font from a server far away; the one here loads nothing from elsewhere.
"""

from __future__ import annotations

import contextlib
import hmac
import secrets
import shlex
import socket
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from urllib.parse import urlsplit

from aiohttp import web
from aiohttp.typedefs import Handler, Middleware
from textual_serve.server import Server

HOST = "127.0.0.1"
PAGE = Path(__file__).with_name("pages") / "chat.html"
_NAMES = ("127.0.0.1", "localhost", "::1")
_CLOSING_S = 2.0
"""What an open page is given to end its chat, when the server ends."""


class ChatServer(Server):
    """Serves the chat, a process of its own for each page, to whoever has the key.

    command: what runs the chat, as arguments. port: 0 for any that is free. started: is told the
    address once the server listens. Raises OSError for a port that cannot be had.
    """

    def __init__(
        self, command: Sequence[str], *, port: int, started: Callable[[str], None]
    ) -> None:
        self._listening = socket.create_server((HOST, port))
        port = self._listening.getsockname()[1]
        super().__init__(shlex.join(command), host=HOST, port=port, title="d3a")
        self._key = secrets.token_urlsafe(16)
        self._cookie = f"d3a-{port}"
        self._started = started

    @property
    def address(self) -> str:
        """The address of the page, with the key."""
        return f"http://{HOST}:{self.port}/?key={self._key}"

    def serve(self, debug: bool = False) -> None:
        """Serve until SIGINT or SIGTERM."""
        self.debug = debug
        with contextlib.redirect_stdout(sys.stderr):  # textual-serve passes on what a chat says
            web.run_app(
                self._make_app(),
                sock=self._listening,
                print=None,
                access_log=None,
                shutdown_timeout=_CLOSING_S,
            )

    async def on_startup(self, app: web.Application) -> None:
        """Tell the address."""
        self._started(self.address)

    async def _make_app(self) -> web.Application:
        app = await super()._make_app()
        app.middlewares.append(self._guard)
        return app

    @property
    def _guard(self) -> Middleware:
        @web.middleware
        async def guard(request: web.Request, handler: Handler) -> web.StreamResponse:
            self._admit(request)
            return await handler(request)

        return guard

    def _admit(self, request: web.Request) -> None:
        """Refuse other names of this machine, pages of other origins, and who lacks the key."""
        if urlsplit(f"//{request.host}").hostname not in _NAMES:
            raise web.HTTPForbidden(text="This chat is for this machine alone.")
        if request.headers.get("Origin", f"http://{request.host}") != f"http://{request.host}":
            raise web.HTTPForbidden(text="Another page may not use this chat.")
        given = request.query.get("key") or request.cookies.get(self._cookie, "")
        if not hmac.compare_digest(given.encode(), self._key.encode()):
            raise web.HTTPForbidden(text="Open the address that d3a chat --serve printed.")

    async def handle_index(self, request: web.Request) -> web.Response:
        """Return the page; the key comes back as a cookie from there on.

        Every address in it is the one the browser used: an ssh tunnel may change the port.
        """
        page = PAGE.read_text(encoding="utf-8").replace("{{host}}", request.host)
        response = web.Response(text=page, content_type="text/html")
        response.set_cookie(self._cookie, self._key, httponly=True, samesite="Strict")
        response.headers["Cache-Control"] = "no-store"
        response.headers["Referrer-Policy"] = "no-referrer"
        response.headers["Content-Security-Policy"] = (
            "default-src 'self' data:; style-src 'self' 'unsafe-inline'; "
            f"script-src 'self' 'unsafe-inline'; connect-src ws://{request.host}; "
            "frame-ancestors 'none'"
        )
        return response
