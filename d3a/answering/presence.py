"""What is so still: the newest moments that nothing seen since has ended.

"What is on the table?" asks for what was seen there last and was neither seen elsewhere since nor
missed there.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property

import numpy as np

from d3a.answering import columns
from d3a.answering.distinct import rounds_of
from d3a.answering.many import spans_asked
from d3a.answering.moments import Entry, Found, Moment, entry_of, single
from d3a.answering.run import Run
from d3a.answering.steps import KeepPresent
from d3a.rank import LEAST_OF_BEST
from d3a.store.base import Sighting
from grammar.forms import ANYTHING, ObjectTerm


def keep_present(run: Run, step: KeepPresent) -> None:
    """Keep what is so still; where neither place nor relation was judged there is no "still"."""
    table = run.found[step.var]
    before = run.before_place.get(step.var) or run.before_relation.get(step.var)
    if before is None and step.anywhere:
        before = list(table.sightings)
    if before is None:
        return
    others = (s for var, found in run.found.items() if var != step.var for s in found.sightings)
    newest = newest_of([*others, *before])
    kept, gone = present(run.answering(step.var), newest)
    term = run.term(step.var)
    if term.owner in ("me", "you"):  # one thing is meant: its newest likeness tells where it is
        last = _newest_likeness(table, newest, before)
        away = [m for m in kept if last is not None and m.figure.sighting.object_id != last]
        kept = [m for m in kept if m not in away]
        table.gone += [newest[last] for _ in away[:1] if last is not None and not kept]
    if not kept and step.var in run.newest_alone:
        gone += _left_before(run, step.var, newest)
    for moment in gone:
        sighting = moment.figure.sighting
        there = term.category == ANYTHING
        table.gone.append(sighting if there else newest[sighting.object_id])
    kept = [at_its_newest(moment, table, newest) for moment in kept]
    if step.anywhere:
        alike = _Alike(run, step.var, kept, before)  # the newest place counts
        kept = [moment for moment in kept if not alike.seen_since(moment)]
    else:
        kept = _doubted(run, term, table, kept, before)
    if run.moments is not None:
        run.moments = kept
    else:
        table.sightings = [moment.figure.sighting for moment in kept]


class _Alike:
    """What else of its kind was seen, so that it may be the same thing under another id."""

    def __init__(
        self, run: Run, var: str, kept: Sequence[Moment], before: Sequence[Sighting]
    ) -> None:
        table = run.found[var]
        kinds = {moment.figure.candidate.record.category for moment in kept}
        of = {name: c.record.category for name, c in table.candidates.items()}
        seen = [s for s in before if of.get(s.object_id) in kinds]
        self._unsure = {name for name, c in table.candidates.items() if c.record.tentative}
        self._newest, self._seen = newest_of(seen), seen
        self._first = first_of(seen)
        self._run, self._is_whole = run, var not in run.newest_alone
        if not self._is_whole:  # each object's newest sighting was found and no other
            self._first = first_of(run.store.edges([*self._newest], "first"))
        self._of_kind: dict[str, list[str]] = {}
        for name in self._newest:
            self._of_kind.setdefault(of[name], []).append(name)

    @cached_property
    def _shown(self) -> dict[str, set[int]]:
        """The rounds that showed each, by number: of many things they are seldom asked for."""
        if self._is_whole:
            return rounds_of(self._seen)
        spans = self._run.facts.spans(sorted(self._newest), None, None)
        shown: dict[str, set[int]] = {name: set() for name in spans.ids}
        numbers = columns.rounds_of(spans.start_ms, spans.end_ms).tolist()
        for of, number in zip(spans.of.tolist(), numbers, strict=True):
            shown[spans.ids[of]].add(number)
        return shown

    def turned_up(self, moment: Moment, besides: Collection[str]) -> list[Sighting]:
        """Return those that were first seen after the moment, each as it was seen last."""
        names = self._others(moment, besides)
        return [self._newest[n] for n in names if self._first[n].start_ms > moment.end_ms]

    def seen_since(self, moment: Moment) -> list[Sighting]:
        """Return those that were seen after the moment, and never in one round with its thing."""
        name = moment.figure.sighting.object_id
        others = [self._newest[other] for other in self._others(moment, ())]
        return [
            other
            for other in others
            if other.start_ms > moment.end_ms
            and self._shown[other.object_id].isdisjoint(self._shown[name])
        ]

    def _others(self, moment: Moment, besides: Collection[str]) -> list[str]:
        of_kind = self._of_kind[moment.figure.candidate.record.category]
        mine = moment.figure.sighting.object_id
        ruled_out = self._unsure.union(besides, (mine,))  # what may be a mistake doubts nothing
        return [name for name in of_kind if name not in ruled_out]


def _left_before(run: Run, var: str, newest: Mapping[str, Sighting]) -> list[Moment]:
    """Return the newest moment in the room of what was ever there, of things found by their newest.

    Of anything at all: what was there last, so many as are told.
    """
    table, spans = run.found[var], spans_asked(run, var)
    rows = columns.lasts(spans.of, [spans.end_ms, spans.start_ms])
    rows = rows[np.argsort(-spans.end_ms[rows], kind="stable")]
    if run.term(var).category != ANYTHING:
        known = [newest[spans.ids[of]] for of in spans.of[rows].tolist()]
        return [single(table, sighting) for sighting in known]
    told = run.store.sightings_at(spans.chosen(rows[: run.limit]).which())
    table.stays |= run.facts.stays_of(told)
    return [single(table, sighting) for sighting in told]


def _doubted(
    run: Run, term: ObjectTerm, table: Found, kept: list[Moment], before: Sequence[Sighting]
) -> list[Moment]:
    """Leave out of a list what may have moved under a new id; tell it of a thing asked for.

    Another of its category turned up elsewhere after it was seen last: it may be that one. So may
    any that was seen elsewhere since, and never in one round with it: of what is listed that is
    told apart, but for the large things that stay.
    """
    here = {moment.figure.sighting.object_id for moment in kept}
    alike = _Alike(run, term.var, kept, before)
    if term.category == ANYTHING:
        kept = [moment for moment in kept if not alike.turned_up(moment, here)]
        stay = run.facts.landmarks(run.lexicon) if kept else ()
        run.doubted = [
            moment
            for moment in kept
            if moment.figure.sighting.object_id not in stay and alike.seen_since(moment)
        ]
        return [moment for moment in kept if moment not in run.doubted] or kept
    doubts: list[list[Sighting]] = []
    for moment in kept:
        doubts.append([*alike.turned_up(moment, here), *alike.seen_since(moment)])
        if not doubts[-1]:  # one of them is there for certain
            break
    if doubts and all(doubts):
        best = max((s for each in doubts for s in each), key=lambda s: (s.end_ms, s.object_id))
        run.otherwise = single(table, best)
    return kept


def _newest_likeness(
    table: Found, newest: Mapping[str, Sighting], before: Sequence[Sighting]
) -> str | None:
    """Return the object seen last among those that are about as likely meant as the best."""
    ids = {s.object_id for s in before}
    worth = {
        name: c.match * math.prod(c.attributes.values())
        for name, c in table.candidates.items()
        if name in ids
    }
    least = LEAST_OF_BEST * max(worth.values(), default=0.0)
    likely = [name for name in sorted(worth) if worth[name] >= least]
    return max(likely, key=lambda name: (newest[name].end_ms, name), default=None)


def first_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that began first, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.start_ms, s.place), reverse=True)
    return {sighting.object_id: sighting for sighting in ordered}


def newest_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that ended last, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.end_ms, s.start_ms, s.place))
    return {sighting.object_id: sighting for sighting in ordered}


def present(
    moments: Sequence[Moment], newest: Mapping[str, Sighting]
) -> tuple[list[Moment], list[Moment]]:
    """Return the newest moment of each object that still holds, and of each that does not.

    newest: of every object of the moments, wherever it was. A moment no longer holds where one of
    its objects was seen at another place since, or where its place was then seen without it.
    """
    last: dict[str, Moment] = {}
    for moment in sorted(moments, key=lambda m: (m.end_ms, m.start_ms)):
        last[moment.figure.sighting.object_id] = moment
    kept: list[Moment] = []
    gone: list[Moment] = []
    for _, moment in sorted(last.items()):
        (kept if all(_is_still(e, newest) for e in moment.entries) else gone).append(moment)
    return kept, gone


def at_its_newest(moment: Moment, found: Found, newest: Mapping[str, Sighting]) -> Moment:
    """Return a moment that still holds with the newest sighting of its figure.

    A bowl that was seen on a table, and at the same spot since, was last seen there then.
    """
    sighting = newest[moment.figure.sighting.object_id]
    if sighting.end_ms <= moment.end_ms:
        return moment
    entries = (entry_of(found, sighting), *moment.entries[1:])
    return moment._replace(entries=entries, end_ms=sighting.end_ms)


def _is_still(entry: Entry, newest: Mapping[str, Sighting]) -> bool:
    stay, absent = entry.stay, entry.stay.last_absent_ms if entry.stay is not None else None
    if stay is not None and absent is not None and absent > stay.last_ms:
        return False
    return newest[entry.sighting.object_id].stay == entry.sighting.stay
