"""Non-maximum suppression: of boxes of one class that are mostly each other, the best is kept."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def suppressed(
    boxes: NDArray[np.float32], kinds: NDArray[np.intp], most_overlap: float
) -> NDArray[np.intp]:
    """Return which boxes (n, 4), given best first, are kept, best first.

    kinds (n,): the class of each; boxes of two classes leave each other alone. A box goes where it
    shares more than `most_overlap` (intersection over union) with a better one that is kept.
    """
    area = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1)
    left, kept = np.arange(len(boxes)), []
    while len(left):
        best, left = left[0], left[1:]
        kept.append(best)
        low = np.maximum(boxes[best, :2], boxes[left, :2])
        high = np.minimum(boxes[best, 2:], boxes[left, 2:])
        shared = np.prod(np.clip(high - low, 0, None), axis=1)
        whole = area[best] + area[left] - shared
        left = left[(shared <= most_overlap * whole) | (kinds[left] != kinds[best])]
    return np.array(kept, dtype=np.intp)
