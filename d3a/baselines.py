"""The methods that the association is measured against; each fills an ordinary store.

Naive: every detection is an object of its own (paper, "Baselines"). Naive+: the same store, with
shared frames kept as encounters, and its answers diversified at query time. Non-spatial: the
paper's tiers without space, as in its Exp 4, which is a parameter of the paper's profile.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from d3a.answer import Answer, RankedKeyframe
from d3a.ingesting.coverage import Coverage
from d3a.model import Detection, Frame, Position
from d3a.parameters import PAPER, Parameters
from d3a.readers.base import Reader, RecordingFacts, Skipped
from d3a.store.base import (
    Batch,
    Encounter,
    ObjectRecord,
    RecordingRecord,
    Sighting,
    StayKey,
    StayRecord,
    Store,
    View,
)

NON_SPATIAL = PAPER.with_changes(d_thresh_m=1e4)
"""The paper's tiers where everything is near everything: 10 km is beyond any home."""
CELL_M = 1.0
_FLUSH_FRAMES = 500


@dataclass(frozen=True, slots=True)
class NaiveRun:
    """What a naive ingest did: where each row went (by row), frames and detections."""

    assignments: dict[int, StayKey]
    frames: int
    detections: int


def fill_naive(
    reader: Reader, store: Store, *, together: bool = False, parameters: Parameters = PAPER
) -> NaiveRun:
    """Insert every detection as its own object, stay and sighting (paper: "Naive").

    together: also keep, for Naive+, which detections shared a frame; the paper's Naive has no
    such record and answers Q2 by the union of what it found for each object. parameters: written
    to the store's meta, where questions find them. Raises StoreError.
    """
    facts = reader.facts
    coverage = Coverage(parameters, facts.site, facts.name)
    batch, assignments = _Batch(store), dict[int, StayKey]()
    times: list[int] = []
    last_name: str | None = None
    detections = 0
    for frame in reader:
        found = [
            _insert(frame, detection, facts, detections + k)
            for k, detection in enumerate(frame.detections or ())
        ]
        batch.add(found, _encounters(frame, found, facts.name) if together else ())
        batch.cover(coverage.add(frame.time_ms, frame.pose, frame.camera))
        assignments |= {one.row: one.stay.key for one in found if one.row is not None}
        detections += len(found)
        times.append(frame.time_ms)
        last_name = frame.name
        if len(times) % _FLUSH_FRAMES == 0:
            batch.flush()
    batch.cover(coverage.open)
    batch.flush()
    record = _record(facts, times, detections, last_name, reader.skipped)
    meta = {"zone": facts.zone, "parameters": parameters.to_json()}
    store.apply(Batch(recordings=[record], meta=meta))
    return NaiveRun(assignments, len(times), detections)


def _record(
    facts: RecordingFacts, times: Sequence[int], detections: int, last: str | None, skipped: Skipped
) -> RecordingRecord:
    return RecordingRecord(
        key=facts.name,
        name=facts.name,
        site=facts.site,
        zone=facts.zone,
        frames=len(times),
        detections=detections,
        first_ms=min(times, default=None),
        last_ms=max(times, default=None),
        last_frame=last,
        done=True,
        skipped=tuple(sorted(skipped.counts.items())),
    )


@dataclass(frozen=True, slots=True)
class _Insert:
    """The three records of one detection, and its row in the recording's file."""

    record: ObjectRecord
    stay: StayRecord
    sighting: Sighting
    row: int | None


def _insert(frame: Frame, detection: Detection, facts: RecordingFacts, number: int) -> _Insert:
    name, time = f"{facts.name}:{number:06d}", frame.time_ms
    category, weight = detection.category, detection.probability
    pose = frame.pose
    record = ObjectRecord(
        object_id=name,
        category=category,
        weight=weight,
        first_ms=time,
        last_ms=time,
        site=facts.site,
        categories=((category, weight),),
        embedding=detection.embedding,
        embedding_model=facts.embedding_model,
    )
    covariance = detection.covariance
    stay = StayRecord(
        name, 0, detection.position, time, time, weight, facts.site, covariance=covariance
    )
    sighting = Sighting(
        object_id=name,
        place=0,
        start_ms=time,
        end_ms=time,
        frame=frame.name,
        probability=detection.probability,
        box=detection.box,
        category=category,
        recording=facts.name,
        keyframe_ms=time,
        viewer=(*pose.position, *pose.quaternion) if pose else None,
    )
    return _Insert(record, stay, sighting, detection.row)


class _Batch:
    """Collects records until they are written together."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._clear()

    def _clear(self) -> None:
        self._inserts: list[_Insert] = []
        self._encounters: list[Encounter] = []
        self._views: list[View] = []

    def add(self, inserts: Sequence[_Insert], encounters: Iterable[Encounter]) -> None:
        self._inserts += inserts
        self._encounters += encounters

    def cover(self, view: View | None) -> None:
        if view is not None:
            self._views.append(view)

    def flush(self) -> None:
        self._store.apply(
            Batch(
                objects=[one.record for one in self._inserts],
                stays=[one.stay for one in self._inserts],
                sightings=[one.sighting for one in self._inserts],
                encounters=self._encounters,
                views=self._views,
            )
        )
        self._clear()


def _encounters(frame: Frame, inserts: Sequence[_Insert], recording: str) -> Iterable[Encounter]:
    for a, b in combinations(sorted(inserts, key=lambda one: one.record.object_id), 2):
        yield Encounter(
            object_a=a.record.object_id,
            object_b=b.record.object_id,
            place_a=0,
            place_b=0,
            start_ms=frame.time_ms,
            end_ms=frame.time_ms,
            frame=frame.name,
            box_a=a.sighting.box,
            box_b=b.sighting.box,
            probability=min(a.sighting.probability, b.sighting.probability),
            recording=recording,
            viewer=a.sighting.viewer,
        )


Cell = tuple[str, int, int]
Moment = tuple[RankedKeyframe, ...]


def diversify(answer: Answer) -> Answer:
    """Return the answer with its keyframes spread over kinds and places (Naive+).

    Single keyframes: the best of every (category, 1 m cell) first, then every second best, and so
    on. Moments of several objects: frames first that show the most pairs of cells not yet shown,
    each frame once, then the rest in their order. Scores are kept, ranks follow the new order.
    """
    moments = moments_of(answer)
    if any(len(moment) > 1 for moment in moments):
        ordered = _cover(moments)
    else:
        ordered = _round_robin(moments)
    keyframes = [keyframe for moment in ordered for keyframe in moment]
    ranked = tuple(replace(keyframe, rank=k) for k, keyframe in enumerate(keyframes, 1))
    return replace(answer, keyframes=ranked)


def moments_of(answer: Answer) -> list[Moment]:
    """Return the keyframes by the moment they belong to, in their order: one by one, or a group."""
    moments: list[list[RankedKeyframe]] = []
    for keyframe in answer.keyframes:
        last = moments[-1][-1].group if moments else None
        if keyframe.group is not None and keyframe.group == last:
            moments[-1].append(keyframe)
        else:
            moments.append([keyframe])
    return [tuple(moment) for moment in moments]


def _cell(keyframe: RankedKeyframe) -> Cell:
    x, y = _ground(keyframe.position)
    return keyframe.category, x, y


def _ground(position: Position | None) -> tuple[int, int]:
    if position is None:
        return 0, 0
    return math.floor(position[0] / CELL_M), math.floor(position[1] / CELL_M)


def _round_robin(moments: Sequence[Moment]) -> list[Moment]:
    """Take the best of every cell, then the second best, ...; cells in the order of their best."""
    turn: dict[Cell, int] = {}
    order = []
    for number, moment in enumerate(moments):
        cell = _cell(moment[0])
        turn[cell] = turn.get(cell, -1) + 1
        order.append((turn[cell], number))
    return [moments[number] for _, number in sorted(order)]


def _cover(moments: Sequence[Moment]) -> list[Moment]:
    """Cover pairs of cells greedily by whole frames, ties by the order of the answer."""
    frames: dict[str, list[int]] = {}
    for number, moment in enumerate(moments):
        frames.setdefault(moment[0].frame, []).append(number)
    pairs = {
        frame: {frozenset(map(_cell, moments[n])) for n in numbers}
        for frame, numbers in frames.items()
    }
    shown: set[frozenset[Cell]] = set()
    chosen = []
    # What a frame adds only shrinks: one whose worth still holds at its turn is the best of all.
    waiting = [(-len(new), number, frame) for number, (frame, new) in enumerate(pairs.items())]
    heapq.heapify(waiting)
    while waiting:
        worth, number, frame = heapq.heappop(waiting)
        adds = len(pairs[frame] - shown)
        if adds and -adds == worth:
            shown |= pairs[frame]
            chosen.append(frames[frame][0])
        elif adds:
            heapq.heappush(waiting, (-adds, number, frame))
    rest = sorted(set(range(len(moments))) - set(chosen))
    return [moments[number] for number in [*chosen, *rest]]
