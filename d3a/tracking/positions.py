"""Default profile: where the places of the things in short-term memory are, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.parameters import Parameters
from d3a.symmetric import Matrix, Six, Triple, Vector, added, along
from d3a.tracking.kalman import pulled
from d3a.tracking.known import Known, Place
from d3a.tracking.sides import LOOKS_KEPT, SIDES_KEPT

Floats = NDArray[np.float64]
SCALE_PRIOR = 4.0
"""Views as many of which the assumed covariance is worth against the scatter that is seen."""
MOST_PLACES = 1 << 20
"""Of a thing: what its number counts for in the order of places."""
SCALE_LEAST, SCALE_MOST = 0.5, 9.0
"""Bounds of that correction: it adapts a noise model, it does not replace one."""


class Row(NamedTuple):
    """What is known of a place, in plain numbers; covariances are xx xy xz yy yz zz.

    mean: where it is in the frame of first sight, the frames' offsets taken out. spread: how far
    from there its views are expected, own noise of a view aside. raw: the mean without alignment:
    unbiased where drift is, and what is reported. error: covariance of the mean, without the
    correction by what is seen. scale: summed normalised squared residuals, and their number.
    """

    mean: Triple
    spread: Matrix
    raw: Triple
    error: Matrix
    scale: tuple[float, float]

    @classmethod
    def of(
        cls,
        mean: Triple,
        raw: Triple,
        error: Matrix,
        scale: tuple[float, float],
        parameters: Parameters,
    ) -> Row:
        """Return the row whose spread follows from its error and how well that predicted views."""
        off, seen = scale
        factor = min(max((SCALE_PRIOR + off) / (SCALE_PRIOR + seen), SCALE_LEAST), SCALE_MOST)
        surface = parameters.object_spread_m**2
        xx, xy, xz, yy, yz, zz = error
        spread = (
            factor * (xx + surface), factor * xy, factor * xz,
            factor * (yy + surface), factor * yz, factor * (zz + surface),
        )  # fmt: skip
        return cls(mean, spread, raw, error, scale)


class Positions:
    """Rows of places, and means and spreads of all as arrays, as a frame is compared with them."""

    def __init__(self) -> None:
        self.owners: list[tuple[Known, Place]] = []
        self._rows: list[Row] = []
        self._placed: dict[int, int] = {}
        self._size = 64
        self._order = np.empty(64, dtype=np.int64)
        """By thing and place, as one number."""
        self._columns = np.ones((11, 64))
        """Ones, then `columns`, then `there`."""
        self._sides = np.empty((64, 3, SIDES_KEPT))
        self._looks = np.empty((64, 5, LOOKS_KEPT))

    @property
    def placed(self) -> int:
        """How many things have a position."""
        return len(self._placed)

    def in_order(self, wanted: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return the wanted (k,) rows by thing and place."""
        rows = wanted.nonzero()[0]
        return np.asarray(rows[self._order[rows].argsort()])

    @property
    def columns(self) -> Floats:
        """(9, k): x y z of the means, then xx xy xz yy yz zz of the spreads.

        What all of a frame is compared with: so much quicker as so few rows of many numbers.
        """
        return self._columns[1:10, : len(self.owners)]

    @property
    def spots(self) -> Floats:
        """(4, k): 1 x y z of the means."""
        return self._columns[:4, : len(self.owners)]

    @property
    def variance(self) -> Floats:
        """(3, k): the spread along x, y and z alone."""
        return self._columns[_DIAGONAL, : len(self.owners)]

    @property
    def there(self) -> Floats:
        """(k,): see `Place.there`."""
        return self._columns[10, : len(self.owners)]

    @property
    def spread_m2(self) -> Floats:
        """(k,): the spread along all three axes together."""
        columns = self.columns
        return np.asarray(columns[3] + columns[6] + columns[8])

    def keys(self, rows: NDArray[np.intp]) -> NDArray[np.int64]:
        """Return what places in some rows are known by wherever their rows are, (k,)."""
        return np.asarray(self._order[rows])

    def rows_of(self, keys: NDArray[np.int64]) -> NDArray[np.intp]:
        """Return the rows of places by their keys (k,), -1 of those that are no more."""
        order = self._order[: len(self.owners)]
        by_key = order.argsort()
        at = order.searchsorted(keys, sorter=by_key)
        rows = by_key[np.minimum(at, len(order) - 1)] if len(order) else at
        return np.where(order[rows] == keys, rows, -1) if len(order) else np.full_like(at, -1)

    def sides(self, rows: NDArray[np.intp]) -> Floats:
        """Return from where the places in some rows were seen, (k, 3, SIDES_KEPT), NaN: nowhere."""
        return np.asarray(self._sides[rows])

    def looks(self, rows: NDArray[np.intp]) -> Floats:
        """Return the latest looks at the places in some rows, (k, 5, LOOKS_KEPT).

        x y z of the eye, NaN: no look; then its share, and 1 if it found the thing; else 0.
        """
        return np.asarray(self._looks[rows])

    def put_some_looks(self, looks: Sequence[tuple[Place, int]]) -> None:
        """Take over some of the latest looks at places: of each the place, and which it is."""
        if looks:
            rows, which = [place.row for place, _ in looks], [at for _, at in looks]
            self._looks[rows, :, which] = [place.looks[at] for place, at in looks]

    def put_looks(self, place: Place) -> None:
        """Take over the latest looks at a place."""
        looks, count = self._looks[place.row], len(place.looks)
        looks[:3], looks[3:] = np.nan, 0.0
        if count:
            looks[:, :count] = np.array(place.looks).T

    def put_sides(self, place: Place) -> None:
        """Take over from where a place was seen."""
        sides = self._sides[place.row]
        sides[:, len(place.seen_from) :] = np.nan
        sides[:, : len(place.seen_from)] = np.array(place.seen_from).T

    def of(self, place: Place) -> Row:
        """Return what is known of a place."""
        return self._rows[place.row]

    def put(self, place: Place, row: Row) -> None:
        """Set what is known of a place."""
        self._rows[place.row] = row
        self._columns[1:10, place.row] = (*row.mean, *row.spread)

    def put_there(self, place: Place) -> None:
        """Take over how likely a place's thing is still there."""
        self._columns[10, place.row] = place.there

    def add(self, placed: Sequence[tuple[Known, Place, Row]]) -> None:
        """Add places with what is known of them."""
        if not placed:
            return
        first, last = len(self.owners), len(self.owners) + len(placed)
        while last > self._size:
            self._size *= 2
            self._columns = np.concatenate([self._columns, np.ones_like(self._columns)], axis=1)
            self._order = np.concatenate([self._order, np.empty_like(self._order)])
            self._sides = np.concatenate([self._sides, np.empty_like(self._sides)])
            self._looks = np.concatenate([self._looks, np.empty_like(self._looks)])
        self._rows += [row for *_, row in placed]
        self._columns[1:, first:last] = np.array(
            [(*row.mean, *row.spread, place.there) for _, place, row in placed]
        ).T
        self._sides[first:last] = np.nan
        for at, (thing, place, _) in enumerate(placed, first):
            self.owners.append((thing, place))
            self._own(at, thing, place)
            if place.seen_from:
                self.put_sides(place)
            self.put_looks(place)

    def _own(self, at: int, thing: Known, place: Place) -> None:
        place.row = at
        self._order[at] = thing.number * MOST_PLACES + place.number
        self._placed[thing.number] = self._placed.get(thing.number, 0) + 1

    def loosen(self, place: Place, sigma: Vector, parameters: Parameters) -> None:
        """Let a place err by so much more along a vector."""
        row, (x, y, z) = self._rows[place.row], sigma
        error = added(row.error, along(x, y, z))
        self.put(place, Row.of(row.mean, row.raw, error, row.scale, parameters))

    def pull(
        self, place: Place, where: Vector, offset: Vector, noise: Six, parameters: Parameters
    ) -> float:
        """Move a place towards where it was seen; return how far off that was, squared sigmas.

        See `kalman.pulled`.
        """
        mean, spread, raw, error, (off, seen) = self._rows[place.row]
        new = pulled((mean, raw, error, spread), where, offset, noise, parameters)
        scale = off + min(new.squared, parameters.gate_sigmas**2) / 3, seen + 1.0
        self.put(place, Row.of(new.mean, new.raw, new.error, scale, parameters))
        return new.squared

    def give(self, place: Place, thing: Known) -> None:
        """Make a place another thing's."""
        self._leave(self.owners[place.row][0])
        self.owners[place.row] = (thing, place)
        self._own(place.row, thing, place)

    def _leave(self, thing: Known) -> None:
        left = self._placed.pop(thing.number) - 1
        if left:
            self._placed[thing.number] = left

    def remove(self, places: Sequence[Place]) -> None:
        """Take places out; the last rows move into theirs."""
        comes_from: dict[int, int] = {}
        for place in places:
            self._leave(self.owners[place.row][0])
            last, row = self.owners.pop(), self._rows.pop()
            source = comes_from.pop(len(self.owners), len(self.owners))
            if last[1] is not place:
                comes_from[place.row] = source
                last[1].row = place.row
                self.owners[place.row], self._rows[place.row] = last, row
            place.row = -1
        if comes_from:
            into, of = list(comes_from), list(comes_from.values())
            self._columns[:, into] = self._columns[:, of]
            self._order[into] = self._order[of]
            self._sides[into] = self._sides[of]
            self._looks[into] = self._looks[of]


_DIAGONAL = np.array([4, 7, 9])
"""Of the rows of numbers."""
