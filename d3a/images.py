"""Pictures: decode, crop, the colour histogram, encode. The only user of OpenCV here.

Pixels are RGB inside; OpenCV's BGR never leaves this module.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from d3a.colours.looks import HISTOGRAM_MODEL as HISTOGRAM_MODEL
from d3a.model import BadInput, Box, Depth, Image

Pixels = NDArray[np.uint8]
MILLIMETRES = 1000.0
MAX_SIDE, MAX_PIXELS = 1 << 16, 1 << 27
"""A larger picture is refused before it is decoded: it would fill the memory."""
YUV = {
    "yuv422": cv2.COLOR_YUV2RGB_UYVY,
    "uyvy": cv2.COLOR_YUV2RGB_UYVY,
    "yuv422_yuy2": cv2.COLOR_YUV2RGB_YUY2,
    "yuyv": cv2.COLOR_YUV2RGB_YUY2,
}
"""Ways of packing brightness and colour into two bytes a pixel, as ROS calls them."""
_BAYER = {
    "rggb": cv2.COLOR_BayerRGGB2RGB,
    "bggr": cv2.COLOR_BayerBGGR2RGB,
    "gbrg": cv2.COLOR_BayerGBRG2RGB,
    "grbg": cv2.COLOR_BayerGRBG2RGB,
}
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")  # a JPEG marker but for stuffing and restarts
_END, _SCAN = 0xD9, 0xDA


def decode(image: Image) -> Pixels:
    """Return the pixels (h, w, 3), RGB.

    Raises BadInput for a file that is missing, is no picture, or ends too early: OpenCV decodes
    half a JPEG without a word and paints the rest grey, which would poison a histogram.
    """
    if isinstance(image, np.ndarray):
        return image
    content = _content(image)
    if is_cut(content):
        raise BadInput("the picture is cut off: it has no end marker")
    pixels = _decoded(content, cv2.IMREAD_COLOR)
    if pixels is None:
        raise BadInput("the file is not a picture that can be decoded")
    return np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB), dtype=np.uint8)


def decode_depth(depth: Depth, scale: float = MILLIMETRES) -> NDArray[np.float32]:
    """Return depth in metres (h, w), 0 where nothing was measured.

    A PNG holds 16-bit counts, `scale` of them a metre: millimetres (REP 118) unless told. Raises
    BadInput for a file that is missing, cut off, or not 16-bit with one channel.
    """
    if isinstance(depth, np.ndarray):
        return np.nan_to_num(depth, nan=0.0, posinf=0.0, neginf=0.0)
    content = _content(depth)
    if is_cut(content):
        raise BadInput("the depth picture is cut off")
    raw = _decoded(content, cv2.IMREAD_UNCHANGED)
    if raw is None or raw.dtype != np.uint16 or raw.ndim != 2:
        raise BadInput("depth must be a 16-bit PNG with one channel")
    return np.asarray(raw, dtype=np.float32) / np.float32(scale)


def decode_grey(content: bytes) -> tuple[Pixels, Pixels | None]:
    """Return grey values (h, w) and opacity (h, w), None without; for floor plans.

    Raises BadInput for what is cut off or no picture of 8 bits.
    """
    if is_cut(content):
        raise BadInput("the picture is cut off")
    raw = _decoded(content, cv2.IMREAD_UNCHANGED)
    if raw is None or raw.dtype != np.uint8:
        raise BadInput("it is not a picture of 8 bits that can be decoded")
    if raw.ndim == 2:
        return np.asarray(raw, dtype=np.uint8), None
    # map_server takes the plain mean of the colours
    grey = np.rint(raw[:, :, :3].astype(np.float64).mean(axis=2)).astype(np.uint8)
    return grey, np.asarray(raw[:, :, 3], np.uint8) if raw.shape[2] == 4 else None


def from_bayer(raw: Pixels, pattern: str) -> Pixels:
    """Return the pixels (h, w, 3), RGB, of a sensor's values (h, w).

    pattern: the colours of the upper left four, row by row, as in `rggb`. Raises BadInput for one
    that is not known, or a picture below 2 x 2.
    """
    if pattern not in _BAYER or min(raw.shape) < 2:
        raise BadInput(f"a picture of {raw.shape[1]} x {raw.shape[0]} cannot be {pattern[:20]!r}")
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(raw), _BAYER[pattern]), np.uint8)


def from_yuv(packed: Pixels, way: str) -> Pixels:
    """Return the pixels (h, w, 3), RGB, of two bytes a pixel (h, w, 2); way: a key of YUV."""
    if packed.shape[1] % 2:
        raise BadInput(f"a picture {packed.shape[1]} wide cannot share colours between two pixels")
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(packed), YUV[way]), np.uint8)


def _content(source: Path | bytes) -> bytes:
    if isinstance(source, bytes):
        content = source
    else:
        try:
            content = source.read_bytes()
        except OSError as error:
            raise BadInput(f"{source.name} cannot be read: {error.strerror}") from error
    if not content:
        raise BadInput("the file is empty")
    return content


def _decoded(content: bytes, flags: int) -> NDArray[Any] | None:
    """Return what OpenCV makes of the bytes, None where it makes nothing."""
    refuse_huge(_written_size(content))
    try:
        return cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error as error:  # sizes beyond its limits
        raise BadInput(f"the picture cannot be decoded: {error.err}") from error


def size(image: Image) -> tuple[int, int]:
    """Return width and height, from the header where that says it; BadInput as `decode`."""
    if isinstance(image, np.ndarray):
        return image.shape[1], image.shape[0]
    content = _content(image)
    is_turned = b"Exif\0\0" in content[:4096]  # it may be: then the header has it the other way
    written = None if is_turned or is_cut(content) else _written_size(content)
    if written is not None:
        refuse_huge(written)
        return written
    pixels = decode(content)
    return pixels.shape[1], pixels.shape[0]


def refuse_huge(written: tuple[int, int] | None) -> None:
    """Raise BadInput for a size that would fill the memory."""
    if written is not None and (max(written) > MAX_SIDE or written[0] * written[1] > MAX_PIXELS):
        raise BadInput(f"the picture is too large to decode: {written[0]} x {written[1]} pixels")


def _written_size(content: bytes) -> tuple[int, int] | None:
    """Return the size in a PNG's or JPEG's header, None for other formats or where there is none.

    A JPEG's is in its frame header (SOF), whose size is the picture's and not its thumbnail's.
    """
    if content.startswith(b"\x89PNG"):
        if len(content) < 24:
            return None
        return int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
    at = 2 if content.startswith(b"\xff\xd8") else len(content)
    while found := _MARKER.search(content, at):
        marker, start = content[found.end() - 1], found.end()
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = content[start + 3 : start + 5], content[start + 5 : start + 7]
            return int.from_bytes(width, "big"), int.from_bytes(height, "big")
        at = start + (int.from_bytes(content[start : start + 2], "big") if marker != 0x01 else 0)
    return None


def is_cut(content: bytes) -> bool:
    """Say whether a JPEG or PNG ends before its end marker; other formats are never said to."""
    if content.startswith(b"\x89PNG"):
        return b"IEND" not in content[-64:]
    if not content.startswith(b"\xff\xd8"):
        return False
    at = 2
    while found := _MARKER.search(content, at):
        marker = content[found.end() - 1]
        if marker == _END:
            return False
        # A segment's length counts itself; a thumbnail's own end marker hides inside of one.
        length = int.from_bytes(content[found.end() : found.end() + 2], "big")
        at = found.end() + (length if marker != 0x01 else 0)
    return True


def crop(pixels: Pixels, box: Box) -> Pixels:
    """Return the box's pixels (a view), at least one; the box must overlap the picture."""
    x1, y1, x2, y2 = corners(pixels, box)
    return pixels[y1:y2, x1:x2]


def corners(pixels: Pixels, box: Box) -> tuple[int, int, int, int]:
    """Return the first and the end of a box's columns and rows: x1, y1, x2, y2; see `crop`."""
    height, width = pixels.shape[:2]
    x1, y1 = min(max(int(box[0]), 0), width - 1), min(max(int(box[1]), 0), height - 1)
    x2, y2 = min(max(round(box[2]), x1 + 1), width), min(max(round(box[3]), y1 + 1), height)
    return x1, y1, x2, y2


def resized(pixels: Pixels, width: int, height: int) -> Pixels:
    """Return the picture scaled to a size, between neighbouring pixels (bilinear)."""
    return np.asarray(cv2.resize(pixels, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)


def histogram(pixels: Pixels) -> NDArray[np.float32]:
    """Return the `rgb-8x8x8` embedding (512,): raw pixel counts at unit length (L2).

    Index 64 * (R // 32) + 8 * (G // 32) + B // 32. The paper compares raw counts by their cosine,
    to which the length is nothing; and dividing by the sum gives each colour's share of the
    pixels back, which is what a colour word is scored on.
    """
    counts = cv2.calcHist(
        [np.ascontiguousarray(pixels)], [0, 1, 2], None, [8, 8, 8], [0, 256, 0, 256, 0, 256]
    ).ravel()
    return unit(np.asarray(counts, dtype=np.float32))


def bins(pixels: Pixels) -> NDArray[np.intp]:
    """Return the bin of `histogram` that each pixel falls into, (h, w)."""
    levels = (pixels >> 5).astype(np.intp)
    return np.asarray(levels[..., 0] * 64 + levels[..., 1] * 8 + levels[..., 2])


def unit(counts: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a vector (d,) or the rows of a matrix (n, d) at unit length; zeros stay zeros."""
    length = np.sqrt(np.sum(np.square(counts, dtype=np.float64), axis=-1, keepdims=True))
    return np.asarray(counts / np.where(length > 0, length, 1.0), dtype=np.float32)


def encode(pixels: Pixels, max_side: int, quality: int) -> bytes:
    """Return a JPEG whose longer side is at most `max_side` pixels."""
    height, width = pixels.shape[:2]
    scale = max_side / max(height, width)
    if scale < 1:
        size = (max(1, round(width * scale)), max(1, round(height * scale)))
        pixels = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)
    fine, buffer = cv2.imencode(
        ".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    if not fine:
        raise BadInput(f"a picture of {width} x {height} cannot be encoded")
    return bytes(buffer)


def check(image: Image) -> None:
    """Raise BadInput for a picture that is missing, empty or cut off, without decoding it."""
    if isinstance(image, np.ndarray):
        return
    content = _content(image)
    if is_cut(content):
        raise BadInput("the picture is cut off: it has no end marker")
