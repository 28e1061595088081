"""Random keys and resizes, seeded: whatever is pressed, the chat stands and still answers."""

from __future__ import annotations

import os
import random

import pytest
from textual.widgets import Static

from assistant.ui.app import ChatApp
from d3a.answer import Answer
from d3a.store.base import StoreUnreachable
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

KEYS = (
    *("f1", "f2", "f3", "f5", "f7", "f8", "ctrl+p", "escape", "escape", "escape"),
    *("up", "down", "left", "right", "tab", "shift+tab", "enter", "enter", "pageup", "pagedown"),
    *("1", "2", "9", "a", "w", "slash", "left_square_bracket", "space", "backspace", "home", "end"),
    *("ctrl+c", "ctrl+u", "ctrl+w", "ctrl+a", "n", "p", "c", "q"),
)
SIZES = ((80, 24), (160, 50), (60, 16), (59, 15), (40, 10), (20, 6), (110, 30), (3, 2), (200, 12))
TEXTS = (
    "where are my keys",
    "the mug [/]",
    "my wallet",
    "yesterday",
    "never",
    "lost",
    "/why",
    "/map",
)
PRESSES = int(os.environ.get("D3A_RANDOM_PRESSES", "120"))


def ask(text: str) -> Answer:
    if text == "lost":
        raise StoreUnreachable("the server went away")
    return small_home.answer(text)


@pytest.mark.parametrize("seed", [1, 2])
async def test_random_presses_break_nothing(seed: int) -> None:
    rng = random.Random(seed)
    store = OracleStore()
    small_home.fill(store)
    app = ChatApp(small_home.session(store, ask))
    async with app.run_test(size=(80, 24)) as pilot:
        for _ in range(PRESSES):
            chance = rng.random()
            if chance < 0.08:
                await pilot.resize_terminal(*rng.choice(SIZES))
            elif chance < 0.16:
                app.ask(rng.choice(TEXTS))
            else:
                await pilot.press(rng.choice(KEYS))
        await pilot.resize_terminal(80, 24)
        for _ in range(6):  # out of whatever is open
            await pilot.press("escape")
        app.ask("where are my keys at last")
        for _ in range(500):
            await pilot.pause()
            said = str(app.chat.query_one("#exchange", Static).content)
            if "at last" in said:
                break
        assert "On the kitchen table." in said
        assert app.is_running
