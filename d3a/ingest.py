"""Fill a store from a recording: the reader's frames, prepared, through the associator."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from d3a.assignments import AssignmentLog
from d3a.associator import Associator, check_filled_alike
from d3a.detectors.base import Detector
from d3a.detectors.recorded import RecordedDetector
from d3a.images import HISTOGRAM_MODEL
from d3a.model import BadInput, Frame
from d3a.parameters import Parameters
from d3a.preparation import Preparation, Stopwatch
from d3a.readers.base import Reader, RecordingFacts, Skipped
from d3a.retention import retain
from d3a.store.base import Store

Progress = Callable[[int, int | None], None]
"""Called with the frames done and their number, None where that is unknown."""
DUPLICATE = "duplicate frame"
BACKWARDS = "time runs backwards or stands still"


@dataclass(frozen=True, slots=True)
class IngestSummary:
    """What an ingest did.

    frames, detections: taken in by this run. objects, places: in the store now. seconds: by stage
    (decode, embed, tiers, store). already: the store had all of it. already_frames: how many
    frames it had before. forgotten: intervals that the store's retention took afterwards.
    """

    frames: int
    detections: int
    objects: int
    places: int
    skipped: Skipped
    seconds: dict[str, float] = field(default_factory=dict)
    already: bool = False
    already_frames: int = 0
    forgotten: int = 0


def ingest(
    reader: Reader,
    store: Store,
    parameters: Parameters,
    *,
    detector: Detector | None = None,
    on_progress: Progress | None = None,
    max_frames: int | None = None,
    assignments: Path | None = None,
) -> IngestSummary:
    """Put a recording into the store; run again, it goes on where it was or changes nothing.

    detector: None takes the recorded boxes. max_frames: stop after so many new frames, with the
    recording left open. assignments: a file to tell what became of each detection, a JSON object a
    line. Raises BadInput for a recording without frames or detections, StoreError where the store
    fails or was filled with other parameters.
    """
    run = _Run(reader, store, parameters, detector or RecordedDetector(reader.facts.classes))
    return run.go(on_progress, max_frames, assignments)


class _Run:
    """One ingest of one recording."""

    def __init__(
        self, reader: Reader, store: Store, parameters: Parameters, detector: Detector
    ) -> None:
        self._reader = reader
        self._store = store
        self._parameters = parameters
        self._stopwatch = Stopwatch()
        facts = reader.facts
        self._model = facts.embedding_model or HISTOGRAM_MODEL
        advised = facts.min_probability
        least = parameters.min_probability
        self._preparation = Preparation(
            detector,
            parameters,
            recording=facts.name,
            min_probability=advised if least is None else least,
            computes_embeddings=self._model == HISTOGRAM_MODEL,
            stopwatch=self._stopwatch,
        )
        self._frames = 0
        self._detections = 0
        self._total = facts.frames
        self._names: set[str] = set()
        self._forgotten = 0

    def go(
        self, on_progress: Progress | None, max_frames: int | None, assignments: Path | None
    ) -> IngestSummary:
        check_filled_alike(self._store, self._parameters, self._model)
        frames = iter(self._reader)
        first = next(frames, None)
        if first is None:
            raise BadInput(f"the recording {self._reader.facts.name!r} has no frame to read")
        associator = self._associator(self._reader.facts, first)
        had = associator.record
        log = AssignmentLog.open(assignments, associator.consumed, had.frames > 0)
        stopped = False
        for frame in self._fresh(chain([first], frames), associator):
            self._take(frame, associator, log)
            if on_progress is not None:
                on_progress(associator.consumed, self._total)
            stopped = max_frames is not None and self._frames >= max_frames
            if stopped or associator.consumed % self._parameters.checkpoint_frames == 0:
                self._checkpoint(associator, log)
            if stopped:
                break
        if not stopped and (self._frames > 0 or not had.done):
            if associator.has_news():
                self._checkpoint(associator, log)
            with self._stopwatch.stage("tiers"):
                associator.finish()
            self._checkpoint(associator, log, done=True)
        log.close(done=not stopped)
        if not stopped:
            with self._stopwatch.stage("store"):
                old = retain(self._store)
            self._forgotten = 0 if old is None else old.intervals
        return self._summary(associator, had.frames)

    def _associator(self, facts: RecordingFacts, first: Frame) -> Associator:
        key = f"{facts.name}|{first.name}|{first.time_ms}"
        return Associator(self._store, self._parameters, facts, key, self._model)

    def _fresh(self, frames: Iterator[Frame], associator: Associator) -> Iterator[Frame]:
        """Yield frames that are not in the store, in time order; count those that are amiss.

        A recording that is going on is continued by the number of frames taken so far, one that
        was ended by its last time: then it has grown since.
        """
        consumed, record = associator.consumed, associator.record
        for number, frame in enumerate(frames):
            is_duplicate = frame.name in self._names
            self._names.add(frame.name)
            if number < consumed:
                continue
            associator.consumed = number + 1
            last_ms = associator.record.last_ms
            if record.done and record.last_ms is not None and frame.time_ms <= record.last_ms:
                continue
            if is_duplicate:
                associator.skipped.add(DUPLICATE, frame.name)
            elif last_ms is not None and frame.time_ms <= last_ms:
                associator.skipped.add(BACKWARDS, frame.name)
            else:
                yield frame

    def _take(self, frame: Frame, associator: Associator, log: AssignmentLog) -> None:
        skipped = Skipped()
        prepared = self._preparation.prepare(frame, skipped)
        if associator.has_news():  # what people said is taken in before the tiers read its traces
            associator.consumed -= 1
            self._checkpoint(associator, log)
            associator.consumed += 1
        associator.skipped.join(skipped)
        with self._stopwatch.stage("tiers"):
            associator.add(prepared.scene, frame.image if prepared.has_picture else None)
        log.left_out(frame.name, prepared.left_out)
        log.events(associator.take_events())
        self._frames += 1
        self._detections += len(prepared.scene.detections)

    def _checkpoint(
        self, associator: Associator, log: AssignmentLog, *, done: bool = False
    ) -> None:
        log.events(associator.take_events())
        log.mark(associator.consumed)
        with self._stopwatch.stage("store"):
            associator.checkpoint(self._reader.skipped, done=done)

    def _summary(self, associator: Associator, had_frames: int) -> IngestSummary:
        skipped = Skipped(dict(self._reader.skipped.counts), dict(self._reader.skipped.examples))
        for reason, count in associator.skipped.counts.items():
            skipped.counts[reason] = skipped.counts.get(reason, 0) + count
            examples = skipped.examples.get(reason, []) + associator.skipped.examples.get(
                reason, []
            )
            skipped.examples[reason] = examples[:3]
        counts = self._store.counts()
        return IngestSummary(
            frames=self._frames,
            detections=self._detections,
            objects=int(counts["objects"]),
            places=int(counts["stays"]),
            skipped=skipped,
            seconds=dict(self._stopwatch.seconds),
            already=self._frames == 0,
            already_frames=had_frames,
            forgotten=self._forgotten,
        )
