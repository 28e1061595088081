"""The confirmed things by category are those that a walk over the whole memory finds."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.parameters import DEFAULT
from d3a.store.base import TaughtName
from d3a.tracking.kinds import Kinds
from d3a.tracking.known import Known, Place
from d3a.tracking.memory import Memory

NAMES = ("bowl", "cup", "mug")
LEAST = DEFAULT.confirm_sightings


def _walked(memory: Memory, name: str) -> tuple[list[tuple[Known, Place]], list[Known]]:
    things = [
        thing
        for _, thing in sorted(memory.things.items())
        if thing.category == name and thing.seen >= LEAST
    ]
    fresh = [thing for thing in things if thing.places[0].moved_from is None and not thing.names]
    return [(thing, thing.latest) for thing in things], fresh


def _thing(memory: Memory, number: int) -> Known:
    thing = Known(number, {"cup": 1.0}, 0, 0, seen=1)
    memory.add(thing)
    thing.places.append(Place(0, 0, 0))
    return thing


def _change(memory: Memory, thing: Known, rng: np.random.Generator) -> None:
    """Let one of all that a look may change of a thing happen to it."""
    match int(rng.integers(6)):
        case 0:
            thing.vote(NAMES[rng.integers(3)], 2.0)
        case 1:
            thing.seen += 1
        case 2:
            thing.places.append(
                Place(len(thing.places), 0, int(rng.integers(9)), moved_from=(0, 1))
            )
        case 3:
            thing.places[0].last_ms += 5
        case 4:
            thing.names = () if thing.names else (TaughtName("Bert", None),)
        case _:
            memory.remove(thing)
            _thing(memory, thing.number)  # it comes back from the store under its number
            return
    memory.touch(thing)


@pytest.mark.parametrize("seed", range(5))
def test_the_lists_are_those_of_the_whole_memory(seed: int) -> None:
    memory, rng = Memory(), np.random.default_rng(seed)
    kinds = Kinds(memory, LEAST)
    for number in range(20):
        _thing(memory, number)
    for _ in range(60):
        for number in rng.permutation(20)[:3].tolist():
            _change(memory, memory.things[number], rng)
        for name in NAMES:
            kind = kinds.of(name)
            assert (kind.lasts, kind.fresh) == _walked(memory, name)


def test_a_list_is_made_anew_only_where_its_things_are_others_or_elsewhere() -> None:
    memory = Memory()
    kinds = Kinds(memory, LEAST)
    cup, other = _thing(memory, 1), _thing(memory, 2)
    cup.seen = other.seen = LEAST
    before = kinds.of("cup")
    cup.seen, cup.last_ms, cup.latest.last_ms = 9, 1000, 1000
    memory.touch(cup)
    assert kinds.of("cup") is before
    other.places.append(Place(1, 2000, 2000, moved_from=(0, 0.9)))
    memory.touch(other)
    assert kinds.of("cup") is not before
    assert kinds.of("cup").fresh == [cup, other]  # nobody knows where it was before the first
    other.places[0].moved_from = (7, 0.9)
    memory.touch(other)
    assert kinds.of("cup").fresh == [cup]
    assert kinds.of("bowl").lasts == []


@pytest.mark.parametrize("seed", range(5))
def test_what_was_ever_called_so_is_found_by_its_names(seed: int) -> None:
    """Also after things left the memory, came back, or were made others."""
    memory, rng = Memory(), np.random.default_rng(seed)
    for number in range(20):
        _thing(memory, number)
    for _ in range(60):
        awake = sorted(memory.things)
        for number in rng.permutation(awake)[:3].tolist():
            _change(memory, memory.things[number], rng)
        if len(awake) > 10:
            memory.lay([memory.things[number] for number in awake[: int(rng.integers(4))]])
        asleep = [each.thing.number for each in memory.sleepers()]
        memory.wake(rng.permutation(asleep)[: int(rng.integers(4))].tolist())
        for names in ({"cup"}, {"bowl", "mug"}, {"vase"}):
            things = [thing for _, thing in sorted(memory.things.items())]
            assert memory.called(names) == [t for t in things if not names.isdisjoint(t.votes)]
