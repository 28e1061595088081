"""An LALR(1) parser over tokens that are typed already, driven by tables made ahead of time.

Lark reads the grammars and computes their tables (`python -m grammar.tables` writes them as JSON);
a question only walks them: importing Lark costs more than a hundred questions, and it is loaded
where a table is not of the very grammar beside it, which is then made anew.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

_HERE = Path(__file__).parent
FORMAT = 1
"""The layout of the tables; to be raised with every change of it."""
END = "$END"
"""The terminal after the last token."""


@dataclass(frozen=True, slots=True)
class Token:
    """A terminal of a grammar with its value; what reads the words derives from it."""

    type: str
    value: Any


class UnreadError(Exception):
    """No rule goes on with the token at `index`, the number of tokens where all were read."""

    def __init__(self, index: int) -> None:
        """Say where it broke off."""
        super().__init__(f"no rule goes on with token {index}")
        self.index = index


class Rule(NamedTuple):
    """One way of saying a rule.

    origin: the rule. size: how many symbols it has. kept: the index of each symbol that the rule's
    method is given, None for all; one below zero, ~i, stands for the list of a repetition at i.
    method: the name of the method, empty for a repetition, whose value is the list of its parts.
    single: the value of a lone part is that part.
    """

    origin: str
    size: int
    kept: list[int] | None
    method: str
    single: bool


class Tables(NamedTuple):
    """What a grammar says, ready to be walked.

    states: for each state, the next state after a symbol, or ~n below zero: reduce by rule n.
    starts: for each start rule, the state it begins in.
    """

    rules: list[Rule]
    states: list[dict[str, int]]
    starts: dict[str, int]


@dataclass(frozen=True, slots=True)
class Source:
    """A grammar: its file and its start rules. Every name in capitals is a terminal of its own."""

    name: str
    start: tuple[str, ...] = ("start",)

    @property
    def text(self) -> str:
        """The grammar as it is written."""
        return (_HERE / self.name).read_text(encoding="utf-8")

    @property
    def path(self) -> Path:
        """Where the tables are kept."""
        return (_HERE / self.name).with_suffix(".tables.json")

    @property
    def made_from(self) -> list[Any]:
        """What tables must say they were made from to be this grammar's."""
        return [FORMAT, list(self.start), self.text]

    def tables(self) -> Tables:
        """Return the tables: the kept ones where they are of this grammar, else new ones."""
        kept = self.kept()
        if kept is not None:
            return kept
        from grammar.tables import computed  # Lark: only for a grammar that was just changed

        return computed(self)

    def kept(self) -> Tables | None:
        """Return the tables of the file beside the grammar, None where they are of another text."""
        if not self.path.exists():
            return None
        record = json.loads(self.path.read_text(encoding="utf-8"))
        if record["made_from"] != self.made_from:
            return None
        return Tables([Rule(*rule) for rule in record["rules"]], record["states"], record["starts"])


class Parser:
    """Walks the tables; the methods of `forms` bear the rules' names and make their values."""

    def __init__(self, tables: Tables, forms: object) -> None:
        """Take the tables of a grammar and what its rules mean."""
        self._states, self._starts = tables.states, tables.starts
        self._rules = tables.rules
        self._methods: list[Any] = [getattr(forms, rule.method, None) for rule in tables.rules]

    def parse(self, tokens: Sequence[Token], start: str = "start") -> Any:
        """Return the value of the rule `start` over all tokens.

        Raises UnreadError, and what the methods of the forms raise.
        """
        states, values = [self._starts[start]], list[Any]()
        for index, token in enumerate(tokens):
            states.append(self._reduced(token.type, index, states, values))
            values.append(token)
        self._reduced(END, len(tokens), states, values)
        value: Any = values[0]
        return value

    def _reduced(self, symbol: str, index: int, states: list[int], values: list[Any]) -> int:
        """Reduce what ends before the terminal `symbol`; return the state after it."""
        while True:
            action = self._states[states[-1]].get(symbol)
            if action is None:
                raise UnreadError(index)
            if action >= 0:
                return action
            self._reduce(~action, states, values)

    def _reduce(self, number: int, states: list[int], values: list[Any]) -> None:
        """Put the value of a rule in the place of the values of its symbols."""
        origin, size, kept, method, single = self._rules[number]
        parts: list[Any] = values[-size:] if size else []
        if size:
            del states[-size:], values[-size:]
        if kept is not None:
            parts = _chosen(parts, kept)
        states.append(self._states[states[-1]][origin])
        if not method:
            values.append(parts)
        elif single and len(parts) == 1:
            values.append(parts[0])
        else:
            values.append(self._methods[number](*parts))


def _chosen(parts: list[Any], kept: Sequence[int]) -> list[Any]:
    """Return the parts that a rule hands on, those of its repetitions among them."""
    found: list[Any] = []
    for index in kept:
        if index < 0:
            found += parts[~index]
        else:
            found.append(parts[index])
    return found
