"""What a detector is: it looks at a frame and names things with their boxes."""

from __future__ import annotations

from typing import Protocol

from d3a.images import Pixels
from d3a.model import Detection, Frame


class Detector(Protocol):
    """Finds things in frames."""

    classes: tuple[str, ...]
    """What it can recognise, () where that is unknown."""

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        """Return the frame's detections; pixels (h, w, 3) RGB, None without a picture."""
        ...
