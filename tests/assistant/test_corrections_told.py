"""Spelling that was made good is told: by ask, batch, the chat and parse."""

from __future__ import annotations

import json

from click.testing import CliRunner

from assistant import batch
from assistant.asking import ask
from assistant.cli import main
from assistant.conversation import Conversation
from tests.worlds import small_home
from tests.worlds.oracle import OracleStore

TOLD = "I read “botle” as bottle. "
Q3 = "pink(x), cup(y), time(t) | STc.find(OIc.find(x, y), 1600 >= t >= 1300)"


def home() -> OracleStore:
    store = OracleStore()
    small_home.fill(store)
    return store


def test_an_answer_tells_what_was_read_before_anything_else() -> None:
    plain = ask(home(), "Where is the bottle?", now=small_home.NOW)
    slip = ask(home(), "Where is the botle?", now=small_home.NOW)
    assert slip.answer == TOLD + plain.answer
    assert slip.to_json()["query"]["corrections"] == [
        {"said": "botle", "taken": "bottle", "position": 13}
    ]
    assert "corrections" not in plain.to_json()["query"]


def test_a_batch_tells_it_too() -> None:
    (answer,) = batch.run(home(), ["where is the botle"], now=small_home.NOW)
    assert answer.answer.startswith(TOLD)


def test_the_chat_tells_it_once() -> None:
    talk = Conversation(home(), lambda: small_home.NOW)
    assert talk.ask("Where is the cup?").answer.startswith("I read") is False
    assert talk.ask("And the botle?").answer.startswith(TOLD)
    assert talk.ask("And yesterday?").answer.startswith("I read") is False


def test_parse_tells_it_and_reads_the_papers_notation() -> None:
    told = CliRunner().invoke(main, ["parse", "where is the botle", Q3])
    assert told.exit_code == 0
    assert f"  {TOLD.strip()}\n" in told.output
    record = json.loads(CliRunner().invoke(main, ["parse", "--json", Q3]).output)
    assert [o["category"] for o in record["objects"]] == ["cup"]
    assert record["objects"][0]["attributes"] == ["pink"]
    assert record["time"] is not None
