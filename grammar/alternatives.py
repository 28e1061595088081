"""What `or` leaves open in a question: one query of either, where the algebra can say it.

A pink or red cup, on the couch or the table, in the kitchen or the hall are each one thing that is
asked for. Where two things are asked for (where is the cup or the bowl), and where two relations
are, it stays open which is meant.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.forms import Ask, ObjectTerm
from grammar.meaning import AtPlace, Choice, Group, Item, Meaning, Outside, Related

_EITHER: tuple[Ask, ...] = ("whether", "what", "when", "count", "how_often", "moved", "missing")
"""Questions that are answered alike by one thing or another: did you see a cup or a bowl."""


def united(meaning: Meaning) -> Meaning | None:
    """Return the meaning with each choice said as one thing or place; None where one cannot be."""
    group = meaning.things.group
    if group is not None and group.choice:
        if group.apart:
            return None
        term = either_of(group.terms, looks_alone=meaning.ask not in _EITHER)
        if term is None:
            return None
        group = Group((term,))
    items = [_item(item) for item in meaning.things.items]
    if any(item is None for item in items):
        return None
    told = tuple(item for item in items if item is not None)
    return replace(meaning, things=replace(meaning.things, group=group, items=told))


def either_of(terms: tuple[ObjectTerm, ...], *, looks_alone: bool = False) -> ObjectTerm | None:
    """Return the first term, with the others as what will do as well; None where one will not do.

    What is said of the first alone is said of all where they differ in their looks alone: two red
    or blue cups are two cups. looks_alone: else they are no one thing.
    """
    first, *others = terms
    bare = [replace(term, attributes=(), without=(), or_else=()) for term in terms]
    plain = replace(bare[0], quantity=None, bound="least", where=None, other_than=())
    alike = all(other == plain for other in bare[1:])
    told = any(t.quantity or t.where or t.or_else or t.other_than for t in others)
    of_first = first.quantity is not None or first.where is not None or first.other_than
    if told or ((of_first or looks_alone) and not alike):
        return None
    return replace(first, or_else=(*first.or_else, *others))


def _item(item: Item) -> Item | None:
    if isinstance(item, Related) and item.group.choice:
        term = None if item.group.apart else either_of(item.group.terms)
        return None if term is None else replace(item, group=Group((term,)))
    if not isinstance(item, Choice):
        return item
    first = item.options[0]
    if item.apart or any(type(option) is not type(first) for option in item.options):
        return None
    if isinstance(first, AtPlace | Outside):
        names = [o.name for o in item.options if isinstance(o, AtPlace | Outside)]
        return replace(first, others=(*first.others, *names[1:]))
    related = [option for option in item.options if isinstance(option, Related)]
    alike = {(r.kind, r.negated, len(r.group.terms)) for r in related}
    if len(related) < len(item.options) or len(alike) > 1 or len(related[0].group.terms) > 1:
        return None
    term = either_of(tuple(r.group.terms[0] for r in related))
    return None if term is None else replace(related[0], group=Group((term,)))
