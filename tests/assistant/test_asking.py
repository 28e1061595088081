"""From text to answer: statuses, now and zone, failing stores, explanations."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import pytest

from assistant.asking import (
    ask,
    ask_query,
    explain,
    home_zone,
    store_now,
    store_words,
)
from d3a.answering.facts import Facts
from d3a.model import BadInput
from d3a.parameters import DEFAULT, PAPER
from d3a.store.base import Batch, Store, StoreUnreachable
from grammar.errors import NotUnderstood
from grammar.forms import FormalQuery, ObjectTerm
from tests.worlds.made import NOW, ZONE, Home, at
from tests.worlds.oracle import OracleStore


def furnished(store: Store) -> Store:
    home = Home(classes=("cup", "bowl"))
    home.thing("cup", "cup", paint="red", names=(("Pumpkin", "anna"),))
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.room("den", 0, 0, 3, 3)
    return home.into(store)


class Unplugged(OracleStore):
    """A store whose server went away."""

    def categories(self) -> list[tuple[str, int]]:
        raise StoreUnreachable("mongodb://***@robot cannot be reached; is it on?")


@pytest.fixture
def store() -> Store:
    return furnished(OracleStore())


def test_a_question_becomes_an_answer_with_its_query(store: Store) -> None:
    answer = ask(store, "Where is the red cup?", now=NOW, id="q7")
    assert (answer.status, answer.id, answer.text) == ("found", "q7", "Where is the red cup?")
    assert answer.query is not None
    assert answer.query.select == "last"
    assert {"parse", "retrieve", "rank", "total"} <= set(answer.elapsed_ms)
    assert json.loads(json.dumps(answer.to_json()))["keyframes"][0]["place"] == "den"


def test_every_backend_gives_the_same_answer(make_store: Callable[[], Store]) -> None:
    question = "Where is the red cup?"
    expected = ask(furnished(OracleStore()), question, now=NOW)
    other = make_store()
    try:
        answer = ask(furnished(other), question, now=NOW)
        assert answer.answer == expected.answer
        assert answer.keyframes == expected.keyframes
    finally:
        other.close()


@pytest.mark.parametrize(
    ("question", "status"),
    [
        ("Why did I leave my cup?", "out_of_scope"),
        ("florp the zzz of", "not_understood"),
        ("", "not_understood"),
        ("Where is the cup or the bowl?", "ambiguous"),
    ],
)
def test_what_cannot_be_answered_says_where_and_what_would_do(
    store: Store, question: str, status: str
) -> None:
    answer = ask(store, question, now=NOW)
    assert answer.status == status
    assert answer.message
    assert answer.position is not None
    assert answer.keyframes == ()
    assert answer.query is None
    assert answer.answer


def test_a_store_that_fails_is_an_answer() -> None:
    answer = ask(Unplugged(), "Where is my cup?", now=NOW)
    assert answer.status == "error"
    assert "robot cannot be reached" in (answer.message or "")
    query = FormalQuery("?", "Q1", "whether", (ObjectTerm("cup"),))
    assert ask_query(Unplugged(), query, now=NOW).status == "error"


def test_formal_notation_is_read_as_such(store: Store) -> None:
    answer = ask(store, "red(x), cup(y) | OIc.find(x, y)", now=NOW)
    assert answer.status == "found"
    assert [k.object_id for k in answer.keyframes] == ["cup"]


def test_unknown_precision_is_the_caller_s_mistake(store: Store) -> None:
    with pytest.raises(BadInput, match="perfect, category, attribute, any"):
        ask(store, "Where is my cup?", now=NOW, precision="fuzzy")


@pytest.mark.parametrize(
    ("precision", "question", "said"),
    [
        ("perfect", "Did you see a red cup?", "Nobody taught me which thing is “cup”"),
        (
            "category",
            "Did you see a red cup?",
            "the category alone: I did not judge “red”. I saw a",
        ),
        ("category", "Did you see a cup that is not red?", "I did not judge “not red”. I saw a c"),
        ("category", "Did you see a cup?", "Yes. I saw a cup"),
        (
            "any",
            "Did you see a red cup?",
            "anything that I saw: I did not judge “red cup”. I saw a",
        ),
        ("any", "Did you see anything?", "Yes. I saw a"),
        ("attribute", "Did you see a red cup?", "Yes. I saw a red cup"),
    ],
)
def test_a_forced_rung_claims_no_more_than_it_judged(
    store: Store, precision: str, question: str, said: str
) -> None:
    answer = ask(store, question, now=NOW, precision=precision)
    assert said in answer.answer
    assert ("Yes" in answer.answer) == said.startswith("Yes")
    assert "cannot recognise" not in answer.answer
    assert answer.status == ("not_found" if precision == "perfect" else "found")


def test_the_grammar_gets_the_store_s_words(store: Store) -> None:
    words = store_words(store)
    assert words.categories == ("cup", "bowl")
    assert words.names == (("Pumpkin", "anna"),)
    assert words.places == ("den",)


def test_now_is_given_or_fixed_or_the_newest_frame_or_the_clock(store: Store) -> None:
    def clock() -> datetime:
        return datetime(2030, 1, 1, tzinfo=UTC)

    given = datetime(2024, 5, 14, 20, 0, tzinfo=UTC)
    assert store_now(store, given, clock) == given
    assert store_now(store, given, clock).tzinfo == ZONE
    assert store_now(store, "last", clock) == at(10)
    assert store_now(store, None, clock) == clock()
    store.apply(Batch(meta={"now": "2024-05-15T08:00:00-04:00"}))
    assert store_now(store, None, clock) == datetime(2024, 5, 15, 12, tzinfo=UTC)
    assert store_now(store, "last", clock) == at(10)


def test_a_clock_behind_the_robot_s_hides_nothing_and_a_given_time_does(store: Store) -> None:
    behind = at(7)
    assert store_now(store, None, lambda: behind) == at(10)
    assert store_now(store, behind, lambda: behind) == behind
    found = ask(store, "Where is the cup?", now=behind)
    assert found.keyframes[0].end == behind
    assert found.last_looked == behind
    store.apply(Batch(meta={"now": behind.isoformat()}))
    assert store_now(store, None, lambda: behind) == at(10)


def test_before_anything_was_seen_there_is_no_memory_yet(store: Store) -> None:
    early = ask(store, "Did you ever see a cup?", now=at(-24 * 60))
    assert (early.status, early.reason, early.last_looked) == ("not_found", "empty", None)
    assert early.answer.startswith("I had not seen anything yet: my memory begins")
    assert "12:00" in early.answer


def test_a_now_without_an_offset_is_the_home_s_wall_clock(store: Store) -> None:
    naive = datetime(2024, 5, 14, 20, 0)  # noqa: DTZ001  this is the case
    assert store_now(store, naive, lambda: NOW) == datetime(2024, 5, 15, 0, 0, tzinfo=UTC)


def test_zone_of_the_home(store: Store) -> None:
    assert home_zone(store) == ZoneInfo("America/New_York")
    assert home_zone(OracleStore()) is None
    store.apply(Batch(meta={"zone": "Moon/Crater"}))
    assert home_zone(store) is None


def test_a_store_is_asked_with_the_thresholds_that_filled_it(store: Store) -> None:
    assert Facts(store).parameters() == DEFAULT
    filled = PAPER.with_changes(together_m=2.5).to_json() | {"from_a_later_version": 1}
    store.apply(Batch(meta={"parameters": filled}))
    assert Facts(store).parameters() == PAPER.with_changes(together_m=2.5)


def test_explain_tells_plan_and_native_queries(make_store: Callable[[], Store]) -> None:
    store = make_store()
    try:
        furnished(store)
        told = explain(store, "Where is the red cup?", now=NOW)
    finally:
        store.close()
    assert told.plan.steps
    record = json.loads(json.dumps(told.to_json()))
    assert [step["step"] for step in record["plan"]][:3] == [
        "FindObjects",
        "JudgeAttributes",
        "FindSightings",
    ]
    if record["native"]:  # the oracle has none to tell
        assert all(native["query"] for native in record["native"])
        assert any(native["index"] for native in record["native"])
    text = told.to_text()
    assert "judge attributes x, attributes red" in text
    assert "found, 1 objects" in text


def test_explain_raises_what_has_no_plan(store: Store) -> None:
    with pytest.raises(NotUnderstood):
        explain(store, "florp the zzz of", now=NOW)


def test_asking_does_not_import_what_a_person_would_wait_for() -> None:
    heavy = ("cv2", "sklearn", "scipy", "textual", "PIL", "pymongo", "joblib")
    code = f"import sys, assistant.asking; print([m for m in {heavy!r} if m in sys.modules])"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"


def test_a_question_is_asked_of_what_the_ingest_has_written_so_far(store: Store) -> None:
    before = ask(store, "How many bowls did you see?", now=NOW)
    assert before.status == "not_found"
    later = Home(seed=1)
    later.thing("bowl", "bowl")
    later.seen("bowl", 20)
    later.into(store)
    after = ask(store, "How many bowls did you see?", now=NOW + timedelta(minutes=1))
    assert after.value == 1.0


@pytest.mark.parametrize(
    "text", ["what is on the den?", "is the cup on the den?", "where is the cup on the den?"]
)
def test_what_lies_on_a_place_of_that_name_lies_there(store: Store, text: str) -> None:
    answer = ask(store, text, now=NOW)
    assert answer.query is not None
    assert (answer.query.form, answer.query.place, answer.query.relation) == ("Q3", "den", None)
    assert (answer.status, answer.unjudged) == ("found", ())
    assert [each.object_id for each in answer.keyframes] == ["cup"]
    assert explain(store, text, now=NOW).answer.unjudged == ()


def with_a_desk(*rooms: str) -> Store:
    """A cup at the desk, a bowl far from it; rooms lie around the desk."""
    home = Home(classes=("cup", "bowl", "desk"))
    home.thing("cup", "cup")
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.thing("bowl", "bowl")
    home.seen("bowl", 0, 10, at=(9, 1, 1))
    home.thing("desk", "desk")
    home.seen("desk", 0, 10, at=(1.2, 1, 0.5))
    for room in rooms:
        home.room(room, 0, 0, 3, 3)
    return home.into(OracleStore())


@pytest.mark.parametrize("condition", ["on the", "near the", "in the", "at my", "by the"])
def test_a_place_goes_before_the_things_of_its_name_and_is_told(condition: str) -> None:
    answer = ask(with_a_desk("desk"), f"what is {condition} desk?", now=NOW)
    assert answer.query is not None
    assert (answer.query.place, answer.query.relation) == ("desk", None)
    assert [each.object_id for each in answer.keyframes] == ["cup"]
    assert "a cup at the desk" in answer.answer
    assert answer.answer.endswith("By “the desk” I mean the place that you call so.")
    assert answer.count == 1


def test_what_is_under_a_place_of_that_name_is_under_its_thing() -> None:
    answer = ask(with_a_desk("desk"), "what was under the desk?", now=NOW)
    assert answer.query is not None
    assert answer.query.relation is not None
    assert (answer.query.place, answer.query.relation.kind) == ("desk", "under")


def test_whose_desk_it_is_tells_the_place() -> None:
    both = with_a_desk("Anna's desk")
    hers = ask(both, "what is on Anna's desk?", now=NOW)
    assert hers.query is not None
    assert hers.query.place == "Anna's desk"
    assert "at Anna's desk" in hers.answer
    mine = ask(both, "what is on the desk?", now=NOW)
    assert mine.query is not None
    assert mine.query.place is None


def test_another_word_for_a_place_is_the_place() -> None:
    home = Home(classes=("cup",))
    home.thing("cup", "cup")
    home.seen("cup", 0, 10, at=(1, 1, 1))
    home.room("sofa", 0, 0, 3, 3)
    answer = ask(home.into(OracleStore()), "what is on the couch?", now=NOW)
    assert "a cup at the sofa" in answer.answer
    assert "call so" not in answer.answer


def test_near_a_room_is_not_in_it() -> None:
    answer = ask(with_a_desk("kitchen"), "what is near the kitchen?", now=NOW)
    assert answer.unjudged == ("near the kitchen",)


def test_where_a_place_is_asked_for_the_place_is_told() -> None:
    store = with_a_desk("workshop", "bench")
    answer = ask(store, "where is the bench?", now=NOW)
    assert answer.status == "unknown_object"
    told = "The bench is a place that I know, in the workshop. Ask what is there."
    assert answer.answer == told
    assert answer.suggestions == ("What is at the bench?",)


def test_a_place_that_is_no_more_is_the_things_of_its_name() -> None:
    at_the_desk = FormalQuery(
        "what is at the desk?", "Q3", "what", (ObjectTerm("object", "thing"),), place="desk"
    )
    answer = ask_query(with_a_desk(), at_the_desk, now=NOW)
    assert answer.query is not None
    assert (answer.query.place, answer.query.relation and answer.query.relation.kind) == (
        None,
        "near",
    )
    assert answer.keyframes[0].object_id == "cup"


class Unrevised(OracleStore):
    """A store that is lost before it tells what it was last changed by."""

    def revision(self) -> tuple[int, int] | None:
        raise StoreUnreachable("mongodb://robot cannot be reached")


def test_a_store_lost_before_the_first_look_is_an_answer() -> None:
    query = FormalQuery("where is the cup?", "Q3", "where", (ObjectTerm("cup"),), select="last")
    assert ask(Unrevised(), "where is the cup?", now=NOW).status == "error"
    lost = ask_query(Unrevised(), query, now=NOW)
    assert (lost.status, lost.query) == ("error", query)
