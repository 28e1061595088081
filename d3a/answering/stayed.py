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
    """The objects of one category (k of them), and what was seen of them, by start.

    of (n,): of which of them. met (k, k): which a round showed both. start_ms, end_ms (n,): of a
    sighting; rows (n,): where it begins among all; is_so (n,): whether it is where it is asked for.
    """

    of: Ints
    met: Mask
    start_ms: Ints
    end_ms: Ints
    rows: Rows
    is_so: Mask

    def stretches(self) -> Iterator[tuple[int, list[tuple[int, int]], int | None]]:
        """Yield each object's number, its stretches, and the row of what ended before the last."""
        of_so = self.of[self.is_so]
        for number in np.unique(of_so).tolist():
            own = self.is_so & (self.of == number)
            may_be = ~self.met[number]
            may_be[number] = True
            breaks = np.flatnonzero(may_be[self.of] & ~self.is_so)
            last = np.searchsorted(self.start_ms[breaks], self.start_ms[own]) - 1
            reached = np.maximum.accumulate(self.end_ms[own])
            ended = np.append(-1, self.start_ms[breaks])[last + 1]  # by no break: long before
            begins = np.append(True, ended[1:] >= reached[:-1])
            first = np.flatnonzero(begins)
            ends = reached[np.append(first[1:], len(reached)) - 1]
            spans = zip(self.start_ms[own][first].tolist(), ends.tolist(), strict=True)
            before = int(last[first[-1]])
            yield number, [*spans], int(self.rows[breaks[before]]) if before >= 0 else None


def stretches_of_many(run: Run, step: FindStretches) -> list[Stretch]:
    """Return what `stretches` does; what was before is read where the newest alone is told."""
    every, room = _seen(run, step.var)
    found: dict[str, list[tuple[int, int]]] = {}
    ended: dict[str, int] = {}
    for numbers, kind in _kinds(run, step.var, every, room):
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
    """Return when the objects of a variable were seen in the slice: anywhere, and where asked."""
    find = next(s for s in run.steps if isinstance(s, FindSightings) and s.var == var)
    start, end = milliseconds(find.start), milliseconds(find.end)
    last = None if end is None else end - 1
    every = run.facts.spans(run.found[var].ids, start, last)
    return every, spans_asked(run, var, start, last)


def _kinds(run: Run, var: str, every: Spans, room: Spans) -> Iterator[tuple[Ints, _Kind]]:
    """Yield the numbers of the objects of each category, and what was seen of these."""
    first, end_ms = columns.begins(every)
    by_start = np.lexsort((every.place[first], every.of[first], every.start_ms[first]))
    first, end_ms = first[by_start], end_ms[by_start]
    is_so = columns.at_stays_of(every, room)[first]
    rounds = columns.rounds_of(every.start_ms, every.end_ms)[first]
    kinds: dict[str, list[int]] = {}
    for number, name in enumerate(every.ids):
        kinds.setdefault(run.found[var].candidates[name].record.category, []).append(number)
    place = np.zeros(len(every.ids), dtype=np.int64)
    for numbers in map(np.array, kinds.values()):
        place[numbers] = np.arange(len(numbers))
        own = np.isin(every.of[first], numbers)
        of, rows = place[every.of[first[own]]], first[own]
        met = columns.shown_both(of, rounds[own], len(numbers))
        yield numbers, _Kind(of, met, every.start_ms[rows], end_ms[own], rows, is_so[own])


def _read(run: Run, every: Spans, rows: Mapping[str, int]) -> dict[str, Sighting]:
    """Return the sightings that begin in some rows, each by its name."""
    first = np.array([*rows.values()], dtype=np.intp)
    known = run.store.sightings_at(every.chosen(columns.whole(every, first)).which())
    by_key = {(*s.stay, s.start_ms): s for s in joined(known)}
    return {name: by_key[every.chosen(np.array([row])).which()[0]] for name, row in rows.items()}
