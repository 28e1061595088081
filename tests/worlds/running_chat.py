"""A running chat without a terminal, with the words a test asks of it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

from textual.pilot import Pilot
from textual.widgets import Static

from assistant.session import Session
from assistant.ui.app import ChatApp
from assistant.ui.lists import KeyframeList
from assistant.ui.picture import PictureView
from assistant.ui.prompt import Prompt
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

QUESTION = "where are my keys?"


class Chat:
    """A running chat, with the words a test asks of it."""

    def __init__(self, app: ChatApp, pilot: Pilot[None]) -> None:
        self.app, self.pilot = app, pilot

    async def until(self, condition: Callable[[], bool]) -> None:
        """Wait for threads and timers, at most five seconds."""
        for _ in range(500):
            await self.pilot.pause()
            if condition():
                return
            await asyncio.sleep(0.01)
        raise AssertionError(f"never came true; the screen says: {self.said()!r}")

    def said(self) -> str:
        return str(self.app.chat.query_one("#exchange", Static).content)

    def rows(self) -> list[str]:
        return self.app.chat.query_one(KeyframeList).lines_shown

    def prompt(self) -> Prompt:
        return self.app.chat.query_one(Prompt)

    def picture(self) -> str:
        return self.app.chat.query_one("#picture", PictureView).text

    async def type(self, text: str, enter: bool = True) -> None:
        self.prompt().insert_text_at_cursor(text)
        if enter:
            await self.pilot.press("enter")

    async def ask(self, text: str = QUESTION) -> None:
        await self.type(text)
        await self.until(lambda: f"You: {text}" in self.said())


@asynccontextmanager
async def chat(
    session: Session | None = None, size: tuple[int, int] = (80, 24), **options: Any
) -> AsyncIterator[Chat]:
    if session is None:
        store = OracleStore()
        small_home.fill(store)
        session = small_home.session(store)
    app = ChatApp(session, **options)
    async with app.run_test(size=size) as pilot:
        running = Chat(app, pilot)
        await running.until(lambda: bool(running.said()))
        yield running
