"""Whether a question asks for the present: the formal query holds no tense, its text does."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

from assistant.phrases import likely_of, newest_of
from assistant.said import is_one
from d3a.answer import Answer, RankedKeyframe
from d3a.parameters import Parameters
from d3a.plan import Lasting, Plan, Precision, plan
from grammar.forms import FormalQuery

_IS = frozenset({"is", "are", "isn't", "aren't", "whats", "theres"})
_ASKING = frozenset({"what", "that", "there", "which", "where"})
_WAS = frozenset(
    {"was", "were", "wasn't", "weren't", "did", "didn't", "had", "has", "have", "hasn't", "haven't"}
    | {"been", "saw", "seen", "left", "put", "ever"}
)


_WHICH_WAS = re.compile(r"\b(that|which) (was|were|lay|stood|had been|used to be)\b")
_SEEING = frozenset({"see", "saw", "seen", "view", "watch", "watched", "look", "looked"})
_HAS = frozenset({"has", "have", "hasn't", "haven't"})
_NOW = frozenset({"now", "currently", "presently"})


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
    )


def chooses_a_sighting(query: FormalQuery) -> bool:
    """Whether `last` tells which sighting: what did you last see here, not what is here now."""
    words = _words(query.text)
    past = _says_past(words) and not any(w in _NOW for w in words)
    return query.ask == "what" and query.select == "last" and past


def lasting(query: FormalQuery) -> Lasting | None:
    """Return how its time at a place is asked for: all of it, or since when; None where it is not.

    "How long was it on the table?" asks when it was put there and taken away, "How long did you
    see it there?" for the time in view. What has been there is there still.
    """
    somewhere = query.relation is not None or query.place is not None
    if not somewhere or query.negated or (query.relation is not None and query.relation.negated):
        return None
    words = _words(query.text)
    if query.ask == "when":
        since = ("since", "when") in pairwise(words)
        return "newest" if since and query.time is None else None
    if query.ask != "how_long" or any(word in _SEEING for word in words):
        return None
    still = "been" in words and any(word in _HAS for word in words)
    return "newest" if (still or _is_present(query.text)) and query.time is None else "all"


def asks_for_a_sighting(query: FormalQuery) -> bool:
    """Whether it is asked what was seen, and not what was so: did you see it, not was it there."""
    return any(word in _SEEING for word in _words(query.text))


def is_no_more(answer: Answer, query: FormalQuery) -> bool:
    """Whether it is asked if there is a thing still, and each that was seen was gone later.

    Only where nothing says where: a thing that left a place may be at another.
    """
    words = _words(query.text)
    has = query.place is not None or query.relation is not None or query.time is not None
    if query.ask != "whether" or has or query.negated or not {"there", "still"} & {*words}:
        return False
    past = [word for word in words if word not in _HAS]
    if _says_past(past) or not (_is_present(" ".join(past)) or "still" in words):
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
    if query.ask != "where" or not told or not _is_present(query.text.partition(" that ")[0]):
        return False
    return _WHICH_WAS.search(query.text.casefold()) is not None


def as_of_now(query: FormalQuery) -> FormalQuery:
    """Return the query with `select` "last" where it asks what is somewhere now.

    "What is on the table?" is about the present and "What was on the table?" about all times;
    their formal queries are the same. Only what may be somewhere is asked so: a relation or a
    place, and no time. Since when it has been so is asked of what is there still. Of one thing
    that is not there now no sighting tells that was elsewhere before: it asks whether it is there.
    """
    somewhere = query.relation is not None or query.place is not None
    asked = query.ask in ("what", "whether", "count") and query.select == "all"
    now = somewhere and asked and query.time is None and _is_present(query.text)
    if not now and lasting(query) != "newest":
        return query
    is_elsewhere = query.contrary and not (now and is_one(query))
    return replace(query, select="last", contrary=is_elsewhere)


def _is_present(text: str) -> bool:
    """Whether a verb of being stands in the present, and no other in the past."""
    words = _words(text)
    now = any(w in _IS or (w.endswith("'s") and w[:-2] in _ASKING) for w in words)
    return now and not _says_past(words)


def _says_past(words: list[str]) -> bool:
    """Whether any word is one of the past; left of a thing and to the left are sides."""
    sides = zip(["", *words], words, [*words[1:], ""], strict=False)
    return any(
        word in _WAS and not (word == "left" and (before == "the" or after == "of"))
        for before, word, after in sides
    )


def _words(text: str) -> list[str]:
    return text.lower().replace("\u2019", "'").replace("?", " ").replace(",", " ").split()
