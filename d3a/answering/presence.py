"""What is so still: the newest moments that nothing seen since has ended.

"What is on the table?" asks for what was seen there last and was neither seen elsewhere since nor
missed there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from d3a.answering.distinct import rounds_of
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
    for moment in gone:
        sighting = moment.figure.sighting
        there = term.category == ANYTHING
        table.gone.append(sighting if there else newest[sighting.object_id])
    kept = [at_its_newest(moment, table, newest) for moment in kept]
    if step.anywhere:
        kept = _each_thing_once(table, kept, before)
    else:
        kept = _doubted(run, term, table, kept, before)
    if run.moments is not None:
        run.moments = kept
    else:
        table.sightings = [moment.figure.sighting for moment in kept]


def _each_thing_once(
    table: Found, kept: Sequence[Moment], before: Sequence[Sighting]
) -> list[Moment]:
    """Leave out what may have been seen since under a new id: the newest place counts."""
    shown, newest = rounds_of(before), newest_of(before)

    def is_later(name: str, moment: Moment) -> bool:
        mine = moment.figure.candidate.record
        return (
            table.candidates[name].record.category == mine.category
            and newest[name].start_ms > moment.end_ms
            and shown[name].isdisjoint(shown[mine.object_id])
        )

    return [moment for moment in kept if not any(is_later(name, moment) for name in newest)]


def _doubted(
    run: Run, term: ObjectTerm, table: Found, kept: list[Moment], before: Sequence[Sighting]
) -> list[Moment]:
    """Leave out of a list what may have moved under a new id; tell it of a thing asked for.

    Another of its category turned up elsewhere after it was seen last: it may be that one. So may
    any that is asked for, was seen elsewhere since, and never in one round with it.
    """
    here = {moment.figure.sighting.object_id for moment in kept}
    first: dict[str, Sighting] = {}
    for sighting in sorted(before, key=lambda s: (s.start_ms, s.object_id, s.place)):
        first.setdefault(sighting.object_id, sighting)
    newest = newest_of(before)

    is_any = term.category == ANYTHING
    shown = rounds_of(before) if term.attributes or not is_any else {}

    def is_alike(moment: Moment, name: str) -> bool:
        mine = moment.figure.sighting.object_id
        return (
            bool(shown)
            and newest[name].start_ms > moment.end_ms
            and shown[name].isdisjoint(shown[mine])
        )

    def later(moment: Moment) -> list[Sighting]:
        kind = moment.figure.candidate.record.category
        return [
            newest[name]
            for name, sighting in first.items()
            if name not in here
            and table.candidates[name].record.category == kind
            and (sighting.start_ms > moment.end_ms or is_alike(moment, name))
        ]

    if is_any:
        return [moment for moment in kept if not later(moment)]
    doubts = [later(moment) for moment in kept]
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
