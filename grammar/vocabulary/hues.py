"""The names of colours of the public lists, and how one is carried through the parser as a word."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from grammar.vocabulary import files

_MARK = "-hue"
_CARRIED = re.compile(rf"[^\s]+{_MARK}\b")


@dataclass(frozen=True, slots=True)
class Hues:
    """Names of colours that need more than a look at one word.

    beginning: the names by their first word, each as its words, the longest first. glued: names
    of several words as style sheets write them, in one: aliceblue. things: names that are things
    or stuff too.
    """

    beginning: Mapping[str, tuple[tuple[str, ...], ...]]
    glued: frozenset[str]
    things: frozenset[str]


@lru_cache(maxsize=1)
def hues() -> Hues:
    """Return the listed names."""
    found = files.sections("colours.txt")
    several = [name for line in found["several"] for name in files.split(line)]
    things = frozenset(word for line in found["things"] for word in line.split())
    single = {word for line in found["single"] for word in line.split()} | things
    beginning: dict[str, list[tuple[str, ...]]] = {}
    for name in (*several, *single):
        words = tuple(name.split())
        beginning.setdefault(words[0], []).append(words)
    ordered = {first: tuple(sorted(names, key=len)[::-1]) for first, names in beginning.items()}
    return Hues(ordered, frozenset(name.replace(" ", "") for name in several), things)


def carried(name: str) -> str:
    """Return a name of a colour as one word, which nobody says: burnt-sienna-hue."""
    return name.replace(" ", "-") + _MARK


@lru_cache(maxsize=1)
def carried_names() -> frozenset[str]:
    """Return every listed name as a word that carries it, in all its spellings."""
    listed = hues()
    names = {" ".join(name) for each in listed.beginning.values() for name in each} | listed.glued
    return frozenset(
        carried(said) for name in names for said in (name, name.replace("grey", "gray"))
    )


def is_carried(word: str) -> bool:
    """Whether a word carries the name of a colour."""
    return word.endswith(_MARK)


def as_said(text: str) -> str:
    """Return a text with the names that it carries as they are said: burnt sienna."""
    return _CARRIED.sub(lambda m: m[0].removesuffix(_MARK).replace("-", " "), text)
