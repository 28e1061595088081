"""What the tense of a question changes in its plan and its answer; `grammar.tense` reads it."""

from __future__ import annotations

from dataclasses import replace

from assistant.phrases import likely_of, newest_of
from assistant.said import is_one, known_of
from d3a.answer import Answer, RankedKeyframe
from d3a.parameters import Parameters
from d3a.plan import Lasting, Plan, Precision, plan
from grammar.forms import FormalQuery
from grammar.tense import asks_for_a_sighting, chooses_a_sighting


def planned(query: FormalQuery, parameters: Parameters, precision: Precision | None = None) -> Plan:
    """Return the plan of a question, by the tense of its words.

    What is somewhere asks for what is there now, what was last seen there for a sighting.
    """
    return plan(
        as_of_now(query),
        parameters=parameters,
        precision=precision,
        sighting=chooses_a_sighting(query),
        lasting=lasting(query),
        since_then=stood_then(query),
        known=known_of(query),
    )


def lasting(query: FormalQuery) -> Lasting | None:
    """Return how its time at a place is asked for: all of it, or since when; None where it is not.

    "How long was it on the table?" asks when it was put there and taken away, "How long did you
    see it there?" for the time in view. What has been there is there still.
    """
    somewhere = query.relation is not None or query.place is not None
    if not somewhere or query.negated or (query.relation is not None and query.relation.negated):
        return None
    if query.now and query.time is None and query.ask in ("when", "how_long"):
        return "newest"
    return "all" if query.ask == "how_long" and not asks_for_a_sighting(query) else None


def is_no_more(answer: Answer, query: FormalQuery) -> bool:
    """Whether it is asked if there is a thing still, and each that was seen was gone later.

    Only where nothing says where: a thing that left a place may be at another.
    """
    has = query.place is not None or query.relation is not None or query.time is not None
    if query.ask != "whether" or has or query.negated or not query.now:
        return False
    newest: dict[str, RankedKeyframe] = {}
    for keyframe in sorted(likely_of(answer), key=lambda k: (k.last, -k.rank)):
        newest[keyframe.object_id] = keyframe
    return bool(newest) and all(k.last_absent is not None for k in newest.values())


def gone_by_now(answer: Answer) -> Answer:
    """Return the answer that what was seen is there no more, with what was seen of it last."""
    last = newest_of(answer)
    asked = None if answer.query is None else replace(answer.query, select="last")
    return replace(
        answer, status="not_found", reason="gone", query=asked, otherwise=last, keyframes=(),
        count=0, least=0, value=None, truncated=False,
    )  # fmt: skip


def stood_then(query: FormalQuery) -> bool:
    """Whether it is asked where that is now which was somewhere: the book that was on the bed."""
    told = query.relation is not None and not query.relation.negated and not query.negated
    return query.ask == "where" and query.now and told


def as_of_now(query: FormalQuery) -> FormalQuery:
    """Return the query with `select` "last" where it asks what is somewhere now.

    "What is on the table?" is about the present and "What was on the table?" about all times. Only
    what may be somewhere is asked so: a relation or a place, and no time. Since when it has been so
    is asked of what is there still. Of one thing that is not there now no sighting tells that was
    elsewhere before: it asks whether it is there.
    """
    somewhere = query.relation is not None or query.place is not None
    asked = query.ask in ("what", "whether", "count") and query.select == "all"
    now = somewhere and asked and query.time is None and query.now
    if not now and lasting(query) != "newest":
        return query
    is_elsewhere = query.contrary and not (now and is_one(query))
    return replace(query, select="last", contrary=is_elsewhere)
