"""Several things that were asked for at once: how many of them at each spot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from datetime import datetime

from assistant.conditions import gathered_words
from assistant.english import is_many, number_word, sentence_case
from assistant.phrases import likely_of, seen_when, term_of, where_words
from assistant.said import said_many
from d3a.answer import Answer, RankedKeyframe
from grammar.forms import FormalQuery

_SPOTS = 3
"""So many places are told, and one more; of further ones the rest stand in the table."""


def asks_for_each(answer: Answer, query: FormalQuery) -> bool:
    """Whether several things were asked for by one noun, and several there are: "the chairs".

    What has no singular, as scissors, is one thing; two cups that were together are at one place.
    """
    term = term_of(query)
    number = max(answer.least, min(answer.count, term.quantity or 0))
    many = said_many(query, term) and not is_many(term.word) and number > 1
    return many and not gathered_words(answer, query)


def each_words(
    answer: Answer, likely: Sequence[RankedKeyframe], query: FormalQuery, thing: str
) -> tuple[str, str]:
    """Return "two of the chairs in the kitchen; one elsewhere", and how many there are for certain.

    likely: a keyframe of each. The second is a sentence, "" where they are so many.
    """
    spots = Counter(spot_words(keyframe, query) for keyframe in likely).most_common()
    shown = len(spots) if len(spots) <= _SPOTS + 1 else _SPOTS
    counts = [(number_word(number), spot) for spot, number in spots[:shown]]
    rest = sum(number for _, number in spots[shown:])
    counts += [(number_word(rest), "elsewhere")] * bool(rest)
    (first, spot), *others = counts
    told = "; ".join([f"{first} of {thing} {spot}", *(" ".join(other) for other in others)])
    if answer.least >= len(likely):
        return told, ""
    if answer.least < 2:  # a moved one may have got a new id
        return told, " They may be the same one."
    return told, f" At least {number_word(answer.least)} of them are different things."


def where_each_is(answer: Answer, query: FormalQuery, thing: str, now: datetime) -> str:
    """Return where each of several things was last seen, and how many were gone since."""
    newest: dict[str, RankedKeyframe] = {}
    for keyframe in sorted(likely_of(answer), key=lambda k: (k.last, -k.rank), reverse=True):
        newest.setdefault(keyframe.object_id, keyframe)
    told, certain = each_words(answer, [*newest.values()], query, thing)
    last = seen_when(max(newest.values(), key=lambda k: k.last), now)
    number = sum(k.last_absent is not None for k in newest.values())
    verb = "was" if number == 1 else "were"
    lost = f" {sentence_case(number_word(number))} of them {verb} gone when I looked there again."
    return f"I last saw {told}, the newest {last}.{lost if number else ''}{certain}"


def spot_words(keyframe: RankedKeyframe, query: FormalQuery) -> str:
    """Return where a keyframe's object was, also where that has no name."""
    return where_words(keyframe, query) or "at a place that has no name"
