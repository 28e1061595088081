"""The methods under test: how each fills a store, and how its answers are arranged."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter, process_time
from typing import Literal

from assistant.evaluation.questions import taught_name
from assistant.evaluation.worlds import Recorded
from d3a.answer import Answer
from d3a.baselines import NON_SPATIAL, diversify, fill_naive
from d3a.ingest import ingest
from d3a.metrics import best_ids, id_owners
from d3a.parameters import DEFAULT, PAPER, Parameters
from d3a.readers.recording import RecordingReader
from d3a.store.base import Batch, StayKey, Store, TaughtName
from d3a.store.opening import open_store
from d3a.truth import Truth

Kind = Literal["naive", "naive+", "tiers"]


@dataclass(frozen=True, slots=True)
class Method:
    """A method: its key, its name in tables, the world's condition and what fills the store.

    condition: None for the condition under test, else the sensor it is given instead (D3A+P).
    paper: its key in the paper's tables, where it has one.
    """

    key: str
    title: str
    kind: Kind
    parameters: Parameters
    condition: str | None = None
    paper: str | None = None

    @property
    def is_papers(self) -> bool:
        """Whether it is asked as the paper asks: unions for Q2, keyframes by probability."""
        return self.parameters.profile == "paper"

    def arrange(self, answer: Answer) -> Answer:
        """Return the answer in the method's own order."""
        return diversify(answer) if self.kind == "naive+" else answer


NAIVE = Method("naive", "Naive", "naive", PAPER, paper="naive")
NAIVE_PLUS = Method("naive+", "Naive+", "naive+", DEFAULT)
NON_SPATIAL_METHOD = Method("non-spatial", "Non-spatial", "tiers", NON_SPATIAL)
D3A_D = Method("d3a+d", "D3A+D, paper profile", "tiers", PAPER, paper="d3a+d")
D3A_P = Method("d3a+p", "D3A+P, same pose noise", "tiers", PAPER, "perfect", "d3a+p")
D3A_P_EXACT = Method("d3a+p-0.1", "D3A+P, 0.1 m", "tiers", PAPER, "perfect-0.1", "d3a+p")
OURS = Method("default", "D3A+D, default profile", "tiers", DEFAULT, paper="d3a+d")
METHODS = (NAIVE, NAIVE_PLUS, NON_SPATIAL_METHOD, D3A_P, D3A_P_EXACT, D3A_D, OURS)


@dataclass(frozen=True, slots=True)
class Filled:
    """A filled store with what is known of the filling.

    assignments: by row of detections.jsonl, None where left out. seconds: wall time of the
    ingest, reading included; associate_s: processor time of the association alone, without
    reading and storing; a naive ingest has no association, and its whole time is told.
    """

    method: Method
    store: Store
    path: Path
    assignments: tuple[StayKey | None, ...]
    detections: int
    seconds: float
    associate_s: float


@contextmanager
def filled(method: Method, recording: Recorded, folder: Path) -> Iterator[Filled]:
    """Fill a fresh store in `folder` from a recording and give it; it is closed at the end.

    The recording's truth only says how many rows there are. Raises StoreError and BadInput.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{method.key}.db"
    for old in folder.glob(f"{method.key}.db*"):
        old.unlink()
    store = open_store(str(path))
    try:
        yield _fill(method, recording.folder, store, path, len(recording.truth.owner))
    finally:
        store.close()


def _fill(method: Method, recording: Path, store: Store, path: Path, rows: int) -> Filled:
    reader = RecordingReader(recording)
    before, spent = perf_counter(), process_time()
    if method.kind == "tiers":
        record = path.with_suffix(".assignments.jsonl")
        summary = ingest(reader, store, method.parameters, assignments=record)
        seconds = perf_counter() - before
        kept = read_assignments(record, rows)
        detections = summary.detections
        associate = summary.processor["tiers"]
    else:
        together = method.kind == "naive+"
        naive = fill_naive(reader, store, together=together, parameters=method.parameters)
        seconds, associate = perf_counter() - before, process_time() - spent
        kept = tuple(naive.assignments.get(row) for row in range(rows))
        detections = naive.detections
    return Filled(method, store, path, kept, detections, seconds, associate)


def read_assignments(path: Path, rows: int) -> tuple[StayKey | None, ...]:
    """Return where each row went, from the record that an ingest writes."""
    kept: list[StayKey | None] = [None] * rows
    with path.open(encoding="utf-8") as file:
        for line in file:
            record = json.loads(line)
            if record["row"] is not None and record["object_id"] is not None:
                kept[record["row"]] = (record["object_id"], int(record["place"]))
    return tuple(kept)


def teach(store: Store, truth: Truth, assignments: tuple[StayKey | None, ...]) -> None:
    """Teach the store a name for each true object: on the ObjectIDs that are the object's.

    This is the paper's Perfect precision: the query "can map to an exact ObjectID". Those are the
    ids most of whose detections show it, and the id that holds most of its own. An object of
    which nothing was kept has no ObjectID, and so no name. Raises StoreError.
    """
    owners = truth.owner.tolist()
    pairs = {(i, o) for i, o in id_owners(owners, assignments).items() if o >= 0}
    pairs |= {(i, o) for o, i in best_ids(owners, assignments).items()}
    names: dict[str, list[TaughtName]] = {}
    for object_id, number in sorted(pairs):
        names.setdefault(object_id, []).append(TaughtName(taught_name(number)))
    records = store.objects(ids=sorted(names))
    taught = [replace(r, names=(*r.names, *names[r.object_id])) for r in records]
    store.apply(Batch(objects=taught))
