"""Frames made ready for the tiers: one by one, or many at a time in other processes.

Paper: "Pre-processing each frame" is a job of its own. Whatever the number of jobs, scenes come out
in the recording's order, and the tiers see them one by one in one process.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from d3a.ingesting.preparation import Preparation, Prepared
from d3a.ingesting.sieve import Sifted
from d3a.readers.base import Skipped


@dataclass(frozen=True, slots=True)
class Ready:
    """A verdict, and the scene of a frame that is to be taken in; what was left out of it.

    reader_skipped: what the reader had left out when the frame was read, None: ask the reader.
    """

    sifted: Sifted
    prepared: Prepared | None = None
    skipped: Skipped = field(default_factory=Skipped)
    reader_skipped: Skipped | None = None


def is_wanted(sifted: Sifted) -> bool:
    """Say whether a frame goes to the tiers."""
    return sifted.why is None and not sifted.is_known


def one_by_one(
    sifted: Iterable[Sifted | None], preparation: Preparation
) -> Generator[Ready | None]:
    """Yield each frame with its scene, made when it is asked for; None is passed on.

    As many as the detector takes at once are looked at together; where a None says that no more
    will come for now, those that wait are not kept waiting.
    """
    group: list[Sifted] = []
    wanted = 0
    for each in sifted:
        if each is not None:
            group.append(each)
            wanted += is_wanted(each)
        if each is None or wanted in (0, preparation.batch):
            yield from _together(group, preparation)
            group, wanted = [], 0
        if each is None:
            yield None
    yield from _together(group, preparation)


def _together(group: Sequence[Sifted], preparation: Preparation) -> Iterator[Ready]:
    skipped = [Skipped() for _ in group]
    looked_at = [
        (each.frame, own) for each, own in zip(group, skipped, strict=True) if is_wanted(each)
    ]
    scenes = iter(preparation.prepare_all([f for f, _ in looked_at], [s for _, s in looked_at]))
    for each, own in zip(group, skipped, strict=True):
        yield Ready(each, next(scenes), own) if is_wanted(each) else Ready(each)
