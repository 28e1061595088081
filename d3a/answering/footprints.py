"""How likely a figure stands within a ground's outline, seen from above: on, under, in or over it.

A picture shows a ground's width and not its depth, and of what is wide seldom all. What is narrow
is about as deep as wide; what is wide is furniture: tables, desks and couches measure about as
much round two sides, so that seen from its end a thing goes the further back.
"""

from __future__ import annotations

import numpy as np

from d3a.answering.pairs import (
    THIN_M,
    Floats,
    Pairs,
    as_factor,
    box_middle,
    metres_a_pixel,
    normal_cdf,
    soft_step,
    spread_out,
    within,
)

UNMEASURED_M = 0.9
"""Half the width of a ground that nothing measured and none of its kind."""
WIDE_M = 0.75
"""What is as wide as a table is seldom seen whole, and is longer one way than the other."""
PART_M = 0.65
"""And what is called a table was seen in part, if it measures but this."""
HALF_SHARE = 0.39
"""Half the side of what is square, as a share of its width: seen from anywhere, this is on
average 4 / pi of the side."""
RIM_M = 0.05
"""How far beyond a ground's measured outline a figure's middle may be."""
LONG_M, GROWS = 1.6, 1.5
"""What is wide is at least so long as furniture is, but no more than so many times as seen."""
AROUND_M, SIDES = 2.8, 1.5
"""Furniture measures so much round two sides, and at least so many of its widths."""
DEPTH_SIGMA_M = 0.2
"""The deviation of half a depth that is known from such measures alone."""
LEAST_SHOWN_M = 0.3
"""A smaller part of what is wide does not tell which of its sides is seen."""


def footprint(pairs: Pairs, wide_from_m: Floats | float = WIDE_M) -> Floats:
    """Return the probability that the figure stands within the ground's outline, (n,).

    wide_from_m: what measures so much is wider than was seen, and longer one way than the other.
    Across the view a shared frame tells it too, without the error of the robot's place: the mean
    counts. Without a viewer it is told by the distance alone. NaN where nothing tells it.
    """
    width = pairs.extent_b[:, 0]
    wide = soft_step(width, wide_from_m, 0.04)
    whole = np.where(wide > 0.5, np.maximum(width, np.minimum(GROWS * width, LONG_M)), width)
    half = (1 - wide) * HALF_SHARE * width + wide * whole / 2 + RIM_M
    half = np.where(np.isnan(width), UNMEASURED_M, half)
    across, along = spread_out(pairs)
    in_picture, shown = _in_picture(pairs, whole)
    by_place = _inside(half, across, pairs.sigma)
    sideways = np.where(np.isnan(in_picture), by_place, (by_place + in_picture) / 2)
    deep = np.where(np.isnan(width), half, (1 - wide) * half + wide * _half_depth(width, shown))
    unsure = np.hypot(pairs.sigma, DEPTH_SIGMA_M * np.nan_to_num(wide))
    by_sides = sideways * _inside(deep, along, unsure)
    about = within(pairs, half, level=True) * as_factor(in_picture)
    return np.where(np.isnan(by_sides), about, by_sides)


def _half_depth(width: Floats, shown: Floats) -> Floats:
    """Return how far furniture goes back from its middle, by its width and how wide it shows."""
    seen = np.where(np.isnan(shown), width, np.maximum(shown, LEAST_SHOWN_M))
    around = np.maximum(AROUND_M, SIDES * width)
    return np.asarray(np.clip(around - seen, THIN_M, LONG_M) / 2 + RIM_M)


def _in_picture(pairs: Pairs, whole: Floats) -> tuple[Floats, Floats]:
    """Return the probability by the boxes alone, across the picture, and how wide the ground shows.

    whole: metres that it is wide; what does not show may be on either side. NaN without a frame.
    """
    width = pairs.box_b[:, 2] - pairs.box_b[:, 0]
    own = metres_a_pixel(pairs.extent_b, pairs.box_b)
    scale = np.fmin(own, metres_a_pixel(pairs.extent_a, pairs.box_a))
    shown = width * scale
    apart = np.abs(box_middle(pairs.box_a) - box_middle(pairs.box_b))[:, 0] * scale
    hidden = np.nan_to_num(np.clip(whole - width * own, 0.0, None))
    limit = shown / 2 + hidden + RIM_M
    return _inside(limit, apart, 0.1 * apart + RIM_M), shown


def _inside(half: Floats, off: Floats, sigma: Floats) -> Floats:
    """Return the probability of being within half a width of the middle, measured `off` it.

    Beyond either side: of a narrow thing's outline much of what may be true is outside of it.
    """
    return normal_cdf((half - off) / sigma) - normal_cdf((-half - off) / sigma)
