from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from d3a.model import Detection
from d3a.parameters import PAPER
from d3a.sightings import FrameRef, Scene
from d3a.tier1 import Member, SlidingWindow, components, dbscan, distances, things
from tests.worlds.rounds import colour


def seen(x: float, look: int = 1, category: str = "cup", probability: float = 0.8) -> Detection:
    return Detection(
        category, probability, (x, 0, x + 5, 5), position=(x, 0.0, 0.0), embedding=colour(look)
    )


def scene(number: int, *detections: Detection, step_s: float = 1.0) -> Scene:
    return Scene(FrameRef(f"f{number}", round(number * step_s * 1000)), detections)


def test_one_frame_is_noise_and_two_are_a_cluster() -> None:
    window = SlidingWindow(PAPER)
    assert window.push(scene(0, seen(1.0))) == ([], [])
    (cluster,), noise = window.push(scene(1, seen(1.2)))
    assert not noise
    assert len(cluster.members) == 2
    assert cluster.position[0] == pytest.approx(1.1)
    assert cluster.weight == pytest.approx(1.6)


def test_two_boxes_of_one_frame_are_no_cluster() -> None:
    window = SlidingWindow(PAPER)
    clusters, _ = window.push(scene(0, seen(1.0), seen(1.1)))
    assert clusters == []


@pytest.mark.parametrize(
    "other",
    [seen(1.0, category="bowl"), seen(1.0, look=9), seen(1.6)],
    ids=["category", "look", "place"],
)
def test_each_gate_separates(other: Detection) -> None:
    window = SlidingWindow(PAPER)
    window.push(scene(0, seen(1.0)))
    clusters, _ = window.push(scene(1, other))
    assert clusters == []


def test_the_distance_reading_of_the_threshold_is_stricter() -> None:
    near = Member(FrameRef("a", 0), seen(1.0))
    far = Member(FrameRef("b", 1), seen(1.0))
    mixed = colour(1) + 1.2 * colour(5)
    far.detection = Detection(
        "cup", 0.8, (0, 0, 5, 5), position=(1.0, 0, 0), embedding=mixed / np.linalg.norm(mixed)
    )
    assert distances([near], [far], PAPER)[0, 0] <= 1.0
    assert distances([near], [far], PAPER.with_changes(min_similarity=0.75))[0, 0] > 1.0


def test_what_is_unknown_does_not_separate() -> None:
    a = Member(FrameRef("a", 0), Detection("cup", 0.8, (0, 0, 5, 5)))
    b = Member(FrameRef("b", 1), seen(40.0))
    assert distances([a], [b], PAPER)[0, 0] == 0.0


def test_each_detection_is_counted_once_and_labels_carry_over() -> None:
    window = SlidingWindow(PAPER)
    counted: list[Member] = []
    for number in range(25):
        clusters, noise = window.push(scene(number, seen(1.0 + 0.01 * number)))
        assert not noise
        for cluster in clusters:
            if number > 1:
                assert cluster.label == 7
                assert len(cluster.members) == 1
            for member in cluster.members:
                member.label = 7
            counted += cluster.members
    assert len(counted) == len(set(map(id, counted))) == 25


def test_a_pause_starts_a_new_window() -> None:
    window = SlidingWindow(PAPER)
    window.push(scene(0, seen(1.0)))
    clusters, noise = window.push(scene(61, seen(1.0)))
    assert clusters == []
    assert len(noise) == 1


def test_what_leaves_the_window_uncounted_is_noise() -> None:
    window = SlidingWindow(PAPER)
    window.push(scene(0, seen(1.0)))
    left = [noise for n in range(1, 12) for noise in window.push(scene(n))[1]]
    assert len(left) == 1
    assert all(not m.neighbours for m in left)


positions = st.lists(st.integers(0, 25).map(lambda n: n * 0.2), max_size=5)


@settings(deadline=None, max_examples=30)
@given(st.lists(positions, min_size=1, max_size=14), st.integers(1, 2))
def test_components_are_dbscan(frames: list[list[float]], looks: int) -> None:
    """The links that are kept frame by frame give what scikit-learn gives on the whole window."""
    window = SlidingWindow(PAPER)
    for number, xs in enumerate(frames):
        window.push(scene(number, *(seen(x, look=1 + i % looks) for i, x in enumerate(xs))))
        members = [m for _, each in window.frames for m in each]
        left = [[id(m) for m in group] for group in components(members)]
        assert left == [[id(m) for m in group] for group in dbscan(members, PAPER)]


def test_boxes_that_coincide_are_one_thing_named_twice() -> None:
    chair = Detection("chair", 0.9, (0, 0, 100, 100))
    bench = Detection("bench", 0.4, (2, 0, 100, 98))
    cup = Detection("cup", 0.8, (0, 0, 20, 20))
    found = things([bench, cup, chair], PAPER)
    assert [thing.detection.category for thing in found] == ["chair", "cup"]
    assert found[0].votes == (("bench", 0.4), ("chair", 0.9))
    assert set(found[0].rows) == {chair, bench}
    assert things([], PAPER) == []


def test_a_scene_has_an_order_of_its_own() -> None:
    detections = [seen(3.0), seen(1.0), seen(2.0, probability=0.9)]
    one, other = scene(0, *detections), scene(0, *reversed(detections))
    assert one.detections == other.detections
    assert all(a.probability >= b.probability for a, b in pairwise(one.detections))
