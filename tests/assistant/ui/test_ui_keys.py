"""Every action by its key, and by another that the settings put in its place."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.command import CommandPalette
from textual.widgets import Footer, Static

from assistant import config
from assistant.keymap import ACTIONS, KeysError, checked
from assistant.speaking import Voice
from assistant.ui.footer import SheetFoot
from assistant.ui.sheets import BOXING, LOOKING, FloorSheet, LargeSheet, PictureSheet, Sheet
from tests.worlds import small_home
from tests.worlds.running_chat import Chat, chat

OPENS = {
    "help": Sheet,
    "picture": PictureSheet,
    "map": FloorSheet,
    "large": LargeSheet,
    "why": Sheet,
    "palette": CommandPalette,
}
OTHERS = dict(zip(ACTIONS, (f"f{number}" for number in range(11, 24)), strict=True))


@pytest.mark.parametrize("keys", [{}, OTHERS], ids=["usual", "others"])
@pytest.mark.parametrize("action", list(ACTIONS))
async def test_each_action_has_its_key(
    action: str, keys: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = keys.get(action, ACTIONS[action])
    monkeypatch.setattr(Voice, "say", lambda self, text: f"Speaking {text}")
    async with chat(keys=keys, saves=tmp_path) as c:
        await c.ask("where was the cup yesterday?")
        await c.ask()
        await c.until(lambda: c.app.chat.shot is not None)
        await c.pilot.press(key)
        await check(c, action, key, tmp_path)
        if keys and action != "quit":  # the usual key does nothing any more
            before = [type(screen) for screen in c.app.screen_stack], len(c.app._notifications)
            await c.pilot.press(ACTIONS[action])
            await c.pilot.pause()
            assert before == ([type(s) for s in c.app.screen_stack], len(c.app._notifications))


async def check(c: Chat, action: str, key: str, saves: Path) -> None:
    if action in OPENS:
        await c.until(lambda: isinstance(c.app.screen, OPENS[action]))
        await c.pilot.press("escape" if action == "palette" else key)  # away by its own key
        await c.until(lambda: c.app.screen is c.app.chat)
    elif action == "speak":
        await c.until(lambda: any("Speaking On" in note.message for note in c.app._notifications))
    elif action == "save":
        await c.until(lambda: len(list(saves.iterdir())) == 3)
    elif action == "copy":
        await c.until(lambda: c.app.clipboard.startswith("On the kitchen table."))
    elif action == "quit":
        await c.until(lambda: not c.app.is_running)
    elif action == "stop":
        assert c.prompt().has_focus
    elif action == "earlier":
        await c.until(lambda: isinstance(c.app.screen, Sheet))
        assert "yesterday" in str(c.app.screen.query_one("#sheet-text", Static).content)
        await c.pilot.press("escape")
    else:
        assert action == "later"  # there is nothing after the newest
        assert c.app.screen is c.app.chat


async def test_stop_by_another_key_goes_back_to_the_question_line() -> None:
    async with chat(keys={"stop": "f12"}) as c:
        await c.ask()
        await c.pilot.press("down")
        assert not c.prompt().has_focus
        await c.pilot.press("f12")
        assert c.prompt().has_focus


async def test_the_footer_and_the_help_say_the_keys_that_hold() -> None:
    async with chat(keys={"why": "ctrl+y", "help": "f9,ctrl+g"}, size=(110, 30)) as c:
        shown = " ".join(str(part.render()) for part in c.app.chat.query_one(Footer).children)
        assert "^y Why" in shown
        assert "f9 Help" in shown
        await c.pilot.press("ctrl+g")
        text = str(c.app.screen.query_one("#sheet-text", Static).content)
        assert "Your own keys   why: Ctrl+y   help: F9 or Ctrl+g" in text


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"hlep": "f9"}, "nearest: help"),
        ({"help": 9}, "write it as text"),
        ({"help": "ctrl+i"}, "cannot tell from Tab"),
        ({"help": "ctrl+c"}, "copies a selection"),
        ({"help": "contrl+x"}, "no key"),
        ({"help": "x"}, "no key"),  # a letter is typed
        ({"help": ""}, "no key"),
        ({"help": "f2"}, "f2 is to do both"),
        ({"help": "f9,f9"}, "f9 is to do both"),
    ],
)
def test_keys_that_cannot_be_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(KeysError, match=r".*") as raised:
        checked(given)
    assert words in str(raised.value)


def test_two_actions_may_change_places() -> None:
    assert checked({"help": "F2", "picture": "f1"}) == {"help": "f2", "picture": "f1"}


def test_keys_come_from_a_settings_file(tmp_path: Path) -> None:
    path = tmp_path / "d3a.toml"
    path.write_text('[keys]\nwhy = "ctrl+y"\n')
    settings = config.load(lambda: small_home.NOW, {}, (path,))
    assert settings.keys == {"why": "ctrl+y"}
    path.write_text('[keys]\nwhi = "ctrl+y"\n')
    with pytest.raises(config.SettingsError, match=r"d3a.toml: keys.whi .* nearest: why"):
        config.load(lambda: small_home.NOW, {}, (path,))
    path.write_text('keys = "f1"\n')
    with pytest.raises(config.SettingsError, match="it must be a table"):
        config.load(lambda: small_home.NOW, {}, (path,))


@pytest.mark.parametrize("width", [40, 44, 50, 57, 60, 72, 76, 80, 160])
async def test_the_footer_has_whole_keys_the_way_out_among_them(width: int) -> None:
    async with chat(size=(width, 20)) as c:
        footer = c.app.chat.query_one(Footer)

        def said() -> dict[str, int]:
            keys = [key for key in footer.children if key.display]
            return {str(key.render()): key.region.width for key in keys}

        await c.until(lambda: all(said()) and all(w >= len(k) for k, w in said().items()))
        await c.until(lambda: {"f1 Help", "^q Quit"} <= said().keys())
        assert sum(len(each) + 1 for each in said()) - 1 <= width
        assert (len(said()) == 9) == (width >= 76)
        await c.pilot.resize_terminal(160, 20)
        await c.until(lambda: sum(key.display for key in footer.children) == 9)


@pytest.mark.parametrize("width", [40, 50, 60, 80])
async def test_the_foot_of_a_sheet_says_whole_words(width: int) -> None:
    async with chat(size=(width, 20)) as c:
        await c.ask()
        await c.pilot.press("f2")
        foot = c.app.screen.query_one(SheetFoot)
        await c.until(lambda: bool(foot.size.width))
        for words in (LOOKING, BOXING):
            said = str(foot.content)
            assert len(said) <= width - 2
            assert words.startswith(said)
            assert words[len(said) :][:3] in ("", "   ")
            await c.pilot.press("b")
            await c.pilot.pause()
