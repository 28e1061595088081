"""The conversation a line at a time: for screen readers, pipes and TERM=dumb."""

from __future__ import annotations

import io
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from assistant.history import History
from assistant.lines import LEAVING
from assistant.plain import STOPPED, PlainChat, talk, wrapped
from assistant.session import Session
from assistant.speaking import Voice
from assistant.terminal import clean, clean_lines, json_line, shorten, table, why_not_full_screen
from d3a.answer import Answer
from d3a.store.base import StoreUnreachable
from grammar.errors import NotUnderstood
from tests.worlds import small_home, terminals
from tests.worlds.bare import bare
from tests.worlds.oracle import OracleStore


def said(lines: str, session: Session | None = None, *, person: bool = False) -> list[str]:
    if session is None:
        store = OracleStore()
        small_home.fill(store)
        session = small_home.session(store)
    out: list[str] = []
    chat = PlainChat(session, out.append, echoes=not person)
    if person:
        chat.welcome()
    talk(chat, lines.splitlines())
    return "\n".join(out).splitlines()


def test_an_answer_is_lines_that_read_aloud() -> None:
    assert said("where are my keys?\n") == [
        "You: where are my keys?",
        "Answer: On the kitchen table. I last saw them today at 9:42, 9 hours ago.",
        "1 of 3: keys, 9:42 today, kitchen, by the table, fairly sure, seen 14 times",
        "2 of 3: keys, 8:15 today, hall, by the door, not sure, seen 3 times",
        "3 of 3: keys, 17:00 Fri, kitchen, by the sofa, a guess, seen once",
    ]


def test_numbers_more_why_and_help_are_about_the_last_answer() -> None:
    lines = said("2\nwhere are my keys?\n2\n7\nmore\nwhy\nhelp\nquit\nnever reached\n")
    assert lines[0] == "Answer: There is no 2; nothing is listed yet."
    assert "2 of 3: keys, 8:15 today, hall, by the door, not sure, seen 3 times" in lines[6:]
    assert "Frame 000001, object keys-1." in lines
    assert "Answer: There is no 7; the list has 3." in lines
    assert "Answer: There is no more." in lines
    assert "Formal     keys(x)" in "\n".join(lines)
    assert any(line.startswith("Type a question") for line in lines)
    assert not any("never reached" in line for line in lines)


def test_undo_may_be_said_with_a_slash_as_the_other_commands() -> None:
    assert said("/undo\n") == said("undo\n")
    assert said("/undo\n")[0] == "You: undo"


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("/map", "Answer: /map needs the full screen. Here: /help"),
        ("/save", "Answer: Ask a question first."),
        ("read it to me", "Answer: Ask a question first."),
        ("/hlep", "Answer: There is no /hlep. Did you mean /help? There are /help /more"),
        ("/nonsense", "Answer: There is no /nonsense. There are /help /more /why /speak"),
        ("/box", "Answer: Say its edges too"),
        ("/box 1 2 3 4", "You: /box 1 2 3 4"),
        ("/taught", "You: what did I teach you?"),
        ("Why?", "Answer: Ask a question first."),
    ],
)
def test_no_command_is_taken_for_a_question(typed: str, words: str) -> None:
    assert said(f"{typed}\n")[0].startswith(words)


def test_a_person_is_greeted_with_questions_to_try() -> None:
    lines = said("", person=True)
    assert lines[0] == (
        "The memory of lab, up to 18:52 today, 8 minutes ago. Times: America/New_York."
    )
    assert "For example: Where are the keys?" in lines


def test_more_goes_on_ten_rows_at_a_time() -> None:
    row = small_home.keyframe(1)
    rows = tuple(replace(row, rank=rank) for rank in range(1, 25))
    many = replace(small_home.found("where"), keyframes=rows, truncated=True)
    session = small_home.session(OracleStore(), lambda text: many)
    lines = said("where are my keys\nmore\nmore\nmore\n", session)
    ranks = [line.partition(" of ")[0] for line in lines if " of 24: " in line]
    assert ranks == [str(rank) for rank in range(1, 25)]
    assert [line for line in lines if "type more" in line] == [
        "21 more: type more",
        "11 more: type more",
        "1 more: type more",
    ]
    assert lines[-1] == "The list stops at 24; there are more."


def test_why_is_told_without_the_queries_of_the_store() -> None:
    steps = "query   keys(x)\nplan\n  1. find keys\nnative queries\n  SELECT :x_min\nanswer  found"
    session = small_home.session(OracleStore(), explain=lambda _: steps)
    lines = said("where are my keys?\n2\nwhy\n", session)
    assert lines[-2:] == ["plan", "  1. find keys"]
    assert "Keyframe 2   keys, frame 000001" in lines  # the row that was pointed at


def test_an_answer_is_saved_copied_and_spoken_without_a_screen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = OracleStore()
    small_home.fill(store)
    monkeypatch.setattr("assistant.clipboard._COMMANDS", [])
    out: list[str] = []
    voice = Voice("no-such-command-to-speak")
    chat = PlainChat(small_home.session(store), out.append, voice=voice, saves=tmp_path)
    talk(chat, ["where are my keys?", "save", "copy that, please", "speak"])
    assert out[-3:] == [
        f"Answer: Saved 3 files in {tmp_path}",
        f"Answer: There is no clipboard for it here: saved {tmp_path / 'copied.txt'}",
        "Answer: The command to speak with cannot be run: no-such-command-to-speak",
    ]
    assert "1  keys, 9:42 today" in (tmp_path / "copied.txt").read_text()


def test_questions_are_kept_for_the_next_chat_and_forgotten_when_said_twice(tmp_path: Path) -> None:
    history = History(tmp_path / "questions.jsonl")
    session = small_home.session(OracleStore())
    out: list[str] = []
    talk(PlainChat(session, out.append, history=history), ["where are my keys?", "1", "why"])
    assert History(tmp_path / "questions.jsonl").questions == ("where are my keys?",)
    talk(PlainChat(session, out.append, history=history), ["/forget", "/forget"])
    assert out[-1] == "Answer: The questions are forgotten."
    assert not (tmp_path / "questions.jsonl").exists()


def test_ctrl_c_stops_the_answer_and_not_the_chat() -> None:
    def interrupted(text: str) -> Answer:
        raise KeyboardInterrupt

    out: list[str] = []
    session = small_home.session(OracleStore(), interrupted)
    talk(PlainChat(session, out.append, echoes=False), ["what is where?", "help"])
    assert out[0] == STOPPED
    assert out[1].startswith("Type a question")
    with pytest.raises(KeyboardInterrupt):  # a script is to end
        talk(PlainChat(session, out.append), ["what is where?"])


def test_lines_break_between_words_and_only_where_they_must() -> None:
    assert wrapped("short\n  1. step", 20) == "short\n  1. step"
    assert wrapped("seen in the kitchen twice", 12) == "seen in the\nkitchen\ntwice"
    assert wrapped("a" * 30, 12) == "a" * 30


def test_typing_at_a_terminal_has_the_keys_of_a_shell(tmp_path: Path) -> None:
    command, environment = bare(tmp_path, term="dumb")
    with terminals.opened([*command, "chat", "--plain"], environment, size=(24, 60)) as terminal:
        terminal.read_until(b"You: ")
        terminal.type("where are my keus\x7f\x7fys?\r")  # Backspace
        terminal.read_until(b"1 of ")
        terminal.read_until(b"You: ")
        terminal.type("where are the g")
        terminal.read_until(b"the g")
        terminal.process.send_signal(signal.SIGINT)  # what was begun is dropped, the chat stays
        terminal.read_until(LEAVING.encode()[:40])
        terminal.read_until(b"You: ")
        terminal.type("\x1b[A\r")  # Up: the question before
        terminal.read_until(b"where are my keys?")
        terminal.read_until(b"1 of ")
        terminal.read_until(b"You: ")
        terminal.type("where is the cu\t\r")
        terminal.read_until(b"where is the cup")
        terminal.read_until(b"1 of ")
        terminal.read_until(b"You: ")
        terminal.process.send_signal(signal.SIGINT)
        terminal.read_until(b"You: ")
        terminal.process.send_signal(signal.SIGINT)  # the second in a row
        assert terminal.process.wait(timeout=60) == 130


def test_what_is_not_known_comes_with_what_is() -> None:
    lines = said("where is my wallet\n")
    assert lines[1:] == [
        "Answer: I do not know wallets.",
        "Did you mean, 1: Where is the bag?",
        "Did you mean, 2: Where are the keys?",
    ]


def test_a_no_names_the_nearest_true_sighting() -> None:
    lines = said("where were my keys yesterday\n")
    assert lines[1:] == [
        "Answer: Not then; on Friday at 17:00.",
        "Instead: keys, 17:00 Fri, kitchen, by the sofa, fairly sure, seen once",
    ]


def test_escapes_from_data_are_not_printed() -> None:
    lines = said("where is the mug\x1b[2J [/]\n")
    assert "mug [red]" in "".join(lines)
    assert not {"\x1b", "\u202e"} & set("".join(lines))


def test_a_lost_store_is_an_answer() -> None:
    def lost(text: str) -> Answer:
        raise StoreUnreachable("mongodb://robot: gone")

    lines = said("where are my keys\nwhy\n", small_home.session(OracleStore(), lost))
    assert "I cannot reach my memory" in lines[1]
    assert lines[2] == "Reason: mongodb://robot: gone"


def test_why_of_a_refused_question_is_its_reason() -> None:
    def refuse(text: str) -> str:
        raise NotUnderstood(text, 0, "I could not follow that.")

    lines = said("blah\nwhy\n", small_home.session(OracleStore(), explain=refuse))
    assert lines[-1] == "I could not follow that."


@pytest.mark.parametrize(
    ("raw", "harmless"),
    [
        ("keys", "keys"),
        ("a\nb\tc", "a b c"),
        ("\x1b]0;title\x07cup\x9b31m", "]0;titlecup31m"),
        ("\u202ecup\u2066\ud800", "cup"),
        ("tasse à café 鍵 👩‍👧", "tasse à café 鍵 👩‍👧"),
    ],
)
def test_clean(raw: str, harmless: str) -> None:
    assert clean(raw) == harmless


def test_clean_lines_keeps_line_breaks() -> None:
    assert clean_lines("a\x1b\nb\r") == "a\nb "


def test_json_lines_hold_no_raw_control_character() -> None:
    line = json_line({"text": "a\x1b\x9b\x7f\u2028é"})
    assert line == '{"text": "a\\u001b\\u009b\\u007f\\u2028é"}'


def test_tables_align_wide_letters_and_numbers() -> None:
    lines = table([["n", "what"], ["1", "鍵"], ["10", "cup"]])
    assert lines == [" n  what", " 1  鍵", "10  cup"]
    assert shorten("鍵鍵鍵", 5) == "鍵鍵…"
    assert shorten("keys", 4) == "keys"


def test_why_there_is_no_full_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        encoding = "utf-8"

        def isatty(self) -> bool:
            return True

    class Latin(Terminal):
        encoding = "latin-1"

    for name in ("stdin", "stdout", "stderr"):
        monkeypatch.setattr(f"sys.{name}", Terminal())
    assert why_not_full_screen({"TERM": "xterm"}) is None
    assert "dumb" in str(why_not_full_screen({"TERM": "dumb"}))
    assert "not named" in str(why_not_full_screen({}))
    monkeypatch.setattr("sys.stderr", Latin())
    assert "latin-1" in str(why_not_full_screen({"TERM": "xterm"}))
    monkeypatch.setattr("sys.stdin", io.StringIO())
    assert "not a terminal" in str(why_not_full_screen({"TERM": "xterm"}))
