"""Every screen of ours as it stands there, character for character, at 80x24 and 160x50.

The clock, the world and the way pictures are shown are fixed; the pictures are of one colour, so
that no decoder's rounding changes a cell. After a change that is meant, look at the difference of

    D3A_UPDATE_SCREENS=1 python -m pytest tests/assistant/ui/test_ui_screens.py
"""

from __future__ import annotations

import io
import os
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from textual.widgets import Static

from assistant.ui.picture import PictureView
from assistant.ui.sheets import LargeSheet, PictureSheet
from d3a.answer import Answer
from d3a.store.base import Keyframe, StoreUnreachable
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.running_chat import Chat, chat

SCREENS = Path(__file__).with_name("screens")
UPDATE = "D3A_UPDATE_SCREENS"


class FlatPictures(OracleStore):
    """A store whose pictures have one colour."""

    def keyframe(self, key: str) -> Keyframe | None:
        written = io.BytesIO()
        Image.new("RGB", (64, 36), (96, 96, 96)).save(written, "JPEG")
        return Keyframe(key, written.getvalue(), small_home.WIDTH, small_home.HEIGHT, 0)


def ask(text: str) -> Answer:
    if "lost" in text:
        raise StoreUnreachable("mongodb://robot: no answer within 5 s")
    answer = small_home.answer(text)
    return replace(answer, elapsed_ms={"total": 2.2}) if answer.elapsed_ms else answer


def shown(c: Chat) -> str:
    """Return the rows of the screen, without the spaces at their ends."""
    strips = c.app.screen._compositor.render_strips()
    return "\n".join(strip.text.rstrip() for strip in strips) + "\n"


async def drawn(c: Chat) -> None:
    """Wait until every picture that has room stands there."""
    await c.until(lambda: c.app.chat.shot is not None)
    views = c.app.screen.query(PictureView)
    await c.until(lambda: all("┏" in view.text for view in views if view.region.area > 0))


async def start(c: Chat) -> None:
    await c.until(lambda: "Ask me where" in c.said())


async def answered(c: Chat) -> None:
    await c.ask("where was my cup this morning?")
    await c.ask()
    await drawn(c)


async def second(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("down", "2")
    await c.until(lambda: c.app.chat.shot is not None and c.app.chat.shot.keyframe.rank == 2)
    await c.pilot.pause(0.1)
    await drawn(c)


async def no(c: Chat) -> None:
    await c.ask("where were my keys yesterday?")
    await drawn(c)


async def unknown(c: Chat) -> None:
    await c.ask("where is my wallet?")


async def lost(c: Chat) -> None:
    await c.ask("is it lost?")


async def help_(c: Chat) -> None:
    await c.pilot.press("f1")


async def why(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("f7")
    await c.until(
        lambda: "find [keys]" in str(c.app.screen.query_one("#sheet-text", Static).content)
    )


async def picture(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("f2")
    await c.until(lambda: isinstance(c.app.screen, PictureSheet))
    await drawn(c)


async def map_(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("f3")


async def large(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("f5")
    await c.until(lambda: isinstance(c.app.screen, LargeSheet))
    await drawn(c)


async def earlier(c: Chat) -> None:
    await answered(c)
    await c.pilot.press("pageup")


STEPS: dict[str, Callable[[Chat], Awaitable[None]]] = {
    "start": start,
    "answer": answered,
    "second": second,
    "no": no,
    "unknown": unknown,
    "lost": lost,
    "help": help_,
    "why": why,
    "picture": picture,
    "map": map_,
    "large": large,
    "earlier": earlier,
}


@pytest.mark.parametrize("size", [(80, 24), (160, 50)], ids=["80x24", "160x50"])
@pytest.mark.parametrize("name", list(STEPS))
async def test_the_screen_is_as_it_was(name: str, size: tuple[int, int]) -> None:
    store = FlatPictures()
    small_home.fill(store)
    async with chat(small_home.session(store, ask), size=size, pictures="cells") as c:
        await STEPS[name](c)
        await c.pilot.pause(0.1)
        screen = shown(c)
    assert len(screen.splitlines()) == size[1]
    path = SCREENS / f"{name}-{size[0]}x{size[1]}.txt"
    if os.environ.get(UPDATE):
        SCREENS.mkdir(exist_ok=True)
        path.write_text(screen, encoding="utf-8")
    assert path.exists(), f"no such screen yet: run with {UPDATE}=1, and look at it"
    assert screen.splitlines() == path.read_text(encoding="utf-8").splitlines()


def test_every_stored_screen_is_tested() -> None:
    stored = {path.name.rpartition("-")[0] for path in SCREENS.glob("*.txt")}
    assert stored == set(STEPS)
