"""The rows of the ranked list: which columns stand in which width."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import pytest

from assistant.terminal import width_of
from assistant.ui.lists import KeyframeList, rows
from d3a.answer import RankedKeyframe
from tests.worlds.running_chat import chat

NOW = datetime(2026, 11, 20, 20, 0, tzinfo=UTC)

FIRST = RankedKeyframe(
    rank=1,
    score=0.9,
    object_id="a",
    category="key",
    frame="f",
    probability=0.9,
    box=None,
    start=NOW.replace(hour=18),
    end=NOW.replace(hour=19),
    place="living room",
    near="coffee table",
    seen=3,
)
BOTH = [
    FIRST,
    replace(FIRST, rank=2, place="hall", near="shelf", end=NOW.replace(day=19), seen=12),
]


@pytest.mark.parametrize("width", [52, 58, 60, 62, 76, 120])
def test_long_places_are_shortened_before_a_column_goes(width: int) -> None:
    lines = rows(BOTH, NOW, width)
    assert all(width_of(line) <= width for line in lines)
    assert all("fairly sure" in line or "guess" in line or "not sure" in line for line in lines)
    assert "3x" in lines[0] or "seen 3 times" in lines[0]
    assert "12x" in lines[1] or "seen 12 times" in lines[1]
    assert "living room" in lines[0]


def test_a_long_place_loses_its_small_words_first() -> None:
    """In the 60 cells of the wide chat's list, and whole where there is room."""
    first, second = rows(BOTH, NOW, 60)
    assert first == " 1  19:00 today  living room, coffee table  fairly sure  3x"
    assert second == " 2  20:00 Thu    hall, shelf                fairly sure  12x"
    assert "living room, by the coffee table  fairly sure  3x" in rows(BOTH, NOW, 76)[0]


@pytest.mark.parametrize("width", [57, 60, 76, 120])
def test_a_mixed_list_keeps_how_often_things_were_seen(width: int) -> None:
    """The list of the wide chat has 57 cells, however wide the window is."""
    mixed = [FIRST, replace(BOTH[1], category="washing machine"), replace(FIRST, rank=3)]
    lines = rows(mixed, NOW, width)
    assert all(width_of(line) <= width for line in lines)
    assert "12x" in lines[1] or "seen 12 times" in lines[1]
    assert "washing" in lines[1]
    assert all("fairly sure" in line for line in lines)


def test_a_window_of_fifty_columns_keeps_how_often_things_were_seen() -> None:
    """Its list has 45 cells; the numbers stand closer to make room."""
    lines = rows([FIRST, replace(BOTH[1], seen=5)], NOW, 45)
    assert lines[0] == " 1 19:00 today  living room…  fairly sure  3x"
    assert lines[1].endswith("5x")
    assert all(width_of(line) <= 45 for line in lines)


def test_in_a_narrow_list_time_and_place_stay() -> None:
    first, _ = rows(BOTH, NOW, 34)
    assert "19:00 today" in first
    assert "living" in first
    assert "3x" not in first


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_a_row_takes_one_line_where_the_list_scrolls(size: tuple[int, int]) -> None:
    long = replace(FIRST, near="coffee table with a very long name")
    many = [replace(long, rank=rank) for rank in range(1, 61)]
    async with chat(size=size) as c:
        await c.ask()
        shown = c.app.chat.query_one(KeyframeList)
        shown.show_keyframes(many, NOW)
        await c.until(lambda: shown.show_vertical_scrollbar)
        await c.pilot.pause()
        assert shown.virtual_size.height == len(many)
