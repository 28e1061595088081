"""Questions over the whole memory: what moved, what is missing, where a thing usually is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from d3a.distinct import may_be_one
from d3a.moments import Found, Moment, changes_of_place, entry_of, single, total_ms
from d3a.store.base import Sighting, StayKey

LEAST_STAY_MS = 1_000
"""A look in passing still says that the thing was there: it counts as this long."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A half-open slice in milliseconds, open ends None."""

    start_ms: int | None = None
    end_ms: int | None = None

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


def moved(found: Found, when: Slice, everywhere: Sequence[Sighting] | None = None) -> list[Moment]:
    """Return the first sighting after each change of place within the slice.

    The association links an object's stays and says how sure it is (`moved_from`); a change
    without such a link has the chance of a coin. What was last seen before the slice may have
    moved before it: as likely as the time unseen lies outside.
    everywhere: the sightings before those outside of an asked room, or without an asked relation,
    were dropped; then what came into the room or left it, or moved within.
    """
    out: list[Moment] = []
    inside = {s.stay for s in found.sightings}
    for sightings in by_object(found.sightings if everywhere is None else everywhere).values():
        for before, after in changes_of_place(sightings):
            if when.holds(after.start_ms) and not inside.isdisjoint((before.stay, after.stay)):
                stay = found.stays.get(after.stay)
                linked = stay.moved_from if stay is not None else None
                sure = linked[1] if linked is not None and linked[0] == before.place else 0.5
                sure *= _share_within(when, before.end_ms, after.start_ms)
                place = max(found.place.get(s.stay, 1.0) for s in (before, after))
                held = max(found.held.get(s.stay, 1.0) for s in (before, after))
                entry = entry_of(found, after)._replace(place=place, held=held)
                relation = max(0.0, min(1.0, sure))
                out.append(Moment((entry,), after.start_ms, after.end_ms, relation=relation))
    return out


def _share_within(when: Slice, start_ms: int, end_ms: int) -> float:
    """Return which share of an interval that ends in a slice lies in it."""
    if when.start_ms is None or start_ms >= when.start_ms:
        return 1.0
    return (end_ms - when.start_ms) / (end_ms - start_ms)


def missing(found: Found, when: Slice) -> list[Moment]:
    """Return the last sighting of each object whose place was seen without it, in the slice.

    An object that was seen anywhere after that look is not missing. Nor may it be where another
    of its category turned up since it was seen last: a moved thing may have got a new id.
    """
    out: list[Moment] = []
    objects = by_object(found.sightings)
    newest: dict[str, int] = {}
    for name, sightings in objects.items():
        category = found.candidates[name].record.category
        newest[category] = max(newest.get(category, 0), sightings[0].start_ms)
    for name, sightings in objects.items():
        last = max(sightings, key=lambda s: (s.end_ms, s.start_ms))
        stay = found.stays.get(last.stay)
        absent = stay.last_absent_ms if stay is not None else None
        if newest[found.candidates[name].record.category] > last.end_ms:
            continue
        if absent is not None and absent > last.end_ms and when.holds(absent):
            out.append(single(found, last))
    return out


def usual(found: Found, when: Slice) -> list[Moment]:
    """Return the newest sighting of each stay with its share of the object's seen time.

    What others of its category, never seen in one round with it, were seen counts as its time
    too: they may be the same thing at another place.
    """
    out: list[Moment] = []
    seen = [s for s in found.sightings if when.holds(s.start_ms) or when.holds(s.end_ms)]
    objects = by_object(seen)
    for name, inside in objects.items():
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
            entry = entry_of(found, sighting)
            share = lengths[stay] / total
            out.append(Moment((entry,), sighting.start_ms, sighting.end_ms, share=share))
    return out


def _span(sighting: Sighting) -> tuple[int, int]:
    return (sighting.start_ms, max(sighting.end_ms, sighting.start_ms + LEAST_STAY_MS))
