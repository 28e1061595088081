"""The store: records of OIc and STc, a batch of writes, and the Protocol of both backends.

Paper: Tier 3 and the appendix (two collections). Times are UTC milliseconds, intervals are closed
at both ends. Every write is an absolute put or a removal, so that a batch may be applied twice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from d3a.model import Json
from d3a.store.batch import Batch, Expected
from d3a.store.documents import (
    LEAST_SIGMA_M,
    Apart,
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Region,
    Sighting,
    StayKey,
    StayRecord,
    TaughtName,
    View,
)
from d3a.store.errors import (
    StoreBusy,
    StoreConflict,
    StoreDamaged,
    StoreError,
    StoreMissing,
    StoreRefused,
    StoreUnreachable,
)
from d3a.store.spans import Positions, SightingKey, Spans

if TYPE_CHECKING:
    from d3a.store.lease import Lease

__all__ = [
    "FORGOTTEN",
    "LEAST_SIGMA_M",
    "SCHEMA",
    "Apart",
    "Area",
    "Batch",
    "Encounter",
    "Expected",
    "Keyframe",
    "NativeQuery",
    "ObjectRecord",
    "Positions",
    "RecordingRecord",
    "Region",
    "Sighting",
    "SightingKey",
    "Spans",
    "StayKey",
    "StayRecord",
    "Store",
    "StoreBusy",
    "StoreConflict",
    "StoreDamaged",
    "StoreError",
    "StoreMissing",
    "StoreRefused",
    "StoreUnreachable",
    "TaughtName",
    "View",
]

SCHEMA = 1
FORGOTTEN = "forgotten"
"""Key in the store's meta: how often something was forgotten. Nothing says what."""


@dataclass(frozen=True, slots=True)
class Area:
    """An axis-aligned box of the ground plane, metres, edges included."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


@dataclass(frozen=True, slots=True)
class NativeQuery:
    """One query as the backend ran it, for `explain`: its text, the index, rows and time."""

    text: str
    index: str | None
    rows: int
    elapsed_ms: float


class Store(Protocol):
    """OIc and STc behind one narrow interface; SQLite and MongoDB keep one contract suite.

    Every list has a stated order, ties by id. Readers in other processes see whole batches.
    Every method raises StoreError (unreachable, refused, damaged) and nothing of the driver's.
    """

    uri: str
    """The store's address, passwords masked."""

    def close(self) -> None:
        """Release the connection; the store can be opened again."""
        ...

    # writing
    def turn(self) -> AbstractContextManager[object]:
        """Keep all other writers away: what is read within still holds when it is written.

        For milliseconds; turns of one thread nest. What is applied within is committed when the
        outermost ends, or (a server) at once. Raises StoreBusy where another does not end its turn.
        """
        ...

    def apply(self, batch: Batch) -> None:
        """Apply a batch; returns after the commit. Applying it again changes nothing."""
        ...

    def lease(self) -> Lease | None:
        """Return who ingests or did last, None for nobody yet. It is no part of the content."""
        ...

    def put_lease(self, lease: Lease) -> None:
        """Keep another lease; in a turn, for `store/lease.py`."""
        ...

    def clock_ms(self) -> int:
        """Return what time leases go by: that of the server, where there is one."""
        ...

    def collect_keyframes(self, keep: Sequence[str] = ()) -> int:
        """Remove pictures that no sighting or encounter refers to, but for `keep`; count them."""
        ...

    def scrub(self) -> bool:
        """Leave no byte of what was removed in the store's files; False: a server's own affair.

        Raises StoreError where another process keeps the old state open; call it again then.
        """
        ...

    def moment(self) -> AbstractContextManager[object]:
        """Have all reads within see one moment; nothing is to be written.

        A server can only keep the others from writing, and not for who opened it to read.
        """
        ...

    # OIc
    def objects(
        self,
        *,
        ids: Sequence[str] | None = None,
        categories: Sequence[str] | None = None,
        names: Sequence[str] | None = None,
        votes: bool = False,
        embeddings: bool = True,
    ) -> list[ObjectRecord]:
        """Return objects by id; None: no condition, conditions are and-ed.

        categories: the record's `category`, exactly; with `votes` also the categories that only
        some of its detections had. names: the `word` of a taught name, exactly.
        embeddings: False leaves them out, which is quicker.
        """
        ...

    def categories(self) -> list[tuple[str, int]]:
        """Return (category, objects of it), by category."""
        ...

    def names(self) -> list[TaughtName]:
        """Return what people call the objects, by (word, owner or ""), none twice."""
        ...

    def embeddings(self, limit: int | None = None) -> tuple[list[str], NDArray[np.float32]]:
        """Return the ids, by id, of the objects with an embedding, and their matrix (n, d).

        limit: only the first so many.
        """
        ...

    # STc
    def stays(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[StayRecord]:
        """Return stays by (object_id, place) whose [first, last] touches [start, end].

        area: the position, edges included; a stay without a position is in no area.
        """
        ...

    def stays_at(self, keys: Sequence[StayKey]) -> list[StayRecord]:
        """Return these stays of those that there are, by (object_id, place)."""
        ...

    def sightings(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> list[Sighting]:
        """Return sightings by (start, object_id, place) that touch the closed [start, end].

        area: where the sighting's stay is. limit: only the first so many.
        """
        ...

    def sightings_at(self, keys: Sequence[SightingKey]) -> list[Sighting]:
        """Return these sightings of those that there are, by (start, object_id, place)."""
        ...

    def spans(
        self,
        object_ids: Sequence[str],
        *,
        area: Area | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
        limit: int | None = None,
    ) -> Spans:
        """Return when objects were seen within the closed [start, end], by (object_id, start, end).

        Of all that they touch; ties by place. area, limit: as `sightings` has them.
        """
        ...

    def positions(self, object_ids: Sequence[str]) -> Positions:
        """Return where the stays of objects are, by (object_id, place)."""
        ...

    def newest(
        self,
        object_ids: Sequence[str],
        limit: int,
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
        oldest: bool = False,
    ) -> list[Sighting]:
        """Return at most `limit` sightings that touch [start, end], by (start, object_id, place).

        All of them where there are no more. Else the newest of each stay, of the `limit` stays
        with the newest; of fewer stays than that up to limit // stays of each. Newest is the
        greatest (start, object_id, place); with `oldest`, the least counts instead.
        """
        ...

    def reach(self, object_ids: Sequence[str], count: int, *, oldest: bool = False) -> int | None:
        """Return the start of the count-th newest (or oldest) sighting of any of the objects.

        None where there are not so many. Newest: by start.
        """
        ...

    def count_seen(
        self,
        object_ids: Sequence[str],
        *,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> int:
        """Count the objects with a sighting that touches the closed [start, end]."""
        ...

    def edges(
        self,
        object_ids: Sequence[str],
        which: str,
        *,
        before_ms: int | None = None,
        after_ms: int | None = None,
    ) -> list[Sighting]:
        """Return each object's "first" or "last" sighting, by object_id.

        before_ms: only sightings that start at or before it. after_ms: that end at or after it.
        First is the least (start, end, place), last is the greatest (end, start, place).
        """
        ...

    def encounters(
        self,
        *,
        object_ids: Sequence[str] | None = None,
        with_ids: Sequence[str] | None = None,
        start_ms: int | None = None,
        end_ms: int | None = None,
    ) -> list[Encounter]:
        """Return encounters by (start, a, b, places) between one of `object_ids` and `with_ids`.

        None stands for every object; either may be object_a.
        """
        ...

    # pictures, coverage, places, bookkeeping
    def keyframe(self, key: str) -> Keyframe | None:
        """Return a stored picture."""
        ...

    def keyframe_keys(self) -> list[str]:
        """Return the keys of all stored pictures, sorted."""
        ...

    def views(self, *, start_ms: int | None = None, end_ms: int | None = None) -> list[View]:
        """Return views by (start, end) that touch the closed [start, end]."""
        ...

    def last_view_ms(self) -> int | None:
        """Return the time of the newest frame in the store."""
        ...

    def regions(self) -> list[Region]:
        """Return named rooms, by name."""
        ...

    def recordings(self) -> list[RecordingRecord]:
        """Return recordings, by key."""
        ...

    def meta(self, key: str) -> Any | None:
        """Return a JSON value (zone, now, classes, parameters, ...), None where it is not set."""
        ...

    def state(self) -> bytes | None:
        """Return the associator's checkpoint."""
        ...

    def revision(self) -> tuple[int, int] | None:
        """Return what changes with every write, by whomever: equal revisions, equal answers.

        Only of use to compare with an earlier one of the same open store. None: cannot be told.
        """
        ...

    def counts(self) -> Json:
        """Return how many records of each kind there are, and the store's size in bytes."""
        ...

    def check(self) -> list[str]:
        """Return what is damaged or dangling, a sentence each; [] for a sound store."""
        ...

    def repair(self) -> list[str]:
        """Mend what `check` finds, where it can be: a sentence for each change, [] for none.

        Nothing is made up: what dangles is removed, indexes are built anew.
        """
        ...

    def tracing(self, observer: Callable[[NativeQuery], None] | None) -> None:
        """Call `observer` after every native query, with its plan; None stops it."""
        ...

    def dump(self) -> Iterator[Json]:
        """Yield every record as plain JSON, in a fixed order: to compare stores.

        Of a picture its key and sizes, of the checkpoint its hash.
        """
        ...
