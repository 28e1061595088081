"""Whether the things of a noun in the plural are somewhere: all of them, or some.

"Are the books on the table?" is no yes where two of three are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from assistant.conditions import condition_words
from assistant.each import spot_words
from assistant.english import counted, is_many, number_word, range_of
from assistant.phrases import described, heads_of, last_words, likely_of, seen_when, term_of
from assistant.said import is_one, said_many
from d3a.answer import Answer, RankedKeyframe
from grammar.forms import ANYTHING, FormalQuery, Select

_TOLD = 3
"""Of so many that are elsewhere it is told where each is."""


def wherever_they_are(query: FormalQuery) -> FormalQuery | None:
    """Return the question where all things of the noun are, where all were meant; else None."""
    term = term_of(query)
    somewhere = query.relation is not None or query.place is not None
    point = query.time is not None and query.time.is_point
    if query.ask != "whether" or not somewhere or point or query.select == "usual":
        return None
    if query.seeks_absence or (query.relation is not None and query.relation.negated):
        return None
    if query.relation is not None and len(query.objects) < 2:
        return None  # together with each other
    whole = term.quantity is None and term.category != ANYTHING and not term.or_else
    if not whole or not is_one(query) or not said_many(query, term) or is_many(term.word):
        return None
    select: Select = "last" if query.time is None else "all"
    anywhere = replace(query, relation=None, place=None, or_places=(), outside=False)
    positive = replace(anywhere, negated=False, contrary=False)
    return replace(positive, form="Q3", ask="where", objects=(term,), select=select)


def some_of_them_words(there: Answer, whole: Answer, query: FormalQuery, now: datetime) -> str:
    """Return how many of all are there, and where others are; "" where all may be there.

    there: what was found so. whole: all things of the noun. There are others where more must be
    different things than were found there.
    """
    if there.status != "found" or there.unjudged or there.otherwise is not None:
        return ""
    if there.count >= whole.least or whole.query is None:
        return ""
    term, names = term_of(query), {k.object_id for k in heads_of(there)}
    newest: dict[str, RankedKeyframe] = {}
    for keyframe in likely_of(whole):
        known = newest.get(keyframe.object_id)
        if keyframe.object_id not in names and (known is None or keyframe.last > known.last):
            newest[keyframe.object_id] = keyframe
    number = range_of(there.least, there.count)
    all_of = f"the {counted(whole.count, described(term))}"
    if whole.least < whole.count:
        all_of = f"at least {counted(whole.least, described(term))}"
    verb = "last saw" if query.time is None else "saw"
    told = f"I {verb} {number} of {all_of}{condition_words(there, query)}, "
    told += f"{last_words(there, query, now).removeprefix('last ')}."
    verdict = "Some of them were, as far as I saw: " if query.negated else "Not all of them. "
    others = sorted(newest.values(), key=lambda k: (k.last, -k.rank), reverse=True)
    certain = others[: whole.least - there.least]  # the rest may be one of those told
    return f"{verdict}{told}{_others(whole, certain, now)}"


def _others(whole: Answer, elsewhere: Sequence[RankedKeyframe], now: datetime) -> str:
    if not elsewhere or whole.query is None:
        return ""
    query = whole.query
    if len(elsewhere) == 1:
        (only,) = elsewhere
        return f" One I saw {spot_words(only, query)}, {seen_when(only, now)}."
    spots = list(dict.fromkeys(spot_words(keyframe, query) for keyframe in elsewhere))
    rest = len(spots) - _TOLD
    told = spots[:_TOLD] if rest > 1 else spots
    more = [f"at {number_word(rest)} other places"] if rest > 1 else []
    return f" Others I saw {'; '.join([*told, *more])}."
