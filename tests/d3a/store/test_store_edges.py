"""Fixed cases of the store contract: edges of time and space, long stays, removals, scripts."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from d3a.store import open_store
from d3a.store.base import (
    Area,
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    RecordingRecord,
    Sighting,
    StayRecord,
    Store,
    StoreError,
    StoreRefused,
    TaughtName,
    View,
)
from d3a.store.copy import copy_store
from tests.worlds.oracle import OracleStore

MakeStore = Callable[[], Store]
T0 = 1_582_178_400_000
BOX = (1.0, 2.0, 3.0, 4.0)


def cup(object_id: str = "a", **changes: object) -> ObjectRecord:
    return replace(ObjectRecord(object_id, "cup", 1.0, T0, T0 + 10), **changes)  # type: ignore[arg-type]


def at(
    x: float, y: float, z: float = 0.0, object_id: str = "a", place: int = 0, until: int = 10
) -> StayRecord:
    return StayRecord(object_id, place, (x, y, z), T0, T0 + until, 1.0)


def seen(
    start: int, end: int, object_id: str = "a", place: int = 0, image: str | None = None
) -> Sighting:
    return Sighting(object_id, place, T0 + start, T0 + end, f"f{start}", 0.5, BOX, image)


def met(a: str, b: str, start: int, end: int, image: str | None = None) -> Encounter:
    return Encounter(a, b, 0, 0, T0 + start, T0 + end, "f", BOX, BOX, 0.5, image)


def starts(sightings: list[Sighting]) -> list[int]:
    return [sighting.start_ms - T0 for sighting in sightings]


def test_touching_intervals_overlap_and_a_millisecond_apart_they_do_not(
    make_store: MakeStore,
) -> None:
    with closing(make_store()) as store:
        store.apply(
            Batch([cup()], [at(0, 0)], [seen(0, 10), seen(10, 20), seen(21, 30), seen(31, 31)])
        )
        assert starts(store.sightings(start_ms=T0 + 10, end_ms=T0 + 10)) == [0, 10]
        assert starts(store.sightings(start_ms=T0 + 20, end_ms=T0 + 21)) == [10, 21]
        assert starts(store.sightings(start_ms=T0 + 31)) == [31]
        assert starts(store.sightings(end_ms=T0)) == [0]
        assert starts(store.sightings(start_ms=T0 + 32)) == []
        assert starts(store.sightings(start_ms=T0 + 20, end_ms=T0 + 10)) == [0, 10][1:]


def test_points_on_the_edge_of_a_box_are_in_it(make_store: MakeStore) -> None:
    edges = [(-1.1, 0.3), (2.7, 0.3), (0.0, -0.1), (0.0, 0.7), (-1.1, 0.7)]
    outside = [(np.nextafter(-1.1, -9), 0.3), (2.7, np.nextafter(0.7, 9))]
    with closing(make_store()) as store:
        for place, (x, y) in enumerate(edges + outside):
            store.apply(
                Batch(
                    [cup()], [at(float(x), float(y), place=place)], [seen(place, place, "a", place)]
                )
            )
        area = Area(-1.1, -0.1, 2.7, 0.7)
        assert starts(store.sightings(area=area)) == [0, 1, 2, 3, 4]
        assert starts(store.sightings(area=area, start_ms=T0, end_ms=T0 + 9)) == [0, 1, 2, 3, 4]
        assert starts(store.sightings(area=area, object_ids=["a"], limit=2)) == [0, 1]
        assert [stay.place for stay in store.stays(area=area)] == [0, 1, 2, 3, 4]
        assert store.sightings(area=Area(2.0, 0.0, 1.0, 1.0)) == []
        everywhere = Area(-float("inf"), -float("inf"), float("inf"), float("inf"))
        assert len(store.stays(area=everywhere)) == 7


def test_a_place_that_moves_is_found_where_it_is_now(make_store: MakeStore) -> None:
    """The trees keep a wider box for small moves; what they answer must not show it."""
    with closing(make_store()) as store:
        store.apply(Batch([cup()], [at(0.0, 0.0)], [seen(0, 5), seen(7, 9)]))
        for x in (0.05, 0.089, 0.0901, 0.18, 0.5, -0.3, 3.0):
            store.apply(Batch(stays=[at(x, x)]))
            here, there = Area(x, x, x, x), Area(x + 0.001, x, x + 1, x)
            for start_ms in (None, T0):
                assert starts(store.sightings(area=here, start_ms=start_ms)) == [0, 7], x
                assert store.sightings(area=there, start_ms=start_ms) == [], x
            assert len(store.stays(area=here)) == 1
            assert store.stays(area=there) == []
        store.apply(Batch(stays=[replace(at(0, 0), position=None)]))
        assert store.sightings(area=Area(-9, -9, 9, 9)) == []
        assert starts(store.sightings()) == [0, 7]
        store.apply(Batch(stays=[at(1, 1)]))
        assert starts(store.sightings(area=Area(1, 1, 1, 1))) == [0, 7]
        assert store.check() == []


def test_an_interval_that_grows_is_found_at_its_new_end(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        store.apply(Batch([cup()], [at(1, 1)], [seen(0, 0)]))
        for end in (1, 59_999, 60_000, 60_001, 3_600_000, 30):
            store.apply(Batch(sightings=[seen(0, end)]))
            here = Area(1, 1, 1, 1)
            assert starts(store.sightings(area=here, start_ms=T0 + end, end_ms=T0 + end)) == [0]
            assert store.sightings(area=here, start_ms=T0 + end + 1) == []
            assert store.sightings(start_ms=T0 + end + 1) == []
        assert store.check() == []


def test_edges_with_equal_times_go_by_place(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        store.apply(
            Batch(
                [cup(), cup("b"), cup("c")],
                [at(0, 0), at(5, 5, place=1), at(0, 0, object_id="b"), at(0, 0, object_id="c")],
                [seen(5, 9, place=1), seen(5, 9), seen(0, 9), seen(3, 4, "b")],
            )
        )
        ids = ["c", "b", "a", "a", "none"]
        assert [(s.object_id, s.place) for s in store.edges(ids, "last")] == [("a", 1), ("b", 0)]
        assert starts(store.edges(ids, "first")) == [0, 3]
        assert starts(store.edges(ids, "last", before_ms=T0 + 4)) == [0, 3]
        assert starts(store.edges(ids, "first", after_ms=T0 + 5)) == [0]
        assert store.edges(ids, "first", after_ms=T0 + 10) == []
        assert store.edges([], "last") == []


def test_many_sightings_of_one_stay_keep_their_order(make_store: MakeStore) -> None:
    """512 fit into one document of MongoDB; the next ones go into the next document."""
    every = [seen(n * 10, n * 10 + 5) for n in range(1030)]
    with closing(make_store()) as store:
        store.apply(Batch([cup()], [at(1, 1)], every[:500]))
        store.apply(Batch(sightings=every[490:600]))
        store.apply(Batch(stays=[at(4, 4)], sightings=every[600:]))
        assert store.sightings() == every
        assert starts(store.sightings(area=Area(4, 4, 4, 4), start_ms=T0 + 10_290)) == [10_290]
        assert store.edges(["a"], "last") == every[-1:]
        assert store.edges(["a"], "first", after_ms=T0 + 5_126) == [every[513]]
        assert store.edges(["a"], "last", before_ms=T0 + 5_110) == [every[511]]
        longer = replace(every[0], end_ms=T0 + 20_000)
        store.apply(
            Batch(
                sightings=[longer], removed_sightings=[("a", 0, s.start_ms) for s in every[1:515]]
            )
        )
        assert store.sightings() == [longer, *every[515:]]
        assert store.edges(["a"], "last") == [longer]
        assert store.counts()["sightings"] == 516
        assert store.check() == []


def test_removals_take_what_hangs_on_them(make_store: MakeStore) -> None:
    ids = ["a", "b", "c"]
    full = Batch(
        [cup(i, names=(TaughtName("mine", i),)) for i in ids],
        [at(n, n, object_id=i, place=n) for i in ids for n in (0, 1)],
        [seen(n, n, i, n) for i in ids for n in (0, 1)],
        [met("a", "b", 0, 1), met("b", "c", 2, 3), met("a", "c", 4, 5)],
    )
    with closing(make_store()) as store:
        store.apply(full)
        store.apply(Batch(removed_stays=[("a", 0)], removed_sightings=[("b", 1, T0 + 1)]))
        assert [e.object_a for e in store.encounters()] == ["b"]
        assert [(s.object_id, s.place) for s in store.sightings()] == [
            ("b", 0), ("c", 0), ("a", 1), ("c", 1),
        ]  # fmt: skip
        store.apply(Batch(removed_objects=["b"], objects=[cup("b", category="bowl")]))
        assert store.encounters() == []
        assert store.stays(object_ids=["b"]) == []
        assert store.categories() == [("bowl", 1), ("cup", 2)]
        assert store.names() == [TaughtName("mine", "a"), TaughtName("mine", "c")]
        assert [o.object_id for o in store.objects(names=["mine"])] == ["a", "c"]
        store.apply(Batch(removed_objects=["a", "c", "never"], removed_stays=[("x", 0)]))
        assert {k: n for k, n in store.counts().items() if n and k != "bytes"} == {"objects": 1}
        assert store.check() == []


@pytest.mark.parametrize(
    "dangling",
    [
        Batch(stays=[at(0, 0, object_id="none")]),
        Batch(sightings=[seen(0, 1, place=7)]),
        Batch(encounters=[met("a", "none", 0, 1)]),
        Batch(removed_objects=["a"], stays=[at(0, 0)]),
        Batch(removed_stays=[("a", 0)], sightings=[seen(0, 1)]),
    ],
    ids=["no object", "no stay", "no other", "object removed", "stay removed"],
)
def test_a_batch_with_a_dangling_record_is_refused_whole(
    make_store: MakeStore, dangling: Batch
) -> None:
    with closing(make_store()) as store:
        store.apply(Batch([cup()], [at(0, 0)], [seen(0, 1)]))
        before = list(store.dump())
        with pytest.raises(StoreRefused, match="not stored"):
            store.apply(replace(dangling, meta={"zone": "UTC"}))
        assert list(store.dump()) == before


def test_embeddings_of_another_length_or_model_are_refused(make_store: MakeStore) -> None:
    def with_embedding(object_id: str, length: int, model: str) -> Batch:
        row = np.arange(length, dtype=np.float32) / 7
        return Batch([cup(object_id, embedding=row, embedding_model=model)])

    with closing(make_store()) as store:
        assert store.embeddings()[1].shape == (0, 0)
        store.apply(with_embedding("b", 64, "histogram"))
        store.apply(with_embedding("a", 64, "histogram"))
        for length, model in ((65, "histogram"), (64, "clip")):
            with pytest.raises(StoreRefused, match="use another store"):
                store.apply(with_embedding("c", length, model))
        ids, matrix = store.embeddings()
        assert ids == ["a", "b"]
        assert matrix.dtype == np.float32
        expected = np.arange(64, dtype=np.float32) / 7
        np.testing.assert_array_equal(matrix, np.stack([expected, expected]))
        [found] = store.objects(ids=["a"])
        np.testing.assert_array_equal(found.embedding, expected)


def test_objects_are_found_by_what_some_detections_called_them(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        store.apply(
            Batch(
                [
                    cup("a", categories=(("cup", 7.0), ("bowl", 3.0))),
                    cup("b", category="bowl", embedding=np.ones(64, dtype=np.float32)),
                    cup("c", categories=(("cup", 2.0),)),
                ]
            )
        )

        def found(category: str, *, votes: bool) -> list[str]:
            return [o.object_id for o in store.objects(categories=[category], votes=votes)]

        assert found("bowl", votes=False) == ["b"]
        assert found("bowl", votes=True) == ["a", "b"]
        assert found("cup", votes=True) == ["a", "c"]
        store.apply(Batch([cup("a", category="bowl", categories=(("bowl", 8.0), ("cup", 7.0)))]))
        assert found("bowl", votes=False) == ["a", "b"]
        assert found("cup", votes=True) == ["a", "c"]
        store.apply(Batch(removed_objects=["a"]))
        assert found("cup", votes=True) == ["c"]
        assert [o.embedding for o in store.objects(ids=["b"], embeddings=False)] == [None]


def test_a_revision_changes_with_every_write_and_with_nothing_else(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        before = store.revision()
        if before is None:
            pytest.skip("this store does not count the writes of others")
        store.objects()
        assert store.revision() == before
        store.apply(Batch([cup()]))
        assert store.revision() != before


def test_a_revision_counts_the_writes_of_another_connection(tmp_path: Path) -> None:
    path = str(tmp_path / "home.db")
    with closing(open_store(path)) as writer, closing(open_store(path, read_only=True)) as reader:
        before = reader.revision()
        assert reader.revision() == before
        writer.apply(Batch([cup()]))
        assert reader.revision() != before


HOSTILE = ["$where", "a.b", "{$gt: ''}", "'; DROP TABLE oic; --", "%", "键🔑", "\x1b[31m", "a:0:1"]


@pytest.mark.parametrize("name", HOSTILE)
def test_names_are_values_and_nothing_else(make_store: MakeStore, name: str) -> None:
    other = "a:0"
    with closing(make_store()) as store:
        store.apply(
            Batch(
                [cup(name, category=name, names=(TaughtName(name, name),)), cup(other)],
                [at(0, 0, object_id=name), at(1, 1, object_id=other, place=1)],
                [seen(0, 1, name), seen(2, 3, other, 1)],
                meta={name: {name: [name]}},
                recordings=[RecordingRecord(name, name, name, name, 1, 1, T0, T0, name, True)],
                keyframes=[Keyframe(name, b"jpeg", 1, 1, T0)],
                views=[View(T0, T0, 1, name, name)],
            )
        )
        assert [o.object_id for o in store.objects(categories=[name])] == [name]
        assert [o.object_id for o in store.objects(names=[name])] == [name]
        assert [s.object_id for s in store.sightings(object_ids=[name])] == [name]
        assert [s.object_id for s in store.edges([name], "last")] == [name]
        assert store.meta(name) == {name: [name]}
        assert store.keyframe(name) == Keyframe(name, b"jpeg", 1, 1, T0)
        assert store.keyframe("nothing") is None
        store.apply(Batch(removed_objects=[name], meta={name: None}))
        assert [s.object_id for s in store.sightings()] == [other]
        assert store.meta(name) is None


def test_pictures_nobody_refers_to_are_removed(make_store: MakeStore) -> None:
    pictures = [Keyframe(key, key.encode(), 1, 1, T0) for key in ("met", "seen", "kept", "old")]
    with closing(make_store()) as store:
        store.apply(
            Batch(
                [cup(), cup("b")],
                [at(0, 0), at(0, 0, object_id="b")],
                [seen(0, 1, image="seen")],
                [met("a", "b", 0, 1, image="met")],
                keyframes=pictures,
            )
        )
        assert store.check() == []
        assert store.collect_keyframes(keep=["kept"]) == 1
        assert store.keyframe_keys() == ["kept", "met", "seen"]
        store.apply(Batch(sightings=[seen(0, 1, image="lost")], removed_objects=["b"]))
        assert store.collect_keyframes() == 3
        assert [text for text in store.check() if "lost" in text]


def test_an_empty_store_answers_everything(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        store.apply(Batch())
        assert list(store.dump()) == []
        assert store.check() == []
        assert store.sightings(area=Area(0, 0, 1, 1), start_ms=0, end_ms=1) == []
        assert store.encounters(object_ids=[], with_ids=None) == []
        assert store.objects(ids=[]) == []
        assert (store.state(), store.meta("zone"), store.last_view_ms()) == (None, None, None)
        assert (store.names(), store.categories(), store.regions()) == ([], [], [])
        assert store.collect_keyframes() == 0


def test_more_ids_than_one_command_takes(make_store: MakeStore) -> None:
    ids = [f"o{n:05}" for n in range(1021)]
    stored = ids[::30]  # 35 of them, from each part that is sent
    with closing(make_store()) as store:
        store.apply(
            Batch(
                [cup(i) for i in stored],
                [at(0, 0, object_id=i) for i in stored],
                [seen(n, n, i) for n, i in enumerate(stored)],
                [met(a, b, 0, 1) for a, b in pairwise(stored)],
            )
        )
        assert len(store.sightings(object_ids=ids)) == 35
        assert len(store.sightings(object_ids=ids, start_ms=T0 + 10, end_ms=T0 + 20)) == 11
        assert len(store.edges(ids, "last")) == 35
        assert len(store.objects(ids=ids)) == 35
        assert len(store.stays(object_ids=ids)) == 35
        assert len(store.encounters(object_ids=stored[::2], with_ids=ids)) == 34


@pytest.mark.parametrize("way", ["there", "back"])
def test_a_copy_is_equal(make_store: MakeStore, tmp_path: object, way: str) -> None:
    oracle, state = OracleStore(), b"\x00\x01" * 10
    full = Batch(
        [cup(embedding=np.ones(64, dtype=np.float32), names=(TaughtName("mine"),)), cup("b")],
        [at(0, 0), at(-1, 2, object_id="b")],
        [seen(n, n, image="p") for n in range(600)],
        [met("a", "b", 0, 1)],
        [View(T0, T0, 1)],
        [Keyframe("p", b"jpeg", 1, 1, T0)],
        meta={"zone": "UTC"},
        state=state,
    )
    with closing(make_store()) as store:
        source, target = (oracle, store) if way == "there" else (store, oracle)
        source.apply(full)
        told: list[int] = []
        copy_store(source, target, progress=told.append)
        assert told[-1] == len(list(source.dump()))
        assert list(target.dump()) == list(source.dump())
        assert target.keyframe("p") == source.keyframe("p")
        assert target.state() == state
        with pytest.raises(StoreRefused, match="not empty"):
            copy_store(source, target)


def test_a_copy_that_differs_is_told(make_store: MakeStore) -> None:
    class Forgetful(OracleStore):
        def apply(self, batch: Batch) -> None:
            super().apply(replace(batch, views=()))

    with closing(make_store()) as store:
        store.apply(Batch(views=[View(T0, T0, 1)], meta={"zone": "UTC"}))
        with pytest.raises(StoreError, match="is not equal"):
            copy_store(store, Forgetful())


def test_a_store_can_be_opened_again(make_store: MakeStore) -> None:
    with closing(make_store()) as store:
        if isinstance(store, OracleStore):
            pytest.skip("the oracle is in memory")
        store.apply(Batch([cup()], [at(0, 0)], [seen(0, 1)], state=b"s"))
        before = list(store.dump())
        with closing(open_store(store.uri, read_only=True)) as again:
            assert list(again.dump()) == before
            with pytest.raises(StoreError):
                again.apply(Batch(meta={"zone": "UTC"}))
        assert list(store.dump()) == before
