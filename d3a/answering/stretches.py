"""How long a thing was somewhere: not the seconds in view, but from when to when it was there.

A thing that was seen on the table at eight and again at nine, and nowhere else in between, lay
there for an hour. Where another of its category was seen elsewhere meanwhile, and never in one
round with it, that may be the same thing: then nobody knows that it lay there all the time.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from operator import attrgetter

from d3a.answering.distinct import rounds_of
from d3a.answering.moments import Moment, Stretch
from d3a.answering.run import Run
from d3a.answering.stayed import stretches_of_many
from d3a.answering.steps import FindStretches
from d3a.store.base import Sighting

_BY_TIME = attrgetter("start_ms", "object_id", "place")


def stretches(run: Run, step: FindStretches) -> list[Stretch]:
    """Return from when to when each object of the moments was so, by object and time.

    At the same place it was so even where no frame shows what it was related to.
    """
    var = step.var
    if var in run.many or var in run.so:
        return stretches_of_many(run, step)
    found, moments = run.found[var], run.answering(var)
    sifted = run.before_relation.get(var) or run.before_place.get(var)
    of: dict[str, list[Moment]] = {}
    for moment in moments:
        of.setdefault(moment.figure.sighting.object_id, []).append(moment)
    every: dict[str, list[Sighting]] = {}
    for sighting in found.sightings if sifted is None else sifted:
        every.setdefault(sighting.object_id, []).append(sighting)
    here = {moment.figure.sighting.stay for moment in moments}
    shown = rounds_of(s for each in every.values() for s in each)
    out: list[Stretch] = []
    for name, so in sorted(of.items()):
        so.sort(key=lambda m: (m.start_ms, m.end_ms))
        kind = found.candidates[name].record.category
        alike = [
            other
            for other in every
            if other == name
            or (
                found.candidates[other].record.category == kind
                and shown[other].isdisjoint(shown[name])
            )
        ]
        elsewhere = [s for other in alike for s in every[other] if s.stay not in here]
        out += _of_one(name, so, sorted(elsewhere, key=_BY_TIME))
    return out


def _of_one(name: str, so: Sequence[Moment], breaks: Sequence[Sighting]) -> list[Stretch]:
    """Return the stretches of one object. so: its moments; breaks: what ends one; both by time."""
    starts = [sighting.start_ms for sighting in breaks]
    out: list[Stretch] = []
    for moment in so:
        row = bisect_left(starts, moment.start_ms)
        last = breaks[row - 1] if row else None
        if out and (last is None or last.start_ms < out[-1].end_ms):
            end_ms = max(out[-1].end_ms, moment.end_ms)
            out[-1] = out[-1]._replace(end_ms=end_ms)
        else:
            out.append(Stretch(name, moment.start_ms, moment.end_ms, last))
    return out
