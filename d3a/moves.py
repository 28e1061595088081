"""Default profile: the identity of things that were moved.

A new thing is an old one that was moved if the old place was seen empty before or since, the look
is the same, and no other candidate is nearly as alike. To inherit an id from whatever is most
alike, as the paper does, is right once in ten times.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from d3a.ledger import Ledger
from d3a.look_space import LookSpace
from d3a.memory import Known, Memory
from d3a.parameters import Parameters
from d3a.sightings import Became, entry_name
from d3a.store.base import Encounter, StayKey


@dataclass(frozen=True, slots=True)
class Link:
    """`new` is `old`, moved; score: how alike they look, 0..1."""

    old: Known
    new: Known
    score: float


def find_links(memory: Memory, space: LookSpace, parameters: Parameters) -> list[Link]:
    """Return the moves that are plain: each the best of both its ends, by a lead."""
    gone = [thing for thing in _confirmed(memory, parameters) if _has_left(thing)]
    fresh = [thing for thing in _confirmed(memory, parameters) if _is_unexplained(thing)]
    scores: dict[tuple[int, int], float] = {}
    for old in gone:
        for new in fresh:
            if new.first_ms > old.last_ms and new.category in old.votes and old is not new:
                likeness = _likeness(memory, space, old, new)
                if likeness >= parameters.move_similarity:
                    scores[old.number, new.number] = likeness
    links = []
    for (old_number, new_number), score in sorted(scores.items()):
        rivals = [
            other
            for key, other in scores.items()
            if key != (old_number, new_number) and (key[0] == old_number or key[1] == new_number)
        ]
        new = memory.things[new_number]
        # What stands elsewhere and looks as much like it shows how little the look tells.
        rivals += [
            _likeness(memory, space, other, new)
            for other in _confirmed(memory, parameters)
            if other.number not in (old_number, new_number) and new.category in other.votes
        ]
        if score >= max(rivals, default=0.0) + parameters.move_lead:
            links.append(Link(memory.things[old_number], memory.things[new_number], score))
    return links


def _confirmed(memory: Memory, parameters: Parameters) -> list[Known]:
    return [
        memory.things[number]
        for number in sorted(memory.things)
        if memory.things[number].seen >= parameters.confirm_sightings
    ]


def _has_left(thing: Known) -> bool:
    """Say whether its latest place was seen empty since."""
    latest = max(thing.places, key=lambda place: (place.last_ms, place.number))
    return latest.last_absent_ms is not None


def _is_unexplained(thing: Known) -> bool:
    """Say whether it turned up at one place and is not known from another."""
    return len(thing.places) == 1 and not thing.names and thing.places[0].moved_from is None


def _likeness(memory: Memory, space: LookSpace, old: Known, new: Known) -> float:
    a, b = memory.looks.of(old), memory.looks.of(new)
    if a is None or b is None:
        return 0.0
    one, other = space.of(np.stack([a, b]))
    return float(one @ other)


def apply_link(link: Link, memory: Memory, ledger: Ledger, parameters: Parameters) -> Became:
    """Make `new` a further place of `old`, in the memory and in what is written already."""
    old, new = link.old, link.new
    left = max(old.places, key=lambda place: (place.last_ms, place.number))
    place = new.places[0]
    was: StayKey = (new.object_id, place.number)
    place.number = max(each.number for each in old.places) + 1
    place.moved_from = (left.number, link.score)
    becomes: StayKey = (old.object_id, place.number)
    sightings = ledger.sightings([new.object_id])
    encounters = ledger.encounters(new.object_id)
    _merge(old, new, memory, parameters)
    ledger.remove_object(new.object_id)
    for sighting in sightings:
        ledger.put_sighting(replace(sighting, object_id=becomes[0], place=becomes[1]))
    for encounter in encounters:
        if (renamed := rename(encounter, was, becomes)) is not None:
            ledger.put_encounter(renamed)
    return Became(entry_name(was), entry_name(becomes), "moved")


def _merge(old: Known, new: Known, memory: Memory, parameters: Parameters) -> None:
    place = new.places.pop()
    for category, weight in new.votes.items():
        old.votes[category] = old.votes.get(category, 0.0) + weight
    old.weight += new.weight
    old.seen += new.seen
    old.last_ms = max(old.last_ms, new.last_ms)
    old.dirty = True
    look = memory.looks.of(new)
    if look is not None:
        memory.looks.blend(old, look, new.look_weight, parameters.looks_remembered)
    old.places.append(place)
    if place.row >= 0:
        memory.positions.owners[place.row] = (old, place)
    memory.remove(new)


def rename(encounter: Encounter, was: StayKey, becomes: StayKey) -> Encounter | None:
    """Return the encounter with a stay renamed; None where a thing would meet itself."""
    e = encounter
    ends = [((e.object_a, e.place_a), e.box_a), ((e.object_b, e.place_b), e.box_b)]
    renamed = sorted((becomes if stay == was else stay, box) for stay, box in ends)
    (a, box_a), (b, box_b) = renamed
    if a[0] == b[0]:
        return None
    return replace(
        e, object_a=a[0], place_a=a[1], box_a=box_a, object_b=b[0], place_b=b[1], box_b=box_b
    )
