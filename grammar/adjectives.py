"""Adjectives that no list holds, told by how they are made: quilted, leafy, waterproof, woven."""

from __future__ import annotations

from collections.abc import Collection

from grammar.closed import words_of

_ENDINGS = ("ish", "less", "like", "proof", "ous", "esque", "ful", "able", "ible", "style")
_LEAST = 5
"""A shorter word that ends so is no adjective: bed, sofa, eye."""
PARTICIPLES = words_of(
    "woven handwoven interwoven broken frozen worn torn bent sewn knit drawn handwritten written "
    "shrunken sunken fallen stolen molten swollen painted blown handblown spun rolled cut split "
    "burnt unworn unsewn strewn mown shorn hewn laden shaven threadbare bound leatherbound"
)
"""Participles that do not end in -ed."""


def describes(word: str, nouns: Collection[str]) -> bool:
    """Whether an unlisted word before a noun describes it.

    nouns: the last words of the listed nouns; none of them is an adjective.
    Such are participles (quilted), words made with a suffix of their own (waterproof, greenish),
    and nouns with -y or -en (leafy of leaf, silken of silk).
    """
    if word in nouns or len(word) < _LEAST or not word.isalpha():
        return False
    if word in PARTICIPLES or (word.endswith("ed") and not word.endswith("eed")):
        return True
    if word.endswith(_ENDINGS):
        return True
    return any(word.endswith(ending) and _made_of(word, ending, nouns) for ending in ("y", "en"))


def happened(word: str) -> bool:
    """Whether a word at the end of a noun phrase says what became of the thing: `door opened`."""
    return word in PARTICIPLES or (word.endswith(("ed", "ing")) and len(word) >= _LEAST)


def _made_of(word: str, ending: str, nouns: Collection[str]) -> bool:
    """Whether the word is a noun with `ending`: leaf-y, strip(e)-y, fur(r)-y, silk-en."""
    stem = word.removesuffix(ending)
    stems = {stem, stem + "e"}
    if stem[-1:] == stem[-2:-1]:
        stems.add(stem[:-1])
    return any(s in nouns and len(s) > 2 for s in stems)
