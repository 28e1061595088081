"""The detector that has looked already: boxes that came with the recording."""

from __future__ import annotations

from dataclasses import dataclass

from d3a.images import Pixels
from d3a.model import BadInput, Detection, Frame


@dataclass(slots=True)
class RecordedDetector:
    """Gives each frame's own detections back."""

    classes: tuple[str, ...] = ()
    identity: str = ""

    def detect(self, frame: Frame, pixels: Pixels | None) -> tuple[Detection, ...]:
        """Return the recorded detections; BadInput for a recording that no detector has seen."""
        if frame.detections is None:
            raise BadInput(
                f"frame {frame.name} has no detections: the recording needs a detector, or a "
                "file of detections made by one"
            )
        return frame.detections
