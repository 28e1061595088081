"""The map, the timeline and the rows: text drawn from numbers, asserted as text."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta

from hypothesis import given
from hypothesis import strategies as st

from assistant.terminal import width_of
from assistant.ui.floor import Floor, Mark, draw_floor, marks_of, read_floor
from assistant.ui.lists import rows
from assistant.ui.panels import legend_lines, timeline
from d3a.store.base import Region
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

METRES = st.floats(-50, 50)


def home() -> Floor:
    store = OracleStore()
    small_home.fill(store)
    return read_floor(store)


def test_the_map_shows_rooms_names_numbers_and_the_robot() -> None:
    marks = marks_of(small_home.found("where").keyframes)
    assert draw_floor(home(), marks, 33, 11) == [
        "┌───────────────┬───────────────┐",
        "│               │               │",
        "│     hall      │               │",
        "│   2           │        3      │",
        "│               │               │",
        "├───────────────┤    kitchen    │",
        "│               │               │",
        "│               │       1       │",
        "│      lab  R   │               │",
        "│               │               │",
        "└───────────────┴───────────────┘",
    ]


def test_the_map_can_do_without_line_characters() -> None:
    lines = draw_floor(home(), (), 33, 11, ascii_only=True)
    assert "".join(lines).isascii()
    assert lines[0].startswith("+---")
    assert "kitchen" in "".join(lines)


def test_a_home_without_rooms_gets_a_frame_and_dots() -> None:
    floor = replace(home(), regions=())
    lines = draw_floor(floor, [Mark("1", (6.0, 1.5))], 30, 10)
    assert lines[0].startswith("┌")
    assert "·" in "".join(lines)
    assert "1" in "".join(lines)


def test_no_position_is_no_map() -> None:
    assert draw_floor(Floor(), (), 30, 10) == []


def test_a_place_is_numbered_once() -> None:
    best = small_home.keyframe(1)
    again = replace(best, rank=2, position=(6.2, 1.6, 0.8))
    assert [mark.label for mark in marks_of([best, again, small_home.keyframe(3)])] == ["1", "3"]
    assert marks_of([replace(best, position=None)]) == ()


def test_a_room_named_in_escapes_stays_inside_its_walls() -> None:
    room = Region("k\x1b[31mitchen of the long name", ((0, 0), (4, 0), (4, 4), (0, 4)))
    lines = draw_floor(Floor(regions=(room,)), (), 16, 8)
    assert "\x1b" not in "".join(lines)
    assert all(width_of(line) <= 16 for line in lines)


def rooms(*names: str) -> tuple[Region, ...]:
    """Rooms of 4 x 4 m side by side."""
    return tuple(
        Region(name, ((4 * i, 0), (4 * i + 4, 0), (4 * i + 4, 4), (4 * i, 4)))
        for i, name in enumerate(names)
    )


def test_a_map_that_cannot_hold_the_names_to_scale_takes_the_width() -> None:
    floor = Floor(regions=rooms("kitchen", "living room"), robot=(6, 2))
    marks = [Mark(str(i), (1 + i * 0.6, 3.5 - i * 0.8)) for i in range(1, 5)]
    lines = draw_floor(floor, marks, 34, 6)
    text = "\n".join(lines)
    assert "kitchen" in text
    assert "living room" in text
    assert max(map(len, lines)) == 34
    to_scale = draw_floor(Floor(regions=rooms("hall", "lab")), (), 34, 6)
    assert max(len(line.strip()) for line in to_scale) == 21


def test_numbers_in_one_cell_stand_side_by_side() -> None:
    marks = [Mark(str(i), (2 + i / 100, 2)) for i in range(1, 7)]
    floor = Floor(regions=rooms("kitchen", "hall"), robot=(2.05, 2))
    text = "\n".join(draw_floor(floor, marks, 26, 6))
    left = "\n".join(line[: len(line) // 2 + 1] for line in text.splitlines())
    assert all(left.count(label) == 1 for label in "123456R")  # none in the room next door


def test_a_name_stands_whole_where_a_sign_would_cut_it() -> None:
    low = Region("living room", ((4, 0), (8, 0), (8, 2), (4, 2)))
    floor = Floor(regions=(*rooms("kitchen"), low), robot=(6, 1))
    lines = draw_floor(floor, [Mark("1", (6.5, 1.2))], 28, 6)
    assert lines == [
        "┌─────────────┐",
        "│             │",
        "│   kitchen   ├────────────┐",
        "│             │living room │",
        "│             │     R 1    │",
        "└─────────────┴────────────┘",
    ]
    one_row = Region("living room", ((4, 0), (8, 0), (8, 1.6), (4, 1.6)))
    lines = draw_floor(replace(floor, regions=(*rooms("kitchen"), one_row)), [], 28, 6)
    assert lines[3:5] == ["│             ├─────R──────┐", "│             │living room │"]
    wide = draw_floor(floor, [Mark("1", (6.5, 1.2))], 40, 12)  # with room each keeps its place
    assert wide[7:10] == [
        "│                   │           1      │",
        "│                   │        R         │",
        "│                   │   living room    │",
    ]


def test_a_place_too_small_for_walls_keeps_its_name() -> None:
    desk = Region("desk", ((1, 1), (1.5, 1), (1.5, 1.5), (1, 1.5)))
    lines = draw_floor(Floor(regions=(*rooms("kitchen"), desk)), [Mark("2", (1.2, 1.2))], 24, 9)
    text = "\n".join(lines)
    assert "desk" in text
    assert "kitchen" in text
    assert "2" in text
    assert [text.count(corner) for corner in "┌┐└┘"] == [1, 1, 1, 1]


def test_a_spot_in_a_room_has_walls_where_its_name_fits_between_them() -> None:
    corners = ((1.0, 0.5), (3.0, 0.5), (3.0, 1.5), (1.0, 1.5))
    floor = Floor(regions=(*rooms("kitchen"), Region("workbench", corners)))
    small, large = (draw_floor(floor, (), *size) for size in ((24, 9), (60, 28)))
    for lines, walls in ((small, 1), (large, 2)):
        text = "\n".join(lines)
        assert "workbench" in text
        assert "kitchen" in text
        assert text.count("┌") == walls


@given(
    st.lists(st.tuples(METRES, METRES), max_size=6),
    st.lists(st.tuples(METRES, METRES), min_size=3, max_size=6),
    st.integers(0, 80),
    st.integers(0, 40),
)
def test_any_floor_fits_its_panel(
    places: list[tuple[float, float]],
    corners: list[tuple[float, float]],
    columns: int,
    height: int,
) -> None:
    floor = Floor((Region("room", tuple(corners)),), tuple(places), (0.0, 0.0))
    marks = [Mark(str(i), at) for i, at in enumerate(places, 1)]
    lines = draw_floor(floor, marks, columns, height)
    assert len(lines) <= height
    assert all(len(line) <= columns for line in lines)


def test_the_legend_breaks_where_it_does_not_fit() -> None:
    floor = Floor(robot=(0, 0))
    assert legend_lines(floor, ["1", "2"], 80) == ["1 best  2 other places  R robot now"]
    assert legend_lines(floor, ["1", "2"], 24) == ["1 best  2 other places", "R robot now"]


def test_the_timeline_is_to_scale() -> None:
    line, ends = timeline(small_home.found("where").keyframes, small_home.NOW, 51)
    assert (line[0], line[round(50 - 10.75)], line[round(50 - 9.3)]) == ("3", "2", "1")
    assert ends.startswith("17:00 Fri")
    assert ends.endswith("now 19:00")


def test_rows_give_up_columns_from_the_right() -> None:
    keyframes = small_home.found("where").keyframes
    wide = rows(keyframes, small_home.NOW, 78)
    assert wide[0] == " 1  9:42 today  kitchen, by the table  fairly sure  seen 14 times"
    assert rows(keyframes, small_home.NOW, 60)[0].endswith("fairly sure  14x")
    assert rows(keyframes, small_home.NOW, 44)[0] == " 1  9:42 today  kitchen, table  fairly sure"
    assert rows(keyframes, small_home.NOW, 30)[0] == " 1  9:42 today  kitchen, table"
    assert all(width_of(line) <= 20 for line in rows(keyframes, small_home.NOW, 20))


def test_rows_name_the_category_where_it_differs() -> None:
    keyframes = (small_home.keyframe(1), replace(small_home.keyframe(2), category="cup"))
    assert rows(keyframes, small_home.NOW, 90)[1].startswith(" 2  cup   8:15 today")


def test_times_are_said_by_the_calendar_of_the_home() -> None:
    late = small_home.NOW.replace(hour=0, minute=30)
    keyframe = replace(small_home.keyframe(1), end=late - timedelta(minutes=45))
    assert "23:45 yesterday" in rows((keyframe,), late, 90)[0]
