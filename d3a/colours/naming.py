"""What people call a colour that they see as it is: by the names of the survey nearest to it.

Light that is dimmer than the sensor's white is made good first, as the eye does.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from d3a.colours.looks import HISTOGRAM_SIZE
from d3a.colours.names import BASIC, Floats, colours_of, lab, linear

NEAR = 16.0
"""Distance at which a name counts 0.6 of one that is hit: people draw borders 10 to 20 apart."""
_NOBODY = 1e-9


def bin_levels() -> Floats:
    """Return the sRGB levels in the middle of the histogram's bins (512, 3)."""
    index = np.arange(HISTOGRAM_SIZE)
    levels = np.stack([index // 64, index // 8 % 8, index % 8], axis=1)
    return np.asarray(levels * 32.0 + 15.5)


@lru_cache(maxsize=16)
def bins_lab(exposure: float) -> Floats:
    """Return the bins (512, 3) as the eye sees them in light in which white has an exposure."""
    return lab(np.minimum(linear(bin_levels()) / exposure, 1.0))


@lru_cache(maxsize=16)
def naming(exposure: float) -> Floats:
    """Return the share of people who call each bin by each basic term (11, 512)."""
    return named(bins_lab(exposure))


def named(seen: Floats) -> Floats:
    """Return the shares of people who call colours (n, 3) in CIELAB by each basic term (11, n)."""
    shares = np.stack([_nearness(term, seen) for term in BASIC]) + _NOBODY
    return np.asarray(shares / shares.sum(axis=0))


def _nearness(term: str, seen: Floats) -> Floats:
    """Return how near a term's names are to colours (n,): each as likely to be said, over all."""
    colours = colours_of(term)
    assert colours is not None
    apart = ((seen[:, None, :] - lab(colours)[None, :, :]) ** 2).sum(axis=2)
    return np.asarray(np.exp(apart / (-2 * NEAR**2)).mean(axis=1))
