"""Default profile: how alike the looks of one thing at two places are, and those of two things."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
BINS = 40
"""Of cosines, -1 to 1."""
OTHER_PRIOR, OTHER_MEAN, OTHER_SIGMA = 10.0, 0.3, 0.3
"""Pairs of different things that are assumed before any was seen, and how alike they are."""
SAME_SIGMA, SAME_OUTLIERS = 0.12, 0.05
"""How the likeness of two means of one thing varies in one light, and the share that follows
nothing: another side."""
LIGHT_SHARE, LIGHT_LESS, LIGHT_SIGMA = 0.5, 0.15, 0.17
"""The share of moves into another light, before another background; by how much less alike that
makes the looks, and how much that varies."""


def assumed_others() -> Floats:
    """Return pairs of different things by how alike they are, (BINS,), before any was seen."""
    middle = (np.arange(BINS) + 0.5) * 2 / BINS - 1
    bell = np.exp(-(((middle - OTHER_MEAN) / OTHER_SIGMA) ** 2) / 2)
    return np.asarray(OTHER_PRIOR * bell / bell.sum())


def same_density(above: Floats) -> Floats:
    """Return how dense the looks of a thing at two places lie so much above what is usual."""
    follow = _bell(np.minimum(above, 0.0), SAME_SIGMA, 1 - LIGHT_SHARE)
    follow += _bell(above + LIGHT_LESS, LIGHT_SIGMA, LIGHT_SHARE)
    follow *= 1 - SAME_OUTLIERS
    follow += SAME_OUTLIERS / 2
    return follow


def _bell(away: Floats, sigma: float, share: float) -> Floats:
    """Return how dense a share of all lies so far from its mean; `away` is overwritten."""
    away *= away
    away *= -0.5 / sigma**2
    np.exp(away, out=away)
    away *= share / (sigma * math.sqrt(2 * math.pi))
    return away


def bins_of(likeness: Floats) -> NDArray[np.intp]:
    """Return the bins of likenesses, alike shaped."""
    bins = ((likeness + 1.0) * (BINS / 2)).astype(np.intp)
    return np.asarray(np.minimum(np.maximum(bins, 0), BINS - 1))
