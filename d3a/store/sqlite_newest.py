"""The newest sightings of many objects, and their stays, without reading the rest.

A history of months holds more sightings of a common thing than a person can be told. Windows of
time are walked from the newest (or the oldest) on, each as wide as should hold enough, until
enough stays are found: what lies beyond is never touched.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from d3a.store.base import StayKey
from d3a.store.rows import SIGHTING_COLUMNS, Row
from d3a.store.sqlite_read import (
    MANY_IDS,
    Select,
    among,
    as_list,
    columns_of,
    seen,
    seen_within,
    sightings,
    stays_at,
    stays_of_rows,
    touching,
)

Rows = Callable[[str, dict[str, Any]], list[Row]]
_ORDER = "s.start_ms, s.object_id, s.place"
_COLUMNS = columns_of("s", f"{SIGHTING_COLUMNS}, stay_id")
PROBE = 4
"""A step into an index costs as much as so many rows that are walked."""
SPARE = 2.5
"""Sightings that the first window should hold for each stay that is wanted: two of a stay are
usual, and a window that falls short by one stay costs as much again."""
MANY_TIMES = 10
"""Where so many times the limit are to be expected, they are surely more than the limit."""
_EXTENT = """
SELECT (SELECT max(id) FROM sighting), (SELECT min(start_ms) FROM sighting),
  (SELECT max(start_ms) FROM sighting), (SELECT max(rowid) FROM oic),
  (SELECT value FROM internal WHERE key = 'max_sighting_ms')
"""
_LAST_VIEW = """
SELECT max(ms) FROM (
  SELECT max(end_ms) AS ms FROM seen_area UNION ALL SELECT max(last_ms) FROM recording
)
"""


@dataclass(frozen=True, slots=True)
class _Extent:
    """How much there is: sightings, from when to when they start, objects, the longest."""

    sightings: int
    first_ms: int
    last_ms: int
    objects: int
    longest_ms: int

    @classmethod
    def read(cls, rows: Rows) -> _Extent | None:
        """Return the store's, None where nothing was seen. rows: runs a query."""
        row = rows(_EXTENT, {})[0]
        return None if row[0] is None else cls(*row)

    @property
    def a_ms(self) -> float:
        """How many sightings of any object start in a millisecond."""
        return self.sightings / max(1, self.last_ms - self.first_ms)

    def within(self, start_ms: int | None, end_ms: int | None) -> tuple[int, int]:
        """Return from when to when what touches the closed [start, end] may start."""
        low = self.first_ms if start_ms is None else max(self.first_ms, start_ms - self.longest_ms)
        return low, self.last_ms if end_ms is None else min(self.last_ms, end_ms)

    def expected(self, width_ms: int, ids: int) -> float:
        """Return how many sightings of so many objects start in a span, seen as often as others."""
        return self.a_ms * width_ms * min(1.0, ids / max(1, self.objects))

    def is_walked(self, width_ms: int, ids: int) -> bool:
        """Whether to walk through so much time beats a step into an index for each of the ids."""
        return width_ms * self.a_ms < PROBE * ids


def count_seen(
    rows: Rows, object_ids: Sequence[str], start_ms: int | None, end_ms: int | None
) -> int:
    """Return what `Store.count_seen` does. rows: runs a query."""
    ids = sorted(dict.fromkeys(object_ids))  # most come in their order: sorted at once
    select = seen(ids, start_ms, end_ms)
    if len(ids) > MANY_IDS and start_ms is not None and end_ms is not None:
        extent = _Extent.read(rows)
        if extent is not None and extent.is_walked(end_ms - start_ms + extent.longest_ms, len(ids)):
            select = seen_within(ids, start_ms, end_ms)
    return int(rows(select.text(), select.parameters)[0][0])


def last_view_ms(rows: Rows) -> int | None:
    """Return what `Store.last_view_ms` does. rows: runs a query."""
    newest: int | None = rows(_LAST_VIEW, {})[0][0]
    return newest


@dataclass(slots=True)
class _Stays:
    """The stays found so far, each with start and row id of its newest sighting; and how many."""

    newest: dict[StayKey, tuple[int, int]] = field(default_factory=dict)
    sightings: int = 0

    def take(self, rows: Sequence[Row]) -> int:
        """Take a window's stays: those of an earlier window are newer. Returns its sightings."""
        count = 0
        for object_id, place, start_ms, row_id, several in rows:
            self.newest.setdefault((object_id, place), (start_ms, row_id))
            count += several
        self.sightings += count
        return count

    def best(self, limit: int, *, oldest: bool) -> list[int]:
        """Return the row ids of the newest `limit`, ties by object_id and place."""
        ordered = sorted(
            ((start_ms, *stay, row_id) for stay, (start_ms, row_id) in self.newest.items()),
            reverse=not oldest,
        )
        return [row_id for *_, row_id in ordered[:limit]]


@dataclass(frozen=True)
class Newest:
    """One call of `Store.newest`."""

    object_ids: Sequence[str]
    limit: int
    start_ms: int | None
    end_ms: int | None
    oldest: bool = False

    def read(self, rows: Rows) -> list[Row]:
        """Return the rows of SIGHTING_COLUMNS and stay_id. rows: runs a query."""
        ids = sorted(dict.fromkeys(self.object_ids))
        extent = _Extent.read(rows) if ids and self.limit > 0 else None
        if extent is None:
            return []
        low, high = extent.within(self.start_ms, self.end_ms)
        many = extent.expected(high - low, len(ids)) > MANY_TIMES * self.limit
        if not many and len(ids) <= MANY_IDS and self._are_few(rows, ids):
            return self._all(rows, ids)
        stays = self._walk(rows, ids, extent)
        if len(stays.newest) < self.limit:
            if stays.sightings <= self.limit:
                return self._all(rows, ids)
            return self._several_of_each(rows, sorted(stays.newest))
        source = "json_each(:rows) j CROSS JOIN sighting s ON s.id = j.value"
        best = as_list(stays.best(self.limit, oldest=self.oldest))
        select = Select(_COLUMNS, source, _ORDER, [], {"rows": best})
        return rows(select.text(), select.parameters)

    def _are_few(self, rows: Rows, ids: Sequence[str]) -> bool:
        select = Select("q.id", "sighting q INDEXED BY sighting_object_start", "")
        select.where(among("q.object_id", "ids"), ids=as_list(ids))
        touching(select, "q", "max_sighting_ms", self.start_ms, self.end_ms)
        text = f"SELECT count(*) FROM ({select.text()} LIMIT :most)"
        counted = rows(text, {**select.parameters, "most": self.limit + 1})
        return int(counted[0][0]) <= self.limit

    def _all(self, rows: Rows, ids: Sequence[str]) -> list[Row]:
        select = sightings(ids, None, self.start_ms, self.end_ms, trees=False)
        select.columns = _COLUMNS
        return rows(select.text(), select.parameters)

    def _walk(self, rows: Rows, ids: Sequence[str], extent: _Extent) -> _Stays:
        """Return the stays of windows of time, until they are enough or there is no more."""
        found = _Stays()
        low, high = extent.within(self.start_ms, self.end_ms)
        width = max(60_000, round(SPARE * self.limit / extent.expected(1, len(ids))))
        listed = as_list(ids)
        while low <= high and len(found.newest) < self.limit:
            begin = low if self.oldest else max(low, high - width + 1)
            end = min(high, low + width - 1) if self.oldest else high
            walked = extent.is_walked(end - begin + 1, len(ids))
            count = found.take(self._window(rows, listed, begin, end, walked=walked))
            low, high = (end + 1, high) if self.oldest else (low, begin - 1)
            width *= 2 if count > self.limit // 4 else 8
        return found

    def _window(self, rows: Rows, listed: str, begin: int, end: int, *, walked: bool) -> list[Row]:
        """Return (object_id, place, start, id, sightings) of each stay that starts within."""
        index = "sighting_start" if walked else "sighting_object_start"
        edge = "min" if self.oldest else "max"
        columns = f"q.object_id, q.place, {edge}(q.start_ms), q.id, count(*)"  # id is of the edge
        select = Select(columns, f"sighting q INDEXED BY {index}", "")
        select.where(among(f"{'+' if walked else ''}q.object_id", "ids"), ids=listed)
        select.where("q.start_ms BETWEEN :low AND :high", low=begin, high=end)
        if self.start_ms is not None and begin < self.start_ms:
            select.where("q.end_ms >= :start_ms", start_ms=self.start_ms)
        return rows(f"{select.text()} GROUP BY q.object_id, q.place", select.parameters)

    def _several_of_each(self, rows: Rows, stays: Sequence[StayKey]) -> list[Row]:
        inner = Select("q.id", "sighting q", "q.start_ms" + ("" if self.oldest else " DESC"))
        inner.where("q.stay_id = p.stay_id")
        touching(inner, "q", "max_sighting_ms", self.start_ms, self.end_ms)
        source = (
            "json_each(:stays) j CROSS JOIN stc p ON p.object_id = json_extract(j.value, '$[0]') "
            "AND p.place = json_extract(j.value, '$[1]') "
            f"CROSS JOIN sighting s ON s.id IN ({inner.text()} LIMIT :each)"
        )
        select = Select(_COLUMNS, source, _ORDER)
        each = max(1, self.limit // len(stays))
        given = {**inner.parameters, "stays": as_list(stays), "each": each}
        return rows(select.text(), given)


class StayRows:
    """Where the stays of the sightings lie that were read last: they are found without their index.

    In a large store nothing of it is in memory: what is asked of a hundred stays would read a
    hundred pages of the index and then a hundred of the table.
    """

    def __init__(self) -> None:
        self._row_ids: dict[StayKey, int] = {}

    def kept(self, found: list[Row]) -> list[Row]:
        """Return what `Newest` read, and keep the row ids of its stays."""
        self._row_ids = {(row[0], row[1]): row[-1] for row in found}
        return found

    def read(self, rows: Rows, keys: Sequence[StayKey]) -> list[Row]:
        """Return what `Store.stays_at` does. rows: runs a query."""
        wanted = sorted(set(keys))
        row_ids = self._row_ids
        if all(key in row_ids for key in wanted):
            select = stays_of_rows([row_ids[key] for key in wanted])
            found = rows(select.text(), select.parameters)
            if [row[:2] for row in found] == wanted:  # another's by now, where it was written anew
                return found
        select = stays_at(wanted)
        return rows(select.text(), select.parameters)
