"""Where the things of a frame may be: places by thing, of which the likeliest counts."""

from __future__ import annotations

import numpy as np

from d3a.tracking.compared import NEVER, Gated
from d3a.tracking.known import Known

THINGS = [Known(number, {"cup": 1.0}, 0, 0) for number in range(3)]
RATIOS = np.array([[[1.0, 4.0, 2.0], [3.0, 0.0, NEVER]], [[1.5, 0.5, 0.0], [2.0, 0.0, NEVER]]])
"""Two detections and three rows; against anything, and against what stands beside."""


def test_a_thing_that_moved_is_where_it_is_likeliest() -> None:
    gated = Gated(THINGS[:2], [7, 8, 9], np.empty((9, 3)), np.zeros(3), [(0, 2), (2, 3)], [], [])
    assert gated.by_thing(RATIOS).tolist() == [
        [[4.0, 2.0], [3.0, NEVER]],
        [[1.5, 0.0], [2.0, NEVER]],
    ]
    assert gated.at(RATIOS[0], [0, 1]) == [8, 9]
    assert gated.at(RATIOS[0], [-1, 0]) == [-1, 7]


def test_what_is_nowhere_may_be_anything() -> None:
    gated = Gated(
        THINGS, [7, 8, 9], np.empty((9, 3)), np.zeros(3), [(0, 2), (2, 3), (0, 0)], [2], [1]
    )
    place = gated.by_thing(RATIOS)
    assert place[0].tolist() == [[4.0, 2.0, 0.0], [0.0, 0.0, 0.0]]
    assert gated.at(RATIOS[0], [2, 0]) == [-1, -1]


def test_each_at_one_place_is_as_it_is() -> None:
    gated = Gated(
        THINGS, [7, 8, 9], np.empty((9, 3)), np.zeros(3), [(0, 1), (1, 2), (2, 3)], [], []
    )
    assert gated.by_thing(RATIOS) is RATIOS
    assert gated.at(RATIOS[0], [2, 0]) == [9, 7]
