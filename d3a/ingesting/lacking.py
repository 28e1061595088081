"""What the frames of a recording lack for all that a memory can tell, as sentences for a person."""

from __future__ import annotations

from collections.abc import Iterable

from d3a.model import Detection

UNPLACED = (
    "no frame has a pose, so nothing is placed on the map: ask what and when, and see where in the "
    "pictures"
)
UNPOSED = (
    "no frame has a pose, so where the robot looked is not known: it cannot be told that a thing "
    "was gone, nor sides as seen by the robot"
)
LOOKLESS = (
    "no detection has an embedding, nor a picture to make one of: colours are not judged, and what "
    "looks alike is told apart by place and name alone"
)


class Lacking:
    """Takes frames in, and says what none of them had; each sentence once."""

    def __init__(self) -> None:
        self._is_posed = self._is_placed = self._has_looks = self._has_things = False
        self._said: set[str] = set()

    def add(self, *, posed: bool, detections: Iterable[Detection]) -> None:
        """Take a frame in. posed: whether it has the robot's pose."""
        self._is_posed |= posed
        for detection in detections:
            self._has_things = True
            self._is_placed |= detection.position is not None
            self._has_looks |= detection.embedding is not None

    def say(self) -> list[str]:
        """Return what the frames so far lack and was not said before; nothing before any thing."""
        found = []
        if self._has_things and not self._is_posed:
            found.append(UNPOSED if self._is_placed else UNPLACED)
        if self._has_things and not self._has_looks:
            found.append(LOOKLESS)
        fresh = [sentence for sentence in found if sentence not in self._said]
        self._said.update(fresh)
        return fresh
