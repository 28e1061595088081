"""Pictures as cells: nothing distorted, the box on whole cells, the crop inside of the picture."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from assistant.ui.cells import (
    BOX_INK,
    Cells,
    box_cells,
    crop_around,
    fit,
    letters,
    quadrants,
    render,
    with_box,
)

GLYPH_PARTS = dict(zip(" ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█", range(16), strict=True))
SIDE = st.integers(1, 120)
FRACTION = st.floats(0, 1)


def shown(cells: Cells) -> np.ndarray:
    """Return what a terminal would draw: (2h, 2w, 3)."""
    height, width = cells.glyphs.shape
    pixels = np.zeros((2 * height, 2 * width, 3), dtype=np.uint8)
    for y in range(height):
        for x in range(width):
            bits = GLYPH_PARTS[cells.glyphs[y, x]]
            for part in range(4):
                colour = cells.ink[y, x] if bits >> part & 1 else cells.paper[y, x]
                pixels[2 * y + part // 2, 2 * x + part % 2] = colour
    return pixels


def test_two_colours_in_a_cell_are_shown_exactly() -> None:
    rng = np.random.default_rng(5)
    two = np.array([[16, 160, 240], [248, 48, 8]], dtype=np.uint8)
    pixels = two[rng.integers(0, 2, (12, 20))]
    np.testing.assert_array_equal(shown(quadrants(pixels)), pixels)


def test_four_colours_in_a_cell_lose_least() -> None:
    pixels = np.array([[[0, 0, 0], [8, 8, 8]], [[240, 240, 240], [248, 248, 248]]], np.uint8)
    drawn = shown(quadrants(pixels)).astype(int)
    assert np.abs(drawn - pixels).max() <= 8  # dark above bright, not mixed


def test_letters_grow_denser_with_brightness() -> None:
    grey = np.repeat(np.linspace(0, 255, 10).astype(np.uint8)[None, :, None], 3, axis=2)
    row = letters(grey).glyphs[0]
    assert "".join(row) == " .:-=+*#%@"


@given(SIDE, SIDE, st.integers(1, 200), st.integers(1, 60))
def test_a_picture_keeps_its_shape(width: int, height: int, columns: int, rows: int) -> None:
    across, down = fit((0, 0, width, height), columns, rows)
    assert 1 <= across <= columns
    assert 1 <= down <= rows
    assert across == columns or down == rows  # all of the space in one direction
    ideal = width / height * 2
    # The other direction is rounded to a whole cell, and at least one.
    assert abs(across - down * ideal) <= max(ideal, 1) or 1 in (across, down)


@given(
    st.tuples(FRACTION, FRACTION, FRACTION, FRACTION),
    st.tuples(st.integers(8, 2000), st.integers(8, 2000)),
    st.integers(2, 200),
    st.integers(2, 60),
)
def test_a_crop_lies_inside_and_holds_the_box(
    corners: tuple[float, float, float, float], size: tuple[int, int], columns: int, rows: int
) -> None:
    x1, x2 = sorted((corners[0] * size[0], corners[2] * size[0]))
    y1, y2 = sorted((corners[1] * size[1], corners[3] * size[1]))
    left, top, right, bottom = crop_around((x1, y1, x2, y2), size, columns, rows)
    slack = 1e-6
    assert -slack <= left <= x1 + slack
    assert x2 - slack <= right <= size[0] + slack
    assert -slack <= top <= y1 + slack
    assert y2 - slack <= bottom <= size[1] + slack
    assert right > left
    assert bottom > top


@pytest.mark.parametrize("ascii_only", [False, True])
def test_the_box_is_drawn_on_whole_cells(ascii_only: bool) -> None:
    image = Image.new("RGB", (320, 180), (128, 128, 128))
    cells = render(image, (0, 0, 320, 180), 64, 18, ascii_only=ascii_only)
    edge = box_cells((80, 60, 160, 120), (0, 0, 320, 180), cells.size)
    assert edge == (15, 5, 32, 12)
    drawn = with_box(cells, edge, "keys", ascii_only=ascii_only)
    rows = ["".join(row) for row in drawn.glyphs]
    corners = "++++" if ascii_only else "┏┓┗┛"
    assert rows[5][15] + rows[5][32] + rows[12][15] + rows[12][32] == corners
    assert " keys " in rows[5]
    assert tuple(drawn.ink[8, 15]) == BOX_INK
    np.testing.assert_array_equal(drawn.ink[6:12, 16:32], cells.ink[6:12, 16:32])  # uncovered
    assert "keys" not in "".join(map("".join, cells.glyphs))  # the picture itself is untouched


def test_a_speck_still_gets_a_box() -> None:
    assert box_cells((319, 179, 320, 180), (0, 0, 320, 180), (64, 18)) == (62, 16, 63, 17)
    assert box_cells((100, 100, 101, 101), (0, 0, 320, 180), (64, 18)) == (19, 9, 21, 11)
    assert box_cells((400, 0, 410, 10), (0, 0, 320, 180), (64, 18)) is None
    assert box_cells((0, 0, 1, 1), (0, 0, 320, 180), (2, 1)) == (0, 0, 1, 0)
    assert box_cells((-50, -50, 900, 900), (0, 0, 320, 180), (64, 18)) == (0, 0, 63, 17)


def test_a_label_that_does_not_fit_is_left_out() -> None:
    cells = letters(np.zeros((6, 12, 3), np.uint8))
    drawn = with_box(cells, (1, 1, 6, 4), "refrigerator")
    assert "".join(drawn.glyphs[1]).strip() == "┏━━━━┓"
