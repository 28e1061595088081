"""Default profile: where the places of the things in short-term memory are, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.kalman import pulled
from d3a.known import Known, Place
from d3a.parameters import Parameters
from d3a.symmetric import Matrix, Six, Vector, along, of_rows

Floats = NDArray[np.float64]
SCALE_PRIOR = 4.0
"""Views as many of which the assumed covariance is worth against the scatter that is seen."""
SCALE_LEAST, SCALE_MOST = 0.5, 9.0
"""Bounds of that correction: it adapts a noise model, it does not replace one."""


class Row(NamedTuple):
    """What `Positions` holds of a place: 9 columns and 11 numbers of its record, as they are."""

    columns: Sequence[float]
    record: Sequence[float]


class Positions:
    """Rows of places: mean (aligned), covariance of the mean, raw mean, spread for the gates."""

    def __init__(self) -> None:
        self.owners: list[tuple[Known, Place]] = []
        self._placed: dict[int, int] = {}
        self._size = 64
        self._order = np.empty((2, 64), dtype=np.int64)
        self._columns = np.empty((9, 64))
        self._records = np.empty((64, 11))

    @property
    def placed(self) -> int:
        """How many things have a position."""
        return len(self._placed)

    def sorted_rows(self, wanted: NDArray[np.bool_]) -> tuple[NDArray[np.intp], list[int]]:
        """Return the wanted (k,) rows by thing and place, and the numbers of their things."""
        rows = wanted.nonzero()[0]
        order = self._order[:, rows]
        by = np.lexsort(order)
        numbers: list[int] = order[1, by].tolist()
        return rows[by], numbers

    @property
    def columns(self) -> Floats:
        """(9, k): x y z of the means, then xx xy xz yy yz zz of the spreads.

        What all of a frame is compared with: so much quicker as so few rows of many numbers.
        """
        return self._columns[:, : len(self.owners)]

    @property
    def mean(self) -> Floats:
        """(k, 3): where it is in the frame of first sight, the frames' offsets taken out."""
        return self._columns[:3, : len(self.owners)].T

    @property
    def variance(self) -> Floats:
        """(3, k): the spread along x, y and z alone."""
        return self._columns[_DIAGONAL, : len(self.owners)]

    def sigmas(self, rows: NDArray[np.intp], shared: Floats) -> Floats:
        """Return the mean error (k,) of some rows (k,), with what all share, (3, 3)."""
        variance = self._columns[_DIAGONAL[:, None], rows].sum(axis=0)
        return np.asarray(np.sqrt((variance + np.trace(shared)) / 3))

    @property
    def raw(self) -> Floats:
        """(k, 3): the same without alignment: unbiased where drift is, and what is reported."""
        return self._records[: len(self.owners), RAW]

    @property
    def error(self) -> Floats:
        """(k, 6): covariance of the mean, without the correction by what is seen."""
        return self._records[: len(self.owners), ERROR]

    @property
    def scale(self) -> Floats:
        """(k, 2): summed normalised squared residuals, and their number."""
        return self._records[: len(self.owners), SCALE]

    def spread(self, row: int) -> tuple[float, ...]:
        """Return (9,): how far from the mean its views are expected, own noise of a view aside."""
        xx, xy, xz, yy, yz, zz = self._columns[3:, row].tolist()
        return xx, xy, xz, xy, yy, yz, xz, yz, zz

    def add(self, thing: Known, place: Place, mean: Floats, raw: Floats, error: Floats) -> None:
        """Add a place; error: (3, 3). Its spread is set by `respread`."""
        self._append([(thing, place)])
        record = self._records[place.row]
        self._columns[:3, place.row], record[RAW], record[SCALE] = mean, raw, 0.0
        record[ERROR] = of_rows(error.ravel().tolist())

    def rows(self, places: Sequence[Place]) -> list[Row]:
        """Return what is known of some places."""
        at = [place.row for place in places]
        columns, records = self._columns[:, at].T.tolist(), self._records[at].tolist()
        return [Row(*row) for row in zip(columns, records, strict=True)]

    def put_back(self, placed: Sequence[tuple[Known, Place, Row]]) -> None:
        """Add places with all that was known of them."""
        if not placed:
            return
        rows = self._append([(thing, place) for thing, place, _ in placed])
        self._columns[:, rows] = np.array([row.columns for *_, row in placed]).T
        self._records[rows] = [row.record for *_, row in placed]

    def _append(self, owners: Sequence[tuple[Known, Place]]) -> slice:
        """Make room for places; return their rows."""
        first, last = len(self.owners), len(self.owners) + len(owners)
        while last > self._size:
            self._size *= 2
            self._columns, self._order = (
                np.concatenate([array, np.empty_like(array)], axis=1)
                for array in (self._columns, self._order)
            )
            self._records = np.concatenate([self._records, np.empty_like(self._records)])
        self.owners += owners
        rows = slice(first, last)
        self._order[:, rows] = np.array([(place.number, thing.number) for thing, place in owners]).T
        for row, (thing, place) in enumerate(owners, first):
            place.row = row
            self._placed[thing.number] = self._placed.get(thing.number, 0) + 1
        return rows

    def respread(self, rows: Iterable[int], parameters: Parameters) -> None:
        """Set the spread of some rows from their error and how well that predicted the views."""
        for row in rows:
            record = self._records[row].tolist()
            self._columns[3:, row] = _spread(record[ERROR], record[SCALE], parameters)

    def loosen(self, row: int, sigma: Vector, parameters: Parameters) -> None:
        """Let a place err by so much more along a vector (3,)."""
        x, y, z = sigma
        self._records[row, ERROR] += along(x, y, z)
        self.respread([row], parameters)

    def pull(
        self, row: int, where: Vector, offset: Vector, noise: Six, parameters: Parameters
    ) -> float:
        """Move a place towards where it was seen; return how far off that was, squared sigmas.

        See `kalman.pulled`.
        """
        columns, record = self._columns[:, row].tolist(), self._records[row].tolist()
        known = columns[:3], record[RAW], record[ERROR], columns[3:]
        new = pulled(known, where, offset, noise, parameters)
        off, seen = record[SCALE]
        scale = off + min(new.squared, parameters.gate_sigmas**2) / 3, seen + 1.0
        self._columns[:, row] = (*new.mean, *_spread(new.error, scale, parameters))
        self._records[row] = (*new.raw, *new.error, *scale)
        return new.squared

    def give(self, place: Place, thing: Known) -> None:
        """Make a place another thing's."""
        self._leave(self.owners[place.row][0])
        self.owners[place.row] = (thing, place)
        self._order[:, place.row] = place.number, thing.number
        self._placed[thing.number] = self._placed.get(thing.number, 0) + 1

    def _leave(self, thing: Known) -> None:
        left = self._placed.pop(thing.number) - 1
        if left:
            self._placed[thing.number] = left

    def remove(self, places: Sequence[Place]) -> None:
        """Take places out; the last rows move into theirs."""
        comes_from: dict[int, int] = {}
        for place in places:
            self._leave(self.owners[place.row][0])
            last = self.owners.pop()
            source = comes_from.pop(len(self.owners), len(self.owners))
            if last[1] is not place:
                comes_from[place.row] = source
                last[1].row = place.row
                self.owners[place.row] = last
            place.row = -1
        if comes_from:
            into, of = list(comes_from), list(comes_from.values())
            self._columns[:, into] = self._columns[:, of]
            self._order[:, into] = self._order[:, of]
            self._records[into] = self._records[of]


_DIAGONAL = np.array([3, 6, 8])
"""Of the columns."""
RAW, ERROR, SCALE = slice(0, 3), slice(3, 9), slice(9, 11)
"""Of a record: the raw mean, xx xy xz yy yz zz of the error, and the residuals."""


def _spread(error: Six, scale: Vector, parameters: Parameters) -> Matrix:
    """Return the spread of a place from its error and how well that predicted its views."""
    off, seen = scale
    factor = min(max((SCALE_PRIOR + off) / (SCALE_PRIOR + seen), SCALE_LEAST), SCALE_MOST)
    surface = parameters.object_spread_m**2
    xx, xy, xz, yy, yz, zz = error
    return (
        factor * (xx + surface), factor * xy, factor * xz,
        factor * (yy + surface), factor * yz, factor * (zz + surface),
    )  # fmt: skip
