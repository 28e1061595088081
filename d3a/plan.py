"""From a formal query to a plan: what to ask of OIc and STc, in which order, as data.

Paper: "Retrieving object instances" (Q1 to Q3 become finds on the two collections). A plan is a
tuple of steps; `plan` is pure and asks no store. `d3a.execute` walks it, one native query a step
at most, and joins and scores above the store.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from datetime import datetime
from typing import Any, Literal

from d3a.model import Json
from d3a.parameters import DEFAULT, Parameters
from grammar.forms import (
    ANYTHING,
    Ask,
    FormalQuery,
    ObjectTerm,
    RelationKind,
    Select,
    TimeSlice,
)

Precision = Literal["perfect", "category", "any"]
"""The paper's rungs (Evaluation): the very object, its category, any object at all."""
Edge = Literal["first", "last"]


@dataclass(frozen=True, slots=True)
class FindObjects:
    """OIc.find: the objects that `word` may mean, each with how well the word fits.

    var: the variable of the formal query; `x.1` is the object that describes `x`.
    """

    var: str
    category: str
    word: str
    owner: str | None = None
    precision: Precision | None = None


@dataclass(frozen=True, slots=True)
class JudgeAttributes:
    """Score what must hold of the objects of `var`, and what must not; drop who is refused."""

    var: str
    attributes: tuple[str, ...]
    without: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FindSightings:
    """STc.find: sightings of the objects of `var` that touch [start, end)."""

    var: str
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class FindEdge:
    """STc.find: a sighting an object, to tell what was true at a moment.

    edge "last": the newest that starts at or before it; "first": the oldest that ends after it.
    """

    var: str
    edge: Edge
    at: datetime


@dataclass(frozen=True, slots=True)
class FindStays:
    """STc.find: where the objects of `var` lay, for the sightings that were found."""

    var: str


@dataclass(frozen=True, slots=True)
class DropGone:
    """Drop sightings whose place had been seen without the object by the moment asked for."""

    var: str
    at: datetime


@dataclass(frozen=True, slots=True)
class FilterPlace:
    """Keep sightings of `var` inside of the named region; outside of it where negated."""

    var: str
    place: str
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Relate:
    """Join the sightings of `vars` (figure first) where the relation holds between them.

    keep: "moments" makes a moment of all arguments; "figure" keeps the figure's sightings alone,
    as the description of an object does (the table next to the door).
    Negated: the figure's sightings that no argument stands in the relation to.
    """

    kind: RelationKind
    vars: tuple[str, ...]
    negated: bool = False
    keep: Literal["moments", "figure"] = "moments"
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class KeepMissing:
    """Keep the last sighting of objects whose place was then seen without them, in the slice."""

    var: str
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class KeepMoved:
    """Keep the first sighting after each change of place that fell into the slice."""

    var: str
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class KeepUsual:
    """Keep a sighting a stay, by the share of the object's time that it lay there."""

    var: str
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class Measure:
    """Compute the number asked for: objects, seconds, or sightings."""

    ask: Ask
    var: str
    quantity: int | None = None


@dataclass(frozen=True, slots=True)
class Rank:
    """Order the moments by probability of correctness, or by time where the question says so.

    spread: each object at each place once before any twice, so that near-duplicates do not fill
    the list. vars: more than one where several objects are asked for at once.
    at: the moment asked for; what was seen nearest to it comes first.
    """

    vars: tuple[str, ...]
    select: Select
    spread: bool
    at: datetime | None = None


@dataclass(frozen=True, slots=True)
class FindLaterNames:
    """Find what the detector called otherwise right after the last sighting, at its spot.

    Where there is any, the moments are ranked again.
    """

    var: str


@dataclass(frozen=True, slots=True)
class FindLandmarks:
    """Tell each keyframe by the nearest large static thing, as people do."""

    var: str


@dataclass(frozen=True, slots=True)
class Cover:
    """Tell when the robot looked last, in the asked place where one is named."""

    place: str | None = None


@dataclass(frozen=True, slots=True)
class ExplainEmpty:
    """Where nothing is left: find out why, and the nearest keyframe outside of slice or place.

    vars: the objects that must all have been seen, where each is asked for on its own.
    """

    vars: tuple[str, ...]
    time: TimeSlice | None = None
    place: str | None = None


Step = (
    FindObjects
    | JudgeAttributes
    | FindSightings
    | FindEdge
    | FindStays
    | DropGone
    | FilterPlace
    | Relate
    | KeepMissing
    | KeepMoved
    | KeepUsual
    | Measure
    | Rank
    | FindLaterNames
    | FindLandmarks
    | Cover
    | ExplainEmpty
)


@dataclass(frozen=True, slots=True)
class Plan:
    """The steps that answer a query, in order. `to_json` and `lines` print it."""

    query: FormalQuery
    steps: tuple[Step, ...]

    def to_json(self) -> list[Json]:
        """Return a record a step: its name under `step`, and its fields that say something."""
        return [{"step": type(step).__name__} | _fields(step) for step in self.steps]

    def lines(self) -> list[str]:
        """Return a line a step, as one would write the call."""
        return [
            f"{type(step).__name__}({', '.join(f'{k}={v!r}' for k, v in _fields(step).items())})"
            for step in self.steps
        ]


def plan(
    query: FormalQuery, *, parameters: Parameters = DEFAULT, precision: Precision | None = None
) -> Plan:
    """Return the plan of a query. Pure: equal queries give equal plans.

    precision forces a rung of the matching ladder. parameters.profile "paper" answers Q2 as the
    paper does, by the union of what was found for each object, unless a relation is geometry.
    """
    steps: list[Step] = []
    objects = query.objects or (ObjectTerm(ANYTHING),)
    polarity = _asks_for_absence(query)
    for term in objects:
        steps += _term_steps(term, term.var, query, precision)
    names = tuple(term.var for term in objects)
    var = names[0]
    if query.place is not None:
        negated = polarity and query.relation is None
        placed = names if query.relation is None else (var,)
        steps += [FilterPlace(name, query.place, negated) for name in placed]
    if query.relation is not None and len(names) > 1:
        negated = query.relation.negated != polarity
        steps.append(_relate(query, names, negated))
    kept = _keep_steps(query, var)
    steps += kept
    steps.append(Measure(query.ask, var, objects[0].quantity))
    alone = names if query.relation is None and not kept else (var,)
    point = query.time.start if query.time is not None and query.time.is_point else None
    steps.append(Rank(alone, query.select, _spreads(query), point))
    if _wants_the_last(query):
        steps.append(FindLaterNames(var))
    steps.append(FindLandmarks(var))
    steps.append(Cover(query.place))
    steps.append(ExplainEmpty(alone, query.time, query.place))
    return Plan(query, tuple(steps))


def _asks_for_absence(query: FormalQuery) -> bool:
    """Whether the relation or place must fail to hold.

    "Is there no cup on the table?" is settled by looking for a cup on the table; what it found is
    said with the question's own polarity. "When was the cup not with the bowl?" wants the others.
    """
    return query.negated and query.ask != "whether"


def _term_steps(
    term: ObjectTerm, var: str, query: FormalQuery, precision: Precision | None
) -> list[Step]:
    steps: list[Step] = [FindObjects(var, term.category, term.word, term.owner, precision)]
    if term.attributes or term.without:
        steps.append(JudgeAttributes(var, term.attributes, term.without))
    if query.time is not None and query.time.is_point and query.time.start is not None:
        steps.append(FindEdge(var, "last", query.time.start))
        steps.append(FindEdge(var, "first", query.time.start))
    elif query.ask in ("moved", "missing") or query.select == "usual":
        steps.append(FindSightings(var))  # the slice is about the change, see `_keep_steps`
    else:
        start, end = (query.time.start, query.time.end) if query.time else (None, None)
        steps.append(FindSightings(var, start, end))
    steps.append(FindStays(var))
    if query.time is not None and query.time.is_point and query.time.start is not None:
        steps.append(DropGone(var, query.time.start))
    if term.where is not None:
        inner = f"{var}.1"
        steps += _term_steps(term.where.object, inner, query, precision)
        relation = Relate(term.where.kind, (var, inner), term.where.negated, keep="figure")
        steps.append(relation)
    return steps


def _relate(query: FormalQuery, names: tuple[str, ...], negated: bool) -> Relate:
    assert query.relation is not None
    point = query.time is not None and query.time.is_point
    start, end = (query.time.start, query.time.end) if query.time and not point else (None, None)
    return Relate(query.relation.kind, names, negated, "moments", start, end)


def _keep_steps(query: FormalQuery, var: str) -> list[Step]:
    start, end = (query.time.start, query.time.end) if query.time else (None, None)
    if query.ask == "moved":
        return [KeepMoved(var, start, end)]
    if query.ask == "missing":
        return [KeepMissing(var, start, end)]
    if query.select == "usual":
        return [KeepUsual(var, start, end)]
    return []


def _wants_the_last(query: FormalQuery) -> bool:
    """Whether the very last sighting is the answer, and nothing but the object narrows it."""
    plain = query.relation is None and query.place is None and query.time is None
    category = query.objects[0].category if query.objects else ANYTHING
    return query.select == "last" and plain and category != ANYTHING


def _spreads(query: FormalQuery) -> bool:
    """Whether a second keyframe of one object and place is a repetition, not an answer."""
    return query.select == "all" and query.ask in ("whether", "where", "what", "count")


def _fields(step: Any) -> Json:
    assert is_dataclass(step)
    said = {f.name: getattr(step, f.name) for f in fields(step)}
    return {
        name: _plain(value)
        for name, value in said.items()
        if value is not None and value != () and value is not False
    }


def _plain(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, TimeSlice):
        return value.to_json()
    return list(value) if isinstance(value, tuple) else value
