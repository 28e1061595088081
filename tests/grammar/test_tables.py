"""The parse tables: fresh, without conflicts, and the same parser as the grammar's text."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import pytest
from lark import Lark
from lark import logger as lark_logger

from grammar.lalr import Source, Typed
from grammar.tables import SOURCES


@pytest.fixture
def debug(caplog: pytest.LogCaptureFixture) -> Iterator[pytest.LogCaptureFixture]:
    """Lark's log at its loudest, where it tells of conflicts."""
    before, spread = lark_logger.level, lark_logger.propagate
    lark_logger.setLevel(logging.DEBUG)
    lark_logger.addHandler(caplog.handler)
    caplog.set_level(logging.DEBUG)
    yield caplog
    lark_logger.removeHandler(caplog.handler)
    lark_logger.setLevel(before)
    lark_logger.propagate = spread


@pytest.mark.parametrize("source", SOURCES, ids=lambda s: s.name)
def test_tables_are_of_the_grammar_beside_them(source: Source) -> None:
    assert source.digest in source.tables.read_text(encoding="utf-8"), (
        "run python -m grammar.tables"
    )


@pytest.mark.parametrize("source", SOURCES, ids=lambda s: s.name)
def test_no_rule_is_chosen_by_the_parser(source: Source, debug: pytest.LogCaptureFixture) -> None:
    Lark(source.text, parser="lalr", lexer=Typed, start=list(source.start), debug=True)
    assert [r.getMessage() for r in debug.records if "conflict" in r.getMessage().lower()] == []
