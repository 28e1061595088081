"""A record that says what its sentence says: a script reads the status, a person the words.

Two questions find sightings that are no answer. Of a moment, those before and after it tell what
was true then, and not always that it was so. Of a place or a thing that this memory does not
know, all that was ever seen is left when the condition is left out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from assistant.english import listed
from assistant.lexicon import VocabularyLexicon
from assistant.phrases import likely_of, plain_place, tells_nothing, the_place
from assistant.then import was_so
from d3a.answer import Answer
from d3a.answering.facts import Facts
from d3a.answering.points import edge_of
from grammar.forms import FormalQuery

_OFFERED, _TOLD = 3, 8
"""So many other questions are offered, and so many places told."""


def agreed(answer: Answer, facts: Facts) -> Answer:
    """Return the answer, a no where its sentence tells none of what was asked for.

    What was seen before and after a moment is what may be it then: `perhaps`. Raises StoreError.
    """
    query = answer.query
    if query is None or answer.status != "found":
        return answer
    if tells_nothing(answer):
        return _without_a_place(answer, query, facts)
    at = edge_of(query)
    if at is None or query.ask != "whether" or query.negated or was_so(answer, query, at):
        return answer
    around = [*likely_of(answer), *([answer.otherwise] if answer.otherwise else [])]
    ranked = tuple([replace(k, rank=rank) for rank, k in enumerate(around, 1)])
    return replace(
        answer, status="not_found", reason="not_then", keyframes=(), perhaps=ranked,
        otherwise=ranked[0], count=0, least=0, truncated=False,
    )  # fmt: skip


def _without_a_place(answer: Answer, query: FormalQuery, facts: Facts) -> Answer:
    """Return the no of a question of which only its place was asked, and that is unknown."""
    told, said, known = answer.answer, "", list[str]()
    if query.place is not None and f"in the {query.place}" in answer.unjudged:
        said, known = plain_place(query.place), [region.name for region in facts.regions()]
        told = f"{told} {_known_places(known)}".strip()
    elif query.relation is not None and len(query.objects) > 1:
        said, lexicon = query.objects[1].word, VocabularyLexicon()
        usual = facts.usual_grounds(query.relation.kind, lexicon)
        grounds = [c for c in facts.categories() if c in usual]
        known = list(dict.fromkeys([*lexicon.nearest(said, grounds), *grounds]))
        known = [lexicon.canonical(category) for category in known]
    word = re.compile(rf"\b{re.escape(said)}\b", re.IGNORECASE)
    names = [plain_place(name) for name in known[:_OFFERED]]
    swapped = [name.join(word.split(query.text)) for name in names]
    offered = tuple([text for text in swapped if text != query.text])
    return replace(
        answer, status="not_found", reason="not_recognisable", answer=told, keyframes=(),
        otherwise=None, count=0, least=0, value=None, truncated=False, suggestions=offered,
    )  # fmt: skip


def _known_places(names: Sequence[str]) -> str:
    """Return the places that there are, as a sentence; of a large house some; "" where none."""
    told = listed([the_place(name) for name in names[:_TOLD]])
    if len(names) > _TOLD:
        return f"Some of the places that I know are {told}."
    if len(names) == 1:
        return f"The one place that I know is {told}."
    return f"The places that I know are {told}." if names else ""
