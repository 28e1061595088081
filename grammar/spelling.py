"""Spelling: a word that nobody knows becomes the known word it is a slip of, and that is reported.

A slip keeps the first letter (or swaps the first two), and is one letter left out, doubled, swapped
or struck beside its key; words of eight letters may hold two. Where two known words are as near,
or the word is as good a noun as any, nothing is changed: any noun may be asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from grammar import numbers, phrases, scope
from grammar import timewords as tw
from grammar.closed import CLOSED, is_open
from grammar.vocabulary import Lexicon, StoreWords, files, lexicon
from grammar.words import Word

_KEYS = ("qwertyuiop", "asdfghjkl", "zxcvbnm")
_MIN_LETTERS = 4


@dataclass(frozen=True, slots=True)
class Correction:
    """A word that was read as another: what was said, what was taken, and where it stands."""

    said: str
    taken: str
    position: int


@lru_cache(maxsize=16)
def _known(words: StoreWords) -> tuple[frozenset[str], tuple[str, ...]]:
    """Return every word that needs no correction, and those a slip may be corrected to."""
    lex = lexicon(words)
    targets: set[str] = set()
    for phrase in (*lex.nouns, *lex.attributes, *lex.places, *lex.plurals):
        targets.update(phrase.split())
    targets.update(lex.plurals.values())
    targets.update((*tw.WEEKDAYS, *tw.MONTHS, *tw.PARTS, "yesterday", "today", "tonight"))
    targets.update(("where", "what", "when", "which", "there", "between", "behind", "under"))
    targets.update(("beside", "together", "without", "many", "last", "before", "after", "since"))
    known = set(targets) | CLOSED | lex.names | lex.parts | set(lex.patterns) | lex.shades
    known |= set(numbers.CARDINALS) | set(numbers.ORDINALS) | set(tw.UNITS) | set(tw.MONTH_NUMBER)
    known |= set(tw.WEEKDAY_NUMBER) | set(tw.SEASONS) | set(tw.HOLIDAYS)
    for phrase in (*tw.PHRASES, *tw.HOLIDAYS, *phrases.spoken(), *scope.spoken()):
        known.update(phrase.split())
    for section in files.sections("speech.txt").values():
        known.update(word for line in section for word in line.split())
    return frozenset(known), tuple(sorted(word for word in targets if len(word) >= _MIN_LETTERS))


def corrected(
    words: list[Word], lex: Lexicon, store: StoreWords
) -> tuple[list[Word], tuple[Correction, ...]]:
    """Return the words with slips made good, and what was changed."""
    known, targets = _known(store)
    out: list[Word] = []
    changed: list[Correction] = []
    for word in words:
        taken = _taken(word, known, targets, lex)
        if taken is not None:
            changed.append(Correction(word.text, taken, word.start))
            word = replace(word, text=taken)
        out.append(word)
    return out, tuple(changed)


def _taken(word: Word, known: frozenset[str], targets: tuple[str, ...], lex: Lexicon) -> str | None:
    text = word.text
    if text in known or len(text) < _MIN_LETTERS or not text.isalpha() or not is_open(text):
        return None
    if lex.singular(text) in known or text in lex.glued or lex.singular(text) in lex.glued:
        return None
    from rapidfuzz import process  # only where a word is unknown: its import is not free
    from rapidfuzz.distance import OSA

    reach = 2 if len(text) >= 8 else 1
    near = process.extract(text, targets, scorer=OSA.distance, score_cutoff=reach, limit=8)
    fitting = [(distance, target) for target, distance, _ in near if _is_slip(text, target)]
    if not fitting:
        return None
    best = min(distance for distance, _ in fitting)
    nearest = sorted({target for distance, target in fitting if distance == best})
    if len(nearest) > 1:
        singles = {lex.singular(target) for target in nearest}
        return nearest[0] if len(singles) == 1 else None
    return nearest[0]


def _is_slip(said: str, meant: str) -> bool:
    """Whether `said` may be a slip of `meant` and is no other word by the look of it."""
    if said[0] != meant[0] and said[:2] != meant[1::-1]:
        return False
    if len(said) == len(meant):
        differing = [(a, b) for a, b in zip(said, meant, strict=True) if a != b]
        if len(differing) == 1:
            return len(said) > _MIN_LETTERS and _beside(*differing[0])
        return sorted(said) == sorted(meant) or len(said) >= 8
    if len(said) > len(meant):
        return len(meant) >= _MIN_LETTERS and (_doubles(said, meant) or len(said) >= 7)
    return not (meant == said + "s" or meant.endswith("ing"))


def _doubles(said: str, meant: str) -> bool:
    """Whether `said` is `meant` with one letter struck twice or a neighbour struck with it."""
    for i, letter in enumerate(said):
        if said[:i] + said[i + 1 :] == meant:
            around = said[max(0, i - 1) : i] + said[i + 1 : i + 2]
            return any(letter == other or _beside(letter, other) for other in around)
    return False


@lru_cache(maxsize=1024)
def _beside(a: str, b: str) -> bool:
    """Whether two letters are neighbours on the keyboard, or both vowels."""
    if a in "aeiouy" and b in "aeiouy":
        return True
    for row, keys in enumerate(_KEYS):
        if a not in keys:
            continue
        column = keys.index(a)
        for other in range(max(0, row - 1), min(3, row + 2)):
            near = _KEYS[other][max(0, column - 1) : column + 2]
            if b in near:
                return True
    return False
