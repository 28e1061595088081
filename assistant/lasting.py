"""The sentence of how long, and since when: the time at a place, and apart from it in view."""

from __future__ import annotations

from datetime import datetime, timedelta

from assistant.conditions import condition_words
from assistant.english import ago, clock, counted, day_of, duration, when
from assistant.phrases import definite, found_words, last_words, newest_of, term_of, there_words
from assistant.said import said_many
from d3a.answer import Answer
from d3a.answering.distinct import ROUND_GAP_MS
from grammar.forms import FormalQuery

_A_ROUND = timedelta(milliseconds=ROUND_GAP_MS)


def how_long_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return how long a thing was somewhere; where nothing more is known, how long it was in view.

    In between it may have been elsewhere and back: it was there whenever it was seen.
    """
    if query.select == "last" and answer.stayed:
        return since_words(answer, query, now)
    thing, last = _the_thing(answer, query), last_words(answer, query, now)
    seconds, in_view = answer.value or 0.0, answer.in_view
    if seconds < 1:
        return f"I saw {thing} only in passing, {last.removeprefix('last ')}."
    if not answer.stayed or seconds < 2 * in_view or seconds < in_view + 60:
        return f"About {duration(seconds)}: that is how long I saw {thing}, {last}."
    first, final = answer.stayed[0][0], answer.stayed[-1][1]
    spans = len(answer.stayed)
    apart = f" in {counted(spans, 'stretch')}" if spans > 1 else ""
    told = f"About {duration(seconds)}{apart}, from {_at(first, now)} to {_at(final, now)}"
    seen = f" I had {_pronoun(query)} in view for {duration(in_view)} of that."
    seen = seen if in_view >= 1 else ""
    return f"{told}: whenever I looked I saw {thing}.{seen}"


def since_words(answer: Answer, query: FormalQuery, now: datetime) -> str:
    """Return since when a thing has been where it is, and where it was seen before.

    When it was put there nobody saw: it was there at the latest when it was seen there.
    """
    thing, best = _the_thing(answer, query), newest_of(answer)
    start, end = answer.stayed[0]
    before = answer.otherwise
    since = f"{_at(start, now)}, {ago(start.astimezone(now.tzinfo), now)}"
    if before is None:
        told = f"Since {since}, or longer: that is when I first saw {thing}."
    elif before.start > best.last:  # it may have moved since, under another id
        there = there_words(before, query)
        told = f"I cannot be sure. I saw {thing} since {since}."
        return f"{told} I saw {_some(query)} that may be the same {when(before.end, now)}{there}."
    else:
        there = there_words(before, query)
        same = f"{_some(query)} that may be the same"
        same = _pronoun(query) if before.object_id == best.object_id else same
        told = f"Since {since}, at the latest: I saw {thing} then."
        told += f" Before that I saw {same} {when(before.end, now)}{there}."
    again = f" I last saw {_pronoun(query)} there {when(end, now)}."
    again = again if end - start > _A_ROUND else ""
    return f"{told}{again}"


def _pronoun(query: FormalQuery) -> str:
    return "them" if said_many(query, term_of(query)) else "it"


def _some(query: FormalQuery) -> str:
    return "some" if said_many(query, term_of(query)) else "one"


def _the_thing(answer: Answer, query: FormalQuery) -> str:
    words = definite(term_of(query), found_words(answer, query))
    return words + condition_words(answer, query)


def _at(moment: datetime, now: datetime) -> str:
    """Return a day and a clock time: "Tuesday at 8:32"."""
    local = moment.astimezone(now.tzinfo)
    return f"{day_of(local, now).removeprefix('on ')} at {clock(local)}"
