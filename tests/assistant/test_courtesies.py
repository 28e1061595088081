"""What asks nothing is answered in kind; what asks something is no politeness."""

from __future__ import annotations

import pytest

from assistant.courtesies import courteous


@pytest.mark.parametrize(
    ("said", "reply"),
    [
        ("Thanks!", "welcome"),
        ("ok, thank you very much.", "welcome"),
        ("great", "welcome"),
        ("Good morning", "Hello"),
        ("bye", "Goodbye"),
        ("never mind", "All right"),
        ("Yes.", "asked nothing"),
        ("no", "not this one"),
    ],
)
def test_politeness_has_its_answer(said: str, reply: str) -> None:
    assert reply in (courteous(said) or "")


@pytest.mark.parametrize(
    "said",
    ["thanks, where is the cup", "ok and the bowl", "hello kitty", "good cups", "not this one", ""],
)
def test_what_asks_or_names_something_is_none(said: str) -> None:
    assert courteous(said) is None
