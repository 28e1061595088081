"""Compute parse tables with Lark: run `python -m grammar.tables` after a change of a grammar.

`python -m grammar.tables --terminals "sentence"` prints what the rules see of a sentence instead.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Any

import lark
from lark.common import ParserConf
from lark.grammar import Rule as LarkRule
from lark.grammar import Symbol, Terminal
from lark.lexer import Lexer
from lark.parsers.grammar_analysis import RulePtr
from lark.parsers.lalr_analysis import LALR_Analyzer, ParseTable, Shift

from grammar.lalr import END, Rule, Source, Tables
from grammar.parser import NO_STORE, read
from grammar.reading import QUESTION, Reading
from grammar.timespan import TIME
from grammar.words import Word

SOURCES = (QUESTION, TIME)
_TERMINAL = re.compile(r"\b_?[A-Z][A-Z0-9_]*\b")
_COMMENT = re.compile(r"//.*")


class _Typed(Lexer):
    """Stands for the taggers: Lark makes no lexer of its own, and never reads a word."""

    def __init__(self, lexer_conf: Any) -> None:
        """Take what Lark gives every lexer; nothing of it is needed."""

    def lex(self, data: Any, parser_state: Any = None) -> Iterator[lark.Token]:
        """Yield the tokens that are given."""
        return iter(data)


def declared(source: Source) -> str:
    """Return the text of a grammar with its terminals declared, as Lark wants it."""
    terminals = sorted(set(_TERMINAL.findall(_COMMENT.sub("", source.text))))
    return f"{source.text}%declare {' '.join(terminals)}\n"


def computed(source: Source) -> Tables:
    """Return the tables of a grammar.

    Raises lark.exceptions.GrammarError where the text is no grammar, and where two rules want the
    same token: two readings are never the parser's pick.
    """
    grammar = lark.Lark(
        declared(source),
        parser="lalr",
        lexer=_Typed,
        start=list(source.start),
        maybe_placeholders=False,
    )
    conf = ParserConf(grammar.rules, {}, list(source.start))
    analysis = LALR_Analyzer(conf, debug=True, strict=True)  # debug: states by what is in them
    analysis.compute_lalr()  # type: ignore[no-untyped-call]  # Lark does not type it
    table = analysis.parse_table
    rules = {rule: number for number, rule in enumerate(grammar.rules)}
    order = {state: number for number, state in enumerate(_walk(table))}
    states: list[dict[str, int]] = [{} for _ in order]
    for state, number in order.items():
        for symbol, (action, to) in sorted(table.states[state].items()):
            states[number][symbol] = order[to] if action is Shift else ~rules[to]
    for complete in table.end_states.values():
        number = order[complete]
        states[number][END] = number  # Lark tells the end by the state, the walk by a step
    starts = {name: order[table.start_states[name]] for name in source.start}
    return Tables([_rule(rule) for rule in grammar.rules], states, starts)


def _walk(table: ParseTable) -> list[frozenset[RulePtr]]:
    """Return the states as they are reached: an order of the grammar's, not of the process's."""
    reached = [table.start_states[name] for name in sorted(table.start_states)]
    known = set(reached)
    for state in reached:  # grows while it is walked
        for _, (action, to) in sorted(table.states[state].items()):
            if action is Shift and to not in known:
                known.add(to)
                reached.append(to)
    return reached


def _rule(rule: LarkRule) -> Rule:
    """Return what is needed of one of Lark's rules: which symbols its method is given."""
    kept = [
        ~index if _repeats(symbol) else index
        for index, symbol in enumerate(rule.expansion)
        if not (isinstance(symbol, Terminal) and symbol.filter_out)
    ]
    all_kept = kept == list(range(len(rule.expansion)))
    return Rule(
        origin=rule.origin.name,
        size=len(rule.expansion),
        kept=None if all_kept else kept,
        method="" if _repeats(rule.origin) else rule.alias or rule.origin.name,
        single=rule.options.expand1 and not rule.alias,
    )


def _repeats(symbol: Symbol) -> bool:
    """Whether a symbol is one that Lark made of `x+` or `x*`: its parts go to the rule around."""
    return not symbol.is_term and symbol.name.startswith("_")


def write(source: Source) -> None:
    """Write the tables of a grammar beside it."""
    record = {"made_from": source.made_from, **computed(source)._asdict()}
    source.path.write_text(
        json.dumps(record, separators=(",", ":"), sort_keys=True) + "\n", encoding="utf-8"
    )


def terminals(text: str, now: datetime) -> list[str]:
    """Return a line for each terminal of a text: its name and the words from where it stands.

    now: aware. Raises QuestionError for what is refused before the rules see it.
    """

    def lines(reading: Reading, sentences: list[list[Word]]) -> list[str]:
        found = [tag for words in sentences for tag in reading.terminals(words, None).tagged.tags]
        return [f"{tag.type:12} {text[tag.word.start : tag.word.end]}" for tag in found]

    return read(text, now, NO_STORE, lines)[0]


def main() -> None:
    """Write the tables of every grammar, or print the terminals of a sentence."""
    parser = argparse.ArgumentParser(prog="python -m grammar.tables", description=__doc__)
    parser.add_argument("--terminals", metavar="SENTENCE", help="print them, and write nothing")
    said = parser.parse_args().terminals
    if said is not None:
        sys.stdout.write("\n".join([*terminals(said, datetime.now(UTC)), ""]))
        return
    for source in SOURCES:
        write(source)


if __name__ == "__main__":
    main()
