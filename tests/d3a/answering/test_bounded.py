"""What is read where far more was seen than can be told."""

from __future__ import annotations

import random
from contextlib import closing
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest

from assistant.asking import ask
from d3a.answer import Answer
from d3a.answering import bounded, facts
from d3a.answering.facts import Facts
from d3a.answering.moments import joined
from d3a.store import open_store, sqlite_newest
from d3a.store.base import Batch, Encounter, NativeQuery, Sighting, StayKey, Store
from d3a.store.newest import newest_of
from tests.worlds import scaled
from tests.worlds.made import NOON, NOW, Home, ms
from tests.worlds.oracle import OracleStore

MIN = 60_000


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A small drawn home on disk: 600 stays of 15 objects and more."""
    path = str(tmp_path_factory.mktemp("scaled") / "home.db")
    with closing(open_store(path)) as store:
        scaled.fill(store, 600, seed=3)
    return path


@pytest.mark.parametrize(
    ("many", "probe", "times"),
    [(0, 4, 10), (0, 1_000_000, 10), (10, 4, 10), (1000, 4, 10), (1000, 4, 0)],
)
def test_the_newest_of_each_stay_by_windows_as_by_reading_all(
    home: str, many: int, probe: int, times: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_newest, "MANY_IDS", many)
    monkeypatch.setattr(sqlite_newest, "PROBE", probe)  # so large: time is walked through
    monkeypatch.setattr(sqlite_newest, "MANY_TIMES", times)  # 0: few are walked through, too
    draw = random.Random(many)
    first, last = scaled.span_ms(600)
    with closing(open_store(home, read_only=True)) as store:
        ids = [record.object_id for record in store.objects(embeddings=False)]
        for _ in range(60):
            some = draw.sample(ids, draw.choice((1, 2, 5, len(ids))))
            low, high = sorted(draw.randint(first - 9_999, last + 9_999) for _ in range(2))
            start, end = draw.choice((None, low)), draw.choice((None, high))
            limit, oldest = draw.choice((1, 7, 60, 5_000)), draw.random() < 0.5
            read = store.sightings(object_ids=some, start_ms=start, end_ms=end)
            found = store.newest(some, limit, start_ms=start, end_ms=end, oldest=oldest)
            assert found == newest_of(read, limit, oldest=oldest)
            seen = store.count_seen([*some, some[0]], start_ms=start, end_ms=end)
            assert seen == len({sighting.object_id for sighting in read})


def stays_of(found: list[Sighting]) -> list[StayKey]:
    return sorted({sighting.stay for sighting in found})


def test_stays_of_what_was_read_last_are_found_without_an_index(home: str) -> None:
    with closing(open_store(home, read_only=True)) as store:
        ids = [record.object_id for record in store.objects(embeddings=False)]
        for limit in (5, 60):
            keys = stays_of(store.newest(ids, limit))
            wanted = [stay for stay in store.stays() if stay.key in keys]
            asked: list[NativeQuery] = []
            store.tracing(asked.append)
            assert store.stays_at([*reversed(keys), keys[0]]) == wanted
            store.tracing(None)
            assert [query.index for query in asked] == ["INTEGER PRIMARY KEY"]
            assert store.stays_at([(ids[0], 99), keys[0]]) == wanted[:1]


def test_a_stay_that_another_wrote_anew_is_found_where_it_is_now(tmp_path: Path) -> None:
    home = Home()
    for name in ("a", "b", "c"):
        home.thing(name, "cup")
        home.seen(name, 10, at=(1.0, 1.0, 0.0))
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as store, closing(open_store(path)) as other:
        home.into(store)
        keys = stays_of(store.newest(["a", "b", "c"], 9))
        stays, sightings = other.stays(), other.sightings()
        other.apply(Batch(removed_stays=keys))
        swapped = list(reversed(stays))  # each lies where another lay
        other.apply(Batch(stays=swapped, sightings=sightings))
        assert store.stays_at(keys) == stays
        other.apply(Batch(removed_stays=keys[:1]))
        assert store.stays_at(keys) == stays[1:]


def test_a_choice_of_the_newest_is_not_kept_as_all_that_there_is(tmp_path: Path) -> None:
    home = Home()
    home.thing("c", "cup")
    for place in range(3):
        home.seen("c", place, place=place)
    for number in range(40):
        home.seen("c", 10 + number / 2, at=(1.0, 1.0, 0.0))
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        home.into(store)
        every = store.sightings(object_ids=["c"])
        assert len(Facts(store).newest(["c"], 20, None, None)) < 20  # as much of each stay
        assert Facts(store).sightings(["c"], None, None) == every
        assert Facts(store).newest(["c"], 60, None, None) == every


def test_of_few_things_all_is_read_once_and_the_same_is_chosen(tmp_path: Path) -> None:
    home = Home()
    for name in ("c", "d"):
        home.thing(name, "cup")
        for number in range(30):
            home.seen(name, 10 * number, 10 * number + 5, place=number % 3)
    with closing(open_store(str(tmp_path / "home.db"))) as store:
        home.into(store)
        first = store.sightings()[0].start_ms
        slices = [(None, None), (first + 900_000, None), (first + 900_000, first + 9_000_000)]
        wanted = [
            store.newest(["c", "d"], 12, start_ms=a, end_ms=None if b is None else b - 1)
            for a, b in slices
        ]
        assert Facts(store).newest(["c", "d"], 12, *slices[0]) == wanted[0]
        asked: list[NativeQuery] = []
        store.tracing(asked.append)
        found = [Facts(store).newest(["c", "d"], 12, a, b) for a, b in slices]
        assert found == wanted
        assert asked == []


@pytest.fixture
def cups() -> OracleStore:
    """A cup at one place 600 times and once at another before; a red ball before many pink ones."""
    home = Home()
    home.thing("c", "cup")
    home.seen("c", -90, at=(8.0, 1.0, 0.0), place=1)
    home.thing("red", "ball", paint="red")
    home.seen("red", -80, at=(5.0, 5.0, 0.0))
    for number in range(600):
        home.seen("c", number / 2, at=(1.0, 1.0, 0.0))
    for number in range(300):
        home.thing(f"pink{number}", "ball", paint="pink")
        home.seen(f"pink{number}", number / 2)
    store = OracleStore()
    home.into(store)
    return store


def told(store: Store, text: str) -> Answer:
    return ask(store, text, now=NOW)


def test_a_place_is_told_however_often_another_was_seen(cups: Store) -> None:
    answer = told(cups, "Did you see a cup?")
    assert answer.truncated
    assert answer.count == 1
    assert {k.position for k in answer.keyframes[:2]} == {(1.0, 1.0, 0.0), (8.0, 1.0, 0.0)}


def test_the_oldest_are_read_where_they_are_asked_for(cups: Store) -> None:
    first = told(cups, "When did you first see the cup?")
    assert first.keyframes[0].position == (8.0, 1.0, 0.0)


def test_the_likeliest_is_told_however_many_came_since(cups: Store) -> None:
    answer = told(cups, "Did you see a red ball?")
    assert answer.keyframes[0].object_id == "red"


def test_all_are_counted_where_not_all_are_read(cups: Store) -> None:
    answer = told(cups, "Did you see a ball?")
    assert answer.truncated
    assert answer.count == 301


def test_numbers_are_of_all_that_was_seen(cups: Store) -> None:
    assert told(cups, "How often did you see the cup?").value == 601


def test_a_store_that_was_read_before_answers_the_same(cups: Store) -> None:
    questions = ("Did you see a cup?", "Where is the ball?", "When did you first see the ball?")
    alone = [told(cups, question) for question in questions]
    ask(cups, "How many things did you see?", now=NOW)  # everything is known now
    again = [told(cups, question) for question in questions]
    assert [a.keyframes for a in again] == [a.keyframes for a in alone]


class Noted(OracleStore):
    """Notes from when on sightings, and between when encounters, are read."""

    def __init__(self) -> None:
        super().__init__()
        self.from_ms: list[int | None] = []
        self.asked_of: list[tuple[int | None, int | None]] = []

    def sightings(self, **asked: Any) -> list[Sighting]:
        self.from_ms.append(asked.get("start_ms"))
        return super().sightings(**asked)

    def encounters(self, **asked: Any) -> list[Encounter]:
        self.asked_of.append((asked["start_ms"], asked["end_ms"]))
        return super().encounters(**asked)


def crowd() -> Noted:
    """A cup seen every minute for an hour, a bowl every half hour for ten; at times together."""
    home = Home()
    for name in ("cup", "bowl"):
        home.thing(name, name)
    for minute in range(-60, 0):
        home.seen("cup", minute, minute + 0.2, at=(1.0, 1.0, 0.0))
    for number in range(20):
        home.seen("bowl", 30 * number - 600, 30 * number - 599.8, at=(6.0, 1.0, 0.0))
    home.met("bowl", "cup", -509.9)  # of the bowl alone a sighting is found then
    home.met("bowl", "cup", -29.9)
    store = Noted()
    home.into(store)
    return store


def test_a_relation_is_looked_for_from_when_on_all_of_its_things_are_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(bounded, "MOST_JOINED", 45)
    monkeypatch.setattr(facts, "FEW_SIGHTINGS", 1)  # it is not a home of few things
    store = crowd()
    answer = told(store, "Did you see a bowl with a cup?")
    since = next(s.start_ms for s in reversed(store.sightings()) if s.object_id == "cup") - 44 * MIN
    assert [ms for ms in store.from_ms if ms is not None] == [since, since]
    assert answer.truncated
    assert answer.count == 1
    assert {k.start for k in answer.keyframes} == {NOON + timedelta(minutes=-29.9)}
    monkeypatch.setattr(bounded, "MOST_JOINED", 10_000)
    whole = told(store, "Did you see a bowl with a cup?")
    assert not whole.truncated
    assert whole.keyframes == answer.keyframes


def test_the_first_time_of_a_relation_is_looked_for_from_the_oldest_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    home = Home()
    for name in ("cup", "bowl"):
        home.thing(name, name)
        for minute in range(-60, 0):
            home.seen(name, minute, minute + 0.2, at=(1.0, 1.0, 0.0))
    home.met("bowl", "cup", -49.9)
    home.met("bowl", "cup", -9.9)
    said = "When did you first see a bowl with a cup?"
    whole = told(home.into(OracleStore()), said)
    monkeypatch.setattr(bounded, "MOST_JOINED", 20)
    monkeypatch.setattr(facts, "FEW_SIGHTINGS", 1)  # it is not a home of few things
    cut = told(home.into(OracleStore()), said)
    assert cut.truncated
    assert cut.keyframes[0].start == whole.keyframes[0].start
    assert cut.answer.split(". ")[0] == whole.answer.split(". ")[0]


def test_beside_the_number_of_times_stands_the_newest_of_them() -> None:
    home = Home()
    for name in ("cup", "bowl"):
        home.thing(name, name)
        for minute in range(-60, 0):
            worse = 0.9 if minute < -10 else 0.6
            home.seen(name, minute, minute + 0.2, at=(1.0, 1.0, 0.0), probability=worse)
    said = "How often was the bowl with the cup?"
    store = home.into(OracleStore())
    few, many = (ask(store, said, now=NOW, limit=limit).keyframes for limit in (4, 500))
    newest = max(keyframe.end for keyframe in many)
    assert max(keyframe.end for keyframe in few) == newest


def test_what_was_seen_without_the_other_is_told_where_it_was(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    home = Home()
    for number, name in enumerate(("cup", "bowl")):
        home.thing(name, name)
        for minute in range(-60, 0, 2):
            home.seen(name, minute + number, minute + number + 0.2, at=(5.0 * number, 1.0, 0.0))
    store = home.into(OracleStore())
    whole = told(store, "Did you see a bowl with a cup?")
    monkeypatch.setattr(bounded, "MOST_JOINED", 20)
    monkeypatch.setattr(facts, "FEW_SIGHTINGS", 1)
    answer = told(home.into(OracleStore()), "Did you see a bowl with a cup?")
    assert answer.status == whole.status == "not_found"
    assert answer.truncated
    assert answer.otherwise == whole.otherwise
    assert answer.otherwise is not None
    assert answer.otherwise.position == (5.0, 1.0, 0.0)


@pytest.mark.parametrize(("at", "found"), [(-54.9, False), (-37, True), (-9.9, False)])
def test_shared_frames_are_read_where_both_things_were_seen(at: float, found: bool) -> None:
    home = Home()
    for name, first in (("cup", -60), ("bowl", -40)):
        home.thing(name, name)
        home.seen(name, first, first + 25, at=(float(first), 1.0, 0.0))
    home.met("bowl", "cup", at)
    store = Noted()
    home.into(store)
    assert (told(store, "Did you see a bowl with a cup?").status == "found") == found
    assert store.asked_of == [(ms(NOON) - 40 * MIN, ms(NOON) - 35 * MIN)]


def test_parts_of_an_interval_are_joined_in_any_order() -> None:
    draw = random.Random(5)
    box = (0.0, 0.0, 1.0, 1.0)

    def part(stay: tuple[str, int], start: int, end: int) -> Sighting:
        return Sighting(*stay, start, end, f"{stay}{start}", draw.random(), box, seen=2)

    parts = [
        part((name, place), start, start + 9)
        for name in "ab"
        for place in (0, 1)
        for start in (0, 10, 20, 31, 40)  # 31 is two from 29: not the same look
    ]
    draw.shuffle(parts)
    found = joined(parts)
    spans = [(s.start_ms, s.object_id, s.place, s.end_ms, s.seen) for s in found]
    ends = {0: (29, 6), 31: (49, 4)}
    assert spans == [(a, n, p, *ends[a]) for a in (0, 31) for n in "ab" for p in (0, 1)]
    for one in found:
        of_it = [p for p in parts if p.stay == one.stay and one.start_ms <= p.start_ms < one.end_ms]
        assert one.frame == max(of_it, key=lambda p: p.probability).frame
