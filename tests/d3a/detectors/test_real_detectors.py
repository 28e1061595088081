"""Real networks on real pictures, where they are at hand: pictures alone make a memory."""

from __future__ import annotations

from pathlib import Path

from tests.bench.bench_detector import (
    ORANGE_BOWL,
    SAME_QUESTION,
    WIDE,
    asked,
    detector_share,
    first_frame,
    kitchen,
    kuri,
    right_frames,
)
from tests.bench.bench_real import NEAR_M


def test_cups_and_chairs_are_where_they_are_by_pictures_alone(shared: Path) -> None:
    """The smallest network, which misses most: see the bench for the other family."""
    summary, store, found = kitchen(shared, "yolox-nano-416.onnx", {"threads": "1"})
    assert len(found) == 6
    assert [(each.name, each.stays) for each in found if each.distance_m <= NEAR_M] == [
        (each.name, 1) for each in found
    ]
    assert sum(r.category == "cup" and not r.tentative for r in store.objects()) == 2
    assert detector_share(summary) > 0.5
    assert store.check() == []


def test_the_orange_bowl_is_found_in_the_jpegs_alone(shared: Path) -> None:
    summary, store = kuri(shared, WIDE, {"threads": "1"})
    assert summary.frames == 30
    assert summary.detections > 60
    assert all(stay.position is None for stay in store.stays())
    (answer,) = asked(store, [ORANGE_BOWL])
    assert answer.status == "found"
    assert first_frame(answer) in right_frames(shared / "data/kuri-sample", SAME_QUESTION)
    (no,) = asked(store, ["Did you ever see a surfboard?"])
    assert (no.status, no.reason) == ("not_found", "never")
    (unknown,) = asked(store, ["Did you ever see a wallet?"])
    assert (unknown.status, unknown.reason) == ("unknown_object", "not_recognisable")
