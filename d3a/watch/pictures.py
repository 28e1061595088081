"""Whether a picture that somebody writes is there to its end."""

from __future__ import annotations

from pathlib import Path

from d3a.images import is_cut
from d3a.model import Depth, Image


def is_whole(*pictures: Image | Depth | None) -> bool:
    """Say whether the pictures are there, and end where such files end."""
    return all(_is_whole(each) for each in pictures)


def _is_whole(picture: Image | Depth | None) -> bool:
    if not isinstance(picture, Path):
        return True
    try:
        content = picture.read_bytes()
    except OSError:
        return False
    return bool(content) and not is_cut(content)
