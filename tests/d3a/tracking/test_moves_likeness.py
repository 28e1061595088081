"""How alike different things look is a matter of their category."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from d3a.parameters import DEFAULT
from d3a.tracking.absence import Absence
from d3a.tracking.alike import BINS
from d3a.tracking.arrivals import CAME_MOST
from d3a.tracking.kinds import Kind
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import LookModel
from d3a.tracking.look_space import LookSpace
from d3a.tracking.memory import Memory
from d3a.tracking.moves import (
    ASK_AGAIN_MS,
    LEFT_LEAST,
    MORE_GONE,
    MORE_SEEN,
    PLAIN_LOOK,
    Asked,
    Link,
    Moves,
)
from d3a.tracking.rivals import Rivals

NOW_MS = 10_000
LEAST = DEFAULT.move_probability
ALIKE, UNLIKE = int(0.95 * BINS), int(0.6 * BINS)


def _moves(others: dict[str, list[float]]) -> Moves:
    memory = Memory()
    absence = Absence(memory, DEFAULT)
    moves = Moves(memory, LookSpace(DEFAULT), LookModel(DEFAULT), absence, DEFAULT)
    moves.others = others
    return moves


def _pairs(bin_: int, count: float) -> list[float]:
    counts = [0.0] * BINS
    counts[bin_] = count
    return counts


def test_chairs_of_a_set_say_little_of_the_cups() -> None:
    cups = _pairs(UNLIKE, 30.0)
    alone = _moves({"cup": cups})._densities("cup")[ALIKE]
    few, many = (
        _moves({"cup": cups, "chair": _pairs(ALIKE, n)})._densities("cup")[ALIKE]
        for n in (10.0, 1000.0)
    )
    assert np.isclose(few, many)  # beyond the prior's pairs more of them change nothing
    assert alone < many < _moves({"chair": _pairs(ALIKE, 1000.0)})._densities("chair")[ALIKE] / 5


def test_a_category_without_pairs_of_its_own_takes_what_is_usual() -> None:
    moves = _moves({"chair": _pairs(ALIKE, 10.0), "cup": _pairs(UNLIKE, 10.0)})
    assert moves._densities("cup")[ALIKE] < moves._densities("vase")[ALIKE]
    assert moves._densities("vase")[ALIKE] < moves._densities("chair")[ALIKE]


def _thing(memory: Memory, number: int, look: list[float], first_ms: int, last_ms: int) -> Known:
    thing = Known(number, {"bag": 1.0}, first_ms, last_ms, seen=9)
    thing.places.append(Place(0, first_ms, last_ms, seen=9))
    memory.add(thing)
    memory.looks.put(thing, np.array(look, dtype=np.float32), 9.0)
    return thing


@pytest.mark.parametrize(("others", "is_linked"), [(0, True), (12, False)])
def test_a_changed_look_is_enough_where_there_is_only_one_such_thing(
    others: int, is_linked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing was at the new place before; how many may have come there makes the difference."""
    mostly_unlike = [a + b for a, b in zip(_pairs(UNLIKE, 30.0), _pairs(ALIKE, 9.0), strict=True)]
    moves = _moves({"bag": mostly_unlike})
    monkeypatch.setattr(moves._absence, "came", lambda place: 2.0)
    memory = moves._memory
    old = _thing(memory, 0, [1.0, 0.0, 0.0], 0, 1000)
    old.places[0].evidence, old.places[0].misses = 9.0, 3
    _thing(memory, 1, [0.88, 0.475, 0.0], 2000, 3000)  # the same in another light
    for number in range(2, 2 + others):
        _thing(memory, number, [0.0, 0.0, 1.0], 0, 3000)
        moves.compared.add(number)
    links = moves.find({0, 1}, NOW_MS)
    assert [(link.old.number, link.new.number) for link in links] == ([(0, 1)] if is_linked else [])


def test_a_stranger_s_look_is_no_move_even_of_the_only_such_thing() -> None:
    moves = _moves({"bag": _pairs(int(0.75 * BINS), 30.0)})
    memory = moves._memory
    old = _thing(memory, 0, [1.0, 0.0, 0.0], 0, 1000)
    old.places[0].evidence, old.places[0].misses = 9.0, 3
    _thing(memory, 1, [0.0, 1.0, 0.0], 2000, 3000)
    assert moves.find({0, 1}, NOW_MS) == []


def test_what_is_learned_of_others_counts_at_once() -> None:
    moves = _moves({})
    memory = moves._memory
    old = _thing(memory, 0, [1.0, 0.0, 0.0], 0, 3000)
    new = _thing(memory, 1, [1.0, 0.0, 0.0], 1000, 3000)
    before = moves._densities("bag")
    assert np.array_equal(moves._densities("bag"), before)
    # both were seen since: two of them look just alike
    moves._compare(Kind([(old, old.places[0]), (new, new.places[0])], [new]))
    assert moves._densities("bag")[-1] > before[-1]


def _plain(moves: Moves, came: dict[int, float]) -> list[tuple[int, int]]:
    """Return the moves by the definition alone: every pair among all of them, all known at once."""
    things = [moves._memory.things[number] for number in sorted(moves._memory.things)]
    kind = Kind([(thing, thing.latest) for thing in things], things)
    brought = DEFAULT.move_odds - math.log(len(things) - 1)
    asked = Asked("bag", kind, moves._likenesses(kind), brought)
    moves._look_at(asked, things)
    odds = np.array([
        [
            moves._odds(asked, new, k, lambda thing: came[thing.number])
            if new is not old and place.last_ms < new.first_ms else 0.0
            for k, (old, place) in enumerate(kind.lasts)
        ]
        for new in things
    ])  # fmt: skip
    rivals, found = Rivals.of(odds), []
    for row, k in np.argwhere(odds > 0.0).tolist():
        new, (old, place) = things[row], kind.lasts[k]
        counts = [moves._may_be_gone(asked, new, k, j) for j in range(len(things))]
        sure = place.evidence >= LEFT_LEAST or asked.looks[new.number][k] >= PLAIN_LOOK
        if sure and place.misses and rivals.chance(row, k, np.array(counts)) >= LEAST:
            found.append((new.number, old.number))
    return sorted(found)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_moves_are_those_that_every_rival_leaves_plain(seed: int) -> None:
    rng = np.random.default_rng(seed)
    moves = _moves({"bag": _pairs(UNLIKE, 30.0)})
    came = {}
    for number in range(int(rng.integers(2, 7))):
        look = np.eye(3)[rng.integers(3)] + rng.uniform(0.0, 0.4, 3)
        first = int(rng.integers(0, 4)) * 1000
        thing = _thing(moves._memory, number, look.tolist(), first, first + 500)
        place, came[number] = thing.places[0], float(rng.uniform(0, CAME_MOST))
        place.misses, place.evidence = int(rng.integers(0, 3)), float(rng.uniform(0, 9))
        moves.compared.add(number)
    numbers = {id(thing.places[0]): thing.number for thing in moves._memory.things.values()}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(moves._absence, "came", lambda place: came[numbers[id(place)]])
        found = [(link.new.number, link.old.number) for link in moves.find(set(came), NOW_MS)]
    assert found == _plain(moves, came)


def _left(memory: Memory, number: int, first_ms: int) -> Known:
    thing = _thing(memory, number, [1.0, 0.0, 0.0], first_ms, first_ms + 1000)
    thing.places[0].evidence, thing.places[0].misses = 9.0, 3
    return thing


@pytest.mark.parametrize(("second_ms", "is_linked"), [(2000, True), (500, False)])
def test_traces_of_one_thing_do_not_speak_against_each_other(
    second_ms: int, is_linked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What turned up may be either of two that left; one of them may be the other, moved before."""
    moves = _moves({"bag": _pairs(UNLIKE, 300.0)})
    monkeypatch.setattr(moves._absence, "came", lambda place: CAME_MOST)
    memory = moves._memory
    _left(memory, 0, 0)
    _left(memory, 1, second_ms)
    _thing(memory, 2, [1.0, 0.0, 0.0], 4000, 5000)
    links = {(link.old.number, link.new.number) for link in moves.find({0, 1, 2}, NOW_MS)}
    assert ((1, 2) in links) == is_linked
    assert (0, 2) not in links


@pytest.mark.parametrize("is_chain", [False, True])
def test_what_moved_before_may_have_come_too(
    is_chain: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thing with several places is asked for where it was before the first of them."""
    moves = _moves({"bag": _pairs(UNLIKE, 30.0)})
    monkeypatch.setattr(moves._absence, "came", lambda place: CAME_MOST)
    old = _left(moves._memory, 0, 0)
    new = _thing(moves._memory, 1, [1.0, 0.0, 0.0], 2000, 3000)
    if is_chain:
        new.places.append(Place(1, 4000, 5000, seen=9, moved_from=(0, 0.99)))
    (link,) = moves.find({0, 1}, NOW_MS)
    assert (link.old, link.new) == (old, new)


def test_a_pair_is_asked_again_only_when_more_is_known_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    moves = _moves({"bag": _pairs(UNLIKE, 30.0)})
    memory, asked, link = moves._memory, [], moves._link

    def noted(of: Asked, new: Known, k: int) -> Link | None:
        asked.append((new.number, k))
        return link(of, new, k)

    monkeypatch.setattr(moves, "_link", noted)
    old = _thing(memory, 0, [1.0, 0.0, 0.0], 0, 1000)
    new = _thing(memory, 1, [0.0, 1.0, 0.0], 2000, 3000)  # it looks otherwise
    left = old.places[0]
    left.evidence, left.misses = 2.0, 3
    more, often, told = 2.0 + 1.1 * MORE_GONE, math.ceil(20 * MORE_SEEN), []
    for evidence, seen in (
        (2.0, 20), (2.0, often - 1), (more - 0.2 * MORE_GONE, 20), (more, 20), (more, 20),
        (more, often), (9.0, often),
    ):  # fmt: skip
        left.evidence, new.seen = evidence, seen
        rows = moves.asked_rows()
        moves.asked.clear()
        moves.restore_asked(rows)  # a checkpoint changes nothing
        asked.clear()
        assert moves.find({0, 1}, NOW_MS) == []
        told.append(len(asked))
    assert told == [1, 0, 0, 1, 0, 1, 1]
    left.evidence = 30.0  # no look in vain tells more than enough of them do
    for later_ms, is_asked in ((ASK_AGAIN_MS - 1, False), (ASK_AGAIN_MS, True)):
        asked.clear()
        moves.find({0, 1}, NOW_MS + later_ms)
        assert bool(asked) == is_asked  # what is known of all others may be more by then
