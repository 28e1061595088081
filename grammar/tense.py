"""Whether a question asks for the present, by its words: what is so, and not what was ever seen.

The paper's form has no tense. "What is on the table?" and "What was on the table?" differ in it
alone, and so `FormalQuery.now` holds it.
"""

from __future__ import annotations

import re
from itertools import pairwise

from grammar.forms import Ask, FormalQuery

_IS = frozenset({"is", "are", "isn't", "aren't", "whats", "theres"})
_ASKING = frozenset({"what", "that", "there", "which", "where"})
_HAS = frozenset({"has", "have", "hasn't", "haven't"})
_DID = frozenset({"did", "didn't"})
_WAS = (
    frozenset({"was", "were", "wasn't", "weren't", "had", "been", "saw", "seen", "left", "put"})
    | _HAS
    | _DID
    | {"ever"}
)
_NOW = frozenset({"now", "currently", "presently"})
_LASTS = _NOW | {"still"}
_SEEING = frozenset({"see", "saw", "seen", "view", "watch", "watched", "look", "looked"})
_WHICH_WAS = re.compile(r"\b(that|which) (was|were|lay|stood|had been|used to be)\b")
_LISTS: frozenset[Ask] = frozenset({"what", "whether", "count"})


def asks_for_now(query: FormalQuery) -> bool:
    """Whether a query asks for the present, by its `text`; of a time that is named it never does.

    Where it is asked for a place, that is said already by `select`; it is of the present only where
    the thing is told by where it was before: where is the book now that was on the bed?
    """
    if query.time is not None:
        return False
    match query.ask:
        case "what" | "whether" | "count":
            return query.select == "all" and _is_present(query.text)
        case "where":
            return _stood_then(query)
        case "when":
            return ("since", "when") in pairwise(_words(query.text))
        case "how_long":
            return _lasts_still(query)
        case _:
            return False


def asks_where_it_has_been(query: FormalQuery) -> bool:
    """Whether it is asked for all places of a thing: where has it been, and not where it is."""
    words = _words(query.text)
    has = any(word in _HAS or word.endswith("'s") for word in words)
    return query.ask == "where" and has and words[-1] == "been"


def follows_now(text: str, ask: Ask, last: FormalQuery) -> bool:
    """Whether a follow-up asks for the present: by its own verb, else as the question before it.

    text: the follow-up's words. ask: what it asks for now. It is of no time.
    """
    words = _words(text)
    if ask in _LISTS and (_is_present(text) or any(word in _NOW for word in words)):
        return True
    if ask != last.ask and (ask not in _LISTS or last.ask not in _LISTS or _says_past(words)):
        return False
    return last.now


def chooses_a_sighting(query: FormalQuery) -> bool:
    """Whether `last` tells which sighting: what did you last see here, not what is here now."""
    words = _words(query.text)
    past = _says_past(words) and not any(w in _NOW for w in words)
    return query.ask == "what" and query.select == "last" and past and not asks_what_is_left(query)


def asks_what_is_left(query: FormalQuery) -> bool:
    """Whether it is asked what a person left somewhere, by no time: what did I leave here."""
    left = query.ask in ("what", "whether") and query.time is None
    return left and _asks_what_is_left(_words(query.text))


def asks_for_a_sighting(query: FormalQuery) -> bool:
    """Whether it is asked what was seen, and not what was so: did you see it, not was it there."""
    return any(word in _SEEING for word in _words(query.text))


def _lasts_still(query: FormalQuery) -> bool:
    """Whether "how long" is asked of what is so still, as in how long has it been there."""
    words = _words(query.text)
    has_been = "been" in words and any(word in _HAS for word in words)
    return (has_been or _is_present(query.text)) and not asks_for_a_sighting(query)


def _stood_then(query: FormalQuery) -> bool:
    """Whether it is asked where that is now which was somewhere: the book that was on the bed."""
    if query.relation is None or query.relation.negated or query.negated:
        return False
    said = query.text.casefold()
    return _WHICH_WAS.search(said) is not None and _is_present(said.partition(" that ")[0])


def _is_present(text: str) -> bool:
    """Whether the question's verb stands in the present, or what it tells lasts.

    A verb in the past beside it tells which thing is meant, where the question ends in "there" or
    says still: is the book that was on the bed still there? What one has left somewhere is there.
    """
    words = _words(text)
    if _asks_what_is_left(words):
        return True
    now = any(w in _IS or (w.endswith("'s") and w[:-2] in _ASKING) for w in words)
    if now and (not _LASTS.isdisjoint(words) or words[-1] == "there"):
        return True
    lasts = "still" in words and not _says_past([w for w in words if w not in _HAS])
    return lasts or (now and not _says_past(words))


def _asks_what_is_left(words: list[str]) -> bool:
    """Whether it is asked if a thing was left, to find it there: did I leave, have I forgotten."""
    if "ever" in words:
        return False
    forgot = "leave" in words or "forget" in words
    has_left = "forgotten" in words or "left" in _without_sides(words)
    return (forgot and not _DID.isdisjoint(words)) or (has_left and not _HAS.isdisjoint(words))


def _says_past(words: list[str]) -> bool:
    """Whether any word is one of the past."""
    return not _WAS.isdisjoint(_without_sides(words))


def _without_sides(words: list[str]) -> list[str]:
    """Return the words without a `left` that is a side: left of a thing, to the left."""
    around = zip(["", *words], words, [*words[1:], ""], strict=False)
    return [
        word
        for before, word, after in around
        if not (word == "left" and (before == "the" or after == "of"))
    ]


def _words(text: str) -> list[str]:
    return text.lower().replace("\u2019", "'").replace("?", " ").replace(",", " ").split()
