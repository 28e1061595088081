"""Pictures in a terminal's own pixels: their shape kept, their box drawn after the resize."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from assistant.ui.cells import BOX_INK
from assistant.ui.picture import Shot
from assistant.ui.pixels import draw
from d3a.store.base import Keyframe
from tests.worlds import small_home

PICTURE = Keyframe(
    "p1", small_home.jpeg((210, 160, 30)), small_home.WIDTH, small_home.HEIGHT, 0
)  # 320 x 180
SHOT = Shot(small_home.keyframe(1), PICTURE)


@pytest.mark.parametrize(
    ("columns", "rows", "cell", "cells"),
    [
        (32, 20, (10, 20), (32, 9)),  # as wide as there is room
        (64, 9, (10, 20), (32, 9)),  # as high
        (40, 40, (9, 18), (40, 11)),
        (1, 1, (10, 20), (1, 1)),
    ],
)
def test_a_whole_picture_keeps_its_shape(
    columns: int, rows: int, cell: tuple[int, int], cells: tuple[int, int]
) -> None:
    drawn = draw(SHOT, columns, rows, whole=True, cell=cell)
    assert drawn is not None
    image, across, down = drawn
    assert (across, down) == cells
    assert image.size == (across * cell[0], down * cell[1])


def test_the_box_is_drawn_after_the_resize() -> None:
    drawn = draw(SHOT, 64, 18, whole=True, cell=(10, 20))
    assert drawn is not None
    image = drawn[0]
    x1, y1, _, y2 = (edge * image.width / small_home.WIDTH for edge in small_home.BOX)
    assert image.getpixel((round(x1) - 2, round((y1 + y2) / 2))) == BOX_INK
    inside = image.getpixel((round(x1) + 40, round((y1 + y2) / 2)))
    assert inside != BOX_INK


def test_the_crop_is_larger_than_the_whole() -> None:
    def box_width(*, whole: bool) -> int:
        drawn = draw(SHOT, 40, 20, whole=whole, cell=(10, 20))
        assert drawn is not None
        image = drawn[0]
        row = [image.getpixel((x, image.height // 2)) for x in range(image.width)]
        edges = [x for x, colour in enumerate(row) if colour == BOX_INK]
        return max(edges) - min(edges) if edges else 0

    assert box_width(whole=False) > 100


def test_no_picture_is_none_and_damage_is_raised() -> None:
    assert draw(Shot(small_home.keyframe(1), None), 10, 5, whole=True, cell=(10, 20)) is None
    cut = Keyframe("p1", PICTURE.jpeg[:200], 320, 180, 0)
    with pytest.raises((OSError, SyntaxError)):
        draw(Shot(small_home.keyframe(1), cut), 10, 5, whole=True, cell=(10, 20))


def test_the_library_is_imported_without_a_word_to_the_terminal() -> None:
    pytest.importorskip("textual_image")
    import pty

    master, slave = pty.openpty()
    code = (
        "import os, sys; from assistant.ui import pixels; pixels.load((7, 15));"
        "assert sys.__stdout__.isatty(); assert pixels.cell_size() == (7, 15);"
        "assert 'TEXTUAL_CELL_WIDTH' not in os.environ; print('done')"
    )
    root = Path(__file__).parents[3]
    subprocess.run(
        [sys.executable, "-c", code], stdin=slave, stdout=slave, stderr=slave, cwd=root, check=True
    )
    os.close(slave)
    try:
        assert os.read(master, 1024) == b"done\r\n"
    finally:
        os.close(master)
