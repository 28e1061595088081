"""How often a thing was somewhere: the share of the looks there that showed it."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter
from typing import TypeVar

import numpy as np

from d3a.answering import columns
from d3a.answering.changes import Slice, held_by, read_best, shared
from d3a.answering.distinct import rounds
from d3a.answering.many import note_elsewhere
from d3a.answering.moments import Moment
from d3a.answering.run import Run
from d3a.answering.steps import KeepOften

T = TypeVar("T")


def often(run: Run, step: KeepOften) -> list[Moment]:
    """Return the newest moment of each thing with the share of the looks that showed it so.

    A look is a round in which the ground was seen, or in the asked place anything at all. Things of
    one category that were never there in one look count together: a cup was there each time.
    """
    if step.var in run.spans:
        return _of_many(run, step)
    when, moments = Slice.of(step), run.answering(step.var)
    moments = [m for m in moments if when.holds(m.start_ms) or when.holds(m.end_ms)]
    ground = run.found[step.ground or step.var].sightings
    ground = [s for s in ground if when.holds(s.start_ms) or when.holds(s.end_ms)]
    ground = ground or [moment.figure.sighting for moment in moments]  # a ground nobody knows
    looks = [(one[0].start_ms, max(s.end_ms for s in one)) for one in rounds(ground)]
    of: dict[str, list[Moment]] = {}
    for moment in sorted(moments, key=lambda m: (m.end_ms, m.start_ms)):
        of.setdefault(moment.figure.sighting.object_id, []).append(moment)
    shown = (
        (name, {k for m in so for k in looks_at(looks, m.start_ms, m.end_ms)}, so[-1])
        for name, so in of.items()
    )
    things = _together(run, step.var, shown, lambda moment: moment.end_ms)
    return [moment._replace(share=len(own) / len(looks)) for own, moment in things]


def _of_many(run: Run, step: KeepOften) -> list[Moment]:
    """Return what `often` does, of what was seen in a place too often to read it all."""
    spans = held_by(Slice.of(step), run.spans.pop(step.var))
    if not len(spans):
        note_elsewhere(run, step.var)
        return []
    part = columns.parts(spans)
    start, end = (each[part] for each in columns.occasions(spans))
    looks = columns.rounds_of(spans.start_ms, spans.end_ms)
    rows = columns.lasts(spans.of, [end, start, spans.place])
    shown = columns.Shown(spans, looks)
    names = (spans.ids[of] for of in spans.of[rows].tolist())
    each = ((name, shown[name], row) for name, row in zip(names, rows.tolist(), strict=True))
    things = _together(run, step.var, each, lambda row: int(end[row]))
    run.counted = len(things)
    share = np.array([len(own) / (int(looks.max()) + 1) for own, _ in things])
    newest = np.array([row for _, row in things])
    newest, share = read_best(run, step.var, spans, newest, share)
    return shared(run.found[step.var], spans, newest, share)


def _together(
    run: Run, var: str, shown: Iterable[tuple[str, set[int], T]], end_ms: Callable[[T], int]
) -> list[tuple[set[int], T]]:
    """Return the looks and the newest of each thing; those never in one look may be one.

    shown: an object's id, its looks and its newest; those of most looks come first.
    """
    by_kind: dict[str, list[tuple[set[int], T]]] = {}
    for name, looks, last in sorted(shown, key=lambda each: (-len(each[1]), each[0])):
        kind = run.found[var].candidates[name].record.category
        things = by_kind.setdefault(kind, [])
        alike = next((k for k, (own, _) in enumerate(things) if own.isdisjoint(looks)), None)
        if alike is None:
            things.append((looks, last))
        else:
            own, newest = things[alike]
            things[alike] = own | looks, max(newest, last, key=end_ms)
    return [thing for things in by_kind.values() for thing in things]


def looks_at(looks: Sequence[tuple[int, int]], start_ms: int, end_ms: int) -> Sequence[int]:
    """Return the looks that a closed span touches; where it lies between two, the nearer.

    looks: (start, end) by time, none of them touching another.
    """
    first = bisect_left(looks, start_ms, key=itemgetter(1))
    after = bisect_right(looks, end_ms, key=itemgetter(0))
    if first < after:
        return range(first, after)
    apart: dict[int, int] = {}
    if first:
        apart[first - 1] = start_ms - looks[first - 1][1]
    if after < len(looks):
        apart[after] = looks[after][0] - end_ms
    nearest = min(apart.values())
    return [number for number, away in apart.items() if away == nearest]
