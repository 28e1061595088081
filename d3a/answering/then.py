"""What was so at a moment: a sighting before or after it tells, unless a nearer one says otherwise.

A laptop that was on the desk in the morning and in the evening was seen on the kitchen table in
between: what was nearer to the moment counts, also under another id where one thing may be both.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from d3a.answering import columns
from d3a.answering.moments import Moment, single
from d3a.answering.points import MINUTE
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import KeepThen
from d3a.store.base import Sighting

_MINUTE_MS = round(MINUTE.total_seconds() * 1000)


def keep_then(run: Run, step: KeepThen) -> None:
    """Drop the moments that were not so any more, or not yet, by what was seen nearer to then.

    Where nothing is left on one side of the moment, what was seen there instead is told.
    """
    table, moments = run.found[step.var], run.answering(step.var)
    sifted = run.before_relation.get(step.var) or run.before_place.get(step.var)
    if sifted is None:
        return
    held = {(m.figure.sighting.stay, m.figure.sighting.start_ms) for m in moments}
    away = [s for s in sifted if (s.stay, s.start_ms) not in held]
    between = _Between(run, step, away)
    kept = [moment for moment in moments if not any(between.against(moment))]
    asked = [m.figure.sighting for m in kept] or [m.figure.sighting for m in moments] or sifted
    other = between.told([m.figure.sighting for m in kept], asked)
    if other is not None:
        table.stays |= run.facts.stays_of([other])
        run.otherwise = single(table, other)
    if run.moments is not None:
        run.moments = kept
    else:
        table.sightings = [moment.figure.sighting for moment in kept]


class _Between:
    """What was seen elsewhere around a moment. away: the nearest of each object on either side."""

    def __init__(self, run: Run, step: KeepThen, away: Sequence[Sighting]) -> None:
        at = milliseconds(step.at)
        assert at is not None
        self._at, self._away = at, away
        candidates = run.found[step.var].candidates
        self._kind = {name: c.record.category for name, c in candidates.items()}
        self._unsure = {name for name, c in candidates.items() if c.record.tentative}
        ids = run.found[step.var].ids if away else []
        self._shown = columns.Shown.of(run.facts.spans(ids, None, None))

    def against(self, moment: Moment) -> Iterator[Sighting]:
        """Yield what was seen between a moment and then, of its figure or what may be it."""
        own = moment.figure.sighting
        if own.start_ms < self._at + _MINUTE_MS and own.end_ms >= self._at:
            return
        for other in self._away:
            is_nearer = (
                own.end_ms < other.start_ms < self._at + _MINUTE_MS
                if own.end_ms < self._at
                else self._at <= other.end_ms < own.start_ms
            )
            if is_nearer and self._may_be(other.object_id, own.object_id):
                yield other

    def told(self, kept: Sequence[Sighting], asked: Sequence[Sighting]) -> Sighting | None:
        """Return what was seen instead on the side of the moment that nothing kept tells of.

        kept: the figures that are told; asked: what is told must be one of these, or may be.
        """
        names = {s.object_id for s in asked}
        away = [s for s in self._away if any(self._may_be(s.object_id, name) for name in names)]
        before = [s for s in away if s.start_ms < self._at + _MINUTE_MS]
        after = [s for s in away if s.start_ms >= self._at + _MINUTE_MS]
        told_before = any(s.start_ms < self._at + _MINUTE_MS for s in kept)
        told_after = any(s.end_ms >= self._at for s in kept)
        if before and not told_before:
            return max(before, key=lambda s: (s.end_ms, s.object_id))
        if after and not told_after:
            return min(after, key=lambda s: (s.start_ms, s.object_id))
        return None

    def _may_be(self, other: str, name: str) -> bool:
        if other == name:
            return True
        alike = self._kind[other] == self._kind[name] and other not in self._unsure
        return alike and self._shown[other].isdisjoint(self._shown[name])
