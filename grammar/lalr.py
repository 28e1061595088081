"""Lark's LALR parser over tokens that are typed already."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lark import Lark, Token, Transformer
from lark.lexer import Lexer

_HERE = Path(__file__).parent


class Typed(Lexer):
    """A lexer of tokens that are there already: it hands them on."""

    def __init__(self, lexer_conf: Any) -> None:
        """Take what Lark gives every lexer; nothing of it is needed."""

    def lex(self, data: list[Token]) -> Iterator[Token]:  # type: ignore[override]
        """Yield the tokens."""
        return iter(data)


def parser(
    name: str,
    terminals: tuple[str, ...],
    transformer: Transformer[Token, Any],
    start: tuple[str, ...] = ("start",),
) -> Lark:
    """Build the parser of the grammar file `name`, its terminals declared."""
    text = (_HERE / name).read_text(encoding="utf-8")
    declared = f"%declare {' '.join(terminals)}\n"
    return Lark(
        text + declared,
        parser="lalr",
        lexer=Typed,
        start=list(start),
        transformer=transformer,
        maybe_placeholders=False,
    )
