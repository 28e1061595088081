"""What lies "on the workbench" where a place bears that name: the place is asked, not a thing.

People call the places that they teach by the furniture that stands there. A detector need not
know that furniture; the grammar alone cannot tell the two apart, as it reads "on" of things.
"""

from __future__ import annotations

from dataclasses import replace

from d3a.facts import Facts
from grammar.forms import FormalQuery, ObjectTerm


def on_a_spot(query: FormalQuery, facts: Facts) -> FormalQuery:
    """Return the query with a place for its relation, where what things lie on is a place's name.

    A thing that the detector knows, or that somebody named, goes before the place of its name.
    Raises StoreError.
    """
    relation = query.relation
    if relation is None or relation.kind != "on" or len(query.objects) != 2 or query.place:
        return query
    spot = _name_of(query.objects[1], facts)
    if spot is None:
        return query
    return replace(
        query,
        form="Q3",
        objects=query.objects[:1],
        relation=None,
        place=spot,
        negated=query.negated or relation.negated,
    )


def _name_of(ground: ObjectTerm, facts: Facts) -> str | None:
    """Return the place that a bare noun names and nothing else bears, as it is written."""
    if ground != ObjectTerm(ground.category, ground.word, var=ground.var):
        return None
    said = {ground.word.casefold(), ground.category.casefold()}
    things = [*facts.categories(), *(facts.classes() or ()), *(n.word for n in facts.names())]
    if said & {thing.casefold() for thing in things}:
        return None
    return next((r.name for r in facts.regions() if r.name.casefold() in said), None)
