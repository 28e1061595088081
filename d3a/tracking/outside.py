"""Default profile, tier 3: where the things are that left the memory, so that they can come back.

A few numbers for each place, held for the squares of the ground that were asked for; the things
themselves, with their looks and votes, are in the store.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.model import Position

Floats = NDArray[np.float64]
SPARE = 64
"""Rows that may be empty, beside as many as are in use, before the table is made dense."""


class Outside:
    """Columns of places by object: position and variance along each axis; NaN where it is empty."""

    def __init__(self) -> None:
        self._spots = np.empty((6, SPARE))
        self._owners: list[str] = []
        self._columns: dict[str, list[int]] = {}
        self._nowhere: set[str] = set()
        self._empty = 0

    def __contains__(self, object_id: str) -> bool:
        """Say whether any place of the object is known."""
        return object_id in self._columns or object_id in self._nowhere

    def clear(self) -> None:
        """Forget all."""
        self._owners.clear()
        self._columns.clear()
        self._nowhere.clear()
        self._empty = 0

    def add(self, object_id: str, position: Position | None, variance: Sequence[float]) -> None:
        """Add a place of an object; variance: along x, y and z, square metres."""
        if position is None:
            self._nowhere.add(object_id)
        else:
            self.add_all([object_id], [(*position, *variance)])

    def add_all(self, object_ids: Sequence[str], spots: Sequence[Sequence[float]]) -> None:
        """Add a place of each of some objects; spots: x y z, then the variance along each."""
        first, last = len(self._owners), len(self._owners) + len(object_ids)
        if first == last:
            return
        while last > self._spots.shape[1]:
            self._spots = np.concatenate([self._spots, np.empty_like(self._spots)], axis=1)
        self._spots[:, first:last] = np.array(spots).T
        self._owners += object_ids
        for column, object_id in enumerate(object_ids, first):
            self._columns.setdefault(object_id, []).append(column)

    def remove(self, object_ids: Iterable[str]) -> None:
        """Forget the places of some objects."""
        gone: list[int] = []
        for object_id in object_ids:
            self._nowhere.discard(object_id)
            gone += self._columns.pop(object_id, ())
        if not gone:
            return
        self._spots[:, gone] = np.nan
        self._empty += len(gone)
        if 2 * self._empty > len(self._owners) + SPARE:
            self._make_dense()

    def _make_dense(self) -> None:
        kept = [column for columns in self._columns.values() for column in columns]
        self._spots[:, : len(kept)] = self._spots[:, kept]
        self._owners = [self._owners[column] for column in kept]
        self._columns.clear()
        for column, owner in enumerate(self._owners):
            self._columns.setdefault(owner, []).append(column)
        self._empty = 0

    def near(self, places: Floats, variance: Floats, sigmas: float) -> set[str]:
        """Return the objects that may be at any of some places, and those that may be anywhere.

        places (n, 3), NaN where unknown; variance (n, 3) along each axis.
        """
        if len(places) == 0 or not self._owners:
            return set(self._nowhere)
        spots = self._spots[:, : len(self._owners)]
        away = places.T[:, :, None] - spots[:3, None]
        away *= away
        reach = variance.T[:, :, None] + spots[3:, None]
        reach *= sigmas**2
        inside = np.logical_or.reduce(np.logical_and.reduce(away <= reach, axis=0), axis=0)
        owners = self._owners
        return {owners[k] for k in np.flatnonzero(inside).tolist()} | self._nowhere
