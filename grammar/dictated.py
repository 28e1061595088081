"""Marks that are dictated by their names: where is my cane question mark, robot comma where is it.

A recogniser that has no marks of its own writes the names; they are no part of what is asked.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.closed import LEADING, is_open, words_of
from grammar.vocabulary import Lexicon
from grammar.words import Word

_NAMES = {
    ("question", "mark"): "?", ("exclamation", "mark"): "!", ("exclamation", "point"): "!",
    ("full", "stop"): ".", ("period",): ".", ("comma",): ",",
}  # fmt: skip
_FIRST = frozenset(name[0] for name in _NAMES)
_KINDS = words_of("what which time no some any each every of")
"""After these a mark's name is a noun: in what period, which question mark."""


def with_marks(words: list[Word], lexicon: Lexicon) -> list[Word]:
    """Return the words with marks for their names, where these can be no things."""
    if _FIRST.isdisjoint(w.text for w in words):
        return words
    out: list[Word] = []
    i = 0
    while i < len(words):
        name = next((n for n in _NAMES if tuple(w.text for w in words[i : i + len(n)]) == n), ())
        after = words[i + len(name)].text if i + len(name) < len(words) else ""
        parts = _NAMES.get(name) == "," or not is_open(after)
        if not name or not out or not parts or _leads(out[-1].text, lexicon):
            out.append(words[i])
            i += 1
            continue
        out.append(replace(words[i], text=_NAMES[name], end=words[i + len(name) - 1].end))
        i += len(name)
    return out


def _leads(text: str, lexicon: Lexicon) -> bool:
    """Whether a noun is due after a word: the, my, anna's, a look."""
    return text in LEADING or text in _KINDS or text in lexicon.attributes or text.endswith("'s")
