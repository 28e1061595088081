"""The conversation a line at a time: for screen readers, pipes and TERM=dumb."""

from __future__ import annotations

import io

import pytest

from assistant.plain import talk
from assistant.session import Session
from assistant.terminal import clean, clean_lines, json_line, shorten, table, why_not_full_screen
from d3a.answer import Answer
from d3a.store.base import StoreUnreachable
from grammar.errors import NotUnderstood
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore


def said(lines: str, session: Session | None = None, *, person: bool = False) -> list[str]:
    if session is None:
        store = OracleStore()
        small_home.fill(store)
        session = small_home.session(store)
    out = io.StringIO()
    talk(session, io.StringIO(lines), out, ask_for_lines=person)
    return out.getvalue().splitlines()


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
    assert "query   keys(x)" in lines
    assert any(line.startswith("Type a question") for line in lines)
    assert not any("never reached" in line for line in lines)


def test_undo_may_be_said_with_a_slash_as_the_other_commands() -> None:
    assert said("/undo\n") == said("undo\n")
    assert said("/undo\n")[0] == "You: undo"


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("/map", "Answer: /map needs the full screen. Here: /help"),
        ("/save", "Answer: /save needs the full screen."),
        ("/nonsense", "Answer: There is no /nonsense. There are /help /more /why /box"),
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
    assert lines[0] == "The memory of lab. Type a question, help or quit."
    assert "For example: Where are the keys?" in lines


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
