"""What may stand in a relation, of thousands of sightings: found as columns, and no more read.

Of a year of cups few were ever near the table. Which were at one time with it, or shown by one
frame, and which stood there meanwhile, when and where they were seen tells; the rest is not read.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from d3a.answering import columns
from d3a.answering.joins import STANDING, reach_of
from d3a.answering.late import encounters_of, side_of
from d3a.answering.meetings import Side, met
from d3a.answering.moments import Found, Stood, joined
from d3a.answering.run import Run
from d3a.answering.standing import MOST_RUNS
from d3a.answering.steps import KeepPresent, Relate
from d3a.store.base import Sighting, StayKey


def find_narrowly(run: Run, step: Relate) -> None:
    """Find of two things all that was seen at places where they may stand in a relation.

    Where it is asked what is so still, also where each was last.
    """
    sides = one, other = [side_of(run, var) for var in step.vars]
    reach_m = reach_of(step.kind, run.parameters)
    found = met(one, other, encounters_of(run, one, other), reach_m, once=False)
    for var, side, rows in zip(step.vars, sides, (found.figure, found.ground), strict=True):
        table, wanted = run.found[var], np.zeros(len(side.places), dtype=np.bool_)
        wanted[rows] = True
        if any(isinstance(each, KeepPresent) for each in run.steps):
            spans = side.spans
            newest = columns.lasts(spans.of, [spans.end_ms, spans.start_ms, spans.place])
            wanted[side.at[newest]] = True
        runs = _Runs(run, table, side) if step.kind in STANDING else None
        if runs is not None:
            wanted[runs.at] = True
        keys = side.which(np.flatnonzero(wanted[side.at]))
        table.sightings = joined(run.store.sightings_at(keys))
        table.stays = run.facts.stays_of(table.sightings)
        table.stood = None if runs is None else runs.told(table.sightings)


class _Runs:
    """The newest times at which things of a side stood at their places, see `Stood`."""

    def __init__(self, run: Run, table: Found, side: Side) -> None:
        spans = side.spans
        order = np.lexsort((spans.place, spans.start_ms, spans.of))
        at = side.at[order]
        first = np.flatnonzero(np.append(True, np.diff(at) != 0)[: len(at)])
        of, self.at = spans.of[order[first]], at[first]
        self._start = spans.start_ms[order[first]]
        self._end = np.maximum.reduceat(spans.end_ms[order], first) if len(first) else self._start
        sure = np.array([not table.candidates[name].record.tentative for name in spans.ids])
        known = sure[of] & ~np.isnan(side.places.x[self.at])
        self._extend(run, side, of, known)
        ends = np.append(first[1:], len(order))
        rows = np.flatnonzero(known)
        rows = np.sort(rows[np.argsort(-self._end[rows], kind="stable")[:MOST_RUNS]])
        self.at, self._start, self._end = self.at[rows], self._start[rows], self._end[rows]
        self._names = [
            spans.chosen(order[begin:end]).which()
            for begin, end in zip(first[rows].tolist(), ends[rows].tolist(), strict=True)
        ]

    def _extend(self, run: Run, side: Side, of: columns.Ints, known: NDArray[np.bool_]) -> None:
        """Let the first and the last of each thing reach as far as the stay does."""
        changes = np.diff(of) != 0
        is_first = np.append(True, changes)[: len(of)] & known
        is_last = np.append(changes, True)[: len(of)] & known
        rows = np.flatnonzero(is_first | is_last)
        keys = side.stays(self.at[rows])
        stays = {stay.key: stay for stay in run.store.stays_at(sorted({*keys}))}
        for row, key in zip(rows.tolist(), keys, strict=True):
            if is_first[row]:
                self._start[row] = min(stays[key].first_ms, self._start[row])
            if is_last[row]:
                self._end[row] = max(stays[key].last_ms, self._end[row])

    def told(self, sightings: list[Sighting]) -> list[Stood]:
        """Return them with what was seen then, of sightings that were read."""
        by_name = {(*s.stay, s.start_ms): s for s in sightings}
        spans = zip(self._start.tolist(), self._end.tolist(), self._names, strict=True)
        out: list[Stood] = []
        for start, end, names in spans:
            stay: StayKey = names[0][:2]
            out.append(Stood(stay, start, end, [by_name[name] for name in names]))
        return out
