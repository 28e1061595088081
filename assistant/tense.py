"""Whether a question asks for the present: the formal query holds no tense, its text does."""

from __future__ import annotations

from dataclasses import replace

from grammar.forms import FormalQuery

_IS = frozenset({"is", "are", "isn't", "aren't", "whats", "theres"})
_ASKING = frozenset({"what", "that", "there", "which"})
_WAS = frozenset(
    {"was", "were", "wasn't", "weren't", "did", "didn't", "had", "has", "have", "hasn't", "haven't"}
    | {"been", "saw", "seen", "left", "put", "ever"}
)


def as_of_now(query: FormalQuery) -> FormalQuery:
    """Return the query with `select` "last" where it asks what is somewhere now.

    "What is on the table?" is about the present and "What was on the table?" about all times;
    their formal queries are the same. Only what may be somewhere is asked so: a relation or a
    place, and no time.
    """
    somewhere = query.relation is not None or query.place is not None
    asked = query.ask in ("what", "whether", "count") and query.select == "all"
    if not (somewhere and asked and query.time is None and _is_present(query.text)):
        return query
    return replace(query, select="last")


def _is_present(text: str) -> bool:
    """Whether a verb of being stands in the present, and no other in the past."""
    words = text.lower().replace("\u2019", "'").replace("?", " ").replace(",", " ").split()
    now = any(w in _IS or (w.endswith("'s") and w[:-2] in _ASKING) for w in words)
    return now and not any(w in _WAS for w in words)
