"""A picture in the terminal's own pixels, by kitty's or sixel's protocol: the extra `images`.

`textual_image` asks the terminal while it is imported, and takes what comes late for nothing: it
lands in the question line. So it is imported without a terminal in sight, and told what
`assistant.protocols` has found out.
"""

from __future__ import annotations

import io
import os
import re
import sys
from typing import TYPE_CHECKING, Protocol, cast

from PIL import Image, ImageDraw
from rich.segment import Segment
from textual.strip import Strip

from assistant.drawing import decode, scaled_box
from assistant.protocols import USUAL_CELL, Cell, Kind
from assistant.ui.cells import BOX_INK, BOX_PAPER, Region, crop_around

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.geometry import Region as TextualRegion
    from textual.widget import Widget

    from assistant.ui.picture import Shot

_MOVE = re.compile(r"\x1b\[\d+;\d+H$")
_CELL_SIZE = ("TEXTUAL_CELL_WIDTH", "TEXTUAL_CELL_HEIGHT")


class PixelWidget(Protocol):
    """What both widgets of textual_image have: the picture they show."""

    image: Image.Image | None


def load(cell: Cell = USUAL_CELL) -> None:
    """Import textual_image, which is told the size of a cell and asks nobody."""
    kept = {name: os.environ.get(name) for name in _CELL_SIZE}
    stdout = sys.__stdout__
    os.environ.update(zip(_CELL_SIZE, map(str, cell), strict=True))
    vars(sys)["__stdout__"] = io.StringIO()  # no terminal, so it asks none
    try:
        import textual_image.widget  # noqa: F401  imported for later
    finally:
        vars(sys)["__stdout__"] = stdout
        for name, value in kept.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def cell_size() -> Cell:
    """Return the width and height of a cell that textual_image reckons with."""
    from textual_image._terminal import get_cell_size

    size = get_cell_size()
    return size.width, size.height


def widget(kind: Kind) -> Widget:
    """Return an empty widget that shows a picture in pixels."""
    load()
    from textual_image.widget import SixelImage, TGPImage

    if kind == "kitty":
        return TGPImage()
    shown = SixelImage()
    composed = shown.compose

    def compose() -> ComposeResult:
        for part in composed():
            yield _ending_in_its_last_row(part)

    shown.compose = compose  # type: ignore[method-assign]  # its class admits no heirs
    return shown


def _ending_in_its_last_row(part: Widget) -> Widget:
    """Return the widget, its last row ending with the cursor in that row.

    textual_image leaves it in the row below, so that what stands beside it is never drawn.
    """
    rendered = part.render_lines

    def render_lines(crop: TextualRegion) -> list[Strip]:
        lines = rendered(crop)
        segments = list(lines[-1]) if lines else []
        if segments:
            region = part.screen.find_widget(part).visible_region
            last = f"\x1b[{region.bottom};{region.right + 1}H"  # rows and columns count from 1
            segments[-1] = Segment(_MOVE.sub(last, segments[-1].text), segments[-1].style)
            lines[-1] = Strip(segments, crop.width)
        return lines

    part.render_lines = render_lines  # type: ignore[method-assign]  # of this one alone
    return part


def show(child: Widget, image: Image.Image | None, columns: int, rows: int) -> None:
    """Let the widget show a picture over so many cells; None for none."""
    child.display = image is not None
    if image is not None:
        child.styles.width, child.styles.height = columns, rows
    cast("PixelWidget", child).image = image


def draw(
    shot: Shot, columns: int, rows: int, *, whole: bool, cell: Cell
) -> tuple[Image.Image, int, int] | None:
    """Return the picture of a shot in pixels, its box drawn in, and the cells it takes.

    None without a picture. The box is drawn after the resize, so that it keeps its colour. Raises
    OSError for damaged bytes.
    """
    if shot.picture is None:
        return None
    image = decode(shot.picture)
    box = shot.keyframe.box
    region: Region = (0.0, 0.0, float(image.width), float(image.height))
    edge = None if box is None else scaled_box(box, shot.picture, image.size)
    if edge is not None and not whole:
        region = crop_around(edge, image.size, columns, rows)
    width, height = region[2] - region[0], region[3] - region[1]
    scale = min(columns * cell[0] / width, rows * cell[1] / height)
    across = min(max(round(width * scale / cell[0]), 1), columns)
    down = min(max(round(height * scale / cell[1]), 1), rows)
    size = (across * cell[0], down * cell[1])
    small = image.resize(size, Image.Resampling.LANCZOS, box=region)
    if edge is not None:
        x, y = size[0] / width, size[1] / height
        left, top = (edge[0] - region[0]) * x, (edge[1] - region[1]) * y
        right, bottom = (edge[2] - region[0]) * x, (edge[3] - region[1]) * y
        _draw_box(small, (left, top, right, bottom))
    return small, across, down


def _draw_box(image: Image.Image, edge: tuple[float, float, float, float]) -> None:
    """Draw a box: bright on dark, so that it shows on any picture."""
    thick = max(2, image.width // 160)
    drawing = ImageDraw.Draw(image)
    x1, y1, x2, y2 = edge
    last = (image.width - 1, image.height - 1)
    outer = (
        max(x1 - thick, 0),
        max(y1 - thick, 0),
        min(x2 + thick, last[0]),
        min(y2 + thick, last[1]),
    )
    drawing.rectangle(outer, outline=BOX_PAPER, width=thick + 2)
    drawing.rectangle(outer, outline=BOX_INK, width=thick)
