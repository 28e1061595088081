"""What a shared frame measures between two things, and what becomes of it."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from d3a.ledger import Ledger
from d3a.model import Detection, Position
from d3a.parameters import DEFAULT
from d3a.sightings import FrameRef
from d3a.store.base import Encounter
from d3a.tracking.encounters import Encounters, apart
from tests.worlds.oracle import OracleStore

BOX, OTHER_BOX = (0.0, 0.0, 10.0, 10.0), (20.0, 0.0, 30.0, 10.0)


def seen_at(position: Position | None, sigma: float | None = 0.1) -> Detection:
    variance = None if sigma is None else sigma**2
    covariance = None if variance is None else (variance, 0, 0, 0, variance, 0, 0, 0, variance)
    return Detection("cup", 0.9, BOX, position, covariance)


def test_a_frame_measures_how_far_two_things_are_apart() -> None:
    told = apart(seen_at((1.0, 2.0, 0.5), 0.3), seen_at((1.5, 1.0, 0.5), 0.4))
    assert told == pytest.approx((0.5, -1.0, 0.0, 0.5))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (seen_at(None), seen_at((1.0, 0.0, 0.0))),
        (seen_at((1.0, 0.0, 0.0), None), seen_at((2.0, 0.0, 0.0))),
        (seen_at((1.0, 0.0, 0.0)), seen_at((1.0, 0.0, 0.0))),  # the robot's own place for both
        (seen_at((1.0, 0.0, 0.0), 0.9), seen_at((2.0, 0.0, 0.0), 0.9)),  # an assumed range
    ],
)
def test_what_was_not_measured_is_not_told(one: Detection, other: Detection) -> None:
    assert apart(one, other) is None
    assert apart(other, one) is None


def test_several_frames_are_a_mean_that_is_surer() -> None:
    ledger, met = Ledger(OracleStore()), Encounters(DEFAULT)
    for n, (gap, sigma) in enumerate(((0.2, 0.1), (0.5, 0.2), (9.0, 2.0))):
        two = [(("a", 0), seen_at((0.0, 0.0, 0.0), sigma)), (("b", 0), seen_at((gap, 0, 0), sigma))]
        met.add(FrameRef(f"f{n}", 1000 * n), two, ledger)
    (record,) = met.to_state()["open"]
    assert record["seen"] == 3
    assert record["apart"] == pytest.approx((0.26, 0.0, 0.0, math.sqrt(0.02 * 0.08 / 0.1)))
    again = Encounters(DEFAULT)
    again.restore({"open": [record | {"apart": list(record["apart"])}]})
    assert again.to_state()["open"] == [record]


def test_a_renamed_encounter_is_measured_from_its_new_first_thing() -> None:
    one = Encounter("a", "b", 1, 2, 5, 9, "f", BOX, OTHER_BOX, 0.5, apart=(0.1, -0.2, 0.3, 0.05))
    after = one.renamed({("a", 1): ("c", 4)})
    assert after is not None
    assert (after.object_a, after.place_a, after.object_b, after.place_b) == ("b", 2, "c", 4)
    assert (after.box_a, after.box_b) == (OTHER_BOX, BOX)
    assert after.apart == (-0.1, 0.2, -0.3, 0.05)
    assert after.renamed({("c", 4): ("a", 1)}) == one
    assert one.renamed({("b", 2): ("a", 7)}) is None
    unmeasured = replace(one, apart=None).renamed({("a", 1): ("c", 4)})
    assert unmeasured is not None
    assert unmeasured.apart is None


@pytest.mark.parametrize("order", [("b", "c"), ("c", "b")])
def test_of_two_that_become_one_what_was_seen_last_goes_on(order: tuple[str, str]) -> None:
    ledger, met = Ledger(OracleStore()), Encounters(DEFAULT)
    for n, name in enumerate(order):
        two = [(("a", 0), seen_at((0.0, 0.0, 0.0))), ((name, 0), seen_at((1.0, 0, 0)))]
        met.add(FrameRef(f"f{n}", 1000 * n), two, ledger)
    met.write_some({"b", "c"}, ledger)
    met.rename(("c", 0), ("b", 0))
    (record,) = met.to_state()["open"]
    assert (record["object_a"], record["object_b"], record["end_ms"]) == ("a", "b", 1000)


def test_only_what_changed_of_some_is_written_and_the_rest_later() -> None:
    ledger, met = Ledger(OracleStore()), Encounters(DEFAULT)
    names = ("a", "b", "c", "d")
    shown = [((name, 0), seen_at((float(k), 0.0, 0.0))) for k, name in enumerate(names)]
    met.add(FrameRef("f", 0), shown, ledger)
    met.write_some({"a"}, ledger)
    assert [e.object_b for e in ledger.encounters(None)] == ["b", "c", "d"]
    met.rename(("a", 0), ("e", 0))
    met.write(ledger)
    written = [(e.object_a, e.object_b) for e in ledger.encounters(None)]
    assert written == [("a", "b"), ("a", "c"), ("a", "d"), ("b", "c"), ("b", "d"), ("c", "d")]
