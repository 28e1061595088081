"""Scenes made in other processes, in the recording's order: joblib's own, or a cluster's.

Paper: "Pre-processing each frame" (decode, detect, embed) needs no memory, so that it can be done
anywhere; the tiers are one process. Frames go out in waves while the wave before is taken in, and
no more than that is held: scenes have depth pictures.
"""

from __future__ import annotations

import importlib
import importlib.util
import pickle
import queue
import threading
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from typing import Any, Literal

from d3a.ingesting.batches import Ready, is_wanted
from d3a.ingesting.preparation import Preparation, Prepared, Stopwatch
from d3a.ingesting.sieve import Sifted
from d3a.model import BadInput, Frame
from d3a.readers.base import Skipped

Backend = Literal["processes", "dask", "ray"]
NEEDS: dict[Backend, tuple[str, str]] = {
    "processes": ("joblib", "pip install joblib"),
    "dask": ("distributed", "pip install 'd3a[dask]'"),
    "ray": ("ray", "pip install ray"),
}
CHUNK = 8
"""Frames that a worker makes ready at once: what it costs to send them is then small."""
AHEAD = 2
"""Chunks for each worker in a wave, so that one slow chunk does not leave the others idle."""


@dataclass(frozen=True, slots=True)
class Jobs:
    """Where scenes are made. count: workers; 1 of "processes" is this process alone."""

    count: int = 1
    backend: Backend = "processes"

    def __post_init__(self) -> None:
        if self.count < 1:
            raise BadInput(f"jobs {self.count} must be 1 or more")
        library, way = NEEDS[self.backend]
        if importlib.util.find_spec(library) is None:
            raise BadInput(f"the backend {self.backend!r} needs {library}: {way}")

    @property
    def is_here(self) -> bool:
        """Whether scenes are made in this process."""
        return self.count == 1 and self.backend == "processes"


ONE = Jobs()


@dataclass(frozen=True, slots=True)
class _Chunk:
    """Verdicts, with what the reader had left out when the last of them was read."""

    sifted: list[Sifted]
    reader_skipped: Skipped

    def wanted(self) -> list[Frame]:
        return [each.frame for each in self.sifted if is_wanted(each)]


@dataclass(frozen=True, slots=True)
class _Made:
    scenes: list[tuple[Prepared, Skipped]]
    seconds: dict[str, float]


_Wave = list[tuple[_Chunk, _Made]]


def in_jobs(
    sifted: Iterable[Sifted | None],
    preparation: Preparation,
    stopwatch: Stopwatch,
    left_out: Callable[[], Skipped],
    jobs: Jobs,
) -> Generator[Ready | None]:
    """Yield what `one_by_one` yields, made by other processes; the stopwatch counts their time.

    left_out: what the reader has left out by now; it is asked in the thread that reads it. What a
    worker raises is raised here.
    """
    content = pickle.dumps((preparation, stopwatch))  # which it counts on
    waves: queue.Queue[_Wave | BaseException | None] = queue.Queue(1)
    ended = threading.Event()

    def make() -> None:
        try:
            chunks = _chunks(sifted, left_out)
            with _pool(jobs) as pool:
                while not ended.is_set() and (wave := list(islice(chunks, AHEAD * jobs.count))):
                    made = pool(content, [chunk.wanted() for chunk in wave])
                    waves.put(list(zip(wave, made, strict=True)))
            waves.put(None)
        except BaseException as error:  # it is for who waits for the frames
            waves.put(error)

    worker = threading.Thread(target=make, name="d3a-jobs", daemon=True)
    worker.start()
    try:
        while (wave := waves.get()) is not None:
            if isinstance(wave, BaseException):
                raise wave
            for chunk, made in wave:
                yield from _ready(chunk, made, stopwatch)
    finally:
        ended.set()
        while worker.is_alive():  # it may wait to hand a wave over
            _discard(waves)
            worker.join(0.1)


def _discard(waves: queue.Queue[Any]) -> None:
    try:
        waves.get_nowait()
    except queue.Empty:
        return


def _ready(chunk: _Chunk, made: _Made, stopwatch: Stopwatch) -> Iterator[Ready]:
    for stage, seconds in made.seconds.items():
        stopwatch.seconds[stage] += seconds
    scenes = iter(made.scenes)
    for each in chunk.sifted:
        if is_wanted(each):
            yield Ready(each, *next(scenes), reader_skipped=chunk.reader_skipped)
        else:
            yield Ready(each, reader_skipped=chunk.reader_skipped)


def _chunks(sifted: Iterable[Sifted | None], left_out: Callable[[], Skipped]) -> Iterator[_Chunk]:
    verdicts = (each for each in sifted if each is not None)
    while part := list(islice(verdicts, CHUNK)):
        skipped = Skipped()
        skipped.join(left_out())
        yield _Chunk(part, skipped)


@contextmanager
def _pool(jobs: Jobs) -> Iterator[Callable[[bytes, Sequence[list[Frame]]], list[_Made]]]:
    """Give a function that has lists of frames made ready by the backend's workers."""
    from joblib import Parallel, delayed, parallel_config

    with ExitStack() as stack:
        if jobs.backend == "dask":
            stack.enter_context(_dask_client(jobs.count))
        elif jobs.backend == "ray":
            importlib.import_module("ray.util.joblib").register_ray()
        name = "loky" if jobs.backend == "processes" else jobs.backend
        stack.enter_context(parallel_config(backend=name, n_jobs=jobs.count))
        # the detector's own threads are what it was told to have
        parallel = stack.enter_context(Parallel(pre_dispatch="all", batch_size=1))
        yield lambda content, lists: parallel(delayed(_make)(content, frames) for frames in lists)


@contextmanager
def _dask_client(count: int) -> Iterator[None]:
    """Connect to the cluster that DASK_SCHEDULER_ADDRESS names, else to one of this machine."""
    dask, distributed = (importlib.import_module(name) for name in ("dask", "distributed"))
    with ExitStack() as stack:
        address = dask.config.get("scheduler-address", None)
        if address is None:
            cluster = distributed.LocalCluster(
                n_workers=count, threads_per_worker=1, dashboard_address=None, silence_logs=40
            )
            address = stack.enter_context(cluster)
        stack.enter_context(distributed.Client(address))
        yield


def _make(content: bytes, frames: list[Frame]) -> _Made:
    """Make scenes of frames; runs in a worker."""
    preparation, stopwatch = _unpacked(content)
    before = dict(stopwatch.seconds)
    counted = [Skipped() for _ in frames]
    scenes = preparation.prepare_all(frames, counted) if frames else []
    spent = {stage: value - before[stage] for stage, value in stopwatch.seconds.items()}
    return _Made(list(zip(scenes, counted, strict=True)), spent)


@lru_cache(maxsize=1)
def _unpacked(content: bytes) -> tuple[Preparation, Stopwatch]:
    """Return the preparation, once a worker: a detector's model is large."""
    preparation, stopwatch = pickle.loads(content)
    return preparation, stopwatch
