"""The formal notation as text: the paper's, made lossless.

`write` prints every FormalQuery, `read` takes it back unchanged. A line has three parts:

    pink(x), cup(x), said(x, "mug") | STc.find(OIc.find(x), in kitchen, 2020-01-01T13:00:00-05:00
    <= t < 2020-01-01T16:00:00-05:00) | ask where, select last, said "where was my mug"

The first two are the paper's (Table 1), with whole times for its clock times and each attribute
bound to its object by a shared variable. Without the third part, and with the paper's own `pink(x),
cup(y)`, a line is read as the paper means it: OIc.find asks whether, STc.find with objects together
asks when, with a time where; a clock time is the last one gone by.

`formal` prints the same for people, as the paper does: a variable for each attribute, an OIc.find
for each object, and of the third part only what does not go without saying. What the paper has no
sign for is said in both by one rule each:

    cup(x)                  a category; an attribute is written alike and stands before it
    not red(x)              a word that must not hold
    said(x, "mug")          the noun, where it is another word than the category
    of(x, "anna")           the owner; `not of(x, "anna")`: whose it must not be
    count(x, 2)             at least two; `count(x, <= 2)`: at most; `count(x, = 2)`: exactly
    or(x, xo1)              what will do as well, of an object with predicates of its own
    other(x, xn1)           what it must not be, of such an object
    near(x, x1)             what describes it, of an object with predicates of its own; or `not`
    on, not on              the relation of the objects, in the call
    in hall, not in hall    the place where it must be, must not be; of several: any, none of them
    ask count               what is asked, where it is not the paper's whether, when or where
    select last             which of the sightings: last, first or usual
    negated                 the question as a whole is denied; `contrary`: it asks for the contrary
    now                     it is asked for what is so, not for what was ever seen
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime
from itertools import count

from grammar.forms import (
    VARIABLES,
    Ask,
    Bound,
    Form,
    FormalQuery,
    ObjectTerm,
    Relation,
    TimeSlice,
)

_BARE = re.compile(r"[a-z]+(?:[ -][a-z]+)*\Z")
_FORMAL = re.compile(r"\|[^|]*\b(?:OIc|STc)\s*\.\s*find\s*\(", re.IGNORECASE)
_RESERVED = frozenset(("not", "in", "t"))
TIME = "t"
"""The variable of a time."""
SIGNS: dict[Bound, str] = {"least": "", "most": "<= ", "exactly": "= "}
"""What stands before a number, by how it is meant."""


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
    found = [f"OIc.find({', '.join(var for _, var in named)})"]
    time = None if query.time is None else _slice(query.time)
    said = [f"form {query.form}", f"ask {query.ask}", f"select {query.select}"]
    said += _flags(query)
    return _line(query, predicates, found, time, [*said, f"said {json.dumps(query.text)}"])


def formal(query: FormalQuery) -> str:
    """Return the paper's notation of a query, for people to read.

    It says all but the question's own words, the zone of times, and of two clock times of one day
    which day that is. Two queries that differ in anything else have different notations.
    """
    names = _variables()
    predicates: list[str] = []
    found: list[str] = []
    for term in query.objects:
        looks = [next(names) for _ in term.attributes]
        noun = next(names)
        predicates += [f"{_word(w)}({var})" for w, var in zip(term.attributes, looks, strict=True)]
        predicates += _predicates(replace(term, attributes=()), noun)
        found.append(f"OIc.find({', '.join((*looks, noun))})")
    time = None if query.time is None else _bounds(query.time)
    stored, relation = _is_stored(query), query.relation
    # objects alone would be read as together
    apart = stored and relation is None and query.time is None and len(found) > 1
    said = []
    if query.form != form_unsaid(relation, stored=stored):
        said.append(f"form {query.form}")
    if apart or query.ask != ask_unsaid(relation, query.time, stored=stored):
        said.append(f"ask {query.ask}")
    said += [f"select {query.select}"] if query.select != "all" else []
    said += _flags(query)
    return _line(query, predicates, found or ["OIc.find()"], time, said)


def _flags(query: FormalQuery) -> list[str]:
    return ["negated"] * query.negated + ["contrary"] * query.contrary + ["now"] * query.now


def form_unsaid(relation: Relation | None, *, stored: bool) -> Form:
    """Return the form of a line that names none. stored: it has an STc.find."""
    if relation is not None:
        return "Q2"
    return "Q3" if stored else "Q1"


def ask_unsaid(relation: Relation | None, time: TimeSlice | None, *, stored: bool) -> Ask:
    """Return what a line asks that does not say it, as the paper has it."""
    if not stored:
        return "whether"
    return "when" if relation is not None and time is None else "where"


def _is_stored(query: FormalQuery) -> bool:
    narrowed = query.relation is not None or query.place is not None or query.time is not None
    return query.form != "Q1" or narrowed


def _line(
    query: FormalQuery, predicates: list[str], found: list[str], time: str | None, said: list[str]
) -> str:
    """Return the three parts of a line; the last one only where it says something."""
    calls = list(found)
    if query.relation is not None:
        calls.append(("not " if query.relation.negated else "") + query.relation.kind)
    places = () if query.place is None else (query.place, *query.or_places)
    calls += [f"{'not ' if query.outside else ''}in {_word(place)}" for place in places]
    if time is not None:
        predicates, calls = [*predicates, f"time({TIME})"], [*calls, time]
    call = ", ".join(calls)
    parts = [", ".join(predicates), f"STc.find({call})" if _is_stored(query) else call]
    return " | ".join([*parts, ", ".join(said)] if said else parts)


def _variables() -> Iterator[str]:
    """Yield x, y, z and so on, all but that of a time; then x2, which describes no x."""
    letters = [letter for letter in VARIABLES if letter != TIME]
    yield from letters
    yield from (f"{letter}{number}" for number in count(2) for letter in letters)


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
    if term.not_owner is not None:
        found.append(f"not of({var}, {json.dumps(term.not_owner)})")
    if term.quantity is not None:
        found.append(f"count({var}, {SIGNS[term.bound]}{term.quantity})")
    for link, others in (("or", term.or_else), ("other", term.other_than)):
        for number, other in enumerate(others, 1):
            inner = f"{var}{'o' if link == 'or' else 'n'}{number}"
            found += [*_predicates(other, inner), f"{link}({var}, {inner})"]
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


def _bounds(time: TimeSlice) -> str:
    """Write a slice as the paper does, `1600 >= t >= 1300`: clock times of one day.

    Other times have their date.
    """
    start, end = time.start, time.end
    ends = [moment for moment in (start, end) if moment is not None]
    one_day = len(ends) == 2 and ends[0].date() == ends[1].date()
    plain = one_day and not any(moment.second or moment.microsecond for moment in ends)
    said = [f"{m:%H%M}" if plain else _dated(m) for m in ends]
    if not ends:
        return TIME
    if time.is_point:
        return f"{TIME} = {said[0]}"
    if start is None:
        return f"{said[0]} >= {TIME}"
    return f"{TIME} >= {said[0]}" if end is None else f"{said[1]} >= {TIME} >= {said[0]}"


def _dated(moment: datetime) -> str:
    whole = not moment.second and not moment.microsecond
    return moment.replace(tzinfo=None).isoformat(timespec="minutes" if whole else "auto")
