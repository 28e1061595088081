"""The panels around an answer: its sentence, the map, the timeline."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC
from typing import TYPE_CHECKING

from rich.text import Text
from textual.reactive import reactive
from textual.widget import Widget

from assistant.terminal import clean, shorten
from assistant.ui.floor import Floor, draw_floor, is_drawable, marks_of
from assistant.wording import more_words, short_time, told

if TYPE_CHECKING:
    from datetime import datetime

    from textual.app import RenderResult

    from d3a.answer import Answer, RankedKeyframe


LONGEST_QUESTION = 200
"""The cells of a question that are shown: what was pasted must not push its answer away."""


def asked(question: str) -> Text:
    """Return the line of a question."""
    return Text(f"You: {shorten(clean(question), LONGEST_QUESTION)}\n", style="dim")


def exchange(answer: Answer) -> Text:
    """Return a question and its answer; what a person and a recording said stays plain text."""
    text = asked(answer.text)
    sentence, reason = told(answer)
    text.append(clean(sentence), style="not dim bold")
    more = more_words(answer) if answer.query is not None else ""
    if more:
        text.append(f" {more}", style="not dim")
    notes = [clean(reason)] if reason else []
    if answer.perhaps:
        notes.append("Below: what may be it, the likeliest first.")
    elif answer.otherwise is not None and not answer.keyframes:
        notes.append("Below: the nearest that I did see.")
    elif answer.status == "error" and answer.suggestions:
        notes.append("Ask it again (Down and Enter):")
    elif answer.suggestions and not answer.keyframes:
        notes.append("Did you mean (Down and Enter, or its number):")
    elif answer.suggestions:  # the list stays, so they stand here
        notes += [f"{i}  {clean(each)}" for i, each in enumerate(answer.suggestions, 1)]
        notes.append("Type yes, or no." if len(answer.suggestions) == 1 else "Type its number.")
    return text.append("".join(f"\n{note}" for note in notes), style="not dim")


NO_POSITIONS = "no map: this memory holds no positions"


class FloorView(Widget):
    """The map: rooms, the numbered places of the answer, the robot."""

    floor: reactive[Floor] = reactive(Floor())
    keyframes: reactive[tuple[RankedKeyframe, ...]] = reactive(())

    def render(self) -> RenderResult:
        """Return the map with its legend below, as far as there is room."""
        columns, rows = self.size
        marks = marks_of(self.keyframes)
        legend = legend_lines(self.floor, [mark.label for mark in marks], columns)
        lines = draw_floor(self.floor, marks, columns, max(rows - len(legend), 0))
        if not lines:
            drawable = is_drawable(self.floor, marks)
            words = self._where_instead() if drawable else NO_POSITIONS
            return Text(words, style="dim")
        return Text("\n".join([*lines, *legend][:rows]), no_wrap=True)

    def _where_instead(self) -> str:
        """Return what to do where the pane is too small: the key that shows the map large."""
        for each in self.screen.active_bindings.values():
            if each.binding.action == "map":
                return f"Map: {self.app.get_key_display(each.binding).capitalize()}"
        return "Please make the window larger."


def legend_lines(floor: Floor, labels: Sequence[str], columns: int) -> list[str]:
    """Return what the signs on the map mean."""
    words = []
    if labels:
        words.append(f"{labels[0]} best")
    if len(labels) > 1:
        words.append(f"{' '.join(labels[1:])} other places")
    if floor.robot is not None:
        words.append("R robot now")
    lines: list[str] = []
    for word in words:
        if lines and len(lines[-1]) + 2 + len(word) <= columns:
            lines[-1] += f"  {word}"
        else:
            lines.append(shorten(word, columns))
    return lines


class Timeline(Widget):
    """When: the answer's keyframes from the earliest to now, by their numbers."""

    keyframes: reactive[tuple[RankedKeyframe, ...]] = reactive(())
    now: reactive[datetime | None] = reactive(None)

    def render(self) -> RenderResult:
        """Return a line of numbers and a line that says where it begins and ends."""
        if self.now is None or not self.keyframes:
            return ""
        return Text("\n".join(timeline(self.keyframes, self.now, self.size.width)), no_wrap=True)


def timeline(keyframes: Sequence[RankedKeyframe], now: datetime, width: int) -> list[str]:
    """Return two lines: numbers on a scale of elapsed time, and its two ends in words."""
    first = min(keyframe.end for keyframe in keyframes).astimezone(UTC)
    span = max((now.astimezone(UTC) - first).total_seconds(), 1.0)
    line = ["·"] * width
    for keyframe in reversed(keyframes[:9]):  # the best is written last, over the others
        share = (keyframe.end.astimezone(UTC) - first).total_seconds() / span
        line[min(max(round(share * (width - 1)), 0), width - 1)] = str(keyframe.rank)
    start, end = short_time(first, now), f"now {now.hour}:{now.minute:02d}"
    return ["".join(line), start + end.rjust(max(width - len(start), len(end) + 1))]
