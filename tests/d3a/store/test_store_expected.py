"""A batch that was made from what no longer holds is refused, and nothing of it is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from d3a.store.base import Batch, Expected, RecordingRecord, Store, StoreConflict

RECORDING = RecordingRecord("r|f|1", "r", "", None, 1, 0, 1, 1, "f", False)


def test_what_holds_is_written_and_what_does_not_is_refused(
    make_store: Callable[[], Store],
) -> None:
    store = make_store()
    store.apply(Batch(meta={"a": [1]}, expects=Expected({"a": None}, ())))
    before = list(store.dump())
    for stale in (Expected({"a": [2]}), Expected({"b": 1}), Expected({"a": None})):
        with pytest.raises(StoreConflict, match="meanwhile"):
            store.apply(Batch(meta={"c": 1}, expects=stale))
    assert list(store.dump()) == before
    store.apply(Batch(recordings=[RECORDING], expects=Expected({"a": [1]}, ())))
    with pytest.raises(StoreConflict, match="an ingest"):
        store.apply(Batch(meta={"c": 1}, expects=Expected(recordings=())))
    grown = replace(RECORDING, frames=2)
    store.apply(Batch(recordings=[grown], expects=Expected(recordings=(RECORDING,))))
    assert store.recordings() == [grown]
    assert store.meta("c") is None
    store.close()
