"""Frames made ready for the tiers: one by one, or many at a time in other processes.

Paper: "Pre-processing each frame" is a job of its own. Whatever the number of jobs, scenes come out
in the recording's order, and the tiers see them one by one in one process.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from d3a.preparation import Preparation, Prepared
from d3a.readers.base import Skipped
from d3a.sieve import Sifted


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


def one_by_one(sifted: Iterable[Sifted | None], preparation: Preparation) -> Iterator[Ready | None]:
    """Yield each frame with its scene, made when it is asked for; None is passed on."""
    for each in sifted:
        if each is None:
            yield None
        elif is_wanted(each):
            skipped = Skipped()
            yield Ready(each, preparation.prepare(each.frame, skipped), skipped)
        else:
            yield Ready(each)
