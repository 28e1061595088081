"""The sentence of what changed: what was seen at another place, and what was not seen again."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

from assistant.conditions import condition_words
from assistant.english import article, counted, is_many, sentence_case, when
from assistant.phrases import (
    definite,
    described,
    heads_of,
    is_room,
    kind_of,
    likely_of,
    newest_of,
    numbered,
    seen_when,
    term_of,
    the_place,
    there_words,
    where_words,
)
from assistant.said import said_many
from assistant.telling_apart import colour_of
from assistant.wording import FAIRLY_SURE
from d3a.answer import Answer, RankedKeyframe
from grammar.forms import ANYTHING, FormalQuery

_LISTED = 3
"""So many things of a longer list are told one by one; the rest stand in the table."""


def moved_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return what was at another place when it was seen again; when it moved, nobody saw."""
    once, anywhere = _each_once(answer), replace(query, place=None, outside=False, or_places=())
    sure = [k for k in once if k.score >= FAIRLY_SURE]
    if len(once) == 1 and term_of(query).category != ANYTHING:
        return _one_moved(answer, newest_of(answer), anywhere, now)
    told = []
    for keyframe in (sure or once)[:_LISTED]:
        where = where_words(keyframe, anywhere) or "at a place that has no name"
        said = " ".join([*colour_of(answer, keyframe.object_id).split(), kind_of(keyframe)])
        told.append(f"the {said}, {where}, {when(keyframe.first, now)}")
    number = min(len(sure), max(answer.least, 1)) or answer.count
    things, condition = sentence_case(counted(number, "thing")), condition_words(answer, query)
    if query.relation is not None and condition:  # the row may be where it went
        condition = f" to or from a spot{condition}"
    elif query.place is not None and is_room(query.place) and condition:
        condition = f" into, within or out of {the_place(query.place)}"
    said = f"{things} may have moved{condition}"
    if sure:
        seen = "it" if number == 1 else "them"
        said = f"At least {counted(number, 'thing')} had moved{condition}"
        said += f" when I saw {seen} again"
    among = ", among them" if len(told) < number else ""
    rest = answer.count - number
    more = f" {sentence_case(counted(rest, 'other thing'))} may have moved." if rest else ""
    return f"{said}{among}: {'; '.join(told)}.{more}"


def _one_moved(answer: Answer, keyframe: RankedKeyframe, query: FormalQuery, now: datetime) -> str:
    """Return that the one thing that was asked about was at another place when seen again."""
    term = term_of(query)
    many, several = said_many(query, term), not is_many(term.word)
    if many and several and term.owner is None:  # which cups moved: one did
        colour = colour_of(answer, keyframe.object_id).split()
        many, thing = False, article(" ".join([*colour, described(term)]))
    else:
        thing = definite(term, numbered(query, term))
    where = where_words(keyframe, query) or "at a place that has no name"
    seen = f"{where}, {when(keyframe.first, now)}"
    pronoun = "them" if many else "it"
    before = ""
    if (was := answer.otherwise) is not None:
        there = there_words(was, query)
        before = f" Before that I saw {pronoun} {when(was.end, now)}{there}."
    moves = len(likely_of(answer))
    if moves > 1:
        before += f" That is the last of {counted(moves, 'move')} that I know of."
    if keyframe.score < FAIRLY_SURE:
        return f"{sentence_case(thing)} may have moved: I saw {pronoun} {seen}.{before}"
    asked = query.text.casefold().split()[:1] not in (["when"], ["which"], ["what"], ["how"])
    yes = "Yes. " * asked
    return f"{yes}{sentence_case(thing)} had moved when I saw {pronoun} {seen}.{before}"


def missing_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return what is no longer where it was seen last."""
    told = []
    for keyframe in _each_once(answer)[:_LISTED]:
        where = where_words(keyframe, query)
        there = f" {where}," if where else ""
        told.append(f"the {kind_of(keyframe)}, last seen{there} {seen_when(keyframe, now)}")
    verb = "is" if answer.count == 1 else "are"
    number = sentence_case(counted(answer.count, "thing"))
    where = condition_words(answer, query)
    return f"{number} {verb} no longer{where or ' in place'}{_among(told, answer)}."


def _each_once(answer: Answer) -> list[RankedKeyframe]:
    """Return the best ranked keyframe of each object: a thing may have moved twice."""
    once: dict[str, RankedKeyframe] = {}
    for keyframe in heads_of(answer):
        once.setdefault(keyframe.object_id, keyframe)
    return list(once.values())


def _among(told: list[str], answer: Answer) -> str:
    """Return a list of things, and that it is not all of them where it is not.

    Each has commas of its own, so that they are parted by semicolons.
    """
    return f"{', among them' if len(told) < answer.count else ''}: {'; '.join(told)}"
