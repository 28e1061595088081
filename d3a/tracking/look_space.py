"""Default profile: which parts of a look tell things apart, learned while the robot looks.

Most of a box's colours are those of the room: they are much alike in every box, or change with
the light. What differs between things and stays the same for one counts most (Fisher's
discriminant, each part by itself), so the background's share fades as the room gets known.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters

Floats = NDArray[np.float64]
Features = NDArray[np.float32]
FRESH = 1.02
"""What was learned is taken into use when there is this much more of it: the rest of the time the
same scale serves, as one view in a thousand changes nothing."""
FLOOR = 0.05
"""Share of the mean variance that each part has at least: no part is exactly repeatable."""

THREADED = 1 << 18
"""Multiplications from which on OpenBLAS shares a product among threads: on a busy machine that
costs fifty times what it saves."""


class LookSpace:
    """Scales features so that their cosine compares what tells things apart.

    Before anything is learned it is the plain cosine; that counts as `space_prior` views.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._prior = parameters.space_prior
        self.sums: Floats = np.zeros((3, 0))
        """(3, d): sum of all views, of their squares, and of squared deviations from a thing."""
        self.counts: Floats = np.zeros(2)
        """(2,): views, and views of a known thing."""
        self.scale: Features = np.zeros((2, 0), dtype=np.float32)
        """(2, d): centre, and what each part is worth, of all that was learned by `scaled_at`."""
        self.scaled_at = 0.0
        self._version = 1

    def add(self, looks: Features, pictured: list[bool]) -> None:
        """Learn what there is to see: looks (n, d), and which of them are known."""
        if not any(pictured):
            return
        known = (looks if all(pictured) else looks[pictured]).astype(np.float64)
        self._ready(looks.shape[1])
        self.sums[0] += np.add.reduce(known, axis=0)
        known *= known
        self.sums[1] += np.add.reduce(known, axis=0)
        self.counts[0] += len(known)

    def add_same(self, look: Features, mean: Features, views: float) -> None:
        """Learn how a view (d,) of a known thing differs from the mean (d,) of so many views."""
        self._ready(len(look))
        deviation = look.astype(np.float64) - mean
        self.sums[2] += deviation**2 * (views / (views + 1.0))
        self.counts[1] += 1.0

    def _ready(self, length: int) -> None:
        if self.sums.shape[1] == 0:
            self.sums = np.zeros((3, length))

    def of(self, looks: Features, *, are_known: bool = False) -> Features:
        """Return looks (n, d) in the space, rows of unit length; zeros stay zeros.

        are_known: that none of them is zeros is known already.
        """
        if looks.shape[1] == 0 or self.ready() == 0:
            return looks
        centre, scale = self.scale
        moved = looks - centre
        moved *= scale
        length = np.sqrt(np.einsum("nd,nd->n", moved, moved))
        moved /= np.maximum(length, np.float32(1e-12))[:, None]
        if not are_known:
            moved[~looks.any(axis=1)] = 0.0
        return np.asarray(moved)

    def ready(self) -> int:
        """Take into use what is due, and return the scale's number: another one, another space.

        0: nothing was learned yet. Numbers are good for as long as this object lives.
        """
        if self.sums.shape[1] == 0:
            return 0
        if float(self.counts[0]) + float(self.counts[1]) > self.scaled_at * FRESH:
            self._rescale()
            self._version += 1
        return self._version

    def _rescale(self) -> None:
        total, within = self.counts.tolist()
        trust = total / (total + self._prior)
        centre = self.sums[0] / max(total, 1.0)
        overall = self.sums[1] / max(total, 1.0) - centre**2
        overall = np.maximum(overall, 0.0)
        overall += FLOOR * overall.mean() + 1e-12
        inner = (self.sums[2] + self._prior * overall) / (within + self._prior)
        inner += FLOOR * inner.mean()
        learned = np.sqrt(overall) / inner
        learned /= learned.mean()
        scale = 1.0 + trust * (learned - 1.0)
        self.scale = np.stack([trust * centre, scale]).astype(np.float32)
        self.scaled_at = total + within


def cosines(looks: Features, units: Features, rows: NDArray[np.intp]) -> Floats:
    """Return the products (n, k) of looks (n, d) with some rows (k,) of others (m, d)."""
    return products(looks, units[rows])


def products(looks: Features, others: Features) -> Floats:
    """Return the products (n, m) of looks (n, d) with others (m, d).

    In parts so small that one thread does them.
    """
    step = max(1, THREADED // max(looks.size, 1))
    if len(others) <= step:
        return (looks @ others.T).astype(np.float64)
    found = np.empty((len(looks), len(others)))
    for start in range(0, len(others), step):
        part = slice(start, start + step)
        found[:, part] = looks @ others[part].T
    return found
