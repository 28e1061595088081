"""What is said, word for word: one home, many questions through the real grammar."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from assistant.phrases import whose
from assistant.reply import sentence
from d3a.answer import Answer
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore

ON_TABLE, TABLE = (180.0, 170.0, 220.0, 230.0), (100.0, 200.0, 300.0, 400.0)


@pytest.fixture(scope="module")
def home() -> OracleStore:
    home = Home(
        classes=(
            "cup",
            "bowl",
            "refrigerator",
            "couch",
            "elephant",
            "dining table",
            "key",
            "glasses",
        )
    )
    home.thing("cup-red", "cup", paint="red")
    home.thing("cup-blue", "cup", paint="blue")
    home.thing("bowl", "bowl", paint="orange")
    home.thing("fridge", "refrigerator", paint="white")
    home.thing("couch", "couch", paint="green")
    home.thing("table", "dining table", paint="brown")
    home.thing("keys", "key", names=(("key", "anna"),))
    home.seen("cup-red", 0, 30, at=(1, 1, 1))
    home.seen("cup-blue", 20, 30, at=(1.5, 1, 1))
    home.seen("cup-blue", 200, 210, at=(6, 1, 1), place=1)
    home.seen("bowl", 5, 30, at=(1.2, 1.2, 1), absent=100, box=ON_TABLE)
    home.seen("fridge", 0, 50, at=(0, 0, 1))
    home.seen("couch", 200, 220, at=(6.5, 1, 1))
    home.seen("table", 5, 30, at=(1.2, 1.0, 0.8), box=TABLE)
    home.seen("keys", -1500, -1440, at=(6.2, 1.2, 0.5))
    home.thing("glasses", "glasses", paint="black")
    home.seen("glasses", 190, 210, at=(6.8, 1.4, 0.5), absent=225)
    home.met("bowl", "table", 5, 30, boxes=(ON_TABLE, TABLE))
    home.met("cup-red", "bowl", 6, 8)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    store = OracleStore()
    home.into(store)
    return store


SAID = {
    "Did you see a red cup?": (
        "Yes. I saw a red cup today at 12:30, 6 hours ago, in the kitchen, next to the dining "
        "table. I am fairly sure: seen five times."
    ),
    "Where is the blue cup?": (
        "In the living room, next to the couch. I last saw the blue cup there today at 15:30, 4 "
        "hours ago. I am fairly sure: seen five times."
    ),
    "Where is the second bowl?": (
        "I last saw the bowl today at 12:30, 6 hours ago, in the kitchen, next to the dining "
        "table. When I looked there again today at 13:40, it was gone. I am fairly "
        "sure: seen five times. Which one is the second I cannot tell."
    ),
    "When was the cup on the dining table with the bowl?": (
        "I saw the cup on the dining table with the bowl on two occasions, first today at 12:00 "
        "and last today at 12:30, 6 hours ago. I am fairly sure: seen five times then, ten times "
        "in all."
    ),
    "When was the cup on the dining table without the bowl?": (
        "I did not see the cup on the dining table without the bowl. I last saw it today at 15:30, "
        "4 hours ago, in the living room, next to the couch."
    ),
    "Was there a bowl on the dining table with the elephant?": (
        "I never saw a bowl on the dining table with the elephant. I last looked today at 15:40, "
        "3 hours ago."
    ),
    "Where is Anna's key?": (
        "In the living room, next to the couch. I last saw Anna's key there yesterday at 12:00, "
        "31 hours ago. I am fairly sure: seen five times."
    ),
    "Where is the bowl?": (
        "I last saw the bowl today at 12:30, 6 hours ago, in the kitchen, next to the dining "
        "table. When I looked there again today at 13:40, it was gone. I am fairly "
        "sure: seen five times."
    ),
    "Is there a bowl on the dining table?": (
        "No, not any more. I last saw the bowl today at 12:30, 6 hours ago, in the kitchen. When "
        "I looked there again today at 13:40, it was gone."
    ),
    "Was there a bowl on the dining table?": (
        "Yes. I saw a bowl on the dining table today at 12:30, 6 hours ago, in the kitchen. When "
        "I looked there again today at 13:40, it was gone. I am fairly sure: seen once "
        "then, five times in all."
    ),
    "Is there no bowl on the dining table?": (
        "That is right: I last saw the bowl today at 12:30, 6 hours ago, in the kitchen. When I "
        "looked there again today at 13:40, it was gone."
    ),
    "Was there no bowl on the dining table?": (
        "No, there was: I saw a bowl on the dining table today at 12:30, 6 hours ago, in the "
        "kitchen. When I looked there again today at 13:40, it was gone. I am fairly sure: seen "
        "once then, five times in all."
    ),
    "Is the blue cup in the kitchen?": (
        "No, not any more. I last saw the blue cup today at 15:30, 4 hours ago, in the living "
        "room, next to the couch."
    ),
    "Is the red cup in the kitchen?": (
        "Yes. I last saw a red cup in the kitchen today at 12:30, 6 hours ago, next to the dining "
        "table. I am fairly sure: seen five times."
    ),
    "Where are Anna's keys?": (
        "In the living room, next to the couch. I last saw Anna's keys there yesterday at 12:00, "
        "31 hours ago. I am fairly sure: seen five times."
    ),
    "Did you see keys today?": (
        "I did not see keys today. I saw some yesterday at 12:00, 31 hours ago, in the living "
        "room, next to the couch. I last looked today at 15:40, 3 hours ago."
    ),
    "Where were my glasses an hour ago?": (
        "I looked again and your glasses were gone. I last saw them today at 15:30, 4 hours ago, "
        "in the living room, next to the couch."
    ),
    "Did you see glasses?": (
        "Yes. I saw a pair of glasses today at 15:30, 4 hours ago, in the living room, next to "
        "the couch. When I looked there again today at 15:45, they were gone. I am fairly sure: "
        "seen five times."
    ),
    "Is anything missing?": (
        "Two things are no longer in place: the bowl, last seen in the kitchen, next to the "
        "dining table, today at 12:30, 6 hours ago; the glasses, last seen in the living room, "
        "next to the couch, today at 15:30, 4 hours ago."
    ),
    "What is on the kitchen table?": (
        "I last saw a cup on the kitchen table today at 12:30, 6 hours ago."
    ),
    "What was on the table in the kitchen?": (
        "I saw two cups and a bowl on the table in the kitchen, last today at 12:30, 6 hours ago."
    ),
    "What is on the living room table?": "I cannot tell what is “on the living room table” here.",
    "Is there a cup in the basement?": (
        "I cannot tell what is “in the basement” here. I last saw a cup today at 15:30, 4 hours "
        "ago, in the living room, next to the couch. I am fairly sure: seen five times."
    ),
    "Is there no elephant?": (
        "That is right: I never saw an elephant. I last looked today at 15:40, 3 hours ago."
    ),
    "Did you see an elephant?": (
        "I never saw an elephant. I last looked today at 15:40, 3 hours ago."
    ),
    "Did you see a yellow cup?": (
        "I saw a cup, but none that looked yellow. I last saw one, which looked blue, today at "
        "15:30, 4 hours ago, in the living room, next to the couch."
    ),
    "Did you see a purple cup?": (
        "I saw a cup, but I cannot be sure that it looked purple. I last saw it today at 15:30, "
        "4 hours ago, in the living room, next to the couch."
    ),
    "Did you see a wallet?": (
        "I cannot recognise wallets: the detector of this memory has no such word. I last looked "
        "today at 15:40, 3 hours ago."
    ),
    "Did you see a red cup this morning?": (
        "I was not looking between 5:00 and 12:00 today, so I cannot tell. I saw one today at "
        "12:30, 6 hours ago, in the kitchen, next to the dining table. I last looked today at "
        "15:40, 3 hours ago."
    ),
    "Did you see a red cup in the living room?": (
        "I did not see a red cup in the living room. I last saw one today at 12:30, 6 hours ago, "
        "in the kitchen, next to the dining table."
    ),
    "How many cups did you see?": "Two cups, last seen today at 15:30, 4 hours ago.",
    "What is on the dining table?": (
        "I last saw a cup on the dining table today at 12:30, 6 hours ago."
    ),
    "What was on the dining table?": (
        "I saw two cups and a bowl on the dining table, last today at 12:30, 6 hours ago."
    ),
    "Did you never see three cups?": (
        "That is right: I saw only two cups, last today at 15:30, 4 hours ago."
    ),
    "Did you see three cups?": "No. I saw only two cups, last today at 15:30, 4 hours ago.",
    "Did you see a wooden cup?": (
        "I cannot tell what is “wooden” here. I saw a cup on three occasions in three places, last "
        "today at 15:30, 4 hours ago, in the living room, next to the couch. I am fairly sure: "
        "seen 15 times in all."
    ),
    "How long was the red cup in the kitchen?": (
        "About 30 minutes: that is how long I saw the red cup in the kitchen, last today at "
        "12:30, 6 hours ago."
    ),
    "How often did you see the blue cup?": (
        "On two occasions. I last saw the blue cup today at 15:30, 4 hours ago."
    ),
    "When was the red cup together with the bowl?": (
        "Today at 12:08, 7 hours ago, in the kitchen, next to the dining table. I saw the red cup "
        "with the bowl once. I am fairly sure: seen once then, five "
        "times in all."
    ),
    "Did you see a cup without the bowl?": (
        "Yes. I saw a cup without the bowl today at 15:30, 4 hours ago, in the living room, next "
        "to the couch. I am fairly sure: seen five times."
    ),
    "When did you see a cup without the bowl?": (
        "Today at 15:30, 4 hours ago, in the living room, next to the couch. I saw the cup "
        "without the bowl once. I am fairly sure: seen five times."
    ),
    "Did you see a bowl in the kitchen but not on the couch?": (
        "Yes. I saw a bowl in the kitchen but not on the couch today at 12:30, 6 hours ago, next "
        "to the dining table. When I looked there again today at 13:40, it was gone. I am fairly "
        "sure: seen five times."
    ),
    "Did you see a bowl that is not on the dining table?": (
        "I did not see a bowl not on the dining table. I last saw one today at 12:30, 6 hours "
        "ago, in the kitchen."
    ),
    "Did you see a glimmery bowl?": (
        "I cannot tell what is “glimmery” here. I saw a bowl today at 12:30, 6 hours ago, in the "
        "kitchen, next to the dining table. When I looked there again today at 13:40, it was "
        "gone. This is a guess: seen five times."
    ),
    "Where are the couch and the bowl?": (
        "I last saw the couch today at 15:40, 3 hours ago, in the living room. I last saw the "
        "bowl today at 12:30, 6 hours ago, in the kitchen, next to the dining table."
    ),
}


@pytest.mark.parametrize(("question", "said"), SAID.items(), ids=SAID.keys())
def test_sentence(home: OracleStore, question: str, said: str) -> None:
    assert ask(home, question, now=NOW).answer == said


def test_never_a_claim_of_the_present(home: OracleStore) -> None:
    for question in SAID:
        answer = ask(home, question, now=NOW).answer
        assert " it is " not in answer
        assert "  " not in answer
        assert answer.endswith(".")


def test_same_question_same_words(home: OracleStore) -> None:
    first = ask(home, "Where is the blue cup?", now=NOW)
    again = ask(home, "Where is the blue cup?", now=NOW)
    assert first.answer == again.answer
    assert first.keyframes == again.keyframes


def test_an_answer_without_a_query_keeps_its_sentence() -> None:
    assert sentence(Answer(status="error", answer="No memory."), now=NOW) == "No memory."


def test_an_empty_memory_says_so() -> None:
    assert ask(OracleStore(), "Where is my cup?", now=NOW).answer == (
        "My memory is empty: nothing was stored yet."
    )


@pytest.mark.parametrize(
    ("owner", "said"),
    [
        ("me", "your"),
        ("you", "my"),
        ("anna", "Anna's"),
        ("grandmother", "your grandmother's"),
        ("everyone", "Everyone's"),
    ],
)
def test_kin_are_the_asker_s(owner: str, said: str) -> None:
    assert whose(owner) == said
