"""How a picture is put into a network's input, and boxes back into the picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from d3a import images
from d3a.images import Pixels

RGB_1, BGR_1, RGB_255, BGR_255 = "rgb-1", "bgr-1", "rgb-255", "bgr-255"
IMAGENET = "rgb-imagenet"
PIXELS = (RGB_1, BGR_1, RGB_255, BGR_255, IMAGENET)
"""What networks are shown: red, green, blue or the reverse, from 0 to 1 or to 255; or as shares
less the mean of the ImageNet pictures, over their deviation."""
CENTRE, CORNER, STRETCH = "centre", "corner", "stretch"
FITS = (CENTRE, CORNER, STRETCH)
"""Where the scaled picture lies: in the middle, in the top left corner, or over all of it."""
GREY = 114
"""What is around the picture; networks have been trained with it."""
_MEAN = np.array([0.485, 0.456, 0.406], dtype=np.float32)
_DEVIATION = np.array([0.229, 0.224, 0.225], dtype=np.float32)


@dataclass(frozen=True, slots=True)
class Placement:
    """Where a picture lies in a network's input: scales, offset in input pixels, own size."""

    scale_x: float
    scale_y: float
    left: int
    top: int
    width: int
    height: int

    def back(self, boxes: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return boxes (n, 4) of the input as boxes of the picture, cut to it."""
        offset = np.array([self.left, self.top] * 2, dtype=np.float32)
        scale = np.array([self.scale_x, self.scale_y] * 2, dtype=np.float32)
        most = np.array([self.width, self.height] * 2, dtype=np.float32)
        return np.asarray(np.clip((boxes - offset) / scale, 0, most), dtype=np.float32)


@dataclass(frozen=True, slots=True)
class Feeding:
    """What a network is shown: pictures of one size (height, width), see PIXELS and FITS."""

    size: tuple[int, int]
    pixels: str = RGB_1
    fit: str = CENTRE

    def place(self, picture: Pixels) -> tuple[NDArray[np.float32], Placement]:
        """Return a picture (h, w, 3) as the input (3, height, width), and where it lies in it."""
        height, width = picture.shape[:2]
        high, wide = self.size
        if self.fit == STRETCH:
            new_width, new_height = wide, high
        else:
            scale = min(wide / width, high / height)
            new_width = min(max(round(width * scale), 1), wide)
            new_height = min(max(round(height * scale), 1), high)
        left = (wide - new_width) // 2 if self.fit == CENTRE else 0
        top = (high - new_height) // 2 if self.fit == CENTRE else 0
        canvas = np.full((high, wide, 3), GREY, dtype=np.uint8)
        scaled = images.resized(picture, new_width, new_height)
        canvas[top : top + new_height, left : left + new_width] = scaled
        placement = Placement(new_width / width, new_height / height, left, top, width, height)
        return self._numbers(canvas), placement

    def grey(self) -> NDArray[np.float32]:
        """Return the input for a picture of one grey."""
        return self._numbers(np.full((*self.size, 3), GREY, dtype=np.uint8))

    def _numbers(self, canvas: Pixels) -> NDArray[np.float32]:
        ordered = canvas[:, :, ::-1] if self.pixels in (BGR_1, BGR_255) else canvas
        numbers = ordered.astype(np.float32)
        if self.pixels not in (RGB_255, BGR_255):
            numbers /= np.float32(255)
        if self.pixels == IMAGENET:
            numbers = (numbers - _MEAN) / _DEVIATION
        return np.ascontiguousarray(numbers.transpose(2, 0, 1))
