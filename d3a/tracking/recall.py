"""Default profile, tier 3: what leaves the short-term memory goes to the store and comes back.

Things are written as ordinary records (absolute puts, ids stable from birth). What was not viewed
for longest is evicted; it is fetched back by place when the robot looks there again.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from d3a.answer import is_by_look
from d3a.checkpoint import Arrays
from d3a.correcting.same_thing import ranked, votes_of
from d3a.ledger import Ledger
from d3a.model import Json
from d3a.parameters import Parameters
from d3a.sightings import Interval
from d3a.store.base import Area, ObjectRecord, StayRecord
from d3a.symmetric import flat, of_rows
from d3a.tier3 import Stored
from d3a.tracking import likelihood
from d3a.tracking.known import Known, Place
from d3a.tracking.likelihood import VARIANCES
from d3a.tracking.memory import Memory, Sleeper
from d3a.tracking.memory_state import memory_of_state, memory_state
from d3a.tracking.outside import Outside
from d3a.tracking.positions import Row

CELL_M = 4.0
"""Side of the squares in which the store is asked what is where: about a room."""
EVICTED_SHARE = 16
"""When the memory is over its bound, a share of it goes at once (one in so many)."""
ASLEEP = 8
"""So many times the memory's bound of things are kept beside it, whole but not compared: the store
does not hold what looks have told of a place, nor all that is known of where it is."""
REACH_SIGMAS, SPREAD_M = 3.0, 1.0
"""What comes back is within so many sigmas along each axis: what is farther off is hardly ever what
was seen. The store is asked what is around as if a thing there might be so far off, one sigma."""
LEAST_M2 = 1e-6
"""No mean is known better than to a millimetre."""
Floats = NDArray[np.float64]
Cell = tuple[int, int] | None
"""A square of the ground plane; None: things without a position."""
FIRST_NUMBER = 1


class Recall:
    """Moves things between the memory and the ledger."""

    def __init__(
        self, memory: Memory, ledger: Ledger, stored: Stored, parameters: Parameters, outside: int
    ) -> None:
        self._memory = memory
        self._ledger = ledger
        self._stored = stored
        self._parameters = parameters
        self._is_histogram = is_histogram(stored.embedding_model)
        self.outside = outside
        """How many objects the store holds that the memory does not."""
        self._complete: set[Cell] = set()
        """Squares of which `_index` knows all that is not in memory."""
        self._index = Outside()
        self._wanted: set[str] = set()

    # to the store
    def write(self) -> None:
        """Put what changed into the ledger."""
        self.write_some(self._memory.things.values())

    def write_some(self, things: Iterable[Known]) -> None:
        """Put those of some things that changed into the ledger."""
        for thing in things:
            if thing.dirty:
                self._put(thing)

    def _put(self, thing: Known) -> None:
        look = self._memory.looks.of(thing)
        tentative = thing.seen < self._parameters.confirm_sightings
        self._ledger.put_object(
            ObjectRecord(
                object_id=thing.object_id,
                category=thing.category,
                weight=thing.weight,
                first_ms=thing.first_ms,
                last_ms=thing.last_ms,
                site=self._stored.site,
                categories=ranked(thing.votes),
                names=thing.names,
                embedding=None
                if look is None
                else likelihood.embedding_of(look, self._is_histogram),
                embedding_model=None if look is None else self._stored.embedding_model,
                extent_m=thing.extent_m,
                tentative=tentative,
            )
        )
        for place in thing.places:
            self._ledger.put_stay(self._stay(thing, place, tentative))
            if place.open is not None:
                self._ledger.put_sighting(place.open.sighting((thing.object_id, place.number)))
        thing.dirty = False

    def _stay(self, thing: Known, place: Place, tentative: bool) -> StayRecord:
        position = covariance = None
        if place.row >= 0:
            row = self._memory.positions.of(place)
            position, covariance = row.raw, flat(row.spread)
        return StayRecord(
            object_id=thing.object_id,
            place=place.number,
            position=position,
            first_ms=place.first_ms,
            last_ms=place.last_ms,
            weight=place.weight,
            site=self._stored.site,
            covariance=covariance,
            seen=place.seen,
            moved_from=place.moved_from,
            last_absent_ms=place.last_absent_ms,
            tentative=tentative,
        )

    def evict(self) -> list[Known]:
        """Write and put to sleep the least recently viewed when the memory is over its bound.

        To be compared with what is in view counts as a view: else what has just come back would be
        the first to go again.
        """
        things, most = self._memory.things, self._parameters.stm_capacity
        if len(things) <= most:
            return []
        over = len(things) - most + most // EVICTED_SHARE
        viewed = [
            (t.last_ms if t.last_ms > t.compared_ms else t.compared_ms, number)
            for number, t in things.items()
        ]
        oldest = [things[number] for _, number in sorted(viewed)[:over]]
        for thing in oldest:
            if thing.dirty:
                self._put(thing)
        self._lay(oldest)
        asleep = self._memory.sleepers()
        over = max(0, len(asleep) - most * ASLEEP)  # where those are the store tells
        self._memory.forget_sleepers(each.thing.number for each in asleep[:over])
        self.outside += len(oldest)
        return oldest

    def _lay(self, things: list[Known]) -> None:
        """Put things to sleep."""
        self._remember_asleep(self._memory.lay(things))

    def _remember_asleep(self, asleep: list[Sleeper]) -> None:
        ids: list[str] = []
        spots: list[Sequence[float]] = []
        for each in asleep:
            object_id = each.thing.object_id
            for _, row in each.rows:
                ids.append(object_id)
                xx, _, _, yy, _, zz = row.spread
                spots.append((*row.raw, xx, yy, zz))
            if len(each.rows) < len(each.thing.places):
                self._index.add(object_id, None, ())
        self._index.add_all(ids, spots)

    def _remember(self, stay: StayRecord) -> None:
        surface = self._parameters.object_spread_m**2 * 2
        variance = stay.covariance or np.diag([surface] * 3).ravel().tolist()
        self._index.add(stay.object_id, stay.position, (variance[0], variance[4], variance[8]))

    def things(self) -> Iterator[Known]:
        """Yield all things that were not left to the store alone."""
        yield from self._memory.things.values()
        for each in self._memory.sleepers():
            yield each.thing

    def forget_all(self) -> None:
        """Empty the memory; everything in it is written."""
        self._wanted.clear()
        self._memory.forget_sleepers(each.thing.number for each in self._memory.sleepers())
        for thing in list(self._memory.things.values()):
            self._memory.remove(thing)
            self.outside += 1
        self._forget_index()

    def refetch(self, before: Collection[str], after: Collection[str]) -> list[Known]:
        """Forget objects that the store has otherwise now; what they became comes back at once.

        before, after: ids. All of the memory is written. Returns what was forgotten.
        """
        ids = {*before, *after}
        gone = [t for t in self._memory.things.values() if t.object_id in ids]
        for thing in gone:
            self._memory.remove(thing)
        asleep = [t.thing for t in self._memory.sleepers() if t.thing.object_id in ids]
        self._memory.forget_sleepers(thing.number for thing in asleep)
        if gone:
            self._wanted = (self._wanted - ids) | set(after)
        # One too many costs a look into the store, one too few would hide things.
        self.outside += len(gone) + max(0, len(after) - len(before))
        self._forget_index()
        return gone

    def _forget_index(self) -> None:
        self._complete.clear()
        self._index.clear()
        self._remember_asleep(self._memory.sleepers())

    # from the store
    def fetch(self, places: Floats, noise: Floats, shared_m2: float, now_ms: int) -> list[Known]:
        """Bring back what is known around some positions (n, 3), NaN where unknown.

        noise (n, 6): covariance of each, xx xy xz yy yz zz; shared_m2: variance along each axis of
        what all of them have in common. Returns what had slept.
        """
        if self.outside == 0:
            return []
        variance = noise[:, VARIANCES] + shared_m2
        self._ask(places, variance)
        ids, self._wanted = self._wanted, set()
        ids |= self._index.near(places, variance, REACH_SIGMAS)
        if not ids:
            return []
        is_asleep = self._memory.is_asleep
        away = sorted(each for each in ids if self._is_away(each))
        woken = self._wake([name for name in away if is_asleep(number_of(name))], now_ms)
        stored = [name for name in away if number_of(name) not in self._memory.things]
        if stored:
            self._load(stored, now_ms)
        return woken

    def _wake(self, object_ids: list[str], now_ms: int) -> list[Known]:
        woken = self._memory.wake(number_of(name) for name in object_ids)
        for thing in woken:
            thing.compared_ms = now_ms
        self._index.remove(object_ids)
        self.outside -= len(woken)
        return woken

    def _ask(self, places: Floats, variance: Floats) -> None:
        """Learn what the store has around some places, where that is not known yet."""
        for cell in self._missing(places, variance):
            if cell is None:
                found = [stay for stay in self._ledger.stays() if stay.position is None]
            else:
                low_x, low_y = cell[0] * CELL_M, cell[1] * CELL_M
                area = Area(low_x, low_y, low_x + CELL_M, low_y + CELL_M)
                # the area's far sides belong to the next squares
                found = [stay for stay in self._ledger.stays(area=area) if _cell_of(stay) == cell]
            self._complete.add(cell)
            for stay in found:
                if stay.site != self._stored.site or not self._is_away(stay.object_id):
                    continue
                # where a sleeper is is known
                if not self._memory.is_asleep(number_of(stay.object_id)):
                    self._remember(stay)

    def _is_away(self, object_id: str) -> bool:
        """Say whether an object may be in a later frame and is not in memory.

        What is known by its look alone is in none: no detector knows it.
        """
        return not is_by_look(object_id) and number_of(object_id) not in self._memory.things

    def _missing(self, places: Floats, variance: Floats) -> list[Cell]:
        missing: list[Cell] = [] if None in self._complete else [None]
        known = [
            (x, y, REACH_SIGMAS * (math.sqrt(vx + vy + vz) + SPREAD_M))
            for (x, y, _), (vx, vy, vz) in zip(places.tolist(), variance.tolist(), strict=True)
            if not math.isnan(x)
        ]
        if not known:
            return missing
        left, low = (math.floor(min(k[i] - k[2] for k in known) / CELL_M) for i in (0, 1))
        right, high = (math.floor(max(k[i] + k[2] for k in known) / CELL_M) for i in (0, 1))
        missing += [
            (column, row)
            for column in range(left, right + 1)
            for row in range(low, high + 1)
            if (column, row) not in self._complete
        ]
        return missing

    def _load(self, ids: list[str], now_ms: int) -> None:
        stays: dict[str, list[StayRecord]] = {}
        for stay in self._ledger.stays(object_ids=ids):
            stays.setdefault(stay.object_id, []).append(stay)
        gap_ms = round(self._parameters.unbroken_gap_s * 1000)
        open_of = {
            sighting.stay: Interval.from_sighting(sighting)
            for sighting in self._ledger.sightings(ids, now_ms - gap_ms, now_ms)
        }
        placed: list[tuple[Known, Place, StayRecord]] = []
        for record in self._ledger.objects(ids=ids):
            if record.site != self._stored.site:  # a map of its own: its places are not these
                continue
            thing = self._known(record)
            thing.compared_ms = now_ms
            for stay in stays.get(record.object_id, []):
                place = self._place(stay, open_of.get(stay.key))
                thing.places.append(place)
                thing.seen += stay.seen
                if stay.position is not None:
                    placed.append((thing, place, stay))
            self._index.remove([record.object_id])
            self.outside -= 1
        self._settle(placed)

    def _known(self, record: ObjectRecord) -> Known:
        thing = Known(
            number=number_of(record.object_id),
            votes=votes_of(record),
            first_ms=record.first_ms,
            last_ms=record.last_ms,
            weight=record.weight,
            extent_m=record.extent_m,
            extents=0 if record.extent_m is None else 1,
            names=record.names,
            dirty=False,
        )
        self._memory.add(thing)
        if record.embedding is not None:
            look = likelihood.feature(record.embedding, self._is_histogram)
            self._memory.looks.put(thing, look, record.weight)
        return thing

    def _place(self, stay: StayRecord, interval: Interval | None) -> Place:
        is_left = stay.last_absent_ms is not None  # the odds of that, which nobody wrote, at least
        return Place(
            number=stay.place,
            first_ms=stay.first_ms,
            last_ms=stay.last_ms,
            weight=stay.weight,
            seen=stay.seen,
            moved_from=stay.moved_from,
            last_absent_ms=stay.last_absent_ms,
            there=-self._parameters.absent_odds if is_left else 0.0,
            open=interval,
        )

    def _settle(self, placed: list[tuple[Known, Place, StayRecord]]) -> None:
        """Give places their stored positions, all at once."""
        if not placed:
            return
        parameters = self._parameters
        surface = np.eye(3) * parameters.object_spread_m**2
        unknown = (surface * 2).ravel()
        spread = np.array([unknown if s.covariance is None else s.covariance for *_, s in placed])
        # What is stored is the spread: the surface's share comes back when it is spread anew.
        errors = spread.reshape(-1, 3, 3) - surface
        for k in np.flatnonzero(np.linalg.eigvalsh(errors)[:, 0] < LEAST_M2).tolist():
            errors[k] = np.diag(np.maximum(np.diag(errors[k]), LEAST_M2))  # it is to be inverted
        rows = []
        for (thing, place, stay), error in zip(placed, errors.reshape(-1, 9).tolist(), strict=True):
            assert stay.position is not None
            mean = stay.position
            rows.append((thing, place, Row.of(mean, mean, of_rows(error), (0.0, 0.0), parameters)))
        self._memory.positions.add(rows)

    def to_state(self) -> tuple[Json, Arrays]:
        """Return the memory, and what is known of the store beside what it holds."""
        record, arrays = memory_state(self._memory.wholes())
        asleep = len(self._memory.sleepers())
        own = {"outside": self.outside, "wanted": sorted(self._wanted), "asleep": asleep}
        return record | {"recall": own}, arrays

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called; where other things are the store tells again."""
        memory_of_state(self._memory, record, arrays, self._parameters)
        own = record["recall"]
        self.outside, self._wanted = own["outside"], set(own["wanted"])
        things = list(self._memory.things.values())
        asleep = own.get("asleep", 0)  # older checkpoints have none
        self._lay(things[len(things) - asleep :])


def _cell_of(stay: StayRecord) -> Cell:
    if stay.position is None:
        return None
    return math.floor(stay.position[0] / CELL_M), math.floor(stay.position[1] / CELL_M)


def is_histogram(model: str | None) -> bool:
    """Say whether a model's embeddings are colour counts, whose square roots are compared."""
    return model is not None and model.startswith("rgb-")


def number_of(object_id: str) -> int:
    """Return the number in an id such as "o12"; that of "s3" is -3."""
    return -int(object_id[1:]) if object_id.startswith("s") else int(object_id.removeprefix("o"))
