"""Read what a recording's truth.jsonl says: for judging after the run, never for an ingest."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a.model import BadInput, Json, Position


@dataclass(frozen=True, slots=True)
class TrueRelation:
    """What a stay was on, under or near, and from when to when (UTC milliseconds)."""

    kind: str
    object: str
    start_ms: int
    end_ms: int


@dataclass(frozen=True, slots=True)
class TruePlace:
    """One stay of a true object: centre in metres, closed interval in UTC milliseconds.

    seen_empty_ms: first and last time after its end at which the place was seen without it.
    """

    object: str
    position: Position
    start_ms: int
    end_ms: int
    seen_empty_ms: tuple[int, int] | None = None
    relations: tuple[TrueRelation, ...] = ()


@dataclass(frozen=True, slots=True)
class TrueObject:
    """A true object: places in the order of time, detections as row numbers."""

    name: str
    category: str
    colour: str
    places: tuple[TruePlace, ...]
    detections: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Truth:
    """The objects and every detection of a recording, by row number of detections.jsonl.

    owner (d,): index of the object that a detection shows, -1 for a false positive.
    time_ms (d,), category (d,), probability (d,), box (d, 4), position (d, 3), frame (d,) names.
    """

    objects: tuple[TrueObject, ...]
    owner: NDArray[np.intp]
    time_ms: NDArray[np.int64]
    frame: tuple[str, ...]
    category: tuple[str, ...]
    probability: NDArray[np.float64]
    box: NDArray[np.float64] = field(repr=False)
    position: NDArray[np.float64] = field(repr=False)
    frames: int = 0
    span_ms: tuple[int, int] = (0, 0)

    def seen(self, least: int = 1) -> list[int]:
        """Return the indices of the objects detected at least `least` times."""
        return [k for k, one in enumerate(self.objects) if len(one.detections) >= least]

    def place_of(self, row: int) -> int | None:
        """Return which place of its object a detection shows; None for a false positive."""
        k = int(self.owner[row])
        if k < 0:
            return None
        return place_at(self.objects[k].places, int(self.time_ms[row]))


def place_at(places: tuple[TruePlace, ...], time_ms: int) -> int | None:
    """Return the place whose interval holds a time, None while the object is carried."""
    for number, place in enumerate(places):
        if place.start_ms <= time_ms <= place.end_ms:
            return number
    return None


def milliseconds(text: str) -> int:
    """Return an ISO time with offset as UTC milliseconds."""
    return round(datetime.fromisoformat(text).timestamp() * 1000)


def lines_of(path: Path) -> Iterator[Json]:
    """Yield the records of a JSON lines file; raises BadInput where it cannot be read."""
    try:
        with path.open(encoding="utf-8") as file:
            for line in file:
                if line.strip():
                    yield json.loads(line)
    except (OSError, json.JSONDecodeError) as error:
        raise BadInput(f"{path} cannot be read as JSON lines: {error}") from error


def read_truth(folder: Path) -> Truth:
    """Return the truth of a recording folder; raises BadInput where there is none.

    An ingest leaves out what is broken; a judgement has to know every row, and does not begin.
    """
    path = folder / "truth.jsonl"
    if not path.exists():
        raise BadInput(f"{folder} has no truth.jsonl; `d3a simulate` writes one")
    rows = list(lines_of(folder / "detections.jsonl"))
    with _judged(path, "a truth file"):
        objects = tuple(_object(record) for record in lines_of(path))
        owner = np.full(len(rows), -1, dtype=np.intp)
        for k, one in enumerate(objects):
            for row in one.detections:
                if not 0 <= row < len(rows):
                    raise ValueError(
                        f"{one.name} is of row {row}, and detections.jsonl has {len(rows)} rows"
                    )
            owner[list(one.detections)] = k
    with _judged(folder, "a recording that can be judged, with every line whole"):
        return _truth(objects, owner, list(lines_of(folder / "frames.jsonl")), rows)


@contextmanager
def _judged(path: Path, wanted: str) -> Iterator[None]:
    try:
        yield
    except (LookupError, TypeError, ValueError) as error:
        said = f"a line lacks {error}" if isinstance(error, KeyError) else str(error)
        raise BadInput(f"{path} is not {wanted}: {said}") from error


def _truth(
    objects: tuple[TrueObject, ...], owner: NDArray[np.intp], frames: list[Json], rows: list[Json]
) -> Truth:
    times = {row["frame"]: milliseconds(row["time"]) for row in frames}
    for row in rows:
        if row["frame"] not in times:
            raise ValueError(f"frames.jsonl does not list {row['frame']!r}, which has detections")
    nowhere = (float("nan"),) * 3
    return Truth(
        objects=objects,
        owner=owner,
        time_ms=np.array([times[row["frame"]] for row in rows], dtype=np.int64),
        frame=tuple(row["frame"] for row in rows),
        category=tuple(row["category"] for row in rows),
        probability=np.array([row["probability"] for row in rows]),
        box=np.array([row["box"] for row in rows]).reshape(-1, 4),
        position=np.array([row["position"] or nowhere for row in rows]).reshape(-1, 3),
        frames=len(times),
        span_ms=(min(times.values(), default=0), max(times.values(), default=0)),
    )


def _object(record: Mapping[str, Any]) -> TrueObject:
    return TrueObject(
        name=record["object"],
        category=record["category"],
        colour=record.get("colour") or "",
        places=tuple(_place(record["object"], place) for place in record["places"]),
        detections=tuple(record["detections"]),
    )


def _place(name: str, record: Mapping[str, Any]) -> TruePlace:
    empty = record.get("seen_empty")
    x, y, z = record["position"]
    return TruePlace(
        object=name,
        position=(float(x), float(y), float(z)),
        start_ms=milliseconds(record["start"]),
        end_ms=milliseconds(record["end"]),
        seen_empty_ms=(milliseconds(empty["first"]), milliseconds(empty["last"]))
        if empty
        else None,
        relations=tuple(
            TrueRelation(r["kind"], r["object"], milliseconds(r["start"]), milliseconds(r["end"]))
            for r in record.get("relations", ())
        ),
    )
