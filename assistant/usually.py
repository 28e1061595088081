"""The sentence of where things usually are: the places of one, or the spot of each of several."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from assistant.caveats import others_words
from assistant.conditions import condition_words
from assistant.counting import amount_of
from assistant.each import asks_for_each, each_words, spot_words
from assistant.english import article, counted, is_many, listed, plural, sentence_case
from assistant.phrases import (
    definite,
    described,
    found_words,
    heads_of,
    indefinite,
    kind_of,
    left_with,
    term_of,
)
from assistant.said import said_many
from assistant.wording import NOT_SURE
from d3a.answer import Answer, RankedKeyframe
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

_LEAST_WHOLE = 0.99
"""Shares of a thing's places that add up to less leave time for what may be the same thing."""
_MOSTLY = 0.5
"""What was so at least half of the time is usual."""
_SPOTS = 3
"""So many places are told; the rest stand in the table."""


def usual_words(answer: Answer, query: FormalQuery) -> str:
    """Return where a thing is most of the time; of several that were asked for, where each is.

    What has no singular, as keys, is one thing. Where one is asked for and there are several, they
    are told by their number and each by its spot.
    """
    if query.relation is None and len(query.objects) > 1:
        parts = [(_of_term(answer, term), _alone(query, term)) for term in query.objects]
        return " ".join(usual_words(part, each) for part, each in parts if part.keyframes)
    term = term_of(query)
    thing = definite(term, found_words(answer, query))
    if asks_for_each(answer, query):
        told, certain = _each(answer, query, thing)
        return f"{told}{certain}"
    if answer.least > 1 and term.owner is None and not is_many(term.word):
        words = described(term, answer.unjudged)
        told, _ = _each(answer, query, f"the {plural(words)}")
        return f"I know {amount_of(answer.least, answer.count, words)}. {told}"
    best = answer.keyframes[0].object_id
    own = [k for k in heads_of(answer) if k.object_id == best]
    is_whole = sum(_share(k) for k in own) >= _LEAST_WHOLE
    if not is_whole and answer.least <= 1:  # all of it may be one, and its shares add up
        own = sorted(heads_of(answer), key=_share, reverse=True)
    spots = [f"{spot_words(k, query)} ({round(100 * _share(k))} %)" for k in own[:_SPOTS]]
    many = said_many(query, term)
    was = f"{thing} {'were' if many else 'was'}"
    if not is_whole:
        others = "Of the rest I cannot be sure: what I saw elsewhere may be the same."
        if len({k.object_id for k in own[:_SPOTS]}) > 1:
            others = "They may not have been the same ones each time."
            others = others if many else "It may not have been the same one each time."
        return f"{sentence_case(was)} {listed(spots)}, as far as I saw. {others}"
    told = f"Most of the time {was} {listed(spots)}, as far as I saw."
    more = max(answer.least, 1) - 1
    return f"{told} {others_words(more, many=False)}" if more else told


def often_words(answer: Answer, query: FormalQuery) -> str:
    """Return what is somewhere each time that the robot looks, most times, and now and then."""
    shares = sorted(((round(100 * _share(k)), kind_of(k)) for k in heads_of(answer)), reverse=True)
    always = Counter(kind for share, kind in shares if share == 100)
    mostly = Counter((kind, share) for share, kind in shares if 100 * _MOSTLY <= share < 100)
    seldom = Counter(kind for share, kind in shares if share < 100 * _MOSTLY)
    condition = condition_words(answer, query)
    told = []
    if always:
        told.append(f"Each time that I looked I saw {_counts(always)}{condition}.")
    if mostly:
        each = listed([f"{_some(kind, n)} ({share} %)" for (kind, share), n in mostly.items()])
        told.append(f"Most times I {'also ' * bool(told)}saw {each}{'' if told else condition}.")
    if not told:
        told.append(f"I saw nothing{condition} most of the times that I looked.")
    if seldom:
        told.append(f"Now and then I saw {_counts(seldom)} there.")
    return " ".join(told)


def _counts(kinds: Counter[str]) -> str:
    return listed([_some(kind, number) for kind, number in kinds.items()])


def usual_verdict(answer: Answer, query: FormalQuery) -> str:
    """Return whether a thing is somewhere most of the time, and which share of it."""
    shares: dict[str, float] = {}
    for keyframe in heads_of(answer):
        shares[keyframe.object_id] = shares.get(keyframe.object_id, 0.0) + _share(keyframe)
    share = max(shares.values())
    term, words = term_of(query), found_words(answer, query)
    many = said_many(query, term)
    thing = indefinite(term, words, many=many) if len(shares) > 1 else definite(term, words)
    was = f"{sentence_case(thing)} {'were' if many else 'was'}{condition_words(answer, query)}"
    verdict = "Yes" if share >= _MOSTLY else "No"
    return f"{verdict}. {was} {round(100 * share)} % of the time, as far as I saw."


def _some(kind: str, number: int) -> str:
    return article(kind) if number == 1 else counted(number, kind)


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


def _each(answer: Answer, query: FormalQuery, thing: str) -> tuple[str, str]:
    """Return how many of several things were most of the time at each spot, and how many they are.

    What is hardly one of them at all is left to the table.
    """
    best: dict[str, RankedKeyframe] = {}
    for keyframe in heads_of(answer):
        kept = best.setdefault(keyframe.object_id, keyframe)
        if _share(keyframe) > _share(kept):
            best[keyframe.object_id] = keyframe
    likely = [k for k in best.values() if k.score >= NOT_SURE * _share(k)] or [*best.values()]
    told, certain = each_words(answer, likely, query, thing)
    return f"Most of the time I saw {told}.", certain


def _share(keyframe: RankedKeyframe) -> float:
    return float(keyframe.why.get("share", 1.0))
