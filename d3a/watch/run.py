"""An ingest of a recording that grows, for as long as it does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from d3a.associator import ForgottenMeanwhile
from d3a.ingest import IngestSummary, Note, NothingYet, Progress, ingest
from d3a.ingesting.intake import EVERYTHING, Intake
from d3a.ingesting.live import Live
from d3a.parameters import Parameters
from d3a.readers.base import Follower
from d3a.store.base import Store

if TYPE_CHECKING:
    from d3a.detectors.base import Detector
    from d3a.embedders.base import Embedder

FRESH_S = 2.0
"""How old the answers of a store may be that is filled as one watches."""


@dataclass(frozen=True, slots=True)
class Watching:
    """What an ingest that follows a recording needs besides the recording and the store.

    fresh_s: the store is at most this much older than what came. is_resumable: whether the
    recording can be followed from its start again; else one that is stopped is ended. intake: what
    goes in, given the recording's zone, for times without an offset. on_note: told what `ingest`
    notes, and when something was forgotten meanwhile and it goes on from its last checkpoint.
    """

    parameters: Parameters
    should_stop: Callable[[], bool]
    fresh_s: float = FRESH_S
    is_resumable: bool = True
    intake: Callable[[str | None], Intake] = lambda _: EVERYTHING
    detector: Detector | None = None
    embedder: Embedder | None = None
    on_progress: Progress | None = None
    on_note: Note = lambda _: None


def watch(
    opened: Callable[[], Follower | None], store: Store, watching: Watching
) -> IngestSummary | None:
    """Take a growing recording in until it is over or is stopped; None where nothing came.

    opened: begins to follow the recording, from its first frame; None where it was stopped. A
    recording that is over is as a plain ingest leaves it; one that was stopped is left open, and
    goes on when it is watched or ingested again. Raises as `ingest`.
    """
    asked = watching.should_stop if watching.is_resumable else lambda: False
    while True:
        follower = opened()
        if follower is None:
            return None
        try:
            return ingest(
                follower,
                store,
                watching.parameters,
                detector=watching.detector,
                embedder=watching.embedder,
                on_progress=watching.on_progress,
                on_note=watching.on_note,
                intake=watching.intake(follower.facts.zone),
                live=Live(watching.fresh_s, asked),
            )
        except NothingYet:
            if watching.should_stop():
                return None
            raise
        except ForgottenMeanwhile as error:
            watching.on_note(str(error))
