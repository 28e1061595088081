"""The short-term memory of tier 2: a bounded number of instances, as contiguous arrays.

Paper: Tier 2, "a fixed-length short-term memory (STM)" with eviction of the least recently viewed
entry. Rows are kept dense, so that one product compares a thing with all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from d3a.sightings import Interval

Floats = NDArray[np.float64]
Embedding = NDArray[np.float32]


@dataclass(slots=True, eq=False)
class Entry:
    """An instance at one place. serial: unique; instance: the thing, wherever it was.

    weight: summed probability; seen: detections. moved_from: serial of the entry of the same
    instance that it was most like, and that likeness. row: its place in the arrays.
    """

    serial: int
    instance: int
    category: str
    weight: float
    seen: int
    first_ms: int
    last_ms: int
    intervals: list[Interval] = field(default_factory=list)
    moved_from: tuple[int, float] | None = None
    row: int = -1


class ShortTermMemory:
    """Entries with their positions and embeddings; the owner evicts before it is over-full."""

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self._entries: list[Entry] = []
        self._by_serial: dict[int, Entry] = {}
        self._positions: Floats = np.empty((capacity, 3))
        self._embeddings: Embedding = np.empty((capacity, 0), dtype=np.float32)
        self._lengths: Floats = np.empty(capacity)
        self._categories: dict[str, int] = {}
        self._codes = np.empty(capacity, dtype=np.intp)

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[Entry]:
        """Yield entries from the oldest to the newest."""
        return iter(sorted(self._entries, key=lambda entry: entry.serial))

    def get(self, serial: int) -> Entry | None:
        """Return the entry with this serial, None where it was evicted."""
        return self._by_serial.get(serial)

    def position(self, entry: Entry) -> Floats:
        """Return its mean position (3,), NaN where unknown."""
        return np.array(self._positions[entry.row])

    def embedding(self, entry: Entry) -> Embedding | None:
        """Return its mean embedding (d,), None where it has none."""
        if self._lengths[entry.row] == 0:
            return None
        return np.array(self._embeddings[entry.row])

    def add(self, entry: Entry, position: Floats, embedding: Embedding | None) -> None:
        """Add an entry; there must be room."""
        entry.row = len(self._entries)
        self._entries.append(entry)
        self._by_serial[entry.serial] = entry
        self._codes[entry.row] = self._categories.setdefault(entry.category, len(self._categories))
        self.write(entry, position, embedding)

    def write(self, entry: Entry, position: Floats, embedding: Embedding | None) -> None:
        """Replace an entry's means."""
        if embedding is not None and self._embeddings.shape[1] == 0:
            self._embeddings = np.zeros((self.capacity, len(embedding)), dtype=np.float32)
        self._positions[entry.row] = position
        self._embeddings[entry.row] = 0.0 if embedding is None else embedding
        self._lengths[entry.row] = 0.0 if embedding is None else float(np.linalg.norm(embedding))

    def remove(self, entry: Entry) -> None:
        """Take an entry out; the last row moves into its place."""
        last = self._entries.pop()
        del self._by_serial[entry.serial]
        if last is not entry:
            for array in (self._positions, self._embeddings, self._lengths, self._codes):
                array[entry.row] = array[last.row]
            last.row = entry.row
            self._entries[last.row] = last
        entry.row = -1

    def least_recently_viewed(self) -> Entry:
        """Return the entry that was not viewed for longest, the older of equals."""
        return min(self._entries, key=lambda entry: (entry.last_ms, entry.serial))

    def near_in_look(
        self, category: str | None, embedding: Embedding | None, min_similarity: float
    ) -> list[tuple[Entry, float]]:
        """Return nearIDs: entries of the category with a cosine of at least `min_similarity`.

        None for entries of any category. With the cosine, by serial. What has no embedding is
        unlike nothing: its cosine is 1.
        """
        rows = np.arange(len(self._entries))
        if category is not None:
            rows = np.flatnonzero(self._codes[rows] == self._categories.get(category, -1))
        # By serial: where a row lies depends on what was evicted before a restart, and a product's
        # last bits on where the row lies.
        rows = np.array(sorted(rows.tolist(), key=lambda r: self._entries[r].serial), dtype=np.intp)
        cosine = np.ones(len(rows))
        if embedding is not None and self._embeddings.shape[1]:
            scale = self._lengths[rows] * float(np.linalg.norm(embedding))
            product = (self._embeddings[rows] @ embedding).astype(np.float64)
            cosine = np.where(scale > 0, product / np.where(scale > 0, scale, 1.0), 1.0)
        near = [
            (self._entries[row], float(c))
            for row, c in zip(rows, cosine, strict=True)
            if c >= min_similarity
        ]
        return sorted(near, key=lambda each: each[0].serial)
