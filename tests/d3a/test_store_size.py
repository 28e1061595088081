from __future__ import annotations

import numpy as np
import pytest

from d3a.model import Box
from d3a.store.base import Sighting
from d3a.store_size import against_naive


def sighting(start_ms: int, frame: str, box: Box) -> Sighting:
    return Sighting(
        object_id="o1", place=0, start_ms=start_ms, end_ms=start_ms, frame=frame,
        probability=0.9, box=box,
    )  # fmt: skip


def test_entries_and_crops_are_counted_against_all_detections() -> None:
    boxes = np.array([[0, 0, 10, 10], [0, 0, 20, 20], [0, 0, 10, 10], [0, 0, 20, 10]], dtype=float)
    kept = [sighting(0, "a", (0, 0, 10, 10)), sighting(1, "a", (0, 0, 10, 10))]
    found = against_naive([*kept, sighting(2, "b", (0, 0, 10, 10))], boxes)
    assert found.entries == 2
    assert found.pictures == 2.0
    assert found.crops == pytest.approx(800 / 200)
    assert found.entries_mb == pytest.approx(2.6)


def test_an_empty_store_has_a_size_too() -> None:
    assert against_naive([], np.zeros((5, 4))).pictures == 5.0
