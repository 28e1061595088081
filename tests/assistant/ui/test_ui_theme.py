"""The theme of the settings: worn from the first screen on, and refused where there is none."""

from __future__ import annotations

from pathlib import Path

import pytest

from assistant.commands.chat import wear
from assistant.options import Failure
from assistant.ui.app import ChatApp
from tests.worlds import small_home, terminals
from tests.worlds.bare import bare
from tests.worlds.oracle import OracleStore


def app() -> ChatApp:
    store = OracleStore()
    small_home.fill(store)
    return ChatApp(small_home.session(store))


@pytest.mark.parametrize("theme", ["textual-light", "high-contrast", "ansi-light"])
async def test_the_chat_wears_the_theme_of_the_settings(theme: str) -> None:
    worn = app()
    wear(worn, theme)
    async with worn.run_test():
        assert worn.theme == theme
        background = worn.chat.background_colors[1]
        dark = worn.current_theme.dark
        assert background.ansi is not None or (background.brightness < 0.5) == dark


def test_an_unknown_theme_is_refused_with_the_nearest() -> None:
    with pytest.raises(Failure, match=r"theme 'high contrast' is none of .*nearest: high-contrast"):
        wear(app(), "high contrast")


def test_the_theme_is_said_in_the_environment_or_a_file(tmp_path: Path) -> None:
    command, environment = bare(tmp_path)
    light = environment | {"D3A_THEME": "textual-light"}
    with terminals.opened(command, light, cwd=tmp_path, size=(24, 80)) as terminal:
        terminal.read_until(b"Ask:")
        terminal.type("\x11")
        assert terminal.process.wait(timeout=60) == 0
    wrong = environment | {"D3A_THEME": "drakula"}
    with terminals.opened(command, wrong, cwd=tmp_path, size=(24, 80)) as terminal:
        assert b"nearest: dracula" in terminal.read_all().replace(b"\r\n", b" ")
        assert terminal.process.wait(timeout=60) == 2
