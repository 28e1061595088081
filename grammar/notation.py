"""The formal notation as text: the paper's, made lossless.

`write` prints every FormalQuery, `read` takes it back unchanged. A line has three parts:

    pink(x), cup(x), said(x, "mug") | STc.find(OIc.find(x), in kitchen, 2020-01-01T13:00:00-05:00
    <= t < 2020-01-01T16:00:00-05:00) | ask where, select last, said "where was my mug"

The first two are the paper's (Table 1), with whole times for its clock times and each attribute
bound to its object by a shared variable. Without the third part, and with the paper's own `pink(x),
cup(y)`, a line is read as the paper means it: OIc.find asks whether, STc.find with objects together
asks when, with a time where; a clock time is the last one gone by.
"""

from __future__ import annotations

import json
import re
from datetime import datetime

from grammar.forms import FormalQuery, ObjectTerm, TimeSlice

_BARE = re.compile(r"[a-z]+(?: [a-z]+)*\Z")
_FORMAL = re.compile(r"\|[^|]*\b(?:OIc|STc)\s*\.\s*find\s*\(", re.IGNORECASE)
_RESERVED = frozenset(("not", "in", "t"))
TIME = "t"
"""The variable of a time."""


def looks_formal(text: str) -> bool:
    """Whether a text is meant as notation: a bar, and a call of one of the two stores after it."""
    return _FORMAL.search(text) is not None


def read(text: str, *, now: datetime) -> FormalQuery:
    """Return the query of a line of notation, the paper's own strings included.

    now: aware; a bare clock time (1300) is the last one gone by before it.
    Raises NotUnderstood with the position of what could not be read.
    """
    from grammar import notationreader  # Lark comes with it; words in English do without

    return notationreader.read(text, now)


def write(query: FormalQuery) -> str:
    """Return the notation of a query; `read` gives the equal query back."""
    named = [(term, f"{TIME}0" if term.var == TIME else term.var) for term in query.objects]
    predicates = [p for term, var in named for p in _predicates(term, var)]
    arguments = [f"OIc.find({', '.join(var for _, var in named)})"]
    if query.relation is not None:
        arguments.append(("not " if query.relation.negated else "") + query.relation.kind)
    if query.place is not None:
        arguments.append(f"in {_word(query.place)}")
    if query.time is not None:
        predicates.append(f"time({TIME})")
        arguments.append(_slice(query.time))
    stored = query.form != "Q1" or len(arguments) > 1
    call = f"STc.find({', '.join(arguments)})" if stored else arguments[0]
    clauses = [f"form {query.form}", f"ask {query.ask}", f"select {query.select}"]
    if query.negated:
        clauses.append("negated")
    clauses.append(f"said {json.dumps(query.text)}")
    return f"{', '.join(predicates)} | {call} | {', '.join(clauses)}"


def _word(text: str) -> str:
    """Write a word bare, spaces as underscores, or quoted where that would lose something."""
    bare = _BARE.match(text) is not None and text not in _RESERVED
    return text.replace(" ", "_") if bare else json.dumps(text)


def _predicates(term: ObjectTerm, var: str) -> list[str]:
    """Write an object: what must hold, the category last, then what else is said of it."""
    found = [f"{_word(w)}({var})" for w in (*term.attributes, term.category)]
    found += [f"not {_word(w)}({var})" for w in term.without]
    if term.word != term.category:
        found.append(f"said({var}, {json.dumps(term.word)})")
    if term.owner is not None:
        found.append(f"of({var}, {json.dumps(term.owner)})")
    if term.quantity is not None:
        found.append(f"count({var}, {term.quantity})")
    if term.where is not None:
        inner = f"{var}1"
        found += _predicates(term.where.object, inner)
        found.append(f"{'not ' if term.where.negated else ''}{term.where.kind}({var}, {inner})")
    return found


def _slice(time: TimeSlice) -> str:
    if time.is_point and time.start is not None:
        return f"{TIME} = {time.start.isoformat()}"
    start = f"{time.start.isoformat()} <= " if time.start else ""
    end = f" < {time.end.isoformat()}" if time.end else ""
    return f"{start}{TIME}{end}"
