"""Questions over the whole memory: what moved, what is missing, where a thing usually is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from d3a.answering.departures import Left, Looks, share_left
from d3a.answering.distinct import may_be_one, rounds
from d3a.answering.moments import Found, Moment, changes_of_place, entry_of, single, total_ms
from d3a.answering.run import Run, milliseconds
from d3a.answering.steps import KeepMissing, KeepMoved, KeepOften, KeepUsual
from d3a.store.base import Sighting, StayKey

LEAST_STAY_MS = 1_000
"""A look in passing still says that the thing was there: it counts as this long."""
LEAST_LEFT = 0.5
"""A thing went missing in a slice where that is more likely than not."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A half-open slice in milliseconds, open ends None."""

    start_ms: int | None = None
    end_ms: int | None = None

    @classmethod
    def of(cls, step: KeepMissing | KeepMoved | KeepOften | KeepUsual) -> Self:
        """Return the slice of a step."""
        return cls(milliseconds(step.start), milliseconds(step.end))

    def holds(self, moment_ms: int) -> bool:
        """Whether a moment falls into the slice."""
        return (self.start_ms is None or moment_ms >= self.start_ms) and (
            self.end_ms is None or moment_ms < self.end_ms
        )


def by_object(sightings: Sequence[Sighting]) -> dict[str, list[Sighting]]:
    """Return the sightings of each object, by start, objects by id."""
    out: dict[str, list[Sighting]] = {}
    for sighting in sorted(sightings, key=lambda s: (s.object_id, s.start_ms, s.place)):
        out.setdefault(sighting.object_id, []).append(sighting)
    return out


def moved(run: Run, step: KeepMoved) -> list[Moment]:
    """Return the first sighting after each change of place within the slice.

    The association links an object's stays and says how sure it is (`moved_from`); a change
    without such a link has the chance of a coin. What was last seen before the slice may have
    moved before it: as likely as the time unseen lies outside.
    Of an asked room or relation: what came into it or left it, or moved within.
    """
    found, when = run.found[step.var], Slice.of(step)
    everywhere = run.before_place.get(step.var) or run.before_relation.get(step.var)
    out: list[Moment] = []
    inside = {s.stay for s in found.sightings}
    for sightings in by_object(found.sightings if everywhere is None else everywhere).values():
        for before, after in changes_of_place(sightings):
            if when.holds(after.start_ms) and not inside.isdisjoint((before.stay, after.stay)):
                stay = found.stays.get(after.stay)
                linked = stay.moved_from if stay is not None else None
                sure = linked[1] if linked is not None and linked[0] == before.place else 0.5
                share = _share_within(when, before.end_ms, after.start_ms)
                place = max(found.place.get(s.stay, 1.0) for s in (before, after))
                held = max(found.held.get(s.stay, 1.0) for s in (before, after))
                entry = entry_of(found, after)._replace(place=place, held=held)
                relation = max(0.0, min(1.0, sure))
                span = (after.start_ms, after.end_ms)
                within = None if share == 1.0 else share
                out.append(Moment((entry,), *span, relation=relation, share=within))
    return out


def _share_within(when: Slice, start_ms: int, end_ms: int) -> float:
    """Return which share of an interval that ends in a slice lies in it."""
    if when.start_ms is None or start_ms >= when.start_ms:
        return 1.0
    return (end_ms - when.start_ms) / (end_ms - start_ms)


def missing(run: Run, step: KeepMissing) -> list[Moment]:
    """Return the last sighting of each object whose place was seen without it, in the slice.

    An object that was seen anywhere after that look is not missing. Nor may it be where another
    of its category turned up since it was seen last: a moved thing may have got a new id.
    In the slice means gone since it began and before it ended, not that it was gone then too: see
    `share_left`, which is asked where the last sighting or the look without it lies outside.
    """
    found, when = run.found[step.var], Slice.of(step)
    gone = left_places(found)
    settled = {
        one.stay.key for one in gone if when.holds(one.last_ms) and when.holds(one.absent_ms)
    }
    unsure = [one for one in gone if one.stay.key not in settled]
    shares = dict.fromkeys(settled, 1.0)
    if unsure:
        first, last = min(one.stay.first_ms for one in unsure), max(one.absent_ms for one in unsure)
        looks = Looks(run.store.views(start_ms=first, end_ms=last))
        start = first if when.start_ms is None else when.start_ms
        end = last + 1 if when.end_ms is None else when.end_ms
        for one in unsure:
            chance = run.parameters.detect_chance
            shares[one.stay.key] = share_left(one, looks, chance, start, end)
    out: list[Moment] = []
    for one in gone:
        share = shares[one.stay.key]
        if share >= LEAST_LEFT:
            moment = single(found, max(one.sightings, key=lambda s: (s.end_ms, s.start_ms)))
            out.append(moment if one.stay.key in settled else moment._replace(relation=share))
    return out


def left_places(found: Found) -> list[Left]:
    """Return what was last seen at a place that was then seen without it, by object."""
    objects = by_object(found.sightings)
    newest: dict[str, int] = {}
    for name, sightings in objects.items():
        category = found.candidates[name].record.category
        newest[category] = max(newest.get(category, 0), sightings[0].start_ms)
    out: list[Left] = []
    for name, sightings in objects.items():
        last = max(sightings, key=lambda s: (s.end_ms, s.start_ms))
        stay = found.stays.get(last.stay)
        absent = stay.last_absent_ms if stay is not None else None
        if newest[found.candidates[name].record.category] > last.end_ms:
            continue
        if stay is not None and absent is not None and absent > last.end_ms:
            there = [s for s in sightings if s.stay == last.stay]
            out.append(Left(there, stay, absent))
    return out


def usual(run: Run, step: KeepUsual) -> list[Moment]:
    """Return the newest sighting of each stay with its share of the object's seen time.

    What others of its category, never seen in one round with it, were seen counts as its time
    too: they may be the same thing at another place. Whether it is usually at a place asks for the
    share of all the time that it was seen anywhere.
    """
    found, when = run.found[step.var], Slice.of(step)
    out: list[Moment] = []
    anywhere = run.before_place.get(step.var) or run.before_relation.get(step.var)
    if anywhere is None or run.query.ask != "whether":
        anywhere = found.sightings
    seen = [s for s in anywhere if when.holds(s.start_ms) or when.holds(s.end_ms)]
    objects = by_object(seen)
    for name, theirs in by_object(found.sightings).items():
        inside = objects.get(name, [])
        there = {sighting.stay for sighting in theirs}
        kind = found.candidates[name].record.category
        others = [
            theirs
            for other, theirs in objects.items()
            if other != name
            and found.candidates[other].record.category == kind
            and may_be_one([*inside, *theirs])
        ]
        spans: dict[StayKey, list[tuple[int, int]]] = {}
        newest: dict[StayKey, Sighting] = {}
        for sighting in inside:
            spans.setdefault(sighting.stay, []).append(_span(sighting))
            newest[sighting.stay] = sighting
        lengths = {stay: total_ms(parts) for stay, parts in spans.items()}
        total = sum(lengths.values())
        total += sum(total_ms(_span(s) for s in theirs) for theirs in others)
        for stay, sighting in newest.items():
            if stay not in there:
                continue
            entry = entry_of(found, sighting)
            share = lengths[stay] / total
            out.append(Moment((entry,), sighting.start_ms, sighting.end_ms, share=share))
    return out


def often(run: Run, step: KeepOften) -> list[Moment]:
    """Return the newest moment of each thing with the share of the looks that showed it so.

    A look is a round in which the ground was seen, or in the asked place anything at all. Things of
    one category that were never there in one look count together: a cup was there each time.
    """
    when, moments = Slice.of(step), run.answering(step.var)
    moments = [m for m in moments if when.holds(m.start_ms) or when.holds(m.end_ms)]
    ground = run.found[step.ground or step.var].sightings
    ground = [s for s in ground if when.holds(s.start_ms) or when.holds(s.end_ms)]
    ground = ground or [moment.figure.sighting for moment in moments]  # a ground nobody knows
    looks = [(one[0].start_ms, max(s.end_ms for s in one)) for one in rounds(ground)]
    of: dict[str, list[Moment]] = {}
    for moment in sorted(moments, key=lambda m: (m.end_ms, m.start_ms)):
        of.setdefault(moment.figure.sighting.object_id, []).append(moment)
    shown = {name: {k for m in so for k in _looks_at(looks, m)} for name, so in of.items()}
    by_kind: dict[str, list[tuple[set[int], Moment]]] = {}
    for name, so in sorted(of.items(), key=lambda each: (-len(shown[each[0]]), each[0])):
        things = by_kind.setdefault(so[-1].figure.candidate.record.category, [])
        alike = next((k for k, (own, _) in enumerate(things) if own.isdisjoint(shown[name])), None)
        if alike is None:
            things.append((shown[name], so[-1]))
        else:
            own, newest = things[alike]
            things[alike] = own | shown[name], max(newest, so[-1], key=lambda m: m.end_ms)
    return [
        moment._replace(share=len(own) / len(looks))
        for things in by_kind.values()
        for own, moment in things
    ]


def _looks_at(looks: Sequence[tuple[int, int]], moment: Moment) -> list[int]:
    """Return the looks that a moment touches; where it lies between two, the nearer."""
    apart = [max(start - moment.end_ms, moment.start_ms - end, 0) for start, end in looks]
    nearest = min(apart)
    return [number for number, away in enumerate(apart) if away == nearest]


def _span(sighting: Sighting) -> tuple[int, int]:
    return (sighting.start_ms, max(sighting.end_ms, sighting.start_ms + LEAST_STAY_MS))
