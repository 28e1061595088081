"""Lark's LALR parser over tokens that are typed already, and its tables kept between processes.

Building the tables costs more than a hundred questions, so they are kept as JSON beside their
grammar (`python -m grammar.tables` writes them). A table is used only when it was made from the
very grammar text, terminals and release of Lark at hand; otherwise it is built anew.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import lark
from lark import Lark, Token, Transformer
from lark.grammar import Rule
from lark.lexer import Lexer, TerminalDef

_HERE = Path(__file__).parent
_TERMINAL = re.compile(r"\b_?[A-Z][A-Z0-9_]*\b")
_COMMENT = re.compile(r"//.*")


class Typed(Lexer):
    """A lexer of tokens that are there already: it hands them on."""

    def __init__(self, lexer_conf: Any) -> None:
        """Take what Lark gives every lexer; nothing of it is needed."""

    def lex(self, data: Any, parser_state: Any = None) -> Iterator[Token]:
        """Yield the tokens."""
        return iter(data)


@dataclass(frozen=True, slots=True)
class Source:
    """A grammar: its file and its start rules. Every name in capitals is a terminal of its own."""

    name: str
    start: tuple[str, ...] = ("start",)

    @property
    def text(self) -> str:
        """The grammar with its terminals declared."""
        written = (_HERE / self.name).read_text(encoding="utf-8")
        terminals = sorted(set(_TERMINAL.findall(_COMMENT.sub("", written))))
        return f"{written}%declare {' '.join(terminals)}\n"

    @property
    def tables(self) -> Path:
        """Where the tables are kept."""
        return (_HERE / self.name).with_suffix(".tables.json")

    @property
    def digest(self) -> str:
        """What the tables were made from, in short."""
        parts = (lark.__version__, self.text, *self.start)
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def parser(source: Source, transformer: Transformer[Token, Any]) -> Lark:
    """Return the parser of a grammar, from its tables where they are of this grammar."""
    if source.tables.exists():
        kept = json.loads(source.tables.read_text(encoding="utf-8"), object_hook=_numbered)
        if kept["digest"] == source.digest:
            return _loaded(kept["data"], kept["memo"], transformer)
    return _built(source, transformer)


def _numbered(record: dict[str, Any]) -> dict[Any, Any]:
    """Return a record with its keys as the numbers that JSON wrote as text."""
    return {int(key) if key.isdecimal() else key: value for key, value in record.items()}


def _built(source: Source, transformer: Transformer[Token, Any] | None) -> Lark:
    return Lark(
        source.text,
        parser="lalr",
        lexer=Typed,
        start=list(source.start),
        transformer=transformer,
        maybe_placeholders=False,
    )


def _loaded(data: Any, memo: Any, transformer: Transformer[Token, Any]) -> Lark:
    data["options"]["lexer"] = Typed
    data["parser"]["lexer_conf"]["lexer_type"] = Typed
    loaded: Lark = Lark._load_from_dict(  # type: ignore[no-untyped-call]  # as `load` does
        data, memo, transformer=transformer
    )
    return loaded


def write(source: Source) -> None:
    """Write the tables of a grammar beside it."""
    data, memo = _built(source, None).memo_serialize([TerminalDef, Rule])
    data["options"]["lexer"] = data["parser"]["lexer_conf"]["lexer_type"] = "typed"
    record = {"digest": source.digest, "data": data, "memo": memo}
    source.tables.write_text(
        json.dumps(record, separators=(",", ":"), sort_keys=True) + "\n", encoding="utf-8"
    )
