"""What tells things of one kind apart for a person: the colour that each looked.

"Which cup is on the table?" asks for no cup, but for the one that it is.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

from assistant.phrases import heads_of, kind_of, term_of
from d3a.answer import Answer
from d3a.answering import columns
from d3a.answering.attributes import seen_colours
from d3a.answering.facts import Facts
from grammar.forms import ANYTHING, FormalQuery

_MOST_TOLD = 16
"""Of so many things the first are told by their colours: more are not listed."""
_SURELY_SEVERAL = 64
"""So many ids of a kind are several things, whatever moved."""


def with_colours(answer: Answer, query: FormalQuery, facts: Facts) -> Answer:
    """Return the answer with the colours of what is listed, where there are several of its kind.

    Asked of a kind, or what moved; what looks were asked for goes without saying. What looked like
    no colour has none. Raises StoreError.
    """
    term = term_of(query)
    named = term.category != ANYTHING
    asked = query.ask == "moved" or (query.ask == "what" and named)
    known = term.or_else or term.attributes or term.without
    if answer.status != "found" or not asked or known:
        return answer
    listed: defaultdict[str, dict[str, str]] = defaultdict(dict)
    for keyframe in heads_of(answer):
        listed[kind_of(keyframe)][keyframe.object_id] = keyframe.category
    ids = [
        name
        for words in listed.values()
        if (named or len(words) > 1) and _are_several({*words.values()}, facts)
        for name in words
    ][:_MOST_TOLD]
    records = facts.store.objects(ids=ids) if ids else []
    seen = seen_colours(facts.looks(records)) if records else {}
    told = {records[row].object_id: " or ".join(colours) for row, colours in seen.items()}
    return replace(answer, colours=tuple(told.items()))


def _are_several(categories: set[str], facts: Facts) -> bool:
    """Whether a round showed two things of some categories; what is seen once may be a mistake."""
    records = facts.objects(sorted(categories), embeddings=False)
    sure = [r.object_id for r in records if r.category in categories and not r.tentative]
    if len(sure) >= _SURELY_SEVERAL:
        return True
    seen = facts.spans(sorted(sure), None, None)
    return columns.least_number(seen.of, seen.start_ms, seen.end_ms) > 1


def colour_of(answer: Answer, object_id: str) -> str:
    """Return the colour that a thing is told by, and "" where it is told by its kind alone."""
    return dict(answer.colours).get(object_id, "")
