"""What `d3a.answering.stretches` tells, of what was seen too often to be read whole: by columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.answering import columns
from d3a.answering.columns import Ints, Mask
from d3a.answering.many import spans_asked
from d3a.answering.moments import Stretch, joined
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import FindSightings, FindStretches
from d3a.store.base import Sighting, Spans

Rows = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class _Kind:
    """The objects of one category (k of them), when they were so, and what may end that; by start.

    met (k, k): which a round showed both. of (n,): of which of them something was seen elsewhere;
    start_ms (n,): from when on; rows (n,): where that begins among all. so_of (m,): which of them
    was so from so_start to so_end (m,).
    """

    met: Mask
    of: Ints
    start_ms: Ints
    rows: Rows
    so_of: Ints
    so_start: Ints
    so_end: Ints

    def stretches(self) -> Iterator[tuple[int, list[tuple[int, int]], int | None]]:
        """Yield each object's number, its stretches, and the row of what ended before the last."""
        for number in np.unique(self.so_of).tolist():
            own = self.so_of == number
            start, end = self.so_start[own], self.so_end[own]
            may_be = ~self.met[number]
            may_be[number] = True
            breaks = np.flatnonzero(may_be[self.of])
            last = np.searchsorted(self.start_ms[breaks], start) - 1
            reached = np.maximum.accumulate(end)
            ended = np.append(-1, self.start_ms[breaks])[last + 1]  # by no break: long before
            begins = np.append(True, ended[1:] >= reached[:-1])
            first = np.flatnonzero(begins)
            ends = reached[np.append(first[1:], len(reached)) - 1]
            spans = zip(start[first].tolist(), ends.tolist(), strict=True)
            before = int(last[first[-1]])
            yield number, [*spans], int(self.rows[breaks[before]]) if before >= 0 else None


def stretches_of_many(run: Run, step: FindStretches) -> list[Stretch]:
    """Return what `stretches` does; what was before is read where the newest alone is told."""
    every, so = _seen(run, step.var)
    found: dict[str, list[tuple[int, int]]] = {}
    ended: dict[str, int] = {}
    for numbers, kind in _kinds(run, step.var, every, so):
        for number, spans, row in kind.stretches():
            name = every.ids[numbers[number]]
            found[name] = spans
            if row is not None and step.newest:
                ended[name] = row
    before = _read(run, every, ended)
    return [
        Stretch(name, *span, before.get(name) if span == spans[-1] else None)
        for name, spans in sorted(found.items())
        for span in spans
    ]


def _seen(run: Run, var: str) -> tuple[Spans, Spans]:
    """Return when the objects of a variable were seen in the slice, and when they were so."""
    find = next(s for s in run.steps if isinstance(s, FindSightings) and s.var == var)
    start, end = milliseconds(find.start), milliseconds(find.end)
    last = None if end is None else end - 1
    if var in run.so:  # of what stood so in a place, that it was elsewhere meanwhile ends nothing
        return spans_asked(run, var, start, last), run.so[var]
    every = run.facts.spans(run.found[var].ids, start, last)
    return every, columns.joined(spans_asked(run, var, start, last))


def _kinds(run: Run, var: str, every: Spans, so: Spans) -> Iterator[tuple[Ints, _Kind]]:
    """Yield the numbers of the objects of each category, and what was seen of these."""
    first, _ = columns.begins(every)
    first = first[np.lexsort((every.place[first], every.of[first], every.start_ms[first]))]
    is_so = columns.at_stays_of(every, so)[first]
    rounds = columns.rounds_of(every.start_ms, every.end_ms)[first]
    so = so.chosen(np.lexsort((so.end_ms, so.start_ms)))
    kinds: dict[str, list[int]] = {}
    for number, name in enumerate(every.ids):
        kinds.setdefault(run.found[var].candidates[name].record.category, []).append(number)
    place = np.zeros(len(every.ids), dtype=np.int64)
    for numbers in map(np.array, kinds.values()):
        place[numbers] = np.arange(len(numbers))
        own, so_own = np.isin(every.of[first], numbers), so.chosen(np.isin(so.of, numbers))
        met = columns.shown_both(place[every.of[first[own]]], rounds[own], len(numbers))
        rows = first[own & ~is_so]
        ends = place[every.of[rows]], every.start_ms[rows], rows
        yield numbers, _Kind(met, *ends, place[so_own.of], so_own.start_ms, so_own.end_ms)


def _read(run: Run, every: Spans, rows: Mapping[str, int]) -> dict[str, Sighting]:
    """Return the sightings that begin in some rows, each by its name."""
    first = np.array([*rows.values()], dtype=np.intp)
    known = run.store.sightings_at(every.chosen(columns.whole(every, first)).which())
    by_key = {(*s.stay, s.start_ms): s for s in joined(known)}
    return {name: by_key[every.chosen(np.array([row])).which()[0]] for name, row in rows.items()}
