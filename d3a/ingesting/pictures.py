"""Keyframes on their way to the store: only those that a record refers to are encoded."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from d3a import images
from d3a.model import BadInput, Image
from d3a.parameters import Parameters
from d3a.readers.base import Skipped
from d3a.store.base import Keyframe


class Pictures:
    """The pictures since the last checkpoint, as they came; unreadable ones are remembered."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._waiting: dict[str, tuple[Image, int]] = {}
        self.unreadable: set[str] = set()

    def add(self, key: str, image: Image, time_ms: int) -> None:
        """Keep a picture until the next checkpoint; decoded pixels as JPEG, as they are large."""
        if isinstance(image, np.ndarray):
            image = images.encode(image, max(image.shape), self._parameters.keyframe_quality)
        self._waiting[key] = (image, time_ms)

    def take(self, wanted: Iterable[str], skipped: Skipped) -> list[Keyframe]:
        """Return the wanted pictures that are waiting, by key, and forget the others.

        A picture that cannot be decoded after all is counted and joins `unreadable`.
        """
        found = []
        for key in sorted(set(wanted) & self._waiting.keys()):
            image, time_ms = self._waiting[key]
            try:
                pixels = images.decode(image)
                jpeg = images.encode(
                    pixels, self._parameters.keyframe_max_side, self._parameters.keyframe_quality
                )
            except BadInput as error:
                skipped.add("broken picture", f"{key} ({error})")
                self.unreadable.add(key)
                continue
            height, width = pixels.shape[:2]
            found.append(Keyframe(key, jpeg, width, height, time_ms))
        self._waiting.clear()
        return found
