"""Places that bear the name of a thing: what lies "on the desk" where a place is called so.

People call the places that they teach by the furniture that stands there. A detector may or may
not know that furniture; the grammar alone cannot tell the two apart, as it reads "on" of things.
"""

from __future__ import annotations

from dataclasses import replace

from assistant.english import sentence_case
from assistant.phrases import (
    at_place,
    is_room,
    kind_of,
    left_with,
    plain_place,
    term_of,
    the_place,
)
from d3a.answer import Answer
from d3a.answering.facts import Facts
from d3a.answering.places import room_of
from grammar import vocabulary
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm, Relation, RelationKind

_AT: frozenset[RelationKind] = frozenset({"on", "in", "near"})
"""What is so of a place is at it."""
_BESIDE: frozenset[RelationKind] = frozenset(
    {"under", "above", "behind", "in_front_of", "left_of", "right_of"}
)
"""What is so of a thing: a place of its name says no more than which one."""


def on_a_spot(query: FormalQuery, facts: Facts) -> FormalQuery:
    """Return the query with a place in it, where what things lie on is a place's name.

    A person's name for a place goes before a detector's word. What is asked of a place that is no
    more is asked of the things of its name. Raises StoreError.
    """
    if query.place is not None:
        return _beside_things(query, facts)
    relation = query.relation
    if relation is None or len(query.objects) != 2 or relation.kind not in _AT | _BESIDE:
        return query
    spot = _spot_of(query.objects[1], facts)
    if spot is None or (relation.kind == "near" and is_room(spot)):
        return query
    if relation.kind in _BESIDE:
        return replace(query, place=spot)
    return replace(
        query,
        form="Q3",
        objects=query.objects[:1],
        relation=None,
        place=spot,
        outside=relation.negated,
    )


def _beside_things(query: FormalQuery, facts: Facts) -> FormalQuery:
    """Return the query of the things of a name that was a place's, and is no longer."""
    name = query.place
    if name is None or query.or_places or query.relation is not None or len(query.objects) != 1:
        return query
    if _is_place(name, facts) or not _is_thing(name, facts):
        return query
    ground = ObjectTerm(vocabulary.canonical(name), name)
    near, objects = Relation("near", query.outside), (*query.objects, ground)
    return replace(query, form="Q2", objects=objects, place=None, outside=False, relation=near)


def of_the_spot(query: FormalQuery, facts: Facts) -> str:
    """Return a sentence on which of two was taken: the place, or the things of the same name.

    Empty where there are no such things. Raises StoreError.
    """
    name = query.place
    if name is None or not _is_place(name, facts) or not _is_thing(name, facts):
        return ""
    return f"By “{the_place(name)}” I mean the place that you call so."


def told_as_place(answer: Answer, query: FormalQuery, facts: Facts) -> Answer:
    """Return the answer about a thing with what is known of the place of its name.

    Where there is no such thing, the place alone is told, and what to ask of it. Raises StoreError.
    """
    spot = _spot_of(query.objects[0], facts) if _asks_of_one_thing(query) else None
    if spot is None:
        return answer
    room = _room_around(spot, facts)
    inside = f", {at_place(room)}" if room is not None else ""
    name = sentence_case(the_place(spot))
    if answer.status != "unknown_object":
        return replace(answer, answer=f"{answer.answer} {name} is a place of yours too{inside}.")
    told = f"{name} is a place that I know{inside}. Ask what is there."
    return replace(answer, answer=told, suggestions=(f"What is {at_place(spot)}?",))


def _room_around(spot: str, facts: Facts) -> str | None:
    """Return the room that the middle of a place lies in; a place that was taught has no site."""
    region = next(each for each in facts.regions() if each.name == spot)
    xs, ys = zip(*region.polygon, strict=True)
    middle = (sum(xs) / len(xs), sum(ys) / len(ys), 0.0)
    rooms = (each for each in facts.regions() if is_room(each.name) and each is not region)
    held = (each for each in rooms if room_of([each], middle, region.site or each.site))
    return next((each.name for each in held), None)


def _asks_of_one_thing(query: FormalQuery) -> bool:
    alone = len(query.objects) == 1 and query.relation is None and query.place is None
    return alone and query.ask in ("where", "whether", "when")


def without_itself(answer: Answer, query: FormalQuery) -> Answer:
    """Return what was seen at a place without the thing whose name the place has.

    Who asks what is on the desk does not ask for the desk.
    """
    listing = query.ask in ("what", "whether") and query.relation is None
    if query.place is None or not listing or term_of(query).category != ANYTHING:
        return answer
    itself = vocabulary.canonical(plain_place(query.place))
    kept = [k for k in answer.keyframes if kind_of(k) != itself]
    return left_with(answer, kept) if 0 < len(kept) < len(answer.keyframes) else answer


def _spot_of(ground: ObjectTerm, facts: Facts) -> str | None:
    """Return the place that the words of an object name, as it is written; the exact one first."""
    if ground.without or ground.not_owner or ground.quantity is not None or ground.where:
        return None
    if ground.or_else or ground.other_than:
        return None
    whose = "" if ground.owner in (None, "me") else f"{ground.owner}'s "
    words = (" ".join((*ground.attributes, noun)) for noun in (ground.word, ground.category))
    said = [f"{whose}{each}".casefold() for each in words]
    names = {plain_place(region.name): region.name for region in facts.regions()}
    alike = {vocabulary.canonical(name): written for name, written in names.items()}
    return next((known[each] for known in (names, alike) for each in said if each in known), None)


def _is_place(name: str, facts: Facts) -> bool:
    return any(region.name.casefold() == name.casefold() for region in facts.regions())


def _is_thing(name: str, facts: Facts) -> bool:
    """Whether something that was seen, or was named by somebody, is called as a place is."""
    word = vocabulary.canonical(plain_place(name))
    things = [*facts.categories(), *(taught.word for taught in facts.names())]
    return any(vocabulary.canonical(thing.casefold()) == word for thing in things)
