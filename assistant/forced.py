"""What the sentence tells where a rung of the matching ladder was forced: only what was judged."""

from __future__ import annotations

import re
from dataclasses import replace

from assistant.english import listed, plural
from assistant.phrases import described, wider_kind
from d3a.answer import Answer
from d3a.answering.match import said_alone
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm


def as_judged(answer: Answer, query: FormalQuery) -> FormalQuery:
    """Return the query without what was not looked at: by a forced rung looks, or kinds too.

    Of a blurple cup the cup was: `unjudged` has what nobody knows of its noun.
    """
    if answer.precision not in ("category", "any"):
        heard = tuple(_heard(term, answer) for term in query.objects)
        return replace(query, objects=heard, text=_said_wider(answer, query))
    is_any = answer.precision == "any"
    return replace(query, objects=tuple(_bare(term, is_any=is_any) for term in query.objects))


def not_judged(answer: Answer) -> str:
    """Return what the forced rung did not look at, as a sentence; empty where it judged all."""
    if answer.query is None or answer.precision not in ("category", "any"):
        return ""
    if answer.precision == "any":
        asked = [described(term) for term in answer.query.terms if not _is_plain(term)]
        opening = "This is about anything that I saw"
    else:
        terms = answer.query.terms
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


def _heard(term: ObjectTerm, answer: Answer) -> ObjectTerm:
    if term.owner is not None and said_alone(term.owner) in answer.unjudged:
        term = replace(term, owner=None)  # a cup it was; nobody told that it is Anna's
    if kind := wider_kind(answer, term):
        return replace(term, category=kind, word=kind, owner=None)
    lead, _, head = term.word.rpartition(" ")
    if not lead or lead not in answer.unjudged:
        return term
    return replace(term, category=vocabulary.canonical(head), word=head)


def _said_wider(answer: Answer, query: FormalQuery) -> str:
    """Return the question with the wider words for what was found by them, in the same number."""
    text = query.text
    for term in query.objects:
        if kind := wider_kind(answer, term):
            for said, found in ((plural(term.word), plural(kind)), (term.word, kind)):
                text = re.sub(rf"\b{re.escape(said)}\b", found, text, flags=re.IGNORECASE)
    return text


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
