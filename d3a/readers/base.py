"""What every reader gives: the recording's facts, and its frames in time order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Protocol

from d3a.model import Frame, Json


@dataclass(frozen=True, slots=True)
class Regions:
    """Named rooms that a recording brings along: name -> polygon of (x, y) in metres."""

    polygons: tuple[tuple[str, tuple[tuple[float, float], ...]], ...] = ()


@dataclass(frozen=True, slots=True)
class RecordingFacts:
    """What holds for a whole recording.

    zone: IANA name, None where the recording does not say. frames: how many, None where unknown.
    classes: what the detector can recognise, () where unknown. embedding_model: of recorded
    embeddings. now: a fixed "now" in ISO form (the demo home). extra: fields kept in the store.
    min_probability: below it the detector's words are noise; used where `Parameters` leaves it.
    """

    name: str
    site: str = ""
    zone: str | None = None
    frames: int | None = None
    classes: tuple[str, ...] = ()
    embedding_model: str | None = None
    now: str | None = None
    regions: Regions = field(default_factory=Regions)
    extra: Json = field(default_factory=dict)
    min_probability: float = 0.0


@dataclass(slots=True)
class Skipped:
    """What was left out, by reason: counted, with the first few named."""

    counts: dict[str, int] = field(default_factory=dict)
    examples: dict[str, list[str]] = field(default_factory=dict)

    def add(self, reason: str, where: str) -> None:
        """Count one thing that was left out; `where` names it (file, line, frame)."""
        self.counts[reason] = self.counts.get(reason, 0) + 1
        named = self.examples.setdefault(reason, [])
        if len(named) < 3:
            named.append(where)


class Reader(Protocol):
    """A recording: an iterator of Frame with the facts around it.

    Broken lines, rows and files are added to `skipped` and left out; a folder that cannot be read
    at all raises BadInput with what was looked for.
    """

    facts: RecordingFacts
    skipped: Skipped

    def __iter__(self) -> Iterator[Frame]:
        """Yield frames in time order."""
        ...
