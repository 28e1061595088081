"""What must not be claimed: a moment, an absence, a look-alike, a spot that nobody is sure of."""

from __future__ import annotations

import pytest

from assistant.asking import ask
from tests.worlds.made import NOW, Home
from tests.worlds.oracle import OracleStore


@pytest.fixture
def two_rooms() -> Home:
    home = Home(classes=("cup", "key", "couch"))
    home.thing("cup", "cup", paint="red")
    home.seen("cup", 0, 30, at=(1, 1, 1))
    home.seen("cup", 200, 210, at=(6, 1, 1), place=1)
    home.room("kitchen", -1, -1, 3, 3)
    home.room("living room", 4, -1, 9, 3)
    return home


def told(home: Home, question: str) -> str:
    store = OracleStore()
    home.into(store)
    return ask(store, question, now=NOW).answer


def test_at_a_moment_between_sightings_both_are_told(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup at 2 pm today?")
    assert said == (
        "I did not see a cup today at 14:00. I had last seen one today at 12:30, 6 hours ago, in "
        "the kitchen. I next saw one today at 15:20, 4 hours ago, in the living room."
    )


def test_at_a_moment_within_a_sighting_the_answer_is_yes(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup at 12:10 today?")
    assert said == "Yes. I was seeing a cup today at 12:10, in the kitchen."


def test_at_a_moment_before_all_only_the_next_is_told(two_rooms: Home) -> None:
    said = told(two_rooms, "Did you see a cup at 4 am today?")
    assert said.startswith("I did not see a cup today at 4:00. I next saw one today at 12:00,")
