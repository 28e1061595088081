"""The order of moments, and the parts of a score."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from d3a.answering.match import Candidate
from d3a.answering.moments import Entry, Moment
from d3a.model import Position
from d3a.rank import LEAST_OF_BEST, TENTATIVE, UNJUDGED, entry_score, rank
from d3a.rank import views_probability as views
from d3a.store.base import ObjectRecord, Sighting, StayRecord
from grammar.forms import Select


@pytest.fixture(autouse=True)
def _uncalibrated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take the product of the parts as it is: `test_calibration` tests the rest."""
    monkeypatch.setattr("d3a.rank.calibrated", lambda product, kind: product)


def moment(
    name: str,
    start: int,
    *,
    place: int = 0,
    probability: float = 0.9,
    match: float = 1.0,
    seen: int = 1,
    tentative: bool = False,
    attributes: dict[str, float] | None = None,
    relation: float | None = None,
    span: tuple[int, int] = (0, 0),
) -> Moment:
    record = ObjectRecord(name, "cup", 1.0, *span, tentative=tentative)
    stay = StayRecord(name, place, (0, 0, 0), start, start, 1.0, seen=seen)
    box = (0.0, 0.0, 1.0, 1.0)
    sighting = Sighting(name, place, start, start + 5, "f", probability, box)
    entry = Entry(Candidate(record, match, attributes or {}), stay, sighting)
    return Moment((entry,), start, start + 5, relation=relation)


def order(moments: list[Moment], select: Select = "all", *, spread: bool = False) -> list[str]:
    ranked = rank(moments, select, spread=spread)
    return [f"{r.moment.figure.sighting.object_id}@{r.moment.start_ms}" for r in ranked]


def test_the_score_is_the_product_of_its_parts() -> None:
    one = moment("a", 0, match=0.9, attributes={"red": 0.8}, tentative=True, relation=0.7)
    ranked = rank([one], "all", spread=False, unjudged=1)[0]
    assert ranked.score == pytest.approx(0.9 * 0.8 * 0.9 * TENTATIVE * 0.7 * UNJUDGED)
    assert ranked.why[0] == {
        "match": 0.9,
        "attributes": {"red": 0.8},
        "detection": 0.9,
        "views": 1,
        "tentative": TENTATIVE,
        "relation": 0.7,
        "unjudged": UNJUDGED,
    }


def test_more_views_make_it_likelier_but_not_as_if_independent() -> None:
    assert views(0.7, 1) == pytest.approx(0.7)
    assert views(0.7, 1) < views(0.7, 4) == pytest.approx(1 - 0.3**2)
    assert views(0.7, 4) < 1 - 0.3**4


def test_all_goes_by_score_and_ties_by_time_then_id() -> None:
    moments = [moment("b", 5), moment("a", 5), moment("c", 1), moment("d", 9, probability=0.95)]
    assert order(moments) == ["d@9", "c@1", "a@5", "b@5"]


def test_each_place_comes_once_before_any_twice() -> None:
    unlikely = moment("c", 70, probability=0.3)
    moments = [moment("a", 0), moment("a", 100), moment("b", 50, probability=0.8), unlikely]
    assert order(moments, spread=True) == ["a@0", "b@50", "a@100", "c@70"]
    ranked = rank(moments, "all", spread=True)
    assert [one.score for one in ranked] == pytest.approx([0.9, 0.8, 0.8, 0.3])
    assert ranked[2].why[0]["repeat"] == pytest.approx(0.8889)
    assert "repeat" not in ranked[3].why[0]


def test_each_object_comes_once_before_its_other_places() -> None:
    moments = [moment("a", 0), moment("a", 10, place=1), moment("b", 20, probability=0.8)]
    moments += [moment("a", 30, place=1), moment("b", 40, probability=0.8)]
    assert order(moments, spread=True) == ["a@0", "b@20", "a@10", "a@30", "b@40"]


def test_what_may_be_a_thing_carried_elsewhere_comes_after_surely_another() -> None:
    carried = moment("c", 60, probability=0.88, span=(60, 90))
    moments = [moment("a", 0, span=(0, 50)), moment("a", 40, place=1, span=(0, 50)), carried]
    moments.append(moment("b", 20, probability=0.8, span=(20, 70)))
    assert order(moments, spread=True) == ["a@0", "b@20", "c@60", "a@40"]
    told = rank(moments, "all", spread=True, told=2)
    assert [one.moment.figure.sighting.object_id for one in told] == ["a", "b", "a", "c"]


def standing(name: str, at: Position | None, *, category: str = "cup") -> Moment:
    one = moment(name, 0, span=(0, 9))
    entry = one.figure
    assert entry.stay is not None
    record = replace(entry.candidate.record, category=category)
    candidate, stay = replace(entry.candidate, record=record), replace(entry.stay, position=at)
    return one._replace(entries=(entry._replace(candidate=candidate, stay=stay),))


def test_what_stands_beside_one_of_its_kind_comes_after_what_stands_elsewhere() -> None:
    cups = [standing("a", (0, 0, 0)), standing("b", (0.4, 0, 0)), standing("c", (3, 0, 0))]
    assert order(cups, spread=True) == ["a@0", "c@0", "b@0"]
    assert order(cups) == ["a@0", "b@0", "c@0"]
    of_two_kinds = [cups[0], standing("b", (0.4, 0, 0), category="bowl"), cups[2]]
    assert order(of_two_kinds, spread=True) == ["a@0", "b@0", "c@0"]
    unplaced = [cups[0], standing("b", None), cups[2]]
    assert order(unplaced, spread=True) == ["a@0", "b@0", "c@0"]
    apart = rank(cups, "all", spread=True, together_m=0.3)
    assert [one.moment.figure.sighting.object_id for one in apart] == ["a", "b", "c"]


def pair(a: str, b: str, start: int, frame: str, probability: float = 0.9) -> Moment:
    entries = [moment(name, start, probability=probability).figure for name in (a, b)]
    framed = [e._replace(sighting=replace(e.sighting, frame=frame)) for e in entries]
    return Moment(tuple(framed), start, start + 5, relation=1.0)


def test_the_picture_of_most_new_pairs_comes_first_and_each_pair_before_any_twice() -> None:
    again = [pair("a", "b", t, f"f{t}") for t in (0, 10, 20)]
    both = [pair("a", "b", 30, "both"), pair("a", "c", 30, "both"), pair("b", "c", 30, "both")]
    other = pair("c", "d", 50, "other", probability=0.85)
    ranked = rank([*again, *both, other], "all", spread=True)
    shown = [
        (one.moment.figure.sighting.frame, one.moment.entries[1].sighting.object_id)
        for one in ranked
    ]
    assert shown[:4] == [("both", "b"), ("other", "d"), ("both", "c"), ("both", "c")]
    assert [frame for frame, _ in shown[4:]] == ["f0", "f10", "f20"]
    assert len(ranked) == 7


def test_a_picture_of_pairs_shown_already_waits() -> None:
    moments = [pair("a", "b", 0, "one"), pair("c", "d", 0, "one")]
    moments += [pair("a", "b", 9, "two"), pair("e", "f", 9, "two", probability=0.85)]
    ranked = rank(moments, "all", spread=True)
    assert [one.moment.figure.sighting.object_id for one in ranked] == ["a", "e", "c", "a"]


def test_repeats_of_one_thing_alone_keep_their_score() -> None:
    ranked = rank([moment("a", 0), moment("a", 100)], "all", spread=True)
    assert [one.score for one in ranked] == pytest.approx([0.9, 0.9])


def test_a_moment_asked_for_puts_the_nearest_first_and_before_is_nearer() -> None:
    seen = [("a", 0, 0), ("a", 40, 1), ("b", 47, 0), ("a", 200, 2)]
    moments = [moment(name, minute * 60_000, place=place) for name, minute, place in seen]
    ranked = rank(moments, "all", spread=False, at_ms=50 * 60_000)
    starts = [one.moment.start_ms // 60_000 for one in ranked]
    assert starts == [47, 40, 0, 200]
    ranked = rank(moments, "all", spread=False, at_ms=200 * 60_000 - 20_000)
    assert ranked[0].moment.start_ms == 200 * 60_000  # it was seen in that minute


def test_last_goes_by_time_among_those_at_least_half_as_likely() -> None:
    late = moment("late", 900, probability=0.9 * LEAST_OF_BEST - 0.01)
    moments = [moment("a", 0), moment("b", 500, probability=0.6), late]
    assert order(moments, "last") == ["b@500", "a@0", "late@900"]
    assert order(moments, "first") == ["a@0", "b@500", "late@900"]


def test_last_shows_each_place_once_before_any_twice() -> None:
    moments = [moment("a", 0), moment("a", 100), moment("a", 50, place=1)]
    assert order(moments, "last") == ["a@100", "a@50", "a@0"]


drawn = st.builds(
    moment,
    st.sampled_from("abc"),
    st.integers(0, 50),
    place=st.integers(0, 2),
    probability=st.floats(0, 1),
    match=st.floats(0.01, 1),
    seen=st.integers(1, 400),
    tentative=st.booleans(),
    attributes=st.dictionaries(st.sampled_from(["red", "big"]), st.floats(0, 1)),
    relation=st.none() | st.floats(0, 1),
)


@given(
    st.lists(drawn, max_size=12),
    st.sampled_from(["all", "last", "first", "usual"]),
    st.booleans(),
    st.integers(0, 3),
)
def test_scores_are_probabilities_and_the_order_is_fixed(
    moments: list[Moment], select: Select, spread: bool, unjudged: int
) -> None:
    ranked = rank(moments, select, spread=spread, unjudged=unjudged)
    assert len(ranked) == len(moments)
    assert all(0 <= one.score <= 1 for one in ranked)
    again = rank(list(reversed(moments)), select, spread=spread, unjudged=unjudged)
    assert [one.score for one in ranked] == [one.score for one in again]
    if select == "all":
        scores = [one.score for one in ranked]
        assert scores == sorted(scores, reverse=True)


@given(drawn)
def test_a_part_of_a_score_is_never_above_one(one: Moment) -> None:
    score, _ = entry_score(one.figure)
    assert 0 <= score <= min(1.0, one.figure.candidate.match + 1e-9)


def test_what_is_not_told_needs_no_order_but_keeps_its_place_below() -> None:
    moments = [moment("a", 0, place=place) for place in range(4)]
    moments += [moment(name, 0, probability=0.895) for name in "bcdef"]
    every = rank(moments, "all", spread=True)
    for told in (1, 3, 6):
        some = rank(moments, "all", spread=True, told=told)
        assert some[:told] == every[:told]
        assert sorted(map(id, (one.moment for one in some))) == sorted(map(id, moments))
