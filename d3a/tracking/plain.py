"""Default profile: which detections are plainly which things, so that they teach how things look.

By place and category: taught by what it agreed to itself, the model of looks would never learn that
views of one thing are less alike than it assumed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters
from d3a.tracking.known import Known

Floats = NDArray[np.float64]
Pairs = list[tuple[int, int]]
"""A detection of a frame, and which of the things that it is compared with it is."""


def agreed(taken: list[int], evidence: Floats, parameters: Parameters) -> Pairs:
    """Return what place and category say plainly, and the look did not object to.

    What is assumed of histograms in one light holds of any well enough that a look may: of what is
    plain, one pair in thirty is of two things. taken: as in `Assigned`. evidence: (n, m), of place
    and category alone.
    """
    speaks = evidence >= 0  # itself speaks for it in its row and in its column
    alone = np.add.reduce(speaks, axis=1) == 1, np.add.reduce(speaks, axis=0) == 1
    plain = np.logical_and.outer(*alone) & (evidence >= parameters.plain_odds)
    rows, columns = np.nonzero(plain)
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(i, c) for i, c in pairs if taken[i] == c]


def sure(things: list[Known], evidence: Floats, parameters: Parameters) -> Pairs:
    """Return what place and category say so surely that the look is not asked.

    Where nothing is known of it before: of another embedding, or in another light.
    """
    speaks = evidence >= 0
    alone = np.add.reduce(speaks, axis=0) == 1
    # what was seen once may be one of the views of this thing that were not recognised
    speaks &= [thing.seen >= parameters.confirm_sightings for thing in things]
    rivals = np.add.reduce(speaks, axis=1).tolist()
    best = evidence.argmax(axis=1).tolist()
    return [
        (i, c)
        for i, c in enumerate(best)
        if evidence[i, c] >= parameters.sure_odds and alone[c] and rivals[i] == speaks[i, c]
    ]
