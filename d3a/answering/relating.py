"""Relations on a run: what was found for two variables or more is joined where it stood so."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement, count

from d3a.answering.bounded import find_stays_late, finds_stays_late, keep_since
from d3a.answering.gathering import Ties, gathered, of_two_things, scattered
from d3a.answering.joined import (
    between_moments,
    chain_moments,
    holders,
    pair_moments,
    without_relation,
)
from d3a.answering.joins import CARRIED, SYMMETRIC, Asked, Related
from d3a.answering.moments import Found, Moment, common_span
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import Gather, Relate
from d3a.store.base import Encounter


def relate_found(run: Run, step: Relate) -> None:
    """Join what was found for the variables of a step where its relation holds, or does not."""
    tables = [run.found[var] for var in step.vars]
    keep_since(run, tables)
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
    asked = [_asked(run, step, figure, ground, once=once) for ground in grounds]
    found = [_met(run, step, one) for one in asked]
    if not _is_told(step, figure, grounds, found):  # what no frame shows may have stood there
        found = [one.stood(met) for one, met in zip(asked, found, strict=True)]
    if not all(one.judged for one in found):
        _find_all_stays(run, figure)
        run.leave_out(run.relation_words(step, [run.term(var) for var in step.vars[1:]]))
        return
    run.before_relation[step.vars[0]] = list(figure.sightings)
    if step.keep == "figure":
        held = holders(found)
        wanted = {
            stay: 1 - held.get(stay, 0.0) if step.negated else held.get(stay, 0.0)
            for stay in figure.stays
        }
        figure.held |= wanted
        figure.sightings = [s for s in figure.sightings if wanted.get(s.stay, 0.0) >= 0.5]
    elif step.negated:
        run.moments = without_relation(figure, found, grounds)
    elif step.kind == "between":
        run.moments = between_moments(figure, grounds, found)
    else:
        run.moments = pair_moments(found[0], figure, grounds[0])
        for ground, related in zip(grounds[1:], found[1:], strict=True):
            more = pair_moments(related, figure, ground)
            run.moments = chain_moments(run.moments, more)
        if not run.moments:
            _find_all_stays(run, figure)


def _find_all_stays(run: Run, figure: Found) -> None:
    """Find where the figure was ever: it is told without the relation."""
    if finds_stays_late(run):
        figure.stays = run.facts.stays_of(figure.sightings)


def _is_told(
    step: Relate, figure: Found, grounds: Sequence[Found], found: Sequence[Related]
) -> bool:
    """Return whether the relation held anywhere by what was seen at once."""
    if step.kind == "between":
        return bool(between_moments(figure, grounds, found))
    return all(one.holds for one in found)


def _asked(run: Run, step: Relate | Gather, figure: Found, ground: Found, *, once: bool) -> Asked:
    return Asked(
        step.kind,
        figure,
        ground,
        run.parameters,
        once=once,
        usual=run.facts.usual_grounds(step.kind, run.lexicon),
        carriers=run.facts.carriers(run.lexicon) if step.kind in CARRIED else Found(),
    )


def _met(run: Run, step: Relate | Gather, asked: Asked) -> Related:
    figure, ground = asked.figure, asked.ground
    start, end = milliseconds(step.start), milliseconds(step.end)
    encounters: list[Encounter] = []
    if figure.sightings and ground.sightings:
        # a shared frame belongs to a sighting of either: those outside of all are not read
        first, last = common_span(figure.sightings, ground.sightings)
        encounters = run.store.encounters(
            object_ids=figure.ids,
            with_ids=ground.ids,
            start_ms=first if start is None else max(first, start),
            end_ms=last if end is None else min(last, end - 1),
        )
    if finds_stays_late(run):
        find_stays_late(run, figure, ground, encounters)
    return asked.met(encounters)


def gather(run: Run, step: Gather) -> None:
    """Find where so many things of each variable were together, each with each.

    What was together is told as so many; of the most that were together, as many as there were.
    """
    tables = [run.found[var] for var in step.vars]
    keep_since(run, tables)
    run.moments = []
    if not all(table.candidates for table in tables):
        return
    ties = Ties(tables)
    for one, other in combinations_with_replacement(range(len(tables)), 2):
        if one != other or step.numbers[one] > 1:
            asked = _asked(run, step, tables[one], tables[other], once=one == other)
            related = _met(run, step, asked)
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
