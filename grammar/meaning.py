"""What a question means before its time is known, and how that becomes a formal query."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeAlias

from grammar.forms import (
    ANYTHING,
    Ask,
    Form,
    FormalQuery,
    ObjectTerm,
    Relation,
    RelationKind,
    Select,
    TimeSlice,
    Where,
)

THING = ObjectTerm(ANYTHING, "thing")
_PLACED: tuple[Ask, ...] = ("where", "when", "how_long", "how_often", "moved", "missing")
_CHANGES: tuple[Ask, ...] = ("moved", "missing")
_AT_ONCE: tuple[Ask, ...] = ("whether", "when", "how_long", "how_often")
_MUTUAL: tuple[RelationKind, ...] = ("together", "same_place")
_HOLDING: tuple[RelationKind, ...] = ("on", "in", "under")


@dataclass(frozen=True, slots=True)
class Group:
    """Objects joined by `and`; `choice` where each is asked for alone, as `or` does.

    apart: it was `and` that joined them, but no thing is on two others: each of them is asked for.
    """

    terms: tuple[ObjectTerm, ...]
    choice: bool = False
    apart: bool = False


@dataclass(frozen=True, slots=True)
class Related:
    """A relation to further objects: on the table, not next to the door.

    of_figure: said after `and`, of the thing asked for and not of the object named last.
    """

    kind: RelationKind
    group: Group
    negated: bool = False
    of_figure: bool = False


@dataclass(frozen=True, slots=True)
class AtPlace:
    """In a named place, or in any of the others."""

    name: str
    others: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Outside:
    """Not in a named place, nor in any of the others."""

    name: str
    others: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Here:
    """Somewhere, here, at home: no place that narrows anything."""


@dataclass(frozen=True, slots=True)
class SideBySide:
    """together, in the same place: a relation among the objects that were named."""

    kind: RelationKind


@dataclass(frozen=True, slots=True)
class Choice:
    """Items of which one is meant: in the kitchen or in the hall. apart: each is asked for."""

    options: tuple[Item, ...]
    apart: bool = False


Item: TypeAlias = "Related | AtPlace | Outside | Here | SideBySide | Choice"


@dataclass(frozen=True, slots=True)
class Things:
    """Objects and all that is said of where they are."""

    group: Group | None = None
    items: tuple[Item, ...] = ()

    def with_items(self, items: tuple[Item, ...]) -> Things:
        """Return the things with more said of where they are."""
        return replace(self, items=(*self.items, *items))


@dataclass(frozen=True, slots=True)
class Meaning:
    """A question read by the grammar, its floating words and time not yet added.

    ask: None in a fragment, which asks what the question before it asked.
    select: what the saying itself implies. newest: unbounded, it asks for the newest sighting.
    """

    ask: Ask | None
    things: Things = field(default_factory=Things)
    select: Select | None = None
    newest: bool = False


class MeaningError(ValueError):
    """A reading that has no formal query; `state` when a state or property is asked."""

    def __init__(self, reason: str, *, state: bool = True) -> None:
        super().__init__(reason)
        self.state = state


def readings(meaning: Meaning) -> tuple[Meaning, ...]:
    """Return the meanings that `or` leaves open, one alone where there is no choice."""
    things = meaning.things
    if things.group is not None and things.group.choice:
        groups = [Group((term,)) for term in things.group.terms]
        return tuple(replace(meaning, things=replace(things, group=g)) for g in groups)
    for i, item in enumerate(things.items):
        options: tuple[Item, ...] = ()
        if isinstance(item, Choice):
            options = item.options
        elif isinstance(item, Related) and item.group.choice:
            options = tuple(replace(item, group=Group((term,))) for term in item.group.terms)
        if options:
            rests = [(*things.items[:i], option, *things.items[i + 1 :]) for option in options]
            return tuple(replace(meaning, things=replace(things, items=r)) for r in rests)
    return _each_there(meaning)


def _each_there(meaning: Meaning) -> tuple[Meaning, ...]:
    """Return the meanings of two things on one: both there at once, or each asked for alone.

    The contract has no relation of two figures to one ground: both are described by it.
    """
    things = meaning.things
    related = [item for item in things.items if isinstance(item, Related)]
    terms = things.group.terms if things.group else ()
    if len(terms) < 2 or not related or related[0].kind in _MUTUAL:
        return (meaning,)
    if isinstance(things.items[0], SideBySide):  # together on the table
        return (meaning,)
    on = related[0]
    plain = not any(term.where for term in terms) and len(related) == len(on.group.terms) == 1
    if not plain or meaning.ask not in _AT_ONCE or on.kind not in _HOLDING:
        groups = [Group((term,)) for term in terms]
        return tuple(replace(meaning, things=replace(things, group=g)) for g in groups)
    where = Where(on.kind, on.group.terms[0], on.negated)
    both = Group(tuple(replace(term, where=where) for term in terms))
    rest = tuple(item for item in things.items if item is not on)
    placed = Things(both, (SideBySide("together"), *rest))
    return (replace(meaning, things=placed),)


def query(
    meaning: Meaning,
    text: str,
    time: TimeSlice | None,
    select: Select | None,
    negated: bool,
    never: bool = False,
    contrary: bool = False,
) -> FormalQuery:
    """Return the formal query of a meaning, its floating words and its time.

    never: it is denied for all of the time, and not for a sighting. contrary: a sighting is asked
    for of which it does not hold.
    Raises MeaningError where the objects cannot stand in their relation, and for what never was.
    """
    ask = meaning.ask or "where"
    objects, relation, places, outside = _arranged(_denied_once(meaning) if negated else meaning)
    place = places[0] if places else None
    if ask in _CHANGES and relation is not None and relation.kind == "together":
        raise MeaningError("it tells what moved or is missing, not together with what")
    if never and ask != "whether":
        raise MeaningError("it asks for what never was, and I remember what was")
    chosen: Select = select or meaning.select or "all"
    unsaid = select is None and meaning.select is None
    if unsaid and meaning.newest and time is None and ask == "where":
        chosen = "last"
    form = form_of(ask, relation, time, place, chosen)
    return FormalQuery(
        text=text,
        form=form,
        ask=ask,
        objects=objects,
        relation=relation,
        place=place,
        time=time,
        select=chosen,
        negated=negated,
        outside=outside,
        or_places=places[1:],
        contrary=contrary and ask == "whether" and (relation is not None or place is not None),
    )


def _denied_once(meaning: Meaning) -> Meaning:
    """Return a denied meaning with its places denied by it alone: not in the hall nor the kitchen.

    The first `not` denies the question, each further one a place of it: it was in none of them.
    """
    items = meaning.things.items
    first = next((item for item in items if isinstance(item, AtPlace)), None)
    names = tuple(name for o in items if isinstance(o, Outside) for name in (o.name, *o.others))
    if first is None or not names:
        return meaning
    left = tuple(item for item in items if item is not first and not isinstance(item, Outside))
    placed = replace(first, others=(*first.others, *names))
    return replace(meaning, things=replace(meaning.things, items=(placed, *left)))


def form_of(
    ask: Ask, relation: Relation | None, time: TimeSlice | None, place: str | None, select: Select
) -> Form:
    """Return Q2 for a relation, Q3 for a place, a time or what they narrow, else Q1."""
    if relation is not None:
        return "Q2"
    narrowed = time is not None or place is not None or select in ("first", "last", "usual")
    return "Q3" if narrowed or ask in _PLACED else "Q1"


def _arranged(
    meaning: Meaning,
) -> tuple[tuple[ObjectTerm, ...], Relation | None, tuple[str, ...], bool]:
    """Lay objects and relations out: the first relation is the query's, later ones describe."""
    things = meaning.things
    terms = list(things.group.terms) if things.group else []
    relation: Relation | None = None
    places: tuple[str, ...] = ()
    outside = False
    figures = len(terms)
    for item in things.items:
        match item:
            case AtPlace() | Outside():
                denied, named = isinstance(item, Outside), (item.name, *item.others)
                if places and not (denied and outside) and (places, outside) != (named, denied):
                    raise MeaningError("it names two places", state=False)
                places, outside = tuple(dict.fromkeys((*places, *named))), denied
            case SideBySide():
                relation = relation or Relation(item.kind)
            case Here() | Choice():
                continue
            case Related() if relation is None:
                terms, figures = _with_figure(terms, figures)
                relation = Relation(item.kind, item.negated)
                terms += item.group.terms
            case Related():
                _describe(terms, figures, item)
    if relation is not None and relation.kind == "between" and len(terms) - max(figures, 1) > 2:
        raise MeaningError("between takes two things", state=False)
    if not terms and meaning.ask in ("what", "whether", "count"):
        terms = [THING]
    if relation is not None and not terms:
        raise MeaningError("a relation needs two things", state=False)
    return tuple(terms), relation, places, outside


def _with_figure(terms: list[ObjectTerm], figures: int) -> tuple[list[ObjectTerm], int]:
    return (terms, figures) if terms else ([THING], 1)


def _describe(terms: list[ObjectTerm], figures: int, item: Related) -> None:
    """Hang a further relation on the object it describes: the last one, or for `with` the first.

    After `and` it is said of what is asked for: on the table and near the lamp.
    """
    if not terms:  # "what was together next to the cup"
        raise MeaningError("a relation needs two things", state=False)
    of_first = item.kind == "together" or item.of_figure
    if of_first and figures > 1 and item.of_figure:
        raise MeaningError("it says where several things are in two ways", state=False)
    if len(item.group.terms) > 1:
        raise MeaningError("it tells one thing by its place to several others", state=False)
    target = 0 if of_first else len(terms) - 1
    described, where = terms[target], Where(item.kind, item.group.terms[0], item.negated)
    if described.where is None:
        terms[target] = replace(described, where=where)
        return
    inner = described.where.object
    if inner.where is not None or item.of_figure:
        raise MeaningError("it says too much about one thing", state=False)
    deeper = replace(described.where, object=replace(inner, where=where))
    terms[target] = replace(described, where=deeper)
