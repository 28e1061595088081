"""The ranked keyframes, and the questions to start from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual.message import Message
from textual.widgets import OptionList

from assistant.terminal import clean, shorten, width_of
from assistant.wording import keyframe_row, place_words, short_time

if TYPE_CHECKING:
    from datetime import datetime

    from textual.events import Key, Resize

    from d3a.answer import RankedKeyframe

_LIMITS = (16, 18, 36, 11, 15)
"""The widest a column may be: what, when, where, how sure, how often."""

_WHAT, _WHEN, _PLACE, _SEEN = 0, 1, 2, 4
"""Which of the columns is which."""

_SHORTEST = {_PLACE: 12, _WHAT: 8}
"""The least that a column is shortened to, in cells, before another is left out for it."""


def rows(keyframes: Sequence[RankedKeyframe], now: datetime, width: int) -> list[str]:
    """Return a line for each keyframe, its columns aligned, in at most `width` cells.

    The category is told only where there is more than one. Where they do not fit, the views
    become a number, then places and days are told in fewer words, then places and categories are
    shortened, and only then do columns go from the right: time and place stay longest.
    """
    table = [keyframe_row(keyframe, now) for keyframe in keyframes]
    first = 0 if len({row[_WHAT] for row in table}) > 1 else 1
    kept = list(range(first, 5))
    briefer: tuple[tuple[int, Callable[[RankedKeyframe], str]], ...] = (
        (_SEEN, lambda k: f"{k.seen}x"),
        (_PLACE, lambda k: clean(place_words(k, brief=True))),
        (_WHEN, lambda k: short_time(k.last, now, brief=True)),
    )
    for column, told in briefer:
        if sum(_widths(table, kept)) > _room(kept, width):
            table = [
                (*row[:column], told(k), *row[column + 1 :])
                for k, row in zip(keyframes, table, strict=True)
            ]
    gap, room = "  ", width
    if sum(_least(table, kept)) == _room(kept, room) + 1:  # a cell is all that is missing
        gap, room = " ", width + 1
    while len(kept) > 2 and sum(_least(table, kept)) > _room(kept, room):
        kept.pop()
    widths = _fitted(table, kept, room)
    lines = []
    for keyframe, row in zip(keyframes, table, strict=True):
        cells = [shorten(row[i], w) for i, w in zip(kept, widths, strict=True)]
        padded = [cell + " " * (w - width_of(cell)) for cell, w in zip(cells, widths, strict=True)]
        lines.append(shorten(f"{keyframe.rank:>2}{gap}" + "  ".join(padded).rstrip(), width))
    return lines


def _widths(table: Sequence[tuple[str, ...]], kept: Sequence[int]) -> list[int]:
    return [min(_LIMITS[i], max((width_of(row[i]) for row in table), default=0)) for i in kept]


def _least(table: Sequence[tuple[str, ...]], kept: Sequence[int]) -> list[int]:
    """Return how wide the columns are when those are shortened that can be."""
    widths = zip(kept, _widths(table, kept), strict=True)
    return [min(width, _SHORTEST.get(i, width)) for i, width in widths]


def _fitted(table: Sequence[tuple[str, ...]], kept: Sequence[int], width: int) -> list[int]:
    """Return the widths of the columns, shortened as far as they must be: places first."""
    widths, least = _widths(table, kept), _least(table, kept)
    for column in _SHORTEST:
        over = sum(widths) - _room(kept, width)
        if column in kept and over > 0:
            at = kept.index(column)
            widths[at] = max(widths[at] - over, least[at])
    return widths


def _room(kept: Sequence[int], width: int) -> int:
    """Return the cells that are left for the columns beside the number and the gaps."""
    return width - 4 - 2 * (len(kept) - 1)


class MarkedList(OptionList):
    """A list whose highlighted row bears a `>`: meaning is never by colour alone."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002  textual's word
        super().__init__(markup=False, compact=True, id=id)
        self._rows_said: list[str] = []
        self._marked: int | None = None

    def set_lines(self, lines: Sequence[str], highlighted: int | None) -> None:
        """Show these rows, one of them highlighted."""
        self._rows_said = list(lines)
        self._marked = None
        self.set_options([f"  {line}" for line in lines])
        self.highlighted = highlighted if lines else None

    @property
    def lines_shown(self) -> list[str]:
        """The rows as they stand there."""
        return [str(option.prompt) for option in self.options]

    def watch_highlighted(self, highlighted: int | None) -> None:
        """Move the mark along."""
        super().watch_highlighted(highlighted)
        for index, mark in ((self._marked, " "), (highlighted, ">")):
            if index is not None and index < min(len(self._rows_said), self.option_count):
                self.replace_option_prompt_at_index(index, f"{mark} {self._rows_said[index]}")
        self._marked = highlighted

    def action_page_up(self) -> None:
        """Move up by a page; textual's own fails where a tiny window has left no room."""
        if self.size.area:
            super().action_page_up()  # type: ignore[no-untyped-call]  # textual has no type there

    def action_page_down(self) -> None:
        """Move down by a page."""
        if self.size.area:
            super().action_page_down()  # type: ignore[no-untyped-call]

    def on_key(self, event: Key) -> None:
        """Let 1 to 9 choose a row."""
        if event.character and event.character in "123456789":
            index = int(event.character) - 1
            if index < self.option_count:
                self.highlighted = index
                event.stop()
                event.prevent_default()


class KeyframeList(MarkedList):
    """The keyframes of an answer, best first: shows data, posts `Chosen`, asks no store."""

    @dataclass
    class Chosen(Message):
        """A row was highlighted: its picture is wanted."""

        keyframe: RankedKeyframe

    @dataclass
    class Opened(Message):
        """A row was entered: its whole picture is wanted."""

        keyframe: RankedKeyframe

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002  textual's word
        super().__init__(id=id)
        self._keyframes: Sequence[RankedKeyframe] = ()
        self._now: datetime | None = None
        self._width = 0

    def show_keyframes(
        self, keyframes: Sequence[RankedKeyframe], now: datetime, at: int = 0
    ) -> None:
        """Show these, the one with the index `at` highlighted."""
        self._keyframes, self._now = keyframes, now
        self._lay_out(at)

    def on_resize(self, event: Resize) -> None:
        """Align the columns for the new width."""
        if self.size.width != self._width:
            self._lay_out(self.highlighted)

    def _lay_out(self, highlighted: int | None) -> None:
        self._width = self.size.width
        if self._now is not None:
            bar = 0 if self.show_vertical_scrollbar else self.styles.scrollbar_size_vertical
            width = max(self.scrollable_content_region.width - 2 - bar, 20)  # a bar may yet come
            self.set_lines(rows(self._keyframes, self._now, width), highlighted)

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Pass on which keyframe it is."""
        event.stop()
        if event.option_index < len(self._keyframes):
            self.post_message(self.Chosen(self._keyframes[event.option_index]))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Pass on which keyframe it is."""
        event.stop()
        if event.option_index < len(self._keyframes):
            self.post_message(self.Opened(self._keyframes[event.option_index]))


class QuestionList(MarkedList):
    """Questions to take: the first screen's, or what an answer suggests. Posts `Taken`."""

    @dataclass
    class Taken(Message):
        """A question was chosen."""

        question: str

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002  textual's word
        super().__init__(id=id)
        self._questions: Sequence[str] = ()

    def show_questions(self, questions: Sequence[str]) -> None:
        """Show these, numbered."""
        self._questions = questions
        lines = [f"{i:>2}  {clean(q)}" for i, q in enumerate(questions, 1)]
        self.set_lines(lines, 0 if self.has_focus else None)

    def on_focus(self) -> None:
        """Mark the first: Enter takes it from now on."""
        if self.highlighted is None and self.option_count:
            self.highlighted = 0

    def on_blur(self) -> None:
        """Mark none: Enter in the question line takes what is typed there."""
        self.highlighted = None

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Pass on which question it is."""
        event.stop()
        self.post_message(self.Taken(self._questions[event.option_index]))

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Nothing is asked before Enter."""
        event.stop()
