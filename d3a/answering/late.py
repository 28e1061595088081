"""Relations over thousands of sightings: joined as columns, and as records what is told alone.

How long, how often or how many of a thing were with another is counted over all that was ever seen
of both. When and where they were tells it; of the meetings the fifty that are told are read.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.answering.bounded import AS_GOOD, READ_A_KEYFRAME, find_joined, slice_of, worth_of
from d3a.answering.columns import Ints
from d3a.answering.facts import MOST_WHOLE
from d3a.answering.gathering import Ties, gathered, of_two_things
from d3a.answering.joined import pair_moments
from d3a.answering.joins import Asked, Related
from d3a.answering.linked import Link
from d3a.answering.many import chosen_rows, filter_place, place_stays, spans_asked
from d3a.answering.meetings import ENCOUNTER, Meetings, Side, cores, likely, met, together
from d3a.answering.moments import Found, joined
from d3a.answering.pairs import Floats
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import FilterPlace, FindSightings, Gather, Relate
from d3a.rank import LEAST_OF_BEST
from d3a.store.base import Encounter, Sighting, Spans


def tell_together(run: Run, step: Relate) -> bool:
    """Find when two things were together; False where they never were, or nothing tells it."""
    one, other = (side_of(run, var) for var in step.vars)
    figure, ground = (run.found[var] for var in step.vars)
    encounters = encounters_of(run, one, other)
    found, held = _together(run, step, one, other, encounters)
    rows = likely(held)
    found, held = found.at(rows), held[rows]
    if not len(found):
        return False
    of, place = one.places.of[found.figure], one.places.place[found.figure]
    seen = _shown(one, found)
    run.spans[step.vars[0]] = Spans(one.spans.ids, of, place, *seen)
    run.so[step.vars[0]] = Spans(one.spans.ids, of, place, found.start_ms, found.end_ms)
    rows = _chosen(run, one, other, found, (_worth(figure, one), _worth(ground, other)))
    run.cut = run.cut or len(rows) < len(found)
    links = _links(run, one, other, found.at(rows), encounters)
    for table, side in ((figure, 0), (ground, 1)):
        table.stays = run.facts.stays_of([link.seen()[side] for link in links])
    place_stays(run, step.vars[0])
    run.moments = pair_moments(Related(links, held[rows]), figure, ground, ())
    return True


def gather_most(run: Run, step: Gather) -> bool:
    """Find the most of one kind that were together at once; False where no two were."""
    (var,) = step.vars
    table, side = run.found[var], side_of(run, var)
    encounters = encounters_of(run, side, side)
    found, held = _together(run, step, side, side, encounters)
    dense = cores(found.at(likely(held)), len(side.places))
    for number, among in reversed([*enumerate(dense, 2)][step.numbers[0] - 2 :]):
        links = _links(run, side, side, among, encounters)
        table.stays = run.facts.stays_of([seen for link in links for seen in link.seen()])
        place_stays(run, var)
        asked = Asked(step.kind, table, table, run.parameters, once=True)
        ties = Ties([table])
        ties.add(0, 0, of_two_things(asked.judged(links), table, run.parameters))
        if moments := gathered(ties, (number,)):
            run.moments, run.figures = moments, number
            return True
    return False


def find_after_all(run: Run) -> None:
    """Find all that was left to be joined as columns, and was not."""
    for step in run.steps:
        if isinstance(step, FindSightings) and step.var in run.late:
            find_joined(run, step)
            table = run.found[step.var]
            table.stood = None
            table.stays = run.facts.stays_of(table.sightings, whole=run.needs_stays(step.var))
    for step in run.steps:
        if isinstance(step, FilterPlace) and step.var in run.late:
            filter_place(run, step)
    run.late.clear()


def side_of(run: Run, var: str) -> Side:
    """Return all that was seen of a variable's things where they are asked for, as columns."""
    ids = run.found[var].ids
    return Side.of(spans_asked(run, var, *slice_of(run, var)), run.facts.positions(ids))


def _together(
    run: Run, step: Relate | Gather, one: Side, other: Side, encounters: Sequence[Encounter]
) -> tuple[Meetings, Floats]:
    """Return where two sides met in the slice of a step, and how likely they were together."""
    found = met(one, other, encounters, run.parameters.together_m, once=True)
    start, end = milliseconds(step.start), milliseconds(step.end)
    if end is not None:
        found = found.at(found.start_ms < end)
    if start is not None:
        found = found.at(found.end_ms >= start)
    return found, together(one, other, found, run.parameters)


def encounters_of(run: Run, one: Side, other: Side) -> list[Encounter]:
    """Return the shared frames of two sides while both were seen."""
    if not len(one.spans) or not len(other.spans):
        return []
    first = max(int(side.spans.start_ms.min()) for side in (one, other))
    last = min(int(side.spans.end_ms.max()) for side in (one, other))
    return run.store.encounters(
        object_ids=one.spans.ids, with_ids=other.spans.ids, start_ms=first, end_ms=last
    )


def _chosen(
    run: Run, one: Side, other: Side, found: Meetings, worth: Sequence[Floats]
) -> NDArray[np.intp]:
    """Return the meetings that are told: all where they are few, else of the likeliest the newest.

    worth: of the objects of either side.
    """
    if len(found) <= MOST_WHOLE:
        return np.arange(len(found))
    own, its = one.places.of[found.figure], other.places.of[found.ground]
    both, of = np.unique(own * len(other.places.ids) + its, return_inverse=True)
    left, right = np.divmod(both, len(other.places.ids))
    place = found.figure * len(other.places) + found.ground
    pairs = Spans((), of, place, found.start_ms, found.end_ms)
    shares = (AS_GOOD, LEAST_OF_BEST) if run.query.select == "all" else (LEAST_OF_BEST,)
    most, oldest = READ_A_KEYFRAME * run.limit, run.query.select == "first"
    rows = chosen_rows(pairs, worth[0][left] * worth[1][right], shares, most, oldest=oldest)
    return np.sort(rows)


def _worth(table: Found, side: Side) -> Floats:
    return np.array([worth_of(table.candidates[name]) for name in side.spans.ids])


def _shown(side: Side, found: Meetings) -> tuple[Ints, Ints]:
    """Return from when to when the figure of each meeting was seen (n,), (n,)."""
    start, end, apart = found.start_ms.copy(), found.end_ms.copy(), found.apart
    start[apart] = side.spans.start_ms[found.own[apart]]
    end[apart] = side.spans.end_ms[found.own[apart]]
    return start, end


def _links(
    run: Run, one: Side, other: Side, found: Meetings, encounters: Sequence[Encounter]
) -> list[Link]:
    """Return meetings as links, with what tells of each: the shared frame, or two sightings."""
    apart = found.apart
    ones, others = (
        _read(run, side, rows[apart]) for side, rows in ((one, found.own), (other, found.other))
    )
    figures, grounds = one.stays(found.figure), other.stays(found.ground)
    out: list[Link] = []
    columns_of = (found.start_ms, found.end_ms, found.own, found.other)
    rows = zip(figures, grounds, *(each.tolist() for each in columns_of), strict=True)
    for figure, ground, start, end, own, its in rows:
        if own == ENCOUNTER:
            e = encounters[its]
            out.append(Link(figure, ground, start, end, e, figure != (e.object_a, e.place_a)))
        else:
            out.append(Link(figure, ground, start, end, sightings=(ones[own], others[its])))
    return out


def _read(run: Run, side: Side, rows: Ints) -> dict[int, Sighting]:
    """Return the sightings in some rows of a side, by row."""
    rows = np.unique(rows)
    known = {(*s.stay, s.start_ms): s for s in joined(run.store.sightings_at(side.which(rows)))}
    names = side.spans.chosen(rows).which()
    return {row: known[name] for row, name in zip(rows.tolist(), names, strict=True)}
