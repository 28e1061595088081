"""A box that a person draws on a picture, by keys or by mouse: in pixels of the original frame."""

from __future__ import annotations

from d3a.model import Box

STEPS = 40
"""A key moves or changes the box by this share of the picture's side."""
LEAST = 1 / STEPS


def first_box(size: tuple[int, int], near: Box | None) -> Box:
    """Return the box to begin with: that of the thing shown, else the middle of the picture."""
    width, height = size
    if near is not None:
        return within(near, size)
    return (width * 3 / 8, height * 3 / 8, width * 5 / 8, height * 5 / 8)


def moved(box: Box, across: int, down: int, size: tuple[int, int]) -> Box:
    """Return the box so many steps further, kept in the picture with its size."""
    width, height = size
    x1, y1, x2, y2 = box
    dx = min(max(across * width / STEPS, -x1), width - x2)
    dy = min(max(down * height / STEPS, -y1), height - y2)
    return (x1 + dx, y1 + dy, x2 + dx, y2 + dy)


def grown(box: Box, across: int, down: int, size: tuple[int, int]) -> Box:
    """Return the box with its right and lower edges so many steps further."""
    width, height = size
    x1, y1, x2, y2 = box
    right = min(max(x2 + across * width / STEPS, x1 + width * LEAST), width)
    below = min(max(y2 + down * height / STEPS, y1 + height * LEAST), height)
    return (min(x1, width * (1 - LEAST)), min(y1, height * (1 - LEAST)), right, below)


def spanned(a: tuple[float, float], b: tuple[float, float], size: tuple[int, int]) -> Box:
    """Return the box between two corners, at least a step wide and high."""
    width, height = size
    x1, x2 = sorted((a[0], b[0]))
    y1, y2 = sorted((a[1], b[1]))
    wide, high = (max(x2, x1 + width * LEAST), max(y2, y1 + height * LEAST))
    return within((x1, y1, wide, high), size)


def within(box: Box, size: tuple[int, int]) -> Box:
    """Return the part of a box in the picture."""
    width, height = size
    x1, y1, x2, y2 = box
    return (max(x1, 0.0), max(y1, 0.0), min(x2, float(width)), min(y2, float(height)))
