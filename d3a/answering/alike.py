"""What else of its kind was seen, so that it may be the same thing under another id.

A thing that was carried often comes back as a new object. What was seen since, and never in one
round with the thing, may be it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import cached_property

from d3a.answering import columns
from d3a.answering.distinct import rounds_of
from d3a.answering.run import Run
from d3a.store.base import Sighting


class Alike:
    """The objects of a variable by their kinds, and when each was seen."""

    def __init__(
        self, run: Run, var: str, names: Collection[str], before: Sequence[Sighting]
    ) -> None:
        """Take the objects that are asked about, and what was seen of all of the variable."""
        table = run.found[var]
        self._of = {name: c.record.category for name, c in table.candidates.items()}
        kinds = {self._of[name] for name in names}
        seen = [s for s in before if self._of.get(s.object_id) in kinds]
        self._unsure = {name for name, c in table.candidates.items() if c.record.tentative}
        self._newest, self._seen = newest_of(seen), seen
        self._first = first_of(seen)
        self._run, self._is_whole = run, var not in run.newest_alone
        if not self._is_whole:  # each object's newest sighting was found and no other
            self._first = first_of(run.store.edges([*self._newest], "first"))
        self._of_kind: dict[str, list[str]] = {}
        for name in self._newest:
            self._of_kind.setdefault(self._of[name], []).append(name)

    @cached_property
    def _shown(self) -> dict[str, set[int]]:
        """The rounds that showed each, by number: of many things they are seldom asked for."""
        if self._is_whole:
            return rounds_of(self._seen)
        spans = self._run.facts.spans(sorted(self._newest), None, None)
        return columns.shown_in(spans, columns.rounds_of(spans.start_ms, spans.end_ms))

    def turned_up(self, name: str, at_ms: int, besides: Collection[str]) -> list[Sighting]:
        """Return those that were first seen after a moment, each as it was seen last."""
        names = self._others(name, besides)
        return [self._newest[n] for n in names if self._first[n].start_ms > at_ms]

    def seen_since(self, name: str, at_ms: int) -> list[Sighting]:
        """Return those that were seen after a moment, and never in one round with the thing."""
        others = [self._newest[other] for other in self._others(name, ())]
        return [
            other
            for other in others
            if other.start_ms > at_ms and self._shown[other.object_id].isdisjoint(self._shown[name])
        ]

    def _others(self, name: str, besides: Collection[str]) -> list[str]:
        ruled_out = self._unsure.union(besides, (name,))  # what may be a mistake doubts nothing
        return [other for other in self._of_kind[self._of[name]] if other not in ruled_out]


def first_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that began first, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.start_ms, s.place), reverse=True)
    return {sighting.object_id: sighting for sighting in ordered}


def newest_of(sightings: Iterable[Sighting]) -> dict[str, Sighting]:
    """Return the sighting of each object that ended last, by object id."""
    ordered = sorted(sightings, key=lambda s: (s.end_ms, s.start_ms, s.place))
    return {sighting.object_id: sighting for sighting in ordered}
