"""What is so still: the newest moments that nothing seen since has ended.

"What is on the table?" asks for what was seen there last and was neither seen elsewhere since nor
missed there. Of several things in a relation each is judged: where one of them left it holds no
longer, whichever was said first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from d3a.answering import columns
from d3a.answering.alike import Alike, newest_of
from d3a.answering.doubts import Doubts
from d3a.answering.likeness import at_newest_likeness
from d3a.answering.many import spans_asked
from d3a.answering.moments import Entry, Moment, entry_of, single
from d3a.answering.places import holders_of
from d3a.answering.run import Run
from d3a.answering.standing import Timeline
from d3a.answering.steps import KeepPresent
from d3a.store.base import Sighting
from grammar.forms import ANYTHING


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
    together = {id(moment) for moment in _in_one_room(run, kept)}
    gone += [moment for moment in kept if id(moment) not in together]
    kept = [moment for moment in kept if id(moment) in together]
    for var in step.known:
        kept = at_newest_likeness(run, var, kept, newest, before if var == step.var else None)
    if not kept and step.var in run.newest_alone and run.moments is None:
        gone += _left_before(run, step.var, newest)
    for moment in gone:
        _tell_gone(run, step.var, moment, newest)
    kept = at_their_newest(run, kept, newest)
    if step.anywhere:
        ids = {moment.figure.sighting.object_id for moment in kept}
        alike = Alike(run, step.var, ids, before)  # the newest place counts
        since = {id(m): alike.seen_since(m.figure.sighting.object_id, m.end_ms) for m in kept}
        kept = [m for m in kept if next(since[id(m)], None) is None]
    else:
        kept = Doubts(run, step.var, kept, before, newest).judged()
        kept += _seen_later(run, kept, gone)
    if run.moments is not None:
        run.moments = kept
    else:
        table.sightings = [moment.figure.sighting for moment in kept]


def _in_one_room(run: Run, moments: list[Moment]) -> list[Moment]:
    """Return the moments without those of things together that lie in different rooms.

    They were seen together, in a frame that shows one of them through a door. They are not.
    """
    relation, rooms = run.query.relation, run.facts.regions()
    if relation is None or relation.kind != "together" or relation.negated or not rooms:
        return moments
    stays = {e.stay.key: e.stay for m in moments for e in m.entries if e.stay is not None}
    holding = holders_of(rooms, [(stay.position, stay.site) for stay in stays.values()])
    named = {key: {room.name for room in of} for key, of in zip(stays, holding, strict=True)}
    out: list[Moment] = []
    for moment in moments:
        of = [named[e.stay.key] for e in moment.entries if e.stay is not None]
        known = [names for names in of if names]  # what is in no room may be open to any
        if not known or set[str].intersection(*known):
            out.append(moment)
    return out


def _seen_later(run: Run, kept: Sequence[Moment], gone: Sequence[Moment]) -> list[Moment]:
    """Return the newest moment that is over, where of a yes or no none holds for certain.

    When it was last so is told then, of whichever it was; only what holds may be so still.
    """
    if not kept or run.otherwise is None or run.query.ask != "whether":
        return []
    last_ms = max(moment.end_ms for moment in kept)
    later = [moment for moment in gone if moment.end_ms > last_ms]
    return [max(later, key=lambda m: (m.end_ms, m.ids))] if later else []


def _tell_gone(run: Run, var: str, moment: Moment, newest: Mapping[str, Sighting]) -> None:
    """Note where that is now which left: the figure, or what it stood in the relation to."""
    sighting = moment.figure.sighting
    if run.term(var).category == ANYTHING:
        run.found[var].gone.append(sighting)
        return
    left = next((e for e in moment.entries if not _is_still(e, newest)), moment.figure)
    run.found[run.var_of(left)].gone.append(newest[left.sighting.object_id])


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


def present(
    moments: Sequence[Moment], newest: Mapping[str, Sighting]
) -> tuple[list[Moment], list[Moment]]:
    """Return the newest moment of the same objects that still holds, and of those that do not.

    newest: of every object of the moments, wherever it was. A moment no longer holds where one of
    its objects was seen at another place since, or where its place was then seen without it. Of a
    figure of which none holds, the newest alone.
    """
    last: dict[tuple[str, ...], Moment] = {}
    for moment in sorted(moments, key=lambda m: (m.end_ms, m.start_ms)):
        last[moment.ids] = moment
    kept: list[Moment] = []
    gone: dict[str, Moment] = {}
    for _, moment in sorted(last.items()):
        if all(_is_still(e, newest) for e in moment.entries):
            kept.append(moment)
        else:
            figure = moment.figure.sighting.object_id
            gone[figure] = max(moment, gone.get(figure, moment), key=lambda m: m.end_ms)
    there = {moment.figure.sighting.object_id for moment in kept}
    return kept, [moment for figure, moment in gone.items() if figure not in there]


def at_their_newest(
    run: Run, moments: Sequence[Moment], newest: Mapping[str, Sighting]
) -> list[Moment]:
    """Return moments that still hold as they were seen last, all of their objects.

    A bowl that was seen on a table, and at the same spot since, was last seen there then. What a
    thing that is carried lies on, or under, is so as far as that was seen; what stays is no bound.
    """
    settled = run.facts.carriers(run.lexicon).stays if moments else {}
    out: list[Moment] = []
    for moment in moments:
        loose = [e for e in moment.entries if e.sighting.stay not in settled]
        last = min(
            (newest[e.sighting.object_id] for e in loose or moment.entries[:1]),
            key=lambda s: s.end_ms,
        )
        if last.end_ms <= moment.end_ms:
            out.append(moment)
            continue
        entries = [_at(run, entry, last, newest) for entry in moment.entries]
        out.append(moment._replace(entries=tuple(entries), end_ms=last.end_ms))
    return out


def _at(run: Run, entry: Entry, last: Sighting, newest: Mapping[str, Sighting]) -> Entry:
    """Return an entry as it was seen nearest in time to a sighting of another of its moment."""
    sighting = newest[entry.sighting.object_id]
    table = run.found[run.var_of(entry)]
    if sighting.end_ms > last.end_ms:
        stay = entry.sighting.stay
        sighting = Timeline(table, {stay}).nearest(stay, last)
    return entry_of(table, sighting)


def _is_still(entry: Entry, newest: Mapping[str, Sighting]) -> bool:
    stay, absent = entry.stay, entry.stay.last_absent_ms if entry.stay is not None else None
    if stay is not None and absent is not None and absent > stay.last_ms:
        return False
    return newest[entry.sighting.object_id].stay == entry.sighting.stay
