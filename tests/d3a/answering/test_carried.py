"""What carries a thing, or is over it: of a desk and what stands beside it, one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from d3a.answering.carried import Lying
from d3a.answering.joins import Asked
from d3a.answering.linked import Link, pairs_of
from d3a.answering.match import Candidate
from d3a.answering.moments import Found
from d3a.model import Box, Position
from d3a.parameters import DEFAULT
from d3a.store.base import Encounter, ObjectRecord, Sighting, StayRecord
from grammar.forms import RelationKind

BOX = (0.0, 0.0, 10.0, 10.0)
FACING = (-0.5, 0.5, -0.5, 0.5)
"""A camera that looks along +x."""
SURE = (0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01)
Thing = tuple[Position, tuple[float, float] | None]
DESK: Thing = ((3.0, 0.0, 0.37), (1.4, 0.74))
CHAIR: Thing = ((2.4, 0.0, 0.45), (0.6, 0.9))
CUP: Thing = ((2.7, 0.1, 0.79), (0.1, 0.1))
"""On the desk's edge, above the chair's seat and as high as its back."""


def found(**things: Thing) -> Found:
    table = Found()
    for name, (position, extent) in things.items():
        record = ObjectRecord(name, name, 9.0, 0, 99, extent_m=extent)
        table.candidates[name] = Candidate(record, 1.0)
        table.stays[name, 0] = StayRecord(name, 0, position, 0, 99, 9.0, covariance=SURE)
        viewer = (0.0, 0.0, 1.2, *FACING)
        table.sightings.append(Sighting(name, 0, 0, 99, "f", 0.9, BOX, viewer=viewer))
    return table


def held(kind: RelationKind, figure: Found, ground: Found, carriers: Found | None) -> float:
    return judged(Asked(kind, figure, ground, DEFAULT, carriers=carriers or Found()))


def judged(asked: Asked, *frames: Encounter) -> float:
    (p,) = {float(p) for p in asked.judged(asked.links(frames)).probability}
    return p


def frame(one: str, other: str, box: Box, other_box: Box) -> Encounter:
    viewer = (0.0, 0.0, 1.2, *FACING)
    return Encounter(one, other, 0, 0, 5, 6, "f", box, other_box, 0.9, viewer=viewer)


def test_what_lies_on_a_desk_does_not_lie_on_the_chair_beside_it() -> None:
    cup, desk, chair = found(cup=CUP), found(desk=DESK), found(chair=CHAIR)
    alone = Asked("on", cup, chair, DEFAULT)
    shown = frame("chair", "cup", (100.0, 100.0, 160.0, 190.0), (121.0, 101.0, 131.0, 111.0))
    assert judged(replace(alone, carriers=desk), shown) < 0.5 < judged(alone, shown)
    assert held("on", cup, desk, chair) > 0.5
    assert held("on", cup, desk, desk) == held("on", cup, desk, None)  # it is no rival of itself


def test_what_is_under_the_low_table_is_not_under_the_couch_behind_it() -> None:
    bowl: Thing = ((2.9, 0.0, 0.05), (0.1, 0.1))
    couch, table = found(couch=((3.3, 0.0, 0.42), (1.6, 0.85))), ((2.5, 0.0, 0.2), (1.2, 0.5))
    usual: dict[RelationKind, set[str]] = {"under": {"couch", "table"}}
    alone = Asked("under", found(bowl=bowl), couch, DEFAULT, usual=usual)
    beside = replace(alone, carriers=found(table=table))
    shown = frame("bowl", "couch", (192.0, 185.0, 207.0, 200.0), (100.0, 100.0, 300.0, 200.0))
    assert judged(alone, shown) > 0.5 > judged(beside, shown)


def test_more_that_may_carry_a_thing_makes_each_less_likely() -> None:
    cup, desk = found(cup=CUP), found(desk=DESK)
    shelf: Thing = ((2.4, 0.2, 0.37), (1.0, 0.74))
    one, two = found(shelf=shelf), found(shelf=shelf, sideboard=shelf)
    alone, beside, between = (held("on", cup, desk, each) for each in (None, one, two))
    assert alone > beside > between > 0.0


def test_what_stands_on_the_ground_carries_with_it() -> None:
    cup, desk = found(cup=CUP), found(desk=DESK)
    tray: Thing = ((2.9, 0.05, 0.72), (0.6, 0.1))
    alone = held("on", cup, desk, None)
    assert held("on", cup, desk, found(tray=tray)) == pytest.approx(alone, abs=0.15)


@pytest.mark.parametrize("kind", ["behind", "in_front_of"])
def test_what_is_on_a_thing_is_neither_before_nor_behind_it(kind: RelationKind) -> None:
    sign = 1.0 if kind == "behind" else -1.0
    counter, none = found(counter=((3.0, 0.0, 0.45), (2.0, 0.9))), Found()
    on_top: Thing = ((3.0 + sign * 0.15, 0.0, 0.97), (0.1, 0.14))
    beyond: Thing = ((3.0 + sign * 1.2, 0.0, 0.4), (0.4, 0.8))
    assert held(kind, found(cup=on_top), counter, none) < 0.3
    assert held(kind, found(chair=beyond), counter, none) > 0.7
    other: RelationKind = "in_front_of" if kind == "behind" else "behind"
    assert held(other, counter, found(cup=on_top), none) < 0.3


def test_what_nothing_measured_stays_untold() -> None:
    cup, desk = found(cup=CUP), found(desk=DESK)
    for table in (cup, desk):
        for key, stay in table.stays.items():
            table.stays[key] = StayRecord(*key, None, 0, 99, stay.weight)
    link = Link(("cup", 0), ("desk", 0), 0, 99, sightings=(cup.sightings[0], desk.sightings[0]))
    pairs = pairs_of([link], cup, desk)
    lying = Lying([link], pairs, cup, desk, found(chair=CHAIR), {}, DEFAULT)
    assert np.isnan([lying.told("on"), lying.told("under"), lying.told("above")]).all()


def test_a_link_turned_twice_is_the_link() -> None:
    cup, desk = found(cup=CUP), found(desk=DESK)
    link = Link(("cup", 0), ("desk", 0), 0, 99, sightings=(cup.sightings[0], desk.sightings[0]))
    assert link.turned().figure == link.ground
    assert link.turned().seen() == link.seen()[::-1]
    assert link.turned().turned() == link._replace(flipped=False)


def test_furniture_is_not_upon_furniture() -> None:
    stand: Thing = ((3.0, 0.1, 0.94), (0.3, 0.4))
    furniture: dict[RelationKind, set[str]] = {"under": {"stand", "desk"}}
    asked = Asked("on", found(stand=stand), found(desk=DESK), DEFAULT)
    assert judged(asked) > 0.5 > judged(replace(asked, usual=furniture))
    below = Asked("under", found(desk=DESK), found(stand=stand), DEFAULT, usual=furniture)
    assert judged(below) < 0.5


def test_what_a_thing_lies_on_is_under_it_and_it_above_that() -> None:
    cup, desk = found(cup=CUP), found(desk=DESK)
    on = held("on", cup, desk, None)
    assert 0.5 < on <= held("under", desk, cup, None) == held("above", cup, desk, None)
    assert held("under", cup, desk, None) < 0.5
