"""What may be the thing that people named, seen since or at the asked place under another id.

A name is of one id. Where the thing was carried and came back as another, an answer of that id
alone would be a firm one that is out of date: what was seen of the other is told beside it.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

from assistant.conditions import condition_words
from assistant.english import article, when
from assistant.phrases import kind_of, newest_of, numbered, term_of, theirs, there_words
from assistant.said import said_many
from d3a.answer import Answer, RankedKeyframe
from d3a.answering.facts import Facts
from d3a.plan import FindObjects, Plan
from grammar.forms import VARIABLES, FormalQuery


def plan_of_the_unnamed(answer: Answer, made: Plan, facts: Facts) -> Plan | None:
    """Return the plan of the same question about what may be the named thing; None for nothing.

    Of what is denied, of numbers, of a moment and of what was first no look-alike is told. Raises
    StoreError.
    """
    query, time = made.query, made.query.time
    relation, term = query.relation, term_of(query)
    denied = query.negated or query.outside or (relation is not None and relation.negated)
    if not answer.named_alone or denied or (time is not None and time.is_point):
        return None
    if query.ask not in ("whether", "where", "when", "how_often") or term.quantity is not None:
        return None
    if query.select not in ("all", "last") or len(query.objects) > 1 + (relation is not None):
        return None
    from d3a.answering.untaught import may_be_named  # most questions name nothing

    others = may_be_named(facts, answer.named_alone, term.owner)
    if not others:
        return None
    first = VARIABLES[0]
    steps = tuple(
        replace(step, owner=None, among=others)
        if isinstance(step, FindObjects) and step.var == first
        else step
        for step in made.steps
    )
    return replace(made, steps=steps)


def doubted(answer: Answer, other: Answer) -> Answer:
    """Return the answer of a named thing with the newest of what may be it; a no is no sure one."""
    if answer.status == "found":
        newer = _newer(answer, other)
        return replace(answer, otherwise=newer) if _asks_for_the_last(answer) else answer
    if answer.status == "not_found" and other.status == "found":
        return replace(answer, perhaps=other.keyframes, otherwise=newest_of(other))
    return answer


def doubt_words(answer: Answer, other: Answer, said: str, now: datetime) -> str:
    """Return the sentence of a named thing with what was seen that may be it.

    answer: as it was before `doubted`; said: its sentence, of what it became.
    """
    query, newer = answer.query, _newer(answer, other)
    assert query is not None
    if answer.status == "found":
        is_told = query.ask == "whether" and query.select == "last"  # it cannot be sure then
        return said if newer is None or is_told else f"{said} {_seen(newer, query, now)}"
    if answer.status != "not_found" or newer is None:
        return said
    if other.status != "found":
        return f"{said} {_seen(newer, query, now)}"
    told = f"I cannot be sure. {_seen(newer, query, now, condition_words(other, query))}"
    certain = answer.otherwise
    if certain is None:
        return told
    pronoun = "them" if said_many(query, term_of(query)) else "it"
    last = "last " * (query.time is None)
    there = there_words(certain, query)
    return f"{told} For certain I {last}saw {pronoun} {when(certain.end, now)}{there}."


def _asks_for_the_last(answer: Answer) -> bool:
    return answer.query is not None and answer.query.select == "last"


def _newer(answer: Answer, other: Answer) -> RankedKeyframe | None:
    """Return what may be the named thing, where it is news: seen later, or where that was not."""
    query = answer.query
    assert query is not None
    if answer.status == "found":
        is_now = query.ask == "whether" and query.select == "last"
        if is_now:  # at the same place it says as much
            best = other.otherwise if other.status != "found" else None
        else:
            best = newest_of(other) if other.status == "found" else None
        mine = newest_of(answer).last
        return best if best is not None and best.last > mine else None
    if other.status == "found":
        return newest_of(other)
    best, certain = other.otherwise, answer.otherwise
    if best is None or query.time is not None or (certain and certain.last >= best.last):
        return None
    return best


def _seen(seen: RankedKeyframe, query: FormalQuery, now: datetime, condition: str = "") -> str:
    term = term_of(query)
    many = said_many(query, term)
    kind = numbered(query, replace(term, attributes=(), owner=None), noun=kind_of(seen))
    thing = kind if many else article(kind)
    whose = theirs(term.owner) if term.owner else "the same"
    there = there_words(seen, query)
    return f"I saw {thing} that may be {whose}{condition} {when(seen.end, now)}{there}."
