"""The grammar's vocabulary as `d3a.answering.match.Lexicon`: the words of the language."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from grammar import vocabulary
from grammar.vocabulary import lexicon

LEAST_ALIKE = 80.0
"""Words less alike than this, of 100, are no suggestion: of five letters one may be another."""


class VocabularyLexicon:
    """Synonyms, broader and narrower words of the vocabulary files; nearness by spelling."""

    def canonical(self, word: str) -> str:
        """Return the category of a word after plural, synonyms and detector spelling."""
        return _canonical(word)

    def broader(self, category: str) -> Sequence[str]:
        """Return the wider words, nearest first."""
        return _broader(category)

    def narrower(self, category: str) -> Sequence[str]:
        """Return the categories that a wider word takes in, and what those take in."""
        return _narrower(category)

    def is_part(self, word: str) -> bool:
        """Return whether a word names a part of a thing: handle, lid."""
        return word in lexicon().parts

    def unlisted_lead(self, word: str) -> str:
        """Return what stands before the head of a compound that is in no list, "" for none."""
        return vocabulary.unlisted_lead(word)

    def nearest(self, word: str, among: Sequence[str]) -> Sequence[str]:
        """Return up to three words like `word`: of one kind with it, or a slip of its spelling.

        Words of one kind share a broader word: a wallet is nearer to a handbag than to a wall. What
        the vocabulary knows is no slip, however near its letters are: no shoe is a shelf.
        """
        from rapidfuzz import fuzz, process  # only a word without an answer needs it

        kinds = set(self.broader(self.canonical(word)))
        kin = [w for w in among if kinds & {*self.broader(self.canonical(w)), self.canonical(w)}]
        if vocabulary.singular(word) in lexicon().nouns:
            return tuple(kin[:3])
        alike = process.extract(word, among, scorer=fuzz.ratio, score_cutoff=LEAST_ALIKE, limit=3)
        return tuple(dict.fromkeys([*(w for w, _, _ in alike), *kin]))[:3]


@lru_cache(maxsize=4096)
def _canonical(word: str) -> str:
    return vocabulary.canonical(word.replace("_", " ").lower())


@lru_cache(maxsize=4096)
def _broader(category: str) -> tuple[str, ...]:
    return vocabulary.broader(category)


@lru_cache(maxsize=1024)
def _narrower(category: str) -> tuple[str, ...]:
    found: list[str] = []
    waiting = list(vocabulary.narrower(category))
    while waiting:
        word = waiting.pop(0)
        if word not in found:
            found.append(word)
            waiting += vocabulary.narrower(word)
    return tuple(found)
