"""What else of its kind was seen, so that it may be the same thing under another id.

A thing that was carried often comes back as a new object. What was seen since, and never in one
round with the thing, may be it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from d3a.answering import columns
from d3a.answering.distinct import rounds_of
from d3a.answering.run import Run
from d3a.store.base import Sighting, Spans


class Alike:
    """The objects of a variable by their kinds, and when each was seen.

    Most that is asked of them is whether there is any such: the next is looked for when it is
    asked for, as of thousands of things the first tells it mostly.
    """

    def __init__(
        self, run: Run, var: str, names: Collection[str], before: Sequence[Sighting]
    ) -> None:
        """Take the objects that are asked about, and what was seen of all of the variable."""
        table = run.found[var]
        self._of = {name: c.record.category for name, c in table.candidates.items()}
        kinds = {self._of[name] for name in names}
        seen = [s for s in before if self._of.get(s.object_id) in kinds]
        self._ids = table.ids
        self._unsure = {name for name, c in table.candidates.items() if c.record.tentative}
        self._newest, self._seen = newest_of(seen), seen
        self._run, self._is_whole = run, var not in run.newest_alone

    @cached_property
    def _spans(self) -> Spans:
        """When they were seen, where each object's newest sighting was found and no other.

        Of all of the variable, which other questions about it have read as well.
        """
        every = self._run.facts.spans(self._ids, None, None)
        known = np.array([name in self._newest for name in every.ids], dtype=np.bool_)
        return every if known.all() else every.chosen(known[every.of])

    @cached_property
    def _shown(self) -> Mapping[str, set[int]] | columns.Shown:
        """The rounds that showed each, by number."""
        if self._is_whole:
            return rounds_of(self._seen)
        return columns.Shown.of(self._spans)

    @cached_property
    def _latest(self) -> Mapping[str, Sequence[tuple[int, str]]]:
        """The sure objects of each kind with their first start, the latest first."""
        if self._is_whole:
            first = {name: s.start_ms for name, s in first_of(self._seen).items()}
        else:
            of, rows = np.unique(self._spans.of, return_index=True)
            starts = self._spans.start_ms[rows].tolist()
            first = {self._spans.ids[n]: at for n, at in zip(of.tolist(), starts, strict=True)}
        return self._by_kind((first[name], name) for name in self._newest)

    @cached_property
    def _last(self) -> Mapping[str, Sequence[tuple[int, str]]]:
        """The sure objects of each kind with their last end, the last first."""
        return self._by_kind((s.end_ms, name) for name, s in self._newest.items())

    def _by_kind(self, timed: Iterable[tuple[int, str]]) -> dict[str, list[tuple[int, str]]]:
        of_kind: dict[str, list[tuple[int, str]]] = {}
        for at_ms, name in sorted(timed, reverse=True):
            if name not in self._unsure:  # what may be a mistake doubts nothing
                of_kind.setdefault(self._of[name], []).append((at_ms, name))
        return of_kind

    def turned_up(self, name: str, at_ms: int, besides: Collection[str]) -> Iterator[Sighting]:
        """Yield those that were first seen after a moment, each as it was seen last."""
        for first_ms, other in self._latest.get(self._of[name], ()):
            if first_ms <= at_ms:
                return
            if other != name and other not in besides:
                yield self._newest[other]

    def seen_since(self, name: str, at_ms: int) -> Iterator[Sighting]:
        """Yield those that were seen after a moment, and never in one round with the thing.

        By their ends and ids, the last first.
        """
        own: set[int] | None = None
        for end_ms, other in self._last.get(self._of[name], ()):
            if end_ms <= at_ms:
                return
            newest = self._newest[other]
            if newest.start_ms > at_ms:
                own = self._shown[name] if own is None else own
                if own.isdisjoint(self._shown[other]):
                    yield newest


def first_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that began first, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.start_ms, s.place), reverse=True)
    return {sighting.object_id: sighting for sighting in ordered}


def newest_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that ended last, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.end_ms, s.start_ms, s.place))
    return {sighting.object_id: sighting for sighting in ordered}
