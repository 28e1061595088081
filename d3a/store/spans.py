"""When objects were seen, as columns: what numbers and choices need of thousands of sightings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.store.documents import Sighting, StayKey, StayRecord

SightingKey = tuple[str, int, int]
"""(object_id, place, start_ms): one sighting."""
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
UNKNOWN = (float("nan"),) * 9
"""The covariance of a position that nothing measured."""


@dataclass(frozen=True, slots=True)
class Spans:
    """Sightings without their pictures, by (object_id, start, end, place).

    ids: the objects that were asked for, sorted, none twice. of, place, start_ms, end_ms (n,): the
    number of a sighting's object among `ids`, its place, and its closed interval.
    """

    ids: tuple[str, ...]
    of: Ints
    place: Ints
    start_ms: Ints
    end_ms: Ints

    @classmethod
    def of_rows(cls, object_ids: Sequence[str], rows: Sequence[tuple[str, int, int, int]]) -> Spans:
        """Return rows of (object_id, start, end, place) as columns."""
        ids = tuple(sorted({*object_ids}))
        number = {name: n for n, name in enumerate(ids)}
        names, *columns = zip(*rows, strict=True) if rows else ((), (), (), ())
        start, end, place = (np.array(column, dtype=np.int64) for column in columns)
        return cls(ids, np.array([number[name] for name in names], np.int64), place, start, end)

    @classmethod
    def of_texts(cls, object_ids: Sequence[str], rows: Sequence[tuple[str, str]]) -> Spans:
        """Return the columns of rows of (object_id, "start end place start end place ...").

        Half a million sightings are read as text in half the time that they take as rows.
        """
        ids = tuple(sorted({*object_ids}))
        number = {name: n for n, name in enumerate(ids)}
        numbers = np.fromstring(" ".join([text for _, text in rows]), dtype=np.int64, sep=" ")
        start, end, place = numbers.reshape(-1, 3).T
        each = [(text.count(" ") + 1) // 3 for _, text in rows]
        of = np.repeat(np.array([number[name] for name, _ in rows], np.int64), each)
        found = cls(ids, of, place, start, end)
        later = (np.diff(of) > 0) | ((np.diff(of) == 0) & (np.diff(start) > 0))
        return found if later.all() else found.chosen(np.lexsort((place, end, start, of)))

    @classmethod
    def of_sightings(cls, object_ids: Sequence[str], sightings: Sequence[Sighting]) -> Spans:
        """Return the columns of sightings that were read."""
        rows = sorted((s.object_id, s.start_ms, s.end_ms, s.place) for s in sightings)
        return cls.of_rows(object_ids, rows)

    def __len__(self) -> int:
        """Return how many sightings there are."""
        return len(self.of)

    def chosen(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Spans:
        """Return some of the rows, in their order."""
        columns = (self.of, self.place, self.start_ms, self.end_ms)
        return Spans(self.ids, *(column[rows] for column in columns))

    def stays(self) -> list[StayKey]:
        """Return the stay of each sighting."""
        rows = zip(self.of.tolist(), self.place.tolist(), strict=True)
        return [(self.ids[of], place) for of, place in rows]

    def which(self) -> list[SightingKey]:
        """Return which sightings these are."""
        rows = zip(self.of.tolist(), self.place.tolist(), self.start_ms.tolist(), strict=True)
        return [(self.ids[of], place, start) for of, place, start in rows]


@dataclass(frozen=True, slots=True)
class Positions:
    """Where the stays of objects are, by (object_id, place).

    ids: the objects that were asked for, sorted, none twice. of, place (n,): the number of a stay's
    object among `ids`, and its place. x, y, z (n,): metres; variance (n,): of the position, the
    mean over its axes, in square metres; NaN where unknown. site (n,): the number of its map in
    `sites`.
    """

    ids: tuple[str, ...]
    of: Ints
    place: Ints
    x: Floats
    y: Floats
    z: Floats
    variance: Floats
    site: Ints
    sites: tuple[str, ...]

    @classmethod
    def of_columns(
        cls, object_ids: Sequence[str], columns: Sequence[Sequence[Any]], covariance: Floats
    ) -> Positions:
        """Return (object_id, place, x, y, z, site) of stays in order, and covariance (n, 9)."""
        ids = tuple(sorted({*object_ids}))
        number = {name: n for n, name in enumerate(ids)}
        names, place, x, y, z, site = columns
        sites = {name: n for n, name in enumerate(dict.fromkeys(site))}
        return cls(
            ids,
            np.array([number[name] for name in names], dtype=np.int64),
            np.array(place, dtype=np.int64),
            np.array(x, dtype=np.float64),  # None becomes NaN
            np.array(y, dtype=np.float64),
            np.array(z, dtype=np.float64),
            (covariance[:, 0] + covariance[:, 4] + covariance[:, 8]) / 3,
            np.array([sites[name] for name in site], dtype=np.int64),
            tuple(sites),
        )

    @classmethod
    def of_stays(cls, object_ids: Sequence[str], stays: Sequence[StayRecord]) -> Positions:
        """Return the columns of stays that were read, in their order."""
        places = [stay.position or (None, None, None) for stay in stays]
        columns = (
            [stay.object_id for stay in stays],
            [stay.place for stay in stays],
            [at[0] for at in places],
            [at[1] for at in places],
            [at[2] for at in places],
            [stay.site for stay in stays],
        )
        covariance = np.array([s.covariance or UNKNOWN for s in stays], dtype=np.float64)
        return cls.of_columns(object_ids, columns, covariance.reshape(-1, 9))

    def __len__(self) -> int:
        """Return how many stays there are."""
        return len(self.of)

    def rows_of(self, spans: Spans) -> Ints:
        """Return the row of the stay of each sighting of the same objects (n,)."""
        width = 1 + max(int(each.place.max(initial=0)) for each in (self, spans))
        return np.asarray(
            np.searchsorted(self.of * width + self.place, spans.of * width + spans.place)
        )
