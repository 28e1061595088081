"""Where the colour histogram is in an embedding: it is all of it, or carried at the end of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

HISTOGRAM_SIZE = 512
"""8 x 8 x 8 bins of red, green, blue; the red is the slowest (see d3a.images)."""
HISTOGRAM_MODEL = "rgb-8x8x8"
CARRIED = f"+{HISTOGRAM_MODEL}"
"""What the name of an embedding ends in that carries the histogram along."""


def carries_histogram(model: str | None, length: int) -> bool:
    """Say whether embeddings of a model, of so many numbers, hold the colours of their boxes.

    By the name and not by the length alone: other models have 512 numbers too.
    """
    if model is None:
        return False
    return (model == HISTOGRAM_MODEL and length == HISTOGRAM_SIZE) or (
        model.endswith(CARRIED) and length > HISTOGRAM_SIZE
    )


def histograms(looks: NDArray[np.float32]) -> NDArray[Any]:
    """Return the histograms (n, 512) of embeddings (n, d) that carry them, at any scale."""
    return looks[:, -HISTOGRAM_SIZE:]
