"""Questions over thousands of sightings: read as columns, and as records what is told alone.

A home of months holds hundreds of thousands of sightings. Whatever is counted, summed or compared
over all of them needs when and where they were and no more; the fifty that are told are chosen
from that, and read. What was cut is said (`truncated`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.answering.bounded import AS_GOOD, READ_A_KEYFRAME, worth_of
from d3a.answering.columns import lasts, stay_of
from d3a.answering.facts import MOST_WHOLE
from d3a.answering.moments import joined
from d3a.answering.places import Rooms, box_of, is_box
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import (
    FilterPlace,
    FindSightings,
    Gather,
    KeepMissing,
    KeepMoved,
    KeepOften,
    KeepPresent,
    KeepUsual,
    Relate,
)
from d3a.rank import LEAST_OF_BEST
from d3a.store.base import Spans, StayRecord


def find_many(run: Run, step: FindSightings) -> bool:
    """Find the sightings of a step as columns where they are many; False where they are few.

    Nothing but the object, a place and a time narrows them: what stands in a relation is joined.
    """
    table, ids = run.found[step.var], run.found[step.var].ids
    place = _place(run, step.var)
    kept = {type(one): one for one in run.steps}
    if not _is_plain(run, step.var):
        return False
    start, end = milliseconds(step.start), milliseconds(step.end)
    last = None if end is None else end - 1
    rooms = asked_rooms(run, step.var)
    is_there = KeepPresent in kept and rooms is not None
    if (is_there and not start is end is None) or not run.facts.are_many(ids, start, last):
        return False
    run.many.add(step.var)
    if is_there or (KeepMissing in kept and place is None):
        table.sightings = run.facts.last_of(ids)
        run.newest_alone.add(step.var)
        return True
    moved = kept.get(KeepMoved)
    if isinstance(moved, KeepMoved):
        if rooms is not None and not len(spans_asked(run, step.var)):
            run.many.discard(step.var)
            return False  # whether the room can be judged, all stays tell
        run.spans[step.var] = moved_spans(run, ids, moved)
        return True
    spans = spans_asked(run, step.var, start, last)
    run.spans[step.var] = spans
    if kept.keys().isdisjoint((KeepUsual, KeepOften, KeepMissing)):
        _choose(run, step, spans)
    if not len(spans):  # what was elsewhere then is told instead
        most = READ_A_KEYFRAME * run.limit
        table.sightings = joined(run.facts.newest(ids, most, start, end))
    return True


def spans_asked(
    run: Run, var: str, start_ms: int | None = None, last_ms: int | None = None
) -> Spans:
    """Return when the objects of a variable were seen within the closed [start, last].

    In the rooms that they are asked for in, where somebody defined them: more likely than not.
    """
    rooms, ids = asked_rooms(run, var), run.found[var].ids
    if rooms is None:
        return run.facts.spans(ids, start_ms, last_ms)
    if rooms.one is not None and is_box(rooms.one):
        inside = run.facts.spans(ids, start_ms, last_ms, box_of(rooms.one))
        if len(inside):
            return inside
    spans, positions = run.facts.spans(ids, start_ms, last_ms), run.facts.positions(ids)
    if np.isnan(positions.x).all():  # no room is judged
        run.unplaced.add(var)
        return spans
    return spans.chosen(rooms.probability(positions)[positions.rows_of(spans)] >= 0.5)


def moved_spans(run: Run, ids: Sequence[str], step: KeepMoved) -> Spans:
    """Return when objects were seen in the slice of a step, and the last time before it."""
    start, end = milliseconds(step.start), milliseconds(step.end)
    within = run.facts.spans(ids, start, None if end is None else end - 1)
    if start is None:
        return within
    before = Spans.of_sightings(ids, run.store.edges(ids, "last", before_ms=start - 1))
    both = Spans(
        within.ids,
        *(
            np.concatenate([getattr(before, name), getattr(within, name)])
            for name in ("of", "place", "start_ms", "end_ms")
        ),
    )
    _, first = np.unique(np.stack([both.of, both.start_ms, both.place]), axis=1, return_index=True)
    return both.chosen(first)


def chosen_rows(
    spans: Spans, worth: NDArray[np.float64], shares: Sequence[float], most: int, *, oldest: bool
) -> NDArray[np.intp]:
    """Return at most `most` rows: of the likeliest objects, the newest (or oldest) of each stay.

    worth: of each of the ids. shares: of the best worth, where what is less likely comes later.
    Where there are fewer stays than `most`, their other sightings follow.
    """
    tier = np.sum(worth[:, None] < np.array(shares) * worth.max(initial=0.0), axis=1)
    start = spans.start_ms if oldest else -spans.start_ms
    again = np.ones(len(spans), dtype=np.int64)
    again[lasts(stay_of(spans), [-start, -spans.end_ms if oldest else spans.end_ms])] = 0
    order = np.lexsort((spans.place, spans.of, start, tier[spans.of], again))
    return np.asarray(order[:most])


def _choose(run: Run, step: FindSightings, spans: Spans) -> None:
    """Find the sightings that are told; all of them where they are few after all."""
    table, query = run.found[step.var], run.query
    rows = np.arange(len(spans))
    if len(spans) > MOST_WHOLE:
        worth = np.array([worth_of(table.candidates[name]) for name in spans.ids])
        shares = (AS_GOOD, LEAST_OF_BEST) if query.select == "all" else (LEAST_OF_BEST,)
        most, oldest = READ_A_KEYFRAME * run.limit, query.select == "first"
        rows = chosen_rows(spans, worth, shares, most, oldest=oldest)
        run.cut = run.cut or len(rows) < len(spans)
    else:
        del run.spans[step.var]
    table.sightings = joined(run.store.sightings_at(spans.chosen(rows).which()))


def filter_place(run: Run, step: FilterPlace) -> None:
    """Keep what was found in the rooms of a step, or outside of them, if these can be judged."""
    rooms, table = run.rooms_of(step), run.found[step.var]
    stays = sorted(table.stays.values(), key=lambda stay: stay.key)
    if _are_unplaced(run, step.var, stays):
        rooms = None
    for name in (step.place, *step.others):
        if rooms is None or run.region(name) is None:
            run.leave_out(f"in the {name}")
    if rooms is None:
        return
    run.before_place[step.var] = list(table.sightings)
    for stay, p in zip(stays, rooms.holding(stays).tolist(), strict=True):
        if p == p:  # a stay without a position is in no room: it cannot be told
            table.place[stay.key] = p
    table.sightings = [s for s in table.sightings if table.place.get(s.stay, 0.0) >= 0.5]


def _are_unplaced(run: Run, var: str, stays: Sequence[StayRecord]) -> bool:
    """Whether nobody knows where any of a variable's things was: no room is judged then."""
    if not stays or any(stay.position is not None for stay in stays):
        return var in run.unplaced
    return var not in run.many or bool(np.isnan(run.facts.positions(run.found[var].ids).x).all())


def place_stays(run: Run, var: str) -> None:
    """Note how likely the stays that were found lie in the asked rooms."""
    rooms, table = asked_rooms(run, var), run.found[var]
    if rooms is None:
        return
    stays = sorted(table.stays.values(), key=lambda stay: stay.key)
    for stay, p in zip(stays, rooms.holding(stays).tolist(), strict=True):
        if p == p:  # a stay without a position is in no room: it cannot be told
            table.place[stay.key] = p


def note_elsewhere(run: Run, var: str) -> None:
    """Note where things were last that are asked for in rooms and were not so there."""
    if asked_rooms(run, var) is not None and not run.before_place.get(var):
        run.before_place[var] = run.store.edges(run.found[var].ids, "last")
        run.found[var].stays |= run.facts.stays_of(run.before_place[var])


def asked_rooms(run: Run, var: str) -> Rooms | None:
    """Return the rooms that the variable is asked in, None where none are that can be judged."""
    place = _place(run, var)
    return None if place is None else run.rooms_of(place)


def _place(run: Run, var: str) -> FilterPlace | None:
    steps = (step for step in run.steps if isinstance(step, FilterPlace) and step.var == var)
    return next(steps, None)


def _is_plain(run: Run, var: str) -> bool:
    """Whether the variable stands in no relation, and its noun names no room."""
    joins = any(isinstance(s, Relate | Gather) for s in run.steps)
    joins = joins or any(isinstance(s, KeepPresent) and s.anywhere for s in run.steps)
    return not joins and "." not in var and var not in run.rooms
