"""The picture of a keyframe, its box drawn in: the crop around the box, or the whole picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual import work
from textual.message import Message
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from assistant.drawing import decode, scaled_box
from assistant.protocols import PIXELS, Kind
from assistant.terminal import clean, width_of
from assistant.ui.cells import Cells, box_cells, crop_around, render, with_box
from assistant.wording import place_words, short_time

if TYPE_CHECKING:
    from datetime import datetime

    from PIL.Image import Image
    from textual.app import ComposeResult, RenderResult
    from textual.events import Resize
    from textual.timer import Timer

    from d3a.answer import RankedKeyframe
    from d3a.store.base import Keyframe

SETTLE_S = 0.03
"""A layout settles in several steps; a picture sent at each is 2 MB at the start of a chat."""


@dataclass(frozen=True, slots=True)
class Shot:
    """What a picture widget shows: a keyframe of an answer and its stored picture.

    picture: None where the store holds none.
    """

    keyframe: RankedKeyframe
    picture: Keyframe | None


def caption(shot: Shot | None, count: int, now: datetime, *, whole: bool, width: int) -> str:
    """Return the line above a picture, in at most `width` cells where the short form fits."""
    if shot is None:
        return ""
    keyframe = shot.keyframe
    view = "whole picture" if whole else "crop; Enter: whole"
    where = clean(f"{keyframe.category}, {place_words(keyframe)}")
    words = (
        f"Picture {keyframe.rank} of {count}  {where}, {short_time(keyframe.last, now)}  ({view})"
    )
    return words if width_of(words) <= width else f"Picture {keyframe.rank} of {count}  ({view})"


class PictureView(Widget):
    """A picture in cells or pixels. Data goes in by `shot`; the drawing is done in a thread.

    whole: show the whole picture instead of the part around the box.
    """

    DEFAULT_CSS = "PictureView { align: center middle; }"

    @dataclass
    class Drawn(Message):
        """A thread has drawn a picture; `number` tells a late one from the newest.

        pixels: the picture for a terminal that shows pixels, and the cells it takes.
        """

        view: PictureView
        number: int
        cells: Cells | None
        note: str
        pixels: tuple[Image, int, int] | None = None

    shot: reactive[Shot | None] = reactive(None, init=False)
    whole: reactive[bool] = reactive(False, init=False)

    def __init__(self, *, kind: Kind = "cells", whole: bool = False, id: str | None = None) -> None:  # noqa: A002  textual's word
        super().__init__(id=id)
        self._kind = kind
        self._strips: list[Strip] = []
        self._note = ""
        self._number = 0
        self._settling: Timer | None = None
        self.set_reactive(PictureView.whole, whole)

    def compose(self) -> ComposeResult:
        """Lay out what shows pixels, where the terminal does."""
        if self._kind in PIXELS:
            from assistant.ui import pixels

            child = pixels.widget(self._kind)
            child.display = False
            yield child

    @property
    def text(self) -> str:
        """What stands there, as text: for tests and for copying."""
        return "\n".join(strip.text for strip in self._strips) or self._note

    def frame_point(self, x: int, y: int) -> tuple[float, float] | None:
        """Return the frame's pixel under a cell of the whole picture, None beside it."""
        if not self._strips or self.shot is None or self.shot.picture is None or not self.whole:
            return None
        columns, rows = self._strips[0].cell_length, len(self._strips)
        left, top = (self.size.width - columns) // 2, (self.size.height - rows) // 2
        across = min(max((x - left + 0.5) / columns, 0.0), 1.0)
        down = min(max((y - top + 0.5) / rows, 0.0), 1.0)
        return across * self.shot.picture.width, down * self.shot.picture.height

    def watch_shot(self) -> None:
        """Draw the other picture."""
        self._redraw()

    def watch_whole(self) -> None:
        """Draw the other part."""
        self._redraw()

    def on_resize(self, event: Resize) -> None:
        """Draw for the new size, once it has settled."""
        self._redraw()

    def _redraw(self) -> None:
        if not self.is_attached:
            return
        if self._settling is not None:
            self._settling.stop()
        self._settling = self.set_timer(SETTLE_S, self._draw)

    def _draw(self) -> None:
        self._number += 1
        columns, rows = self.size
        shot = self.shot
        if shot is None or self._kind == "off" or min(columns, rows) < 2:
            off = "pictures are off" if shot is not None and self._kind == "off" else ""
            self._show(None, off)
            return
        self._draw_in_thread(self._number, shot, columns, rows, self.whole)

    @work(thread=True, group="picture")
    def _draw_in_thread(
        self, number: int, shot: Shot, columns: int, rows: int, whole: bool
    ) -> None:
        note = ""
        cells, pixels = None, None
        try:
            if self._kind in PIXELS:
                # A sixel that ends on the last row but one scrolls the screen: one is left free.
                spare = 1 if self._kind == "sixel" and rows > 2 else 0
                pixels = _in_pixels(shot, columns, rows - spare, whole=whole)
            else:
                cells = draw(shot, columns, rows, whole=whole, ascii_only=self._kind == "ascii")
            note = "" if cells or pixels else "no picture is stored for this keyframe"
        except (OSError, ValueError, SyntaxError) as error:  # what PIL raises for damaged bytes
            note = f"the stored picture cannot be read: {clean(str(error))}"
        self.post_message(self.Drawn(self, number, cells, note, pixels))

    def on_picture_view_drawn(self, message: Drawn) -> None:
        """Show what a thread has drawn, unless something newer was asked for since."""
        message.stop()
        if message.view is self and message.number == self._number:
            self._show(message.cells, message.note, message.pixels)

    def _show(
        self, cells: Cells | None, note: str, drawn: tuple[Image, int, int] | None = None
    ) -> None:
        self._strips = [] if cells is None else strips(cells)
        self._note = note
        if self._kind in PIXELS:
            from assistant.ui import pixels

            image, columns, rows = drawn or (None, 0, 0)
            self._strips = [Strip.blank(columns)] * rows  # what the pixels lie over
            for child in self.children:
                pixels.show(child, image, columns, rows)
        self.refresh()

    def render(self) -> RenderResult:
        """Return the note; rows of a picture come from `render_line`."""
        return ""

    def render_line(self, y: int) -> Strip:
        """Return a row of the picture, in the middle of the widget."""
        columns, rows = self.size
        style = self.rich_style
        if not self._strips:
            words = self._note if y == rows // 2 else ""
            return Strip([Segment(words[:columns], style)]).extend_cell_length(columns, style)
        row = y - (rows - len(self._strips)) // 2
        if not 0 <= row < len(self._strips):
            return Strip.blank(columns, style)
        strip = self._strips[row]
        left = max(0, (columns - strip.cell_length) // 2)
        padded = Strip([Segment(" " * left, style), *strip])
        return padded.extend_cell_length(columns, style).crop(0, columns)


def draw(
    shot: Shot, columns: int, rows: int, *, whole: bool, ascii_only: bool = False
) -> Cells | None:
    """Return the cells of a shot, None without a picture. Raises OSError for damaged bytes."""
    if shot.picture is None:
        return None
    image = decode(shot.picture)
    box = shot.keyframe.box
    region = (0.0, 0.0, float(image.width), float(image.height))
    if box is None:
        return render(image, region, columns, rows, ascii_only=ascii_only)
    edge = scaled_box(box, shot.picture, image.size)
    if not whole:
        region = crop_around(edge, image.size, columns, rows)
    cells = render(image, region, columns, rows, ascii_only=ascii_only)
    drawn = box_cells(edge, region, cells.size)
    if drawn is None:
        return cells
    return with_box(cells, drawn, clean(shot.keyframe.category), ascii_only=ascii_only)


def _in_pixels(
    shot: Shot, columns: int, rows: int, *, whole: bool
) -> tuple[Image, int, int] | None:
    from assistant.ui import pixels

    return pixels.draw(shot, columns, rows, whole=whole, cell=pixels.cell_size())


def strips(cells: Cells) -> list[Strip]:
    """Return the rows of a picture, neighbours of one colour joined in one segment."""
    styles: dict[bytes, Style] = {}
    rows = []
    for glyphs, ink, paper in zip(cells.glyphs, cells.ink, cells.paper, strict=True):
        segments: list[Segment] = []
        colours = [row.tobytes() for row in np.concatenate([ink, paper], axis=1)]
        start = 0
        for end in range(1, len(colours) + 1):
            if end == len(colours) or colours[end] != colours[start]:
                key = colours[start]
                style = styles.get(key)
                if style is None:
                    style = styles[key] = _style(key)
                segments.append(Segment("".join(glyphs[start:end]), style))
                start = end
        rows.append(Strip(segments, len(colours)))
    return rows


def _style(key: bytes) -> Style:
    return Style(color=Color.from_rgb(*key[:3]), bgcolor=Color.from_rgb(*key[3:]))
