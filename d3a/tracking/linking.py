"""Default profile: making a place of a thing of what turned out to be that thing, moved."""

from __future__ import annotations

from dataclasses import replace

from d3a.ledger import Ledger
from d3a.parameters import Parameters
from d3a.store.base import StayKey
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory
from d3a.tracking.moves import Link


def apply_link(
    link: Link, memory: Memory, ledger: Ledger, parameters: Parameters
) -> dict[StayKey, StayKey]:
    """Make the places of `new` further ones of `old`, in the memory and in what is written already.

    Returns what its stays are from now on.
    """
    old, new = link.old, link.new
    left = old.latest
    _leave(left, new.first_ms)
    becomes = _renumber(new, old, (left.number, link.score))
    sightings = ledger.sightings([new.object_id])
    encounters = ledger.encounters(new.object_id)
    _merge(old, new, memory, parameters)
    ledger.remove_objects({new.object_id})
    for sighting in sightings:
        object_id, place = becomes[sighting.stay]
        ledger.put_sighting(replace(sighting, object_id=object_id, place=place))
    for encounter in encounters:
        if (renamed := encounter.renamed(becomes)) is not None:
            ledger.put_encounter(renamed)
    return becomes


def _renumber(new: Known, old: Known, came_from: tuple[int, float]) -> dict[StayKey, StayKey]:
    """Give the places of a thing numbers after those of another; the first came from there."""
    first = max(each.number for each in old.places) + 1
    numbers = {place.number: first + k for k, place in enumerate(new.places)}
    head = new.head
    for place in new.places:
        if place.moved_from is not None:
            place.moved_from = numbers[place.moved_from[0]], place.moved_from[1]
        place.number = numbers[place.number]
    head.moved_from = came_from
    return {(new.object_id, was): (old.object_id, becomes) for was, becomes in numbers.items()}


def _leave(left: Place, elsewhere_ms: int) -> None:
    """Note that a place was left: its thing is elsewhere, and the place was looked at in vain.

    The looks alone need not be enough for that, where a thing is hard to see.
    """
    if left.last_absent_ms is None:
        left.last_absent_ms = max([elsewhere_ms, *(looked_ms for _, looked_ms in left.missed_from)])


def _merge(old: Known, new: Known, memory: Memory, parameters: Parameters) -> None:
    places, new.places = new.places, []
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
    old.places += places
    for place in places:
        if place.row >= 0:
            memory.positions.give(place, old)
    memory.remove(new)
