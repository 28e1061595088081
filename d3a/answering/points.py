"""What a query asks of time: a point, as people mean it, or where everything is now.

Formal queries hold a point as start == end; a clock is told to the minute.
"""

from __future__ import annotations

from datetime import datetime, timedelta

from grammar.forms import ANYTHING, FormalQuery, TimeSlice

MINUTE = timedelta(minutes=1)


def looked_at(time: TimeSlice | None) -> TimeSlice:
    """Return the slice in which a look is one at that time: of a point, the minute it begins."""
    if time is None or time.start is None or not time.is_point:
        return time or TimeSlice()
    return TimeSlice(time.start, time.start + MINUTE)


def edge_of(query: FormalQuery) -> datetime | None:
    """Return the point that the sightings before and after it answer; None where none do.

    Where a thing was, and whether it was there, they tell. A list, a number or a change is of
    what was seen then: what was seen at other times would be told as if it were of that one.
    """
    if query.time is None or not query.time.is_point or query.select == "usual":
        return None
    several = query.relation is None and len(query.objects) > 1
    anything = not query.objects or query.objects[0].category == ANYTHING
    counted = any(term.quantity is not None for term in query.objects)
    one = query.ask == "whether" and not (several or anything or counted)
    return query.time.start if one or query.ask == "where" else None


def whether_at(query: FormalQuery) -> datetime | None:
    """Return the point at which a thing is asked to have been somewhere, or stood so; else None."""
    somewhere = query.relation is not None or query.place is not None
    return edge_of(query) if query.ask == "whether" and somewhere else None


def asks_where_all_is(query: FormalQuery) -> bool:
    """Whether it is asked where everything is now, in a place or anywhere."""
    category = query.objects[0].category if query.objects else ANYTHING
    plain = query.relation is None and query.time is None and not query.negated
    return plain and query.ask == "where" and query.select == "last" and category == ANYTHING
