"""Exactly two together, at most three: told by whether so many were, and whether one more was."""

from __future__ import annotations

from dataclasses import replace

from assistant.phrases import term_of
from assistant.several import is_so, without_verdict
from d3a.answer import Answer
from grammar.forms import FormalQuery


def so_many_and_more(query: FormalQuery) -> tuple[FormalQuery, FormalQuery] | None:
    """Return whether so many things of one kind were together, and whether one more; else None.

    Of one thing alone, together with another of its kind, neither is asked.
    """
    together = query.relation is not None and query.relation.kind == "together"
    term = term_of(query)
    plain = query.ask == "whether" and together and not query.negated and len(query.objects) == 1
    if not plain or query.relation is None or query.relation.negated or term.bound == "least":
        return None
    number = term.quantity or 0
    if number < 2:
        return None
    many, more = (replace(term, bound="least", quantity=n) for n in (number, number + 1))
    return replace(query, objects=(many,)), replace(query, objects=(more,))


def told_of_so_many(query: FormalQuery, many: Answer, more: Answer) -> Answer:
    """Return whether so many were together and no more, with the sentence of what tells it.

    Of at most three together none is right, too. What is not sure of one more is not sure.
    """
    is_more, is_many = is_so(more), is_so(many)
    if is_more is not False:
        verdict, told = ("No. " if is_more else "I cannot be sure. "), more
    elif is_many is not False:
        verdict, told = ("Yes. " if is_many else "I cannot be sure. "), many
    else:
        at_most = term_of(query).bound == "most"
        verdict, told = ("That is right. " if at_most else ""), many
    said = f"{verdict}{without_verdict(told.answer)}" if verdict else told.answer
    return replace(told, text=query.text, query=query, answer=said)
