"""Teaching, pointing and choosing in the full-screen chat, over a real conversation."""

from __future__ import annotations

import asyncio
import threading

import pytest
from textual.command import CommandList, CommandPalette

from assistant.conversation import Conversation
from assistant.session import Session
from assistant.slashes import COMMANDS
from assistant.ui.lists import KeyframeList, QuestionList
from assistant.ui.panels import FloorView
from assistant.wording import told
from d3a.answer import Answer
from d3a.store.base import Batch, RecordingRecord, StoreUnreachable, TaughtName
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.running_chat import Chat, chat


def session_over(store: OracleStore) -> Session:
    talk = Conversation(store, lambda: small_home.NOW)
    return small_home.session(
        store, talk.ask, alone=talk.alone, explain=talk.explain, pointer=talk.pointer
    )


def filled(store: OracleStore | None = None) -> OracleStore:
    store = store or OracleStore()
    small_home.fill(store)
    return store


def names(store: OracleStore, object_id: str) -> tuple[TaughtName, ...]:
    return store.objects(ids=[object_id])[0].names


def mark(c: Chat) -> int | None:
    return c.app.chat.query_one(KeyframeList).highlighted


async def test_the_row_under_the_mark_is_what_these_are() -> None:
    store = filled()
    async with chat(session_over(store)) as c:
        await c.ask("what did you see today?")
        rows = c.app.chat.keyframes
        third = rows[2].object_id
        await c.pilot.press("down", "3")
        await c.until(lambda: c.app.chat.shot is not None and c.app.chat.shot.keyframe.rank == 3)
        await c.pilot.press("escape")
        await c.type("this is my favourite")
        await c.until(lambda: "I will remember" in c.said())
        assert [n.word for n in names(store, third)] == ["favourite"]
        assert mark(c) == 2  # the mark stays where it was
        await c.type("/undo")
        await c.until(lambda: "I have undone that" in c.said())
        assert names(store, third) == ()


async def test_the_mark_follows_what_was_said() -> None:
    async with chat(session_over(filled())) as c:
        await c.ask("what did you see today?")
        assert mark(c) == 0
        await c.type("the second one")
        await c.until(lambda: "You: the second one" in c.said())
        assert mark(c) == 1
        assert "more below" not in c.said()


async def test_a_choice_is_taken_by_its_number() -> None:
    async with chat(session_over(filled())) as c:
        await c.ask("where is the cup or the bowl?")
        shown = c.app.chat.query_one(QuestionList).lines_shown
        assert len(shown) == 2
        assert "or its number" in c.said()
        await c.type("2")
        await c.until(lambda: bool(c.app.chat.keyframes))
        assert c.app.chat.keyframes[0].category == "bowl"
        assert c.prompt().known.earlier == ("where is the cup or the bowl?",)


async def test_choices_beside_a_list_stand_in_the_answer() -> None:
    async with chat(session_over(filled())) as c:
        await c.ask("what did you see today?")
        await c.type("that is the same thing")
        await c.until(lambda: "The same as which?" in c.said())
        assert "1  Number 1 is the same as number 2" in c.said()
        await c.type("1")
        await c.until(lambda: "I will take number 1 and number 2" in c.said())


@pytest.mark.parametrize("word", ["wrong", "mine", "undo", "taught", "other"])
async def test_the_palette_says_what_may_be_typed(word: str) -> None:
    async with chat(session_over(filled())) as c:
        await c.ask("where are my keys?")
        before = c.said()
        c.app.action_command_palette()
        await c.until(lambda: isinstance(c.app.screen, CommandPalette))
        await c.pilot.press(*word)
        await c.until(lambda: c.app.screen.query_one(CommandList).option_count >= 1)
        await c.pilot.press("enter")
        await c.until(lambda: c.said() != before and "You:" in c.said())
        assert f"You: {COMMANDS[word].says}" in c.said()


class Leaving(OracleStore):
    """A store whose server goes away and comes back."""

    here = True

    def revision(self) -> tuple[int, int] | None:
        self._answer()
        return super().revision()

    def recordings(self) -> list[RecordingRecord]:
        self._answer()
        return super().recordings()

    def apply(self, batch: Batch) -> None:
        self._answer()
        super().apply(batch)

    def _answer(self) -> None:
        if not self.here:
            raise StoreUnreachable("mongodb://robot: no answer within 5 s")


async def test_a_lost_store_offers_to_ask_again() -> None:
    store = Leaving()
    filled(store)
    async with chat(session_over(store)) as c:
        await c.ask("where are my keys?")
        store.here = False
        await c.type("where is the bowl?")
        await c.until(lambda: "I cannot reach my memory" in c.said())
        assert "Ask it again" in c.said()
        store.here = True
        await c.pilot.press("down", "enter")
        await c.until(lambda: bool(c.app.chat.keyframes))
        assert c.app.chat.keyframes[0].category == "bowl"


async def test_again_asks_what_failed() -> None:
    store = Leaving()
    filled(store)
    talk = Conversation(store, lambda: small_home.NOW)
    store.here = False
    assert talk.ask("where is the bowl?").status == "error"
    store.here = True
    assert talk.ask("again").keyframes[0].category == "bowl"


async def test_a_store_lost_while_it_is_taught_is_an_answer() -> None:
    store = Leaving()
    filled(store)
    talk = Conversation(store, lambda: small_home.NOW)
    talk.ask("where are my keys?")
    store.here = False
    answer = talk.ask("these are my keys")
    assert (answer.status, answer.suggestions) == ("error", ("these are my keys",))
    store.here = True
    assert "I will remember" in talk.ask(answer.suggestions[0]).answer


async def test_of_many_late_answers_the_newest_stands() -> None:
    """Ten questions at once, the first slow: only the last one's answer is ever shown."""
    release = threading.Event()
    asked: list[str] = []

    def slowly(text: str) -> Answer:
        if text.startswith("question"):
            asked.append(text)
        if text == "question 0":
            release.wait(5)
        return small_home.answer(text)

    async with chat(small_home.session(filled(), slowly, suggestions=("where",))) as c:
        c.app.ask("question 0")
        await c.until(lambda: asked == ["question 0"])
        for number in range(1, 10):
            c.app.ask(f"question {number}")
        release.set()
        await c.until(lambda: "You: question 9" in c.said())
        await c.pilot.pause(0.1)
        assert "You: question 9" in c.said()
        assert asked == ["question 0", "question 9"]  # what is late already is not even asked
        assert c.app.chat.earlier.count("You:") == 1  # what was asked of the store is told


async def test_taught_words_are_never_markup() -> None:
    store = filled()
    async with chat(session_over(store)) as c:
        await c.ask("where are my keys?")
        await c.type("call it [red]x[/red] [/]")
        await c.until(lambda: "I will remember" in c.said())
        assert "[red]x[/red] [/]" in c.said()
        [name] = names(store, c.app.chat.keyframes[0].object_id)
        assert "[red]x" in name.word
        await c.pilot.press("f5", "escape", "f7", "escape")
        assert c.app.is_running


def test_what_is_offered_is_said_once() -> None:
    offered = ("Where is the cup?", "Where is the bowl?")
    reason = "It asks one thing or another."
    said = f"{reason} Did you mean: {offered[0]}"
    answer = Answer(status="ambiguous", answer=said, message=reason, suggestions=offered)
    assert told(answer) == (reason, "")
    assert told(Answer(answer="I never saw one.")) == ("I never saw one.", "")
    failed = Answer(status="error", answer="I cannot.", message="no server", suggestions=("x",))
    assert told(failed) == ("I cannot.", "no server")


class Held:
    """A conversation whose slow question waits until it is released."""

    def __init__(self, store: OracleStore) -> None:
        self.talk = Conversation(store, lambda: small_home.NOW)
        self.release = threading.Event()
        self.asked: list[str] = []
        self.session = small_home.session(
            store, self.ask, alone=self.talk.alone, explain=self.talk.explain,
            pointer=self.talk.pointer, teaches=self.talk.teaches,
        )  # fmt: skip

    def ask(self, text: str) -> Answer:
        self.asked.append(text)
        if "chair" in text:
            self.release.wait(5)
        return self.talk.ask(text)


async def taught_behind_the_slow(c: Chat) -> str:
    """Ask for the bowl, then for what is slow, and name the bowl meanwhile; return its id."""
    await c.ask("where is the bowl?")
    bowl = c.app.chat.keyframes[0].object_id
    await c.type("where is the chair?")
    await c.until(lambda: "Looking" in c.said())
    await c.type("call it Excalibur")
    return bowl


async def test_what_was_taught_is_kept_though_something_newer_was_asked() -> None:
    store = filled()
    held = Held(store)
    async with chat(held.session) as c:
        bowl = await taught_behind_the_slow(c)
        await c.type("where is the cup?")
        await c.type("where are my keys?")
        held.release.set()
        await c.until(lambda: "You: where are my keys?" in c.said())
        assert [n.word for n in names(store, bowl)] == ["excalibur"]
        assert "as “Excalibur”" in c.app.chat.earlier
        assert any("as “Excalibur”" in notice.message for notice in c.app._notifications)
        asked = ["where is the bowl?", "where is the chair?", "call it Excalibur"]
        assert held.asked == [*asked, "where are my keys?"]  # the cup was overtaken


async def test_a_question_is_answered_that_something_is_taught_about() -> None:
    store = filled()
    held = Held(store)
    async with chat(held.session) as c:
        await c.type("where is the chair?")
        await c.until(lambda: "Looking" in c.said())
        await c.type("where is the bowl?")
        await c.type("call it Excalibur")
        held.release.set()
        await c.until(lambda: "as “Excalibur”" in c.said())
        named = [o for o in store.objects() if [n.word for n in o.names] == ["excalibur"]]
        assert [each.category for each in named] == ["bowl"]


async def test_a_choice_that_teaches_is_kept_too() -> None:
    store = filled()
    held = Held(store)
    async with chat(held.session) as c:
        await c.ask("where is the bowl?")
        bowl = c.app.chat.keyframes[0].object_id
        await c.type("these are my keys")
        await c.until(lambda: "all the same?" in c.said())
        assert held.session.teaches("yes")
        assert not held.session.teaches("what did I teach you?")
        assert not held.session.teaches("where are my keys?")
        await c.type("yes")
        await c.until(lambda: "as “your keys”" in c.said())
        assert [n.word for n in names(store, bowl)] == ["key"]


async def test_a_place_is_on_the_map_as_soon_as_it_is_taught() -> None:
    store = filled()
    async with chat(session_over(store), size=(160, 50)) as c:
        view = c.app.chat.query_one(FloorView)
        await c.ask("where is the bowl?")
        assert "workbench" not in {region.name for region in view.floor.regions}
        await c.type("call this place the workbench")
        await c.until(lambda: "workbench" in str(view.render()))
        assert "workbench" in c.prompt().known.words
        await c.pilot.press("f3")
        sheet = c.app.screen.query_one(FloorView)
        await c.until(lambda: "workbench" in str(sheet.render()))
        await c.pilot.press("escape")
        await c.type("undo")
        await c.until(lambda: "workbench" not in str(view.render()))
        assert "workbench" not in c.prompt().known.words


async def test_what_was_taught_is_kept_though_the_chat_was_left() -> None:
    store = filled()
    held = Held(store)
    async with chat(held.session) as c:
        bowl = await taught_behind_the_slow(c)
        await c.pilot.press("ctrl+q")
    held.release.set()
    await asyncio.get_running_loop().shutdown_default_executor()  # as a chat's own end does
    assert [n.word for n in names(store, bowl)] == ["excalibur"]
