"""What a writer read must still hold when it writes: else it would overwrite another's words."""

from __future__ import annotations

from d3a.store.base import Batch, Store, StoreConflict


def check_expected(store: Store, batch: Batch) -> None:
    """Raise StoreConflict where the store no longer holds what the batch was made from.

    For a store to call where nobody else can write: in its transaction, or behind its lock.
    """
    expected = batch.expects
    if expected is None:
        return
    for key, value in expected.meta.items():
        if store.meta(key) != value:
            raise StoreConflict(f"{store.uri}: {key!r} was written by another meanwhile")
    if expected.recordings is not None and tuple(store.recordings()) != expected.recordings:
        raise StoreConflict(f"{store.uri}: an ingest wrote to it meanwhile")
