"""The kinds of things that a list tells: how many of each, and which where that can be told."""

from __future__ import annotations

from dataclasses import replace

from assistant.english import counted_range
from assistant.phrases import described, kind_of, kinds_of_broad, term_of
from assistant.telling_apart import colour_of
from d3a.answer import Answer, RankedKeyframe
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery


def sort_of(answer: Answer, keyframe: RankedKeyframe) -> tuple[str, str]:
    """Return the colour by which a thing is told from others of its kind, or "", and its kind."""
    return colour_of(answer, keyframe.object_id), kind_of(keyframe)


def of_kind(answer: Answer, query: FormalQuery, sort: tuple[str, str], number: int) -> str:
    """Return so many things of a kind at most, and at least what must be different ones."""
    colour, kind = sort
    least = sum(n for category, n in answer.kinds if vocabulary.canonical(category) == kind)
    least = 1 if colour else least  # two that look the same may be one
    words = kind
    term = term_of(query)
    if term.category == ANYTHING:  # what it is not goes without saying
        term = replace(term, without=(), other_than=(), not_owner=None)
    if kinds_of_broad(answer, query) or term.attributes or term.without or term.other_than:
        words = described(term, answer.unjudged, noun=kind)  # each is as it was asked for
    return counted_range(least or number, number, " ".join([*colour.split(), words]))
