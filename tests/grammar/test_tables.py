"""The parse tables: fresh, without conflicts, and walked as Lark walks them."""

from __future__ import annotations

import json
import subprocess
import sys
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from lark.exceptions import GrammarError

from grammar import lalr
from grammar.lalr import Parser, Source, Tables, Token, UnreadError
from grammar.reading import QUESTION
from grammar.tables import SOURCES, computed, terminals, write
from grammar.timespan import TIME
from grammar.timetransform import TimeForms
from grammar.transform import Meanings

SUMS = """
start: sum
?sum: product | sum PLUS product -> plus
?product: atom+
atom: NUMBER -> number
    | _OPEN sum _CLOSE -> inside
pair: STAR? sum
"""


class Sums:
    """Tells how a sum was read, in brackets."""

    def start(self, found: str) -> str:
        return f"={found}"

    def plus(self, left: str, plus: Token, right: str) -> str:
        return f"({left}{plus.value}{right})"

    def product(self, *parts: str) -> str:
        return f"[{' '.join(parts)}]"

    def number(self, token: Token) -> str:
        return str(token.value)

    def inside(self, found: str) -> str:
        return f"<{found}>"

    def pair(self, *parts: Any) -> tuple[Any, ...]:
        return tuple(p.value if isinstance(p, Token) else p for p in parts)


@pytest.fixture
def sums(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Source:
    """A small grammar with all that a rule may be: aliases, repetitions, lone parts, options."""
    monkeypatch.setattr(lalr, "_HERE", tmp_path)
    (tmp_path / "sums.lark").write_text(SUMS, encoding="utf-8")
    return Source("sums.lark", ("start", "pair"))


def typed(text: str) -> list[Token]:
    kinds = {"+": "PLUS", "(": "_OPEN", ")": "_CLOSE", "*": "STAR"}
    return [Token(kinds.get(letter, "NUMBER"), letter) for letter in text]


@pytest.mark.parametrize(
    ("text", "value"),
    [("1", "=1"), ("12", "=[1 2]"), ("1+2+3", "=((1+2)+3)"), ("1(2+34)", "=[1 <(2+[3 4])>]")],
)
def test_walk_gives_methods_what_lark_would(sums: Source, text: str, value: str) -> None:
    assert Parser(sums.tables(), Sums()).parse(typed(text)) == value


def test_walk_begins_at_the_rule_it_is_told(sums: Source) -> None:
    parser = Parser(sums.tables(), Sums())
    assert parser.parse(typed("(1)"), "pair") == ("<1>",)
    assert parser.parse(typed("*(2)"), "pair") == ("*", "<2>")


@pytest.mark.parametrize(("text", "index"), [("", 0), ("1+", 2), ("1+)2", 2), ("(1", 2), ("1)", 1)])
def test_walk_says_where_it_broke_off(sums: Source, text: str, index: int) -> None:
    with pytest.raises(UnreadError) as caught:
        Parser(sums.tables(), Sums()).parse(typed(text))
    assert caught.value.index == index


def test_kept_tables_are_used_until_the_grammar_changes(sums: Source) -> None:
    assert sums.kept() is None
    write(sums)
    assert sums.kept() == sums.tables() == computed(sums)
    sums.path.with_name("sums.lark").write_text(SUMS.replace("atom+", "atom"), encoding="utf-8")
    assert sums.kept() is None
    with pytest.raises(UnreadError):
        Parser(sums.tables(), Sums()).parse(typed("12"))


def test_two_readings_of_a_token_make_no_tables(sums: Source) -> None:
    sums.path.with_name("sums.lark").write_text(
        "start: sum\npair: sum\nsum: NUMBER | sum PLUS sum\n", encoding="utf-8"
    )
    with pytest.raises(GrammarError, match="conflict"):
        computed(sums)


@pytest.mark.parametrize("source", SOURCES, ids=lambda s: s.name)
def test_tables_are_of_the_grammar_beside_them(source: Source) -> None:
    assert source.kept() == computed(source), "run python -m grammar.tables"


@pytest.mark.parametrize(
    ("source", "forms"), [(QUESTION, Meanings()), (TIME, TimeForms())], ids=["question", "time"]
)
def test_every_rule_has_its_method(source: Source, forms: object) -> None:
    tables = source.tables()
    missing = {
        rule.method
        for rule in tables.rules
        if rule.method and not (rule.single and lone(rule)) and not hasattr(forms, rule.method)
    }
    assert missing == set()


def lone(rule: lalr.Rule) -> bool:
    """Whether a rule has one part, always, and so needs no method where `single`."""
    parts = range(rule.size) if rule.kept is None else rule.kept
    return len(parts) == 1 and all(index >= 0 for index in parts)


@pytest.mark.parametrize(
    ("question", "needless"),
    [
        ("where was my cup at noon", {"lark", "rapidfuzz", "hashlib", "logging", "tempfile"}),
        ("where is my cup", {"grammar.timeforms", "grammar.clock", "grammar.notationreader"}),
    ],
)
def test_a_question_is_read_without(question: str, needless: set[str]) -> None:
    program = (
        "import sys, grammar\nfrom datetime import UTC, datetime\n"
        f"grammar.parse({question!r}, now=datetime(2020, 1, 1, tzinfo=UTC))\nprint(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert needless & {*done.stdout.split()} == set()


def test_tables_are_plain_json() -> None:
    for source in SOURCES:
        record = json.loads(source.path.read_text(encoding="utf-8"))
        assert set(record) == {"made_from", *Tables._fields}


def test_the_terminals_of_a_sentence_are_named() -> None:
    now = datetime.fromisoformat("2020-01-01T18:00:00-05:00")
    found = [line.split() for line in terminals("where did my keys go", now)]
    assert found == [
        ["_WHERE", "where"],
        ["AUX", "did"],
        ["OWNER", "my"],
        ["NOUN", "keys"],
        ["GO", "go"],
    ]
