"""The lexicon: nouns with synonyms and broader words, attributes, places, relations, names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from grammar.forms import ANYTHING, RelationKind
from grammar.numbers import CARDINALS
from grammar.vocabulary import files, inflection
from grammar.vocabulary.hues import carried_names

THINGS = frozenset(
    ("thing", "anything", "something", "everything", "stuff", "object", "item", "belonging")
)
_LEAST_JOINED = 5
"""Two words that join to a noun of so few letters are two words: to day."""


@dataclass(frozen=True)
class StoreWords:
    """A store's own words, handed in as arguments: its categories, taught names and regions.

    names: (word, owner or None) of taught things. places: names of the home's regions.
    """

    categories: tuple[str, ...] | frozenset[str] = ()
    names: tuple[tuple[str, str | None], ...] = ()
    places: tuple[str, ...] = ()


@dataclass(frozen=True)
class Lexicon:
    """All words the parser knows, of the vocabulary files and of one store.

    nouns: singular noun -> category. broader: category -> wider words. attributes: word -> kind.
    places: phrase -> place, spelled as the store does where it has it. relations: phrase -> kind.
    names: of people. taught: what things of the store are called, be it a first name.
    words: every word that a noun is made of.
    """

    nouns: dict[str, str]
    broader: dict[str, tuple[str, ...]]
    plurals: dict[str, str]
    attributes: dict[str, str]
    shades: frozenset[str]
    patterns: dict[str, str]
    parts: frozenset[str]
    noise: frozenset[str]
    places: dict[str, str]
    relations: dict[str, RelationKind]
    names: frozenset[str]
    taught: frozenset[str]
    glued: dict[str, str] = field(repr=False)
    heads: frozenset[str] = field(repr=False)
    words: frozenset[str] = field(repr=False)

    def singular(self, noun: str) -> str:
        """Return the singular of a noun, lower case."""
        return inflection.singular(noun, self.plurals)

    def known_noun(self, noun: str) -> str | None:
        """Return the singular of `noun` when the lexicon knows it, else None."""
        if noun in self.nouns:
            return noun
        one = self.singular(noun)
        if one in self.nouns or one in THINGS:
            return one
        return None

    def is_one_word(self, joined: str) -> bool:
        """Whether words that were said apart are, joined, one listed noun: head phones."""
        one = joined if joined in self.nouns else self.singular(joined)
        return len(one) > _LEAST_JOINED and " " not in one and one in self.nouns

    def canonical(self, noun: str) -> str:
        """Return the category of a noun as said: after plural, synonyms and detector spelling.

        An unknown noun is its own category; a compound of a known head keeps its words.
        """
        if noun in self.nouns:
            return self.nouns[noun]
        one = self.singular(noun.lower().strip())
        if one in THINGS:
            return ANYTHING
        found = self.nouns.get(one) or self.nouns.get(self.glued.get(one, one))
        return found or self.nouns.get(one.replace(" ", "")) or one

    def wider(self, category: str) -> tuple[str, ...]:
        """Return the words that take in `category` and more, nearest first.

        A compound that the files do not list is a kind of its last word: `fruit bowl`, `bowl`;
        with a number after it, of the word before: `shelf 2`, `shelf`.
        """
        if category in self.broader:
            return self.broader[category]
        kind, _, head = category.rpartition(" ")
        if head.isdecimal() or head in CARDINALS:
            head = kind
        if head and head != category:
            general = self.canonical(head)
            return (general, *self.broader.get(general, ()))
        return ()

    def narrower(self, category: str) -> tuple[str, ...]:
        """Return the listed categories that `category` takes in, in file order."""
        return tuple(name for name, wide in self.broader.items() if category in wide)

    def synonyms(self, category: str) -> tuple[str, ...]:
        """Return the other words for `category`, in file order."""
        return tuple(w for w, c in self.nouns.items() if c == category and w != category)


def _noun_lines() -> Iterator[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    for line in files.lines("nouns.txt"):
        left, _, wide = line.partition(">")
        category, _, said = left.partition("=")
        yield category.strip(), files.split(said), files.split(wide)


def _plural_exceptions() -> dict[str, str]:
    found: dict[str, str] = {}
    for line in files.lines("plurals.txt"):
        many, _, one = line.partition("=")
        found[many.strip()] = one.strip() or many.strip()
    return found


def _attribute_files(
    parts: Mapping[str, Sequence[str]],
) -> tuple[dict[str, str], frozenset[str], dict[str, str], frozenset[str]]:
    kinds = {
        word: kind
        for kind in ("other", "size", "shape", "pattern", "material", "colour")
        for line in parts[kind]
        for word in line.split()
    }
    shades = frozenset(word for line in parts["shade"] for word in line.split())
    patterns = {
        said.strip(): word.strip()
        for said, _, word in (line.partition("=") for line in parts["pattern noun"])
    }
    pieces = frozenset(word for line in parts["part"] for word in line.split())
    return kinds, shades, patterns, pieces


def _places(own: Iterable[str]) -> dict[str, str]:
    """Return each place with the name it is printed by: as said, or as the store spells it.

    A hyphen or underscore of the store is a pause in speech: "the reading corner".
    """
    names = [name.lower() for name in own]
    taught = {re.sub(r"[-_\s]+", " ", name).strip(): name for name in names}
    taught.update({name: name for name in names})
    found: dict[str, str] = {}
    for line in files.lines("places.txt"):
        place, _, said = line.partition("=")
        alike = (place.strip(), *files.split(said))
        spelled = next((taught[name] for name in alike if name in taught), None)
        found.update({name: spelled or name for name in alike})
    found.update(taught)
    return found


def _relations() -> dict[str, RelationKind]:
    found: dict[str, RelationKind] = {}
    for line in files.lines("relations.txt"):
        kind, _, said = line.partition(":")
        for phrase in files.split(said):
            found[phrase] = kind.strip()  # type: ignore[assignment]  # a test checks the kinds
    return found


@lru_cache(maxsize=1)
def _listed() -> tuple[dict[str, str], dict[str, str], dict[str, tuple[str, ...]]]:
    """Return odd plurals, nouns and wider words of the files: read once for every lexicon."""
    plurals = _plural_exceptions()
    return plurals, *_nouns(plurals)


def _nouns(plurals: dict[str, str]) -> tuple[dict[str, str], dict[str, tuple[str, ...]]]:
    """Return the category of each noun, and the wider words of each category, as listed."""
    nouns: dict[str, str] = {}
    broader: dict[str, tuple[str, ...]] = {}
    listed = list(_noun_lines())
    for category, said, wide in listed:
        nouns[category] = category
        broader[category] = wide
        for word in said:
            nouns.setdefault(word, category)
    for category, said, _ in listed:
        nouns[category] = category  # a category is never another one's synonym
        for word in said:
            nouns.setdefault(inflection.singular(word, plurals), category)
    return nouns, broader


@lru_cache(maxsize=16)
def lexicon(words: StoreWords = StoreWords()) -> Lexicon:  # frozen and empty
    """Return the lexicon with a store's words added; one object for equal words."""
    plurals, listed, broader = _listed()
    names = {name for line in files.lines("names.txt") for name in line.split()}
    plurals = plurals | {name: name for name in names if name.endswith("s")}  # james is one
    taught = {inflection.singular(word.lower(), plurals) for word, _ in words.names}
    names -= taught  # a thing that is called Tim is no person
    nouns = dict(listed)  # a store's words are added to it
    glued = {noun.replace(" ", ""): noun for noun in nouns if " " in noun}
    for name in [*words.categories, *(word for word, _ in words.names)]:
        one = inflection.singular(name.lower(), plurals)
        nouns.setdefault(one, nouns.get(glued.get(one, one), one))
    described = files.sections("attributes.txt")
    kinds, shades, patterns, parts = _attribute_files(described)
    names |= {owner.lower() for _, owner in words.names if owner and owner not in ("me", "you")}
    return Lexicon(
        nouns=nouns,
        broader={c: tuple(nouns.get(w, w) for w in wide) for c, wide in broader.items()},
        plurals=plurals,
        attributes=kinds | dict.fromkeys(carried_names(), "colour"),
        shades=shades,
        patterns=patterns,
        parts=parts,
        noise=frozenset(word for line in described["noise"] for word in line.split()),
        places=_places(words.places),
        relations=_relations(),
        names=frozenset(names),
        taught=frozenset(taught),
        glued=glued,
        heads=frozenset(noun.rpartition(" ")[2] for noun in nouns),
        words=frozenset(word for noun in nouns for word in noun.split()),
    )
