"""Video files: their pictures in order, with the time of each. OpenCV decodes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from d3a.images import Pixels
from d3a.model import BadInput

MAX_BROKEN = 25
"""So many pictures on end that cannot be decoded are the end of what can be read."""


@dataclass(frozen=True, slots=True)
class Shot:
    """A picture of a video: its number from 0, seconds from the start, and pixels (h, w, 3) RGB.

    pixels: None where the picture is broken.
    """

    number: int
    seconds: float
    pixels: Pixels | None


@dataclass(frozen=True, slots=True)
class Video:
    """A video file. frames: as its header says, 0 where it does not; rate: pictures a second."""

    path: Path
    frames: int
    rate: float
    width: int
    height: int

    @classmethod
    def open(cls, path: Path) -> Video:
        """Read the header; BadInput for what is no video that can be decoded."""
        capture = _capture(path)
        try:
            count, rate = (capture.get(p) for p in (cv2.CAP_PROP_FRAME_COUNT, cv2.CAP_PROP_FPS))
            width, height = (
                capture.get(p) for p in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
            )
        finally:
            capture.release()
        if not math.isfinite(rate) or rate <= 0:
            raise BadInput(f"{path.name} does not say how many pictures a second it has")
        return cls(path, max(int(count), 0), rate, int(width), int(height))

    def shots(self) -> Iterator[Shot]:
        """Yield the pictures in order; the time is the file's own, else by the rate."""
        capture = _capture(self.path)
        try:
            number, broken = 0, 0
            while broken < MAX_BROKEN and (number < self.frames or broken == 0):
                pixels = None
                is_there = capture.grab()
                if is_there:
                    is_there, decoded = capture.retrieve()
                    if is_there:
                        pixels = np.asarray(cv2.cvtColor(decoded, cv2.COLOR_BGR2RGB), np.uint8)
                broken = 0 if is_there else broken + 1
                if pixels is not None:
                    yield Shot(number, self._seconds(number, capture), pixels)
                elif number < self.frames:
                    yield Shot(number, number / self.rate, None)
                number += 1
        finally:
            capture.release()

    def _seconds(self, number: int, capture: cv2.VideoCapture) -> float:
        told = float(capture.get(cv2.CAP_PROP_POS_MSEC)) / 1000
        # Some files tell no times, and then all of them are 0.
        return told if number == 0 or told > 0 else number / self.rate


def _capture(path: Path) -> cv2.VideoCapture:
    capture = cv2.VideoCapture(str(path))
    if not capture.isOpened():
        raise BadInput(f"{path.name} is no video that can be decoded, or it is cut off")
    return capture
