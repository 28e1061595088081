"""Who writes: turns of milliseconds, and the lease of an ingest, on every kind of store."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import pytest

from d3a.ingest import ingest
from d3a.model import Frame
from d3a.parameters import PROFILES
from d3a.store import lease as leases
from d3a.store import open_store
from d3a.store.base import Batch, Expected, Store, StoreBusy, StoreConflict, StoreError
from d3a.store.lease import Lease, give_back, leased, renew, take
from tests.worlds.oracle import OracleStore
from tests.worlds.rounds import ListReader, Thing, circle, rounds

TERM_MS = round(leases.TERM_S * 1000)
Pair = tuple[Store, Store]


@pytest.fixture(params=["sqlite", "double", "D3A_TEST_MONGO_URI"])
def pair(
    request: pytest.FixtureRequest, tmp_path: Path, new_database: Callable[[str], str]
) -> Iterator[Pair]:
    """One store, opened twice, as two processes do."""
    kind: str = request.param
    uri = str(tmp_path / "home.db") if kind == "sqlite" else new_database(kind)
    with ExitStack() as stack:
        one, two = (stack.enter_context(closing(open_store(uri))) for _ in range(2))
        yield one, two


def frames(count: int = 12) -> list[Frame]:
    spots = circle(1.5, 8)
    return rounds([Thing("cup", spots[0], 1), Thing("bowl", spots[2], 2)], count, 3)


def elsewhere(store: Store) -> Lease:
    """Return the lease of an ingest on another machine, which holds the store from now."""
    other = replace(Lease.next(store.lease(), "an ingest of 'lab'", store.clock_ms()), host="robot")
    store.put_lease(other)
    return other


def test_who_has_the_turn_is_alone_from_reading_to_writing(pair: Pair) -> None:
    one, two = pair
    one.apply(Batch(meta={"count": 0}))

    def count(store: Store) -> None:
        for _ in range(10):
            with store.turn():
                store.apply(Batch(meta={"count": (store.meta("count") or 0) + 1}))

    threads = [threading.Thread(target=count, args=(store,)) for store in pair]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert one.meta("count") == two.meta("count") == 20


def test_turns_nest_and_one_that_fails_lets_the_next_begin(pair: Pair) -> None:
    one, two = pair
    with one.turn(), one.turn():
        one.apply(Batch(meta={"a": 1}))
        one.apply(Batch(meta={"b": one.meta("a")}))
    with pytest.raises(KeyError), one.turn():
        raise KeyError
    two.apply(Batch(meta={"c": two.meta("b")}))
    assert one.meta("c") == 1


def test_a_second_ingest_is_refused_and_told_whose_the_store_is(
    make_store: Callable[[], Store],
) -> None:
    with closing(make_store()) as store:
        elsewhere(store)
        numbers = PROFILES["default"].with_changes()
        told = r"filled: an ingest of 'lab' \(process \d+ on robot\) until \d\d:\d\d:\d\d UTC"
        with pytest.raises(StoreBusy, match=told):
            ingest(ListReader(frames()), store, numbers)
        assert store.recordings() == []
        assert not list(store.dump()), "a lease is no part of what a store holds"


def test_a_lease_that_ran_out_is_taken_and_its_owner_writes_no_more(
    pair: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two = pair
    mine = elsewhere(one)
    late = two.clock_ms() + TERM_MS + 1
    with pytest.raises(StoreBusy):
        take(two, "another")
    monkeypatch.setattr(two, "clock_ms", lambda: late)
    theirs = take(two, "another")
    assert theirs.fence == mine.fence + 1
    with pytest.raises(StoreConflict, match="has lost the store to another: another"):
        one.apply(Batch(meta={"a": 1}, expects=Expected(fence=mine.fence)))
    assert one.meta("a") is None
    assert not renew(one, mine)
    give_back(one, mine)
    assert one.lease() == theirs, "it is not theirs to give back"
    two.apply(Batch(meta={"a": 1}, expects=Expected(fence=theirs.fence)))


def test_an_ingest_renews_its_lease_and_gives_it_back(
    make_store: Callable[[], Store], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(leases, "TERM_S", 0.15)
    with closing(make_store()) as store:
        with leased(store, "a long ingest") as mine:
            renewed = threading.Event()
            put = store.put_lease

            def noting(lease: Lease) -> None:
                put(lease)
                renewed.set()

            monkeypatch.setattr(store, "put_lease", noting)
            assert renewed.wait(20), "nobody renewed it"
            now = store.lease()
            assert now is not None
            assert (now.fence, now.until_ms > mine.until_ms) == (mine.fence, True)
        given_back = store.lease()
        assert given_back is not None
        assert given_back.until_ms == 0
        with pytest.raises(KeyError), leased(store, "another"):
            raise KeyError
        assert take(store, "a third").fence == mine.fence + 2


def test_who_died_on_this_machine_is_not_waited_for() -> None:
    store = OracleStore()
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    mine = take(store, "an ingest")
    with pytest.raises(StoreBusy):
        take(store, "another")
    store.put_lease(replace(mine, process=ended.pid))
    assert take(store, "another").fence == mine.fence + 1


def test_an_ingest_that_lost_the_store_ends_and_writes_nothing(
    make_store: Callable[[], Store],
) -> None:
    with closing(make_store()) as store:
        numbers = PROFILES["default"].with_changes(checkpoint_frames=5)

        def lose(done: int, _total: int | None) -> None:
            if done == 7:
                elsewhere(store)

        with pytest.raises(StoreConflict, match="lost the store to another"):
            ingest(ListReader(frames()), store, numbers, on_progress=lose)
        assert [record.frames for record in store.recordings()] == [5]
        assert store.check() == []


def test_a_writer_that_was_held_up_loses_its_turn(
    mongo_uri: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from d3a.store import mongo_turn

    with closing(open_store(mongo_uri)) as one, closing(open_store(mongo_uri)) as two:
        clock = mongo_turn.server_ms
        with one.turn():
            monkeypatch.setattr(mongo_turn, "server_ms", lambda db: clock(db) + TERM_MS + 1)
            two.apply(Batch(meta={"a": "two"}))
            monkeypatch.setattr(mongo_turn, "monotonic", lambda: float("inf"))
            with pytest.raises(StoreConflict, match="held up for so long"):
                one.apply(Batch(meta={"a": "one"}))
        monkeypatch.undo()
        assert one.meta("a") == "two"
        one.apply(Batch(meta={"a": "one"}))
        assert two.meta("a") == "one"


def test_a_turn_that_does_not_end_is_not_waited_for_for_ever(
    mongo_uri: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from d3a.store import mongo_turn

    monkeypatch.setattr(mongo_turn, "WAIT_S", 0.0)
    with closing(open_store(mongo_uri)) as one, closing(open_store(mongo_uri)) as two:
        with one.turn(), pytest.raises(StoreBusy, match="another writes to it: a write"):
            two.apply(Batch(meta={"a": 1}))
        two.apply(Batch(meta={"a": 2}))
        with (
            pytest.raises(StoreError, match="reading only"),
            closing(open_store(mongo_uri, read_only=True)) as reader,
        ):
            reader.apply(Batch(meta={"a": 3}))
