"""Random keys, questions and resizes, seeded: whatever is pressed, the chat stands and answers."""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path

from textual.widgets import Static

from assistant.ui.app import ChatApp
from d3a.answer import Answer
from d3a.store.base import StoreUnreachable
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

KEYS = (
    *("f1", "f2", "f3", "f4", "f5", "f6", "f7", "f8", "ctrl+p", "escape", "escape", "escape"),
    *("up", "down", "left", "right", "tab", "shift+tab", "enter", "enter", "pageup", "pagedown"),
    *("1", "2", "9", "a", "w", "slash", "left_square_bracket", "space", "backspace", "home", "end"),
    *("ctrl+c", "ctrl+u", "ctrl+w", "ctrl+a", "n", "p", "c", "q", "b", "s", "shift+left"),
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


def ask(text: str) -> Answer:
    if text == "lost":
        raise StoreUnreachable("the server went away")
    return small_home.answer(text)


async def press_at_random(seed: int, presses: int, saves: Path) -> Counter[str]:
    """Press, ask and resize so often, then ask once more; return how often each was done.

    It ends early where the keys have said to quit. saves: the folder that F6 may fill. Raises what
    the chat raises, AssertionError where it no longer answers.
    """
    rng = random.Random(seed)
    store = OracleStore()
    small_home.fill(store)
    done: Counter[str] = Counter()
    session = small_home.session(store, ask)
    app = ChatApp(session, saves=saves, speak="no-such-command")
    async with app.run_test(size=(80, 24)) as pilot:
        for _ in range(presses):
            if not app.is_running:  # by /quit, or the palette's
                done["quits"] += 1
                return done
            chance = rng.random()
            if chance < 0.08:
                await pilot.resize_terminal(*rng.choice(SIZES))
                done["resizes"] += 1
            elif chance < 0.16:
                app.ask(rng.choice(TEXTS))
                done["questions"] += 1
            else:
                await pilot.press(rng.choice(KEYS))
                done["keys"] += 1
        await pilot.resize_terminal(80, 24)
        for _ in range(6):  # out of whatever is open
            await pilot.press("escape")
        app.ask("where are my keys at last")
        said = ""
        for _ in range(500):
            await pilot.pause()
            said = str(app.chat.query_one("#exchange", Static).content)
            if "at last" in said:
                break
        assert "On the kitchen table." in said, said
        assert app.is_running
    return done
