"""A home as it was at some time: the records of a drawn home without what was seen later."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TypeVar

from d3a.store.base import Encounter, Sighting, View
from tests.worlds.made import Home
from tests.worlds.oracle import encounter_key

_Timed = TypeVar("_Timed", Sighting, Encounter, View)


def dated(home: Home) -> Home:
    """Return the home as tracking leaves it: dated by what was seen, and who met was there."""
    own = {name: [s for s in home.sightings if s.object_id == name] for name in home.objects}
    objects = {
        name: replace(
            record,
            first_ms=min((s.start_ms for s in own[name]), default=record.first_ms),
            last_ms=max((s.end_ms for s in own[name]), default=record.last_ms),
        )
        for name, record in home.objects.items()
    }
    met = [e for e in home.encounters if all(_begun(home, e, k) for k in (0, 1))]
    return replace(home, objects=objects, encounters=met)


def cut(home: Home, until_ms: int) -> Home:
    """Return a dated home as a store would have held it that was filled until then."""
    seen = {(*s.stay, s.start_ms): s for s in home.sightings}  # as a store has them
    sightings = list(_clipped(seen.values(), until_ms))
    ends = {s.stay: max(o.end_ms for o in sightings if o.stay == s.stay) for s in sightings}
    stays = {
        key: replace(
            stay,
            last_ms=stay.last_ms if stay.last_ms <= until_ms else ends.get(key, until_ms),
            last_absent_ms=stay.last_absent_ms if (stay.last_absent_ms or 0) <= until_ms else None,
        )
        for key, stay in home.stays.items()
        if stay.first_ms <= until_ms
    }
    objects = {
        name: replace(record, last_ms=min(record.last_ms, until_ms))
        for name, record in home.objects.items()
        if record.first_ms <= until_ms
    }
    return replace(
        home,
        objects=objects,
        stays=stays,
        sightings=sightings,
        encounters=list(
            _clipped({encounter_key(e): e for e in home.encounters}.values(), until_ms)
        ),
        views=list(_clipped({v.start_ms: v for v in home.views}.values(), until_ms)),
    )


def _begun(home: Home, met: Encounter, which: int) -> bool:
    """Whether one of the two was at its place when they met, and not only later."""
    stay = ((met.object_a, met.place_a), (met.object_b, met.place_b))[which]
    return home.stays[stay].first_ms <= met.start_ms


def _clipped(records: Iterable[_Timed], until_ms: int) -> Iterable[_Timed]:
    for record in records:
        if record.start_ms <= until_ms:
            yield replace(record, end_ms=min(record.end_ms, until_ms))
