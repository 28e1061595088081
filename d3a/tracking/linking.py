"""Default profile: making a place of a thing of what turned out to be that thing, moved."""

from __future__ import annotations

from dataclasses import replace

from d3a.ledger import Ledger
from d3a.parameters import Parameters
from d3a.sightings import Became, entry_name
from d3a.store.base import StayKey
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.moves import Link


def apply_link(link: Link, memory: Memory, ledger: Ledger, parameters: Parameters) -> Became:
    """Make `new` a further place of `old`, in the memory and in what is written already."""
    old, new = link.old, link.new
    left = old.latest
    place = new.places[0]
    _leave(left, new.first_ms)
    was: StayKey = (new.object_id, place.number)
    place.number = max(each.number for each in old.places) + 1
    place.moved_from = (left.number, link.score)
    becomes: StayKey = (old.object_id, place.number)
    sightings = ledger.sightings([new.object_id])
    encounters = ledger.encounters(new.object_id)
    _merge(old, new, memory, parameters)
    ledger.remove_objects({new.object_id})
    for sighting in sightings:
        ledger.put_sighting(replace(sighting, object_id=becomes[0], place=becomes[1]))
    for encounter in encounters:
        if (renamed := encounter.renamed({was: becomes})) is not None:
            ledger.put_encounter(renamed)
    return Became(entry_name(was), entry_name(becomes), "moved")


def _leave(left: Place, elsewhere_ms: int) -> None:
    """Note that a place was left: its thing is elsewhere, and the place was looked at in vain.

    The looks alone need not be enough for that, where a thing is hard to see.
    """
    if left.last_absent_ms is None:
        left.last_absent_ms = max([elsewhere_ms, *(looked_ms for _, looked_ms in left.missed_from)])


def _merge(old: Known, new: Known, memory: Memory, parameters: Parameters) -> None:
    place = new.places.pop()
    for category, weight in new.votes.items():
        old.vote(category, weight)
    memory.touch(old)
    old.weight += new.weight
    old.seen += new.seen
    old.last_ms = max(old.last_ms, new.last_ms)
    old.dirty = True
    look = memory.looks.of(new)
    if look is not None:
        memory.looks.blend(old, look, new.look_weight, parameters.looks_remembered)
    old.met |= new.met
    old.places.append(place)
    if place.row >= 0:
        memory.positions.give(place, old)
    memory.remove(new)
