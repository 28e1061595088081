"""The associator: scenes go in, batches for the store come out, at checkpoints.

One class for both profiles; they differ in the operators of their tiers (`paper.py`,
`tracker.py`). A checkpoint puts the data, the state that explains it and the recording's progress
in one batch: an ingest that was killed and is run again ends in the same store as one that was
not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

from d3a.answering.match import squash
from d3a.checkpoint import Arrays, pack, unpack
from d3a.constraints import SAID, Constraints, History
from d3a.correcting.reconcile import Corrected, acknowledged, news_of, reconcile, take_in
from d3a.floor_map import MAP, RECORDED_MAP
from d3a.frozen import maker
from d3a.ingesting.coverage import Coverage
from d3a.ingesting.pictures import Pictures
from d3a.ledger import Ledger
from d3a.model import Image, Json
from d3a.paper import NOISE, PaperPipeline
from d3a.parameters import Parameters
from d3a.readers.base import RecordingFacts, Skipped
from d3a.sightings import Became, Event, Scene
from d3a.store.base import (
    FORGOTTEN,
    Batch,
    Expected,
    Keyframe,
    RecordingRecord,
    Region,
    Store,
    StoreError,
    StoreRefused,
    TaughtName,
)
from d3a.tier3 import Stored
from d3a.tracking.tracker import TrackerPipeline


class ForgottenMeanwhile(StoreError):  # noqa: N818
    """Something was forgotten while an ingest ran, which remembers it still.

    `ingest` is to be called again: it goes on from its last checkpoint, without that.
    """


_record = maker(RecordingRecord)
"""Each frame makes one."""


class Pipeline(Protocol):
    """The three tiers of a profile, over a ledger."""

    def observe(self, scene: Scene) -> None:
        """Take a frame through the tiers."""
        ...

    def end_look(self) -> None:
        """Judge what the robot saw from the viewpoint that it has left."""
        ...

    def take_names(self, taught: Mapping[str, tuple[TaughtName, ...]]) -> None:
        """Learn the names of objects, by id: they are all that have any."""
        ...

    def take_constraints(self, constraints: Constraints) -> None:
        """Keep what people said, from here on."""
        ...

    def correct(self, changed: Corrected) -> None:
        """Take in what people changed in the store, when all of the memory is written."""
        ...

    def write(self) -> None:
        """Put what changed since the last call into the ledger."""
        ...

    def flush(self) -> None:
        """End a recording: nothing stays in memory."""
        ...

    def images(self) -> set[str]:
        """Return keys of pictures that later records may refer to."""
        ...

    def take_events(self) -> list[Event]:
        """Return what became of detections and entries since the last call."""
        ...

    def to_state(self) -> tuple[Json, Arrays]:
        """Return everything that `restore` needs."""
        ...

    def restore(self, record: Json, arrays: Arrays) -> None:
        """Go on where `to_state` was called."""
        ...


def check_filled_alike(store: Store, parameters: Parameters, embedding_model: str) -> None:
    """Raise StoreRefused where the store was filled in another way, which cannot be mixed."""
    recorded = store.meta("parameters")
    if recorded is None:
        return
    differing = parameters.differences(recorded)
    if "profile" in differing:
        raise StoreRefused(
            f"{store.uri} was filled with the profile {recorded.get('profile')!r}, not "
            f"{parameters.profile!r}: use that profile, or another store"
        )
    if differing:
        was = ", ".join(f"{name} = {recorded.get(name)}" for name in differing[:5])
        raise StoreRefused(
            f"{store.uri} was filled with other parameters ({was}): use those, or another store"
        )
    model = store.meta("embedding_model")
    if model not in (None, embedding_model):
        raise StoreRefused(
            f"{store.uri} holds embeddings of {model!r}, the recording has {embedding_model!r}: "
            "looks of different kinds cannot be compared; use another store"
        )


class Associator:
    """Feeds scenes to the tiers of the profile and writes checkpoints to the store.

    fence: of the lease that this ingest holds on the store; without it nothing is written.
    """

    def __init__(
        self,
        store: Store,
        parameters: Parameters,
        facts: RecordingFacts,
        key: str,
        embedding_model: str,
        fence: int,
    ) -> None:
        check_filled_alike(store, parameters, embedding_model)
        self._store = store
        self._parameters = parameters
        self._facts = facts
        self._key = key
        self._model = embedding_model
        self._fence = fence
        self._ledger = Ledger(store)
        self._pictures = Pictures(parameters)
        self._coverage = Coverage(parameters, facts.site, facts.name)
        self._categories: set[str] = set(store.meta("categories") or ())
        self._pipeline = self._new_pipeline()
        self._corrections: frozenset[int] = frozenset()
        self.consumed = 0
        """Frames of the recording that were taken from the reader, usable or not."""
        self.skipped = Skipped()
        """What was left out after the reader: it is not counted again when an ingest goes on."""
        self.record = RecordingRecord(
            key, facts.name, facts.site, facts.zone, 0, 0, None, None, None, False
        )
        self._resume()

    def _new_pipeline(self) -> Pipeline:
        stored = Stored(self._facts.site, self._model)
        if self._parameters.profile == "paper":
            return PaperPipeline(self._ledger, stored, self._parameters)
        outside = int(self._store.counts()["objects"])
        return TrackerPipeline(self._ledger, stored, self._parameters, outside)

    def _resume(self) -> None:
        """Go on from the store's checkpoint; another recording's is brought to its end first."""
        known = {record.key: record for record in self._store.recordings()}
        if self._key in known:
            self.record = known[self._key]
        self._said = self._store.meta(SAID)
        self._forgotten = self._store.meta(FORGOTTEN)
        history = take_in(self._store)
        self._pipeline.take_constraints(history.constraints())
        self._corrections = history.moving()
        state = self._store.state()
        if state is None:
            return
        record, arrays = unpack(state)
        self._pipeline.restore(record["pipeline"], arrays)
        self._pipeline.correct(news_of(history, frozenset(record.get("corrections", ()))))
        self._pictures.unreadable.update(record["unreadable"])
        if record["recording"] == self._key:
            self.consumed = record["consumed"]
            self.skipped.counts.update(record["skipped"])
            self.skipped.examples.update(record["examples"])
            self._coverage.restore(record["view"])
        elif record["recording"] is not None:
            self._pipeline.flush()
            self._pipeline.take_events()  # of the other's detections

    def add(self, scene: Scene, image: Image | None) -> None:
        """Take a scene in; image: its picture as it came, for keyframes."""
        ref = scene.ref
        if image is not None and ref.image is not None:
            self._pictures.add(ref.image, image, ref.time_ms)
        ended = self._coverage.add(ref.time_ms, scene.pose, scene.camera)
        if ended is not None:
            self._ledger.put_view(ended)
            self._pipeline.end_look()
        self._pipeline.observe(scene)
        self._categories.update(d.category for d in scene.detections)
        old = self.record
        self.record = _record(
            old.key, old.name, old.site, old.zone, old.frames + 1,
            old.detections + len(scene.detections),
            ref.time_ms if old.first_ms is None else old.first_ms,
            ref.time_ms, ref.name, False, old.skipped,
        )  # fmt: skip

    def has_news(self) -> bool:
        """Say whether people spoke since the last checkpoint: then the next one is due.

        To be asked before each frame, as the tiers read what people have changed. Only what is
        said within the milliseconds that a frame takes in the tiers is heard too late for it.
        """
        return self._store.meta(SAID) != self._said

    def take_events(self) -> list[Event]:
        """Return what became of detections since the last call; count what the paper leaves out."""
        events = self._pipeline.take_events()
        for event in events:
            if isinstance(event, Became) and event.why == NOISE:
                self.skipped.add(NOISE, event.entry.removeprefix("noise "))
        return events

    def finish(self) -> None:
        """End the recording: flush the tiers; `checkpoint(done=True)` is to follow."""
        self._pipeline.flush()

    def checkpoint(self, reader_skipped: Skipped, *, done: bool = False) -> None:
        """Write everything so far to the store, in one batch that becomes visible at once."""
        self._pipeline.take_names(self._ledger.taught())
        self._pipeline.write()
        if self._coverage.open is not None:
            self._ledger.put_view(self._coverage.open)
        if done:
            self._coverage.open = None
        fields = self._ledger.batch_fields()
        wanted = {r.image for r in (*fields["sightings"], *fields["encounters"]) if r.image}
        keyframes = self._pictures.take(wanted | self._pipeline.images(), self.skipped)
        for kind in ("sightings", "encounters"):
            fields[kind] = [self._without_unreadable(record) for record in fields[kind]]
        with self._store.turn():
            history = self._apply(fields, keyframes, reader_skipped, done=done)
        self._ledger.clear()
        if done:
            self._store.collect_keyframes(sorted(history.pictures()))

    def _apply(
        self,
        fields: dict[str, Any],
        keyframes: list[Keyframe],
        reader_skipped: Skipped,
        *,
        done: bool,
    ) -> History:
        """Write what was seen, under what people have said by now; return their history.

        In a turn: people speak before it or after it, however often they do.
        """
        if self._store.meta(FORGOTTEN) != self._forgotten:
            raise ForgottenMeanwhile(
                f"{self._store.uri}: something was forgotten while this ingest ran; it goes on "
                "from its last checkpoint, without that"
            )
        taught = self._ledger.taught()
        fields["objects"] = [
            replace(record, names=taught.get(record.object_id, ())) for record in fields["objects"]
        ]
        history = History.read(self._store)
        made = reconcile(self._store, history, self._corrections, fields, self.skipped)
        self._pipeline.correct(made.changed)
        self._pipeline.take_constraints(made.history.constraints())
        self._corrections = made.history.moving()
        counts = Skipped()
        counts.join(reader_skipped)
        counts.join(self.skipped)
        left_out = tuple(sorted(counts.counts.items()))
        self.record = replace(self.record, done=done, skipped=left_out)
        meta = self._meta() | made.meta
        if history.serial > 0:
            meta |= acknowledged(made.history, done=done)
        self._said = self._store.meta(SAID)
        batch = Batch(
            **made.fields,
            keyframes=keyframes,
            regions=self._regions(made.history.constraints()),
            recordings=[self.record],
            meta=meta,
            state=self._state(done),
            expects=Expected(fence=self._fence),
        )
        self._store.apply(batch)
        return made.history

    def _without_unreadable(self, record: Any) -> Any:
        return replace(record, image=None) if record.image in self._pictures.unreadable else record

    def _regions(self, constraints: Constraints) -> list[Region]:
        known = {region.name for region in self._store.regions()}
        return [
            Region(name, polygon, self._facts.site)
            for name, polygon in self._facts.regions.polygons
            # a person may have drawn it anew, or taken it away
            if name not in known and squash(name) not in constraints.no_places
        ]

    def _meta(self) -> dict[str, Any]:
        meta: dict[str, Any] = {
            "parameters": self._parameters.to_json(),
            "profile": self._parameters.profile,
            "embedding_model": self._model,
            "categories": sorted(self._categories),
        }
        for name, value in (("zone", self._facts.zone), ("now", self._facts.now)):
            if value is not None and self._store.meta(name) is None:
                meta[name] = value
        if self._facts.map is not None and self._store.meta(MAP) is None:
            meta |= {MAP: RECORDED_MAP, RECORDED_MAP: self._facts.map}
        if self._facts.classes:
            known = set(self._store.meta("classes") or ())
            meta["classes"] = sorted(known.union(self._facts.classes))
        return meta

    def _state(self, done: bool) -> bytes:
        pipeline, arrays = self._pipeline.to_state()
        record: Json = {
            "pipeline": pipeline,
            "recording": None if done else self._key,
            "corrections": [] if done else sorted(self._corrections),
            "consumed": 0 if done else self.consumed,
            "skipped": {} if done else self.skipped.counts,
            "examples": {} if done else self.skipped.examples,
            "view": None if done else self._coverage.to_state(),
            "unreadable": [] if done else sorted(self._pictures.unreadable),
        }
        return pack(record, arrays)
