"""Follow-ups against a store: what is kept from one question to the next, and what is not."""

from __future__ import annotations

from datetime import timedelta

from assistant.conversation import Conversation
from d3a.store.base import RecordingRecord, StoreUnreachable
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore


def conversation() -> Conversation:
    store = OracleStore()
    small_home.fill(store)
    return Conversation(store, lambda: small_home.NOW)


def test_a_follow_up_takes_the_rest_from_the_question_before() -> None:
    talk = conversation()
    first = talk.ask("Where are my keys?")
    assert first.keyframes[0].object_id == "keys-1"
    other = talk.ask("And the bowl?")
    assert other.text == "And the bowl?"
    assert other.query is not None
    assert other.query.ask == "where"
    assert other.keyframes[0].object_id == "bowl-1"
    earlier = talk.ask("What about yesterday?")
    assert earlier.query is not None
    assert earlier.query.objects[0].category == "bowl"
    assert earlier.query.time is not None
    assert earlier.query.time.end == small_home.NOW.replace(hour=0)
    assert earlier.status == "not_found"


def test_what_is_not_understood_or_unknown_leaves_the_question_before() -> None:
    talk = conversation()
    talk.ask("Where are my keys?")
    assert talk.ask("Why?").status == "out_of_scope"
    assert talk.ask("Where is the zeppelin?").status == "unknown_object"
    again = talk.ask("And the cup?")
    assert again.query is not None
    assert (again.query.ask, again.query.objects[0].category) == ("where", "cup")


def test_a_question_alone_is_not_followed_up() -> None:
    talk = conversation()
    talk.ask("Where are my keys?")
    assert talk.alone("When did you see the couch?").status == "found"
    after = talk.ask("And the cup?")
    assert after.query is not None
    assert after.query.ask == "where"


def test_a_fragment_at_the_start_is_refused() -> None:
    assert conversation().ask("And yesterday?").status == "not_understood"


def test_why_is_told_of_the_query_that_a_follow_up_became() -> None:
    talk = conversation()
    talk.ask("Where are my keys?")
    talk.ask("And the bowl?")
    assert "bowl(x)" in talk.explain("And the bowl?")
    assert "couch(x)" in talk.explain("Where is the couch?")


def test_notation_and_questions_go_together() -> None:
    talk = conversation()
    assert talk.ask("bowl(x) | OIc.find(x)").status == "found"
    after = talk.ask("And the cup?")
    assert after.query is not None
    assert after.query.objects[0].category == "cup"


class Lost(OracleStore):
    """A store whose server went away."""

    def recordings(self) -> list[RecordingRecord]:
        raise StoreUnreachable("the server went away")

    def categories(self) -> list[tuple[str, int]]:
        raise StoreUnreachable("the server went away")


def test_a_lost_store_is_an_answer() -> None:
    talk = Conversation(Lost(), lambda: small_home.NOW + timedelta(days=1))
    answer = talk.ask("Where are my keys?")
    assert answer.status == "error"
    assert answer.message == "the server went away"
