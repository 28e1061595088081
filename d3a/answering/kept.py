"""What is kept between questions: as much as there is room for, what was not asked lately goes."""

from __future__ import annotations

from collections.abc import Iterable
from threading import Lock
from typing import Generic, TypeVar

K = TypeVar("K")
V = TypeVar("V")
T = TypeVar("T")


class Kept(Generic[K, V]):
    """Values by key, the longest unasked first out; threads may share it.

    most: the sum of the sizes of what is kept. What is larger alone is not kept at all.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._size = 0
        self._values: dict[K, tuple[V, int]] = {}
        self._lock = Lock()

    def get(self, key: K, missing: T) -> V | T:
        """Return the value of a key, now the last to go; `missing` where none is kept."""
        with self._lock:
            found = self._values.pop(key, None)
            if found is None:
                return missing
            self._values[key] = found
            return found[0]

    def several(self, keys: Iterable[K]) -> dict[K, V]:
        """Return the values of those of some keys that are kept, as `get` does, all at once."""
        found: dict[K, V] = {}
        values = self._values
        with self._lock:
            for key in keys:
                kept = values.pop(key, None)
                if kept is not None:
                    values[key] = kept
                    found[key] = kept[0]
        return found

    def put(self, key: K, value: V, size: int) -> None:
        """Keep a value of a size, in place of those that were not asked for longest."""
        with self._lock:
            if key in self._values:
                self._size -= self._values.pop(key)[1]
            if size > self._most:
                return
            self._values[key] = value, size
            self._size += size
            while self._size > self._most:
                self._size -= self._values.pop(next(iter(self._values)))[1]
