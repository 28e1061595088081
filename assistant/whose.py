"""Whose a thing is, where that is asked: only what somebody told can be said of it."""

from __future__ import annotations

import re

from assistant.english import listed
from assistant.phrases import numbered, term_of, theirs
from assistant.said import said_many
from d3a.answer import Answer
from d3a.answering.facts import Facts
from d3a.answering.match import squash
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

_SAID_LAST = re.compile(r"\b(mine|yours|ours|hers|his|theirs|\w+'s)\W*$|\bbelongs?\b")
"""What is asked is the owner: are those keys mine, does the cup belong to Anna."""


def whose_words(answer: Answer, query: FormalQuery, facts: Facts) -> str:
    """Return that nobody told it is theirs, where it is asked whether it is; else "".

    Where somebody did, the answer tells where that was seen. Raises StoreError.
    """
    term = term_of(query)
    somewhere = query.relation is not None or query.place is not None or query.time is not None
    if query.ask != "whether" or term.owner is None or term.category == ANYTHING or somewhere:
        return ""
    if not _SAID_LAST.search(query.text.casefold().replace("\u2019", "'")):
        return ""
    owners = {name.owner for name in facts.names() if name.owner and _is_called(name.word, term)}
    if term.owner in owners or answer.status == "unknown_object":
        return ""
    verb = "are" if said_many(query, term) else "is"
    thing = f"the {numbered(query, term)}"
    told = f"Nobody told me that {thing} {verb} {theirs(term.owner)}."
    others = listed([theirs(owner) for owner in sorted(owners)])
    return f"{told} I know of some that are {others}." if owners else told


def _is_called(name: str, term: ObjectTerm) -> bool:
    """Whether a taught name is the noun, or ends in a word for it: of a blue mug, the cup."""
    if squash(name) in (squash(term.word), squash(term.category)):
        return True
    words = name.casefold().split()
    heads = (" ".join(words[start:]) for start in range(len(words)))
    return any(vocabulary.canonical(head) == term.category for head in heads)
