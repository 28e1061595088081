"""Pictures with their box drawn in, as PNG: what is saved and sent to somebody."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from assistant.terminal import clean

if TYPE_CHECKING:
    from PIL.Image import Image

    from d3a.answer import RankedKeyframe
    from d3a.model import Box
    from d3a.store.base import Keyframe, Store

_EDGE, _SHADOW = (255, 215, 0), (0, 0, 0)


def decode(picture: Keyframe) -> Image:
    """Return the stored picture as RGB; OSError where its bytes are damaged."""
    from PIL import Image

    with Image.open(io.BytesIO(picture.jpeg)) as opened:
        return opened.convert("RGB")


def scaled_box(box: Box, picture: Keyframe, size: tuple[int, int]) -> Box:
    """Return a box of the original frame in pixels of a picture of `size`, cut to its edges.

    The store may hold a smaller picture than the frame that the detector saw.
    """
    across, down = size[0] / picture.width, size[1] / picture.height
    x1, y1, x2, y2 = box
    return (
        min(max(x1 * across, 0.0), size[0]),
        min(max(y1 * down, 0.0), size[1]),
        min(max(x2 * across, 0.0), size[0]),
        min(max(y2 * down, 0.0), size[1]),
    )


def boxed_png(picture: Keyframe, box: Box | None, label: str) -> bytes:
    """Return the picture as PNG with the box and its label, bright on dark so it shows on any."""
    from PIL import ImageDraw, ImageFont

    image = decode(picture)
    if box is not None:
        draw = ImageDraw.Draw(image)
        edge = scaled_box(box, picture, image.size)
        thick = max(2, image.width // 320)
        draw.rectangle(edge, outline=_SHADOW, width=thick + 2)
        draw.rectangle(edge, outline=_EDGE, width=thick)
        height = max(12, image.width // 50)
        font = ImageFont.load_default(size=height)
        words = clean(label)
        left, top = edge[0], max(0.0, edge[1] - height - 2 * thick)
        draw.rectangle(draw.textbbox((left, top), words, font=font), fill=_SHADOW)
        draw.text((left, top), words, font=font, fill=_EDGE)
    written = io.BytesIO()
    image.save(written, "PNG")
    return written.getvalue()


def file_stem(keyframe: RankedKeyframe) -> str:
    """Return a file name for a keyframe: rank, category and time in letters any system takes."""
    word = re.sub(r"[^a-z0-9]+", "-", keyframe.category.lower()).strip("-")[:40] or "object"
    return f"{keyframe.rank:02d}-{word}-{keyframe.end:%Y%m%d-%H%M%S}"


def write_pictures(store: Store, keyframes: Sequence[RankedKeyframe], folder: Path) -> list[Path]:
    """Write the picture of each keyframe that has one into `folder`, and return the files.

    A picture that is missing or damaged is left out; OSError where the folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for keyframe in keyframes:
        picture = None if keyframe.image is None else store.keyframe(keyframe.image)
        if picture is None:
            continue
        try:
            png = boxed_png(picture, keyframe.box, keyframe.category)
        except OSError:  # a damaged picture; the caller counts what is missing
            continue
        path = folder / f"{file_stem(keyframe)}.png"
        path.write_bytes(png)
        written.append(path)
    return written
