"""Speaking and copying: which command does it, what it is given, what is said where none does."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from assistant.clipboard import copied_here, takes_osc_52
from assistant.saving import card_text, plain
from assistant.speaking import NONE_FOUND, Voice, speaker, where_it_sounds
from tests.worlds import small_home
from tests.worlds.running_chat import chat


def has(*names: str) -> Callable[[str], str | None]:
    return lambda name: f"/usr/bin/{name}" if name in names else None


def test_the_first_command_that_there_is_speaks() -> None:
    assert speaker(None, has("espeak-ng", "say")) == ("say", "--")
    assert speaker("", has("espeak-ng")) == ("espeak-ng", "--")
    assert speaker(None, has()) is None
    assert speaker("piper --model 'a b'", has("piper")) == ("piper", "--model", "a b")
    assert speaker("piper", has("say")) is None  # what was named is not replaced by another
    assert speaker("'", has("say")) is None


def test_over_ssh_it_says_where_the_sound_is() -> None:
    assert "at the robot" in where_it_sounds({"SSH_CONNECTION": "1.2.3.4"})
    assert where_it_sounds({}) == ""


def speaks_to(path: Path) -> str:
    code = f"import sys,time; open({str(path)!r},'w').write(sys.argv[1]); time.sleep(20)"
    return f'{sys.executable} -c "{code}"'


def test_words_are_one_argument_and_a_second_time_stops(tmp_path: Path) -> None:
    heard = tmp_path / "heard"
    voice = Voice(speaks_to(heard))
    assert voice.say("keys; touch x $(y)\x1b[31m\nhere").startswith("Speaking.")
    until = time.monotonic() + 10
    while not (heard.exists() and heard.read_text()) and time.monotonic() < until:
        time.sleep(0.01)
    assert heard.read_text() == "keys; touch x $(y)[31m here"
    started = time.monotonic()
    assert voice.say("again") == "Stopped speaking."
    assert time.monotonic() - started < 10
    assert not voice.stop()


def test_no_voice_is_said_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setattr("assistant.speaking.speaker", lambda configured: None)
    assert Voice().say("hello") == NONE_FOUND
    assert "cannot be run: nope" in Voice("nope").say("hello")


async def test_f4_speaks_the_answer(tmp_path: Path) -> None:
    heard = tmp_path / "heard"
    async with chat(speak=speaks_to(heard)) as c:
        await c.ask()
        await c.pilot.press("f4")
        await c.until(lambda: heard.exists() and "On the kitchen table." in heard.read_text())
        await c.type("/speak")
        await c.until(lambda: any("Stopped" in n.message for n in c.app._notifications))


def test_copying_by_the_desktop_or_not(monkeypatch: pytest.MonkeyPatch) -> None:
    script = "import sys; sys.exit(0 if sys.stdin.read() == 'text' else 1)"
    monkeypatch.setattr("assistant.clipboard._COMMANDS", [("", (sys.executable, "-c", script))])
    which = has(sys.executable)
    assert copied_here("text", {}, which)
    assert not copied_here("other", {}, which)
    assert not copied_here("text", {"SSH_CONNECTION": "x"}, which)  # that is the robot's clipboard
    assert not copied_here("text", {}, has())
    assert takes_osc_52({"TERM": "xterm-256color"})
    assert not takes_osc_52({"TERM": "linux"})
    assert not takes_osc_52({"TERM_PROGRAM": "Apple_Terminal"})


async def test_what_cannot_be_copied_is_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "linux")
    monkeypatch.setattr("assistant.clipboard._COMMANDS", [])
    async with chat(saves=tmp_path / "saved") as c:
        await c.ask()
        await c.pilot.press("f8")
        await c.until(lambda: (tmp_path / "saved" / "copied.txt").exists())
    assert (tmp_path / "saved" / "copied.txt").read_text().startswith("On the kitchen table.")


def test_a_card_is_what_was_said_and_no_markup() -> None:
    answer = small_home.found("where is the [mug](x) <b>?", category=small_home.NASTY)
    card = card_text(answer, None, small_home.NOW)
    assert "\x1b" not in card
    assert "\\[mug\\]\\(x\\) \\<b\\>?" in card
    assert plain("a|b & *c*") == "a\\|b &amp; \\*c\\*"
    assert "| 1 | mug \\[red\\]" in card
