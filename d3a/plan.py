"""From a formal query to a plan: what to ask of OIc and STc, in which order, as data.

Paper: "Retrieving object instances" (Q1 to Q3 become finds on the two collections). A plan is a
tuple of steps; `plan` is pure and asks no store. `d3a.execute` walks it, one native query a step
at most, and joins and scores above the store.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, fields, is_dataclass, replace
from datetime import datetime
from typing import Any

from d3a.answering.points import asks_where_all_is, edge_of, looked_at, whether_at
from d3a.answering.steps import (
    Cover,
    DropGone,
    Edge,
    ExplainEmpty,
    FilterPlace,
    FindEdge,
    FindLandmarks,
    FindLaterNames,
    FindNow,
    FindObjects,
    FindSightings,
    FindStays,
    FindStretches,
    Gather,
    JudgeAttributes,
    KeepInRoom,
    KeepMissing,
    KeepMoved,
    KeepOften,
    KeepPresent,
    KeepThen,
    KeepUsual,
    Lasting,
    LeaveOut,
    Measure,
    Precision,
    Rank,
    Relate,
    Step,
    TakeIn,
    Unite,
)
from d3a.model import Json
from d3a.parameters import DEFAULT, Parameters
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm, TimeSlice

__all__ = [
    "Cover",
    "DropGone",
    "Edge",
    "ExplainEmpty",
    "FilterPlace",
    "FindEdge",
    "FindLandmarks",
    "FindLaterNames",
    "FindNow",
    "FindObjects",
    "FindSightings",
    "FindStays",
    "FindStretches",
    "Gather",
    "JudgeAttributes",
    "KeepInRoom",
    "KeepMissing",
    "KeepMoved",
    "KeepOften",
    "KeepPresent",
    "KeepThen",
    "KeepUsual",
    "Lasting",
    "LeaveOut",
    "Measure",
    "Plan",
    "Precision",
    "Rank",
    "Relate",
    "Step",
    "TakeIn",
    "Unite",
    "numbers_together",
    "plan",
]


@dataclass(frozen=True, slots=True)
class Plan:
    """The steps that answer a query, in order. `to_json` and `lines` print it."""

    query: FormalQuery
    steps: tuple[Step, ...]

    def to_json(self) -> list[Json]:
        """Return a record a step: its name under `step`, and its fields that say something."""
        return [{"step": type(step).__name__} | _fields(step) for step in self.steps]

    def lines(self) -> list[str]:
        """Return a line a step, for reading: `find objects x, category cup, owner me`."""
        return [_line(step) for step in self.steps]


def plan(
    query: FormalQuery,
    *,
    parameters: Parameters = DEFAULT,
    precision: Precision | None = None,
    sighting: bool = False,
    lasting: Lasting | None = None,
    since_then: bool = False,
    known: tuple[str, ...] = (),
) -> Plan:
    """Return the plan of a query. Pure: equal queries give equal plans.

    precision forces a rung of the matching ladder. sighting: `last` chooses a sighting; else what
    was last somewhere is what is there now. lasting: a thing's time at a place is asked for, and
    not the time it was in view. since_then: where that is now which once stood so.
    known: the variables of things said as known ones, as the wallet is; what has an owner is one.
    parameters.profile "paper" answers “together” as the paper does, by the union of what was
    found for each object; other relations are geometry in both profiles.
    """
    if query.select == "usual" and query.ask == "when":  # its times, not its places by their share
        all_of_it = replace(query, select="all")
        return Plan(query, plan(all_of_it, parameters=parameters, precision=precision).steps)
    steps: list[Step] = []
    objects = query.objects or (ObjectTerm(ANYTHING),)
    polarity = query.seeks_absence  # what is found is said with the question's own polarity
    for number, term in enumerate(objects):  # all first: how far back is read depends on all
        figure = query.relation is None or number == 0
        steps += _object_steps(term, term.var, query, precision, figure=figure)
    for term in objects:
        steps += _sighting_steps(term, term.var, query, precision)
    names = tuple(term.var for term in objects)
    var = names[0]
    if query.place is not None:
        negated = (polarity and query.relation is None) != query.outside
        placed = names if query.relation is None else (var,)
        others = query.or_places
        steps += [FilterPlace(name, query.place, negated, others) for name in placed]
    united = False
    if query.relation is not None:
        negated = query.relation.negated != polarity
        by_paper = parameters.profile == "paper" and query.relation.kind == "together"
        united = (by_paper and not negated) if len(names) > 1 else not numbers_together(query)
        unite = Unite(query.relation.kind, names)
        steps.append(unite if united else _relate(query, names, negated))
    elif numbers_together(query):
        steps.append(_gather(query, names, polarity))
    if since_then:
        steps.append(FindNow(var))
    if lasting is not None:
        steps.append(FindStretches(var, lasting == "newest"))
    present = (_asks_for_the_present(query) and not sighting) or lasting == "newest"
    if present or asks_where_all_is(query):
        one = tuple(t.var for t in objects if t.var in known or t.owner is not None)
        steps.append(KeepPresent(var, anywhere=not present, known=one))
    if (at := whether_at(query)) is not None:
        steps.append(KeepThen(var, at))
    kept = [step for name in _on_their_own(query, names) for step in _keep_steps(query, name)]
    steps += kept
    steps.append(Measure(query.ask, var, objects[0].quantity))
    alone = names if (query.relation is None or united) and not kept else (var,)
    select = "all" if present else query.select  # one moment an object is left: the likeliest
    steps.append(Rank(alone, select, _spreads(query) or present, edge_of(query)))
    if _wants_the_last(query):
        steps.append(FindLaterNames(var))
    steps.append(FindLandmarks(var))
    within = None if query.outside or query.or_places else query.place
    steps.append(Cover(within))
    steps.append(ExplainEmpty(alone, query.time, within))
    return Plan(query, tuple(steps))


def _asks_for_the_present(query: FormalQuery) -> bool:
    """Whether it is asked what is somewhere now: "What is on the table?", "Is the cup there?".

    The newest sightings are asked for, of what stands in a relation or lies in a place: each
    object's newest counts, and only where nothing was seen since that says otherwise.
    """
    somewhere = query.relation is not None or query.place is not None
    asked = query.ask in ("what", "whether", "count")
    number = bool(query.objects) and query.objects[0].quantity is not None
    asked = asked or (query.ask == "where" and number)  # two cups on the table: those there now
    return query.select == "last" and asked and somewhere and query.time is None


def _object_steps(
    term: ObjectTerm,
    var: str,
    query: FormalQuery,
    precision: Precision | None,
    *,
    figure: bool,
) -> list[Step]:
    """Return the steps that find what a term may mean."""
    counted = query.ask in ("count", "moved", "missing") or term.quantity is not None
    votes = figure and not counted and precision is None and term.category != ANYTHING
    find = FindObjects(var, term.category, term.word, term.owner, precision, votes, term.not_owner)
    steps: list[Step] = [find]
    looks = precision not in ("category", "any")
    if (term.attributes or term.without) and looks:
        doubts = "." not in var and _lists_doubts(query, term)
        somewhere = query.ask == "what" and not (query.place is None and query.relation is None)
        judge = JudgeAttributes(var, term.attributes, term.without, doubts, somewhere)
        steps.append(judge)
    if term.or_else:
        names = tuple(f"{var}/{number}" for number, _ in enumerate(term.or_else, 1))
        for name, other in zip(names, term.or_else, strict=True):
            steps += _object_steps(other, name, query, precision, figure=figure)
        steps.append(TakeIn(var, names))
    if term.other_than and looks:
        names = tuple(f"{var}-{number}" for number, _ in enumerate(term.other_than, 1))
        for name, other in zip(names, term.other_than, strict=True):
            steps += _object_steps(other, name, query, precision, figure=False)
        steps.append(LeaveOut(var, names))
    return steps


def _sighting_steps(
    term: ObjectTerm, var: str, query: FormalQuery, precision: Precision | None
) -> list[Step]:
    """Return the steps that find where and when that was seen, and what describes it."""
    steps: list[Step] = []
    point, time = edge_of(query), looked_at(query.time)
    if point is not None:
        steps.append(FindEdge(var, "last", point))
        steps.append(FindEdge(var, "first", point))
    elif _is_of_all_time(query):
        steps.append(FindSightings(var))  # the slice is about the change, see `_keep_steps`
    else:
        told = query.select if _tells_sightings(query, term) else None
        steps.append(FindSightings(var, time.start, time.end, told))
    steps.append(FindStays(var))
    if " " in term.word and not term.or_else:  # of several each is looked for in its own room
        steps.append(KeepInRoom(var))
    if point is not None:
        steps.append(DropGone(var, point))
    if term.where is not None:
        inner = f"{var}.1"
        steps += _object_steps(term.where.object, inner, query, precision, figure=False)
        steps += _sighting_steps(term.where.object, inner, query, precision)
        relation = Relate(term.where.kind, (var, inner), term.where.negated, keep="figure")
        steps.append(relation)
    return steps


def numbers_together(query: FormalQuery) -> tuple[int, ...]:
    """Return how many things of each object a query wants together, at least two of any.

    () where it is no such query: of one cup and one bowl the relation alone tells. The times at
    which two cups were seen are those at which both were.
    """
    if _is_of_all_time(query):
        return ()
    terms = query.objects or (ObjectTerm(ANYTHING),)
    if query.relation is None:  # when two cups were seen is asked of both
        timed = query.ask in ("when", "how_long", "how_often") and len(terms) == 1
        return (terms[0].quantity or 1,) if timed and _are_several(terms[0]) else ()
    if query.relation.kind != "together":
        return ()
    # of at most three together, or exactly three, no group tells
    numbers = [max(term.quantity or 1, 1) if term.bound == "least" else 1 for term in terms]
    if len(numbers) == 1:
        return (max(numbers[0], 2),)  # one thing is together with another of its kind
    return tuple(numbers) if max(numbers) > 1 else ()


def _are_several(term: ObjectTerm) -> bool:
    return term.bound == "least" and term.quantity is not None and term.quantity > 1


def numbers_unjudged(query: FormalQuery) -> tuple[ObjectTerm, ...]:
    """Return the objects whose number is bounded in a way that the answer does not judge.

    How many there were of what it is asked whether they were seen is judged, and no other number.
    """
    together = query.relation is not None and query.relation.kind == "together"
    several = query.relation is None and len(query.objects) > 1
    judges = query.ask == "whether" and not together and not several
    judged = query.objects[:1] if judges else ()
    return tuple(t for t in query.terms if t.bound != "least" and t not in judged)


def _relate(query: FormalQuery, names: tuple[str, ...], negated: bool) -> Relate | Gather:
    assert query.relation is not None
    if numbers_together(query):
        return _gather(query, names, negated)
    if _is_of_all_time(query):  # the slice is about the change of what stood so
        return Relate(query.relation.kind, names, negated, "figure")
    time = TimeSlice() if edge_of(query) is not None else looked_at(query.time)
    return Relate(query.relation.kind, names, negated, "moments", time.start, time.end)


def _gather(query: FormalQuery, names: tuple[str, ...], negated: bool) -> Gather:
    most = query.ask == "count" and not (query.objects and query.objects[0].quantity)
    time = TimeSlice() if edge_of(query) is not None else looked_at(query.time)
    return Gather(names, numbers_together(query), most, negated, time.start, time.end)


def _is_of_all_time(query: FormalQuery) -> bool:
    """Whether what was seen before and after the slice counts too: what moved, or is usual."""
    return query.ask in ("moved", "missing") or query.select == "usual"


def _on_their_own(query: FormalQuery, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the variables that are each asked about: of a relation the figure alone."""
    return names if query.relation is None else names[:1]


def _keep_steps(query: FormalQuery, var: str) -> list[Step]:
    time = looked_at(query.time)
    if query.ask == "moved":
        return [KeepMoved(var, time.start, time.end)]
    if query.ask == "missing":
        return [KeepMissing(var, time.start, time.end)]
    if query.select == "usual" and query.ask == "what":
        ground = query.objects[1].var if query.relation is not None and query.objects[1:] else None
        return [KeepOften(var, ground, time.start, time.end)]
    if query.select == "usual":
        return [KeepUsual(var, time.start, time.end)]
    return []


def _wants_the_last(query: FormalQuery) -> bool:
    """Whether the very last sighting is the answer, and nothing but the object narrows it."""
    plain = query.relation is None and query.place is None and query.time is None
    category = query.objects[0].category if query.objects else ANYTHING
    return query.select == "last" and plain and category != ANYTHING


def _tells_sightings(query: FormalQuery, term: ObjectTerm) -> bool:
    """Whether the answer is a choice of the object's sightings, not a number or a join of all."""
    chosen = query.ask in ("whether", "where", "when", "what") and query.select != "usual"
    plain = query.relation is None and query.place is None and term.where is None
    return chosen and plain and len(query.objects) == 1 and term.quantity is None


def _lists_doubts(query: FormalQuery, term: ObjectTerm) -> bool:
    """Whether the answer is a list by likelihood, which may end in what is doubtful."""
    listed = query.select == "all" and query.ask in ("whether", "where", "what", "when")
    sifted = term.quantity is not None or term.where is not None or query.place is not None
    chosen = term.without or term.or_else or term.other_than
    return listed and not sifted and not query.negated and not chosen


def _spreads(query: FormalQuery) -> bool:
    """Whether a second keyframe of one object and place is a repetition, not an answer.

    When two things were together is told by every pair before any pair's second moment.
    """
    return query.select == "all" and query.ask in ("whether", "where", "what", "count", "when")


def _said(step: Any) -> dict[str, Any]:
    """Return the fields of a step that say something."""
    assert is_dataclass(step)
    said = {f.name: getattr(step, f.name) for f in fields(step)}
    return {
        name: value
        for name, value in said.items()
        if value is not None and value != () and value is not False
    }


def _fields(step: Any) -> Json:
    return {name: _plain(value) for name, value in _said(step).items()}


def _line(step: Any) -> str:
    """Return a step in plain words: what is done, to which variables, and how."""
    done = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(step).__name__).lower()
    said = _said(step)
    of = [_worded(said.pop(name)) for name in ("var", "vars") if name in said]
    how = [name if value is True else f"{name} {_worded(value)}" for name, value in said.items()]
    return f"{done} {', '.join((*of, *how))}".rstrip()


def _worded(value: Any) -> str:
    match value:
        case datetime():
            return value.isoformat(" ", "minutes" if value.second == 0 else "seconds")
        case TimeSlice():
            ends = (("from", value.start), ("to", value.end))
            return " ".join(f"{word} {_worded(end)}" for word, end in ends if end is not None)
        case tuple():
            return " and ".join(map(_worded, value))
        case _:
            return str(value)


def _plain(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, TimeSlice):
        return value.to_json()
    return list(value) if isinstance(value, tuple) else value
