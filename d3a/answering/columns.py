"""Numbers and choices over thousands of sightings as columns (`Spans`), none made a record."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from d3a.answering.distinct import ROUND_GAP_MS
from d3a.answering.moments import SPLIT_GAP_MS
from d3a.store.base import Spans

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]


def stay_of(spans: Spans) -> Ints:
    """Return a number for each sighting's stay (n,): the same for those at one place of one."""
    return paired(spans.of, spans.place)


def at_stays_of(spans: Spans, others: Spans) -> Mask:
    """Return which sightings (n,) are at a stay that others of the same objects are at."""
    width = 1 + max(int(each.place.max(initial=0)) for each in (spans, others))
    return np.isin(spans.of * width + spans.place, others.of * width + others.place)


def paired(one: Ints, other: Ints) -> Ints:
    """Return a number for each pair (n,), in the order of the pairs; equal pairs have the same."""
    if not len(one):
        return one
    low = int(other.min())
    _, numbers = np.unique(one * (int(other.max()) - low + 1) + other - low, return_inverse=True)
    return np.asarray(numbers, dtype=np.int64).reshape(-1)


def lasts(of: Ints, by: Sequence[Ints]) -> NDArray[np.intp]:
    """Return the row of each group (n,) that is the greatest by some keys, the first key first."""
    order = np.lexsort((*reversed(by), of))
    ends = np.flatnonzero(np.append(np.diff(of[order]) != 0, True)) if len(of) else order
    return np.asarray(order[ends])


def covered_ms(of: Ints, start_ms: Ints, end_ms: Ints, groups: int) -> Ints:
    """Return the length of the union of the closed intervals of each group (groups,)."""
    if not len(of):
        return np.zeros(groups, dtype=np.int64)
    order = np.lexsort((start_ms, of))
    of, start, end = of[order], start_ms[order], end_ms[order]
    low = int(start.min())
    apart = of * (int(end.max()) - low + 1)  # what covers one group ends before the next begins
    reached = np.maximum.accumulate(end - low + apart)
    before = np.append(-1, reached[:-1])
    begin = np.maximum(start - low + apart, before)
    fresh = np.maximum(end - low + apart - begin, 0)
    return np.bincount(of, fresh, minlength=groups).astype(np.int64)


def rounds_of(start_ms: Ints, end_ms: Ints) -> Ints:
    """Return the number of the round of each interval (n,), as `distinct.rounds` divides them."""
    order = np.argsort(start_ms)  # what starts at once is of one round, in any order
    reached = np.maximum.accumulate(end_ms[order])
    begins = np.append(False, start_ms[order][1:] - reached[:-1] > ROUND_GAP_MS)
    numbers = np.empty(len(order), dtype=np.int64)
    numbers[order] = np.cumsum(begins[: len(order)])
    return numbers


class Shown:
    """The rounds that showed each object, by its id; a set is made where it is asked for."""

    def __init__(self, spans: Spans, numbers: Ints) -> None:
        """Take sightings and the number of the round of each (n,)."""
        ends = np.searchsorted(spans.of, np.arange(len(spans.ids) + 1)).tolist()
        self._rows = dict(zip(spans.ids, pairwise(ends), strict=True))
        self._numbers = numbers
        self._made: dict[str, set[int]] = {}

    @classmethod
    def of(cls, spans: Spans) -> Shown:
        """Return the same of sightings by the rounds of all of them."""
        return cls(spans, rounds_of(spans.start_ms, spans.end_ms))

    def __getitem__(self, name: str) -> set[int]:
        """Return the numbers of the rounds that showed an object."""
        if name not in self._made:
            first, end = self._rows[name]
            self._made[name] = {*self._numbers[first:end].tolist()}
        return self._made[name]


def shown_both(of: Ints, rounds: Ints, number: int) -> Mask:
    """Return which of so many objects one round showed both (number, number); itself too.

    of, rounds (n,): the object and the round of each sighting.
    """
    both = np.zeros((number, number), dtype=np.bool_)
    _, first = np.unique(paired(rounds, of), return_index=True)
    of, rounds = of[first], rounds[first]  # by round
    for shown in np.split(of, np.flatnonzero(np.diff(rounds)) + 1):
        both[np.ix_(shown, shown)] = True
    return both


def least_number(of: Ints, start_ms: Ints, end_ms: Ints) -> int:
    """Return how many things of one category there must be: the most objects of one round."""
    if not len(of):
        return 0
    rounds = rounds_of(start_ms, end_ms)
    _, first = np.unique(paired(rounds, of), return_index=True)
    return int(np.bincount(rounds[first]).max())


def parts(spans: Spans) -> Ints:
    """Return the number of the sighting that each is a part of (n,): the limit split some."""
    stay = stay_of(spans)
    order = np.lexsort((spans.start_ms, stay))
    start, until = spans.start_ms[order], reached(stay[order], spans.end_ms[order])
    split = (np.diff(stay[order]) == 0) & (start[1:] - until[:-1] <= SPLIT_GAP_MS)
    numbers = np.empty(len(order), dtype=np.int64)
    numbers[order] = np.cumsum(np.append(False, ~split)[: len(order)])
    return numbers


def begins(spans: Spans) -> tuple[NDArray[np.intp], Ints]:
    """Return in which row each sighting begins and when it ends, those that were split joined."""
    part = parts(spans)
    first, last = lasts(part, [-spans.start_ms]), lasts(part, [spans.end_ms])
    return first, spans.end_ms[last]


def joined(spans: Spans) -> Spans:
    """Return the sightings with those as one that the store's limit split, by object and place."""
    first, end_ms = begins(spans)
    of, place, start = (each[first] for each in (spans.of, spans.place, spans.start_ms))
    return Spans(spans.ids, of, place, start, end_ms)


def occasions(spans: Spans) -> tuple[Ints, Ints]:
    """Return start and end of the sightings when those that the store's limit split are joined."""
    first, end_ms = begins(spans)
    return spans.start_ms[first], end_ms


def whole(spans: Spans, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return these rows and those that the store's limit split from them."""
    part = parts(spans)
    return np.asarray(np.flatnonzero(np.isin(part, part[rows])))


def reached(of: Ints, end_ms: Ints) -> Ints:
    """Return the greatest end so far within each group (n,); groups stand together, ascending."""
    if not len(of):
        return end_ms
    low = int(end_ms.min())
    apart = of * (int(end_ms.max()) - low + 1)
    return np.asarray(np.maximum.accumulate(end_ms - low + apart) - apart + low)


def met(of: Ints, start_ms: Ints, end_ms: Ints, number: int) -> Mask:
    """Return which of so many objects were seen in one round with which (number, number).

    Of two objects alone: a round has both where a sighting of one begins before the gap of a
    round has passed since the end of one of the other.
    """
    order = np.argsort(start_ms, kind="stable")
    of, start, until = of[order], start_ms[order], end_ms[order] + ROUND_GAP_MS
    both = np.zeros((number, number), dtype=np.bool_)
    rows = np.arange(len(of) - 1)
    step = 1
    while len(rows):
        rows = rows[rows + step < len(of)]
        rows = rows[start[rows + step] <= until[rows]]  # the next begins later still
        both[of[rows], of[rows + step]] = True
        step += 1
    np.fill_diagonal(both, val=True)
    return both | both.T
