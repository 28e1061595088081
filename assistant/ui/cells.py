"""Pictures as character cells, in numpy: quadrant blocks in colour, or letters by brightness.

A cell is twice as high as wide. A quadrant cell shows 2 x 2 pixels with two colours, so it splits
the four into the two groups that lose least. The box is drawn after the resize, on whole cells,
in box characters: drawn into the picture it would blend away, and colour alone is not enough.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from d3a.model import Box

Pixels = NDArray[np.uint8]
Region = tuple[float, float, float, float]
Rectangle = tuple[int, int, int, int]
"""left, top, right, bottom in cells, the last two included."""

CELL_ASPECT = 0.5  # width over height of a cell
_QUADRANTS = np.array(list(" ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█"))  # bit 0 upper left, 1 upper right, 2, 3 below
_RAMP = np.array(list(" .:-=+*#%@"))
_BOX = {"unicode": "┏━┓┃┗┛", "ascii": "+-+|++"}
BOX_INK = (255, 215, 0)
BOX_PAPER = (0, 0, 0)
_STEP = 8  # colours are rounded to this: fewer bytes down a slow line, and nobody sees it


@dataclass(frozen=True, slots=True)
class Cells:
    """A picture in cells: glyphs (h, w), ink and paper colours (h, w, 3), RGB."""

    glyphs: NDArray[np.str_]
    ink: Pixels
    paper: Pixels

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.glyphs.shape[1], self.glyphs.shape[0]


def fit(region: Region, columns: int, rows: int) -> tuple[int, int]:
    """Return the columns and rows that show `region` undistorted within the space given."""
    width, height = max(region[2] - region[0], 1e-6), max(region[3] - region[1], 1e-6)
    aspect = width / height / CELL_ASPECT  # columns per row
    if columns / rows > aspect:
        return max(1, min(columns, round(rows * aspect))), rows
    return columns, max(1, min(rows, round(columns / aspect)))


def crop_around(box: Box, size: tuple[int, int], columns: int, rows: int) -> Region:
    """Return the part of a picture to show for a box: the box with as much again around it.

    The part has the shape of the space in cells where the picture is large enough, lies wholly
    inside of the picture, and holds the box. box, size and the result are in pixels.
    """
    x1, y1, x2, y2 = box
    aspect = columns / rows * CELL_ASPECT
    least = min(64.0, *size)  # a distant thing needs its surroundings to be recognised
    width = max((x2 - x1) * 2.0, least)
    height = max((y2 - y1) * 2.0, least)
    width, height = max(width, height * aspect), max(height, width / aspect)
    width, height = min(width, size[0]), min(height, size[1])
    left = min(max((x1 + x2 - width) / 2, 0.0), size[0] - width)
    top = min(max((y1 + y2 - height) / 2, 0.0), size[1] - height)
    return left, top, left + width, top + height


def render(
    image: Image.Image, region: Region, columns: int, rows: int, *, ascii_only: bool = False
) -> Cells:
    """Return `region` of an RGB picture in at most columns x rows cells, its shape kept."""
    across, down = fit(region, columns, rows)
    per_cell = 1 if ascii_only else 2
    small = image.resize(
        (across * per_cell, down * per_cell), Image.Resampling.BOX, box=region, reducing_gap=2.0
    )
    pixels = np.asarray(small, dtype=np.uint8)
    return letters(pixels) if ascii_only else quadrants(pixels)


def quadrants(pixels: Pixels) -> Cells:
    """Return (2h, 2w, 3) pixels as (h, w) quadrant cells, each split where it loses least."""
    height, width = pixels.shape[0] // 2, pixels.shape[1] // 2
    four = pixels.reshape(height, 2, width, 2, 3).transpose(0, 2, 1, 3, 4)
    four = four.reshape(height * width, 4, 3).astype(np.float32)
    splits = (np.arange(8)[:, None] >> np.arange(4)) & 1  # lower right always paper: 8 splits
    ink_share = splits / np.maximum(splits.sum(axis=1, keepdims=True), 1)
    paper_share = (1 - splits) / (1 - splits).sum(axis=1, keepdims=True)
    ink = np.einsum("sp,npc->nsc", ink_share, four)
    paper = np.einsum("sp,npc->nsc", paper_share, four)
    # Minimal squared error is maximal energy of the means, the pixels' own being fixed.
    energy = (ink**2).sum(axis=2) * splits.sum(axis=1)
    energy += (paper**2).sum(axis=2) * (1 - splits).sum(axis=1)
    best = energy.argmax(axis=1)
    rows = np.arange(len(best))
    ink = np.where((best > 0)[:, None], ink[rows, best], paper[rows, best])
    return Cells(
        _QUADRANTS[best].reshape(height, width),
        _rounded(ink).reshape(height, width, 3),
        _rounded(paper[rows, best]).reshape(height, width, 3),
    )


def letters(pixels: Pixels) -> Cells:
    """Return (h, w, 3) pixels as (h, w) letters, the denser the brighter: no colour needed."""
    grey = pixels.astype(np.float32) @ np.array([0.299, 0.587, 0.114], dtype=np.float32)
    low, high = float(grey.min()), float(grey.max())
    level = (grey - low) / max(high - low, 1.0) * (len(_RAMP) - 1)
    ink = np.full(pixels.shape, 220, dtype=np.uint8)
    return Cells(_RAMP[np.rint(level).astype(np.intp)], ink, np.zeros_like(ink))


def box_cells(box: Box, region: Region, cells: tuple[int, int]) -> Rectangle | None:
    """Return the cells for a box's edge, None where the box lies outside of `region`.

    The edge runs just outside of the box, so that it covers nothing of the thing, and at the
    rim of the picture where the box reaches it.
    """
    if box[2] <= region[0] or box[0] >= region[2] or box[3] <= region[1] or box[1] >= region[3]:
        return None
    across = cells[0] / (region[2] - region[0])
    down = cells[1] / (region[3] - region[1])
    left, right = _span((box[0] - region[0]) * across, (box[2] - region[0]) * across, cells[0])
    top, bottom = _span((box[1] - region[1]) * down, (box[3] - region[1]) * down, cells[1])
    return left, top, right, bottom


def _span(start: float, end: float, cells: int) -> tuple[int, int]:
    """Return the cells before and after an extent, kept inside."""
    first = min(max(math.floor(start) - 1, 0), cells - 1)
    last = max(min(math.ceil(end), cells - 1), 0)
    return first, max(first, last)


def with_box(cells: Cells, edge: Rectangle, label: str, *, ascii_only: bool = False) -> Cells:
    """Return the cells with a box drawn over them, its label on the upper edge where it fits."""
    glyphs, ink, paper = cells.glyphs.copy(), cells.ink.copy(), cells.paper.copy()
    left, top, right, bottom = edge
    corner = _BOX["ascii" if ascii_only else "unicode"]
    glyphs[[top, bottom], left : right + 1] = corner[1]
    glyphs[top : bottom + 1, left] = corner[3]
    glyphs[top : bottom + 1, right] = corner[3]
    glyphs[top, left], glyphs[top, right] = corner[0], corner[2]
    glyphs[bottom, left], glyphs[bottom, right] = corner[4], corner[5]
    drawn = np.zeros(glyphs.shape, dtype=bool)
    drawn[[top, bottom], left : right + 1] = True
    drawn[top : bottom + 1, [left, right]] = True
    words = f" {label} "
    if label.isascii() and len(label) > 0 and len(words) <= right - left - 1:
        glyphs[top, left + 1 : left + 1 + len(words)] = list(words)
    ink[drawn], paper[drawn] = BOX_INK, BOX_PAPER
    return Cells(glyphs, ink, paper)


def _rounded(colours: NDArray[np.floating]) -> Pixels:
    return np.asarray(np.clip(np.rint(colours / _STEP) * _STEP, 0, 255), dtype=np.uint8)
