"""Drawn histories of a store: batches that put, extend, move, merge and remove, and questions.

The universe is small on purpose, so that keys collide, intervals touch and points lie on edges.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from hypothesis import strategies as st

from d3a.store.base import (
    Area,
    Batch,
    Encounter,
    Keyframe,
    ObjectRecord,
    Positions,
    RecordingRecord,
    Region,
    Sighting,
    Spans,
    StayRecord,
    Store,
    StoreRefused,
    TaughtName,
    View,
)

IDS = ["a", "b:1", "$where", "ключ.0", "鍵", "e"]
CATEGORIES = ["cup", "keys", "tasse à café"]
WORDS = ["keys", "mug", "clés"]
PICTURES = ["p0", "p1", "p2"]
HOUR_MS = 3_600_000
EPOCH_MS = 1_582_178_400_000

ids = st.sampled_from(IDS)
places = st.integers(0, 2)
instants = st.integers(0, 12).map(lambda n: EPOCH_MS + n * HOUR_MS // 2)
lengths = st.sampled_from([0, 1, 300_000, HOUR_MS // 2, HOUR_MS])
spans = st.tuples(instants, lengths).map(lambda pair: (pair[0], pair[0] + pair[1]))
reals = st.sampled_from([-9999.5, -1.5, -1.0, -0.0, 0.1, 1.0, 1.05, 2.0, 1 / 3])
positions = st.none() | st.tuples(reals, reals, st.sampled_from([0.0, -0.5, 1.2]))
weights = st.floats(0, 1e6)
boxes = st.tuples(reals, reals, reals, reals)
poses = st.none() | st.tuples(*[reals] * 7)
shares = st.floats(0, 1)
texts = st.sampled_from(["", "kuri", "Küche", "frame\x1b[31m"])
whole = st.integers(0, 5)
images = st.none() | st.sampled_from(PICTURES)


@st.composite
def embeddings(draw: st.DrawFn) -> np.ndarray[Any, np.dtype[np.float32]] | None:
    seed = draw(st.none() | st.integers(0, 3))
    return None if seed is None else np.random.default_rng(seed).random(64, dtype=np.float32)


names = st.builds(TaughtName, st.sampled_from(WORDS), st.none() | st.sampled_from(["anna", ""]))


@st.composite
def objects(draw: st.DrawFn, object_id: str) -> ObjectRecord:
    first, last = draw(spans)
    return ObjectRecord(
        object_id,
        draw(st.sampled_from(CATEGORIES)),
        draw(weights),
        first,
        last,
        draw(texts),
        tuple(draw(st.lists(st.tuples(st.sampled_from(CATEGORIES), weights), max_size=2))),
        tuple(draw(st.lists(names, max_size=2))),
        draw(embeddings()),
        "histogram",
        draw(st.none() | st.tuples(shares, shares)),
        draw(st.booleans()),
        draw(st.booleans()),
    )


@st.composite
def stays(draw: st.DrawFn, object_id: str, place: int) -> StayRecord:
    first, last = draw(spans)
    return StayRecord(
        object_id,
        place,
        draw(positions),
        first,
        last,
        draw(weights),
        draw(texts),
        draw(st.none() | st.tuples(*[shares] * 9)),
        draw(whole),
        draw(st.none() | st.tuples(places, shares)),
        draw(st.none() | instants),
        draw(st.booleans()),
        draw(st.booleans()),
    )


@st.composite
def sightings(draw: st.DrawFn, object_id: str, place: int) -> Sighting:
    start, end = draw(spans)
    return Sighting(
        object_id,
        place,
        start,
        end,
        draw(texts),
        draw(shares),
        draw(boxes),
        draw(images),
        draw(whole),
        draw(texts),
        draw(texts),
        draw(st.none() | instants),
        draw(poses),
    )


@st.composite
def encounters(draw: st.DrawFn, known: list[tuple[str, int]]) -> Encounter:
    one, other = draw(st.sampled_from(known)), draw(st.sampled_from(known))
    if one[0] == other[0]:
        other = (next(object_id for object_id in IDS if object_id != one[0]), 0)
    one, other = sorted([one, other])
    start, end = draw(spans)
    return Encounter(
        one[0],
        other[0],
        one[1],
        other[1],
        start,
        end,
        draw(texts),
        draw(boxes),
        draw(boxes),
        draw(shares),
        draw(images),
        draw(whole),
        draw(texts),
        draw(poses),
        draw(st.none() | boxes),
    )


@st.composite
def views(draw: st.DrawFn) -> View:
    start, end = draw(spans)
    numbers = [draw(st.none() | reals) for _ in range(5)]
    return View(start, end, draw(whole), draw(texts), draw(texts), *numbers)


keyframes = st.builds(
    Keyframe, st.sampled_from(PICTURES), st.binary(min_size=1, max_size=4), *[st.just(8)] * 2,
    instants,
)  # fmt: skip
regions = st.builds(
    Region, st.sampled_from(["kitchen", "Flur"]), st.just(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)))
)
recordings = st.builds(
    RecordingRecord, st.sampled_from(["r1", "r2"]), texts, texts, st.none() | texts, whole, whole,
    st.none() | instants, st.none() | instants, st.none() | texts, st.booleans(),
    st.lists(st.tuples(texts, whole), max_size=1).map(tuple),
)  # fmt: skip
values = st.none() | st.recursive(
    st.booleans() | st.integers(-9, 9) | texts,
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.sampled_from("$a."), inner),
    max_leaves=3,
)


@st.composite
def batches(draw: st.DrawFn) -> Batch:
    """Draw a batch; most bring what they refer to, some dangle and must be refused."""
    stay_keys = draw(st.lists(st.tuples(ids, places), max_size=4))
    known = stay_keys or [("a", 0)]
    put_ids = sorted({object_id for object_id, _ in stay_keys}) if draw(st.integers(0, 9)) else []
    put_stays = stay_keys if draw(st.integers(0, 9)) else []
    seen = draw(st.lists(st.sampled_from(known), max_size=5))
    many = st.integers(0, 3)
    return Batch(
        objects=[draw(objects(object_id)) for object_id in put_ids],
        stays=[draw(stays(*key)) for key in put_stays],
        sightings=[draw(sightings(*key)) for key in seen],
        encounters=[draw(encounters(known)) for _ in range(draw(many))],
        views=draw(st.lists(views(), max_size=2)),
        keyframes=draw(st.lists(keyframes, max_size=2)),
        regions=draw(st.lists(regions, max_size=1)),
        recordings=draw(st.lists(recordings, max_size=1)),
        removed_objects=draw(st.lists(ids, max_size=1)),
        removed_stays=draw(st.lists(st.tuples(ids, places), max_size=1)),
        removed_sightings=draw(st.lists(st.tuples(ids, places, instants), max_size=2)),
        removed_encounters=draw(
            st.lists(st.tuples(ids, ids, places, places, instants), max_size=1)
        ),
        removed_regions=draw(st.lists(st.just("kitchen"), max_size=1)),
        removed_views=draw(st.lists(st.tuples(texts, texts, instants), max_size=1)),
        removed_keyframes=draw(st.lists(st.sampled_from(PICTURES), max_size=1)),
        meta=draw(st.dictionaries(st.sampled_from(["zone", "$set", "a.b"]), values, max_size=2)),
        state=draw(st.none() | st.binary(max_size=3)),
    )


def accepted(oracle: Store, drawn: Iterable[Batch]) -> Iterator[Batch]:
    """Apply drawn batches to a store, and yield those that it takes."""
    for batch in drawn:
        try:
            oracle.apply(batch)
        except StoreRefused:
            continue
        yield batch


Question = Callable[[Store], object]
some_ids = st.none() | st.lists(ids, max_size=3)
some_time = st.none() | instants
areas = st.none() | st.tuples(reals, reals, reals, reals).map(lambda v: Area(*v))


def placed(positions: Positions) -> list[Any]:
    """Where stays are as columns, as what can be compared: NaN equals nothing, -0.0 is 0.0."""
    at = (positions.x, positions.y, positions.z)
    numbers = (positions.of, positions.place, *at, positions.variance)
    sites = [positions.sites[n] for n in positions.site.tolist()]
    return [positions.ids, *([repr(n) for n in (each + 0).tolist()] for each in numbers), sites]


def columns(spans: Spans) -> tuple[Any, ...]:
    """What a store tells as columns, as what can be compared."""
    return spans.ids, spans.which(), spans.end_ms.tolist()


@st.composite
def questions(draw: st.DrawFn) -> Question:
    """Draw a call of one of the store's reading methods."""
    start, end = draw(some_time), draw(some_time)
    span = {"start_ms": start, "end_ms": end}
    among, with_ids, area = draw(some_ids), draw(some_ids), draw(areas)
    limit = draw(st.none() | st.integers(0, 3))
    most = draw(st.integers(1, 6))
    which = draw(st.sampled_from(["first", "last"]))
    categories = draw(st.none() | st.lists(st.sampled_from(CATEGORIES), max_size=2))
    words = draw(st.none() | st.lists(st.sampled_from(WORDS), max_size=2))
    asked: list[Question] = [
        lambda s: s.sightings(object_ids=among, area=area, limit=limit, **span),
        lambda s: s.stays(object_ids=among, area=area, **span),
        lambda s: s.edges(among or [], which, before_ms=end, after_ms=start),
        lambda s: s.newest(among or IDS, most, oldest=which == "first", **span),
        lambda s: s.newest(IDS, most, oldest=which == "first"),
        lambda s: s.reach(among or IDS, most),
        lambda s: s.reach(among or IDS, most, oldest=True),
        lambda s: s.count_seen(among or IDS, **span),
        lambda s: s.stays_at([(name, place) for name in among or IDS for place in (0, 2)]),
        lambda s: columns(s.spans(among or IDS, area=area, limit=limit, **span)),
        lambda s: placed(s.positions(among or IDS)),
        lambda s: s.sightings_at([*columns(s.spans(IDS))[1][::most], ("a", 99, 5)]),
        lambda s: s.embeddings(most)[0],
        lambda s: s.encounters(object_ids=among, with_ids=with_ids, **span),
        lambda s: s.views(**span),
        lambda s: s.objects(ids=among, categories=categories, names=words),
    ]
    return draw(st.sampled_from(asked))


def whole_store(store: Store) -> dict[str, Any]:
    """Everything that a store answers without a condition, embeddings and pictures included."""
    rows, matrix = store.embeddings()
    return {
        "dump": list(store.dump()),
        "categories": store.categories(),
        "names": store.names(),
        "embeddings": (rows, matrix.shape, matrix.tobytes()),
        "pictures": [store.keyframe(key) for key in store.keyframe_keys()],
        "regions": store.regions(),
        "recordings": store.recordings(),
        "last view": store.last_view_ms(),
        "meta": [store.meta(key) for key in ("zone", "$set", "a.b", "none")],
        "state": store.state(),
        "counts": {k: n for k, n in store.counts().items() if k != "bytes"},
        "damaged": bool(store.check()),
    }
