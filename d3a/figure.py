"""The pixels of a thing itself, told from its surroundings in one picture: figure and ground.

A box holds a thing and what is behind it. Around the box there is none of the thing, and a thing
is likelier in the middle of its box than in the corners: so a colour that is as frequent around
the box as in it is ground, one that is in it alone is the thing's, and in between it counts by its
share. What of a box is the thing is learned with it, in a few rounds of expectation and
maximisation over two histograms (as in GrabCut, Rother et al. 2004, without the cut: no border
is asked for, but which colours).

Paper: "Pre-processing each frame" takes the histogram of the whole box. What is behind a thing
changes when it is moved, and is what colour words are wrongly judged by.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from d3a import images
from d3a.colours.looks import HISTOGRAM_SIZE
from d3a.images import Pixels
from d3a.model import Box

Counts = NDArray[np.float64]
MIDDLE = 0.85
"""The chance that the middle of a box shows its thing, before colours are looked at."""
CORNER = 0.15
"""The same in its corners; between them it falls with the squared distance from the middle."""
AROUND = 0.25
"""How wide the surroundings are that are looked at, on each side, in widths and heights."""
ROUNDS = 2
SAMPLED = 96
"""A larger box is read by so many rows and columns of it, evenly spaced."""
LEAST_GROUND = 20
"""With fewer pixels of surroundings, as where a box fills the picture, nothing is taken off."""
LEAST_OWN = 0.02
"""Where less than this share of a box were its thing's, the thing has the colours of the ground."""
_SOME = 1e-6


def own_histogram(pixels: Pixels, box: Box) -> NDArray[np.float32]:
    """Return the `rgb-8x8x8` histogram (512,), unit length, of the thing in a box.

    pixels (h, w, 3): the whole picture; the box must overlap it. It is that of the whole box (see
    `images.histogram`) where the surroundings tell nothing.
    """
    inside, around = _bins(pixels, box)
    counts = _own(inside, np.bincount(around.ravel(), minlength=HISTOGRAM_SIZE))
    if counts is None:
        return images.histogram(images.crop(pixels, box))
    return images.unit(counts.astype(np.float32))


def _own(inside: NDArray[np.intp], ground: NDArray[np.intp]) -> Counts | None:
    """Return how much of each bin is the thing's (512,), None where that cannot be told.

    inside (h, w): the bin of each pixel of the box; ground (512,): pixels around it, by bin.
    """
    if ground.sum() < LEAST_GROUND:
        return None
    bins, odds = inside.ravel(), _odds_by_place(*inside.shape).ravel()
    behind = (ground + 0.5 / HISTOGRAM_SIZE) / (ground.sum() + 0.5)
    chance = odds / (1 + odds)
    for _ in range(ROUNDS):
        own = np.bincount(bins, chance, HISTOGRAM_SIZE) + _SOME
        likelier = odds * (own / own.sum() / behind)[bins]
        chance = likelier / (1 + likelier)
    found = np.bincount(bins, chance, HISTOGRAM_SIZE).astype(np.float64)
    return found if found.sum() >= LEAST_OWN * len(bins) else None


def _odds_by_place(height: int, width: int) -> Counts:
    """Return the odds (h, w) that a place in a box shows its thing."""
    rows, columns = (((np.arange(n) + 0.5) / n * 2 - 1) ** 2 for n in (height, width))
    chance = MIDDLE - (MIDDLE - CORNER) / 2 * (rows[:, None] + columns[None, :])
    return np.asarray(chance / (1 - chance))


def _bins(pixels: Pixels, box: Box) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the bins of the box's pixels (h, w), and of those around it (n,)."""
    x1, y1, x2, y2 = images.corners(pixels, box)
    width, height = x2 - x1, y2 - y1
    step = max(1, round(float(np.sqrt(width * height)) / SAMPLED))
    wide, high = max(2, int(width * AROUND)), max(2, int(height * AROUND))
    left, top = max(x1 - wide, 0), max(y1 - high, 0)
    beside = [
        pixels[top:y1, left : x2 + wide],
        pixels[y2 : y2 + high, left : x2 + wide],
        pixels[y1:y2, left:x1],
        pixels[y1:y2, x2 : x2 + wide],
    ]
    around = [images.bins(part[::step, ::step]).ravel() for part in beside]
    return images.bins(pixels[y1:y2:step, x1:x2:step]), np.concatenate(around)
