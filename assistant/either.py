"""One thing or another, one place or another: which of them it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from assistant.all_of_them import wherever_they_are
from assistant.conditions import condition_words
from assistant.english import listed
from assistant.phrases import asked_place, described, indefinite, numbered
from assistant.said import is_one, said_many
from assistant.several import is_so, without_verdict
from d3a.answer import Answer
from grammar.forms import FormalQuery, ObjectTerm


def one_or_another(query: FormalQuery) -> list[FormalQuery]:
    """Return the question of each thing or place that will do, where it is asked whether any does.

    Of a moment what was seen before and after it is told of all of them; what is denied of all is.
    """
    plain = query.ask == "whether" and not query.negated and query.select != "usual"
    plain = plain and not (query.time is not None and query.time.is_point)
    open_terms = [term for term in query.objects if term.or_else]
    if wherever_they_are(query):
        return []  # all of them may be, some here and some there
    if not plain or len(open_terms) + bool(query.or_places) != 1 or query.outside:
        return []
    if query.place is not None and query.or_places:
        return [replace(query, place=p, or_places=()) for p in (query.place, *query.or_places)]
    (term,) = open_terms
    if term.quantity is not None:
        return []
    at = query.objects.index(term)
    others = [replace(other, where=term.where) for other in term.or_else]
    each = [replace(term, or_else=()), *others]
    before, after = query.objects[:at], query.objects[at + 1 :]
    return [replace(query, objects=(*before, one, *after)) for one in each]


def told_of_either(query: FormalQuery, whole: Answer, answers: Sequence[Answer]) -> Answer:
    """Return the answer that one of them does, with a sentence that says which.

    whole: of all of them, with its sentence: it is told where none does for certain.
    """
    so = [None if answer.unjudged else is_so(answer) for answer in answers]
    if True not in so:
        return whole
    held = [answer for answer, is_held in zip(answers, so, strict=True) if is_held]
    if len(held) == len(answers):
        verdict = "Yes, both." if len(answers) == 2 else "Yes, all of them."
    else:
        verdict = f"Yes, {listed([_which(query, answer) for answer in held])}."
    told = " ".join([verdict, *(without_verdict(answer.answer) for answer in held)])
    return replace(whole, answer=told)


def _which(query: FormalQuery, answer: Answer) -> str:
    """Return what an answer is about, of what it might have been: the red cup, in the hall."""
    asked = answer.query
    assert asked is not None
    if query.or_places and asked.place is not None:
        return asked_place(query, asked.place)
    if query.objects[0].or_else:
        return _thing(query, asked.objects[0])
    return condition_words(answer, asked).strip()


def _thing(query: FormalQuery, term: ObjectTerm) -> str:
    words = numbered(query, term)
    if is_one(query) or _is_definite(query, term):
        return f"the {words}"
    return indefinite(term, words, many=said_many(query, term))


def _is_definite(query: FormalQuery, term: ObjectTerm) -> bool:
    looks = described(term)
    return any(f"the {word}" in query.text.casefold() for word in (looks, looks.split()[0]))
