"""What the sentence tells where a rung of the matching ladder was forced: only what was judged."""

from __future__ import annotations

from dataclasses import replace

from assistant.english import listed
from assistant.phrases import described
from d3a.answer import Answer
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm


def as_judged(answer: Answer, query: FormalQuery) -> FormalQuery:
    """Return the query without what the forced rung did not look at: looks, or kinds too."""
    if answer.precision not in ("category", "any"):
        return query
    is_any = answer.precision == "any"
    return replace(query, objects=tuple(_bare(term, is_any=is_any) for term in query.objects))


def not_judged(answer: Answer) -> str:
    """Return what the forced rung did not look at, as a sentence; empty where it judged all."""
    if answer.query is None or answer.precision not in ("category", "any"):
        return ""
    if answer.precision == "any":
        asked = [described(term) for term in _terms(answer.query) if not _is_plain(term)]
        opening = "This is about anything that I saw"
    else:
        terms = _terms(answer.query)
        asked = [w for t in terms for w in (*t.attributes, *(f"not {each}" for each in t.without))]
        opening = "This is about the category alone"
    quoted = listed([f"“{words}”" for words in dict.fromkeys(asked)])
    return f"{opening}: I did not judge {quoted}." if asked else ""


def not_taught(answer: Answer, query: FormalQuery, term: ObjectTerm) -> str:
    """Return that nobody taught the word, where only what was taught was asked for."""
    change = query.ask in ("moved", "missing")  # a taught thing may just have stayed
    if answer.precision != "perfect" or answer.reason != "never" or answer.otherwise or change:
        return ""
    return (
        f"Nobody taught me which thing is “{term.word}”, and that very thing alone was asked for."
    )


def _terms(query: FormalQuery) -> list[ObjectTerm]:
    """Return the objects of a query and what describes them."""
    out: list[ObjectTerm] = []
    for term in query.objects:
        inner: ObjectTerm | None = term
        while inner is not None:
            out.append(inner)
            inner = inner.where.object if inner.where is not None else None
    return out


def _is_plain(term: ObjectTerm) -> bool:
    return term.category == ANYTHING and not (term.attributes or term.without)


def _bare(term: ObjectTerm, *, is_any: bool) -> ObjectTerm:
    where = term.where
    if where is not None:
        where = replace(where, object=_bare(where.object, is_any=is_any))
    if is_any:
        return ObjectTerm(
            ANYTHING, var=term.var, quantity=term.quantity, bound=term.bound, where=where
        )
    return replace(term, attributes=(), without=(), where=where)
