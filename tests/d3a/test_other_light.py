"""Things that look otherwise at the next visit, as the light is another one."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from d3a.checkpoint import unpack
from d3a.images import unit
from d3a.ingest import ingest
from d3a.model import Detection, Frame, Pose
from d3a.parameters import DEFAULT
from d3a.tracking import plain
from d3a.tracking.known import Known
from d3a.tracking.light import Light
from d3a.tracking.likelihood import LATER, LookModel
from d3a.tracking.memory import Looks
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import CAMERA, FORWARD, START_MS, ListReader, Thing, colour

HOUR_MS = 3_600_000
NAMES = ("cup", "book", "lamp", "vase", "radio", "clock")
SHELF = [Thing(name, (2.0, 0.5 * k - 1.2, 0.0), k) for k, name in enumerate(NAMES)]


def look(thing: Thing, light: int) -> NDArray[np.float32]:
    """In another light than the first nearly all of a thing is of another colour."""
    own = colour(thing.number)
    return own if light == 0 else unit(0.2 * own + colour(10 * light + thing.number))


def visit(number: int, light: int) -> list[Frame]:
    pose, start_ms = Pose((0.0, 0.0, 0.0), FORWARD), START_MS + number * HOUR_MS
    shown = tuple(
        Detection(
            thing.category, 0.9, (10.0 * thing.number, 10.0, 10.0 * thing.number + 8.0, 18.0),
            position=thing.position, embedding=look(thing, light),
        )
        for thing in SHELF
    )  # fmt: skip
    return [
        Frame(f"f{number}-{k}", start_ms + k * 5000, pose, CAMERA, None, None, shown)
        for k in range(8)
    ]


def later(lights: tuple[int, ...]) -> tuple[float, float]:
    """Return how many views of things in another light were learned from, and how alike they are.

    Against those that were known of the same things before.
    """
    store = OracleStore()
    frames = [frame for n, light in enumerate(lights) for frame in visit(n, light)]
    ingest(ListReader(frames), store, DEFAULT)
    assert [stay.seen for stay in store.stays()] == [8 * len(lights)] * len(SHELF)
    state = store.state()
    assert state is not None
    counts, means, _ = unpack(state)[1]["look_model"][:, LATER].T
    return float(counts.sum()), float(counts @ means) / max(float(counts.sum()), 1.0)


def test_how_unlike_views_are_in_another_light_is_learned_from_place_and_name() -> None:
    assert later((0, 0, 0))[0] == 0
    views, likeness = later((0, 1, 2))
    assert views > 20
    assert likeness < 0.6


def test_one_look_that_objects_may_be_that_of_another_thing() -> None:
    thing, looks = Known(1, {"cup": 1.0}, 0, 0, seen=9), LookModel(DEFAULT)
    light = Light(looks, DEFAULT)
    light.learn([(0.9, 20.0), (0.9, 20.0), (0.9, 20.0), (-0.5, 20.0)])
    assert not light.is_later(thing, HOUR_MS)
    assert looks.sums[:, LATER].sum() == 0
    light.learn([(-0.5, 20.0)] * 6)
    assert light.is_later(thing, HOUR_MS)
    assert not light.is_later(thing, 1000), "it was known in this light"
    assert looks.sums[:, LATER, 0].sum() > 0
    light.learn([(0.9, 20.0)] * 3)
    assert not light.is_later(thing, HOUR_MS)


def test_a_look_is_as_old_as_its_views() -> None:
    thing, looks = Known(1, {"cup": 1.0}, 0, 0), Looks()
    looks.add(thing)
    looks.blend(thing, colour(1), 0.5, 1000, most=30.0)
    assert thing.look_ms == 1000
    looks.blend(thing, colour(1), 1.5, 3000, most=30.0)
    assert thing.look_ms == pytest.approx(2500)
    looks.put(thing, colour(2), 9.0, 7000)
    assert (thing.look_ms, thing.look_weight) == (7000, 9.0)


def test_what_is_sure_by_place_and_name_teaches_though_the_look_objects() -> None:
    things = [Known(n, {"cup": 1.0}, 0, 0, seen=9) for n in range(2)]
    evidence = np.array([[DEFAULT.sure_odds, -9.0], [-9.0, DEFAULT.plain_odds]])
    assert plain.sure(things, evidence, DEFAULT) == [(0, 0)]
    assert plain.agreed([-1, 1], evidence, DEFAULT) == [(1, 1)]
    assert plain.agreed([-1, -1], evidence, DEFAULT) == []


@pytest.mark.parametrize("odds", [[6.0, 6.0], [6.0, 0.1]])
def test_what_may_be_two_things_teaches_nothing(odds: list[float]) -> None:
    things = [Known(n, {"cup": 1.0}, 0, 0, seen=9) for n in range(2)]
    assert plain.sure(things, np.array([odds]), DEFAULT) == []
    assert plain.agreed([0], np.array([odds]), DEFAULT) == []
