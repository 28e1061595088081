"""What was true at a moment: the sighting before it, and the one after it."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta

from assistant.conditions import condition_words
from assistant.english import sentence_case, slice_words, when
from assistant.phrases import (
    asked_place,
    definite,
    found_words,
    indefinite,
    likely_of,
    term_of,
    there_words,
    where_words,
)
from assistant.said import is_one, said_many
from d3a.answer import Answer, RankedKeyframe
from d3a.answering.points import MINUTE
from grammar.forms import FormalQuery, TimeSlice
from grammar.tense import asks_for_a_sighting

_LOOK_AROUND = timedelta(minutes=10)
"""Sightings so near to each other are of one look around the home, as an interval is closed by."""


def where_then(answer: Answer, query: FormalQuery, at: datetime, now: datetime) -> str:
    """Return where it was: where it was being seen, else seen last before and first after."""
    thing = definite(term_of(query), found_words(answer, query))
    heads = likely_of(answer)
    told = []
    during = next((k for k in heads if _is_during(k, at)), None)
    before, after = _around(heads, at)
    before = during or before
    if before is not None:
        where = sentence_case(where_words(before, query) or "At a place that has no name")
        if before is during:
            return f"{where}. I was seeing {thing} there {slice_words(TimeSlice(at, at), now)}."
        told.append(f"{where}. I had last seen {thing} there {when(before.end, now)}.")
    if after is not None:
        there = there_words(after, query)
        pronoun = "them" if said_many(query, term_of(query)) else "it"
        thing = pronoun if before is not None else thing
        told.append(f"I saw {thing} next {when(after.start, now)}{there}.")
    return " ".join(told)


def was_so(answer: Answer, query: FormalQuery, at: datetime) -> bool:
    """Whether what was seen before and after a moment tells that it was so then.

    So it was where it was being seen, and where the last look before the moment and the first
    after it found it so, or none came after and nobody found it gone. So it was, too,
    where it was seen so in the same look around, and nearer to the moment than elsewhere. Who asks
    whether it was seen then asks for no more than what was seen.
    """
    heads = likely_of(answer)
    if any(_is_during(keyframe, at) for keyframe in heads):
        return True
    before, after = _around(heads, at)
    if asks_for_a_sighting(query):
        return False
    near = min((_apart(k, at) for k in (before, after) if k is not None), default=_LOOK_AROUND)
    if near < _LOOK_AROUND and (answer.otherwise is None or near < _apart(answer.otherwise, at)):
        return True
    if before is None or answer.otherwise is not None:
        return False
    return after is not None or before.last_absent is None


def whether_then(
    answer: Answer, query: FormalQuery, at: datetime, now: datetime, opening: str
) -> str:
    """Return whether it was so at a moment; if it was not seen, what was before and after.

    Where it was elsewhere on one side of the moment, that is told of this side.
    """
    term, condition = term_of(query), condition_words(answer, query)
    many = said_many(query, term)
    thing = indefinite(term, found_words(answer, query), many=many)
    heads, moment = likely_of(answer), slice_words(TimeSlice(at, at), now)
    during = next((k for k in heads if _is_during(k, at)), None)
    if during is not None:
        there = there_words(during, query)
        return f"{opening}I was seeing {thing}{condition} {moment}{there}."
    told = [f"I did not see {thing}{condition} {moment}."]
    if answer.looked_then is False:
        told = [f"I was not looking{looking_into(answer, query)} {moment}."]
    if opening and not query.negated and was_so(answer, query, at):
        told.insert(0, "Probably.")
    some = "some" if many else "one"
    known = (thing if term.owner else "them" if many else "it") if is_one(query) else some
    other = answer.otherwise
    same = other is not None and other.object_id in {k.object_id for k in heads}
    instead = known if same else f"{some} that may be the same"
    before, after = _around(heads, at)
    if before is not None:
        told.append(around_words(before, f"{known}{condition}", query, at, now))
    if other is not None and before is None:
        told.append(around_words(other, instead, query, at, now))
    if after is not None:
        told.append(around_words(after, f"{known}{condition}", query, at, now))
    if other is not None and before is not None:
        told.append(around_words(other, instead, query, at, now))
    return " ".join(told)


def around_words(
    keyframe: RankedKeyframe, thing: str, query: FormalQuery, at: datetime, now: datetime
) -> str:
    """Return a sentence on when and where a thing was seen before, at or after a moment."""
    there = there_words(keyframe, query)
    if _is_during(keyframe, at):
        return f"I was seeing {thing} then{there}."
    if keyframe.end < at:
        return f"I had last seen {thing} {when(keyframe.end, now)}{there}."
    return f"I next saw {thing} {when(keyframe.start, now)}{there}."


def looking_into(answer: Answer, query: FormalQuery) -> str:
    """Return the room that was looked into: " in the kitchen"; "" where none was asked for."""
    told = query.place and not query.outside and not answer.unjudged
    return f" {asked_place(query, query.place)}" if query.place and told else ""


def _around(
    heads: Sequence[RankedKeyframe], at: datetime
) -> tuple[RankedKeyframe | None, RankedKeyframe | None]:
    """Return what was seen last before a moment, and first after it."""
    before = max((k for k in heads if k.end < at), key=lambda k: (k.end, -k.rank), default=None)
    after = min((k for k in heads if k.start > at), key=lambda k: (k.start, k.rank), default=None)
    return before, after


def _apart(keyframe: RankedKeyframe, at: datetime) -> timedelta:
    """Return how long before or after a moment a keyframe's interval ends or begins."""
    return max(at - keyframe.end, keyframe.start - at)


def _is_during(keyframe: RankedKeyframe, at: datetime) -> bool:
    """Whether a keyframe's interval meets the minute that begins at a moment."""
    return keyframe.start < at + MINUTE and keyframe.end >= at
