"""Forgetting: what is asked for goes everywhere, and nothing else does."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from assistant.lexicon import VocabularyLexicon
from d3a.checkpoint import pack, unpack
from d3a.correcting.cutting import Slice
from d3a.correcting.forgetting import ForgetPlan, forget, people, plan_forgetting
from d3a.correcting.forgotten import UNSCRUBBED, Selection
from d3a.correcting.retention import plan_retention, retention_of, seconds_of, set_retention
from d3a.ingest import ingest
from d3a.model import BadInput, Frame
from d3a.parameters import PROFILES, Parameters
from d3a.store import open_store
from d3a.store.base import FORGOTTEN, Batch, Keyframe, Store, StoreError, TaughtName
from d3a.teaching import history, merge, teach_name
from tests.worlds import histories, small_home
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, jpeg, rounds

COUNTED = ("objects", "encounters", "views", "keyframes")
SECRET = "zither case"
"""A category of which no piece turns up by chance."""


def world(frames: int = 40) -> list[Frame]:
    """Four things on a circle; the secret one is seen in the first half alone."""
    at = circle(1.5, 8)
    things = [
        Thing("cup", at[0], 1),
        Thing("bowl", at[2], 2),
        Thing(SECRET, at[4], 3, until=frames // 2),
        Thing("person", at[6], 4),
    ]
    made = rounds(things, frames, 7, noise_m=0.05, missed=0.3)
    return [replace(frame, image=jpeg(n % 150)) for n, frame in enumerate(made)]


def small(profile: str) -> Parameters:
    return PROFILES[profile].with_changes(
        stm_capacity=6, checkpoint_frames=5, interval_gap_s=20.0, unbroken_gaps=1.0
    )


def filled(store: Store, profile: str = "default", cut: int | None = None) -> list[Frame]:
    frames = world()
    ingest(ListReader(frames), store, small(profile), max_frames=cut)
    return frames


def ids_of(store: Store, category: str) -> frozenset[str]:
    return frozenset(r.object_id for r in store.objects(categories=[category]))


def forgotten(store: Store, selection: Selection) -> ForgetPlan:
    plan = plan_forgetting(store, selection)
    assert not plan.is_empty
    forget(store, plan)
    assert store.check() == []
    return plan


def texts(store: Store) -> str:
    return "\n".join(json.dumps(record, ensure_ascii=False) for record in store.dump())


@pytest.mark.parametrize("cut", [None, 17], ids=["ended", "open"])
@pytest.mark.parametrize("profile", ["default", "paper"])
def test_no_byte_of_a_forgotten_thing_is_left(
    tmp_path: Path, profile: str, cut: int | None
) -> None:
    with closing(open_store(str(tmp_path / "lab.db"))) as store:
        filled(store, profile, cut)
        ids = ids_of(store, SECRET)
        for record in store.objects(ids=sorted(ids)):
            store.apply(Batch(objects=[replace(record, names=(TaughtName("heirloom", "zoe"),))]))
        looks = [
            r.embedding.tobytes() for r in store.objects(ids=sorted(ids)) if r.embedding is not None
        ]
        before = {k: p.jpeg for k in store.keyframe_keys() if (p := store.keyframe(k))}
        plan = forgotten(store, Selection(object_ids=ids))
        gone = [before[key] for key in before.keys() - set(store.keyframe_keys())]
        assert (len(gone), plan.objects) == (plan.keyframes, len(ids))
        assert len(gone) >= 1
        kept = store.keyframe_keys()
        files = b"".join(file.read_bytes() for file in sorted(tmp_path.iterdir()))
    assert len(looks) == len(ids) >= 1
    assert b"cup" in files
    for trace in (SECRET.encode(), b"heirloom", b"zoe", *looks, *gone):
        assert trace not in files
    assert all(before[key] in files or len(before[key]) > 4000 for key in kept)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_an_interrupted_ingest_goes_on_after_forgetting(profile: str) -> None:
    store = OracleStore()
    frames = filled(store, profile, cut=17)
    forgotten(store, Selection(object_ids=ids_of(store, SECRET) | ids_of(store, "cup")))
    assert ids_of(store, "cup") == frozenset()
    summary = ingest(ListReader(frames), store, small(profile))
    assert (summary.frames, summary.already_frames) == (len(frames) - 17, 17)
    assert store.check() == []
    assert len(ids_of(store, "cup")) == 1, "it was seen again"
    assert all(
        s.start_ms > frames[16].time_ms
        for s in store.sightings(object_ids=sorted(ids_of(store, "cup")))
    )


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_the_same_recording_does_not_bring_it_back(profile: str) -> None:
    store = OracleStore()
    frames = filled(store, profile)
    forgotten(store, Selection(object_ids=ids_of(store, SECRET)))
    before = texts(store)
    summary = ingest(ListReader(frames), store, small(profile))
    assert summary.already
    assert texts(store) == before
    assert SECRET not in before
    assert store.meta(FORGOTTEN) == 1
    assert store.meta(UNSCRUBBED) is None


def test_a_picture_that_shows_it_goes_from_its_neighbour_too() -> None:
    store = OracleStore()
    small_home.fill(store)
    plan = forgotten(store, Selection(object_ids=frozenset({"cup-1"})))
    assert plan.also_shown == 1
    assert store.keyframe_keys() == ["p1", "p3"]
    assert [s.image for s in store.sightings(object_ids=["keys-1"])] == ["p3", None, "p1"]


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_a_time_goes_with_its_views_and_pictures(profile: str) -> None:
    store = OracleStore()
    frames = filled(store, profile)
    start, end = frames[10].time_ms, frames[20].time_ms
    seen = sum(s.seen for s in store.sightings())
    forgotten(store, Selection(time=Slice(start, end)))
    for kind in (store.sightings, store.encounters, store.views):
        assert kind(start_ms=start, end_ms=end - 1) == []
    pictures = [store.keyframe(key) for key in store.keyframe_keys()]
    assert pictures
    assert not any(start <= p.time_ms < end for p in pictures if p is not None)
    assert 0 < sum(s.seen for s in store.sightings()) < seen
    for stay in store.stays():
        mine = [s for s in store.sightings() if s.stay == stay.key]
        assert (min(s.start_ms for s in mine), max(s.end_ms for s in mine)) == (
            stay.first_ms,
            stay.last_ms,
        )


def test_a_place_goes_with_what_lay_there() -> None:
    store = OracleStore()
    small_home.fill(store)
    kitchen = next(r for r in store.regions() if r.name == "kitchen")
    plan = forgotten(store, Selection(region=kitchen))
    assert {lost.object_id: lost.whole for lost in plan.lost} == {
        "keys-1": False, "cup-1": True, "bowl-1": True,
    }  # fmt: skip
    assert {s.key for s in store.stays()} == {("keys-1", 1), ("couch-1", 5)}
    assert [r.name for r in store.regions()] == ["hall", "kitchen", "lab"]
    assert len(store.views()) == 1, "it was looked from the lab"


def test_people_go_by_every_word_for_them() -> None:
    store = OracleStore()
    filled(store)
    (cup,) = store.objects(categories=["cup"])
    votes = (("cup", cup.weight), ("man", 0.4))
    sighting = store.sightings(object_ids=[cup.object_id])[0]
    store.apply(
        Batch(
            objects=[replace(cup, categories=votes)],
            sightings=[replace(sighting, category="man")],
            meta={"classes": ["cup", "man", "person"]},
        )
    )
    words = people(store, VocabularyLexicon())
    assert words == {"man", "person"}
    forgotten(store, Selection(categories=words))
    assert ids_of(store, "person") == frozenset()
    assert dict(store.objects(ids=[cup.object_id])[0].categories).keys() == {"cup"}
    left = store.sightings(object_ids=[cup.object_id])
    assert left
    assert sighting.start_ms not in {s.start_ms for s in left}
    assert "person" not in (store.meta("categories") or ())


@pytest.mark.parametrize("cut", [None, 17])
def test_a_store_that_an_earlier_release_filled_forgets_too(cut: int | None) -> None:
    store = OracleStore()
    filled(store, cut=cut)
    record, arrays = unpack(store.state() or b"")
    del record["pipeline"]["others"], record["pipeline"]["recall"]["asleep"]
    store.apply(Batch(state=pack(record, arrays)))
    forgotten(store, Selection(object_ids=ids_of(store, "cup")))
    assert not ids_of(store, "cup")


def test_nothing_named_is_refused_and_nothing_found_is_empty() -> None:
    store = OracleStore()
    small_home.fill(store)
    with pytest.raises(BadInput, match="nothing says what"):
        plan_forgetting(store, Selection())
    assert plan_forgetting(store, Selection(object_ids=frozenset({"ghost"}))).is_empty
    assert plan_forgetting(store, Selection(time=Slice(None, 5))).is_empty


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_retention_is_kept_and_applied_by_a_later_ingest(profile: str) -> None:
    store = OracleStore()
    frames = filled(store, profile, cut=20)
    set_retention(store, 60)
    assert retention_of(store) == 60
    summary = ingest(ListReader(frames), store, small(profile))
    before = frames[-1].time_ms - 60_000
    assert summary.forgotten > 0
    assert not store.sightings(end_ms=before - 1)
    assert not store.views(end_ms=before - 1)
    assert plan_retention(store, 60) is None
    once = texts(store)
    assert ingest(ListReader(frames), store, small(profile)).already
    assert texts(store) == once
    set_retention(store, None)
    assert retention_of(store) is None


@pytest.mark.parametrize(
    ("span", "seconds"), [("30d", 2_592_000), ("12h", 43_200), (" 1W", 604_800)]
)
def test_spans_are_read(span: str, seconds: int) -> None:
    assert seconds_of(span) == seconds


@pytest.mark.parametrize("span", ["", "0d", "30", "d", "-3d", "3 months"])
def test_other_spans_are_refused(span: str) -> None:
    with pytest.raises(BadInput, match="12h, 30d"):
        seconds_of(span)


slices = st.tuples(st.none() | histories.instants, st.none() | histories.instants).map(
    lambda ends: Slice(*ends)
)
selections = st.builds(
    Selection,
    object_ids=st.none() | st.frozensets(histories.ids, max_size=2),
    categories=st.none() | st.frozensets(st.sampled_from(histories.CATEGORIES), max_size=1),
    region=st.none() | histories.regions,
    time=slices,
).filter(lambda selection: not selection.is_everything)


@given(batches=st.lists(histories.batches(), min_size=1, max_size=4), selection=selections)
@settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
def test_drawn_stores_lose_the_same_and_exactly_what_was_planned(
    make_store: Callable[[], Store], batches: list[Batch], selection: Selection
) -> None:
    oracle = OracleStore()
    with closing(make_store()) as store:
        for batch in histories.accepted(oracle, [replace(b, state=None) for b in batches]):
            store.apply(batch)
        plan = plan_forgetting(store, selection)
        wanted = plan_forgetting(oracle, selection)
        assert plan.to_json() == wanted.to_json()
        before = store.counts()
        pictures = sum(len(p.jpeg) for p in _pictures(store))
        forget(store, plan)
        forget(oracle, wanted)
        assert list(store.dump()) == list(oracle.dump())
        after = store.counts()
        assert before["objects"] - after["objects"] == plan.objects
        assert before["stays"] - after["stays"] == plan.places
        assert before["sightings"] - after["sightings"] == plan.intervals
        assert before["encounters"] - after["encounters"] == plan.encounters
        assert before["keyframes"] - after["keyframes"] == plan.keyframes
        assert plan.bytes >= pictures - sum(len(p.jpeg) for p in _pictures(store))
        assert _nothing_left(store, selection)
        assert plan_forgetting(store, selection).is_empty


def _pictures(store: Store) -> Iterable[Keyframe]:
    return [p for key in store.keyframe_keys() if (p := store.keyframe(key)) is not None]


def _nothing_left(store: Store, selection: Selection) -> bool:
    """Whether no sighting is left that the selection names, judged anew."""
    called = {r.object_id: r.category for r in store.objects()}
    placed = {s.key: s for s in store.stays()}
    return not [
        s
        for s in store.sightings()
        if (selection.object_ids is None or s.object_id in selection.object_ids)
        and (
            selection.categories is None or {s.category, called[s.object_id]} & selection.categories
        )
        and (selection.region is None or _triangle(placed[s.stay].position))
        and selection.time.touches(s.start_ms, s.end_ms)
    ]


def _triangle(position: tuple[float, float, float] | None) -> bool:
    return position is not None and min(position[:2]) > 0 and position[0] + position[1] < 1


def test_what_people_said_of_it_goes_and_no_undo_brings_it_back(tmp_path: Path) -> None:
    with closing(open_store(str(tmp_path / "lab.db"))) as store:
        filled(store)
        (secret,) = ids_of(store, SECRET)
        (cup,) = ids_of(store, "cup")
        (bowl,) = ids_of(store, "bowl")
        teach_name(store, secret, "heirloom", "zoe")
        teach_name(store, cup, "grail")
        merge(store, cup, bowl, force=True)
        forgotten(store, Selection(object_ids=frozenset({secret})))
        assert [each.kind for each in history(store)] == ["teach", "merge"]
        assert [each.is_sealed for each in history(store)] == [False, True]
        assert store.meta("correction:3:0") is None, "it told that the two met the secret thing"
        files = b"".join(file.read_bytes() for file in sorted(tmp_path.iterdir()))
        assert b"grail" in files
        assert b"heirloom" not in files
        assert b"zoe" not in files
        assert f'"{secret}"' not in texts(store)


@pytest.mark.parametrize("profile", ["default", "paper"])
def test_an_ingest_that_runs_meanwhile_stops_and_goes_on_without_it(profile: str) -> None:
    store, frames = OracleStore(), world()

    def speak(done: int, _total: int | None) -> None:
        if done == 17:
            forgotten(store, Selection(object_ids=ids_of(store, SECRET)))

    with pytest.raises(StoreError, match="forgotten while this ingest ran; it goes on"):
        ingest(ListReader(frames), store, small(profile), on_progress=speak)
    assert ids_of(store, SECRET) == frozenset()
    summary = ingest(ListReader(frames), store, small(profile))
    assert summary.already_frames == 15, "its last checkpoint"
    assert not store.sightings(object_ids=sorted(ids_of(store, SECRET)), end_ms=frames[14].time_ms)
    assert store.check() == []


def test_a_plan_takes_along_what_was_written_since(make_store: Callable[[], Store]) -> None:
    """Forgetting wins over a checkpoint that came between the plan and its carrying out."""
    with closing(make_store()) as store:
        frames = filled(store, cut=10)
        cups = Selection(object_ids=ids_of(store, "cup"))
        plan = plan_forgetting(store, cups)
        ingest(ListReader(frames), store, small("default"), max_frames=5)
        done = forget(store, plan)
        assert done.is_anew
        assert done.plan.batch.state != plan.batch.state
        assert plan_forgetting(store, cups).is_empty
        assert not store.sightings(object_ids=sorted(ids_of(store, "cup")))
        assert store.check() == []
        again = plan_forgetting(store, Selection(object_ids=ids_of(store, "bowl")))
        assert not forget(store, again).is_anew


@pytest.mark.parametrize("cut", [None, 17], ids=["ended", "open"])
def test_no_document_on_a_server_tells_of_it(mongo_uri: str, cut: int | None) -> None:
    from pymongo import MongoClient

    with closing(open_store(mongo_uri)) as store:
        filled(store, "default", cut)
        (secret,) = ids_of(store, SECRET)
        (record,) = store.objects(ids=[secret])
        assert record.embedding is not None
        look = record.embedding.tobytes()
        teach_name(store, secret, "heirloom", "zoe")
        plan = plan_forgetting(store, Selection(object_ids=frozenset({secret})))
        assert not forget(store, plan).is_scrubbed, "the server frees its space by itself"
        assert store.check() == []
    with MongoClient[dict[str, object]](mongo_uri) as client:
        database = client.get_default_database()
        names = database.list_collection_names()
        found = [repr(d) for name in names for d in database[name].find({})]
    assert any("'cup'" in text for text in found)
    for trace in (SECRET, "heirloom", "zoe", f"'{secret}'", f'"{secret}"', repr(look)[2:-1]):
        assert not any(trace in text for text in found), trace
