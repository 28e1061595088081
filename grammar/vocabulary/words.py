"""What others ask of the vocabulary: the category of a noun, and its relatives."""

from __future__ import annotations

from grammar.vocabulary import inflection
from grammar.vocabulary.lexicon import lexicon


def canonical(noun: str) -> str:
    """Return the category of a noun: `mugs` is `cup`, `sportsball` is `sports ball`."""
    return lexicon().canonical(noun)


def broader(category: str) -> tuple[str, ...]:
    """Return the wider words of a category: `ball` for `sports ball`, `bowl` for `fruit bowl`."""
    return lexicon().wider(canonical(category))


def narrower(category: str) -> tuple[str, ...]:
    """Return the listed categories that a wider word takes in, in file order."""
    return lexicon().narrower(canonical(category))


def unlisted_lead(noun: str) -> str:
    """Return what stands before the head of a compound that no list has: `blurple` of a cup.

    Empty for one that is listed, whose head is not, or that begins with a place.
    """
    words = lexicon()
    lead, _, head = noun.rpartition(" ")
    listed = noun in words.nouns or head not in words.nouns or lead in words.places
    return "" if listed else lead


def synonyms(category: str) -> tuple[str, ...]:
    """Return the other words for a category, in file order."""
    return lexicon().synonyms(canonical(category))


def singular(noun: str) -> str:
    """Return the singular of a noun or compound."""
    return inflection.singular(noun.lower(), lexicon().plurals)


def plural(noun: str) -> str:
    """Return the plural of a noun or compound."""
    return inflection.plural(singular(noun), lexicon().plurals)
