"""The state of one execution: what was found so far, what was left out, what was looked up."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from math import prod

from d3a.answer import Reason, Status
from d3a.answering.facts import Facts
from d3a.answering.landmarks import Landmarks
from d3a.answering.match import Candidate, Lexicon, squash
from d3a.answering.moments import Entry, Found, Moment, Stretch, single
from d3a.answering.places import Rooms
from d3a.answering.spots import RuledOut, Spot
from d3a.parameters import Parameters
from d3a.plan import FilterPlace, FindObjects, Rank, Relate, Step, Unite
from d3a.rank import Ranked
from d3a.store.base import ObjectRecord, Region, Sighting, Spans, StayKey, StayRecord, Store
from grammar.forms import ANYTHING, FormalQuery, ObjectTerm

LEAST_TOGETHER = 0.35
"""How likely the looks of all things in a relation must be, where those of some are doubtful."""
_WORDS = {
    "in_front_of": "in front of",
    "left_of": "left of",
    "right_of": "right of",
    "same_place": "in the same place as",
    "together": "with",
}


@dataclass(slots=True)
class Run:
    """One walk over a plan. Steps read and narrow `found`; `moments` is None until joined.

    before_place, before_relation: by variable, the sightings that a place or relation sifted.
    unjudged: conditions left out, in the order of the question, none twice.
    rooms: by variable, the room that its noun names ("kitchen table"); plain: by variable, the
    candidates that the noun means wherever they are. refused: the attributes that `otherwise`
    does not have, or that what is in `perhaps`, the likeliest first, may or may not have; looked:
    the colours that `otherwise` looked instead, where a colour was asked for.
    looked_then, apart: see `Answer`. denied: by variable, the things that were said
    not to be the owner's. limit: of keyframes. cut: not every sighting
    was read; counted: of how many objects there are some; surely: how many of them must be
    different things, where that is too many; figures: how many of a moment's entries are what is
    asked for, more than one of things that were together; stretches: from when to when they were
    so, where that is asked; doubted: what was so and may be elsewhere by now; elsewhere: of what
    is counted, the ids of what may; came_from: by stay and start of what was seen at another place
    than before, how it was seen before; since_ms, until_ms: from when on or until when a relation
    was looked for, as the variables `reached`
    allow. spans: by variable, all sightings that count, where those that were found are a choice
    of them; so: of those that stood in a relation, when they did; late: the variables of which
    nothing is read before it is related; newest_alone: the variables of which each object's newest
    sighting was found and no other; named_alone: the things that a name alone chose for the first
    variable; many: those of which not all stays are read; unplaced: of these those that nobody
    knows a place of.
    """

    query: FormalQuery
    store: Store
    lexicon: Lexicon
    now: datetime
    parameters: Parameters
    facts: Facts
    steps: tuple[Step, ...] = ()
    found: dict[str, Found] = field(default_factory=dict)
    moments: list[Moment] | None = None
    ranked: list[Ranked] = field(default_factory=list)
    unjudged: list[str] = field(default_factory=list)
    before_place: dict[str, list[Sighting]] = field(default_factory=dict)
    before_relation: dict[str, list[Sighting]] = field(default_factory=dict)
    last_looked_ms: int | None = None
    landmarks: Landmarks | None = None
    status: Status = "found"
    reason: Reason | None = None
    otherwise: Moment | None = None
    perhaps: list[Ranked] = field(default_factory=list)
    refused: tuple[str, ...] = ()
    looked: tuple[str, ...] = ()
    looked_then: bool | None = None
    apart: int = 0
    denied: dict[str, set[str]] = field(default_factory=dict)
    limit: int = 50
    cut: bool = False
    counted: int = 0
    surely: int = 0
    figures: int = 1
    since_ms: int = 0
    until_ms: int | None = None
    reached: set[str] = field(default_factory=set)
    spans: dict[str, Spans] = field(default_factory=dict)
    so: dict[str, Spans] = field(default_factory=dict)
    late: set[str] = field(default_factory=set)
    newest_alone: set[str] = field(default_factory=set)
    named_alone: tuple[str, ...] = ()
    many: set[str] = field(default_factory=set)
    unplaced: set[str] = field(default_factory=set)
    suggestions: tuple[str, ...] = ()
    message: str | None = None
    rank_step: Rank | None = None
    stretches: list[Stretch] = field(default_factory=list)
    doubted: list[Moment] = field(default_factory=list)
    elsewhere: frozenset[str] = frozenset()
    came_from: dict[tuple[StayKey, int], Sighting] = field(default_factory=dict)
    plain: dict[str, dict[str, Candidate]] = field(default_factory=dict)
    rooms: dict[str, Region] = field(default_factory=dict)
    _spots: dict[StayKey, Spot] = field(default_factory=dict)
    _not_landmarks: tuple[frozenset[str], frozenset[str]] | None = None

    def region(self, name: str | None) -> Region | None:
        """Return the room of that name, None where nobody defined it."""
        wanted = squash(name or "")
        return next((r for r in self.facts.regions() if squash(r.name) == wanted), None)

    def rooms_of(self, step: FilterPlace) -> Rooms | None:
        """Return the rooms of a step, None where too few are defined to judge it.

        What may be in a room that nobody defined may be in one of several, and outside of all
        others.
        """
        known = [self.region(name) for name in (step.place, *step.others)]
        regions = tuple(region for region in known if region is not None)
        judged = regions and (step.negated or len(regions) == len(known))
        return Rooms(regions, step.negated) if judged else None

    def named(self, step: FindObjects) -> list[ObjectRecord]:
        """Return the objects that a person taught this word for; asks only where any name fits."""
        words = {squash(step.word), squash(step.category)}
        known = sorted({n.word for n in self.facts.names() if squash(n.word) in words})
        return self.store.objects(names=known) if known else []

    def not_denied(self, step: FindObjects, records: list[ObjectRecord]) -> list[ObjectRecord]:
        """Return those that nobody said are not the owner's: "these are not my keys"."""
        if step.owner is None:
            return records
        from d3a.constraints import History  # most questions do without

        words = {squash(step.word), squash(step.category)}
        denied = {
            name
            for name, word, owner in History.read(self.facts).denials()
            if owner == step.owner and words & {squash(word), squash(self.lexicon.canonical(word))}
        }
        left_out = {record.object_id for record in records} & denied
        self.denied.setdefault(step.var, set()).update(left_out)
        return [record for record in records if record.object_id not in left_out]

    def answering(self, var: str) -> list[Moment]:
        """Return the moments so far: those of a relation, else the variable's sightings."""
        if self.moments is not None:
            return self.moments
        found = self.found[var]
        return [single(found, sighting) for sighting in found.sightings]

    def needs_stays(self, var: str) -> bool:
        """Whether all stays of what was found count, not those of the sightings alone.

        A room is judged by all stays of a thing: where none has a position it is not judged.
        """
        placed = any(isinstance(step, FilterPlace) for step in self.steps)
        return (placed and var not in self.many) or var in self.rooms

    def doubtful(self) -> frozenset[str]:
        """Return the ids of what rather lacks the attributes asked for."""
        return frozenset().union(*(found.doubtful for found in self.found.values()))

    def standing(self, moments: Iterable[Moment]) -> Iterator[Moment]:
        """Yield the moments that are answers by themselves, not merely to be listed below others.

        Nothing in them is doubtful; or of several things with looks in a relation some are not,
        and the looks asked for hold for all at once not too seldom.
        """
        doubtful = self.doubtful()
        if not doubtful:
            return iter(moments)
        return (moment for moment in moments if self._stands(moment, doubtful))

    @staticmethod
    def _stands(moment: Moment, doubtful: frozenset[str]) -> bool:
        if doubtful.isdisjoint(moment.ids):
            return True
        judged = {e.sighting.object_id for e in moment.entries if e.candidate.attributes}
        looks = [p for entry in moment.entries for p in entry.candidate.attributes.values()]
        return not doubtful.issuperset(judged) and prod(looks) >= LEAST_TOGETHER

    def without_mere_doubts(self, moments: list[Moment]) -> list[Moment]:
        """Return the moments; none where all are doubtful: then who is doubtful is refused."""
        doubtful = self.doubtful()
        if not doubtful or next(self.standing(moments), None) is not None:
            return moments
        for found in self.found.values():
            found.refuse_doubtful()
        for sifted in (self.before_place, self.before_relation):
            for var, sightings in sifted.items():
                sifted[var] = [s for s in sightings if s.object_id not in doubtful]
        if self.moments is not None:
            self.moments = []
        return []

    def leave_out(self, condition: str) -> None:
        """Note a condition that this store cannot judge."""
        if condition not in self.unjudged:
            self.unjudged.append(condition)

    def var_of(self, entry: Entry) -> str:
        """Return the variable that an entry of a moment was found for."""
        name = entry.sighting.object_id
        tables = self.found.items()
        return next(var for var, t in tables if t.candidates.get(name) is entry.candidate)

    def term(self, var: str) -> ObjectTerm:
        """Return the object of the query behind a variable, `x.1` for what describes x."""
        name, *deeper = var.split(".")
        objects = self.query.objects or (ObjectTerm(ANYTHING),)
        term = next(term for term in objects if term.var == name)
        return [*term.chain()][len(deeper)]

    def relation_words(self, step: Relate | Unite, terms: Sequence[ObjectTerm]) -> str:
        """Return a relation as said: "on the desk"; among things of one kind its name alone."""
        if not terms:
            return step.kind
        kind = _WORDS.get(step.kind, step.kind)
        things = " and the ".join(" ".join((*term.attributes, term.word)) for term in terms)
        return f"{kind} the {things}"

    def find_landmarks(self) -> None:
        """Have the large static things at hand, where there is a keyframe to tell."""
        if self.ranked or self.otherwise is not None:
            self.landmarks = self.facts.landmarks(self.lexicon)

    def spot(self, entry: Entry) -> Spot:
        """Return where an entry was, as a person is told; worked out once a stay."""
        if entry.stay is None:
            return Spot()
        key = entry.stay.key
        if key not in self._spots:
            self.find_spots([entry])
        return self._spots[key]

    def find_spots(self, entries: Sequence[Entry]) -> None:
        """Work out where entries were, all at once."""
        spots = self.facts.spots(self.landmarks, self.parameters.near_m)
        ruled_out: dict[str, RuledOut] = {}
        fresh: dict[RuledOut, list[StayRecord]] = {}
        for entry in entries:
            if entry.stay is not None and entry.stay.key not in self._spots:
                own = entry.candidate.record.category
                if own not in ruled_out:
                    ruled_out[own] = spots.ruled_out(*self._never_landmarks(own))
                fresh.setdefault(ruled_out[own], []).append(entry.stay)
        for without, stays in fresh.items():
            self._spots |= spots.tell(stays, without)

    def _never_landmarks(self, own: str) -> tuple[frozenset[str], frozenset[str]]:
        """Return the ids and the categories that tell no place of a thing of a category.

        Never the thing itself, nor what it may be confused with: what else the figures of the
        question may be, or what is called as they or as the thing.
        """
        if self._not_landmarks is None:
            alone = self.query.objects if self.query.relation is None else self.query.objects[:1]
            figures = [term for term in alone if term.category != ANYTHING]
            confused = {name for term in figures for name in self.found[term.var].candidates}
            called = {self.lexicon.canonical(term.category) for term in figures}
            self._not_landmarks = frozenset(confused), frozenset(called)
        ids, kinds = self._not_landmarks
        return ids, kinds | {self.lexicon.canonical(own)}


def milliseconds(moment: datetime | None) -> int | None:
    """Return UTC milliseconds of an aware time, rounded to the nearest; None stays None."""
    return None if moment is None else round(moment.timestamp() * 1000)
