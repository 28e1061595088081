"""How large a store's entries are against those of a store that keeps every detection.

The paper counts a picture of 1.3 MB for each entry (3,312 MB for 2,558 detections), whichever
frames they share; a store of crops pays for the pixels of each entry's own box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.model import Box
from d3a.store.base import Sighting

PICTURE_MB = 1.3
"""Of one entry with its picture, as the paper's summary table has it."""


@dataclass(frozen=True, slots=True)
class Against:
    """A store against one of all detections. entries: keyframes with their boxes, each once.

    pictures: how many times fewer entries with a picture each; crops: how many times fewer
    pixels in the crops of their boxes.
    """

    entries: int
    pictures: float
    crops: float

    @property
    def entries_mb(self) -> float:
        """The store's size by the paper's count."""
        return PICTURE_MB * self.entries


def against_naive(sightings: Sequence[Sighting], boxes: NDArray[np.float64]) -> Against:
    """Return how a store compares with Naive's, which has an entry for each of `boxes` (n, 4).

    Two sightings that show one box of one frame are one entry. An empty store counts as one of a
    single entry and pixel.
    """
    kept = {(each.frame, each.box): each.box for each in sightings}
    pixels = max(1.0, sum(map(_pixels, kept.values())))
    every = sum(_pixels((x1, y1, x2, y2)) for x1, y1, x2, y2 in boxes.tolist())
    return Against(len(kept), len(boxes) / max(1, len(kept)), every / pixels)


def _pixels(box: Box) -> float:
    x1, y1, x2, y2 = box
    return (x2 - x1) * (y2 - y1)
