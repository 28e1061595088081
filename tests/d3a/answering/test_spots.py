"""Where stays were, in words, worked out once for as long as nobody writes."""

from __future__ import annotations

import pytest

from d3a.answering import spots as spots_module
from d3a.answering.landmarks import Landmarks
from d3a.answering.spots import Spot, Spots
from d3a.store.base import Region, StayRecord

KITCHEN = Region("kitchen", ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)))
SURE = (0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01)
LANDMARKS = Landmarks(
    (("s", 0), ("t", 0)),
    ("sink", "table"),
    ((1.0, 1.0, 0.0), (1.5, 1.0, 0.0)),
    ("", ""),
    (("kitchen",), ("kitchen",)),
)


def stay(name: str, x: float, covariance: tuple[float, ...] = SURE) -> StayRecord:
    return StayRecord(name, 0, (x, 1.0, 0.0), 0, 1, 1.0, covariance=covariance)


def one(
    spots: Spots, of: StayRecord, ids: tuple[str, ...] = (), kinds: tuple[str, ...] = ()
) -> Spot:
    return spots.tell([of], spots.ruled_out(ids, kinds))[of.key]


def test_a_stay_is_told_by_the_nearest_that_the_question_does_not_ask_for() -> None:
    spots = Spots([KITCHEN], LANDMARKS, 1.0)
    cup = stay("cup", 1.1)
    assert one(spots, cup) == Spot("kitchen", near="sink")
    assert one(spots, cup, ids=("s",)) == Spot("kitchen", near="table")
    assert one(spots, cup, kinds=("sink", "table")) == Spot("kitchen")
    assert one(spots, cup) == Spot("kitchen", near="sink")  # the others changed nothing
    assert one(spots, stay("s", 1.0)) == Spot("kitchen", near="table")  # never by itself


def test_what_is_far_or_unsure_is_told_so() -> None:
    spots = Spots([KITCHEN], LANDMARKS, 1.0)
    assert one(spots, stay("cup", 3.5)) == Spot("kitchen", beyond=("table", 2.0))
    assert one(spots, stay("bowl", 2.5, tuple(4.0 for _ in SURE))) == Spot("kitchen", vague="table")


def test_without_landmarks_the_room_is_told_alone() -> None:
    spots = Spots([KITCHEN], None, 1.0)
    assert one(spots, stay("cup", 1.1), ids=("s",)) == Spot("kitchen")
    assert one(spots, stay("cap", 9.0)) == Spot()


def test_a_spot_is_worked_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    spots = Spots([KITCHEN], LANDMARKS, 1.0)
    stays = [stay("a", 1.0), stay("b", 3.9)]
    told = spots.tell(stays, frozenset())
    monkeypatch.setattr(spots_module, "holders_of", None)
    assert spots.tell([*reversed(stays)], frozenset()) == told


def test_more_than_may_be_kept_is_told_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spots_module, "MOST_SPOTS", 2)
    spots = Spots([KITCHEN], LANDMARKS, 1.0)
    many = [stay(f"o{k}", k / 2) for k in range(9)]
    wanted = {each.key: one(Spots([KITCHEN], LANDMARKS, 1.0), each) for each in many}
    assert spots.tell(many[:2], frozenset()) == {k: wanted[k] for k in (many[0].key, many[1].key)}
    assert spots.tell(many, frozenset()) == wanted
    assert spots.tell(many[1:3], frozenset()) == {k.key: wanted[k.key] for k in many[1:3]}
