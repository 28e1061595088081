"""Pictures, depth and camera parameters as sensor_msgs has them."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from d3a import images
from d3a.model import BadInput, Camera, Depth, Image

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
DEPTH_ENCODINGS = frozenset({"16UC1", "mono16", "32FC1"})
"""A picture of 16 bits is nobody's colour picture; cameras also call depth `mono16`."""
COMPRESSED_DEPTH = "compressedDepth"
DEPTH_HEADER = 12
"""Bytes before the PNG of compressedDepth: a number for the way, and two floats of quantising."""
MILLIMETRES = 1000.0
SAME_SHAPE = 0.01
"""Width and height that are scaled alike up to this: a resized picture of the same camera."""
_CHANNELS = {
    "rgb8": (0, 1, 2),
    "bgr8": (2, 1, 0),
    "8UC3": (2, 1, 0),
    "rgba8": (0, 1, 2),
    "bgra8": (2, 1, 0),
    "8UC4": (2, 1, 0),
    "mono8": (0, 0, 0),
    "8UC1": (0, 0, 0),
}
_WIDTHS = {"rgb8": 3, "bgr8": 3, "8UC3": 3, "rgba8": 4, "bgra8": 4, "8UC4": 4}
_DEPTH_TYPES = {"16UC1": "u2", "mono16": "u2", "32FC1": "f4"}


def kind_of(message: Any) -> str:
    """Return the encoding of an Image, or the format of a CompressedImage."""
    return str(message.encoding if hasattr(message, "encoding") else message.format)


def is_depth(message: Any) -> bool:
    """Say whether an Image or CompressedImage holds depth."""
    kind = kind_of(message)
    return COMPRESSED_DEPTH in kind or kind.split(";")[0].strip() in DEPTH_ENCODINGS


def is_colour(message: Any) -> bool:
    """Say whether a picture has colours, as far as its kind tells."""
    return "mono" not in kind_of(message) and "8UC1" not in kind_of(message)


def picture_of(message: Any) -> Image:
    """Return pixels (h, w, 3) RGB of an Image, the bytes of a CompressedImage as they are.

    Raises BadInput for an encoding that is no picture's, a size that cannot be, or too few bytes.
    """
    if not hasattr(message, "encoding"):
        return bytes(message.data)
    encoding = str(message.encoding)
    if encoding.startswith("bayer_") and encoding.endswith("8"):
        return images.from_bayer(_rows(message, 1)[:, :, 0], encoding[6:-1])
    if encoding in images.YUV:
        return images.from_yuv(_rows(message, 2), encoding)
    if encoding not in _CHANNELS:
        raise BadInput(f"pictures of encoding {encoding[:40]!r} cannot be read")
    pixels = _rows(message, _WIDTHS.get(encoding, 1))
    return np.ascontiguousarray(pixels[:, :, _CHANNELS[encoding]])


def depth_of(message: Any) -> Depth:
    """Return depth as metres (h, w), or a 16-bit PNG in millimetres.

    Raises BadInput for what is no depth that can be read.
    """
    if not hasattr(message, "encoding"):
        return _compressed_depth(str(message.format), bytes(message.data))
    kind = _DEPTH_TYPES.get(str(message.encoding))
    if kind is None:
        raise BadInput(f"depth of encoding {str(message.encoding)[:40]!r} cannot be read")
    order = ">" if message.is_bigendian else "<"
    rows = _rows(message, int(kind[1]))
    values = np.ascontiguousarray(rows).view(f"{order}{kind}")[:, :, 0]
    if kind == "u2":
        return values.astype(np.float32) / np.float32(MILLIMETRES)
    return np.nan_to_num(values.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)


def _rows(message: Any, pixel_bytes: int) -> NDArray[np.uint8]:
    """Return the bytes (h, w, pixel_bytes) without what pads a row."""
    width, height, step = int(message.width), int(message.height), int(message.step)
    images.refuse_huge((width, height))
    if width < 1 or height < 1:
        raise BadInput(f"the picture is empty: {width} x {height}")
    step = step or width * pixel_bytes
    if step < width * pixel_bytes:
        raise BadInput(f"a row of {width} pixels does not fit into {step} bytes")
    content = np.frombuffer(message.data, np.uint8)
    needed = step * (height - 1) + width * pixel_bytes  # the last row may come without its padding
    if len(content) < needed:
        raise BadInput(f"the picture is cut off: {len(content)} bytes of {needed}")
    padded = np.zeros(step * height, np.uint8) if len(content) < step * height else content
    if padded is not content:
        padded[: len(content)] = content
    rows = padded[: step * height].reshape(height, step)[:, : width * pixel_bytes]
    return rows.reshape(height, width, pixel_bytes)


def _compressed_depth(form: str, content: bytes) -> Depth:
    """Return what compressed_depth_image_transport packed: 16UC1 as it is, 32FC1 as inverses."""
    if COMPRESSED_DEPTH not in form:
        return content
    if "rvl" in form.lower():
        raise BadInput("depth packed as RVL cannot be read: record it as compressedDepth png")
    if len(content) <= DEPTH_HEADER:
        raise BadInput("the depth picture is empty")
    png = content[DEPTH_HEADER:]
    if not form.strip().startswith("32FC1"):
        return png
    _, a, b = struct.unpack("<iff", content[:DEPTH_HEADER])
    inverse = images.decode_depth(png, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        metres = np.where(inverse > 0, a / (inverse - b), 0.0)
    return np.nan_to_num(metres.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0)


@dataclass(frozen=True, slots=True)
class Calibration:
    """What a CameraInfo says of the pictures: of their size after binning and cropping."""

    camera: Camera
    frame_id: str

    def of_size(self, size: tuple[int, int] | None) -> Camera:
        """Return the camera of a picture; one of another size, but the same shape, is resized.

        A picture of another shape was cropped somehow, and its camera stays as it is: whoever looks
        at both counts it.
        """
        camera = self.camera
        if size is None or size == (camera.width, camera.height):
            return camera
        across, down = size[0] / camera.width, size[1] / camera.height
        if abs(across / down - 1) > SAME_SHAPE:
            return camera
        focal = (camera.fx * across, camera.fy * down)
        # a pixel's middle is at half of it, and that is what scales
        centre = ((camera.cx + 0.5) * across - 0.5, (camera.cy + 0.5) * down - 0.5)
        return Camera(*size, *focal, *centre)


def calibration_of(
    message: Any, size: tuple[int, int] | None, *, is_rectified: bool
) -> Calibration:
    """Return the camera of a CameraInfo; BadInput for one that is not calibrated.

    size: of a picture, for drivers that leave it out. is_rectified: the pictures are, so that the
    projection matrix P holds for them instead of K.
    """
    k = [float(v) for v in (message.k if hasattr(message, "k") else message.K)]
    p = [float(v) for v in (message.p if hasattr(message, "p") else message.P)]
    four = (k[0], k[4], k[2], k[5])
    if is_rectified and p[0] != 0:
        four = (p[0], p[5], p[2], p[6])
    if not all(map(math.isfinite, four)):
        raise BadInput("the camera's matrix has numbers that are not finite")
    if four[0] <= 0 or four[1] <= 0:
        raise BadInput(f"the camera is not calibrated: its focal length is {four[0]:g}")
    roi = message.roi
    width, height = (int(message.width), int(message.height))
    if roi.width and roi.height:
        width, height = int(roi.width), int(roi.height)
    across, down = max(int(message.binning_x), 1), max(int(message.binning_y), 1)
    if width and height:
        size = (width // across, height // down)
    if size is None:
        raise BadInput("neither the camera nor a picture says a size")
    focal = (four[0] / across, four[1] / down)
    centre = ((four[2] - roi.x_offset) / across, (four[3] - roi.y_offset) / down)
    frame_id = str(message.header.frame_id).lstrip("/")
    return Calibration(Camera(*size, *focal, *centre), frame_id)


def distortion_of(message: Any) -> float:
    """Return the largest lens distortion coefficient, 0 for a picture that is straight."""
    values = [float(v) for v in (message.d if hasattr(message, "d") else message.D)]
    return max((abs(v) for v in values if math.isfinite(v)), default=0.0)
