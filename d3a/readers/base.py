"""What every reader gives: the recording's facts, and its frames in time order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol, runtime_checkable

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
    notes: what the reader took for granted, a sentence each, for whoever looks on.
    map: the floor plan that came along, as `FloorMap.to_json`; for a store that has none.
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
    notes: tuple[str, ...] = ()
    map: Json | None = field(default=None, repr=False)


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

    def join(self, other: Skipped) -> None:
        """Count what another has counted as well."""
        for reason, count in other.counts.items():
            self.counts[reason] = self.counts.get(reason, 0) + count
            named = self.examples.setdefault(reason, [])
            named += other.examples.get(reason, [])[: 3 - len(named)]

    def told(self) -> list[str]:
        """Return a line for each reason: how often, and the first few by name."""
        lines = []
        for reason, count in sorted(self.counts.items()):
            named = self.examples.get(reason, [])
            examples = ", ".join(named) + (", …" if count > len(named) else "")
            lines.append(f"{count} x {reason}" + (f": {examples}" if examples else ""))
        return lines


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


class Follower(Protocol):
    """A reader of a recording that grows: it yields None while there is nothing new."""

    facts: RecordingFacts
    skipped: Skipped

    def __iter__(self) -> Iterator[Frame | None]:
        """Yield frames in time order, as they come."""
        ...


@dataclass(frozen=True, slots=True)
class Stream:
    """One part of a recording as it lies there: a table, a folder of pictures, or a topic.

    kind: what it holds ("pictures", "depth", "sensor_msgs/msg/Image", ...). count: its rows or
    messages. first_ms, last_ms: UTC milliseconds, None where it has no times. longest_gap_s: the
    longest time between two, None below two. spans: whether frames want it all of their time.
    """

    name: str
    kind: str
    count: int
    first_ms: int | None = None
    last_ms: int | None = None
    longest_gap_s: float | None = None
    spans: bool = True

    @property
    def rate_hz(self) -> float | None:
        """How many a second on average, None where that cannot be told."""
        if self.first_ms is None or self.last_ms is None or self.last_ms <= self.first_ms:
            return None
        return (self.count - 1) * 1000 / (self.last_ms - self.first_ms)

    @classmethod
    def of(cls, name: str, kind: str, times_ms: Sequence[int]) -> Stream:
        """Return the stream of these times, in any order."""
        ordered = sorted(times_ms)
        gaps = [b - a for a, b in pairwise(ordered)]
        return cls(
            name,
            kind,
            len(ordered),
            ordered[0] if ordered else None,
            ordered[-1] if ordered else None,
            max(gaps) / 1000 if gaps else None,
        )


@dataclass(frozen=True, slots=True)
class Link:
    """A coordinate frame below its parent in the tf tree; is_fixed: it came on /tf_static."""

    parent: str
    child: str
    is_fixed: bool
    count: int = 1


@runtime_checkable
class Described(Protocol):
    """A reader that can tell what the recording is made of, for `d3a doctor`.

    Readers need none of it: what every one can tell is counted from its frames.
    """

    def streams(self) -> Sequence[Stream]:
        """Return the parts there are, used or not."""
        ...

    def links(self) -> Sequence[Link]:
        """Return the tf tree, () for a recording without one."""
        ...


@runtime_checkable
class Outlined(Protocol):
    """A reader whose frames cost much to make, and which can do without their pictures."""

    def outline(self) -> Iterator[Frame]:
        """Yield the frames of `__iter__`; one picture may stand in for those not decoded."""
        ...
