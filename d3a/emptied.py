"""The checkpoint without its short-term memory: what is in it goes to the store, as at an end.

Who changes the store behind an ingest that was interrupted (forgetting does) changes what the
checkpoint remembers too. So the memory is flushed first, into a ledger that nothing was written
from yet; the ingest goes on from the same frame and fetches what is left back by place.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from d3a.answering.facts import Facts
from d3a.associator import Pipeline
from d3a.checkpoint import Arrays, pack, unpack
from d3a.constraints import History
from d3a.correcting.reconcile import news_of
from d3a.images import HISTOGRAM_MODEL
from d3a.ledger import Ledger
from d3a.model import Json
from d3a.paper import PaperPipeline
from d3a.store.base import Store
from d3a.tier3 import Stored
from d3a.tracking.tracker import TrackerPipeline


@dataclass(frozen=True, slots=True)
class Emptied:
    """A store as it is with nothing in memory.

    ledger: reads like it. record, arrays: the checkpoint then, None where there is none.
    was_open: a recording is going on, so that its memory was flushed.
    """

    ledger: Ledger
    record: Json | None
    arrays: Arrays
    was_open: bool

    def state(self, gone_ids: Collection[str], gone_categories: Collection[str]) -> bytes | None:
        """Return the checkpoint's bytes without what it keeps of these; None without one."""
        if self.record is None:
            return None
        pipeline = dict(self.record["pipeline"])
        for counted in ("categories", "others"):  # not of every profile and release
            if counted in pipeline:
                kinds = pipeline[counted]
                pipeline[counted] = {c: n for c, n in kinds.items() if c not in gone_categories}
        if "compared" in pipeline:
            kept = [number for number in pipeline["compared"] if f"o{number}" not in gone_ids]
            pipeline["compared"] = kept
        if "recall" in pipeline:
            outside = max(0, pipeline["recall"]["outside"] - len(gone_ids))
            pipeline["recall"] = pipeline["recall"] | {"outside": outside}
        return pack(self.record | {"pipeline": pipeline}, self.arrays)


def emptied(store: Store) -> Emptied:
    """Flush the checkpoint's memory into a ledger over the store; nothing is written.

    Raises StoreError for a checkpoint of another version.
    """
    ledger = Ledger(store)
    state = store.state()
    if state is None:
        return Emptied(ledger, None, {}, was_open=False)
    record, arrays = unpack(state)
    if record["recording"] is None:  # it was ended: the memory is empty
        return Emptied(ledger, record, arrays, was_open=False)
    pipeline = _pipeline(store, ledger, record["recording"])
    history = History.read(store)
    pipeline.take_constraints(history.constraints())
    pipeline.restore(record["pipeline"], arrays)
    pipeline.correct(news_of(history, frozenset(record.get("corrections", ()))))
    pipeline.take_names(ledger.taught())
    pipeline.flush()
    flushed, arrays = pipeline.to_state()
    record |= {"pipeline": flushed, "examples": {}, "view": None}
    record |= {"corrections": sorted(history.moving())}
    return Emptied(ledger, record, arrays, was_open=True)


def _pipeline(store: Store, ledger: Ledger, recording: str) -> Pipeline:
    parameters = Facts(store).parameters()
    sites = {known.key: known.site for known in store.recordings()}
    model = store.meta("embedding_model") or HISTOGRAM_MODEL
    stored = Stored(sites.get(recording, ""), str(model))
    if parameters.profile == "paper":
        return PaperPipeline(ledger, stored, parameters)
    return TrackerPipeline(ledger, stored, parameters, int(store.counts()["objects"]))
