"""Whether one thing is before another for who looks at both: what of either shows, and where.

Boxes tell it best where things show whole. What is hidden in part may go on to either side, and
then places and widths tell as much.
"""

from __future__ import annotations

import numpy as np

from d3a.answering.pairs import (
    EDGE_M,
    Floats,
    Pairs,
    camera_axis,
    distance_of,
    normal_cdf,
    soft_step,
)

LEAST_SEEN = 2.0
"""A thing is at most so many times as wide as what is seen of it."""
WHOLE_SHARE = 0.25
"""Where so much of a thing is hidden, its place tells as much of it as its box."""


def in_line(pairs: Pairs) -> Floats:
    """Return the probability that one is before the other, whichever (n,), NaN if untold."""
    whole_a, hidden_a = _whole(pairs.extent_a, pairs.box_a)
    whole_b, hidden_b = _whole(pairs.extent_b, pairs.box_b)
    left = np.maximum(pairs.box_a[:, 0], pairs.box_b[:, 0])
    right = np.minimum(pairs.box_a[:, 2], pairs.box_b[:, 2])
    beyond = (hidden_a * whole_a + hidden_b * whole_b) / 2
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(right - left + beyond, 0.0, None) / np.minimum(whole_a, whole_b)
        by_box = soft_step(share, 0.1, 0.08)
        by_place = normal_cdf(-_gap_across(pairs) / np.hypot(pairs.sigma, EDGE_M))
    weight = np.clip(np.maximum(hidden_a, hidden_b) / WHOLE_SHARE, 0.0, 1.0) / 2
    both = np.where(np.isnan(by_place), by_box, by_box + weight * (by_place - by_box))
    return np.where(pairs.shared, both, by_place)


def _whole(extent: Floats, box: Floats) -> tuple[Floats, Floats]:
    """Return how wide things would show whole, pixels (n,), and which share of that is hidden.

    By how high they show. What is unknown of size shows whole.
    """
    seen = box[:, 2] - box[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        by_height = extent[:, 0] / extent[:, 1] * (box[:, 3] - box[:, 1])
        whole = np.fmax(seen, np.fmin(LEAST_SEEN * seen, by_height))
        return whole, 1.0 - seen / whole


def _gap_across(pairs: Pairs) -> Floats:
    """Return the metres between two things as the viewer sees them side by side, NaN if untold.

    By their places and widths, where the nearer is; negative where one is before the other.
    """
    sides, halves, depths = [], [], []
    for place, extent in ((pairs.position_a, pairs.extent_a), (pairs.position_b, pairs.extent_b)):
        away = place - pairs.viewer[:, :3]
        ahead = np.maximum((away * camera_axis(pairs.viewer, 2)).sum(axis=1), EDGE_M)
        sides.append((away * camera_axis(pairs.viewer, 0)).sum(axis=1) / ahead)
        halves.append(extent[:, 0] / 2 / ahead)
        depths.append(ahead)
    gap = (np.abs(sides[0] - sides[1]) - halves[0] - halves[1]) * np.minimum(*depths)
    return np.where(np.isnan(distance_of(pairs)), np.nan, gap)
