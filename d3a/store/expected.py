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
    lease = store.lease() if expected.fence is not None else None
    if expected.fence is not None and (lease is None or lease.fence != expected.fence):
        other = "nobody" if lease is None else lease.told()
        raise StoreConflict(f"{store.uri}: this ingest has lost the store to another: {other}")
