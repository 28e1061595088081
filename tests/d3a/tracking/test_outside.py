"""The index of what left the memory: what it says is near is what a look at each row says."""

from __future__ import annotations

import numpy as np
import pytest

from d3a.tracking.outside import Outside

NOISE = np.array([[0.04, 0.04, 0.02]])


def test_what_is_near_is_found_until_it_is_removed() -> None:
    index = Outside()
    index.add("o1", (1.0, 0.0, 0.0), (0.01, 0.01, 0.01))
    index.add("o2", (9.0, 0.0, 0.0), (0.01, 0.01, 0.01))
    assert index.near(np.zeros((1, 3)), NOISE, 5.0) == {"o1"}
    assert "o1" in index
    index.remove(["o1"])
    assert index.near(np.zeros((1, 3)), NOISE, 5.0) == set()
    assert "o1" not in index
    assert index.near(np.array([[9.0, 0.0, 0.0]]), NOISE, 5.0) == {"o2"}


def test_what_has_no_place_may_be_anywhere() -> None:
    index = Outside()
    index.add("o1", None, (0.0, 0.0, 0.0))
    assert index.near(np.empty((0, 3)), np.empty((0, 3)), 5.0) == {"o1"}
    index.clear()
    assert index.near(np.zeros((1, 3)), NOISE, 5.0) == set()


def test_a_position_that_is_not_known_is_near_to_nothing() -> None:
    index = Outside()
    index.add("o1", (1.0, 0.0, 0.0), (0.01, 0.01, 0.01))
    assert index.near(np.full((1, 3), np.nan), NOISE, 5.0) == set()


@pytest.mark.parametrize("seed", range(5))
def test_any_order_of_adding_and_removing_leaves_what_is_there(seed: int) -> None:
    generator = np.random.default_rng(seed)
    index, truth = Outside(), dict[str, list[tuple[float, float, float]]]()
    for _ in range(400):
        name = f"o{generator.integers(60)}"
        if name in truth and generator.random() < 0.5:
            index.remove([name])
            del truth[name]
        else:
            x, y, z = generator.uniform(0.0, 10.0, 3).tolist()
            index.add(name, (x, y, z), (0.01, 0.01, 0.01))
            truth.setdefault(name, []).append((x, y, z))
    seen = generator.uniform(0.0, 10.0, (3, 3))
    reach = 5.0 * np.sqrt(NOISE + 0.01)
    near = {
        name
        for name, places in truth.items()
        for place in places
        if np.any(np.all(np.abs(seen - np.array(place)) <= reach, axis=1))
    }
    assert index.near(seen, np.repeat(NOISE, 3, axis=0), 5.0) == near
    assert all(name in index for name in truth)
