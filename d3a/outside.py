"""Default profile, tier 3: where the things are that left the memory, so that they can come back.

A few numbers for each place, held for the squares of the ground that were asked for; the things
themselves, with their looks and votes, are in the store.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from d3a.model import Position

Floats = NDArray[np.float64]


class Outside:
    """Rows of places by object: position and variance along each axis."""

    def __init__(self) -> None:
        self._size = 64
        self._spots = np.empty((64, 6))
        self._owners: list[str] = []
        self._rows: dict[str, list[int]] = {}
        self._nowhere: set[str] = set()

    def __contains__(self, object_id: str) -> bool:
        """Say whether any place of the object is known."""
        return object_id in self._rows or object_id in self._nowhere

    def clear(self) -> None:
        """Forget all."""
        self._owners.clear()
        self._rows.clear()
        self._nowhere.clear()

    def add(self, object_id: str, position: Position | None, variance: Iterable[float]) -> None:
        """Add a place of an object; variance: along x, y and z, square metres."""
        if position is None:
            self._nowhere.add(object_id)
            return
        row = len(self._owners)
        if row == self._size:
            self._size *= 2
            self._spots = np.concatenate([self._spots, np.empty_like(self._spots)])
        self._spots[row] = (*position, *variance)
        self._owners.append(object_id)
        self._rows.setdefault(object_id, []).append(row)

    def remove(self, object_id: str) -> None:
        """Forget an object's places; the last rows move into theirs."""
        self._nowhere.discard(object_id)
        for row in sorted(self._rows.pop(object_id, ()), reverse=True):
            last, owner = len(self._owners) - 1, self._owners.pop()
            if row != last:
                self._spots[row] = self._spots[last]
                self._owners[row] = owner
                rows = self._rows[owner]
                rows[rows.index(last)] = row

    def near(self, places: Floats, variance: Floats, sigmas: float) -> set[str]:
        """Return the objects that may be at any of some places, and those that may be anywhere.

        places (n, 3), NaN where unknown; variance (n, 3) along each axis.
        """
        spots = self._spots[: len(self._owners)]
        reach = sigmas**2 * (variance[:, None] + spots[None, :, 3:])
        inside = np.all((places[:, None] - spots[None, :, :3]) ** 2 <= reach, axis=2)
        owners = self._owners
        return {owners[k] for k in np.flatnonzero(inside.any(axis=0)).tolist()} | self._nowhere
