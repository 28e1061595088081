"""What stood where at one time, though no frame and no interval shows it of both.

A couch that was seen in its corner before and after the tv was seen in its own was there then too:
a thing that is seen again at its place was there in between.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.answering.linked import Link
from d3a.answering.moments import Found, positions
from d3a.answering.pairs import Floats
from d3a.store.base import Sighting, StayKey

Rows = NDArray[np.intp]
MOST_RUNS, MOST_STOOD = 1_000, 2_000
"""So many times at a place, and so many pairs of these, are looked at, the newest."""


class _Run(NamedTuple):
    """A thing at a place without being seen elsewhere, and what was seen of it then."""

    stay: StayKey
    start_ms: int
    end_ms: int
    seen: list[Sighting]


def stood_together(
    figure: Found, ground: Found, met: Collection[tuple[StayKey, StayKey]], reach_m: float
) -> list[Link]:
    """Return a link of each two stays within reach whose times overlap, but of those that met.

    It is told by the latest sighting within that time, the figure's where there is one, and by the
    other's that is nearest in time. Sightings that were not found, of other times than those asked
    for, tell nothing.
    """
    ones, others = _runs(figure), _runs(ground)
    rows, columns = within_reach(_places(figure, ones), _places(ground, others), reach_m)
    spans_a, spans_b = _spans(ones), _spans(others)
    start = np.maximum(spans_a[rows, 0], spans_b[columns, 0])
    end = np.minimum(spans_a[rows, 1], spans_b[columns, 1])
    at_once = np.flatnonzero(start <= end)
    newest = np.argsort(-end[at_once], kind="stable")[:MOST_STOOD]
    found: list[Link] = []
    for k in np.sort(at_once[newest]).tolist():
        a, b = ones[rows[k]], others[columns[k]]
        if a.stay[0] == b.stay[0] or (a.stay, b.stay) in met:
            continue
        span = int(start[k]), int(end[k])
        told = _told(a.seen, b.seen, span)
        if told is not None:
            (first, last), both = told
            found.append(Link(a.stay, b.stay, first, last, sightings=both, standing=span))
    return found


def within_reach(here: Floats, there: Floats, reach_m: float) -> tuple[Rows, Rows]:
    """Return the rows of places (n, 3) and (m, 3) that are within reach of each other, by row."""
    order = np.argsort(there[:, 0], kind="stable")
    along = there[order, 0]
    low = np.searchsorted(along, here[:, 0] - reach_m)
    counts = np.searchsorted(along, here[:, 0] + reach_m, side="right") - low
    row = np.repeat(np.arange(len(here)), counts)
    column = order[np.repeat(low - np.cumsum(counts) + counts, counts) + np.arange(len(row))]
    away = there[column] - here[row]
    near = np.einsum("ik,ik->i", away, away) <= reach_m**2
    return row[near], column[near]


def _runs(found: Found) -> list[_Run]:
    """Return when things were at places that are known, by id and time.

    From the first to the last time that a stay has, as far as the thing was not seen elsewhere.
    What was seen but once may be a mistake: of it nothing says that it stood anywhere.
    """
    of: dict[str, list[list[Sighting]]] = {}
    known = {name for name, one in found.candidates.items() if not one.record.tentative}
    for sighting in sorted(found.sightings, key=lambda s: (s.start_ms, s.object_id, s.place)):
        if sighting.object_id not in known:
            continue
        runs = of.setdefault(sighting.object_id, [])
        if runs and runs[-1][0].place == sighting.place:
            runs[-1].append(sighting)
        else:
            runs.append([sighting])
    out: list[_Run] = []
    for _, runs in sorted(of.items()):
        ends = [max(s.end_ms for s in run) for run in runs]
        begins = [run[0].start_ms for run in runs]
        for k, run in enumerate(runs):
            stay = found.stays.get(run[0].stay)
            if stay is None or stay.position is None:
                continue
            first = max([stay.first_ms, *ends[:k][-1:]])
            last = min([stay.last_ms, *begins[k + 1 :][:1]])
            out.append(_Run(stay.key, min(first, begins[k]), max(last, ends[k]), run))
    newest = sorted(range(len(out)), key=lambda k: -out[k].end_ms)[:MOST_RUNS]
    return [out[k] for k in sorted(newest)]


def _places(found: Found, runs: list[_Run]) -> Floats:
    return positions([found.stays[run.stay] for run in runs])


def _spans(runs: list[_Run]) -> NDArray[np.int64]:
    spans = [(run.start_ms, run.end_ms) for run in runs]
    return np.array(spans, dtype=np.int64).reshape(-1, 2)


def _told(
    ones: list[Sighting], others: list[Sighting], span: tuple[int, int]
) -> tuple[tuple[int, int], tuple[Sighting, Sighting]] | None:
    """Return what tells that two stood together within a span: when, and a sighting of each."""
    for seen, beside, turned in ((ones, others, False), (others, ones, True)):
        within = [s for s in seen if s.start_ms <= span[1] and s.end_ms >= span[0]]
        if within:
            last = max(within, key=lambda s: s.end_ms)
            other = min(beside, key=lambda s: (abs(s.end_ms - last.end_ms), s.start_ms))
            told = max(last.start_ms, span[0]), min(last.end_ms, span[1])
            return told, (other, last) if turned else (last, other)
    return None
