"""What is asked beside a question, so that its no speaks of the thing asked for: where that is."""

from __future__ import annotations

from dataclasses import replace

from assistant.said import is_one
from d3a.answer import Answer
from grammar.forms import FormalQuery


def where_it_is(answer: Answer, query: FormalQuery) -> FormalQuery | None:
    """Return the question where the one thing is that did not move and is not missing; else None.

    That nothing moved would be told as if it were of everything.
    """
    plain = query.relation is None and query.place is None and len(query.objects) == 1
    if query.ask not in ("moved", "missing") or not plain or not is_one(query):
        return None
    can_tell = answer.looked_then is not False and answer.reason != "empty" and not answer.apart
    if answer.status != "not_found" or answer.otherwise is not None or not can_tell:
        return None  # or where it was is known already
    return replace(query, form="Q3", ask="where", select="last", time=None)
