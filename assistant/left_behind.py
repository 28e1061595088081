"""What a person left somewhere: nothing that stays there whoever comes and goes."""

from __future__ import annotations

from assistant.phrases import heads_of, left_with, term_of
from d3a.answer import Answer
from d3a.answering.facts import Facts
from d3a.answering.match import Lexicon
from grammar.forms import ANYTHING, FormalQuery
from grammar.tense import asks_what_is_left


def as_left_behind(answer: Answer, query: FormalQuery, facts: Facts, lexicon: Lexicon) -> Answer:
    """Return the answer without furniture, where it is asked what was left: no couch was.

    All of it is told where there is nothing else. Raises StoreError.
    """
    plain = answer.status == "found" and term_of(query).category == ANYTHING
    if not plain or not asks_what_is_left(query):
        return answer
    stay = {name for name, _ in facts.landmarks(lexicon).stays}
    loose = [head for head in heads_of(answer) if head.object_id not in stay]
    groups = {head.group for head in loose if head.group is not None}
    kept = [k for k in answer.keyframes if k in loose or k.group in groups]
    return left_with(answer, kept) if kept else answer
