"""The lines of keys at the bottom: whole words, as many as the window has room for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.cells import cell_len
from textual.widgets import Footer, Static
from textual.widgets._footer import FooterKey

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.events import Resize

_FIRST = ("quit", "help", "picture", "map", "save", "why", "copy_answer", "large", "speak")
"""What is kept longest where there is no room for all: the way out, and the way to the rest."""


class KeyLine(Footer):
    """The keys that are shown; those that do not fit are left out, the least wanted first."""

    def __init__(self) -> None:
        super().__init__(show_command_palette=False, compact=True)

    def compose(self) -> ComposeResult:
        """Yield textual's keys, those hidden that do not fit."""
        children = list(super().compose())
        keys = [child for child in children if isinstance(child, FooterKey)]
        self._fit(keys, self.size.width or self.app.size.width)
        yield from children

    def on_resize(self, event: Resize) -> None:
        """Show as many keys as fit now."""
        self._fit(list(self.query(FooterKey)), event.size.width)

    @staticmethod
    def _fit(keys: list[FooterKey], width: int) -> None:
        left = width
        for key in sorted(keys, key=_place_of):
            needed = cell_len(key.key_display) + 1 + cell_len(key.description)
            key.display = needed <= left
            left -= needed + 1 if key.display else left  # what comes after is wanted less


def _place_of(key: FooterKey) -> int:
    return _FIRST.index(key.action) if key.action in _FIRST else len(_FIRST)


class SheetFoot(Static):
    """What the keys of a sheet do, the most wanted first; parted by three spaces."""

    _PARTED = "   "

    def __init__(self, words: str) -> None:
        super().__init__(markup=False)
        self._words = words

    def say(self, words: str) -> None:
        """Say these words, as far as whole ones fit."""
        self._words = words
        self._fit()

    def on_resize(self) -> None:
        """Say as much as fits now."""
        self._fit()

    def _fit(self) -> None:
        width, parts = self.content_size.width, self._words.split(self._PARTED)
        while len(parts) > 1 and cell_len(self._PARTED.join(parts)) > width:
            parts.pop()
        self.update(self._PARTED.join(parts))
