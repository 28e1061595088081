"""Words to objects: each rung of the ladder, votes, names and owners."""

from __future__ import annotations

from dataclasses import replace

import pytest

from d3a.answering.match import (
    BROADER,
    EXACT,
    NARROWER,
    SYNONYM,
    Candidate,
    candidates,
    in_room,
    is_named,
    rungs,
    unheard,
)
from d3a.plan import FindObjects, Precision
from d3a.store.base import ObjectRecord, TaughtName
from tests.worlds.made import Words

STORE = ("couch", "cup", "sportsball", "truck")


def find(
    category: str, word: str = "", owner: str | None = None, precision: Precision | None = None
) -> FindObjects:
    return FindObjects("x", category, word or category, owner, precision)


def record(
    name: str, category: str, votes: tuple[tuple[str, float], ...] = (), *names: TaughtName
) -> ObjectRecord:
    return ObjectRecord(name, category, 1.0, 0, 0, categories=votes, names=names)


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        (find("cup"), {"cup": EXACT}),
        (find("cup", "mug"), {"cup": SYNONYM}),
        (find("sports ball"), {"sportsball": EXACT}),
        (find("ball"), {"sportsball": NARROWER}),
        (find("furniture"), {"couch": NARROWER}),
        (find("couch", "sofa"), {"couch": SYNONYM}),
        (find("elephant"), {}),
        (find("object"), dict.fromkeys(STORE, EXACT)),
        (find("cup", precision="perfect"), {}),
        (find("elephant", precision="any"), dict.fromkeys(STORE, EXACT)),
        (find("ball", precision="category"), {}),
        (find("ball", precision="attribute"), {}),
        (find("couch", "sofa", precision="attribute"), {"couch": SYNONYM}),
    ],
)
def test_rungs(step: FindObjects, expected: dict[str, float]) -> None:
    assert rungs(step, STORE, Words()) == expected


def test_a_broader_category_may_hold_what_was_asked() -> None:
    assert rungs(find("cup"), ("drinkware",), Words()) == {"drinkware": BROADER}


def test_a_compound_is_a_kind_of_its_head() -> None:
    assert rungs(find("cup"), ("coffee cup", "cup holder"), Words()) == {"coffee cup": NARROWER}


def test_a_minority_of_votes_finds_a_thing_with_the_worth_of_its_share() -> None:
    records = [
        record("a", "cup", (("cup", 30.0), ("bowl", 10.0))),
        record("b", "bowl", (("bowl", 9.0), ("cup", 1.0))),
        record("c", "cup", (("cup", 36.0), ("bowl", 4.0))),  # no more than a detector errs
        record("d", "cup", (("cup", 2.0), ("bowl", 1.0))),  # too few to tell
    ]
    step = find("bowl")
    found = candidates(replace(step, votes=True), records, {"bowl": EXACT})
    assert [(c.record.object_id, c.match, c.votes) for c in found] == [
        ("a", 0.25, 0.25),
        ("b", 0.9, 1.0),
    ]
    sure = candidates(step, records, {"bowl": EXACT})
    assert [c.record.object_id for c in sure] == ["b"]


@pytest.mark.parametrize(
    ("word", "room_and_noun"),
    [
        ("kitchen table", ("kitchen", "table")),
        ("living room coffee table", ("living room", "coffee table")),
        ("dining table", None),
        ("kitchen", None),
    ],
)
def test_a_noun_may_begin_with_the_name_of_a_room(
    word: str, room_and_noun: tuple[str, str] | None
) -> None:
    assert in_room(word, ["kitchen", "living", "living room"]) == room_and_noun


def test_a_taught_name_fits_fully_whatever_the_category() -> None:
    taught = record("a", "cell phone", (), TaughtName("Pumpkin"))
    found = candidates(find("pumpkin"), [taught, record("b", "cup")], {})
    assert [(c.record.object_id, c.match) for c in found] == [("a", EXACT)]


def test_the_owner_narrows_what_is_taught_and_nothing_else() -> None:
    hers = record("a", "key", (), TaughtName("key", "anna"))
    his = record("b", "key", (), TaughtName("key", "ben"))
    plain = record("c", "key")
    worth = {"key": EXACT}
    ids = [c.record.object_id for c in candidates(find("key", owner="anna"), [hers, his], worth)]
    assert ids == ["a"]
    untaught = candidates(find("key", owner="anna"), [plain], worth)
    assert [c.record.object_id for c in untaught] == ["c"]
    others = candidates(find("key", owner="me"), [hers, his, plain], worth)
    assert [c.record.object_id for c in others] == ["c"]


def test_named_needs_the_asked_owner() -> None:
    hers = record("a", "key", (), TaughtName("key", "anna"))
    assert is_named(hers, find("key", owner="anna"))
    assert is_named(hers, find("key"))
    assert not is_named(hers, find("key", owner="ben"))


@pytest.mark.parametrize(
    ("word", "worth", "names", "said"),
    [
        ("blurple cup", {"cup": BROADER}, (), "blurple"),
        ("blurple cup", {"cup": BROADER, "blurple cup": EXACT}, (), ""),
        ("blurple cup", {"drinkware": BROADER}, (), ""),
        ("blurple cup", {"cup": BROADER}, (TaughtName("blurple cup", None),), ""),
        ("coffee cup", {"cup": BROADER}, (), "coffee cup"),
        ("coffee cup", {"cup": BROADER, "coffee cup": EXACT}, (), ""),
        ("coffee cup", {"cup": BROADER}, (TaughtName("coffee cup", None),), ""),
        ("cup", {"cup": EXACT}, (), ""),
    ],
)
def test_what_nobody_knows_of_a_noun_is_told(
    word: str, worth: dict[str, float], names: tuple[TaughtName, ...], said: str
) -> None:
    found = [Candidate(record("a", "cup", (), *names), 1.0)]
    assert unheard(find(word), found, worth, Words()) == said
