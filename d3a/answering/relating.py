"""Relations on a run: what was found for two variables or more is joined where it stood so."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from itertools import combinations_with_replacement, count

from d3a.answering.alike import newest_of
from d3a.answering.bounded import finds_stays_late, keep_reached
from d3a.answering.gathering import Ties, gathered, of_two_things, scattered
from d3a.answering.joined import (
    between_moments,
    chain_moments,
    holders,
    not_between,
    pair_moments,
    without_relation,
)
from d3a.answering.joins import (
    CARRIED,
    GROUNDED,
    HOLDS,
    STANDING,
    SYMMETRIC,
    Asked,
    Related,
    meeting,
)
from d3a.answering.late import find_after_all, gather_most, tell_together
from d3a.answering.linked import Link
from d3a.answering.moments import Found, Moment, common_span, in_slice
from d3a.answering.narrowed import find_narrowly
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import FindEdge, FindSightings, Gather, KeepPresent, Relate
from d3a.store.base import Encounter, Sighting, Spans, StayKey


def relate_found(run: Run, step: Relate) -> None:
    """Join what was found for the variables of a step where its relation holds, or does not."""
    if run.late:
        if tell_together(run, step) if step.kind == "together" else _related_narrowly(run, step):
            return
        find_after_all(run)
    _relate_read(run, step)


def _related_narrowly(run: Run, step: Relate) -> bool:
    """Join what may stand in the relation; False where none does: why not, all that is tells."""
    find_narrowly(run, step)
    _relate_read(run, step)
    if not run.moments:
        run.moments = None
        return False
    var = step.vars[0]
    if any(isinstance(each, KeepPresent) for each in run.steps):
        run.before_relation[var] = [*newest_of(run.found[var].sightings).values()]
        run.newest_alone |= {*step.vars}
    rows = [(*m.figure.sighting.stay, m.start_ms, m.end_ms) for m in run.moments]
    so = [(name, start, end, place) for name, place, start, end in rows]
    run.so[var] = Spans.of_rows(run.found[var].ids, so)
    return True


def _relate_read(run: Run, step: Relate) -> None:
    """Join what was read for the variables of a step."""
    tables = [run.found[var] for var in step.vars]
    keep_reached(run, tables)
    figure, grounds = tables[0], tables[1:]
    absent = [i for i, ground in enumerate(grounds) if not ground.candidates]
    if absent and step.kind != "together":
        # a surface that no detector knows: the figure is told without it
        run.leave_out(run.relation_words(step, [run.term(step.vars[i + 1]) for i in absent]))
        return
    if not figure.candidates or (absent and not step.negated):
        run.moments = []
        if step.keep == "figure":  # no sighting of it is left for the relations that follow
            figure.sightings = []
        return
    if absent:  # nothing was ever seen that it could have been with
        return
    # each pair once is enough, but where it is asked of either whether the relation held
    once = step.kind in SYMMETRIC and step.keep == "moments" and not step.negated
    if step.kind in STANDING | {"between"}:
        for var, table in zip(step.vars, tables, strict=True):
            _know_elsewhere(run, var, table)
    found = [_related(run, step, figure, ground, once=once) for ground in grounds]
    if not all(one.judged for one in found):
        _find_all_stays(run, figure)
        run.leave_out(run.relation_words(step, [run.term(var) for var in step.vars[1:]]))
        return
    run.before_relation[step.vars[0]] = list(figure.sightings)
    if step.keep == "figure":
        _keep_holders(figure, holders(found), negated=step.negated)
        return
    moments = _moments(step, figure, grounds, found, _settled(run, step, tables, found))
    run.moments = [moment for moment in moments if _meets(step, moment)]
    if not run.moments and not step.negated and step.kind != "between":
        _find_all_stays(run, figure)


def _settled(
    run: Run, step: Relate, tables: Sequence[Found], found: Sequence[Related]
) -> Collection[StayKey]:
    """Return the stays of what is not carried: it was there though it was not seen.

    Things in one place need not have been there at one time: of any of them the place is enough.
    """
    if not any(link.standing for related in found for link in related.links):
        return ()
    if step.kind == "same_place":
        return {stay for table in tables for stay in table.stays}
    return run.facts.carriers(run.lexicon).stays.keys()


def _moments(
    step: Relate,
    figure: Found,
    grounds: Sequence[Found],
    found: Sequence[Related],
    settled: Collection[StayKey],
) -> list[Moment]:
    """Return when the relation held of the figure and a thing of each ground, or did not."""
    if step.kind == "between":
        held = between_moments(figure, grounds, found, settled)
        return not_between(figure, held) if step.negated else held
    if step.negated:
        return without_relation(figure, found, grounds)
    moments = pair_moments(found[0], figure, grounds[0], settled)
    for ground, related in zip(grounds[1:], found[1:], strict=True):
        moments = chain_moments(moments, pair_moments(related, figure, ground, settled))
    return moments


def _meets(step: Relate | Gather, told: Moment | Link) -> bool:
    """Whether what is told meets the slice: what was seen in it may have been so before alone."""
    return in_slice(told, milliseconds(step.start), milliseconds(step.end))


def _keep_holders(figure: Found, held: Mapping[StayKey, float], *, negated: bool) -> None:
    """Keep the sightings of stays for which a relation that describes the figure ever held."""
    wanted = {
        stay: 1 - held.get(stay, 0.0) if negated else held.get(stay, 0.0) for stay in figure.stays
    }
    figure.held |= wanted
    figure.sightings = [s for s in figure.sightings if wanted.get(s.stay, 0.0) >= HOLDS]


def _find_all_stays(run: Run, figure: Found) -> None:
    """Find where the figure was ever: it is told without the relation."""
    if finds_stays_late(run):
        figure.stays = run.facts.stays_of(figure.sightings)


def _know_elsewhere(run: Run, var: str, table: Found) -> None:
    """Find where things were around the slice that their sightings were found in.

    What stood at its place before and after it stood there in between; what was found and sifted
    since, by a room or another relation, tells where things were as well.
    """
    sifted = (*run.before_place.get(var, ()), *run.before_relation.get(var, ()))
    asked = {(s.stay, s.start_ms) for s in table.sightings}
    known = {(s.stay, s.start_ms): s for s in sifted}
    table.elsewhere = [s for name, s in known.items() if name not in asked]
    step = next(s for s in run.steps if isinstance(s, FindSightings | FindEdge) and s.var == var)
    if isinstance(step, FindEdge):
        return
    start, end = milliseconds(step.start), milliseconds(step.end)
    newest = run.facts.last_view_ms()
    around: list[Sighting] = []
    if start is not None:
        around += run.store.edges(table.ids, "last", before_ms=start)
    if end is not None and newest is not None and end <= newest:
        around += run.store.edges(table.ids, "first", after_ms=end)
    around = [s for s in around if not in_slice(s, start, end)]
    table.elsewhere += around
    unplaced = [s for s in around if s.stay not in table.stays]
    through = [s for s, n in Counter(s.stay for s in unplaced).items() if n > 1]
    if through:
        table.stays |= run.facts.stays_of([s for s in unplaced if s.stay in through])


def _related(
    run: Run, step: Relate | Gather, figure: Found, ground: Found, *, once: bool
) -> Related:
    asked = Asked(
        step.kind,
        figure,
        ground,
        run.parameters,
        once=once,
        usual={kind: run.facts.usual_grounds(kind, run.lexicon) for kind in GROUNDED},
        carriers=run.facts.carriers(run.lexicon) if step.kind in CARRIED else Found(),
        rooms=run.facts.regions(),
    )
    encounters: list[Encounter] = []
    if figure.sightings and ground.sightings:
        # a shared frame belongs to a sighting of either: those outside of all are not read
        first, last = common_span(figure.sightings, ground.sightings)
        encounters = run.store.encounters(
            object_ids=figure.ids, with_ids=ground.ids, start_ms=first, end_ms=last
        )
    if finds_stays_late(run):
        _find_stays_late(run, figure, ground, encounters)
    links = asked.links(encounters)
    if step.kind != "between":
        links = [link for link in links if link.standing or _meets(step, link)]
    beside: list[Encounter] = []
    if links and step.kind != "together" and _is_of_some_time(run):
        beside = run.store.encounters(
            object_ids=sorted({link.figure[0] for link in links}),
            with_ids=sorted({link.ground[0] for link in links}),
        )
    return asked.judged(links, beside)


def _find_stays_late(
    run: Run, figure: Found, ground: Found, encounters: Sequence[Encounter]
) -> None:
    """Find the stays of those sightings that may meet."""
    met = meeting(figure.sightings, ground.sightings, encounters)
    for table, sightings in zip((figure, ground), met, strict=True):
        table.stays = run.facts.stays_of(sightings)


def _is_of_some_time(run: Run) -> bool:
    """Whether not all that was seen of things was found: the query is of a time."""
    return any(
        isinstance(step, FindEdge)
        or (isinstance(step, FindSightings) and (step.start or step.end) is not None)
        for step in run.steps
    )


def gather(run: Run, step: Gather) -> None:
    """Find where so many things of each variable were together, each with each.

    What was together is told as so many; of the most that were together, as many as there were.
    """
    if run.late:
        if gather_most(run, step):
            return
        find_after_all(run)
    tables = [run.found[var] for var in step.vars]
    keep_reached(run, tables)
    run.moments = []
    if not all(table.candidates for table in tables):
        return
    ties = Ties(tables)
    for one, other in combinations_with_replacement(range(len(tables)), 2):
        if one != other or step.numbers[one] > 1:
            related = _related(run, step, tables[one], tables[other], once=one == other)
            if not related.judged:
                run.moments = None
                run.leave_out("together")
                return
            if one == other:
                related = of_two_things(related, tables[one], run.parameters)
            ties.add(one, other, related)
    run.before_relation[step.vars[0]] = list(tables[0].sightings)
    if step.negated:
        run.moments = scattered(ties, step.numbers, tables[0])
        return
    run.moments, run.figures = gathered(ties, step.numbers), step.numbers[0]
    more: Sequence[Moment] = run.moments
    for number in count(run.figures + 1) if step.most else ():
        more = gathered(ties, (number, *step.numbers[1:])) if more else ()
        if not more:
            break
        run.moments, run.figures = [*more], number
