"""Tables of text: columns under their usual other names, with commas, tabs or blanks between."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from d3a.model import BadInput
from d3a.readers import parsing
from d3a.readers.base import Skipped

Aliases = Mapping[str, tuple[str, ...]]
"""Column -> other names for it; a name counts in any case, with blanks or dashes for the _."""
Row = dict[str, str]


@dataclass(frozen=True, slots=True)
class Table:
    """columns: those found, by their one name. rows: (line number, values), empty ones left out."""

    columns: frozenset[str]
    rows: Iterator[tuple[int, Row]]


def read_table(path: Path, aliases: Aliases, bare: tuple[str, ...], skipped: Skipped) -> Table:
    """Open a table; its first line that is no comment (#) may name the columns.

    bare: the columns where no line names them. An unknown column is counted once and ignored.
    Raises BadInput for a file that cannot be read, is empty, or where a column comes twice.
    """
    lines = _lines(path)
    try:
        first = next(lines, None)
    except OSError as error:
        raise BadInput(f"{path.name} cannot be read: {error.strerror}") from error
    if first is None:
        raise BadInput(f"{path.name} is empty")
    delimiter = next((sign for sign in ",;\t" if sign in first[1]), None)
    header = _cells(first[1], delimiter)
    names = _named(header, aliases)
    if any(name is not None for name in names):
        _check(names, header, path, skipped)
    else:
        names, lines = list(bare), chain([first], lines)
    rows = _rows(lines, delimiter, names, path, skipped)
    return Table(frozenset(name for name in names if name is not None), rows)


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Yield (number from 1, line) of each line that says something."""
    with path.open(encoding="utf-8-sig", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            if line.strip() and not line.lstrip().startswith("#"):
                yield number, line.rstrip("\r\n")


def _cells(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]


def _plain(name: str) -> str:
    return parsing.clean_text(name).casefold().replace(" ", "_").replace("-", "_")


def _named(header: list[str], aliases: Aliases) -> list[str | None]:
    known = {_plain(other): name for name, others in aliases.items() for other in (name, *others)}
    return [known.get(_plain(cell)) for cell in header]


def _check(names: list[str | None], header: list[str], path: Path, skipped: Skipped) -> None:
    for name, said in zip(names, header, strict=True):
        if name is None:
            reason = f"unknown column in {path.name}: {parsing.clean_text(said)[:50]}"
            skipped.add(reason, path.name)
        elif names.count(name) > 1:
            raise BadInput(f"{path.name} has two columns for the {name}; leave one of them out")


def _rows(
    lines: Iterator[tuple[int, str]],
    delimiter: str | None,
    names: list[str | None],
    path: Path,
    skipped: Skipped,
) -> Iterator[tuple[int, Row]]:
    for number, line in lines:
        try:
            cells = _cells(line, delimiter)
        except csv.Error:
            skipped.add(parsing.BROKEN_LINE, f"{path.name}:{number}")
            continue
        row = zip(names, cells, strict=False)  # a cut line lacks its last cells
        yield number, {name: cell for name, cell in row if name is not None and cell}
