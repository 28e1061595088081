"""Fill a store from a recording: the reader's frames, prepared, through the associator."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from time import perf_counter

from d3a.associator import Associator, check_filled_alike
from d3a.correcting.reconcile import corrected_stays
from d3a.correcting.retention import retain
from d3a.correcting.taught_looks import search_later
from d3a.detectors.base import Detector
from d3a.detectors.recorded import RecordedDetector
from d3a.embedders.base import Embedder, HistogramEmbedder
from d3a.images import HISTOGRAM_MODEL
from d3a.ingesting.assignments import AssignmentLog, check_place
from d3a.ingesting.batches import Ready, one_by_one
from d3a.ingesting.intake import EVERYTHING, Intake, agree, check_known, placed
from d3a.ingesting.jobs import ONE, Jobs, in_jobs
from d3a.ingesting.lacking import Lacking
from d3a.ingesting.live import WHOLE, Live, Pulse
from d3a.ingesting.preparation import LeftOut, Preparation, Replaces, Stopwatch
from d3a.ingesting.sieve import Sieve, Sifted
from d3a.model import BadInput, Frame
from d3a.parameters import Parameters
from d3a.readers.base import Follower, Reader, RecordingFacts, Skipped
from d3a.store.base import Region, Store
from d3a.store.lease import Lease, leased

Progress = Callable[[int, int | None], None]
"""Called with the frames done and their number, None where that is unknown."""
Note = Callable[[str], None]
"""Told, in a sentence, what a person may have overlooked."""
PICTURES_A_CHECKPOINT = 16
"""So many are searched for taught things when a growing recording is written; the rest later."""
NOTED_FRAMES = 50
"""After so many frames a person is told what they all lack, and needs not wait for the end."""


class NothingYet(BadInput):
    """The recording has no frame, or none yet."""


@dataclass(frozen=True, slots=True)
class IngestSummary:
    """What an ingest did.

    frames, detections: taken in by this run. objects, places: in the store now. seconds: by stage
    (read, which is waiting too where a recording grows, decode, detect, embed, tiers, store), of
    all processes together. processor: the same of this
    process's processor time, which other work on the machine does not lengthen. elapsed_s: from
    begin to end, with the reading of the recording. already: the store had all of it.
    already_frames: how many frames it had before. forgotten: intervals that the store's retention
    took afterwards.
    """

    frames: int
    detections: int
    objects: int
    places: int
    skipped: Skipped
    seconds: dict[str, float] = field(default_factory=dict)
    processor: dict[str, float] = field(default_factory=dict)
    elapsed_s: float = 0.0
    already: bool = False
    already_frames: int = 0
    forgotten: int = 0


def ingest(
    reader: Reader | Follower,
    store: Store,
    parameters: Parameters,
    *,
    detector: Detector | None = None,
    embedder: Embedder | None = None,
    on_progress: Progress | None = None,
    on_note: Note | None = None,
    max_frames: int | None = None,
    assignments: Path | None = None,
    intake: Intake = EVERYTHING,
    live: Live = WHOLE,
    jobs: Jobs = ONE,
) -> IngestSummary:
    """Put a recording into the store; run again, it goes on where it was or changes nothing.

    detector: its boxes replace the recorded ones; None takes those. embedder: likewise for
    embeddings; None takes those, and the colour histogram where there are none. max_frames: stop
    after so many new frames, with the recording left open. assignments: a file to tell what became
    of each detection, a JSON object a line. intake: what of it goes in; a recording that was taken
    in otherwise before is refused.
    live: for a reader that follows a recording as it grows. jobs: where scenes are made; the store
    is the same. on_note: told what no frame has: poses, looks.
    Raises BadInput for a recording without frames or detections, StoreError where the store fails
    or was filled with other parameters, StoreBusy where another ingest fills it.
    """
    if assignments is not None:
        check_place(assignments)
    run = _Run(reader, store, parameters, detector, embedder, intake, live, jobs, on_note)
    with leased(store, f"an ingest of {reader.facts.name!r}") as lease:
        return run.go(lease, on_progress, max_frames, assignments)


class _Run:
    """One ingest of one recording."""

    def __init__(
        self,
        reader: Reader | Follower,
        store: Store,
        parameters: Parameters,
        detector: Detector | None,
        embedder: Embedder | None,
        intake: Intake,
        live: Live,
        jobs: Jobs,
        on_note: Note | None,
    ) -> None:
        self._live = live
        self._on_note = on_note
        self._lacking = Lacking()
        self._jobs = jobs
        self._left_out: Skipped | None = None  # by the reader, up to the frame that is taken
        self._reader = reader
        self._store = store
        self._parameters = parameters
        self._stopwatch = Stopwatch()
        self._began = perf_counter()
        facts = reader.facts
        self._has_detector = detector is not None
        self._detector = detector or RecordedDetector(facts.classes)
        self._intake = placed(intake, _regions(facts, store))
        check_known(self._intake, self._detector.classes)
        recorded = None if self._has_detector else facts.embedding_model
        if embedder is None and recorded in (None, HISTOGRAM_MODEL):
            embedder = HistogramEmbedder()
        self._embedder = embedder
        self._model = embedder.name if embedder is not None else str(recorded)
        self._replaces = Replaces(
            boxes=self._has_detector, embeddings=recorded not in (None, self._model)
        )
        self._frames = 0
        self._detections = 0
        self._total = facts.frames
        self._forgotten = 0

    def go(
        self,
        lease: Lease,
        on_progress: Progress | None,
        max_frames: int | None,
        assignments: Path | None,
    ) -> IngestSummary:
        self._fence = lease.fence
        frames, associator = self._begin()
        had = associator.record
        log = AssignmentLog.open(assignments, associator.consumed, had)
        with closing(log):
            with closing(self._readied(self._sifted(frames, associator))) as readied:
                stopped = self._take_all(readied, associator, log, on_progress, max_frames)
            self._left_out = None
            self._note_lacking()
            if not stopped and (self._frames > 0 or not had.done):
                if associator.has_news():
                    self._checkpoint(associator, log)
                with self._stopwatch.stage("tiers"):
                    associator.finish()
                self._checkpoint(associator, log, done=True)
            became = {} if assignments is None else corrected_stays(self._store)
            log.finish(became, done=not stopped)
        if not stopped:
            self._search_for_taught(associator)
            with self._stopwatch.stage("store"):
                old = retain(self._store)
            self._forgotten = 0 if old is None else old.intervals
        return self._summary(associator, had.frames)

    def _begin(self) -> tuple[Iterator[Frame | None], Associator]:
        """Return the recording's frames, and the associator where the store has them up to now."""
        check_filled_alike(self._store, self._parameters, self._model)
        frames: Iterator[Frame | None] = iter(self._reader)
        facts = self._reader.facts
        with self._stopwatch.stage("read"):
            first = next((frame for frame in frames if frame is not None), None)
        if first is None:
            why = "".join(f"; {told}" for told in self._reader.skipped.told())
            raise NothingYet(f"the recording {facts.name!r} has no frame to read{why}")
        self._check_seen(first)
        key = f"{facts.name}|{first.name}|{first.time_ms}"
        agree(self._intake, self._store, key, self._detector.identity)
        facts = replace(
            facts,
            name=_name_of_its_own(facts.name, key, self._store),
            # What is not stored is not known, rather than never seen.
            classes=tuple(n for n in self._detector.classes if not self._intake.ignores(n)),
        )
        self._preparation = self._prepared_for(facts)
        associator = Associator(self._store, self._parameters, facts, key, self._model, self._fence)
        return chain([first], frames), associator

    def _take_all(
        self,
        readied: Iterable[Ready | None],
        associator: Associator,
        log: AssignmentLog,
        on_progress: Progress | None,
        max_frames: int | None,
    ) -> bool:
        """Take the frames in, with checkpoints; return whether it was stopped before the end.

        Frames that are not taken count too: checkpoints are by the recording's own numbers.
        """
        each, marked = self._parameters.checkpoint_frames, associator.consumed
        pulse, written = Pulse(self._live), 0
        for ready in readied:
            if ready is not None:
                self._take(ready, associator, log)
                if ready.prepared is None:
                    continue
                if on_progress is not None:
                    on_progress(associator.consumed, self._total)
            stopped = max_frames is not None and self._frames >= max_frames
            stopped = stopped or self._live.should_stop()
            is_due = stopped or pulse.is_due() or associator.consumed // each > marked // each
            if is_due and self._frames > written:
                with pulse.beat():
                    self._checkpoint(associator, log)
                    if self._live.fresh_s is not None:
                        self._search_for_taught(associator, at_most=PICTURES_A_CHECKPOINT)
                marked, written = associator.consumed, self._frames
            if stopped:
                return True
        stopped = self._live.should_stop()
        if stopped and self._frames > written:
            self._checkpoint(associator, log)
        return stopped

    def _search_for_taught(self, associator: Associator, at_most: int | None = None) -> None:
        """Search new pictures for what people taught by a box; those that will not change now."""
        record = associator.record
        if record.last_ms is not None:
            longest_s = max(self._parameters.interval_gap_s, self._parameters.unbroken_gap_s)
            open_ms = 0 if at_most is None else round(longest_s * 1000)
            with self._stopwatch.stage("detect"):
                until_ms = record.last_ms - open_ms
                search_later(self._store, record.name, until_ms, self._fence, at_most)

    def _readied(self, sifted: Iterator[Sifted | None]) -> Generator[Ready | None]:
        if self._jobs.is_here:
            return one_by_one(sifted, self._preparation)
        return in_jobs(
            sifted, self._preparation, self._stopwatch, lambda: self._reader.skipped, self._jobs
        )

    def _sifted(
        self, frames: Iterator[Frame | None], associator: Associator
    ) -> Iterator[Sifted | None]:
        record = associator.record
        sieve = Sieve(
            self._intake,
            consumed=associator.consumed,
            last_ms=record.last_ms,
            was_done=record.done,
        )
        yield from sieve.sift(self._read(frames))
        if not self._live.should_stop():  # else the rest is judged when it goes on
            yield from sieve.rest()

    def _read(self, frames: Iterator[Frame | None]) -> Iterator[Frame | None]:
        """Yield the frames; the time until each comes counts as reading."""
        while True:
            with self._stopwatch.stage("read"):
                following = list(islice(frames, 1))
            if not following:
                return
            yield following[0]

    def _note_lacking(self) -> None:
        for sentence in self._lacking.say():
            if self._on_note is not None:
                self._on_note(sentence)

    def _check_seen(self, first: Frame) -> None:
        """Refuse a recording in which nothing was looked for, before anything is stored."""
        if first.detections is None and not self._has_detector:
            raise BadInput(
                f"the recording {self._reader.facts.name!r} has pictures and no boxes: it needs a "
                "detector (--detector model.onnx), or the boxes of one in a file beside "
                "(detections.jsonl)"
            )

    def _prepared_for(self, facts: RecordingFacts) -> Preparation:
        # What the recording says of weak boxes is of those that came with it.
        usual = 0.0 if self._has_detector else facts.min_probability
        least = self._parameters.min_probability
        return Preparation(
            self._detector,
            self._parameters,
            recording=facts.name,
            min_probability=usual if least is None else least,
            embedder=self._embedder,
            replaces=self._replaces,
            stopwatch=self._stopwatch,
            intake=self._intake,
        )

    def _take(self, ready: Ready, associator: Associator, log: AssignmentLog) -> None:
        prepared, sifted = ready.prepared, ready.sifted
        # what people said is taken in before the tiers read its traces
        if prepared is not None and associator.has_news():
            self._checkpoint(associator, log)
        associator.consumed = sifted.number + 1
        self._left_out = ready.reader_skipped
        if sifted.why is not None:
            associator.skipped.add(sifted.why, sifted.frame.name)
            log.left_out(sifted.frame.name, self._left_out_whole(sifted.frame, sifted.why))
        if prepared is None:
            return
        associator.skipped.join(ready.skipped)
        with self._stopwatch.stage("tiers"):
            associator.add(prepared.scene, prepared.picture)
        log.left_out(sifted.frame.name, prepared.left_out)
        log.events(associator.take_events())
        scene = prepared.scene
        self._lacking.add(posed=scene.pose is not None, detections=scene.detections)
        self._frames += 1
        self._detections += len(scene.detections)
        if self._frames == NOTED_FRAMES:
            self._note_lacking()

    def _left_out_whole(self, frame: Frame, why: str) -> list[LeftOut]:
        """Return the recorded detections of a frame that is not taken in, if they are what counts.

        Those without a row could not be told from the same ones when an ingest is run again.
        """
        recorded = () if self._has_detector else frame.detections or ()
        return [LeftOut(each, why) for each in recorded if each.row is not None]

    def _checkpoint(
        self, associator: Associator, log: AssignmentLog, *, done: bool = False
    ) -> None:
        log.events(associator.take_events())
        if done:
            log.end(associator.record.frames)
        else:
            log.mark(associator.consumed)
        with self._stopwatch.stage("store"):
            associator.checkpoint(self._left_out or self._reader.skipped, done=done)

    def _summary(self, associator: Associator, had_frames: int) -> IngestSummary:
        skipped = Skipped()
        skipped.join(self._reader.skipped)
        skipped.join(associator.skipped)
        counts = self._store.counts()
        return IngestSummary(
            frames=self._frames,
            detections=self._detections,
            objects=int(counts["objects"]),
            places=int(counts["stays"]),
            skipped=skipped,
            seconds=dict(self._stopwatch.seconds),
            processor=dict(self._stopwatch.processor),
            elapsed_s=perf_counter() - self._began,
            already=self._frames == 0 and had_frames > 0,
            already_frames=had_frames,
            forgotten=self._forgotten,
        )


def _name_of_its_own(name: str, key: str, store: Store) -> str:
    """Return the recording's name, numbered where the store has another recording of that name.

    Pictures are kept by the recording's name and the frame's, and cameras count from 1 each time.
    """
    records = store.recordings()
    for record in records:
        if record.key == key:
            return record.name
    taken, free, number = {record.name for record in records}, name, 1
    while free in taken:
        number += 1
        free = f"{name} ({number})"
    return free


def _regions(facts: RecordingFacts, store: Store) -> list[Region]:
    """Return the regions that a name may mean; of two the store's, which a person may have drawn.

    Regions of another site are no places of this recording.
    """
    own = [Region(name, polygon, facts.site) for name, polygon in facts.regions.polygons]
    return own + [region for region in store.regions() if region.site in ("", facts.site)]
