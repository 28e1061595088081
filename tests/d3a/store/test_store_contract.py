"""One contract over every store: drawn histories, compared exactly with the brute-force oracle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from d3a.store.base import Batch, Store, StoreRefused
from tests.worlds import histories
from tests.worlds.oracle import OracleStore

MakeStore = Callable[[], Store]
SETTINGS = settings(
    max_examples=12,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def applied(store: Store, batch: Batch) -> str:
    try:
        store.apply(batch)
    except StoreRefused as refused:
        return str(refused)
    return "applied"


@given(
    history=st.lists(histories.batches(), max_size=4),
    questions=st.lists(histories.questions(), max_size=12),
)
@SETTINGS
def test_a_drawn_history_reads_as_the_oracle_says(
    make_store: MakeStore,
    history: Sequence[Batch],
    questions: Sequence[histories.Question],
) -> None:
    oracle = OracleStore()
    with closing(make_store()) as store:
        for batch in history:
            assert applied(store, batch) == applied(oracle, batch)
        assert histories.whole_store(store) == histories.whole_store(oracle)
        for question in questions:
            assert question(store) == question(oracle)
        assert store.collect_keyframes(["p0"]) == oracle.collect_keyframes(["p0"])
        assert store.keyframe_keys() == oracle.keyframe_keys()


@given(history=st.lists(histories.batches(), min_size=1, max_size=4))
@SETTINGS
def test_a_batch_applied_twice_changes_nothing(
    make_store: MakeStore, history: Sequence[Batch]
) -> None:
    with closing(make_store()) as store:
        for batch in history:
            if applied(store, batch) == "applied":
                once = histories.whole_store(store)
                assert applied(store, batch) == "applied"
                assert histories.whole_store(store) == once
