"""What people call a colour that they see as it is: by the names of the survey nearest to it.

Nearness is that of the eye, in CIELAB (CIE 15): equal steps look about equally large. Light that
is dimmer than the sensor's white is made good first, as the eye does.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from d3a.colours.looks import HISTOGRAM_SIZE
from d3a.colours.names import BASIC, Floats, colours_of, linear

NEAR = 16.0
"""Distance at which a name counts 0.6 of one that is hit: people draw borders 10 to 20 apart."""
_NOBODY = 1e-9
_TO_XYZ = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
).T / np.array([0.9505, 1.0, 1.089])
"""Linear sRGB to XYZ, white at 1 (IEC 61966-2-1, D65)."""


def lab(light: Floats) -> Floats:
    """Return the lightness, redness and yellowness (..., 3) of linear light (..., 3), white 1."""
    xyz = light @ _TO_XYZ
    root = np.where(xyz > 216 / 24389, np.cbrt(xyz), xyz * (841 / 108) + 4 / 29)
    x, y, z = root[..., 0], root[..., 1], root[..., 2]
    seen = np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)
    return np.asarray(seen)


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
