"""Reading of the vocabulary files: plain text, a word a line, `#` starts a comment."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from pathlib import Path

_HERE = Path(__file__).parent


def lines(name: str) -> Iterator[str]:
    """Yield the lines of the vocabulary file `name` that say something."""
    for line in (_HERE / name).read_text(encoding="utf-8").splitlines():
        said = line.strip()
        if said and not said.startswith("#"):
            yield said


def split(text: str, mark: str = ",") -> tuple[str, ...]:
    """Split a list of phrases at `mark`, spaces trimmed, empty ones left out."""
    return tuple(part.strip() for part in text.split(mark) if part.strip())


def spelled(phrase: str) -> Iterator[tuple[str, ...]]:
    """Yield the phrases that one stands for, each as its words; `is|was` is either word."""
    if "|" in phrase:
        yield from product(*(word.split("|") for word in phrase.split()))
    else:
        yield tuple(phrase.split())


@lru_cache(maxsize=8)
def sections(name: str) -> Mapping[str, Sequence[str]]:
    """Return the lines of a file with `[section]` headings, by heading; a file is read once."""
    found: dict[str, list[str]] = {}
    current: list[str] = []
    for line in lines(name):
        if line.startswith("["):
            current = found.setdefault(line.strip("[]"), [])
        else:
            current.append(line)
    return found
