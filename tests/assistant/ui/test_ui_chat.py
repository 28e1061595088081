"""The chat by its keys: a pilot test each, over a fixed home with canned answers."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from textual.command import CommandList, CommandPalette
from textual.events import Key, Paste
from textual.widgets import Static

from assistant.history import History
from assistant.reasons import why_text
from assistant.ui.app import ChatApp
from assistant.ui.floor import marks_of
from assistant.ui.lists import KeyframeList, QuestionList
from assistant.ui.panels import FloorView
from assistant.ui.picture import PictureView
from assistant.ui.sheets import FloorSheet, LargeSheet, PictureSheet, Sheet
from d3a.answer import Answer
from d3a.plan import plan
from d3a.store.base import Keyframe, StoreUnreachable
from grammar import parse
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.running_chat import QUESTION, Chat, chat


async def test_the_first_screen_offers_questions_that_have_answers() -> None:
    async with chat() as c:
        assert "Ask me where things were." in c.said()
        assert "kitchen" in c.said()
        questions = c.app.chat.query_one(QuestionList).lines_shown
        assert questions[0] == "   1  Where are the keys?"  # Enter does not take it from here
        assert any("together" in question for question in questions)
        assert c.prompt().has_focus
        await c.pilot.press("down")
        assert c.app.chat.query_one(QuestionList).lines_shown[0].startswith(">  1")
        await c.pilot.press("2", "enter")
        await c.until(lambda: "together" in c.said())
        assert len(c.rows()) == 3


@pytest.mark.parametrize("part", ["#header", "#exchange", "#questions", "#prompt", "#floor"])
async def test_what_comes_while_the_screen_goes_is_not_shown(part: str) -> None:
    """A screen that is left goes part by part, while threads still tell what they found."""
    async with chat() as c:
        screen, world = c.app.chat, c.app._world
        await screen.query_one(part).remove()
        screen.show_world(world)
        screen.show_welcome()
        screen.show_earlier(["where are my keys?"])
        screen.show_looking("where are my keys?")


async def test_a_question_goes_before_the_search_for_examples() -> None:
    store = OracleStore()
    small_home.fill(store)
    tried: list[str] = []
    goes_on = threading.Event()

    def slowly(text: str) -> Answer:
        tried.append(text)
        goes_on.wait(10.0)
        return Answer(text=text, status="not_found")  # so that the next is tried as well

    app = ChatApp(replace(small_home.session(store), alone=slowly))
    async with app.run_test(size=(80, 24)) as pilot:
        c = Chat(app, pilot)
        await c.until(lambda: bool(tried))
        assert "memory up to" in str(app.chat.query_one("#header", Static).content)
        await c.type(QUESTION)
        await c.until(lambda: app._asked == 1)
        goes_on.set()
        await c.until(lambda: "On the kitchen table." in c.said())
    assert [text for text in tried if text != "where is it?"] == tried[:1]


async def test_enter_asks_and_shows_sentence_list_picture_and_map() -> None:
    async with chat() as c:
        await c.ask()
        assert "On the kitchen table." in c.said()
        assert "2 more below." in c.said()
        assert [row[:5] for row in c.rows()] == [">  1 ", "   2 ", "   3 "]
        await c.until(lambda: "┏" in c.picture())
        assert " keys " in c.picture()
        assert [mark.rank for mark in c.app.chat.query_one(FloorView).keyframes] == [1, 2, 3]
        assert c.prompt().has_focus
        assert c.prompt().value == ""


async def test_digits_and_arrows_choose_a_keyframe() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("down")  # from the question line to the list
        assert c.app.chat.query_one(KeyframeList).has_focus
        await c.pilot.press("3")
        await c.until(lambda: c.app.chat.shot is not None and c.app.chat.shot.keyframe.rank == 3)
        assert c.rows()[2].startswith(">  3")
        assert c.rows()[0].startswith("   1")
        await c.pilot.press("up")
        await c.until(lambda: c.app.chat.shot is not None and c.app.chat.shot.keyframe.rank == 2)


async def test_typing_in_the_list_goes_on_in_the_question_line() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("down", "w", "h")
        assert c.prompt().has_focus
        assert c.prompt().value == "wh"


async def test_enter_on_a_row_opens_the_whole_picture_and_closes_it() -> None:
    async with chat() as c:
        await c.ask()
        await c.until(lambda: bool(c.picture()))
        await c.pilot.press("down", "enter")
        sheet = c.app.screen
        assert isinstance(sheet, PictureSheet)
        view = sheet.query_one(PictureView)
        await c.until(lambda: "┏" in view.text)
        await c.pilot.press("down")
        await c.until(lambda: view.shot is not None and view.shot.keyframe.rank == 2)
        whole = view.whole
        await c.pilot.press("c")
        assert (whole, view.whole) == (True, False)
        await c.pilot.press("enter")
        assert c.app.screen is c.app.chat
        assert c.rows()[1].startswith(">  2")


@pytest.mark.parametrize(
    ("key", "word", "sheet"),
    [
        ("f1", "/help", Sheet),
        ("f2", "/picture", PictureSheet),
        ("f3", "/map", FloorSheet),
        ("f5", "/large", LargeSheet),
        ("f7", "/why", Sheet),
    ],
)
async def test_each_key_opens_its_sheet_and_escape_leaves_it(
    key: str, word: str, sheet: type
) -> None:
    async with chat() as c:
        await c.ask()
        await c.until(lambda: c.app.chat.shot is not None)
        for press in ([key], None):  # by the key, then by the word
            if press:
                await c.pilot.press(*press)
            else:
                await c.type(word)
            await c.until(lambda: isinstance(c.app.screen, sheet))
            await c.pilot.press("escape")
            assert c.app.screen is c.app.chat


@pytest.mark.parametrize("key", ["f1", "f3", "f5", "f7"])
async def test_what_is_typed_over_a_sheet_goes_to_the_question_line(key: str) -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press(key, "space", "w", "h", "y")
        assert c.app.screen is c.app.chat
        assert c.prompt().value == "why"
        await c.pilot.press(key, "q")  # the key that closes it is not typed
        assert c.app.screen is c.app.chat
        assert c.prompt().value == "why"
        await c.pilot.press(key)
        c.app.screen.post_message(Paste("is it\nhere?"))
        await c.until(lambda: c.prompt().value == "whyis it here?")
        assert c.app.screen is c.app.chat


async def test_a_burst_of_keys_over_a_sheet_leaves_it_once() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("f1")
        sheet = c.app.screen
        for letter in ("w", "h", "y", " ", "q"):  # all of them before the first was read
            name = {" ": "space"}.get(letter, letter)
            sheet.post_message(Key(name, letter))
        await c.until(lambda: c.prompt().value == "why q")
        await c.pilot.press("f7")
        why = c.app.screen
        assert isinstance(why, Sheet)
        for _ in range(2):
            why.action_dismiss_sheet()
        await c.until(lambda: c.app.screen is c.app.chat)
        c.prompt().clear()
        await c.ask("where is my mug")


async def test_the_number_of_an_example_asks_it() -> None:
    async with chat() as c:
        await c.type("2")
        await c.until(lambda: "together" in c.said())
        assert len(c.rows()) == 3
        await c.type("2")  # from now on it is a row
        await c.until(lambda: "You: 2" in c.said())


async def test_a_question_typed_before_the_chat_stood_there_is_asked() -> None:
    async with chat() as c:
        await c.type(QUESTION, enter=False)
        await c.pilot.press("ctrl+j")  # Enter, as the shell's terminal passed it on
        await c.until(lambda: "On the kitchen table." in c.said())


async def test_a_word_that_is_no_command_is_told_where_answers_are() -> None:
    async with chat() as c:
        await c.ask()
        await c.type("/hlep")
        await c.until(lambda: "There is no /hlep. Did you mean /help?" in c.said())
        assert "/box" in c.said()
        assert len(c.rows()) == 3
        assert not list(c.app._notifications)


@pytest.mark.parametrize(
    ("said", "sheet"),
    [("What can you do?", Sheet), ("Could you make it bigger, please?", LargeSheet)],
)
async def test_a_command_may_be_said_in_other_words(said: str, sheet: type) -> None:
    async with chat() as c:
        await c.ask()
        await c.type(said)
        await c.until(lambda: isinstance(c.app.screen, sheet))


async def test_a_long_question_leaves_room_for_its_answer() -> None:
    async with chat() as c:
        long = "where are my keys? " * 40
        await c.type(long)
        await c.until(lambda: "On the kitchen table." in c.said())
        shown = c.said().partition("\n")[0]
        assert shown.startswith("You: where are my keys?")
        assert shown.endswith("…")
        assert len(shown) <= 3 * 78
        await c.pilot.press("up")  # whole, for the next one
        assert c.prompt().value == long.strip()


async def test_a_long_answer_has_more_room_and_then_a_bar() -> None:
    def told(text: str) -> Answer:
        words = " ".join(["In the kitchen I saw a cup and a bowl."] * int(text.split()[-1]))
        return replace(small_home.found(text), answer=words)

    async with chat(small_home.session(OracleStore(), told)) as c:
        pane = c.app.chat.query_one("#exchange-pane")
        await c.ask("rooms 16")  # eight rows of 78, and its question
        await c.until(lambda: pane.size.height >= 9)
        assert not pane.show_vertical_scrollbar
        assert c.app.chat.query_one(KeyframeList).size.height >= 3
        await c.ask("rooms 60")
        await c.until(lambda: pane.show_vertical_scrollbar)
        assert pane.size.height == 11
        await c.ask("rooms 1")
        await c.until(lambda: pane.size.height == 2)


async def test_the_question_line_says_how_to_go_on() -> None:
    async with chat() as c:
        assert c.prompt().placeholder == "type a question, then Enter"
        await c.ask()
        assert "not this one" in c.prompt().placeholder
        await c.ask("where is my wallet")
        assert c.prompt().placeholder == "type a question, then Enter"


async def test_a_small_window_shows_the_examples_too() -> None:
    async with chat(size=(40, 10)) as c:
        questions = c.app.chat.query_one(QuestionList)
        await c.until(lambda: questions.size.height > 2)
        assert "Ask me where things were." in c.said()
        await c.pilot.resize_terminal(80, 24)
        await c.until(lambda: "kitchen" in c.said())  # there is room for the words again


async def test_a_wide_window_shows_places_whole() -> None:
    rows = [replace(small_home.keyframe(rank), near="coffee table") for rank in (1, 2, 3)]
    long = [replace(row, place="living room") for row in rows]
    found = replace(small_home.found("where"), keyframes=tuple(long))
    session = small_home.session(OracleStore(), lambda text: replace(found, text=text))
    async with chat(session, size=(200, 60)) as c:
        await c.ask()
        await c.until(lambda: "living room, by the coffee table" in c.rows()[0])


async def test_why_shows_the_formal_query_the_score_and_the_plan() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("f7")

        def text() -> str:
            return str(c.app.screen.query_one("#sheet-text", Static).content)

        await c.until(lambda: "find [keys]" in text())
        for part in ("keys(x) | STc.find", "Q3", "attributes brass 0.50", "0.70 (fairly sure)"):
            assert part in text()
        assert "query   " not in text()  # the formal query stands above, once


def test_why_says_parts_and_steps_in_plain_words() -> None:
    row = replace(small_home.found("where").keyframes[0], why={"refused": ["blue", "big"]})
    query = parse("where was my red cup before noon?", now=small_home.NOW)
    explained = "\n".join(["plan", *plan(query).lines()])
    text = why_text(Answer(query=query), row, explained)
    assert "refused    blue, big" in text
    assert "find objects x, category cup, word cup, owner me" in text
    assert "judge attributes x, attributes red" in text
    assert not any(sign in text.partition("plan")[2] for sign in "[]'=")


@pytest.mark.parametrize("key", ["f2", "f5", "f6", "f7", "f8"])
async def test_a_key_without_an_answer_says_so(key: str) -> None:
    async with chat() as c:
        await c.pilot.press(key)
        await c.pilot.pause()
        assert c.app.screen is c.app.chat
        [notice] = c.app._notifications
        assert "ask a question first" in notice.message


async def test_save_writes_a_card_json_and_a_png_with_the_box(tmp_path: Path) -> None:
    async with chat(saves=tmp_path / "saved") as c:
        await c.ask()
        await c.until(lambda: c.app.chat.shot is not None)
        await c.pilot.press("f6")
        [notice] = c.app._notifications
        assert notice.message == f"Saved 3 files in {tmp_path / 'saved'}"
        await c.pilot.press("f6")  # a second time overwrites nothing
        await c.pilot.press("f1")
        await c.pilot.pause()
        assert not list(c.app._notifications)  # none hides the help
    files = sorted(path.name for path in (tmp_path / "saved").iterdir())
    assert files == [
        "where-are-my-keys-01-keys-20260301-094200-2.png",
        "where-are-my-keys-01-keys-20260301-094200.png",
        "where-are-my-keys-2.json",
        "where-are-my-keys-2.md",
        "where-are-my-keys.json",
        "where-are-my-keys.md",
    ]
    record = json.loads((tmp_path / "saved" / files[4]).read_text())
    card = (tmp_path / "saved" / files[5]).read_text()
    assert card.startswith("# On the kitchen table. I last saw them today at 9:42")
    assert f"({files[1]})" in card
    assert "| 2 | keys | 8:15 today | hall, by the door | not sure | seen 3 times |" in card
    assert record["keyframes"][0]["frame"] == "000000"
    with Image.open(tmp_path / "saved" / files[1]) as image:
        assert image.size == (small_home.WIDTH, small_home.HEIGHT)
        assert image.getpixel((61, 120)) == (255, 215, 0)  # the box's left edge


async def test_a_folder_that_cannot_be_written_is_a_message(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    async with chat(saves=blocked / "saved") as c:
        await c.ask()
        await c.pilot.press("f6")
        [notice] = c.app._notifications
        assert "cannot be written" in notice.message


async def test_copy_takes_the_answer_and_its_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("f8")
        lines = c.app.clipboard.splitlines()
        assert lines[0].startswith("On the kitchen table.")
        assert lines[1] == "1  keys, 9:42 today, kitchen, by the table, fairly sure, seen 14 times"
        assert len(lines) == 4


async def test_up_and_down_walk_through_earlier_questions(tmp_path: Path) -> None:
    history = History(tmp_path / "history.jsonl")
    history.add("where is the bowl?")
    async with chat(history=history) as c:
        await c.ask()
        await c.type("where is", enter=False)
        await c.pilot.press("up")
        assert c.prompt().value == QUESTION
        await c.pilot.press("up", "up")  # there is nothing before the first
        assert c.prompt().value == "where is the bowl?"
        await c.pilot.press("down", "down")
        assert c.prompt().value == "where is"
        c.prompt().clear()
        await c.type("/forget")
        await c.type("/forget")
        await c.until(lambda: not c.prompt().known.earlier)
    assert not (tmp_path / "history.jsonl").exists()


async def test_right_takes_the_suggestion() -> None:
    async with chat() as c:
        await c.pilot.press(*"did you see the bo")
        await c.until(lambda: c.prompt()._suggestion != "")
        await c.pilot.press("right")
        assert c.prompt().value == "did you see the bowl"


async def test_pasted_lines_become_one() -> None:
    from textual.events import Paste

    async with chat() as c:
        c.prompt().post_message(Paste("where are\r\n  my\tkeys\x1b[31m?\n"))
        await c.until(lambda: c.prompt().value == "where are my keys[31m?")


async def test_tab_reaches_the_list() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("tab")
        assert c.app.chat.query_one(KeyframeList).has_focus
        await c.pilot.press("tab")
        assert c.prompt().has_focus


async def test_page_up_shows_what_was_said_earlier() -> None:
    async with chat() as c:
        await c.ask()
        await c.ask("where was the cup yesterday?")
        await c.pilot.press("pageup")
        text = str(c.app.screen.query_one("#sheet-text", Static).content)
        assert f"You: {QUESTION}" in text
        assert "yesterday" not in text


async def test_an_unknown_word_offers_what_is_known() -> None:
    async with chat() as c:
        await c.ask("where is my wallet?")
        assert "Did you mean" in c.said()
        assert not c.app.chat.query_one("#sight").display
        await c.pilot.press("down", "2", "enter")
        await c.until(lambda: "You: Where are the keys?" in c.said())
        assert len(c.rows()) == 3


async def test_a_no_shows_the_nearest_true_sighting() -> None:
    async with chat() as c:
        await c.ask("where were my keys yesterday?")
        assert "Below: the nearest that I did see." in c.said()
        [row] = c.rows()
        assert "17:00 Fri" in row
        await c.until(lambda: "┏" in c.picture())


async def test_a_plain_no_has_no_picture_of_the_answer_before() -> None:
    async with chat() as c:
        await c.ask()
        await c.until(lambda: "┏" in c.picture())
        await c.ask("did you never see it?")
        await c.until(lambda: c.app.chat.shot is None)
        assert c.rows() == []


async def test_a_late_answer_never_replaces_a_newer_one() -> None:
    store = OracleStore()
    small_home.fill(store)
    release = threading.Event()

    def slowly(text: str) -> Answer:
        if "slow" in text:
            release.wait(5)
        return small_home.answer(text)

    async with chat(small_home.session(store, slowly)) as c:
        await c.type("slow question")
        await c.until(lambda: "Looking" in c.said())  # says so after 300 ms
        await c.type("quick question")
        release.set()
        await c.until(lambda: "You: quick question" in c.said())
        await c.pilot.pause(0.1)
        assert "You: quick question" in c.said()
        assert "You: slow question" in c.app.chat.earlier  # late, and not lost


async def test_what_was_done_is_told_though_something_newer_was_asked() -> None:
    store = OracleStore()
    small_home.fill(store)
    release = threading.Event()

    def slowly(text: str) -> Answer:
        if "box" not in text:
            return small_home.answer(text)
        release.wait(5)
        return Answer(text=text, status="found", answer="I see the box.")

    async with chat(small_home.session(store, slowly)) as c:
        await c.type("/box 1 2 3 4")
        await c.until(lambda: "Looking" in c.said())
        await c.type(QUESTION)
        release.set()
        await c.until(lambda: f"You: {QUESTION}" in c.said())
        assert "I see the box." in c.app.chat.earlier
        assert [notice.message for notice in c.app._notifications] == ["I see the box."]


async def test_escape_stops_a_question() -> None:
    store = OracleStore()
    small_home.fill(store)
    release = threading.Event()

    def slowly(text: str) -> Answer:
        if text == "slow":
            release.wait(5)
        return small_home.answer(text)

    async with chat(small_home.session(store, slowly)) as c:
        await c.type("slow")
        await c.until(lambda: "Looking" in c.said())
        await c.pilot.press("escape")
        assert "Stopped." in c.said()
        release.set()
        await c.pilot.pause(0.1)
        assert "Stopped." in c.said()
        await c.ask()


async def test_a_failing_store_is_an_answer_and_the_chat_goes_on() -> None:
    store = OracleStore()
    small_home.fill(store)
    lost = [True]

    def ask(text: str) -> Answer:
        if lost[0]:
            raise StoreUnreachable("mongodb://robot: no answer within 5 s")
        return small_home.answer(text)

    async with chat(small_home.session(store, ask)) as c:
        await c.ask()
        assert "I cannot reach my memory just now" in c.said()
        assert "no answer within 5 s" in c.said()
        lost[0] = False
        await c.ask()
        assert "On the kitchen table." in c.said()


async def test_a_programming_error_is_an_answer_that_names_it() -> None:
    store = OracleStore()
    small_home.fill(store)

    def ask(text: str) -> Answer:
        raise ZeroDivisionError("float division")

    broken = small_home.session(store, ask, explain=ask, suggestions=(QUESTION,))
    async with chat(broken) as c:
        await c.ask()
        assert "ZeroDivisionError: float division" in c.said()
        await c.pilot.press("f7")
        sheet = c.app.screen.query_one("#sheet-text", Static)
        await c.until(lambda: "\nZeroDivisionError" in str(sheet.content))


class NoPictures(OracleStore):
    """A store whose pictures cannot be had."""

    def keyframe(self, key: str) -> Keyframe | None:
        raise StoreUnreachable("the server went away")


async def test_a_picture_that_cannot_be_fetched_is_a_message() -> None:
    store = NoPictures()
    small_home.fill(store)
    async with chat(small_home.session(store)) as c:
        await c.ask()
        await c.until(lambda: "no picture is stored" in c.picture())
        assert any("went away" in notice.message for notice in c.app._notifications)


class CutPictures(OracleStore):
    """A store whose pictures were cut in half."""

    def keyframe(self, key: str) -> Keyframe | None:
        whole = super().keyframe(key)
        assert whole is not None
        return Keyframe(key, whole.jpeg[: len(whole.jpeg) // 2], whole.width, whole.height, 0)


async def test_a_damaged_picture_is_a_note() -> None:
    store = CutPictures()
    small_home.fill(store)
    async with chat(small_home.session(store)) as c:
        await c.ask()
        await c.until(lambda: "cannot be read" in c.picture())


async def test_an_empty_memory_says_how_to_fill_it() -> None:
    async with chat(small_home.session(OracleStore())) as c:
        assert "I have seen nothing yet." in c.said()
        assert "d3a ingest" in c.said()


async def test_names_are_data_and_never_markup_or_escapes() -> None:
    async with chat() as c:
        await c.type("where is the mug [/] \u202e?")
        await c.until(lambda: "You: where is the mug [/] ?" in c.said())
        await c.until(lambda: bool(c.picture()))
        await c.pilot.press("f2")
        await c.pilot.press("escape", "f3", "escape", "f7", "escape", "f5", "escape", "f8")
        shown = c.said() + "".join(c.rows()) + c.picture() + c.app.clipboard
        assert "mug [red]" in shown  # markup stands there as it was said
        assert not {"\x1b", "\u202e"} & set(shown)


@pytest.mark.parametrize(
    ("size", "displayed"),
    [
        ((160, 50), {"exchange", "keyframes", "sight", "crop-pane", "timeline", "earlier"}),
        ((110, 30), {"exchange", "keyframes", "sight", "crop-pane", "timeline", "earlier"}),
        ((109, 40), {"exchange", "keyframes", "sight"}),
        ((80, 24), {"exchange", "keyframes", "sight"}),
        ((60, 16), {"exchange", "keyframes", "sight"}),
        ((59, 24), {"exchange", "keyframes"}),
        ((80, 15), {"exchange", "keyframes"}),
        ((40, 10), {"exchange", "keyframes"}),
        ((39, 24), {"too-small"}),
        ((80, 9), {"too-small"}),
        ((8, 3), {"too-small"}),
    ],
)
async def test_every_size_of_window_has_its_layout(
    size: tuple[int, int], displayed: set[str]
) -> None:
    parts = ("exchange", "keyframes", "sight", "crop-pane", "timeline", "earlier", "too-small")
    async with chat(size=size) as c:
        c.app.ask(QUESTION)
        await c.until(lambda: "You:" in c.said())
        await c.pilot.pause(0.1)
        shown = {part for part in parts if c.app.chat.query_one(f"#{part}").region.area > 0}
        assert shown == displayed
        lines = c.app.chat.query_one("#ask")
        if "too-small" not in displayed:
            assert lines.region.bottom == size[1] - 1  # the question line is never pushed out


async def test_resizing_changes_the_layout_at_once() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.resize_terminal(160, 50)
        await c.until(lambda: c.app.chat.query_one("#picture", PictureView).whole)
        await c.pilot.resize_terminal(30, 8)
        await c.until(lambda: c.app.chat.query_one("#too-small").display)
        await c.pilot.resize_terminal(80, 24)
        await c.until(lambda: not c.app.chat.query_one("#picture", PictureView).whole)
        await c.until(lambda: "┏" in c.picture())


async def test_the_palette_names_every_command_and_takes_early_keys() -> None:
    async with chat() as c:
        await c.ask()
        c.app.action_command_palette()
        await c.until(lambda: isinstance(c.app.screen, CommandPalette))
        c.app.screen.query_one(CommandList).styles.max_height = 0  # as while it opens
        await c.pilot.press("pagedown", "pageup")
        c.app.screen.query_one(CommandList).styles.max_height = 20
        await c.pilot.press(*"large")
        await c.until(lambda: c.app.screen.query_one(CommandList).option_count == 1)
        await c.pilot.press("enter")
        await c.until(lambda: isinstance(c.app.screen, LargeSheet))


async def test_a_list_without_room_takes_its_keys() -> None:
    async with chat() as c:
        await c.ask()
        await c.pilot.press("down")
        await c.pilot.resize_terminal(8, 3)
        await c.pilot.press("pageup", "pagedown", "down", "end", "2")
        await c.pilot.resize_terminal(80, 24)
        await c.until(lambda: len(c.rows()) == 3)


async def test_why_and_quit_need_no_slash() -> None:
    async with chat() as c:
        await c.ask()
        await c.type("why?")
        await c.until(lambda: isinstance(c.app.screen, Sheet))
        await c.pilot.press("escape")
        await c.type("/box")  # without its edges it is no question about boxes
        await c.until(lambda: "LEFT TOP" in c.said())
        await c.type("quit")
        await c.until(lambda: not c.app.is_running)


async def test_the_large_map_names_the_place_of_each_number() -> None:
    async with chat(size=(80, 24)) as c:
        await c.ask()
        await c.pilot.press("f3")
        await c.pilot.pause()
        words = str(c.app.screen.query_one("#floor-words", Static).content).splitlines()
        marked = [mark.label for mark in marks_of(c.app.chat.keyframes)]
        assert [line.split()[0] for line in words] == marked


async def test_a_map_that_has_no_room_says_where_it_is() -> None:
    async with chat(size=(60, 16)) as c:
        await c.ask()
        floor = c.app.chat.query_one(FloorView)
        floor.styles.height = 3
        await c.until(lambda: floor.size.height == 3)
        assert str(floor.render()) == "Map: F3"
    async with chat(small_home.session(OracleStore()), size=(80, 24)) as c:
        assert "no positions" in str(c.app.chat.query_one(FloorView).render())


async def test_questions_are_wiped_when_it_is_said_twice() -> None:
    async with chat() as c:
        await c.ask()
        await c.type("/forget")
        await c.pilot.pause()
        [notice] = c.app._notifications
        assert "/forget again" in notice.message
        assert c.prompt().known.earlier == (QUESTION,)
        await c.ask("where is the bowl?")  # something else: it was not meant
        await c.type("/forget")
        await c.pilot.pause()
        assert len(c.prompt().known.earlier) == 2
        await c.type("/forget")
        await c.until(lambda: c.prompt().known.earlier == ())


async def test_an_answer_without_rows_has_no_empty_picture() -> None:
    async with chat(size=(160, 50)) as c:
        await c.ask()
        assert c.app.chat.query_one("#left").display
        await c.ask("where is my wallet")
        assert not c.app.chat.query_one("#left").display
        assert not c.app.chat.query_one("#crop-pane").display


async def test_ascii_pictures_need_no_block_characters() -> None:
    async with chat(pictures="ascii") as c:
        await c.ask()
        await c.until(lambda: "+--" in c.picture() or "+ keys" in c.picture())
        assert c.picture().isascii()


async def test_pictures_can_be_off() -> None:
    async with chat(pictures="off") as c:
        await c.ask()
        await c.until(lambda: c.picture() == "pictures are off")


async def test_what_comes_while_the_chat_is_left_is_dropped() -> None:
    async with chat() as c:
        await c.ask()
        await c.until(lambda: c.app.chat.shot is not None)
        shot, world = c.app.chat.shot, c.app._world
        assert shot is not None
        await c.app.chat.query_one("#body").remove()  # as textual does, one part after the other
        c.app.chat.show_shot(shot)
        c.app.chat.show_answer(small_home.found("late"), world)
        c.app.chat.show_world(world)
        c.app.chat.show_welcome()
        c.app.chat.step(1)
        await c.pilot.resize_terminal(100, 30)
        await c.pilot.press("ctrl+q")
        await c.until(lambda: not c.app.is_running)
    assert c.app.screen_stack == []
    c.app._chosen = shot.keyframe
    c.app.on_chat_app_fetched(c.app.Fetched(shot))


async def test_quit() -> None:
    async with chat() as c:
        await c.type("/quit")
        await c.until(lambda: not c.app.is_running)
