"""Default profile: the things in short-term memory, with the arrays that tier 2 compares.

What the robot left behind leaves them too, whole, and comes back as it went.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a.tracking.known import Known, Place
from d3a.tracking.look_space import LookSpace, cosines
from d3a.tracking.positions import Positions, Row

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Whole:
    """A thing with its look (d,), None without a picture, and the rows of its placed places."""

    thing: Known
    look: NDArray[np.float32] | None
    rows: tuple[tuple[Place, Row], ...]


@dataclass(frozen=True, slots=True)
class Sleeper:
    """A thing that left the memory, with what was known of its placed places."""

    thing: Known
    rows: list[tuple[Place, Row]]


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

    def likeness(
        self, seen: NDArray[np.float32], things: list[Known], space: LookSpace, are_known: bool
    ) -> Floats:
        """Return the cosines (n, m) of looks (n, d) with those of some things, in their order.

        are_known: whether all of these have a look.
        """
        rows, stale = self._stale_of(things, space)
        count = len(seen)
        units = space.of(
            np.concatenate([seen, self._matrix[stale]]) if len(stale) else seen, are_known=are_known
        )
        if len(stale):
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

    def add(self, thing: Known) -> None:
        """Add a thing without a look."""
        thing.row = len(self.owners)
        self.owners.append(thing)
        if len(self.owners) > len(self._matrix):
            self._matrix = np.concatenate([self._matrix, np.zeros_like(self._matrix)])
        if self._matrix.shape[1]:
            self._put(thing.row, 0.0)
        thing.look_weight = 0.0

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
    """The things of the STM by number, with their positions and looks.

    Beside them sleep those that left it, whole but not compared: their places have no row, and
    their looks stay where they are.
    """

    def __init__(self) -> None:
        self.things: dict[int, Known] = {}
        self.positions = Positions()
        self.looks = Looks()
        self._asleep: dict[int, Sleeper] = {}
        """By number, what left first before."""
        self._touched: set[int] = set()
        """Numbers of the things that came, left or changed since they were taken last."""
        self._called: dict[str, dict[int, Known]] = {}
        """The things that were ever called so, by name and number."""

    def touch(self, thing: Known) -> None:
        """Note that a thing came, left or was named: its category or place may be another now."""
        self._touched.add(thing.number)
        for name in thing.votes:
            called = self._called.setdefault(name, {})
            if thing.number in self.things:
                called[thing.number] = thing
            else:
                called.pop(thing.number, None)

    def called(self, names: Iterable[str]) -> list[Known]:
        """Return the things that were ever called by any of some names, by number."""
        found = {
            number: thing for name in names for number, thing in self._called.get(name, {}).items()
        }
        return [found[number] for number in sorted(found)]

    def take_touched(self) -> set[int]:
        """Return the numbers of the things that were touched since the last call."""
        touched, self._touched = self._touched, set()
        return touched

    def add(self, thing: Known) -> None:
        """Take in a thing, whose look and places are to follow."""
        self.things[thing.number] = thing
        self.looks.add(thing)
        self.touch(thing)

    def remove(self, thing: Known) -> None:
        """Forget a thing."""
        self.positions.remove(_placed(thing))
        self.looks.remove(thing)
        del self.things[thing.number]
        self.touch(thing)

    def lay(self, things: Sequence[Known]) -> list[Sleeper]:
        """Put things to sleep."""
        slept = self._with_rows(things)
        self.positions.remove([place for each in slept for place, _ in each.rows])
        for each in slept:
            del self.things[each.thing.number]
            self._asleep[each.thing.number] = each
            self.touch(each.thing)
        return slept

    def _with_rows(self, things: Sequence[Known]) -> list[Sleeper]:
        known = self.positions.of
        return [Sleeper(thing, [(p, known(p)) for p in _placed(thing)]) for thing in things]

    def wake(self, numbers: Iterable[int]) -> list[Known]:
        """Take in again what sleeps under some numbers."""
        woken = [self._asleep.pop(number) for number in numbers]
        self.things |= {each.thing.number: each.thing for each in woken}
        for each in woken:
            self.touch(each.thing)
        self.positions.add([(e.thing, place, row) for e in woken for place, row in e.rows])
        return [each.thing for each in woken]

    def is_asleep(self, number: int) -> bool:
        """Say whether a thing sleeps."""
        return number in self._asleep

    def sleepers(self) -> list[Sleeper]:
        """Return what sleeps, what left first before."""
        return list(self._asleep.values())

    def forget_sleepers(self, numbers: Iterable[int]) -> None:
        """Forget some things that sleep."""
        for number in list(numbers):
            self.looks.remove(self._asleep.pop(number).thing)

    def wholes(self) -> list[Whole]:
        """Return all things with what the arrays hold of them: by number, then what sleeps."""
        awake = self._with_rows([self.things[number] for number in sorted(self.things)])
        return [
            Whole(each.thing, self.looks.of(each.thing), tuple(each.rows))
            for each in (*awake, *self._asleep.values())
        ]

    def placeless(self) -> list[Known]:
        """Return things that have no position, by number."""
        if self.positions.placed == len(self.things):  # the usual case, without looking at each
            return []
        return [
            self.things[number]
            for number in sorted(self.things)
            if all(place.row < 0 for place in self.things[number].places)
        ]


def _placed(thing: Known) -> list[Place]:
    return [place for place in thing.places if place.row >= 0]
