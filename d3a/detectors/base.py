"""What a detector is: it looks at a frame and names things with their boxes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from d3a.images import Pixels
from d3a.model import Detection, Frame


class Detector(Protocol):
    """Finds things in frames."""

    @property
    def classes(self) -> tuple[str, ...]:
        """What it can recognise, () where that is unknown."""
        ...

    @property
    def identity(self) -> str:
        """What it is, with its settings: a recording is looked at by one only."""
        ...

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        """Return the frame's detections; pixels (h, w, 3) RGB, None without a picture."""
        ...


@runtime_checkable
class BatchDetector(Protocol):
    """A detector that is quicker with several pictures at once."""

    @property
    def batch(self) -> int:
        """How many it takes at once."""
        ...

    def detect_all(
        self, frames: Sequence[Frame], pictures: Sequence[Pixels | None]
    ) -> list[tuple[Detection, ...]]:
        """Return the detections of each frame, as `detect` would; at most `batch` frames."""
        ...
