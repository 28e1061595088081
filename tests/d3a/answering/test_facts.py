"""What is read of a store once: again after a write, and never otherwise than the store has it."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from d3a.answering import facts as facts_module
from d3a.answering import revision
from d3a.answering.attributes import Looks
from d3a.answering.facts import Facts
from d3a.answering.match import Candidate
from d3a.answering.moments import in_slice, joined
from d3a.plan import FindObjects
from d3a.store import open_store
from d3a.store.base import Batch, NativeQuery, Region, Store
from tests.worlds.made import HOUR_MS, NOON, Home, Words, ms
from tests.worlds.oracle import OracleStore

ROOM = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))


def home() -> Home:
    home = Home()
    home.thing("cup", "cup", votes=(("cup", 3.0), ("bowl", 2.0)))
    home.seen("cup", 0, 150, at=(1, 1, 1))  # longer than the store's limit: two sightings or more
    home.seen("cup", 300, 310, at=(5, 1, 1), place=1)
    home.thing("desk", "table")
    home.seen("desk", 0, 10, at=(1, 1, 0.7), times=9)
    return home


def read_all(store: Store) -> None:
    facts = Facts(store)
    facts.categories(), facts.names(), facts.regions(), facts.classes(), facts.parameters()
    facts.objects(["cup"], embeddings=True)
    facts.objects(None, embeddings=False)
    facts.sightings(["cup", "desk"], None, None)
    facts.stays(["cup", "desk"])
    facts.palette()
    facts.landmarks(Words())
    facts.last_view_ms()
    facts.usual_grounds("on", Words())


def test_a_store_is_read_once_until_somebody_writes(tmp_path: Path) -> None:
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as writer, closing(open_store(path, read_only=True)) as store:
        home().into(writer)
        told: list[NativeQuery] = []
        store.tracing(told.append)
        read_all(store)
        assert told
        told.clear()
        read_all(store)
        assert told == []
        writer.apply(Batch(regions=[Region("attic", ROOM)]))
        assert [region.name for region in Facts(store).regions()] == ["attic"]
        assert told


def test_what_is_kept_is_not_what_a_question_changes(tmp_path: Path) -> None:
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        home().into(store)
        whole = Facts(store).sightings(["cup"], None, None)
        Facts(store).sightings(["cup"], None, None).clear()
        assert Facts(store).sightings(["cup"], None, None) == whole
        assert [s.place for s in whole] == [0, 1]


def test_what_a_noun_means_and_how_it_looks_is_worked_out_once(tmp_path: Path) -> None:
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as store:
        made = home()
        made.thing("other", "cup", paint="red")
        made.seen("other", 5, at=(2, 1, 1))
        made.into(store)
        step, worth = FindObjects("x", "cup", "cup"), {"cup": 1.0}

        def meant(facts: Facts, step: FindObjects = step) -> list[Candidate]:
            return facts.candidates(step, facts.objects(["cup"], embeddings=True), worth, 0.1)

        def looks(facts: Facts) -> Looks | None:
            return facts.looks([candidate.record for candidate in meant(facts)])

        first = meant(Facts(store))
        assert [c.record.object_id for c in first] == ["cup", "other"]
        assert meant(Facts(store)) is first
        assert meant(Facts(store), replace(step, var="y")) is first
        assert meant(Facts(store), replace(step, votes=True)) is not first
        seen = looks(Facts(store))
        assert seen is not None
        assert seen.rows.tolist() == [1]
        assert looks(Facts(store)) is seen
        store.apply(Batch(regions=[Region("attic", ROOM)]))
        assert meant(Facts(store)) is not first
        assert looks(Facts(store)) is not seen


def test_colours_are_learned_anew_where_looks_or_views_changed() -> None:
    made = home()
    for name in ("red", "green"):
        made.thing(name, "cup", paint=name)
        made.seen(name, 5, at=(2, 1, 1))
    store = made.into(OracleStore())
    first = Facts(store).palette()
    assert first.count == 2
    store.apply(Batch(regions=[Region("attic", ROOM)]))
    assert Facts(store).palette() is first
    red, green = store.objects(ids=["red", "green"])[::-1]
    assert (red.object_id, green.object_id) == ("red", "green")
    store.apply(Batch(objects=[replace(red, weight=20.0)]))
    better_seen = Facts(store).palette()
    assert better_seen.learned.called.sum() > first.learned.called.sum()
    store.apply(Batch(objects=[replace(red, embedding=green.embedding)]))
    assert Facts(store).palette().total.tolist() != first.total.tolist()


def test_candidates_are_of_the_records_given() -> None:
    facts = Facts(home().into(OracleStore()))
    step, records = FindObjects("x", "cup", "cup"), facts.objects(["cup"], embeddings=False)
    assert len(facts.candidates(step, records, {"cup": 1.0}, 0.1)) == 1
    assert facts.candidates(step, [], {"cup": 1.0}, 0.1) == []
    heavier = [replace(record, weight=99.0) for record in records]
    assert facts.candidates(step, heavier, {"cup": 1.0}, 0.1)[0].record.weight == 99.0


def test_two_stores_are_not_taken_for_one_another() -> None:
    one, other = home().into(OracleStore()), Home().into(OracleStore())
    assert Facts(one).categories() == ["cup", "table"]
    assert Facts(other).categories() == []


@pytest.mark.parametrize("warm", [False, True])
@pytest.mark.parametrize("span", [(None, None), (1.5, None), (None, 1.2), (0.5, 1.5), (4, 6)])
def test_a_slice_is_the_same_whether_the_rest_is_known(
    warm: bool, span: tuple[float | None, float | None]
) -> None:
    store = home().into(OracleStore())
    facts = Facts(store)
    if warm:
        facts.sightings(["cup", "desk"], None, None)
    start, end = (None if hours is None else ms(NOON) + round(hours * HOUR_MS) for hours in span)
    expected = joined(s for s in store.sightings(object_ids=["cup"]) if in_slice(s, start, end))
    assert facts.sightings(["cup"], start, end) == expected
    assert expected


def test_more_than_may_be_kept_is_read_each_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(revision, "MOST_STAYS", 1)
    monkeypatch.setattr(revision, "MOST_SIGHTINGS", 1)
    store = home().into(OracleStore())
    facts = Facts(store)
    for _ in range(2):
        assert len(facts.objects(None, embeddings=False)) == 2
        assert list(facts.stays(["cup"])) == [("cup", 0), ("cup", 1)]
        assert len(facts.sightings(["cup"], None, None)) == 2


def test_a_question_of_everything_keeps_no_room_from_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(revision, "MOST_OBJECTS", 2)
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        facts = Facts(home().into(store))
        assert len(facts.objects(None, embeddings=False)) == 2
        found = facts.objects(["cup"], embeddings=False)
        assert facts.objects(["cup"], embeddings=False) is found


def test_of_a_large_memory_the_asked_stays_are_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(facts_module, "FEW_OBJECTS", 1)
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        facts = Facts(home().into(store))
        early, late = facts.sightings(["cup"], None, None)
        assert facts.stays_of([late]).keys() == {("cup", 1)}
        told: list[NativeQuery] = []
        store.tracing(told.append)
        assert facts.stays_of([late]) == {("cup", 1): store.stays(object_ids=["cup"])[1]}
        told.clear()
        assert facts.stays_of([late, late, early]).keys() == {("cup", 0), ("cup", 1)}
        assert [query.rows for query in told] == [1]
        assert facts.stays_of([early], whole=True).keys() == {("cup", 0), ("cup", 1)}


def test_a_landmark_has_its_category_as_people_say_it() -> None:
    assert Facts(home().into(OracleStore())).landmarks(Words()).categories == ("table",)
