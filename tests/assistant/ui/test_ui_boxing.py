"""A box drawn on the picture by keys, by mouse, by its numbers; what is in it is said after."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assistant.conversation import Conversation
from assistant.ui.boxing import LEAST, STEPS, first_box, grown, moved, spanned
from assistant.ui.picture import PictureView
from assistant.ui.sheets import PictureSheet
from d3a.model import Box
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.running_chat import Chat, chat

SIZE = (small_home.WIDTH, small_home.HEIGHT)


def in_picture(box: Box) -> bool:
    x1, y1, x2, y2 = box
    return -1e-6 <= x1 < x2 <= SIZE[0] + 1e-6 and -1e-6 <= y1 < y2 <= SIZE[1] + 1e-6


@given(st.lists(st.tuples(st.booleans(), st.integers(-50, 50), st.integers(-50, 50)), max_size=20))
def test_no_keys_take_the_box_out_of_the_picture(
    steps: list[tuple[bool, int, int]],
) -> None:
    box = first_box(SIZE, None)
    for is_move, across, down in steps:
        box = (moved if is_move else grown)(box, across, down, SIZE)
        assert in_picture(box)


@given(*(st.tuples(st.floats(0, SIZE[0]), st.floats(0, SIZE[1])) for _ in range(2)))
def test_any_two_corners_span_a_box(a: tuple[float, float], b: tuple[float, float]) -> None:
    box = spanned(a, b, SIZE)
    assert box[0] <= min(a[0], b[0]) + 1e-6
    assert box[2] >= max(a[0], b[0]) - 1e-6
    assert LEAST == 1 / STEPS


async def opened(c: Chat) -> PictureSheet:
    await c.ask("where are my keys?")
    await c.until(lambda: "┏" in c.picture())
    await c.pilot.press("f2")
    await c.until(lambda: isinstance(c.app.screen, PictureSheet))
    sheet = c.app.screen
    assert isinstance(sheet, PictureSheet)
    await c.until(lambda: "┏" in sheet.query_one(PictureView).text)
    return sheet


def talk() -> tuple[OracleStore, Conversation]:
    store = OracleStore()
    small_home.fill(store)
    return store, Conversation(store, lambda: small_home.NOW)


@pytest.mark.parametrize("grow", ["shift+right", "d"])
async def test_keys_draw_and_enter_takes_it(grow: str) -> None:
    store, spoken = talk()
    session = small_home.session(store, spoken.ask, alone=spoken.alone, pointer=spoken.pointer)
    async with chat(session, size=(100, 30)) as c:
        sheet = await opened(c)
        view = sheet.query_one(PictureView)
        await c.pilot.press("b")
        await c.until(lambda: " new " in view.text)
        for _ in range(4):
            await c.pilot.press("left", "up")
        await c.pilot.press(grow, "s")
        shot = view.shot
        assert shot is not None
        drawn = shot.keyframe.box
        x1, y1, x2, y2 = small_home.BOX
        across, down = SIZE[0] / STEPS, SIZE[1] / STEPS
        assert drawn == pytest.approx(
            (x1 - 4 * across, y1 - 4 * down, x2 - 3 * across, y2 - 3 * down)
        )
        await c.pilot.press("enter")
        await c.until(lambda: "I see the box" in c.said())
        assert spoken.pointer.box == pytest.approx(drawn, abs=0.5)
        assert not sheet.is_attached


async def test_escape_leaves_the_box_then_the_sheet() -> None:
    async with chat(size=(100, 30)) as c:
        sheet = await opened(c)
        view = sheet.query_one(PictureView)
        await c.pilot.press("b", "down")
        await c.until(lambda: " new " in view.text)
        await c.pilot.press("escape")
        await c.until(lambda: " keys " in view.text)
        assert sheet.is_current
        await c.pilot.press("escape")
        assert not sheet.is_attached
        assert "box" not in c.said()


async def test_the_mouse_draws() -> None:
    store, spoken = talk()
    session = small_home.session(store, spoken.ask, alone=spoken.alone, pointer=spoken.pointer)
    async with chat(session, size=(100, 30)) as c:
        sheet = await opened(c)
        view = sheet.query_one(PictureView)
        await c.pilot.mouse_down(view, offset=(30, 10))
        await c.pilot.hover(view, offset=(50, 20))
        await c.pilot.mouse_up(view, offset=(50, 20))
        await c.until(lambda: " new " in view.text)
        start, end = view.frame_point(30, 10), view.frame_point(50, 20)
        assert view.shot is not None
        box = view.shot.keyframe.box
        assert box is not None
        assert start is not None
        assert end is not None
        assert (*start, *end) == pytest.approx(box)


async def test_a_box_by_its_numbers_and_what_is_in_it() -> None:
    store, spoken = talk()
    session = small_home.session(store, spoken.ask, alone=spoken.alone, pointer=spoken.pointer)
    async with chat(session) as c:
        await c.ask("where are my keys?")
        await c.until(lambda: c.app.chat.shot is not None)
        await c.type("/box 220 20 300 90")  # the blue poster on the wall, no detection
        await c.until(lambda: "I see the box" in c.said())
        await c.type("this is my poster")
        await c.until(lambda: "by the colours in the box" in c.said())
        await c.ask("where is my poster?")
        assert "It looks like it: I know it by its colours alone." in c.said()
        assert "box 220 20 300 90" not in c.prompt().known.earlier
        await c.type("/undo")
        await c.until(lambda: "no longer know what was in the box" in c.said())
        await c.ask("where is my poster?")
        assert c.app.chat.keyframes == ()
