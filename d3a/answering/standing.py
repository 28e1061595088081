"""What stood where at one time, though no frame and no interval shows it of both.

A couch that was seen in its corner before and after the tv was seen in its own was there then too:
a thing that is seen again at its place was there in between. What is carried may have been away
for as long: of it only what was seen of both within one round tells that they stood together.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Container, Sequence
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from d3a.answering.distinct import ROUND_GAP_MS
from d3a.answering.linked import Link
from d3a.answering.moments import Found, Stood, positions
from d3a.answering.pairs import SAME_SPOT_M, Floats
from d3a.store.base import Sighting, StayKey

Rows = NDArray[np.intp]
MOST_RUNS, MOST_STOOD = 1_000, 2_000
"""So many times at a place, and so many pairs of these, are looked at, the newest."""


def stood_together(
    figure: Found, ground: Found, reach_m: float, *, timeless: bool = False
) -> list[Link]:
    """Return a link of each two stays within reach for each time that both stood at them.

    It is told by the latest sighting that was asked for within that time, the figure's where there
    is one, and by the other's that is nearest in time; what was not asked for tells nothing.
    timeless: they need not have stood there at one time (the same place as).
    """
    ones, others = _runs(figure, timeless=timeless), _runs(ground, timeless=timeless)
    rows, columns = within_reach(_places(figure, ones), _places(ground, others), reach_m)
    spans_a, spans_b = _spans(ones), _spans(others)
    start = np.maximum(spans_a[rows, 0], spans_b[columns, 0])
    end = np.minimum(spans_a[rows, 1], spans_b[columns, 1])
    if timeless:
        start = np.minimum(spans_a[rows, 0], spans_b[columns, 0])
        end = np.maximum(spans_a[rows, 1], spans_b[columns, 1])
    at_once = np.flatnonzero(start <= end)
    newest = np.argsort(-end[at_once], kind="stable")[:MOST_STOOD]
    hidden = _hidden(figure), _hidden(ground)
    found: list[Link] = []
    for k in np.sort(at_once[newest]).tolist():
        a, b = ones[rows[k]], others[columns[k]]
        if a.stay[0] == b.stay[0]:
            continue
        span = int(start[k]), int(end[k])
        told = _told(a.seen, b.seen, span, hidden)
        if told is not None:
            (first, last), both = told
            found.append(Link(a.stay, b.stay, first, last, sightings=both, standing=span))
    return found


class Timeline:
    """All that is known to have been seen at some stays, whether it was asked for or not."""

    def __init__(self, found: Found, stays: Container[StayKey]) -> None:
        self._seen: dict[StayKey, list[Sighting]] = {}
        known = (s for some in (found.sightings, found.elsewhere) for s in some if s.stay in stays)
        for sighting in sorted(known, key=BY_START):
            self._seen.setdefault(sighting.stay, []).append(sighting)
        self._begins = {stay: [s.start_ms for s in seen] for stay, seen in self._seen.items()}
        self._hidden = _hidden(found)

    def is_asked(self, sighting: Sighting) -> bool:
        """Whether the sighting was asked for."""
        return _name(sighting) not in self._hidden

    def within(self, stay: StayKey, span: tuple[int, int]) -> list[Sighting]:
        """Return the sightings of a stay that touch a closed span, by start."""
        return _within(self._seen[stay], span)

    def nearest(self, stay: StayKey, one: Sighting) -> Sighting:
        """Return the sighting of a stay that is nearest to one in time; the earlier of two."""
        seen = self._seen[stay]
        after = bisect_right(self._begins[stay], one.end_ms)
        around = seen[max(after - 1, 0) : after + 1]
        return min(around, key=lambda s: _gap_ms(s, one))


def was_there(one: Sighting, seen: Sighting, settled: Container[StayKey]) -> bool:
    """Whether a thing was at its place at a sighting of another, by its nearest sighting there.

    settled: the stays of what is never carried, so that it was there at any time.
    """
    return seen.stay in settled or _gap_ms(one, seen) <= ROUND_GAP_MS


class Standing:
    """What tells of two that stood at their places at one time: each sighting of either then.

    links: of which it is asked. settled: see `was_there`.
    """

    def __init__(
        self, figure: Found, ground: Found, links: Sequence[Link], settled: Container[StayKey]
    ) -> None:
        self._settled = settled
        if links:  # most relations are told by frames alone
            self._figure = Timeline(figure, {link.figure for link in links})
            self._ground = Timeline(ground, {link.ground for link in links})

    def told(self, link: Link) -> list[Link]:
        """Return the link for each sighting that was asked for and is within its time, by start.

        Beside it stands the other's nearest in time, if that tells that it was there then. What was
        seen of both at once has a link of its own.
        """
        assert link.standing is not None
        (low, high), out = link.standing, []
        sides = (
            (self._figure, link.figure, self._ground, link.ground, False),
            (self._ground, link.ground, self._figure, link.figure, True),
        )
        for own, stay, others, other_stay, turned in sides:
            for one in own.within(stay, link.standing):
                other = others.nearest(other_stay, one)
                if not own.is_asked(one) or _gap_ms(one, other) <= 0:
                    continue
                if was_there(one, other, self._settled):
                    begun, ended = max(one.start_ms, low), min(one.end_ms, high)
                    both = (other, one) if turned else (one, other)
                    out.append(link._replace(start_ms=begun, end_ms=ended, sightings=both))
        return sorted(out, key=lambda k: (k.start_ms, k.end_ms))


def _gap_ms(one: Sighting, other: Sighting) -> int:
    """Return the time between two sightings, at most 0 where they overlap."""
    return max(other.start_ms - one.end_ms, one.start_ms - other.end_ms)


BY_START = attrgetter("start_ms", "object_id", "place")
_Hidden = set[tuple[StayKey, int]]


def _name(sighting: Sighting) -> tuple[StayKey, int]:
    return sighting.stay, sighting.start_ms


def _hidden(found: Found) -> _Hidden:
    """Return the names of sightings that were not asked for."""
    return {_name(s) for s in found.elsewhere}


def _within(seen: Sequence[Sighting], span: tuple[int, int]) -> list[Sighting]:
    return [s for s in seen if s.start_ms <= span[1] and s.end_ms >= span[0]]


def within_reach(here: Floats, there: Floats, reach_m: float) -> tuple[Rows, Rows]:
    """Return the rows of places (n, 3) and (m, 3) that are within reach of each other, by row."""
    order = np.argsort(there[:, 0], kind="stable")
    along = there[order, 0]
    strip_m = reach_m + SAME_SPOT_M  # rounding leaves none out: the distance decides, either way
    low = np.searchsorted(along, here[:, 0] - strip_m)
    counts = np.searchsorted(along, here[:, 0] + strip_m, side="right") - low
    row = np.repeat(np.arange(len(here)), counts)
    column = order[np.repeat(low - np.cumsum(counts) + counts, counts) + np.arange(len(row))]
    away = there[column] - here[row]
    near = np.einsum("ik,ik->i", away, away) <= reach_m**2
    return row[near], column[near]


def _runs(found: Found, *, timeless: bool) -> list[Stood]:
    """Return when things were at places that are known, by id and time.

    From the first to the last time that a stay has; but where a thing was seen elsewhere before or
    after, only as far as it was seen there: when it moved in between is not known.
    What was seen but once may be a mistake: of it nothing says that it stood anywhere.
    timeless: all of a stay is one run, of whatever was seen.
    """
    if found.stood is not None and not timeless:
        return found.stood
    of: dict[str, list[list[Sighting]]] = {}
    known = {n for n, one in found.candidates.items() if timeless or not one.record.tentative}
    every = sorted((*found.sightings, *found.elsewhere), key=_AT if timeless else BY_START)
    for sighting in every:
        if sighting.object_id not in known:
            continue
        runs = of.setdefault(sighting.object_id, [])
        if runs and runs[-1][0].place == sighting.place:
            runs[-1].append(sighting)
        else:
            runs.append([sighting])
    out: list[Stood] = []
    for _, runs in sorted(of.items()):
        for k, run in enumerate(runs):
            stay = found.stays.get(run[0].stay)
            if stay is None or stay.position is None:
                continue
            begun, ended = run[0].start_ms, max(s.end_ms for s in run)
            if timeless or k == 0:
                begun = min(stay.first_ms, begun)
            if timeless or k == len(runs) - 1:
                ended = max(stay.last_ms, ended)
            out.append(Stood(stay.key, begun, ended, run))
    newest = sorted(range(len(out)), key=lambda k: -out[k].end_ms)[:MOST_RUNS]
    return [out[k] for k in sorted(newest)]


_AT = attrgetter("object_id", "place", "start_ms")


def _places(found: Found, runs: list[Stood]) -> Floats:
    return positions([found.stays[run.stay] for run in runs])


def _spans(runs: list[Stood]) -> NDArray[np.int64]:
    spans = [(run.start_ms, run.end_ms) for run in runs]
    return np.array(spans, dtype=np.int64).reshape(-1, 2)


def _told(
    ones: list[Sighting],
    others: list[Sighting],
    span: tuple[int, int],
    hidden: tuple[_Hidden, _Hidden],
) -> tuple[tuple[int, int], tuple[Sighting, Sighting]] | None:
    """Return what tells that two stood together within a span: when, and a sighting of each."""
    for seen, beside, unasked, turned in (
        (ones, others, hidden[0], False),
        (others, ones, hidden[1], True),
    ):
        within = [s for s in _within(seen, span) if _name(s) not in unasked]
        if within:
            last = max(within, key=lambda s: s.end_ms)
            other = min(beside, key=lambda s: (abs(s.end_ms - last.end_ms), s.start_ms))
            told = max(last.start_ms, span[0]), min(last.end_ms, span[1])
            return told, (other, last) if turned else (last, other)
    return None
