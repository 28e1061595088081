"""Whether the four numbers of COCO boxes are a corner and a size, or two corners.

The format says the former, and many files hold the latter. A box that cannot be in its picture
under one reading is evidence for the other; without evidence it is asked, never guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

from d3a import images
from d3a.model import BadInput, Json
from d3a.readers import boxes, parsing

SLACK_PX = 1.5
"""A box may stand out of its picture by this much, from rounding."""
CLEARLY = 10
"""The reading is taken that at least so many times fewer boxes speak against."""
MOST_OPENED = 200
"""So many pictures are looked into for their size, where the list does not say it."""


class Sized(Protocol):
    """An image of the list."""

    @property
    def size(self) -> tuple[int, int] | None:
        """Return width and height, None where the list has none."""
        ...


SizedImage = TypeVar("SizedImage", bound=Sized)


@dataclass(frozen=True, slots=True)
class Told:
    """The layout, and how it was told."""

    layout: str
    notes: tuple[str, ...]


def layout_of(
    records: Iterable[Json],
    listed: Mapping[str, SizedImage],
    picture: Callable[[SizedImage], Path | None],
    file: str,
) -> Told:
    """Return which of xywh and xyxy the boxes are; BadInput that asks where they may be both."""
    sizes: dict[str, tuple[int, int] | None] = {}
    count = not_corners = not_size = 0
    for record in records:
        try:
            a, b, c, d = parsing.numbers(record.get("bbox"), 4, "the bbox")
        except BadInput:
            continue  # it is counted where it is read
        key = str(record.get("image_id"))
        if key in listed and key not in sizes:
            may_open = len(sizes) < MOST_OPENED
            sizes[key] = listed[key].size or (_opened(picture, listed[key]) if may_open else None)
        width, height = sizes.get(key) or (float("inf"), float("inf"))
        if a < -SLACK_PX or b < -SLACK_PX or a >= width or b >= height or c <= 0 or d <= 0:
            continue  # broken under both readings
        count += 1
        not_corners += c <= a or d <= b or c > width + SLACK_PX or d > height + SLACK_PX
        not_size += a + c > width + SLACK_PX or b + d > height + SLACK_PX
    if count == 0:
        return Told("xywh", ())
    if not_corners > CLEARLY * not_size:
        return Told("xywh", ())
    if not_size > CLEARLY * not_corners:
        said = f"boxes are read as two corners: {not_size} of {count} would leave their picture"
        return Told("xyxy", (f"{said} as x, y, width, height",))
    if not any(sizes.values()):
        raise boxes.ask_for_layout(f"{file} (nothing tells the size of a picture either)")
    raise boxes.ask_for_layout(
        f"{file} may hold either: {not_size} of {count} boxes speak against x, y, width, height "
        f"and {not_corners} against two corners; it"
    )


def _opened(picture: Callable[[Any], Path | None], image: Sized) -> tuple[int, int] | None:
    try:
        path = picture(image)
        return None if path is None else images.size(path)
    except (BadInput, ValueError):
        return None
