"""The synthetic detector: exact without noise, in proportion to its rates with it."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from d3a.detectors.synthetic import (
    LOOK_ALIKES,
    DetectorNoise,
    Sighted,
    SyntheticDetector,
    VisibleObject,
)
from d3a.model import BadInput, Box, Camera

CAMERA = Camera(width=480, height=360, fx=400.0, fy=400.0, cx=240.0, cy=180.0)
CUP = VisibleObject("cup-1", "cup", (200.0, 150.0, 260.0, 220.0), 1.0, 1.5, (1.0, 2.0, 0.8))
BOWL = VisibleObject("bowl-1", "bowl", (10.0, 20.0, 110.0, 90.0), 0.9, 2.0, (2.0, 2.0, 0.8))
NO_FAULTS = DetectorNoise(
    fnr=0.0, fpr=0.0, confusion=0.0, half_seen_px=0.1, box_jitter=0.0, range_noise_m=0.0
)


def looks(
    noise: DetectorNoise | None, seen: tuple[VisibleObject, ...], times: int, seed: int = 3
) -> list[tuple[Sighted, ...]]:
    rng = np.random.default_rng(seed)
    detector = SyntheticDetector(noise, ("cup", "vase"))
    return [detector.detect(seen, CAMERA, rng) for _ in range(times)]


def test_perfect_detector_gives_the_truth() -> None:
    (sighted,) = looks(None, (CUP, BOWL), 1)
    assert [s.source for s in sighted] == ["cup-1", "bowl-1"]
    for found, seen in zip(sighted, (CUP, BOWL), strict=True):
        assert found.detection.box == seen.box
        assert found.detection.position == seen.position
        assert found.detection.category == seen.category
        assert found.detection.probability == 1.0


def test_same_seed_gives_the_same_detections_and_another_seed_others() -> None:
    noise = DetectorNoise(fnr=0.3, fpr=0.3, confusion=0.3)
    assert looks(noise, (CUP, BOWL), 20) == looks(noise, (CUP, BOWL), 20)
    assert looks(noise, (CUP, BOWL), 20) != looks(noise, (CUP, BOWL), 20, seed=4)


@pytest.mark.parametrize("fnr", [0.0, 0.2, 0.6, 1.0])
def test_an_object_in_plain_view_is_missed_at_the_given_rate(fnr: float) -> None:
    times = 2000
    found = sum(len(s) for s in looks(DetectorNoise(fnr=fnr, fpr=0.0), (CUP,), times))
    assert found / times == pytest.approx(1 - fnr, abs=0.04)


@pytest.mark.parametrize("fpr", [0.0, 0.1, 0.5])
def test_false_boxes_come_at_the_given_rate_and_lie_in_the_picture(fpr: float) -> None:
    times = 2000
    false = [
        s
        for sighted in looks(DetectorNoise(fpr=fpr), (CUP, BOWL), times)
        for s in sighted
        if s.source is None
    ]
    assert len(false) / (2 * times) == pytest.approx(fpr, abs=0.03)
    for sighted in false:
        x1, y1, x2, y2 = sighted.detection.box
        assert 0 <= x1 < x2 <= CAMERA.width
        assert 0 <= y1 < y2 <= CAMERA.height
        assert sighted.detection.category in ("cup", "vase")


def test_a_false_box_lies_on_the_surface_behind_it() -> None:
    asked: list[Box] = []

    def wall(box: Box) -> tuple[float, float, float]:
        asked.append(box)
        return (4.0, 5.0, 1.0)

    rng = np.random.default_rng(0)
    sighted = SyntheticDetector(DetectorNoise(fpr=1.0), ("cup",)).detect(
        (CUP,) * 5, CAMERA, rng, wall
    )
    false = [s.detection for s in sighted if s.source is None]
    assert false
    assert [d.box for d in false] == asked
    assert {d.position for d in false} == {(4.0, 5.0, 1.0)}


def test_small_and_hidden_things_are_missed_more_often_and_reported_with_less_certainty() -> None:
    speck = VisibleObject("cup-2", "cup", (0.0, 0.0, 11.0, 11.0), 1.0, 4.0, None)
    hidden = VisibleObject("cup-3", "cup", (0.0, 0.0, 60.0, 60.0), 0.3, 1.5, None)
    counts: Counter[str | None] = Counter()
    scores: dict[str | None, list[float]] = {}
    for sighted in looks(DetectorNoise(fpr=0.0, fnr=0.0), (CUP, speck, hidden), 1500):
        for s in sighted:
            counts[s.source] += 1
            scores.setdefault(s.source, []).append(s.detection.probability)
    assert counts["cup-1"] == 1500
    assert counts["cup-2"] / 1500 == pytest.approx(0.5, abs=0.05)
    assert counts["cup-3"] / 1500 == pytest.approx(0.4, abs=0.05)
    assert np.mean(scores["cup-1"]) > np.mean(scores["cup-2"]) > np.mean(scores["cup-3"])


def test_confusions_stay_among_look_alikes_at_the_given_rate() -> None:
    noise = DetectorNoise(fnr=0.0, fpr=0.0, confusion=0.2)
    named = Counter(s.detection.category for seen in looks(noise, (CUP,), 3000) for s in seen)
    assert set(named) == {"cup", *LOOK_ALIKES["cup"]}
    assert 1 - named["cup"] / 3000 == pytest.approx(0.2, abs=0.03)


def test_position_error_grows_with_range_and_is_not_biased() -> None:
    far = VisibleObject("cup-4", "cup", CUP.box, 1.0, 5.0, CUP.position)
    noise = DetectorNoise(fnr=0.0, fpr=0.0, confusion=0.0)

    def errors(seen: VisibleObject) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        found = [s.detection.position for sighted in looks(noise, (seen,), 1500) for s in sighted]
        return np.asarray(np.array(found) - np.array(seen.position))

    near_error, far_error = errors(CUP), errors(far)
    assert near_error.std() == pytest.approx(0.01 + noise.range_noise_m * 1.5**2, rel=0.1)
    assert far_error.std() == pytest.approx(0.01 + noise.range_noise_m * 5.0**2, rel=0.1)
    assert abs(near_error.mean()) < 0.002


def test_boxes_at_the_picture_edge_stay_inside_and_keep_a_width() -> None:
    edge = VisibleObject("cup-5", "cup", (470.0, 350.0, 480.0, 360.0), 1.0, 1.0, None)
    noise = DetectorNoise(fnr=0.0, fpr=0.0, half_seen_px=0.1, box_jitter=0.5)
    for sighted in looks(noise, (edge,), 500):
        for s in sighted:
            x1, y1, x2, y2 = s.detection.box
            assert 0 <= x1 <= x2 - 2 <= CAMERA.width - 2
            assert 0 <= y1 <= y2 - 2 <= CAMERA.height - 2


def test_without_position_none_is_made_up() -> None:
    unplaced = VisibleObject("cup-6", "cup", CUP.box)
    assert {s.detection.position for seen in looks(NO_FAULTS, (unplaced,), 5) for s in seen} == {
        None
    }


@pytest.mark.parametrize(
    "wrong",
    [
        {"fnr": -0.1},
        {"fpr": 1.5},
        {"confusion": float("nan")},
        {"half_seen_px": 0.0},
        {"box_jitter": -1},
    ],
)
def test_impossible_rates_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(BadInput):
        DetectorNoise(**wrong)  # type: ignore[arg-type]  # any field by name is what is tested
