"""The finds of every question to MongoDB: pure functions, names only ever as values of `$in`.

The region is `$geoWithin $box` grown by a centimetre, for the index, and exact ranges on the
coordinates, because servers differ on the box's edge. Intervals are trimmed by `$filter`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from d3a.store.base import Area, Sighting
from d3a.store.limits import MAX_INTERVAL_MS, MAX_XY_M
from d3a.store.mongo_documents import Document, date
from d3a.store.mongo_write import in_parts

GROWN_M = 0.01


@dataclass(frozen=True, slots=True)
class Find:
    """A find: its filter and its projection."""

    filter: Document
    projection: Document | None


def _among(ids: Sequence[str]) -> Iterator[Any]:
    """Yield conditions on the ids: none twice, only as text, so many as go into one find."""
    for part in in_parts(sorted({str(name) for name in ids})):
        yield part[0] if len(part) == 1 else {"$in": part}


def objects(
    ids: Sequence[str] | None,
    categories: Sequence[str] | None,
    names: Sequence[str] | None,
    *,
    votes: bool = False,
    embeddings: bool = True,
) -> Iterator[Find]:
    """Yield the finds of `Store.objects`."""
    shown: Document | None = None if embeddings else {"emb": 0}
    asked: Document = {}
    if names is not None:
        asked["names"] = {"$in": [str(name) for name in names]}
    ways: list[Document] = [asked]
    if categories is not None:
        called = {"$in": [str(category) for category in categories]}
        fields = ("category", "votes") if votes else ("category",)
        ways = [{field: called, **asked} for field in fields]  # each by its own index
    for way in ways:
        if ids is None:
            yield Find(way, shown)
        else:
            yield from (Find({**way, "_id": part}, shown) for part in _among(ids))


def touching(start_ms: int | None, end_ms: int | None, longest_ms: int | None = None) -> Document:
    """Return the filter of closed intervals `start`, `end` that touch [start, end].

    longest_ms: no interval is longer, so that the start has a lower bound as well.
    """
    asked: Document = {}
    if end_ms is not None:
        asked["start"] = {"$lte": date(end_ms)}
    if start_ms is not None:
        asked["end"] = {"$gte": date(start_ms)}
        if longest_ms is not None:
            asked.setdefault("start", {})["$gte"] = date(start_ms - longest_ms)
    return asked


def _spanning(start_ms: int | None, end_ms: int | None) -> Document:
    """Return the filter of documents of `stc` that may hold something in [start, end]."""
    asked: Document = {}
    if end_ms is not None:
        asked["first"] = {"$lte": date(end_ms)}
    if start_ms is not None:
        asked["last"] = {"$gte": date(start_ms)}
    return asked


def _inside(area: Area) -> Document:
    box = [
        [_bounded(area.x_min - GROWN_M), _bounded(area.y_min - GROWN_M)],
        [_bounded(area.x_max + GROWN_M), _bounded(area.y_max + GROWN_M)],
    ]
    return {
        "loc": {"$geoWithin": {"$box": box}},
        "loc.0": {"$gte": float(area.x_min), "$lte": float(area.x_max)},
        "loc.1": {"$gte": float(area.y_min), "$lte": float(area.y_max)},
    }


def _bounded(metres: float) -> float:
    return max(-MAX_XY_M, min(MAX_XY_M, float(metres)))


def _of_stays(
    object_ids: Sequence[str] | None, area: Area | None, asked: Document
) -> Iterator[Document]:
    """Yield the filters of `stc` by ids and area; none where the area is empty."""
    if area is not None:
        if not (area.x_min <= area.x_max and area.y_min <= area.y_max):
            return
        asked = {**asked, **_inside(area)}
    if object_ids is None:
        yield asked
    else:
        for part in _among(object_ids):
            yield {"object_id": part, **asked}


def stays(
    object_ids: Sequence[str] | None, area: Area | None, start_ms: int | None, end_ms: int | None
) -> Iterator[Find]:
    """Yield the finds of `Store.stays`."""
    asked = {"seq": 0, **_spanning(start_ms, end_ms)}
    if end_ms is not None:
        asked["stay.first"] = {"$lte": date(end_ms)}
    if start_ms is not None:
        asked["stay.last"] = {"$gte": date(start_ms)}
    for one in _of_stays(object_ids, area, asked):
        yield Find(one, {"intervals": 0})


def sightings(
    object_ids: Sequence[str] | None, area: Area | None, start_ms: int | None, end_ms: int | None
) -> Iterator[Find]:
    """Yield the finds of `Store.sightings`."""
    for one in _of_stays(object_ids, area, _spanning(start_ms, end_ms)):
        yield intervals(one, start_ms, end_ms)


def intervals(asked: Document, start_ms: int | None, end_ms: int | None) -> Find:
    """Return the find of documents of `stc` with only the intervals that touch [start, end]."""
    conditions: list[Document] = []
    if end_ms is not None:
        conditions.append({"$lte": ["$$this.start", date(end_ms)]})
    if start_ms is not None:
        conditions.append({"$gte": ["$$this.end", date(start_ms)]})
    shown: Any = 1
    if conditions:
        shown = {"$filter": {"input": "$intervals", "cond": {"$and": conditions}}}
    return Find(asked, {"object_id": 1, "place": 1, "intervals": shown})


def spans(object_ids: Sequence[str], start_ms: int | None, end_ms: int | None) -> Iterator[Find]:
    """Yield the finds of the spans of an object's documents, without what is in them."""
    for one in _of_stays(object_ids, None, {"n": {"$gt": 0}, **_spanning(start_ms, end_ms)}):
        yield Find(one, {"object_id": 1, "first": 1, "last": 1})


class EdgeSearch:
    """Finds each object's first or last sighting from as few documents as will do.

    spans: `_id`, object_id, first and last of the documents; a span covers what is in it, and
    may be wider, so that a document is only known by reading it.
    """

    def __init__(self, spans: Sequence[Document], *, last: bool) -> None:
        self._last = last
        self._best: dict[str, Sighting] = {}
        self._open: dict[str, list[Document]] = {}
        for span in sorted(spans, key=lambda d: -int(d["last"]) if last else int(d["first"])):
            self._open.setdefault(span["object_id"], []).append(span)

    def wanted(self) -> list[str]:
        """Return the documents to read next, one of each object that is not settled."""
        wanted = []
        for object_id, left in self._open.items():
            if left and self._may_be_better(left[0], self._best.get(object_id)):
                wanted.append(left.pop(0)["_id"])
            else:
                left.clear()
        return wanted

    def _may_be_better(self, span: Document, best: Sighting | None) -> bool:
        if best is None:
            return True
        if self._last:
            return int(span["last"]) >= best.end_ms
        return int(span["first"]) <= best.start_ms

    def seen(self, sightings: Sequence[Sighting]) -> None:
        """Take the sightings of a document that was read."""
        for sighting in sightings:
            best = self._best.get(sighting.object_id)
            if best is None or self._better(sighting, best):
                self._best[sighting.object_id] = sighting

    def _better(self, one: Sighting, other: Sighting) -> bool:
        if self._last:
            mine, best = (one.end_ms, one.start_ms), (other.end_ms, other.start_ms)
            return (*mine, one.place) > (*best, other.place)
        mine, best = (one.start_ms, one.end_ms), (other.start_ms, other.end_ms)
        return (*mine, one.place) < (*best, other.place)

    def found(self) -> list[Sighting]:
        """Return the edges, by object_id."""
        return [sighting for _, sighting in sorted(self._best.items())]


def encounters(
    object_ids: Sequence[str] | None,
    with_ids: Sequence[str] | None,
    start_ms: int | None,
    end_ms: int | None,
) -> Iterator[Find]:
    """Yield finds of encounters with one of the smaller list; see `Encounter.is_between`."""
    asked = touching(start_ms, end_ms, MAX_INTERVAL_MS)
    few = min((object_ids, with_ids), key=lambda ids: (ids is None, 0 if ids is None else len(ids)))
    if few is None:
        yield Find(asked, None)
        return
    for part in _among(few):
        for end in ("a", "b"):
            yield Find({end: part, **asked}, None)


def index_of(plan: Document) -> str | None:
    """Return the indexes that a winning plan names, None for a scan of the collection."""
    found: list[str] = []
    left: list[Any] = [plan]
    while left:
        stage = left.pop(0)
        if isinstance(stage, dict):
            if "indexName" in stage:
                found.append(stage["indexName"])
            elif stage.get("stage") in {"IDHACK", "EXPRESS_IXSCAN", "CLUSTERED_IXSCAN"}:
                found.append("_id_")
            left += stage.values()
        elif isinstance(stage, list):
            left += stage
    return ", ".join(dict.fromkeys(found)) or None
