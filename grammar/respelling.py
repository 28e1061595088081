"""Slips in the grammar's own words, for a sentence that no rule reads: `did yu se my keys`.

A noun may be any word, a verb of the grammar may not: so these are tried only after the sentence
has failed, only for words nobody knows or that sound like another, and what was taken is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import islice, product

from grammar import scope, spelling
from grammar.forms import Correction
from grammar.phrases import phrases
from grammar.words import Word

_SOUNDS = {
    "sea": "see", "scene": "seen", "our": "are", "hour": "our", "bean": "been", "their": "there",
    "wear": "where", "ware": "where", "witch": "which", "wen": "when",
    "eye": "i", "inn": "in", "off": "of", "buy": "by", "hear": "here",
}  # fmt: skip
"""Words that a recogniser writes for a word of the grammar that sounds the same."""
_TERMINALS = (
    "SEE", "LEAVE", "FINDS", "MOVED", "WHO", "HAVE", "AUX_DID", "AUX_DO", "AUX_HAVE", "AUX_CAN",
    "BE_PRESENT", "BE_PAST", "_WHERE", "_WHEN", "_WHAT", "_WHICH", "last", "first", "usual",
)  # fmt: skip
_SMALL = ("the", "you", "many", "often", "long", "ever")
_LEAST, _MOST_TRIES = 3, 12
Respelled = tuple[list[Word], tuple[Correction, ...]]


@lru_cache(maxsize=1)
def _own() -> tuple[str, ...]:
    """Return the single words of the grammar that a slip may stand for, the shortest first."""
    said = {
        parts[0]
        for entries in phrases().by_first.values()
        for parts, terminal in entries
        if len(parts) == 1 and terminal.strip() in _TERMINALS
    }
    return tuple(
        sorted((w for w in {*said, *_SMALL} if len(w) >= _LEAST), key=lambda w: (len(w), w))
    )


def respelled(
    words: list[Word], known: frozenset[str], corrections: tuple[Correction, ...]
) -> Iterator[Respelled]:
    """Yield the words of a question with slips of the grammar's words made good, likeliest first.

    known: every word that needs no correction of its own. corrections: the nouns that words were
    taken for, which they need not be: `leve` may be a lever, and a slip of leave.
    """
    taken_for = {c.position: c.said for c in corrections}
    meant = [_meant(taken_for.get(word.start, word.text), known) for word in words]
    if not (scope.asks(words) or meant[:1] != [()]):
        return
    for taken in islice(product(*[(*found, "") for found in meant]), _MOST_TRIES):
        changed = [
            replace(word, text=text) if text else word
            for word, text in zip(words, taken, strict=True)
        ]
        told = {
            word.start: Correction(taken_for.get(word.start, word.text), text, word.start)
            for word, text in zip(words, taken, strict=True)
            if text
        }
        if told:
            kept = (c for c in corrections if c.position not in told)
            yield changed, (*kept, *told.values())


def _meant(said: str, known: frozenset[str]) -> tuple[str, ...]:
    """Return the words of the grammar that a word may be a slip of."""
    if said in _SOUNDS:
        return (_SOUNDS[said],)
    if said in known or len(said) < _LEAST - 1 or not said.isalpha():
        return ()
    return tuple(word for word in _own() if _is_slip(said, word))


def _is_slip(said: str, meant: str) -> bool:
    """Whether letters are swapped, one is left out or struck twice, or of a short word a vowel."""
    if said[0] != meant[0] or said == meant:
        return False
    if len(said) == len(meant):
        wrong = [k for k, (a, b) in enumerate(zip(said, meant, strict=True)) if a != b]
        swapped = len(wrong) == 2 and wrong[1] == wrong[0] + 1 and sorted(said) == sorted(meant)
        beside = len(wrong) == 1 and spelling.beside(said[wrong[0]], meant[wrong[0]])
        vowel = meant in _SMALL and len(wrong) == 1 and {said[wrong[0]], meant[wrong[0]]} <= _VOWELS
        return swapped or vowel or beside
    if len(said) + 1 == len(meant):
        return any(meant[:k] + meant[k + 1 :] == said for k in range(1, len(meant)))
    twice = [k for k in range(1, len(said)) if said[k] == said[k - 1]]
    return len(said) == len(meant) + 1 and any(said[:k] + said[k + 1 :] == meant for k in twice)


_VOWELS = frozenset("aeiouy")
