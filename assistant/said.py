"""How a thing was said, which formal queries do not hold: one or several, known or any."""

from __future__ import annotations

import re

from assistant.english import is_many, plural
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

_GOES_ON = re.compile(r"(and|or|but|what about|how about) (in|on|under|at|with|next|behind|near)\b")
"""How a question begins that asks of a place alone, of what the one before was about."""
_IT, _THEY = frozenset({"it"}), frozenset({"they", "them", "these", "those"})


def said_many(query: FormalQuery, term: ObjectTerm) -> bool:
    """Whether a noun was said in the plural, or has no singular: keys, scissors; or as "they".

    The query holds the singular alone; the question's own words tell the rest.
    """
    if is_many(term.word):
        return True
    said = _as_said(query, term)
    return any(word != term.word for word in said) or (not said and _tells(query, _THEY))


def is_one(query: FormalQuery) -> bool:
    """Whether the first object was said as one that is known: the wallet, my keys, it."""
    term = query.objects[0] if query.objects else ObjectTerm(ANYTHING)
    return _is_known(query, term) or (not _as_said(query, term) and _tells(query, _IT | _THEY))


def known_of(query: FormalQuery) -> tuple[str, ...]:
    """Return the variables of the objects that were said as known: the wallet, my keys, it.

    What was spoken of before is known, too: and on the shelf?
    """
    term = query.objects[0] if query.objects else ObjectTerm(ANYTHING)
    goes_on = _GOES_ON.match(query.text.casefold()) and not _as_said(query, term)
    first = query.objects[:1] if is_one(query) or goes_on else ()
    return tuple(t.var for t in query.objects if t in first or _is_known(query, t))


def _is_known(query: FormalQuery, term: ObjectTerm) -> bool:
    nouns = "|".join(map(re.escape, (term.word, plural(term.word))))
    said = rf"\bthe\s+(pairs?\s+of\s+)?([\w'-]+\s+){{0,{len(term.attributes)}}}({nouns})\b"
    return term.owner is not None or re.search(said, query.text.casefold()) is not None


def _as_said(query: FormalQuery, term: ObjectTerm) -> list[str]:
    """Return the words of a question that are the noun, in the singular or the plural."""
    words = [word.removesuffix("'s") for word in _spoken(query)]
    length = len(term.word.split())
    windows = (" ".join(words[i : i + length]) for i in range(len(words) - length + 1))
    return [w for w in windows if w == term.word or vocabulary.singular(w) == term.word]


def _spoken(query: FormalQuery) -> list[str]:
    taken = {c.said.lower(): c.taken.lower() for c in query.corrections}  # kees are keys
    words = query.text.lower().split()
    bare = ("".join(ch for ch in word if ch.isalnum() or ch in "'-") for word in words)
    return [taken.get(word, word) for word in bare]


def _tells(query: FormalQuery, pronouns: frozenset[str]) -> bool:
    return not pronouns.isdisjoint(_spoken(query))
