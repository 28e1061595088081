"""Default profile: the things in short-term memory, with the arrays that tier 2 compares.

What the robot left behind leaves them too, whole, and comes back as it went.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from d3a.kalman import pulled
from d3a.known import Known, Place
from d3a.look_space import LookSpace, cosines
from d3a.parameters import Parameters
from d3a.symmetric import Matrix, Six, Vector, of_rows

Floats = NDArray[np.float64]
SCALE_PRIOR = 4.0
"""Views as many of which the assumed covariance is worth against the scatter that is seen."""
SCALE_LEAST, SCALE_MOST = 0.5, 9.0
"""Bounds of that correction: it adapts a noise model, it does not replace one."""


class Row(NamedTuple):
    """What `Positions` holds of a place: columns (9,) and record (11,), as they are there."""

    columns: Floats
    record: Floats


@dataclass(frozen=True, slots=True)
class Whole:
    """A thing with its look (d,), None without a picture, and the rows of its placed places."""

    thing: Known
    look: NDArray[np.float32] | None
    rows: tuple[tuple[Place, Row], ...]


class Positions:
    """Rows of places: mean (aligned), covariance of the mean, raw mean, spread for the gates."""

    def __init__(self) -> None:
        self.owners: list[tuple[Known, Place]] = []
        self._placed: Counter[int] = Counter()
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
        self._append(thing, place)
        record = self._records[place.row]
        self._columns[:3, place.row], record[RAW], record[SCALE] = mean, raw, 0.0
        record[ERROR] = of_rows(error.ravel().tolist())

    def row(self, place: Place) -> Row:
        """Return what is known of a place."""
        return Row(self._columns[:, place.row].copy(), self._records[place.row].copy())

    def put_back(self, thing: Known, place: Place, row: Row) -> None:
        """Add a place with all that was known of it."""
        self._append(thing, place)
        self._columns[:, place.row], self._records[place.row] = row.columns, row.record

    def _append(self, thing: Known, place: Place) -> None:
        place.row = len(self.owners)
        self.owners.append((thing, place))
        self._placed[thing.number] += 1
        if len(self.owners) > self._size:
            self._size *= 2
            self._columns, self._order = (
                np.concatenate([array, np.empty_like(array)], axis=1)
                for array in (self._columns, self._order)
            )
            self._records = np.concatenate([self._records, np.empty_like(self._records)])
        self._order[:, place.row] = place.number, thing.number

    def respread(self, rows: Iterable[int], parameters: Parameters) -> None:
        """Set the spread of some rows from their error and how well that predicted the views."""
        for row in rows:
            record = self._records[row].tolist()
            self._columns[3:, row] = _spread(record[ERROR], record[SCALE], parameters)

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
        self._placed[thing.number] += 1

    def _leave(self, thing: Known) -> None:
        self._placed[thing.number] -= 1
        if not self._placed[thing.number]:
            del self._placed[thing.number]

    def remove(self, place: Place) -> None:
        """Take a place out; the last row moves into its row."""
        self._leave(self.owners[place.row][0])
        last = self.owners.pop()
        if last[1] is not place:
            self._columns[:, place.row] = self._columns[:, last[1].row]
            self._order[:, place.row] = self._order[:, last[1].row]
            self._records[place.row] = self._records[last[1].row]
            last[1].row = place.row
            self.owners[place.row] = last
        place.row = -1


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


class Looks:
    """Rows of mean features, unit length; zeros for a thing without a picture."""

    def __init__(self) -> None:
        self.owners: list[Known] = []
        self._matrix: NDArray[np.float32] = np.zeros((64, 0), dtype=np.float32)
        self._units: NDArray[np.float32] = np.zeros((64, 0), dtype=np.float32)
        self._stale = np.ones(64, dtype=bool)
        self._version = 0
        """Rows of `_units` are those of the matrix as this version of the space has them, but for
        the stale: most looks are compared far more often than they change."""

    @property
    def length(self) -> int:
        """d, 0 before any picture."""
        return int(self._matrix.shape[1])

    def likeness(self, seen: NDArray[np.float32], things: list[Known], space: LookSpace) -> Floats:
        """Return the cosines (n, m) of looks (n, d) with those of some things, in their order."""
        rows, stale = self._stale_of(things, space)
        count = len(seen)
        units = space.of(np.concatenate([seen, self._matrix[stale]]) if len(stale) else seen)
        self._units[stale] = units[count:]
        self._stale[stale] = False
        return cosines(units[:count], self._units, rows)

    def unit(self, thing: Known, space: LookSpace) -> NDArray[np.float32]:
        """Return what `space.of` makes of the feature of a thing (d,), until the next change."""
        self._keep_up(space)
        if self._stale[thing.row]:
            return np.asarray(self.units([thing], space)[0])
        return np.asarray(self._units[thing.row])

    def units(self, things: list[Known], space: LookSpace) -> NDArray[np.float32]:
        """Return what `space.of` makes of the features of some things (m, d), in their order."""
        rows, stale = self._stale_of(things, space)
        if len(stale):
            self._units[stale] = space.of(self._matrix[stale])
            self._stale[stale] = False
        return np.asarray(self._units[rows])

    def _stale_of(
        self, things: list[Known], space: LookSpace
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the rows of some things, and those of them whose units are not up to date."""
        self._keep_up(space)
        rows = np.array([thing.row for thing in things], dtype=np.intp)
        return rows, rows[self._stale[rows]]

    def _keep_up(self, space: LookSpace) -> None:
        """Let all units count as stale where the space or the matrix is another one by now."""
        if self._units.shape != self._matrix.shape:
            self._units = np.zeros_like(self._matrix)
            self._stale = np.ones(len(self._matrix), dtype=bool)
        version = space.ready()
        if version != self._version:
            self._version = version
            self._stale[:] = True

    def row(self, thing: Known) -> NDArray[np.float32]:
        """Return the feature of a thing (d,), as it is until the next change."""
        return np.asarray(self._matrix[thing.row])

    def of(self, thing: Known) -> NDArray[np.float32] | None:
        """Return the mean feature (d,), None without a picture."""
        return np.array(self._matrix[thing.row]) if thing.look_weight > 0 else None

    def add(self, thing: Known, look: NDArray[np.float32] | None, weight: float) -> None:
        """Add a thing with the look of `weight` views, or without one."""
        thing.row = len(self.owners)
        self.owners.append(thing)
        if len(self.owners) > len(self._matrix):
            self._matrix = np.concatenate([self._matrix, np.zeros_like(self._matrix)])
        if self._matrix.shape[1]:
            self._put(thing.row, 0.0)
        thing.look_weight = 0.0
        if look is not None:
            self.put(thing, look, weight)

    def blend(self, thing: Known, look: NDArray[np.float32], weight: float, most: float) -> None:
        """Average a look in, as if the mean so far were of `most` views at most."""
        if self._matrix.shape[1] == 0:
            self._matrix = np.zeros((len(self._matrix), len(look)), dtype=np.float32)
        mean = self._matrix[thing.row] * np.float32(min(thing.look_weight, most))
        mean += look * np.float32(weight)
        length = math.sqrt(mean @ mean)
        self._put(thing.row, np.divide(mean, np.float32(length), out=mean) if length > 0 else 0.0)
        thing.look_weight += weight

    def put(self, thing: Known, look: NDArray[np.float32], weight: float) -> None:
        """Set the mean look of a thing as it is."""
        if self._matrix.shape[1] == 0:
            self._matrix = np.zeros((len(self._matrix), len(look)), dtype=np.float32)
        self._put(thing.row, look)
        thing.look_weight = weight

    def _put(self, row: int, look: NDArray[np.float32] | float) -> None:
        self._matrix[row] = look
        if row < len(self._stale):
            self._stale[row] = True

    def remove(self, thing: Known) -> None:
        """Take a thing out; the last row moves into its row."""
        last = self.owners.pop()
        if last is not thing:
            self._put(thing.row, self._matrix[last.row])
            last.row = thing.row
            self.owners[thing.row] = last
        thing.row = -1


class Memory:
    """The things of the STM by number, with their positions and looks."""

    def __init__(self) -> None:
        self.things: dict[int, Known] = {}
        self.positions = Positions()
        self.looks = Looks()

    def remove(self, thing: Known) -> None:
        """Forget a thing."""
        for place in thing.places:
            if place.row >= 0:
                self.positions.remove(place)
        self.looks.remove(thing)
        del self.things[thing.number]

    def whole(self, thing: Known) -> Whole:
        """Return a thing with all that the arrays hold of it."""
        placed = [place for place in thing.places if place.row >= 0]
        rows = tuple((place, self.positions.row(place)) for place in placed)
        return Whole(thing, self.looks.of(thing), rows)

    def put_back(self, whole: Whole) -> None:
        """Take in what `whole` gave."""
        thing = whole.thing
        self.things[thing.number] = thing
        self.looks.add(thing, whole.look, thing.look_weight)
        for place, row in whole.rows:
            self.positions.put_back(thing, place, row)

    def placeless(self) -> list[Known]:
        """Return things that have no position, by number."""
        if self.positions.placed == len(self.things):  # the usual case, without looking at each
            return []
        return [
            self.things[number]
            for number in sorted(self.things)
            if all(place.row < 0 for place in self.things[number].places)
        ]
