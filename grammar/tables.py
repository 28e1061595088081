"""Write the parse tables beside their grammars: run `python -m grammar.tables` after a change."""

from __future__ import annotations

from grammar import lalr
from grammar.reading import QUESTION
from grammar.timespan import TIME

SOURCES = (QUESTION, TIME)


def main() -> None:
    """Write the tables of every grammar that has some."""
    for source in SOURCES:
        lalr.write(source)


if __name__ == "__main__":
    main()
