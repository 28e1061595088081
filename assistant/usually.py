"""The sentence of where things usually are: the places of one, or the spot of each of several."""

from __future__ import annotations

from dataclasses import replace

from assistant.caveats import others_words
from assistant.each import asks_for_each, each_words, spot_words
from assistant.english import listed
from assistant.phrases import (
    definite,
    found_words,
    heads_of,
    kind_of,
    left_with,
    term_of,
)
from assistant.wording import NOT_SURE
from d3a.answer import Answer, RankedKeyframe
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

_LEAST_WHOLE = 0.99
"""Shares of a thing's places that add up to less leave time for what may be the same thing."""
_SPOTS = 3
"""So many places are told; the rest stand in the table."""


def usual_words(answer: Answer, query: FormalQuery) -> str:
    """Return where a thing is most of the time; of several that were asked for, where each is.

    What has no singular, as keys, is one thing. Where one is asked for and there are several it is
    the likeliest, and the others are told by their number.
    """
    if query.relation is None and len(query.objects) > 1:
        parts = [(_of_term(answer, term), _alone(query, term)) for term in query.objects]
        return " ".join(usual_words(part, each) for part, each in parts if part.keyframes)
    term = term_of(query)
    thing = definite(term, found_words(answer, query))
    if asks_for_each(answer, query):
        return _of_each(answer, query, thing)
    best = answer.keyframes[0].object_id
    own = [k for k in heads_of(answer) if k.object_id == best]
    spots = [f"{spot_words(k, query)} ({round(100 * _share(k))} %)" for k in own[:_SPOTS]]
    if sum(_share(k) for k in own) < _LEAST_WHOLE:
        others = "Of the rest I cannot be sure: what I saw elsewhere may be the same."
        return f"I saw {thing} {listed(spots)}. {others}"
    told = f"Most of the time I saw {thing} {listed(spots)}."
    more = max(answer.least, 1) - 1
    return f"{told} {others_words(more, many=False)}" if more else told


def _of_term(answer: Answer, term: ObjectTerm) -> Answer:
    """Return the answer of what was found of one of several objects.

    Two ids may be one thing where the shares of either leave time for the other.
    """
    kept = [k for k in answer.keyframes if term.category in (kind_of(k), ANYTHING)]
    shares: dict[str, float] = {}
    for keyframe in kept:
        shares[keyframe.object_id] = shares.get(keyframe.object_id, 0.0) + _share(keyframe)
    whole = sum(share >= _LEAST_WHOLE for share in shares.values())
    return replace(left_with(answer, kept), least=whole + (whole < len(shares)))


def _alone(query: FormalQuery, term: ObjectTerm) -> FormalQuery:
    return replace(query, objects=(term,))


def _of_each(answer: Answer, query: FormalQuery, thing: str) -> str:
    """Return how many of several things were most of the time at each spot.

    What is hardly one of them at all is left to the table.
    """
    best: dict[str, RankedKeyframe] = {}
    for keyframe in heads_of(answer):
        kept = best.setdefault(keyframe.object_id, keyframe)
        if _share(keyframe) > _share(kept):
            best[keyframe.object_id] = keyframe
    likely = [k for k in best.values() if k.score >= NOT_SURE * _share(k)] or [*best.values()]
    told, certain = each_words(answer, likely, query, thing)
    return f"Most of the time I saw {told}.{certain}"


def _share(keyframe: RankedKeyframe) -> float:
    return float(keyframe.why.get("share", 1.0))
