"""The steps of a plan as data: each reads a store or narrows what was read before it.

Paper: "Retrieving object instances". `d3a.plan` lays them out, `d3a.execute` takes them.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from grammar.forms import Ask, RelationKind, Select, TimeSlice

Precision = Literal["perfect", "category", "attribute", "any"]
"""The paper's rungs (Evaluation): the very object, its category, any object at all.

perfect: what a person taught the word for. category: what the detector calls so, whatever its
colour. attribute: of these, what holds the attributes. any: everything, whatever its attributes.
Forced, none of them goes on to wider, narrower or rarely given words.
"""
Edge = Literal["first", "last"]
Lasting = Literal["all", "newest"]
"""How long a thing was somewhere in all, or since when it has been there."""


@dataclass(frozen=True, slots=True)
class FindObjects:
    """OIc.find: the objects that `word` may mean, each with how well the word fits.

    var: the variable of the formal query; `x.1` is the object that describes `x`.
    votes: also what only some of the detections called so, with the worth of their share.
    not_owner: who it must not be taught to belong to. among: of these ids alone, whatever people
    call them.
    """

    var: str
    category: str
    word: str
    owner: str | None = None
    precision: Precision | None = None
    votes: bool = False
    not_owner: str | None = None
    among: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class JudgeAttributes:
    """Score what must hold of the objects of `var`, and what must not; drop who is refused.

    doubts: keep who is doubtful, to be listed below who is likely; alone they are no answer.
    somewhere: what is compared (the biggest) is so among those of a place, which is not known yet.
    """

    var: str
    attributes: tuple[str, ...]
    without: tuple[str, ...] = ()
    doubts: bool = False
    somewhere: bool = False


@dataclass(frozen=True, slots=True)
class TakeIn:
    """Count what was found for `others` as found for `var`: a pink cup, or else a red one."""

    var: str
    others: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class LeaveOut:
    """Drop of `var` what is rather one of `others`: something red that is not a cup."""

    var: str
    others: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FindSightings:
    """STc.find: sightings of the objects of `var` that touch [start, end).

    select: how the answer will choose, where it tells single sightings; then no more are read
    than it can tell, see `d3a.answering.bounded`. None: all are needed, to be counted or joined.
    """

    var: str
    start: datetime | None = None
    end: datetime | None = None
    select: Select | None = None


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
class KeepInRoom:
    """Where the noun names a room ("kitchen table"), keep what is in it, if anything is."""

    var: str


@dataclass(frozen=True, slots=True)
class DropGone:
    """Drop sightings whose place had been seen without the object by the moment asked for."""

    var: str
    at: datetime


@dataclass(frozen=True, slots=True)
class FilterPlace:
    """Keep sightings of `var` inside of the named region; outside of it where negated.

    others: further regions; inside of any of them, or outside of all.
    """

    var: str
    place: str
    negated: bool = False
    others: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Relate:
    """Join the sightings of `vars` (figure first) where the relation holds between them.

    keep: "moments" makes a moment of all arguments; "figure" keeps the figure's sightings alone,
    as the description of an object does (the table next to the door), and what moved on the desk.
    Negated: the figure's sightings that no argument stands in the relation to.
    """

    kind: RelationKind
    vars: tuple[str, ...]
    negated: bool = False
    keep: Literal["moments", "figure"] = "moments"
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class Gather:
    """Join the sightings of `vars` where so many things of each were together, at one time.

    numbers: one a variable; two cups together are two of one variable. most: as many of the first
    as there ever were, and so many at least. Negated: its sightings in no such group.
    """

    vars: tuple[str, ...]
    numbers: tuple[int, ...]
    most: bool = False
    negated: bool = False
    start: datetime | None = None
    end: datetime | None = None
    kind: RelationKind = "together"


@dataclass(frozen=True, slots=True)
class Unite:
    """Answer by what was found for each of `vars` alone: the relation is not judged.

    The paper's “together” (its Any rows return as much for Q2 as for Q1).
    """

    kind: RelationKind
    vars: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FindNow:
    """Find where the objects that stood so were seen last, wherever that was."""

    var: str


@dataclass(frozen=True, slots=True)
class FindStretches:
    """Find from when to when the objects of `var` were so without being seen elsewhere between.

    newest: it is asked since when one has been so, and no more than that is told.
    """

    var: str
    newest: bool = False


@dataclass(frozen=True, slots=True)
class KeepPresent:
    """Keep each object's newest moment, where it was not seen elsewhere or seen gone since.

    anywhere: where everything is is asked for, not what is at one place. known: the variables
    of which each is one thing that is known, where there may be but one: the wallet, my keys.
    """

    var: str
    anywhere: bool = False
    known: tuple[str, ...] = ()


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
class KeepOften:
    """Keep the newest moment of each thing, by the share of the looks that showed it there."""

    var: str
    ground: str | None = None
    start: datetime | None = None
    end: datetime | None = None


@dataclass(frozen=True, slots=True)
class KeepThen:
    """Keep of what was somewhere, or stood so, around a moment what nothing nearer contradicts."""

    var: str
    at: datetime


@dataclass(frozen=True, slots=True)
class Measure:
    """Compute the number asked for: objects, seconds, or sightings."""

    ask: Ask
    var: str
    quantity: int | None = None


@dataclass(frozen=True, slots=True)
class Rank:
    """Order the moments by probability of correctness, or by time where the question says so.

    spread: each object once before its other places, and those before any place twice; pictures
    of several pairs before those of one, so that near-duplicates do not fill the list.
    vars: more than one where several objects are asked for at once.
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
    | TakeIn
    | LeaveOut
    | FindSightings
    | FindEdge
    | FindStays
    | KeepInRoom
    | DropGone
    | FilterPlace
    | Relate
    | Gather
    | Unite
    | FindNow
    | FindStretches
    | KeepPresent
    | KeepThen
    | KeepMissing
    | KeepMoved
    | KeepUsual
    | KeepOften
    | Measure
    | Rank
    | FindLaterNames
    | FindLandmarks
    | Cover
    | ExplainEmpty
)
