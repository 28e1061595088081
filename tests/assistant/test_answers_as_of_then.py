"""An answer as of `now` is that of a store which was filled until then, on every kind of store."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from datetime import datetime
from inspect import getmembers, isfunction
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from assistant.asking import ask_query
from d3a.answering.facts import Facts
from d3a.store.base import Store
from d3a.store.past import PastStore
from grammar.forms import FormalQuery
from tests.worlds import drawn
from tests.worlds.cut import cut, dated
from tests.worlds.made import Home, at, ms
from tests.worlds.oracle import OracleStore

TIMES = {"dump", "check", "counts", "repair", "state"}
"""Of the whole store, as its keeper asks: no question does."""
TIMELESS = {"keyframe", "keyframe_keys", "regions", "recordings", "meta", "revision", "tracing"}
WRITING = {"apply", "put_lease", "collect_keyframes", "scrub", "turn", "moment", "lease"}
KEEPING = {"close", "clock_ms"}
EVERY = settings(
    max_examples=12,
    deadline=None,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
moments = st.integers(-65, 125).map(lambda n: at(n * 2.0))


def told(store: Store, queries: Sequence[FormalQuery], now: datetime) -> list[Any]:
    records = [ask_query(store, query, now=now).to_json() for query in queries]
    return [{k: v for k, v in record.items() if k != "elapsed_ms"} for record in records]


@given(
    home=drawn.homes(),
    queries=st.lists(drawn.queries(), min_size=4, max_size=4),
    now=moments,
)
@EVERY
def test_what_was_seen_later_changes_no_answer(
    make_store: Callable[[], Store], home: Home, queries: Sequence[FormalQuery], now: datetime
) -> None:
    home = dated(home)
    home.look(300, 0.0, 0.0)  # the store goes on after whatever `now` is drawn
    before = cut(home, ms(now)).into(OracleStore())
    with closing(make_store()) as store:
        home.into(store)
        expected = told(before, queries, now)
        for said, wanted in zip(told(store, queries, now), expected, strict=True):
            if wanted.get("reason") == "empty":  # it knows when it began
                said["answer"] = wanted["answer"]
            assert said == wanted


@given(home=drawn.homes(), now=moments, start=moments, end=moments)
@EVERY
def test_every_reader_looks_back_from_then(
    make_store: Callable[[], Store], home: Home, now: datetime, start: datetime, end: datetime
) -> None:
    home = dated(home)
    home.look(300, 0.0, 0.0)  # the store goes on after whatever `now` is drawn
    before = cut(home, ms(now)).into(OracleStore())
    ids = sorted(home.objects)
    since: dict[str, Any] = {"start_ms": ms(start)}
    slices: tuple[dict[str, Any], ...] = ({}, since, {**since, "end_ms": ms(end)})
    with closing(make_store()) as store:
        home.into(store)
        past = PastStore(store, ms(now))
        for bounds in slices:
            for read in ("stays", "sightings", "encounters"):
                whole = {"object_ids": ids, **bounds}
                assert getattr(past, read)(**whole) == getattr(before, read)(**whole), read
            assert past.views(**bounds) == before.views(**bounds)
            assert past.count_seen(ids, **bounds) == before.count_seen(ids, **bounds)
            assert past.newest(ids, 3, **bounds) == before.newest(ids, 3, **bounds)
            spans, wanted = past.spans(ids, **bounds), before.spans(ids, **bounds)
            assert (spans.which(), spans.end_ms.tolist()) == (
                wanted.which(),
                wanted.end_ms.tolist(),
            )
        for which, bound in (("first", "after_ms"), ("last", "before_ms")):
            limited = {bound: ms(start)}
            assert past.edges(ids, which) == before.edges(ids, which)
            assert past.edges(ids, which, **limited) == before.edges(ids, which, **limited)
        for oldest in (False, True):
            assert past.reach(ids, 2, oldest=oldest) == before.reach(ids, 2, oldest=oldest)
        assert past.objects() == before.objects()
        assert past.categories() == before.categories()
        assert past.names() == before.names()
        assert past.last_view_ms() == before.last_view_ms()
        kept = past.positions(ids), before.positions(ids)
        assert np.array_equal(kept[0].x, kept[1].x, equal_nan=True)


def test_no_reader_of_the_store_was_overlooked() -> None:
    members = {name for name, _ in getmembers(Store, isfunction) if not name.startswith("_")}
    own = {name for name, _ in getmembers(PastStore, isfunction) if not name.startswith("_")}
    assert members - own == TIMES | TIMELESS | WRITING | KEEPING


def test_where_nothing_is_newer_the_store_itself_is_asked() -> None:
    home = Home()
    home.thing("cup", "cup")
    home.seen("cup", 0, 10)
    facts = Facts(dated(home).into(OracleStore()))
    assert facts.as_of(at(10)) is facts
    earlier = facts.as_of(at(5))
    assert earlier is not facts
    assert earlier.as_of(at(5)) is earlier
    assert earlier.last_view_ms() == ms(at(5))
